#include "geodesic/solver/move_elasticity.h"

#include <Eigen/LU>
#include <cmath>

#include "geodesic/grid/node_loop.h"
#include "geodesic/grid/q1_element.h"

namespace morphodesic {

namespace {

// Share of what jumps of A cost that is counted: they are steps of single nodes, which the block preconditioner evens
// out in part. (Measured: 0.5, 1 and 2 differ by 5 % in work.)
constexpr float jump_share = 0.5F;
// Jumps that resist a move by less than this part of the stiffness are left out: most of the cube has none.
constexpr float least_jump = 1e-3F;

/// |A|^2 |A^-1|^2 / Dim^2 with Frobenius norms: 1 for similarities.
template <int Dim>
float shear_factor(const Eigen::Matrix<float, Dim, Dim>& a) {
    if constexpr (Dim == 2) {
        const float size = a.squaredNorm(), det = a.determinant();
        return size * size / (4.0F * det * det);
    } else {
        return a.squaredNorm() * a.inverse().squaredNorm() / 9.0F;
    }
}

/// Sums of one frame at the coarse nodes.
template <int Dim>
struct FrameSums {
    std::vector<float> stiffness, share;
    typename VCycle<Dim>::Mass masses;
};

template <int Dim>
FrameSums<Dim> sums_of(const typename Trajectories<Dim>::Frame& frame, const DyadicGrid<Dim>& grid,
                       const DyadicGrid<Dim>& coarse, const std::vector<float>& weights) {
    using Matrix = Eigen::Matrix<float, Dim, Dim>;
    const auto corners = q1::corner_offsets(coarse);
    const auto edge = static_cast<float>(jump_share * std::pow(grid.spacing(), Dim - 2));
    const auto matrix = [&](std::size_t i) {
        Matrix a;
        for (int r = 0; r < Dim; ++r) {
            for (int c = 0; c < Dim; ++c) a(r, c) = frame.a[static_cast<std::size_t>(r * Dim + c)][i];
        }
        return a;
    };
    FrameSums<Dim> sums;
    sums.stiffness.assign(coarse.node_count(), 0.0F);
    sums.share.assign(coarse.node_count(), 0.0F);
    for (auto& entry : sums.masses) entry.assign(coarse.node_count(), 0.0F);
    for_each_node(grid, [&](std::size_t i, const auto& node) {
        const Matrix a = matrix(i);
        Matrix jumps = Matrix::Zero();
        for (int axis = 0; axis < Dim; ++axis) {
            if (node[static_cast<std::size_t>(axis)] == grid.cells(axis)) continue;
            const Matrix jump = matrix(i + grid.stride(axis)) - a;
            jumps += jump.transpose() * jump;
        }
        const auto s = frame.shares(i);
        const float stiffness = weights[i] * shear_factor<Dim>(a);
        for (std::size_t c = 0; c < s.size(); ++c) {
            sums.stiffness[frame.cell[i] + corners[c]] += s[c] * stiffness;
            sums.share[frame.cell[i] + corners[c]] += s[c];
        }
        if (jumps.trace() < least_jump) return;
        for (int r = 0; r < Dim; ++r) {
            for (int t = r; t < Dim; ++t) {
                auto& entry = sums.masses[static_cast<std::size_t>(kernels::symmetric_entry<Dim>(r, t))];
                const float mass = edge * weights[i] * jumps(r, t);
                for (std::size_t c = 0; c < s.size(); ++c) entry[frame.cell[i] + corners[c]] += s[c] * mass;
            }
        }
    });
    return sums;
}

}  // namespace

template <int Dim>
MoveElasticity<Dim>::MoveElasticity(const Trajectories<Dim>& trajectories, const DyadicGrid<Dim>& grid,
                                    const DyadicGrid<Dim>& coarse, std::span<const std::vector<float>> weights) {
    const int steps = static_cast<int>(weights.size());
    std::vector<FrameSums<Dim>> sums(weights.size());
    for_indices(0, steps, [&](int k) {
        const auto at = static_cast<std::size_t>(k);
        sums[at] = sums_of<Dim>(trajectories.frame(k), grid, coarse, weights[at]);
    });
    stiffness.assign(coarse.node_count(), 0.0F);
    for (auto& entry : masses) entry.assign(coarse.node_count(), 0.0F);
    std::vector<float> share(coarse.node_count(), 0.0F);
    for (const auto& sum : sums) {
        for (std::size_t i = 0; i < share.size(); ++i) {
            stiffness[i] += sum.stiffness[i];
            share[i] += sum.share[i];
            for (std::size_t e = 0; e < masses.size(); ++e) {
                masses[e][i] += sum.masses[e][i] / static_cast<float>(steps);
            }
        }
    }
    for (std::size_t i = 0; i < share.size(); ++i) stiffness[i] /= share[i];  // frame 0 reaches every node
}

template struct MoveElasticity<2>;
template struct MoveElasticity<3>;

}  // namespace morphodesic

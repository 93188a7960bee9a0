#include "geodesic/solver/alignment.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "geodesic/grid/moments.h"
#include "geodesic/grid/transfer.h"
#include "geodesic/kernels/alignment_kernel.h"
#include "geodesic/kernels/heaviside_kernel.h"
#include "geodesic/solver/small_rotation.h"

namespace morphodesic {

namespace {

template <int Dim>
using Matrix = Eigen::Matrix<double, Dim, Dim>;
template <int Dim>
using Vector = Eigen::Matrix<double, Dim, 1>;

template <int Dim>
Vector<Dim> as_vector(const Point<Dim>& x) {
    return Eigen::Map<const Vector<Dim>>(x.data());
}

template <int Dim>
struct Motion {
    Matrix<Dim> rotation = Matrix<Dim>::Identity();
    Vector<Dim> translation = Vector<Dim>::Zero();

    [[nodiscard]] RigidMotion<Dim> as_rigid() const {
        RigidMotion<Dim> m;
        for (int i = 0; i < Dim; ++i) {
            for (int j = 0; j < Dim; ++j) m.rotation[static_cast<std::size_t>(i * Dim + j)] = rotation(i, j);
            m.translation[static_cast<std::size_t>(i)] = translation(i);
        }
        return m;
    }
};

/// Mismatch of a o motion^-1 with b at the nodes of a grid, and its Gauss-Newton system in (angles, translation).
template <int Dim>
class MismatchProblem {
public:
    using Normal = Eigen::MatrixXd;

    MismatchProblem(const LevelSet<Dim>& a, const LevelSet<Dim>& b, int level)
        : a_(restricted(a, level)), eps_(a_.grid.spacing()) {
        const auto coarse = restricted(b, level);
        target_.resize(coarse.values.size());
        kernels::smooth_heaviside(coarse.values, eps_, target_);
    }

    double evaluate(const Motion<Dim>& m, Eigen::VectorXd* gradient, Normal* normal, bool rotate) const {
        constexpr int unknowns = kernels::motion_unknowns<Dim>;
        const DyadicGrid<Dim>& grid = a_.grid;
        const Matrix<Dim> back = m.rotation.transpose();
        const Vector<Dim> centre = Vector<Dim>::Constant(0.5);
        kernels::AlignmentSums<Dim> sums;
        kernels::AlignmentRow<Dim> row{};
        row.field = a_.values.data();
        row.count = static_cast<std::size_t>(grid.nodes(0));
        row.spacing = grid.spacing();
        row.eps = eps_;
        row.rotate = rotate;
        for (int c = 0; c < Dim; ++c) {
            row.cells[c] = grid.cells(c);
            row.step[c] = back(c, 0);
            for (int b = 0; b < Dim; ++b) row.rotation[c][b] = m.rotation(c, b);
        }
        for (std::size_t first = 0; first < target_.size(); first += row.count) {
            // y = back (exp(-w) z - t) for a further small rotation exp(w) and translation t, z = x - c - t0.
            const Vector<Dim> z = as_vector<Dim>(grid.position(grid.node(first))) - centre - m.translation;
            const Vector<Dim> y = back * z + centre;
            for (int c = 0; c < Dim; ++c) {
                row.first[c] = y(c) * grid.cells_per_unit();
                row.from_centre[c] = z(c);
            }
            row.target = target_.data() + first;
            kernels::add_row<Dim>(row, gradient != nullptr, sums);
        }
        const double volume = std::pow(grid.spacing(), Dim);
        if (gradient) {
            gradient->resize(unknowns);
            normal->resize(unknowns, unknowns);
            for (int i = 0; i < unknowns; ++i) {
                (*gradient)(i) = 2 * volume * sums.force[i];
                for (int j = 0; j <= i; ++j) (*normal)(i, j) = (*normal)(j, i) = 2 * volume * sums.product[i][j];
            }
        }
        return volume * sums.square;
    }

    /// Levenberg-Marquardt; returns the mismatch.
    double refine(Motion<Dim>& m, bool rotate, int iterations) const {
        Eigen::VectorXd gradient;
        Normal normal;
        double damping = 1e-3, value = evaluate(m, &gradient, &normal, rotate);
        for (int k = 0; k < iterations; ++k) {
            Normal system = normal;
            system.diagonal() += damping * normal.diagonal();
            system.diagonal().array() += 1e-12;
            const Eigen::VectorXd change = system.ldlt().solve(-gradient);
            Motion<Dim> trial = m;
            if (rotate) trial.rotation = small_rotation<Dim>(change) * m.rotation;
            trial.translation = m.translation + change.template tail<Dim>();
            Eigen::VectorXd next_gradient;
            Normal next_normal;
            const double next = evaluate(trial, &next_gradient, &next_normal, rotate);
            if (next < value) {
                const bool small = value - next < 1e-5 * value || change.norm() < 1e-7;
                m = trial;
                value = next;
                gradient.swap(next_gradient);
                normal.swap(next_normal);
                damping = std::max(damping * 0.2, 1e-9);
                if (small) break;
            } else {
                damping *= 8;
                if (damping > 1e6) break;
            }
        }
        return value;
    }

private:
    LevelSet<Dim> a_;
    double eps_;
    std::vector<double> target_;
};

/// Rotations about the centroids from which the search starts.
template <int Dim>
std::vector<Matrix<Dim>> start_rotations(const Moments<Dim>& a, const Moments<Dim>& b) {
    std::vector<Matrix<Dim>> starts;
    if constexpr (Dim == 2) {
        constexpr int angles = 24;
        for (int k = 0; k < angles; ++k) {
            starts.push_back(Eigen::Rotation2D<double>(2 * std::numbers::pi * k / angles).toRotationMatrix());
        }
        (void)a;
        (void)b;
    } else {
        const Eigen::SelfAdjointEigenSolver<Matrix<3>> axes_a(a.covariance), axes_b(b.covariance);
        std::array<int, 3> order{0, 1, 2};
        do {
            for (int signs = 0; signs < 8; ++signs) {
                Matrix<3> permuted = Matrix<3>::Zero();
                for (int i = 0; i < 3; ++i)
                    permuted(i, order[static_cast<std::size_t>(i)]) = (signs >> i & 1) ? -1.0 : 1.0;
                if (permuted.determinant() > 0) starts.push_back(permuted);
                const Matrix<3> turned = axes_b.eigenvectors() * permuted * axes_a.eigenvectors().transpose();
                if (turned.determinant() > 0) starts.push_back(turned);
            }
        } while (std::next_permutation(order.begin(), order.end()));
    }
    return starts;
}

}  // namespace

template <int Dim>
std::vector<AlignmentCandidate<Dim>> align(const LevelSet<Dim>& a, const LevelSet<Dim>& b, const std::string& mode,
                                           int count) {
    if (mode == "none") return {AlignmentCandidate<Dim>{}};
    const bool rotate = mode == "rigid";
    const int top = std::min({a.grid.level(), b.grid.level(), Dim == 2 ? 6 : 5});
    const int coarse = std::min(top, 4);
    const auto coarse_a = restricted(a, top), coarse_b = restricted(b, top);
    const Moments<Dim> moments_a(coarse_a), moments_b(coarse_b);
    if (!(moments_a.volume > 0.0 && moments_b.volume > 0.0)) {
        throw std::invalid_argument("align: a shape is empty on the grid");
    }
    const Vector<Dim> centre = Vector<Dim>::Constant(0.5);

    struct Candidate {
        Motion<Dim> motion;
        double mismatch;
    };
    std::vector<Candidate> candidates;
    const MismatchProblem<Dim> search(coarse_a, coarse_b, coarse);
    const auto rotations =
        rotate ? start_rotations<Dim>(moments_a, moments_b) : std::vector<Matrix<Dim>>{Matrix<Dim>::Identity()};
    for (const auto& rotation : rotations) {
        Candidate c;
        c.motion.rotation = rotation;
        c.motion.translation = moments_b.centroid - centre - rotation * (moments_a.centroid - centre);
        c.mismatch = search.evaluate(c.motion, nullptr, nullptr, rotate);
        candidates.push_back(c);
    }
    const auto better = [](const Candidate& x, const Candidate& y) { return x.mismatch < y.mismatch; };
    std::stable_sort(candidates.begin(), candidates.end(), better);
    candidates.resize(std::min(candidates.size(), static_cast<std::size_t>(std::max(12, 4 * count))));
    for (auto& c : candidates) c.mismatch = search.refine(c.motion, rotate, 12);
    std::stable_sort(candidates.begin(), candidates.end(), better);

    const MismatchProblem<Dim> fine(coarse_a, coarse_b, top);
    std::vector<Candidate> kept;
    for (auto& c : candidates) {
        const bool known = std::any_of(kept.begin(), kept.end(), [&](const Candidate& k) {
            return (k.motion.rotation - c.motion.rotation).norm() < 0.2 &&
                   (k.motion.translation - c.motion.translation).norm() < 0.03;
        });
        if (known) continue;
        kept.push_back(c);
        if (static_cast<int>(kept.size()) == count) break;
    }
    for (auto& c : kept) c.mismatch = fine.refine(c.motion, rotate, 10);
    std::stable_sort(kept.begin(), kept.end(), better);
    std::vector<AlignmentCandidate<Dim>> result;
    for (const auto& c : kept) result.push_back({c.motion.as_rigid(), c.mismatch});
    return result;
}

template std::vector<AlignmentCandidate<2>> align<2>(const LevelSet<2>&, const LevelSet<2>&, const std::string&, int);
template std::vector<AlignmentCandidate<3>> align<3>(const LevelSet<3>&, const LevelSet<3>&, const std::string&, int);

}  // namespace morphodesic

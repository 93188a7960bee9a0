#include "geodesic/solver/path_preconditioner.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geodesic/grid/injectivity.h"
#include "geodesic/grid/node_loop.h"
#include "geodesic/grid/q1_element.h"
#include "geodesic/kernels/heaviside_kernel.h"
#include "geodesic/solver/mismatch_points.h"

namespace morphodesic {

namespace {
constexpr double tail_floor = 1e-2;  // share of max delta_eps^2 in the scaling of u
// A residual of the mismatch moves with phi_k, u_{k-1} and u_k at once; treated one by one they need more than their
// own stiffness for full steps to be accepted (measured: 1 takes more line searches, 3 more iterations).
constexpr double coupling = 1.5;

/// Gauss-Newton matrices of the mismatch of one step in u_{k-1} and u_k, lumped at the nodes.
struct ShapeMass {
    std::vector<float> previous, next;

    void clear(std::size_t nodes) {
        previous.assign(nodes, 0.0F);
        next.assign(nodes, 0.0F);
    }
};

/// Adds a quadrature point: in phi_k, weight N_i (delta_eps(u))^2 grad u grad u^T with u = u_k at the deformed point;
/// in the shapes, weight N_i (delta_eps)^2 at the point of u_{k-1} and at the deformed point of u_k.
template <int Dim>
void add_to(typename VCycle<Dim>::Mass& deformation, ShapeMass& shapes, const MismatchPoint<Dim>& p,
            const std::array<std::size_t, 1 << Dim>& offsets, double weight) {
    const double here = p.here * p.here, there = p.there * p.there;
    const double size = weight * std::max(here, there);
    for (int c = 0; c < (1 << Dim); ++c) {
        const std::size_t corner = offsets[static_cast<std::size_t>(c)];
        const double share = q1::shape<Dim>(c, p.fraction);
        shapes.previous[p.node + corner] += static_cast<float>(weight * share * here);
        shapes.next[p.target.node + corner] +=
            static_cast<float>(weight * q1::shape<Dim>(c, p.target.fraction) * there);
        for (int r = 0; r < Dim; ++r) {
            for (int s = r; s < Dim; ++s) {
                deformation[static_cast<std::size_t>(kernels::symmetric_entry<Dim>(r, s))][p.node + corner] +=
                    static_cast<float>(size * share * p.slope[r] * p.slope[s]);
            }
        }
    }
}

/// Stiffness at the nodes of one time step, as a share of that of an undeformed cell inside.
template <int Dim>
std::vector<float> node_stiffness(const DyadicGrid<Dim>& grid, const double* u,
                                  const DisplacementView<Dim>& displacement, double eps,
                                  const GeodesicOptions& options) {
    const auto least = least_node_det<Dim>(grid, displacement);
    std::vector<float> stiffness(least.size());
    std::array<double, 512> block;
    for (std::size_t first = 0; first < least.size(); first += block.size()) {
        const std::span<double> indicator(block.data(), std::min(block.size(), least.size() - first));
        kernels::smooth_heaviside({u + first, indicator.size()}, eps, indicator);
        for (std::size_t j = 0; j < indicator.size(); ++j) {
            const double inside = (1.0 - options.outside_stiffness) * indicator[j] + options.outside_stiffness;
            // Where a cell is squeezed to det = s, the logarithm stiffens it by about 1 / s^2.
            const double squeezed = std::clamp(least[first + j], 0.005, 1.0);
            double local = inside * 0.5 * (1.0 + 1.0 / (squeezed * squeezed));
            if (squeezed < kernels::barrier_onset) {
                local += PathEnergy<Dim>::barrier_weight * 0.5 / (squeezed * squeezed);
            }
            stiffness[first + j] = static_cast<float>(local);
        }
    }
    return stiffness;
}
}  // namespace

template <int Dim>
PathPreconditioner<Dim>::PathPreconditioner(const PathEnergy<Dim>& energy)
    : layout_(energy.layout()), vectors_(layout_.grid) {
    const auto steps = static_cast<std::size_t>(layout_.time_steps);
    cycles_.assign(steps, VCycle<Dim>(layout_.grid));
    inverse_u_.assign(steps - 1, std::vector<float>(layout_.nodes()));
    if (steps > 1) transport_.emplace(layout_);
}

template <int Dim>
void PathPreconditioner<Dim>::update(const PathEnergy<Dim>& energy, std::span<const double> x) {
    const double eps = energy.eps(), node_volume = std::pow(layout_.grid.spacing(), Dim);
    const auto& options = energy.options();
    const auto stiffness = static_cast<float>(2.0 * layout_.time_steps * (options.mu + 0.25 * options.lambda));
    const double max_delta = std::numbers::inv_pi / eps;
    std::vector<std::vector<float>> weights(static_cast<std::size_t>(layout_.time_steps));
    std::vector<ShapeMass> masses(static_cast<std::size_t>(layout_.time_steps));
    const auto offsets = q1::corner_offsets(layout_.grid);
    const auto points = mismatch_points<Dim>(energy.quadrature());
    const double mass_unit = coupling * 2.0 * energy.eta() * node_volume / static_cast<double>(points.size());
    if constexpr (Dim == 3) vectors_.clear();  // not needed while operators are built, when most memory is in use
    if (transport_) transport_->follow(energy, x);
    oneapi::tbb::this_task_arena::isolate([&] {
        oneapi::tbb::parallel_for(0, layout_.time_steps, [&](int index) {
            const auto k = static_cast<std::size_t>(index);
            const double* u = energy.level_set(x, index);
            const DisplacementView<Dim> displacement = layout_.displacements(x.data(), index + 1);
            weights[k] = node_stiffness<Dim>(layout_.grid, u, displacement, eps, options);
            for (float& w : weights[k]) w *= stiffness;
            masses[k].clear(layout_.nodes());
            auto& deformation = cycles_[k].mass();
            for (auto& entry : deformation) std::fill(entry.begin(), entry.end(), 0.0F);
            for_each_mismatch_point<Dim>(layout_.grid, points, u, energy.level_set(x, index + 1), displacement, eps,
                                         [&](const MismatchPoint<Dim>& p) {
                                             add_to<Dim>(deformation, masses[k], p, offsets, mass_unit);
                                             if (transport_) transport_->add_point(index, p);
                                         });
            cycles_[k].set_operator(weights[k]);
        });
        const double floor = coupling * 4.0 * energy.eta() * node_volume * tail_floor * max_delta * max_delta;
        oneapi::tbb::parallel_for(1, layout_.time_steps, [&](int index) {
            const auto k = static_cast<std::size_t>(index);
            for (std::size_t i = 0; i < layout_.nodes(); ++i) {
                const double curvature = static_cast<double>(masses[k - 1].next[i] + masses[k].previous[i]);
                inverse_u_[k - 1][i] = static_cast<float>(1.0 / (curvature + floor));
            }
        });
    });
    masses.clear();
    masses.shrink_to_fit();
    if (transport_) transport_->build(energy, x, weights, inverse_u_);
}

template <int Dim>
bool PathPreconditioner<Dim>::drop_transport() {
    const bool had = transport_.has_value();
    transport_.reset();
    return had;
}

template <int Dim>
void PathPreconditioner<Dim>::apply(std::span<float> vector) {
    const std::size_t nodes = layout_.nodes();
    if (transport_) transport_->take(vector);
    oneapi::tbb::this_task_arena::isolate([&] {
        oneapi::tbb::parallel_for(1, layout_.time_steps + 1, [&](int k) {
            cycles_[static_cast<std::size_t>(k - 1)].apply(layout_.displacements(vector.data(), k), vectors_);
            if (k == layout_.time_steps) return;
            float* u = vector.data() + layout_.level_set(k);
            const auto& inverse = inverse_u_[static_cast<std::size_t>(k - 1)];
            for (std::size_t i = 0; i < nodes; ++i) u[i] *= inverse[i];
        });
    });
    if (!transport_) return;
    transport_->add_to(vector);
    // The faces of a box stay; what is on them now may have been inside in frame 0, where moves are not zero.
    for_indices(1, layout_.time_steps + 1, [&](int k) {
        for (int a = 0; a < Dim; ++a) clear_boundary(layout_.grid, vector.data() + layout_.displacement(k, a));
    });
}

template class PathPreconditioner<2>;
template class PathPreconditioner<3>;

}  // namespace morphodesic

#include "geodesic/solver/path_preconditioner.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geodesic/energy/heaviside.h"
#include "geodesic/grid/injectivity.h"

namespace morphodesic {

namespace {
constexpr double tail_floor = 1e-3;  // share of max delta_eps^2 in the scaling of u
// A residual of the mismatch moves with phi_k, u_{k-1} and u_k at once; treated one by one they need about twice the
// stiffness for full steps to be accepted (measured: 1 costs twice the line searches, 3 more iterations).
constexpr double coupling = 2.0;

/// |grad u|^2 at a node by one-sided differences of the larger slope per axis, at least 1.
template <int Dim>
double squared_slope(const DyadicGrid<Dim>& grid, const double* u, std::size_t i) {
    const auto at = grid.node(i);
    double square = 0.0;
    std::size_t stride = 1;
    for (const int c : at) {
        const double up = c + 1 < grid.nodes_per_axis() ? u[i + stride] - u[i] : 0.0;
        const double down = c > 0 ? u[i] - u[i - stride] : 0.0;
        square += std::max(up * up, down * down);
        stride *= static_cast<std::size_t>(grid.nodes_per_axis());
    }
    return std::max(1.0, square * grid.cells_per_axis() * grid.cells_per_axis());
}
}  // namespace

template <int Dim>
PathPreconditioner<Dim>::PathPreconditioner(const PathEnergy<Dim>& energy) : layout_(energy.layout()) {
    const auto steps = static_cast<std::size_t>(layout_.time_steps);
    cycles_.assign(steps, VCycle<Dim>(layout_.grid));
    inverse_u_.assign(steps - 1, std::vector<float>(layout_.nodes()));
}

template <int Dim>
void PathPreconditioner<Dim>::update(const PathEnergy<Dim>& energy, std::span<const double> x) {
    const double eps = energy.eps(), node_volume = std::pow(layout_.grid.spacing(), Dim);
    const auto& options = energy.options();
    const double stiffness = 2.0 * layout_.time_steps * (options.mu + 0.25 * options.lambda);
    const double max_delta = std::numbers::inv_pi / eps;
    oneapi::tbb::this_task_arena::isolate([&] {
        oneapi::tbb::parallel_for(0, layout_.time_steps, [&](int index) {
            const auto k = static_cast<std::size_t>(index);
            const double* u = energy.level_set(x, index);
            DisplacementView<Dim> displacement;
            for (int a = 0; a < Dim; ++a) {
                displacement[static_cast<std::size_t>(a)] = x.data() + layout_.displacement(index + 1, a);
            }
            const auto least = least_node_det<Dim>(layout_.grid, displacement);
            std::vector<float> weight(layout_.nodes()), mass(layout_.nodes());
            for (std::size_t i = 0; i < weight.size(); ++i) {
                const double delta = smooth_delta(u[i], eps);
                const double inside =
                    (1.0 - options.outside_stiffness) * smooth_heaviside(u[i], eps) + options.outside_stiffness;
                // Where a cell is squeezed to det = s, the logarithm stiffens it by about 1 / s^2.
                const double squeezed = std::clamp(least[i], 0.005, 1.0);
                double local = inside * 0.5 * (1.0 + 1.0 / (squeezed * squeezed));
                if (squeezed < kernels::barrier_onset) {
                    local += PathEnergy<Dim>::barrier_weight * 0.5 / (squeezed * squeezed);
                }
                weight[i] = static_cast<float>(stiffness * local);
                mass[i] = static_cast<float>(coupling * 2.0 * energy.eta() * delta * delta * node_volume *
                                             squared_slope(layout_.grid, u, i));
                if (k > 0) {
                    const double curvature = coupling * 4.0 * energy.eta() * node_volume *
                                             (delta * delta + tail_floor * max_delta * max_delta);
                    inverse_u_[k - 1][i] = static_cast<float>(1.0 / curvature);
                }
            }
            cycles_[k].set_operator(weight, mass);
        });
    });
}

template <int Dim>
void PathPreconditioner<Dim>::apply(std::span<const double> gradient, std::span<double> direction) {
    const std::size_t nodes = layout_.nodes();
    oneapi::tbb::this_task_arena::isolate([&] {
        oneapi::tbb::parallel_for(1, layout_.time_steps + 1, [&](int k) {
            for (int a = 0; a < Dim; ++a) {
                const std::size_t at = layout_.displacement(k, a);
                cycles_[static_cast<std::size_t>(k - 1)].apply(gradient.subspan(at, nodes),
                                                               direction.subspan(at, nodes));
            }
            if (k == layout_.time_steps) return;
            const std::size_t at = layout_.level_set(k);
            const auto& inverse = inverse_u_[static_cast<std::size_t>(k - 1)];
            for (std::size_t i = 0; i < nodes; ++i) direction[at + i] = gradient[at + i] * inverse[i];
        });
    });
}

template class PathPreconditioner<2>;
template class PathPreconditioner<3>;

}  // namespace morphodesic

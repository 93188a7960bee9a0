#include "geodesic/solver/path_preconditioner.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geodesic/energy/heaviside.h"
#include "geodesic/grid/injectivity.h"
#include "geodesic/grid/q1_element.h"

namespace morphodesic {

namespace {
constexpr double tail_floor = 1e-2;  // share of max delta_eps^2 in the scaling of u
// A residual of the mismatch moves with phi_k, u_{k-1} and u_k at once; treated one by one they need about twice the
// stiffness for full steps to be accepted (measured: 1 costs twice the line searches, 3 more iterations).
constexpr double coupling = 2.0;

/// Gauss-Newton matrices of the mismatch of one step, lumped at the nodes.
template <int Dim>
struct MismatchMass {
    typename VCycle<Dim>::Mass deformation;    // in phi_k
    std::vector<float> previous_shape, shape;  // in u_{k-1} and u_k

    explicit MismatchMass(std::size_t nodes) : previous_shape(nodes, 0.0F), shape(nodes, 0.0F) {
        for (auto& m : deformation) m.assign(nodes, 0.0F);
    }
};

/// Sums over the quadrature points: in phi_k, weight N_i (delta_eps(u))^2 grad u grad u^T with u = u_k at the deformed
/// point; in the shapes, weight N_i (delta_eps)^2 at the point of u_{k-1} and at the deformed point of u_k.
template <int Dim>
void add_mismatch_mass(const DyadicGrid<Dim>& grid, const double* from, const double* to,
                       const DisplacementView<Dim>& w, double eps, double weight, MismatchMass<Dim>& mass) {
    constexpr int corners = 1 << Dim;
    const auto offsets = q1::corner_offsets(grid);
    const double per_cell = grid.cells_per_axis(), far = 6.0 * eps;
    double shape[corners][corners];
    for (int q = 0; q < corners; ++q) {
        Point<Dim> x{};
        for (int a = 0; a < Dim; ++a) x[static_cast<std::size_t>(a)] = q1::gauss_coordinate(q, a);
        for (int c = 0; c < corners; ++c) shape[q][c] = q1::shape<Dim>(c, x);
    }
    typename DyadicGrid<Dim>::Index cell{};
    for (std::size_t number = 0; number < grid.cell_count(); ++number) {
        const std::size_t node = grid.index(cell);
        const auto low = cell;
        for (int a = 0; a < Dim && ++cell[static_cast<std::size_t>(a)] == grid.cells_per_axis(); ++a) {
            cell[static_cast<std::size_t>(a)] = 0;
        }
        double u_from[corners];
        double displacement[Dim][corners];
        for (int c = 0; c < corners; ++c) {
            const std::size_t i = node + offsets[static_cast<std::size_t>(c)];
            u_from[c] = from[i];
            for (int a = 0; a < Dim; ++a) displacement[a][c] = w[static_cast<std::size_t>(a)][i];
        }
        // A cell whose middle is far from both contours has no part in it; displacements stretch a cell two times at
        // most where that matters.
        {
            Point<Dim> y{};
            double before = 0.0;
            for (int a = 0; a < Dim; ++a) {
                const auto at = static_cast<std::size_t>(a);
                y[at] = (low[at] + 0.5) / per_cell;
                for (int c = 0; c < corners; ++c) y[at] += displacement[a][c] / corners;
            }
            for (int c = 0; c < corners; ++c) before += u_from[c] / corners;
            const double reach = far + 2.0 * grid.spacing();
            if (std::abs(before) > reach && std::abs(q1::value(grid, to, y)) > reach) continue;
        }
        for (int q = 0; q < corners; ++q) {
            Point<Dim> y{};
            double before = 0.0;
            for (int a = 0; a < Dim; ++a) {
                const auto at = static_cast<std::size_t>(a);
                y[at] = (low[at] + q1::gauss_coordinate(q, a)) / per_cell;
                for (int c = 0; c < corners; ++c) y[at] += shape[q][c] * displacement[a][c];
            }
            for (int c = 0; c < corners; ++c) before += shape[q][c] * u_from[c];
            const auto where = q1::locate(grid, y);
            double after = 0.0, slope[Dim] = {};
            for (int c = 0; c < corners; ++c) {
                const double v = to[where.node + offsets[static_cast<std::size_t>(c)]];
                after += q1::shape<Dim>(c, where.fraction) * v;
                for (int a = 0; a < Dim; ++a) slope[a] += q1::shape_slope<Dim>(c, where.fraction, a) * v * per_cell;
            }
            if (std::abs(after) > far && std::abs(before) > far) continue;
            const double there = smooth_delta(after, eps), here = smooth_delta(before, eps);
            const double size = weight * std::max(there * there, here * here);
            for (int c = 0; c < corners; ++c) {
                const std::size_t i = node + offsets[static_cast<std::size_t>(c)];
                mass.previous_shape[i] += static_cast<float>(weight * shape[q][c] * here * here);
                mass.shape[where.node + offsets[static_cast<std::size_t>(c)]] +=
                    static_cast<float>(weight * q1::shape<Dim>(c, where.fraction) * there * there);
                for (int r = 0; r < Dim; ++r) {
                    for (int s = r; s < Dim; ++s) {
                        mass.deformation[static_cast<std::size_t>(kernels::symmetric_entry<Dim>(r, s))][i] +=
                            static_cast<float>(size * shape[q][c] * slope[r] * slope[s]);
                    }
                }
            }
        }
    }
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
    std::vector<MismatchMass<Dim>> masses(static_cast<std::size_t>(layout_.time_steps),
                                          MismatchMass<Dim>(layout_.nodes()));
    oneapi::tbb::this_task_arena::isolate([&] {
        oneapi::tbb::parallel_for(0, layout_.time_steps, [&](int index) {
            const auto k = static_cast<std::size_t>(index);
            const double* u = energy.level_set(x, index);
            DisplacementView<Dim> displacement;
            for (int a = 0; a < Dim; ++a) {
                displacement[static_cast<std::size_t>(a)] = x.data() + layout_.displacement(index + 1, a);
            }
            const auto least = least_node_det<Dim>(layout_.grid, displacement);
            std::vector<float> weight(layout_.nodes());
            for (std::size_t i = 0; i < weight.size(); ++i) {
                const double inside =
                    (1.0 - options.outside_stiffness) * smooth_heaviside(u[i], eps) + options.outside_stiffness;
                // Where a cell is squeezed to det = s, the logarithm stiffens it by about 1 / s^2.
                const double squeezed = std::clamp(least[i], 0.005, 1.0);
                double local = inside * 0.5 * (1.0 + 1.0 / (squeezed * squeezed));
                if (squeezed < kernels::barrier_onset) {
                    local += PathEnergy<Dim>::barrier_weight * 0.5 / (squeezed * squeezed);
                }
                weight[i] = static_cast<float>(stiffness * local);
            }
            add_mismatch_mass<Dim>(layout_.grid, u, energy.level_set(x, index + 1), displacement, eps,
                                   coupling * 2.0 * energy.eta() * node_volume / (1 << Dim), masses[k]);
            cycles_[k].set_operator(weight, masses[k].deformation);
        });
        const double floor = coupling * 4.0 * energy.eta() * node_volume * tail_floor * max_delta * max_delta;
        oneapi::tbb::parallel_for(1, layout_.time_steps, [&](int index) {
            const auto k = static_cast<std::size_t>(index);
            for (std::size_t i = 0; i < layout_.nodes(); ++i) {
                const double curvature = static_cast<double>(masses[k - 1].shape[i] + masses[k].previous_shape[i]);
                inverse_u_[k - 1][i] = static_cast<float>(1.0 / (curvature + floor));
            }
        });
    });
}

template <int Dim>
void PathPreconditioner<Dim>::apply(std::span<const double> gradient, std::span<double> direction) {
    const std::size_t nodes = layout_.nodes();
    oneapi::tbb::this_task_arena::isolate([&] {
        oneapi::tbb::parallel_for(1, layout_.time_steps + 1, [&](int k) {
            std::array<const double*, Dim> right_side;
            std::array<double*, Dim> solution;
            for (int a = 0; a < Dim; ++a) {
                right_side[static_cast<std::size_t>(a)] = gradient.data() + layout_.displacement(k, a);
                solution[static_cast<std::size_t>(a)] = direction.data() + layout_.displacement(k, a);
            }
            cycles_[static_cast<std::size_t>(k - 1)].apply(right_side, solution);
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

#include "geodesic/solver/transport_correction.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geodesic/grid/node_loop.h"
#include "geodesic/grid/q1_element.h"
#include "geodesic/solver/mismatch_points.h"
#include "geodesic/solver/move_elasticity.h"

namespace morphodesic {

namespace {

// Levels between the grid of the path and that of the moves. Moves are smooth; a rough move of a rim would not leave
// the mismatch as it is. (Measured: 1, 2 and 3 take about the same number of iterations.)
constexpr int coarser_by = 2, coarsest_level = 3;
// The modes of time are not quite independent where only one frame resists; twice the stiffness keeps steps full.
constexpr double rest_factor = 2.0;
// Share of the stiffness inside that the background gets here. With its own, next to nothing, points of it would move
// by many cells at once, and line searches fail.
constexpr double background = 0.2;
// The corrections overlap with those of phi_k and u_k one by one. (Half of the moves finds paths that are 0.1 % higher;
// in full they strew more dots over the background, which the model allows, where a small shape grows twelvefold.)
constexpr double move_share = 0.7, level_share = 0.3;

template <int Dim>
DyadicGrid<Dim> grid_of_moves(DyadicGrid<Dim> grid) {
    for (int i = 0; i < coarser_by && grid.level() > coarsest_level && grid.can_be_coarser(); ++i)
        grid = grid.coarser();
    return grid;
}
}  // namespace

template <int Dim>
TransportCorrection<Dim>::TransportCorrection(const PathLayout<Dim>& layout)
    : layout_(layout), coarse_(grid_of_moves(layout.grid)), trajectories_(layout, coarse_), vectors_(coarse_) {
    const auto steps = static_cast<std::size_t>(layout.time_steps);
    level_unit_.assign(steps - 1, std::vector<float>(layout.nodes()));
    buffers_.assign(steps, std::vector<float>(coarse_.node_count() * width));
    modes_.assign(steps - 1, VCycle<Dim>(coarse_));
    std::array<std::vector<float>, Dim> field;
    for (auto& c : field) c.resize(coarse_.node_count());
    modal_.assign(steps - 1, field);
}

template <int Dim>
void TransportCorrection<Dim>::follow(const PathEnergy<Dim>& energy, std::span<const double> x) {
    trajectories_.update(energy, x);
    const auto points = mismatch_points<Dim>(energy.quadrature());
    unit_ = 4.0 * energy.eta() * std::pow(layout_.grid.spacing(), Dim) / static_cast<double>(points.size());
    rest_.resize(static_cast<std::size_t>(layout_.time_steps));
    for (auto& rest : rest_) {
        for (auto& m : rest) m.assign(coarse_.node_count(), 0.0F);
    }
}

/// The covector e at a place of frame `of`, taken to frame 0 by the map of that frame, into the sums of frame k.
template <int Dim>
void TransportCorrection<Dim>::add_rest(int k, int of, std::size_t node, const Point<Dim>& fraction,
                                        const double (&e)[Dim]) {
    const auto until = trajectories_.jacobian_at(of, node, fraction);
    const auto origin = trajectories_.origin_at(of, node, fraction);
    float taken[Dim];
    for (int c = 0; c < Dim; ++c) {
        taken[c] = 0.0F;
        for (int r = 0; r < Dim; ++r) taken[c] += static_cast<float>(e[r]) * until(r, c);
    }
    const auto there = place_of<Dim>(coarse_, origin);
    const auto s = corner_shares<Dim>(there.fraction);
    const auto corners = q1::corner_offsets(coarse_);
    auto& rest = rest_[static_cast<std::size_t>(k)];
    for (std::size_t c = 0; c < (1 << Dim); ++c) {
        for (int r = 0; r < Dim; ++r) {
            for (int t = r; t < Dim; ++t) {
                rest[static_cast<std::size_t>(kernels::symmetric_entry<Dim>(r, t))][there.node + corners[c]] +=
                    static_cast<float>(unit_) * s[c] * taken[r] * taken[t];
            }
        }
    }
}

template <int Dim>
void TransportCorrection<Dim>::add_point(int k, const MismatchPoint<Dim>& p) {
    const auto& grid = layout_.grid;
    const auto corners = q1::corner_offsets(grid);
    const auto at = [&](const typename Trajectories<Dim>::Vector& field, std::size_t node, const Point<Dim>& fraction,
                        double(&value)[Dim]) {
        for (std::size_t a = 0; a < Dim; ++a) {
            value[a] = 0.0;
            for (int c = 0; c < (1 << Dim); ++c) {
                value[a] += q1::shape<Dim>(c, fraction) *
                            static_cast<double>(field[a][node + corners[static_cast<std::size_t>(c)]]);
            }
        }
    };
    double g[Dim], e[Dim];
    if (k + 1 < layout_.time_steps) {  // frame k + 1 moves: u_{k+1} is carried by its gradient at the nodes
        at(trajectories_.frame(k + 1).gradient, p.target.node, p.target.fraction, g);
        for (int a = 0; a < Dim; ++a) e[a] = p.there * (p.slope[a] - g[a]);
        add_rest(k, k + 1, p.target.node, p.target.fraction, e);
    }
    if (k > 0) {  // frame k moves: u_k is carried, and phi_{k+1} starts from elsewhere
        at(trajectories_.frame(k).gradient, p.node, p.fraction, g);
        for (int b = 0; b < Dim; ++b) {
            e[b] = p.here * g[b] - p.there * p.slope[b];
            for (int a = 0; a < Dim; ++a) {
                double d = 0.0;
                for (int c = 0; c < (1 << Dim); ++c) {
                    d += q1::shape_slope<Dim>(c, p.fraction, b) * p.displacement[a][c];
                }
                e[b] -= p.there * p.slope[a] * d * grid.cells_per_unit();
            }
        }
        add_rest(k, k, p.node, p.fraction, e);
    }
}

template <int Dim>
void TransportCorrection<Dim>::build(const PathEnergy<Dim>& energy, std::span<const double> x,
                                     const std::vector<std::vector<float>>& weights,
                                     const std::vector<std::vector<float>>& inverse_u) {
    constexpr std::size_t entries = kernels::symmetric_entries<Dim>;
    const std::size_t coarse_nodes = coarse_.node_count();
    const int steps = layout_.time_steps;
    trajectories_.finish();
    for (std::size_t k = 0; k < inverse_u.size(); ++k) {
        // PathPreconditioner takes u_k for stiffer than the mismatch makes it. Far from the contour nothing
        // resists a change of u_k, and single nodes would become positive unseen by any quadrature point.
        const double* u = energy.level_set(x, static_cast<int>(k + 1));
        for (std::size_t i = 0; i < layout_.nodes(); ++i) {
            level_unit_[k][i] = near_contour(u[i], energy.eps()) * std::sqrt(2.0F * inverse_u[k][i]);
        }
    }
    MoveElasticity<Dim> elasticity(trajectories_, layout_.grid, coarse_, weights);
    typename VCycle<Dim>::Mass rest;
    for (auto& m : rest) m.assign(coarse_nodes, 0.0F);
    for (const auto& of_step : rest_) {
        for (std::size_t e = 0; e < entries; ++e) {
            for (std::size_t i = 0; i < coarse_nodes; ++i) rest[e][i] += of_step[e][i] / static_cast<float>(steps - 1);
        }
    }
    const auto floor =
        static_cast<float>(background * 2.0 * steps * (energy.options().mu + 0.25 * energy.options().lambda));
    for (float& w : elasticity.stiffness) w = std::max(floor, w);
    for_indices(1, steps, [&](int m) {
        const double s = std::sin(std::numbers::pi * m / (2 * steps));
        auto& mode = modes_[static_cast<std::size_t>(m - 1)];
        const auto factor = static_cast<float>(rest_factor / (4.0 * s * s));
        for (std::size_t e = 0; e < entries; ++e) {
            auto& mass = mode.mass()[e];
            for (std::size_t i = 0; i < coarse_nodes; ++i) mass[i] = factor * rest[e][i] + elasticity.masses[e][i];
        }
        mode.set_operator(elasticity.stiffness);
    });
}

template <int Dim>
kernels::TransportMaps<Dim> TransportCorrection<Dim>::maps(int k) const {
    const auto& frame = trajectories_.frame(k);
    const auto corners = q1::corner_offsets(coarse_);
    kernels::TransportMaps<Dim> m{};
    m.cell = frame.cell.data();
    for (std::size_t a = 0; a < Dim; ++a) {
        m.fraction[a] = frame.fraction[a].data();
        m.q[a] = frame.q[a].data();
    }
    for (std::size_t e = 0; e < Dim * Dim; ++e) m.a[e] = frame.a[e].data();
    m.d = k > 0 ? level_unit_[static_cast<std::size_t>(k - 1)].data() : nullptr;
    std::copy(corners.begin(), corners.end(), m.corner);
    return m;
}

/// Transposed maps of frame k: its gradients, summed at the coarse nodes.
template <int Dim>
void TransportCorrection<Dim>::push(int k, std::span<const float> gradient) {
    auto& buffer = buffers_[static_cast<std::size_t>(k)];
    std::fill(buffer.begin(), buffer.end(), 0.0F);
    const float* g[Dim];
    for (int a = 0; a < Dim; ++a) g[a] = gradient.data() + layout_.displacement(k + 1, a);
    const float* gu = k > 0 ? gradient.data() + layout_.level_set(k) : nullptr;
    kernels::push<Dim>(layout_.nodes(), maps(k), g, gu, buffer.data());
}

/// Gradients in v_k, z_k, y_k in the buffers -> corrections v_k, z_k, y_k.
template <int Dim>
void TransportCorrection<Dim>::solve() {
    const int steps = layout_.time_steps;
    const auto count = static_cast<std::size_t>(steps);
    std::vector<float> basis((count - 1) * count);  // orthonormal, [m][k]
    for (int m = 1; m < steps; ++m) {
        for (int k = 0; k < steps; ++k) {
            basis[static_cast<std::size_t>((m - 1) * steps + k)] =
                static_cast<float>(std::sqrt(2.0 / steps) * std::cos(std::numbers::pi * m * (k + 0.5) / steps));
        }
    }
    // A coarse node stands for so many of the nodes where levels are curved.
    const double nodes_per_coarse = std::pow(2.0, Dim * (layout_.grid.level() - coarse_.level()));
    const auto level_scale = static_cast<float>(2.0 * level_share / (steps * nodes_per_coarse));
    for_nodes(coarse_, [&](std::size_t i) {
        const bool boundary = coarse_.on_boundary(coarse_.node(i));
        // z_k = v_1 + .. + v_k: the gradient in v_j collects those in z_k, k >= j.
        float tail[Dim] = {};
        for (std::size_t c = 0; c < Dim; ++c) {
            for (std::size_t m = 0; m + 1 < count; ++m) modal_[m][c][i] = 0.0F;
        }
        for (std::size_t k = count; k-- > 0 && !boundary;) {  // v_{k+1} is in frame k
            const float* in = buffers_[k].data() + i * width;
            for (std::size_t c = 0; c < Dim; ++c) {
                const float value = in[c] + tail[c];
                for (std::size_t m = 0; m + 1 < count; ++m) {
                    modal_[m][c][i] += basis[m * count + k] * value;
                }
                tail[c] += in[Dim + c];
            }
        }
        // The chain: inverse of tridiag(-1/2, 1, -1/2) with K - 1 rows, 2 / K min(j, k) (K - max(j, k)), by running
        // sums.
        float before = 0.0F, behind = 0.0F;
        for (std::size_t k = 1; k < count; ++k) {
            behind += static_cast<float>(count - k) * buffers_[k][i * width + 2 * Dim];
        }
        for (std::size_t k = 1; k < count; ++k) {
            float& y = buffers_[k][i * width + 2 * Dim];
            behind -= static_cast<float>(count - k) * y;
            before += static_cast<float>(k) * y;
            y = level_scale * (static_cast<float>(count - k) * before + static_cast<float>(k) * behind);
        }
    });
    for_indices(0, steps - 1, [&](int m) {
        std::array<float*, Dim> field;
        for (std::size_t c = 0; c < Dim; ++c) field[c] = modal_[static_cast<std::size_t>(m)][c].data();
        modes_[static_cast<std::size_t>(m)].apply(field, vectors_);
    });
    for_nodes(coarse_, [&](std::size_t i) {
        float z[Dim] = {};
        for (std::size_t k = 0; k < count; ++k) {
            float* out = buffers_[k].data() + i * width;
            for (std::size_t c = 0; c < Dim; ++c) {
                float v = 0.0F;
                for (std::size_t m = 0; m + 1 < count; ++m) {
                    v += basis[m * count + k] * modal_[m][c][i];
                }
                v *= static_cast<float>(move_share);
                out[c] = v;
                out[Dim + c] = z[c];
                z[c] += v;
            }
        }
    });
}

template <int Dim>
void TransportCorrection<Dim>::pull(int k, std::span<float> direction) const {
    float* to[Dim];
    for (int a = 0; a < Dim; ++a) to[a] = direction.data() + layout_.displacement(k + 1, a);
    float* to_u = k > 0 ? direction.data() + layout_.level_set(k) : nullptr;
    kernels::pull<Dim>(layout_.nodes(), maps(k), buffers_[static_cast<std::size_t>(k)].data(), to, to_u);
}

template <int Dim>
void TransportCorrection<Dim>::take(std::span<const float> gradient) {
    for_indices(0, layout_.time_steps, [&](int k) { push(k, gradient); });
}

template <int Dim>
void TransportCorrection<Dim>::add_to(std::span<float> direction) {
    solve();
    for_indices(0, layout_.time_steps, [&](int k) { pull(k, direction); });
}

template class TransportCorrection<2>;
template class TransportCorrection<3>;

}  // namespace morphodesic

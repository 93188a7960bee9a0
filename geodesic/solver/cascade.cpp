#include "geodesic/solver/cascade.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geodesic/energy/heaviside.h"
#include "geodesic/grid/injectivity.h"
#include "geodesic/grid/node_loop.h"
#include "geodesic/grid/q1_element.h"
#include "geodesic/grid/transfer.h"

namespace morphodesic {

namespace {

template <int Dim>
std::array<double*, Dim> displacement_of(PathState<Dim>& path, int k) {
    std::array<double*, Dim> w;
    for (int a = 0; a < Dim; ++a) w[static_cast<std::size_t>(a)] = path.x.data() + path.layout.displacement(k, a);
    return w;
}

template <int Dim>
Point<Dim> displacement_at(const PathState<Dim>& path, int k, const std::type_identity_t<Point<Dim>>& x) {
    std::array<const double*, Dim> fields;
    for (int a = 0; a < Dim; ++a) fields[static_cast<std::size_t>(a)] = path.x.data() + path.layout.displacement(k, a);
    return q1::values<Dim, Dim>(path.layout.grid, fields, x);
}

/// Solves x + share w_k(x) = y to a thousandth of a cell by damped fixed point iteration; `x` is the start and the
/// result.
template <int Dim>
void invert_at(const PathState<Dim>& path, int k, double share, const std::type_identity_t<Point<Dim>>& y,
               std::type_identity_t<Point<Dim>>& x) {
    const double near_enough = 1e-3 * path.layout.grid.spacing();
    double last = 1e300;
    double damping = 1.0;
    for (int iteration = 0; iteration < 60; ++iteration) {
        const auto w = displacement_at(path, k, x);
        double change = 0.0;
        Point<Dim> step{};
        for (std::size_t a = 0; a < Dim; ++a) {
            step[a] = y[a] - share * w[a] - x[a];
            change = std::max(change, std::abs(step[a]));
        }
        if (change > last) damping = std::max(0.25, 0.5 * damping);
        last = change;
        for (std::size_t a = 0; a < Dim; ++a) x[a] = std::clamp(x[a] + damping * step[a], 0.0, 1.0);
        if (change < near_enough) break;
    }
}

}  // namespace

template <int Dim>
const double* shape_of(const PathState<Dim>& path, const LevelSet<Dim>& first, const LevelSet<Dim>& last, int k) {
    if (k == 0) return first.values.data();
    if (k == path.layout.time_steps) return last.values.data();
    return path.x.data() + path.layout.level_set(k);
}

template <int Dim>
int repair_folds(PathState<Dim>& path, double threshold) {
    int folds = 0;
    for (int k = 1; k <= path.layout.time_steps; ++k) {
        folds += repair_folds<Dim>(path.layout.grid, displacement_of(path, k), threshold);
    }
    return folds;
}

template <int Dim>
PathState<Dim> blended_path(const LevelSet<Dim>& first, const LevelSet<Dim>& last, int time_steps) {
    PathState<Dim> path{{first.grid, time_steps}, {}};
    path.x.assign(path.layout.size(), 0.0);
    for (int k = 1; k < time_steps; ++k) {
        const double t = static_cast<double>(k) / time_steps;
        double* u = path.x.data() + path.layout.level_set(k);
        for (std::size_t i = 0; i < first.values.size(); ++i) u[i] = (1 - t) * first.values[i] + t * last.values[i];
    }
    return path;
}

template <int Dim>
PathState<Dim> split_in_time(const PathState<Dim>& path, const LevelSet<Dim>& first, const LevelSet<Dim>& last,
                             int& folds) {
    const auto& grid = path.layout.grid;
    const int steps = path.layout.time_steps;
    PathState<Dim> fine{{grid, 2 * steps}, {}};
    fine.x.assign(fine.layout.size(), 0.0);
    for (int k = 1; k <= steps; ++k) {
        const double* before = shape_of(path, first, last, k - 1);
        const double* after = shape_of(path, first, last, k);
        if (k < steps)
            std::copy(after, after + grid.node_count(),
                      fine.x.begin() + static_cast<std::ptrdiff_t>(fine.layout.level_set(2 * k)));
        double* between = fine.x.data() + fine.layout.level_set(2 * k - 1);
        for_nodes(grid, [&](std::size_t i) {
            const auto y = grid.position(grid.node(i));
            Point<Dim> here{}, x = y;
            for (int a = 0; a < Dim; ++a)
                here[static_cast<std::size_t>(a)] = path.x[path.layout.displacement(k, a) + i];
            for (std::size_t a = 0; a < Dim; ++a) x[a] = y[a] - 0.5 * here[a];
            invert_at(path, k, 0.5, y, x);
            const auto w = displacement_at(path, k, x);
            Point<Dim> end{};
            for (std::size_t a = 0; a < Dim; ++a) end[a] = x[a] + w[a];
            // From both sides: carried along from the shape before, and pulled back from the shape after.
            between[i] = 0.5 * (q1::value(grid, before, x) + q1::value(grid, after, end));
            const bool fixed = grid.on_boundary(grid.node(i));
            for (int a = 0; a < Dim; ++a) {
                const auto c = static_cast<std::size_t>(a);
                fine.x[fine.layout.displacement(2 * k - 1, a) + i] = 0.5 * here[c];
                fine.x[fine.layout.displacement(2 * k, a) + i] = fixed ? 0.0 : 0.5 * w[c];
            }
        });
    }
    folds = repair_folds(fine);
    return fine;
}

template <int Dim>
PathState<Dim> prolong_in_space(const PathState<Dim>& path, int& folds) {
    PathState<Dim> fine{{path.layout.grid.finer(), path.layout.time_steps}, {}};
    fine.x.assign(fine.layout.size(), 0.0);
    const std::size_t coarse_nodes = path.layout.nodes(), fine_nodes = fine.layout.nodes();
    oneapi::tbb::this_task_arena::isolate([&] {
        oneapi::tbb::parallel_for(0, path.layout.field_count(), [&](int field) {
            const auto f = static_cast<std::size_t>(field);
            add_prolonged<Dim, double>(path.layout.grid, path.x.data() + f * coarse_nodes,
                                       fine.x.data() + f * fine_nodes);
        });
    });
    folds = repair_folds(fine);
    return fine;
}

template <int Dim>
void transport_shapes(PathState<Dim>& path, const LevelSet<Dim>& first, const LevelSet<Dim>& last, double eps) {
    const auto& grid = path.layout.grid;
    const int steps = path.layout.time_steps;
    // Where the point at a node of frame k came from in frame 0, and where it goes to in frame K: as displacements, so
    // that interpolating them again and again does not blur the shapes.
    std::vector<VectorField<Dim>> origin(static_cast<std::size_t>(steps), VectorField<Dim>(grid)), target = origin;
    const auto value_at = [&](const VectorField<Dim>& field, const Point<Dim>& x) {
        std::array<const double*, Dim> fields;
        for (std::size_t a = 0; a < Dim; ++a) fields[a] = field.components[a].data();
        return q1::values<Dim, Dim>(grid, fields, x);
    };
    for (int k = 1; k < steps; ++k) {
        const auto at = static_cast<std::size_t>(k);
        for_nodes(grid, [&](std::size_t i) {
            const auto y = grid.position(grid.node(i));
            const auto here = displacement_at(path, k, y);
            Point<Dim> x{};
            for (std::size_t a = 0; a < Dim; ++a) x[a] = y[a] - here[a];
            invert_at(path, k, 1.0, y, x);
            const auto before = value_at(origin[at - 1], x);
            for (std::size_t a = 0; a < Dim; ++a) origin[at].components[a][i] = x[a] - y[a] + before[a];
        });
    }
    for (int k = steps - 1; k >= 1; --k) {
        const auto at = static_cast<std::size_t>(k);
        for_nodes(grid, [&](std::size_t i) {
            auto z = grid.position(grid.node(i));
            for (int a = 0; a < Dim; ++a)
                z[static_cast<std::size_t>(a)] += path.x[path.layout.displacement(k + 1, a) + i];
            const auto after = k + 1 < steps ? value_at(target[at + 1], z) : Point<Dim>{};
            for (int a = 0; a < Dim; ++a) {
                const auto c = static_cast<std::size_t>(a);
                target[at].components[c][i] = path.x[path.layout.displacement(k + 1, a) + i] + after[c];
            }
        });
        const double t = static_cast<double>(k) / steps;
        double* u = path.x.data() + path.layout.level_set(k);
        for_nodes(grid, [&](std::size_t i) {
            auto from = grid.position(grid.node(i)), to = from;
            for (std::size_t a = 0; a < Dim; ++a) {
                from[a] += origin[at].components[a][i];
                to[a] += target[at].components[a][i];
            }
            const double w = (1 - t) * smooth_heaviside(q1::value(grid, first.values.data(), from), eps) +
                             t * smooth_heaviside(q1::value(grid, last.values.data(), to), eps);
            u[i] = eps * std::tan(std::numbers::pi * (w - 0.5));
        });
    }
}

#define MORPHODESIC_INSTANTIATE(Dim)                                                                              \
    template const double* shape_of<Dim>(const PathState<Dim>&, const LevelSet<Dim>&, const LevelSet<Dim>&, int); \
    template int repair_folds<Dim>(PathState<Dim>&, double);                                                      \
    template PathState<Dim> blended_path<Dim>(const LevelSet<Dim>&, const LevelSet<Dim>&, int);                   \
    template PathState<Dim> split_in_time<Dim>(const PathState<Dim>&, const LevelSet<Dim>&, const LevelSet<Dim>&, \
                                               int&);                                                             \
    template PathState<Dim> prolong_in_space<Dim>(const PathState<Dim>&, int&);                                   \
    template void transport_shapes<Dim>(PathState<Dim>&, const LevelSet<Dim>&, const LevelSet<Dim>&, double);
MORPHODESIC_INSTANTIATE(2)
MORPHODESIC_INSTANTIATE(3)
#undef MORPHODESIC_INSTANTIATE

}  // namespace morphodesic

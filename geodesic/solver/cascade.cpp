#include "geodesic/solver/cascade.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geodesic/grid/injectivity.h"
#include "geodesic/grid/node_loop.h"
#include "geodesic/grid/transfer.h"
#include "geodesic/kernels/heaviside_kernel.h"
#include "geodesic/solver/row_places.h"

namespace morphodesic {

namespace {

/// Solves x + share w_k(x) = y for the places y of a row to a thousandth of a cell, from y - share w_k(y) on.
/// @param row  first node of the row; y are its nodes
template <int Dim>
RowPlaces<Dim> taken_back(const PathState<Dim>& path, int k, double share, std::size_t row, RowPlaces<Dim>& y) {
    const auto w = path.layout.displacements(path.x.data(), k);
    const int per_unit = path.layout.grid.cells_per_unit();
    RowPlaces<Dim> x = y;
    for (std::size_t a = 0; a < Dim; ++a) {
        for (std::size_t i = 0; i < x.count(); ++i) x[a][i] -= share * per_unit * w[a][row + i];
    }
    x.solve(y, w, per_unit, share, 1e-3, 60);
    return x;
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
        folds += repair_folds<Dim>(path.layout.grid, path.layout.displacements(path.x.data(), k), threshold);
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
        const auto w = path.layout.displacements(path.x.data(), k);
        for_rows(grid, [&](std::size_t row) {
            RowPlaces<Dim> y(grid, row), x = taken_back(path, k, 0.5, row, y), end = x;
            for (std::size_t a = 0; a < Dim; ++a) {
                const double* moved = x.sample(w[a]);
                double* half = fine.x.data() + fine.layout.displacement(2 * k - 1, static_cast<int>(a)) + row;
                double* rest = fine.x.data() + fine.layout.displacement(2 * k, static_cast<int>(a)) + row;
                for (std::size_t i = 0; i < x.count(); ++i) {
                    half[i] = 0.5 * w[a][row + i];
                    rest[i] = 0.5 * moved[i];
                    end[a][i] += moved[i] * grid.cells_per_unit();
                }
            }
            // From both sides: carried along from the shape before, and pulled back from the shape after.
            const double *carried = x.sample(before), *pulled = end.sample(after);
            for (std::size_t i = 0; i < x.count(); ++i) between[row + i] = 0.5 * (carried[i] + pulled[i]);
        });
        for (double* field : fine.layout.displacements(fine.x.data(), 2 * k)) clear_boundary(grid, field);
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
int smooth_deformations(PathState<Dim>& path) {
    const auto& grid = path.layout.grid;
    for (int k = 1; k <= path.layout.time_steps; ++k) {
        for (double* w : path.layout.displacements(path.x.data(), k)) {
            ScalarField<Dim> field(grid);
            std::copy_n(w, field.values.size(), field.values.begin());
            const auto coarse = restricted(field, grid.level() - 1);
            std::fill_n(w, field.values.size(), 0.0);
            add_prolonged<Dim, double>(coarse.grid, coarse.values.data(), w);
        }
    }
    return repair_folds(path);
}

template <int Dim>
void transport_shapes(PathState<Dim>& path, const LevelSet<Dim>& first, const LevelSet<Dim>& last, double eps) {
    const auto& grid = path.layout.grid;
    const int steps = path.layout.time_steps;
    // Where the point at a node of frame k came from in frame 0, and where it goes to in frame K: as displacements, so
    // that interpolating them again and again does not blur the shapes.
    std::vector<VectorField<Dim>> origin(static_cast<std::size_t>(steps), VectorField<Dim>(grid)), target = origin;
    const int per_unit = grid.cells_per_unit();
    for (int k = 1; k < steps; ++k) {
        const auto at = static_cast<std::size_t>(k);
        for_rows(grid, [&](std::size_t row) {
            RowPlaces<Dim> y(grid, row), x = taken_back(path, k, 1.0, row, y);
            for (std::size_t a = 0; a < Dim; ++a) {
                const double* before = x.sample(origin[at - 1].components[a].data());
                double* out = origin[at].components[a].data() + row;
                for (std::size_t i = 0; i < x.count(); ++i) out[i] = (x[a][i] - y[a][i]) / per_unit + before[i];
            }
        });
    }
    for (int k = steps - 1; k >= 1; --k) {
        const auto at = static_cast<std::size_t>(k);
        const auto w = path.layout.displacements(path.x.data(), k + 1);
        double* u = path.x.data() + path.layout.level_set(k);
        const double t = static_cast<double>(k) / steps;
        for_rows(grid, [&](std::size_t row) {
            RowPlaces<Dim> z(grid, row), from = z, to = z;
            for (std::size_t a = 0; a < Dim; ++a) {
                for (std::size_t i = 0; i < z.count(); ++i) z[a][i] += w[a][row + i] * per_unit;
            }
            for (std::size_t a = 0; a < Dim; ++a) {
                const double* after = k + 1 < steps ? z.sample(target[at + 1].components[a].data()) : nullptr;
                double* out = target[at].components[a].data() + row;
                for (std::size_t i = 0; i < z.count(); ++i) {
                    out[i] = w[a][row + i] + (after ? after[i] : 0.0);
                    from[a][i] += origin[at].components[a][row + i] * per_unit;
                    to[a][i] += out[i] * per_unit;
                }
            }
            std::vector<double> carried(z.count()), pulled(z.count());
            kernels::smooth_heaviside({from.sample(first.values.data()), z.count()}, eps, carried);
            kernels::smooth_heaviside({to.sample(last.values.data()), z.count()}, eps, pulled);
            for (std::size_t i = 0; i < z.count(); ++i) {
                const double mean = (1 - t) * carried[i] + t * pulled[i];
                u[row + i] = eps * std::tan(std::numbers::pi * (mean - 0.5));
            }
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
    template int smooth_deformations<Dim>(PathState<Dim>&);                                                       \
    template void transport_shapes<Dim>(PathState<Dim>&, const LevelSet<Dim>&, const LevelSet<Dim>&, double);
MORPHODESIC_INSTANTIATE(2)
MORPHODESIC_INSTANTIATE(3)
#undef MORPHODESIC_INSTANTIATE

}  // namespace morphodesic

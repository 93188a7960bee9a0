#include "geodesic/solver/rigid_motion.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cmath>

namespace morphodesic {

namespace {

/// Catmull-Rom weights of the four nodes around a point at `t` between the second and the third.
std::array<double, 4> cubic_weights(double t) {
    const double t2 = t * t, t3 = t2 * t;
    return {0.5 * (-t3 + 2 * t2 - t), 0.5 * (3 * t3 - 5 * t2 + 2), 0.5 * (-3 * t3 + 4 * t2 + t), 0.5 * (t3 - t2)};
}

template <int Dim>
double cubic_value(const LevelSet<Dim>& u, const Point<Dim>& x) {
    const int cells = u.grid.cells_per_axis();
    std::array<std::array<double, 4>, Dim> weight;
    std::array<std::array<int, 4>, Dim> index;
    double beyond = 0.0;
    for (std::size_t a = 0; a < Dim; ++a) {
        const double inside = std::clamp(x[a], 0.0, 1.0);
        beyond += (x[a] - inside) * (x[a] - inside);
        const double y = inside * cells;
        const int cell = std::min(static_cast<int>(y), cells - 1);
        weight[a] = cubic_weights(y - cell);
        for (int j = 0; j < 4; ++j) index[a][static_cast<std::size_t>(j)] = std::clamp(cell + j - 1, 0, cells);
    }
    double sum = 0.0;
    for (std::size_t c = 0; c < (Dim == 2 ? 16U : 64U); ++c) {
        typename DyadicGrid<Dim>::Index i{};
        double w = 1.0;
        std::size_t rest = c;
        for (std::size_t a = 0; a < Dim; ++a, rest /= 4) {
            w *= weight[a][rest % 4];
            i[a] = index[a][rest % 4];
        }
        sum += w * u.values[u.grid.index(i)];
    }
    return sum - std::sqrt(beyond);
}

}  // namespace

template <int Dim>
LevelSet<Dim> moved(const LevelSet<Dim>& u, const RigidMotion<Dim>& motion, int level) {
    LevelSet<Dim> result{DyadicGrid<Dim>(level)};
    const auto back = motion.inverse();
    const auto n = static_cast<std::size_t>(result.grid.nodes_per_axis());
    const std::size_t rows = result.values.size() / n;
    oneapi::tbb::this_task_arena::isolate([&] {
        oneapi::tbb::parallel_for(std::size_t{0}, rows, [&](std::size_t row) {
            for (std::size_t i = row * n; i < (row + 1) * n; ++i) {
                result.values[i] = cubic_value<Dim>(u, back(result.grid.position(result.grid.node(i))));
            }
        });
    });
    return result;
}

template LevelSet<2> moved<2>(const LevelSet<2>&, const RigidMotion<2>&, int);
template LevelSet<3> moved<3>(const LevelSet<3>&, const RigidMotion<3>&, int);

}  // namespace morphodesic

#include "geodesic/solver/path_interpolation.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "geodesic/grid/q1_element.h"

namespace morphodesic {

namespace {

template <int Dim>
Point<Dim> displacement_at(const Deformation<Dim>& phi, const std::type_identity_t<Point<Dim>>& x) {
    Point<Dim> w{};
    for (std::size_t a = 0; a < Dim; ++a) w[a] = q1::value(phi.grid(), phi.displacement.components[a].data(), x);
    return w;
}

template <int Dim, class Body>
void for_nodes(const DyadicGrid<Dim>& grid, const Body& body) {
    const auto n = static_cast<std::size_t>(grid.nodes_per_axis());
    oneapi::tbb::this_task_arena::isolate([&] {
        oneapi::tbb::parallel_for(std::size_t{0}, grid.node_count() / n, [&](std::size_t row) {
            for (std::size_t i = row * n; i < (row + 1) * n; ++i) body(i);
        });
    });
}

/// Step k (from 0) that holds t, and the share of it that has passed, in (0, 1] (or 0 at t = 0).
struct Moment {
    std::size_t step;
    double share;
};

template <int Dim>
Moment moment(const GeodesicResult<Dim>& path, double t) {
    if (!(t >= 0.0 && t <= 1.0)) throw std::invalid_argument("the time on a path must be from 0 to 1");
    if (path.deformations.empty() || path.shapes.size() != path.deformations.size() + 1) {
        throw std::invalid_argument("the path has no steps");
    }
    const auto steps = static_cast<double>(path.deformations.size());
    const double scaled = t * steps, nearest = std::round(scaled);
    // Times that are multiples of the step up to rounding are taken as such.
    const double at = std::abs(scaled - nearest) < 1e-9 * steps ? nearest : scaled;
    const double step = std::max(std::ceil(at) - 1.0, 0.0);
    return {static_cast<std::size_t>(step), at - step};
}

}  // namespace

template <int Dim>
Point<Dim> inverse_at(const Deformation<Dim>& phi, const std::type_identity_t<Point<Dim>>& y, double share) {
    // Damped fixed point iteration: with the gradients of one step it contracts; where it does not, damping helps.
    Point<Dim> x = y;
    double last = 1e300, damping = 1.0;
    for (int iteration = 0; iteration < 100; ++iteration) {
        const Point<Dim> w = displacement_at(phi, x);
        double change = 0.0;
        Point<Dim> step{};
        for (std::size_t a = 0; a < Dim; ++a) {
            step[a] = y[a] - share * w[a] - x[a];
            change = std::max(change, std::abs(step[a]));
        }
        if (change > last) damping = std::max(0.1, 0.5 * damping);
        last = change;
        for (std::size_t a = 0; a < Dim; ++a) x[a] = std::clamp(x[a] + damping * step[a], 0.0, 1.0);
        if (change < 1e-9) break;
    }
    return x;
}

template <int Dim>
Deformation<Dim> deformation_at(const GeodesicResult<Dim>& path, double t) {
    const Moment now = moment(path, t);
    const DyadicGrid<Dim>& grid = path.deformations.front().grid();
    Deformation<Dim> result(grid);
    for_nodes(grid, [&](std::size_t i) {
        const Point<Dim> start = grid.position(grid.node(i));
        Point<Dim> x = start;
        for (std::size_t k = 0; k <= now.step; ++k) {
            const Point<Dim> w = displacement_at(path.deformations[k], x);
            const double share = k == now.step ? now.share : 1.0;
            for (std::size_t a = 0; a < Dim; ++a) x[a] = std::clamp(x[a] + share * w[a], 0.0, 1.0);
        }
        for (std::size_t a = 0; a < Dim; ++a) result.displacement.components[a][i] = x[a] - start[a];
    });
    return result;
}

template <int Dim>
LevelSet<Dim> shape_at(const GeodesicResult<Dim>& path, double t) {
    const Moment now = moment(path, t);
    if (now.share == 0.0) return path.shapes.front();
    if (now.share == 1.0) return path.shapes[now.step + 1];
    const LevelSet<Dim>& before = path.shapes[now.step];
    const Deformation<Dim>& phi = path.deformations[now.step];
    LevelSet<Dim> result(before.grid);
    for_nodes(before.grid, [&](std::size_t i) {
        const Point<Dim> x = inverse_at(phi, before.grid.position(before.grid.node(i)), now.share);
        result.values[i] = q1::value(before.grid, before.values.data(), x);
    });
    return result;
}

template Point<2> inverse_at<2>(const Deformation<2>&, const Point<2>&, double);
template Point<3> inverse_at<3>(const Deformation<3>&, const Point<3>&, double);
template Deformation<2> deformation_at<2>(const GeodesicResult<2>&, double);
template Deformation<3> deformation_at<3>(const GeodesicResult<3>&, double);
template LevelSet<2> shape_at<2>(const GeodesicResult<2>&, double);
template LevelSet<3> shape_at<3>(const GeodesicResult<3>&, double);

}  // namespace morphodesic

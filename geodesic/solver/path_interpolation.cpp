#include "geodesic/solver/path_interpolation.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "geodesic/grid/node_loop.h"
#include "geodesic/grid/q1_element.h"

namespace morphodesic {

namespace {

template <int Dim>
Point<Dim> displacement_at(const Deformation<Dim>& phi, const std::type_identity_t<Point<Dim>>& x) {
    Point<Dim> w{};
    for (std::size_t a = 0; a < Dim; ++a) w[a] = q1::value(phi.grid(), phi.displacement.components[a].data(), x);
    return w;
}

/// Solves (I + share Dw(x)) step = r with the gradient of the cell at x; r itself where that is singular.
template <int Dim>
Point<Dim> newton_step(const Deformation<Dim>& phi, const std::type_identity_t<Point<Dim>>& x, double share,
                       const std::type_identity_t<Point<Dim>>& r) {
    const auto& grid = phi.grid();
    const auto at = q1::locate(grid, x);
    const auto offsets = q1::corner_offsets(grid);
    double m[Dim][Dim] = {};
    for (int i = 0; i < Dim; ++i) {
        const double* w = phi.displacement.components[static_cast<std::size_t>(i)].data();
        for (int j = 0; j < Dim; ++j) {
            for (int c = 0; c < (1 << Dim); ++c) {
                m[i][j] += share * q1::shape_slope<Dim>(c, at.fraction, j) * grid.cells_per_unit() *
                           w[at.node + offsets[static_cast<std::size_t>(c)]];
            }
        }
        m[i][i] += 1.0;
    }
    Point<Dim> b = r;
    for (int i = 0; i < Dim; ++i) {  // Gauss elimination with the largest pivot of the column
        int pivot = i;
        for (int k = i + 1; k < Dim; ++k) pivot = std::abs(m[k][i]) > std::abs(m[pivot][i]) ? k : pivot;
        if (std::abs(m[pivot][i]) < 1e-8) return r;
        std::swap(m[i], m[pivot]);
        std::swap(b[static_cast<std::size_t>(i)], b[static_cast<std::size_t>(pivot)]);
        for (int k = i + 1; k < Dim; ++k) {
            const double f = m[k][i] / m[i][i];
            for (int j = i; j < Dim; ++j) m[k][j] -= f * m[i][j];
            b[static_cast<std::size_t>(k)] -= f * b[static_cast<std::size_t>(i)];
        }
    }
    for (int i = Dim - 1; i >= 0; --i) {
        double sum = b[static_cast<std::size_t>(i)];
        for (int j = i + 1; j < Dim; ++j) sum -= m[i][j] * b[static_cast<std::size_t>(j)];
        b[static_cast<std::size_t>(i)] = sum / m[i][i];
    }
    return b;
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
    const auto residual = [&](const Point<Dim>& at) {
        const Point<Dim> w = displacement_at(phi, at);
        Point<Dim> r{};
        for (std::size_t a = 0; a < Dim; ++a) r[a] = y[a] - share * w[a] - at[a];
        return r;
    };
    const auto size = [](const Point<Dim>& r) {
        double sum = 0.0;
        for (const double c : r) sum += c * c;
        return sum;
    };
    // Fixed point iteration, damped so that the residual falls; where gradients are large it crawls, and Newton's
    // method with the gradient of the cell takes over.
    Point<Dim> x = y, r = residual(x);
    for (int iteration = 0; iteration < 200 && size(r) > 1e-18; ++iteration) {
        Point<Dim> step = r;
        if (iteration >= 12) step = newton_step(phi, x, share, r);
        bool lower = false;
        for (double length = 1.0; length > 1e-3 && !lower; length *= 0.5) {
            Point<Dim> next{};
            for (std::size_t a = 0; a < Dim; ++a) next[a] = std::clamp(x[a] + length * step[a], 0.0, 1.0);
            const Point<Dim> left = residual(next);
            if (size(left) < size(r)) {
                x = next;
                r = left;
                lower = true;
            }
        }
        if (!lower && iteration >= 12) break;
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

template <int Dim>
GeodesicResult<Dim> reversed(GeodesicResult<Dim> path) {
    for (Deformation<Dim>& phi : path.deformations) {
        const auto& grid = phi.grid();
        Deformation<Dim> back(grid);
        for_nodes(grid, [&](std::size_t i) {
            const Point<Dim> y = grid.position(grid.node(i)), x = inverse_at(phi, y);
            for (std::size_t a = 0; a < Dim; ++a) back.displacement.components[a][i] = x[a] - y[a];
        });
        phi = std::move(back);
    }
    std::reverse(path.deformations.begin(), path.deformations.end());
    std::reverse(path.shapes.begin(), path.shapes.end());
    std::reverse(path.deformation_energy.begin(), path.deformation_energy.end());
    std::reverse(path.mismatch_energy.begin(), path.mismatch_energy.end());
    path.frame = path.frame.after(path.motion);
    path.motion = path.motion.inverse();
    return path;
}

template Point<2> inverse_at<2>(const Deformation<2>&, const Point<2>&, double);
template Point<3> inverse_at<3>(const Deformation<3>&, const Point<3>&, double);
template Deformation<2> deformation_at<2>(const GeodesicResult<2>&, double);
template Deformation<3> deformation_at<3>(const GeodesicResult<3>&, double);
template LevelSet<2> shape_at<2>(const GeodesicResult<2>&, double);
template LevelSet<3> shape_at<3>(const GeodesicResult<3>&, double);
template GeodesicResult<2> reversed<2>(GeodesicResult<2>);
template GeodesicResult<3> reversed<3>(GeodesicResult<3>);

}  // namespace morphodesic

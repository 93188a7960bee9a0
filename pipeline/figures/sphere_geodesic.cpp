#include "pipeline/figures/sphere_geodesic.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace morphodesic::pipeline {
namespace {

double dot(const Point<3>& a, const Point<3>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double square(const Point<2>& a, const Point<2>& b) {
    return (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]);
}

/// Squared chord of two points of the plane on the sphere.
double chord(const Point<2>& a, const Point<2>& b) {
    return 4 * square(a, b) / ((1 + a[0] * a[0] + a[1] * a[1]) * (1 + b[0] * b[0] + b[1] * b[1]));
}

/// Adds gradient and Hessian in x of chord(x, b) = 4 n / (d c), n = |x - b|^2, d = 1 + |x|^2, c = 1 + |b|^2.
void add_derivatives(const Point<2>& x, const Point<2>& b, Point<2>& gradient, double hessian[2][2]) {
    const double n = square(x, b), d = 1 + x[0] * x[0] + x[1] * x[1], c = 1 + b[0] * b[0] + b[1] * b[1];
    const double s = 4 / c;
    Point<2> dn{}, dd{};
    for (std::size_t i = 0; i < 2; ++i) {
        dn[i] = 2 * (x[i] - b[i]);
        dd[i] = 2 * x[i];
        gradient[i] += s * (dn[i] / d - n * dd[i] / (d * d));
    }
    for (std::size_t i = 0; i < 2; ++i) {
        for (std::size_t j = 0; j < 2; ++j) {
            const double diagonal = i == j ? 2.0 : 0.0;
            hessian[i][j] += s * (diagonal / d - (dn[i] * dd[j] + dd[i] * dn[j]) / (d * d) - n * diagonal / (d * d) +
                                  2 * n * dd[i] * dd[j] / (d * d * d));
        }
    }
}

/// One elementary relaxation: a Newton step for the vertex between two fixed neighbours, halved until the sum of the
/// squared distances is lower.
Point<2> relaxed(const Point<2>& before, const Point<2>& x, const Point<2>& after) {
    Point<2> gradient{};
    double hessian[2][2] = {};
    add_derivatives(x, before, gradient, hessian);
    add_derivatives(x, after, gradient, hessian);
    const double det = hessian[0][0] * hessian[1][1] - hessian[0][1] * hessian[1][0];
    Point<2> step{};
    if (det > 0 && hessian[0][0] > 0) {
        step = {-(hessian[1][1] * gradient[0] - hessian[0][1] * gradient[1]) / det,
                -(hessian[0][0] * gradient[1] - hessian[1][0] * gradient[0]) / det};
    } else {  // not convex here: downhill, as far as the metric of the sphere says
        const double d = 1 + x[0] * x[0] + x[1] * x[1];
        step = {-gradient[0] * d * d / 16, -gradient[1] * d * d / 16};
    }
    const double value = chord(before, x) + chord(x, after);
    for (int halving = 0; halving < 40; ++halving) {
        const Point<2> candidate{x[0] + step[0], x[1] + step[1]};
        if (chord(before, candidate) + chord(candidate, after) < value) return candidate;
        step = {0.5 * step[0], 0.5 * step[1]};
    }
    return x;
}

}  // namespace

StereographicMap::StereographicMap(const GeographicPosition& centre) {
    up_ = sphere(centre);
    const double longitude = centre.longitude * std::numbers::pi / 180;
    east_ = {-std::sin(longitude), std::cos(longitude), 0};
    north_ = {up_[1] * east_[2] - up_[2] * east_[1], up_[2] * east_[0] - up_[0] * east_[2],
              up_[0] * east_[1] - up_[1] * east_[0]};
}

Point<3> StereographicMap::sphere(const GeographicPosition& at) {
    const double latitude = at.latitude * std::numbers::pi / 180, longitude = at.longitude * std::numbers::pi / 180;
    return {std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude), std::sin(latitude)};
}

Point<3> StereographicMap::frame(const Point<3>& x) const {
    return {dot(x, east_), dot(x, north_), dot(x, up_)};
}

Point<2> StereographicMap::to_plane(const Point<3>& x) const {
    const Point<3> f = frame(x);
    return {f[0] / (1 + f[2]), f[1] / (1 + f[2])};
}

Point<3> StereographicMap::to_sphere(const Point<2>& p) const {
    const double s = p[0] * p[0] + p[1] * p[1];
    const double e = 2 * p[0] / (1 + s), n = 2 * p[1] / (1 + s), u = (1 - s) / (1 + s);
    Point<3> x{};
    for (std::size_t a = 0; a < 3; ++a) x[a] = e * east_[a] + n * north_[a] + u * up_[a];
    return x;
}

double great_circle_distance(const Point<3>& a, const Point<3>& b) {
    const Point<3> c{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    return std::atan2(std::sqrt(dot(c, c)), dot(a, b));
}

Point<3> great_circle_point(const Point<3>& a, const Point<3>& b, double t) {
    const double angle = great_circle_distance(a, b);
    const double wa = std::sin((1 - t) * angle) / std::sin(angle), wb = std::sin(t * angle) / std::sin(angle);
    return {wa * a[0] + wb * b[0], wa * a[1] + wb * b[1], wa * a[2] + wb * b[2]};
}

SpherePath relax(const StereographicMap& map, std::vector<Point<2>> points, const RelaxationStop& stop) {
    SpherePath path;
    const std::size_t steps = points.size() - 1;
    std::vector<Point<3>> exact;
    const Point<3> a = map.to_sphere(points.front()), b = map.to_sphere(points.back());
    for (std::size_t k = 0; k <= steps; ++k) {
        exact.push_back(great_circle_point(a, b, static_cast<double>(k) / static_cast<double>(steps)));
    }
    const auto deviation = [&] {
        double largest = 0.0;
        for (std::size_t k = 1; k < steps; ++k) {
            largest = std::max(largest, great_circle_distance(map.to_sphere(points[k]), exact[k]));
        }
        return largest;
    };
    const bool by_distance = stop.measure == RelaxationStop::Measure::distance;
    // At least two sweeps, which take the corners away that a refined path has.
    double open = 2 * stop.tolerance;
    for (int sweep = 0; steps > 1 && (sweep < 2 || open > stop.tolerance); ++sweep) {
        double moved = 0.0;
        for (std::size_t k = 1; k < steps; ++k) {
            const Point<2> x = relaxed(points[k - 1], points[k], points[k + 1]);
            moved = std::max(moved, std::sqrt(chord(points[k], x)));
            points[k] = x;
            ++path.relaxation_steps;
        }
        open = by_distance ? deviation() : moved;
    }
    for (std::size_t k = 1; k <= steps; ++k) {
        path.energy += static_cast<double>(steps) * chord(points[k - 1], points[k]);
        path.length += great_circle_distance(map.to_sphere(points[k - 1]), map.to_sphere(points[k]));
    }
    path.largest_deviation = deviation();
    path.points = std::move(points);
    return path;
}

SpherePath single_level_geodesic(const StereographicMap& map, const Point<2>& a, const Point<2>& b, int steps,
                                 const RelaxationStop& stop) {
    std::vector<Point<2>> points;
    for (int k = 0; k <= steps; ++k) {
        const double t = static_cast<double>(k) / steps;
        points.push_back({(1 - t) * a[0] + t * b[0], (1 - t) * a[1] + t * b[1]});
    }
    return relax(map, std::move(points), stop);
}

std::vector<SpherePath> cascadic_geodesics(const StereographicMap& map, const Point<2>& a, const Point<2>& b, int steps,
                                           const RelaxationStop& stop) {
    std::vector<SpherePath> levels{relax(map, {a, b}, stop)};
    while (static_cast<int>(levels.back().points.size()) - 1 < steps) {
        const auto& coarse = levels.back().points;
        std::vector<Point<2>> fine;
        for (std::size_t k = 0; k + 1 < coarse.size(); ++k) {
            fine.push_back(coarse[k]);
            fine.push_back({0.5 * (coarse[k][0] + coarse[k + 1][0]), 0.5 * (coarse[k][1] + coarse[k + 1][1])});
        }
        fine.push_back(coarse.back());
        RelaxationStop here = stop;
        if (stop.measure == RelaxationStop::Measure::distance) {
            here.tolerance *= static_cast<double>(fine.size() - 1) / steps;
        }
        levels.push_back(relax(map, std::move(fine), here));
    }
    return levels;
}

}  // namespace morphodesic::pipeline

#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <span>
#include <vector>

#include "geodesic/energy/path_energy.h"
#include "geodesic/grid/fields.h"

namespace morphodesic::tests {

template <int Dim>
LevelSet<Dim> ball(int level, double radius, Point<Dim> centre) {
    LevelSet<Dim> u{DyadicGrid<Dim>(level)};
    for (std::size_t i = 0; i < u.values.size(); ++i) {
        const auto x = u.grid.position(u.grid.node(i));
        double square = 0.0;
        for (std::size_t a = 0; a < Dim; ++a) square += (x[a] - centre[a]) * (x[a] - centre[a]);
        u.values[i] = radius - std::sqrt(square);
    }
    return u;
}

template <int Dim>
LevelSet<Dim> ball(int level, double radius) {
    Point<Dim> centre;
    centre.fill(0.5);
    return ball<Dim>(level, radius, centre);
}

/// Box with half widths, turned in the plane of the first two axes about its centre.
template <int Dim>
LevelSet<Dim> turned_box(int level, Point<Dim> half, Point<Dim> centre, double angle) {
    LevelSet<Dim> u{DyadicGrid<Dim>(level)};
    for (std::size_t i = 0; i < u.values.size(); ++i) {
        auto x = u.grid.position(u.grid.node(i));
        for (std::size_t a = 0; a < Dim; ++a) x[a] -= centre[a];
        const double x0 = std::cos(angle) * x[0] + std::sin(angle) * x[1];
        x[1] = -std::sin(angle) * x[0] + std::cos(angle) * x[1];
        x[0] = x0;
        double outside = 0.0, inside = -1e300;
        for (std::size_t a = 0; a < Dim; ++a) {
            const double d = std::abs(x[a]) - half[a];
            outside += std::max(d, 0.0) * std::max(d, 0.0);
            inside = std::max(inside, d);
        }
        u.values[i] = -(std::sqrt(outside) + std::min(inside, 0.0));
    }
    return u;
}

/// Both shapes together.
template <int Dim>
LevelSet<Dim> united(LevelSet<Dim> a, const LevelSet<Dim>& b) {
    for (std::size_t i = 0; i < a.values.size(); ++i) a.values[i] = std::max(a.values[i], b.values[i]);
    return a;
}

/// A smooth vector field that vanishes on the boundary of the cube, component `axis`, wave `mode`.
template <int Dim>
double smooth_wave(const Point<Dim>& x, int axis, int mode) {
    double value = 1.0;
    for (std::size_t a = 0; a < Dim; ++a) value *= std::sin(std::numbers::pi * x[a]);
    return value * std::cos(2.0 * mode * x[0] + 1.3 * axis + 3.0 * x[Dim - 1]);
}

/// A path between two overlapping balls with smooth deformations and smooth shapes between, and a smooth direction.
template <int Dim>
struct PathProblem {
    PathEnergy<Dim> energy;
    std::vector<double> x, direction;

    PathProblem(int level, int steps, const GeodesicOptions& options, const ScalarField<Dim>& mask = {})
        : energy(ball<Dim>(level, 0.2), shifted_ball(level), steps, options, mask) {
        const auto& layout = energy.layout();
        x.assign(layout.size(), 0.0);
        direction.assign(layout.size(), 0.0);
        for (std::size_t i = 0; i < layout.nodes(); ++i) {
            const auto at = layout.grid.position(layout.grid.node(i));
            for (int k = 1; k <= steps; ++k) {
                for (int a = 0; a < Dim; ++a) {
                    x[layout.displacement(k, a) + i] = 0.03 * smooth_wave<Dim>(at, a, k);
                    direction[layout.displacement(k, a) + i] = smooth_wave<Dim>(at, a + 1, k + 1);
                }
                if (k == steps) continue;
                const double t = static_cast<double>(k) / steps;
                x[layout.level_set(k) + i] = (1 - t) * energy.first().values[i] + t * energy.last().values[i];
                direction[layout.level_set(k) + i] = smooth_wave<Dim>(at, 0, k + 2);
            }
        }
    }

    static LevelSet<Dim> shifted_ball(int level) {
        Point<Dim> centre;
        centre.fill(0.53);
        return ball<Dim>(level, 0.23, centre);
    }
};

/// Mean order of |E(x + t d) - E(x) - t <g, d>| over four halvings of t: about 2 for the right gradient.
inline double taylor_order(const std::function<double(const std::vector<double>&)>& energy,
                           const std::vector<double>& gradient, const std::vector<double>& x,
                           const std::vector<double>& direction, double t) {
    double slope = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) slope += gradient[i] * direction[i];
    const double base = energy(x);
    const auto remainder = [&](double s) {
        std::vector<double> moved(x);
        for (std::size_t i = 0; i < x.size(); ++i) moved[i] += s * direction[i];
        return std::abs(energy(moved) - base - s * slope);
    };
    return std::log2(remainder(t) / remainder(t / 16.0)) / 4.0;
}

}  // namespace morphodesic::tests

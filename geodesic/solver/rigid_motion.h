#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "geodesic/grid/fields.h"

namespace morphodesic {

/// x -> R (x - c) + c + t with c = (1/2, ..., 1/2), R a rotation (row-major), t a translation. No reflections.
template <int Dim>
struct RigidMotion {
    std::array<double, Dim* Dim> rotation = identity();
    Point<Dim> translation{};

    static constexpr std::array<double, Dim * Dim> identity() {
        std::array<double, Dim * Dim> r{};
        for (int a = 0; a < Dim; ++a) r[a * Dim + a] = 1.0;
        return r;
    }
    [[nodiscard]] Point<Dim> operator()(const Point<Dim>& x) const {
        Point<Dim> y{};
        for (int a = 0; a < Dim; ++a) {
            y[a] = 0.5 + translation[a];
            for (int b = 0; b < Dim; ++b) y[a] += rotation[a * Dim + b] * (x[b] - 0.5);
        }
        return y;
    }
    [[nodiscard]] RigidMotion inverse() const {
        RigidMotion m;
        for (int a = 0; a < Dim; ++a) {
            for (int b = 0; b < Dim; ++b) m.rotation[a * Dim + b] = rotation[b * Dim + a];
        }
        for (int a = 0; a < Dim; ++a) {
            for (int b = 0; b < Dim; ++b) m.translation[a] -= m.rotation[a * Dim + b] * translation[b];
        }
        return m;
    }
    [[nodiscard]] bool is_identity() const { return rotation == identity() && translation == Point<Dim>{}; }
    /// x -> this(first(x)).
    [[nodiscard]] RigidMotion after(const RigidMotion& first) const {
        RigidMotion m;
        m.translation = translation;
        for (int a = 0; a < Dim; ++a) {
            for (int b = 0; b < Dim; ++b) {
                double& entry = m.rotation[a * Dim + b] = 0.0;
                for (int c = 0; c < Dim; ++c) entry += rotation[a * Dim + c] * first.rotation[c * Dim + b];
                m.translation[a] += rotation[a * Dim + b] * first.translation[b];
            }
        }
        return m;
    }
};

/// Turn by an angle, counter-clockwise, about the middle of the square.
inline RigidMotion<2> turn_by(double angle) {
    return {{std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle)}, {}};
}

/// Whether a point lies in the cube; motions may take it out.
template <std::size_t Dim>
bool in_unit_cube(const std::array<double, Dim>& x) {
    return std::all_of(x.begin(), x.end(), [](double c) { return c >= 0.0 && c <= 1.0; });
}

/// The shape moved by a rigid motion, u o motion^-1, sampled on a grid of the given level with cubic interpolation.
/// Beyond the cube u is continued as a distance.
template <int Dim>
LevelSet<Dim> moved(const LevelSet<Dim>& u, const RigidMotion<Dim>& motion, int level);

}  // namespace morphodesic

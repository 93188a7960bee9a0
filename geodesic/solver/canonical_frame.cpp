#include "geodesic/solver/canonical_frame.h"

#include <algorithm>
#include <cmath>

#include "geodesic/grid/contour.h"
#include "geodesic/grid/node_loop.h"
#include "geodesic/grid/q1_element.h"

namespace morphodesic {

namespace {

/// Contours whose fourth harmonic is a smaller share of their length have no direction. (A disk of radius
/// 1/5 on a grid of level 6 has a thousandth; small ones on coarse grids are turned at random, which does not matter.)
constexpr double least_harmonic = 0.01;

/// Displacements turn with the points they belong to.
template <int Dim>
Deformation<Dim> turned(const Deformation<Dim>& phi, const RigidMotion<Dim>& motion) {
    const auto& grid = phi.displacement.grid;
    Deformation<Dim> result(grid);
    const auto back = motion.inverse();
    std::array<const double*, Dim> fields;
    for (std::size_t a = 0; a < Dim; ++a) fields[a] = phi.displacement.components[a].data();
    for_nodes(grid, [&](std::size_t i) {
        if (grid.on_boundary(grid.node(i))) return;
        const auto x = back(grid.position(grid.node(i)));
        if (!in_unit_cube(x)) return;
        const auto w = q1::values<Dim, Dim>(grid, fields, x);
        for (std::size_t a = 0; a < Dim; ++a) {
            for (std::size_t b = 0; b < Dim; ++b) {
                result.displacement.components[a][i] += motion.rotation[a * Dim + b] * w[b];
            }
        }
    });
    return result;
}

}  // namespace

template <>
RigidMotion<2> canonical_frame<2>(const LevelSet<2>& u) {
    double cosine = 0.0, sine = 0.0, length = 0.0, area = 0.0;
    Point<2> moment{};  // area times centroid, seen from the middle of the square
    const auto loops = contour(u);
    for (const ContourLoop& loop : loops) {
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const auto &p = loop[i], &q = loop[(i + 1) % loop.size()];
            const double dx = q[0] - p[0], dy = q[1] - p[1], edge = std::hypot(dx, dy);
            const double angle = std::atan2(dy, dx);
            cosine += edge * std::cos(4 * angle);
            sine += edge * std::sin(4 * angle);
            length += edge;
            const double triangle = 0.5 * ((p[0] - 0.5) * (q[1] - 0.5) - (p[1] - 0.5) * (q[0] - 0.5));
            area += triangle;
            for (std::size_t a = 0; a < 2; ++a) moment[a] += triangle * (p[a] + q[a] - 1.0) / 3.0;
        }
    }
    if (!(area > 0 && std::hypot(cosine, sine) > least_harmonic * length)) return {};
    auto motion = turn_by(-0.25 * std::atan2(sine, cosine));
    const auto centroid = motion({0.5 + moment[0] / area, 0.5 + moment[1] / area});
    for (std::size_t a = 0; a < 2; ++a) motion.translation[a] = 0.5 - centroid[a];
    for (const ContourLoop& loop : loops) {
        if (!std::all_of(loop.begin(), loop.end(), [&](const auto& p) { return in_unit_cube(motion(p)); })) return {};
    }
    return motion;
}

template <>
RigidMotion<3> canonical_frame<3>(const LevelSet<3>&) {
    return {};
}

template <int Dim>
bool turns_freely(const LevelSet<Dim>& u) {
    constexpr double largest_radius = 0.47;  // of shapes in studies
    Point<Dim> centroid{};
    double inside = 0.0;
    for (std::size_t i = 0; i < u.values.size(); ++i) {
        if (!(u.values[i] > 0)) continue;
        const auto x = u.grid.position(u.grid.node(i));
        for (std::size_t a = 0; a < Dim; ++a) centroid[a] += x[a];
        ++inside;
    }
    for (double& c : centroid) c /= inside;
    for (std::size_t i = 0; i < u.values.size(); ++i) {
        if (!(u.values[i] > 0)) continue;
        const auto x = u.grid.position(u.grid.node(i));
        double square = 0.0;
        for (std::size_t a = 0; a < Dim; ++a) square += (x[a] - centroid[a]) * (x[a] - centroid[a]);
        if (square > largest_radius * largest_radius) return false;
    }
    return true;
}

template <int Dim>
GeodesicResult<Dim> in_pose_of_last(GeodesicResult<Dim> path) {
    if (path.frame.is_identity()) return path;
    const auto back = path.frame.inverse();
    for (auto& u : path.shapes) u = moved(u, back, u.grid.level());
    for (auto& phi : path.deformations) phi = turned(phi, back);
    path.frame = {};
    return path;
}

template bool turns_freely<2>(const LevelSet<2>&);
template bool turns_freely<3>(const LevelSet<3>&);
template GeodesicResult<2> in_pose_of_last<2>(GeodesicResult<2>);
template GeodesicResult<3> in_pose_of_last<3>(GeodesicResult<3>);

}  // namespace morphodesic

#include "datasets/point_surface.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <boost/geometry.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <cmath>
#include <compare>
#include <cstddef>
#include <numeric>
#include <utility>

#include "datasets/interruption.h"
#include "datasets/principal_axes.h"

namespace morphodesic::datasets {
namespace {

constexpr int neighbours = 24;  // those that triangles may join
constexpr int fitted = 16;      // the nearest, whose plane is taken: few, as other sides of thin parts are near, too

using TreePoint = boost::geometry::model::point<double, 3, boost::geometry::cs::cartesian>;
using TreeValue = std::pair<TreePoint, int>;
using PointTree = boost::geometry::index::rtree<TreeValue, boost::geometry::index::quadratic<16>>;

/// A neighbour in the tangent plane, relative to the point in the middle.
struct Neighbour {
    double x, y;
    int number;
};
/// A corner of the region nearer to the middle than to any neighbour, and the neighbour that bounds the region from
/// here to the next corner; -1: none does, the region goes on.
struct VoronoiCorner {
    double x, y;
    int neighbour;
};

/// Cuts off what is nearer to a neighbour than to the middle.
void cut(std::vector<VoronoiCorner>& region, const Neighbour& q) {
    const double half = 0.5 * (q.x * q.x + q.y * q.y);
    const auto beyond = [&](const VoronoiCorner& c) { return c.x * q.x + c.y * q.y - half; };
    std::vector<VoronoiCorner> result;
    for (std::size_t i = 0; i < region.size(); ++i) {
        const VoronoiCorner &a = region[i], &b = region[(i + 1) % region.size()];
        const double at_a = beyond(a), at_b = beyond(b);
        if (at_a <= 0) result.push_back(a);
        if ((at_a <= 0) == (at_b <= 0)) continue;
        const double t = at_a / (at_a - at_b);
        result.push_back({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), at_a <= 0 ? q.number : a.neighbour});
    }
    region = std::move(result);
}

/// The neighbours of a point, nearest first, in the plane that fits them best.
struct TangentPlane {
    std::vector<Neighbour> around;
    double reach = 0.0;       ///< no point within this distance is missing
    Vector3 normal{};         ///< to either side
    double unevenness = 0.0;  ///< root mean square distance of the points from the plane over reach
};
TangentPlane tangent_plane(const std::vector<Vector3>& points, const PointTree& tree, int middle) {
    const Vector3& p = points[middle];
    std::vector<TreeValue> found;
    found.reserve(neighbours + 1);
    tree.query(boost::geometry::index::nearest(TreePoint(p[0], p[1], p[2]), neighbours + 1), std::back_inserter(found));
    std::vector<std::pair<double, int>> order;
    for (const auto& value : found) {
        const int n = value.second;
        if (n != middle) order.emplace_back(norm(points[n] - p), n);
    }
    std::sort(order.begin(), order.end());
    TangentPlane plane;
    plane.reach = order.back().first;
    const PrincipalAxes axes =
        principal_axes(fitted + 1, [&](std::size_t i) { return i == 0 ? p : points[order[i - 1].second]; });
    plane.unevenness = std::sqrt(std::max(axes.variances[0], 0.0)) / order[fitted - 1].first;
    for (const auto& [r, n] : order) {
        const Eigen::Vector3d e = axes.along(points[n] - p);
        if (2.0 * e[0] * e[0] > e.squaredNorm()) continue;  // on the other side of something thin
        plane.around.push_back({e[2], e[1], n});
    }
    plane.normal = axes.normal();
    return plane;
}

/// Triangles at a point, corners in ascending order.
std::vector<std::array<int, 3>> star(int middle, const TangentPlane& plane) {
    const double r = plane.reach;
    // A circle through the point that is larger than this may hold points that are no neighbours.
    const double limit = 0.5 * r;
    std::vector<VoronoiCorner> region{{-r, -r, -1}, {r, -r, -1}, {r, r, -1}, {-r, r, -1}};
    for (const auto& q : plane.around) cut(region, q);
    std::vector<std::array<int, 3>> result;
    for (std::size_t i = 0; i < region.size(); ++i) {
        const VoronoiCorner& corner = region[(i + 1) % region.size()];
        const int a = region[i].neighbour, b = corner.neighbour;
        if (a < 0 || b < 0 || a == b || std::hypot(corner.x, corner.y) > limit) continue;
        std::array<int, 3> t{middle, a, b};
        std::sort(t.begin(), t.end());
        result.push_back(t);
    }
    return result;
}

/// Turns normals to one side, along the edges between those that differ least (Hoppe et al. 1992).
void turn_to_one_side(const std::vector<std::array<int, 3>>& triangles, std::vector<Vector3>& normals) {
    struct Edge {
        double bend;
        int a, b;
        auto operator<=>(const Edge&) const = default;
    };
    std::vector<Edge> edges;
    edges.reserve(3 * triangles.size());
    for (const auto& t : triangles) {
        for (int i = 0; i < 3; ++i) {
            const int a = std::min(t[i], t[(i + 1) % 3]), b = std::max(t[i], t[(i + 1) % 3]);
            edges.push_back({1.0 - std::abs(dot(normals[a], normals[b])), a, b});
        }
    }
    std::sort(edges.begin(), edges.end());
    // Kruskal's forest; each point knows whether it is turned against the one that stands for it.
    std::vector<int> parent(normals.size());
    std::iota(parent.begin(), parent.end(), 0);
    std::vector<char> turned(normals.size(), 0);
    const auto root = [&](int i) {
        int top = i;
        char against = 0;
        while (parent[top] != top) against ^= turned[top], top = parent[top];
        while (parent[i] != top && i != top) {  // shortens the way
            const int next = parent[i];
            const char rest = static_cast<char>(against ^ turned[i]);
            parent[i] = top, turned[i] = against;
            i = next, against = rest;
        }
        return top;
    };
    for (const auto& e : edges) {
        const int a = root(e.a), b = root(e.b);
        if (a == b) continue;
        const bool differ = dot(normals[e.a], normals[e.b]) < 0;
        parent[b] = a;
        turned[b] = static_cast<char>((e.a == a ? 0 : turned[e.a]) ^ (e.b == b ? 0 : turned[e.b]) ^ differ);
    }
    for (std::size_t i = 0; i < normals.size(); ++i) {
        if (const int r = root(static_cast<int>(i)); r != static_cast<int>(i) && turned[i])
            normals[i] = -1.0 * normals[i];
    }
}

/// So that a patch that closes has a positive volume; one that does not is turned by what its middle sees of it.
void turn_patches_by_volume(TriangleMesh& mesh) {
    const Patches patch = patches(mesh);
    std::vector<Vector3> centre(patch.count, Vector3{});
    std::vector<double> corners(patch.count, 0.0), volume(patch.count, 0.0);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const int p = patch.of_triangle[t];
        for (const auto& c : mesh.corners(t)) centre[p] = centre[p] + c, corners[p] += 1.0;
    }
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const int p = patch.of_triangle[t];
        const auto c = mesh.corners(t);
        volume[p] += dot(c[0] - (1.0 / corners[p]) * centre[p], area_vector(c));
    }
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (volume[patch.of_triangle[t]] < 0) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
    }
}

}  // namespace

PointSurface surface_through(std::vector<Vector3> points) {
    PointSurface result;
    TriangleMesh& mesh = result.mesh;
    mesh.points = std::move(points);
    if (mesh.points.size() <= neighbours) return result;
    std::vector<TreeValue> values;
    values.reserve(mesh.points.size());
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        const Vector3& p = mesh.points[i];
        values.emplace_back(TreePoint(p[0], p[1], p[2]), static_cast<int>(i));
    }
    const PointTree tree(values);
    std::vector<std::vector<std::array<int, 3>>> stars(mesh.points.size());
    std::vector<Vector3> normals(mesh.points.size());
    std::vector<double> unevenness(mesh.points.size());
    tbb::parallel_for(std::size_t{0}, stars.size(), [&](std::size_t i) {
        interruption_point(i, 64);
        const TangentPlane plane = tangent_plane(mesh.points, tree, static_cast<int>(i));
        stars[i] = star(static_cast<int>(i), plane);
        normals[i] = plane.normal;
        unevenness[i] = plane.unevenness;
    });
    const auto middle = unevenness.begin() + static_cast<std::ptrdiff_t>(unevenness.size() / 2);
    std::nth_element(unevenness.begin(), middle, unevenness.end());
    result.unevenness = *middle;
    std::vector<std::array<int, 3>> all;
    for (const auto& s : stars) all.insert(all.end(), s.begin(), s.end());
    std::sort(all.begin(), all.end());
    for (std::size_t i = 0; i + 1 < all.size(); ++i) {
        if (all[i] == all[i + 1] && (mesh.triangles.empty() || mesh.triangles.back() != all[i]))
            mesh.triangles.push_back(all[i]);
    }
    turn_to_one_side(mesh.triangles, normals);
    for (auto& t : mesh.triangles) {
        const Vector3 n = normals[t[0]] + normals[t[1]] + normals[t[2]];
        if (dot(area_vector({mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]}), n) < 0) std::swap(t[1], t[2]);
    }
    leave_out_inconsistent(mesh);
    turn_patches_by_volume(mesh);
    return result;
}

}  // namespace morphodesic::datasets

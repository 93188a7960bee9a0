#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "geodesic/grid/dyadic_grid.h"

namespace morphodesic::datasets {

using Vector3 = Point<3>;

inline Vector3 operator+(const Vector3& a, const Vector3& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Vector3 operator-(const Vector3& a, const Vector3& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Vector3 operator*(double s, const Vector3& a) {
    return {s * a[0], s * a[1], s * a[2]};
}
inline double dot(const Vector3& a, const Vector3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline double norm(const Vector3& a) {
    return std::sqrt(dot(a, a));
}
inline Vector3 cross(const Vector3& a, const Vector3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Triangles in file units; the corners run counter-clockwise seen from outside. Without triangles: a point cloud.
struct TriangleMesh {
    std::vector<Vector3> points;
    std::vector<std::array<int, 3>> triangles;

    [[nodiscard]] std::array<Vector3, 3> corners(std::size_t t) const {
        const auto& c = triangles[t];
        return {points[c[0]], points[c[1]], points[c[2]]};
    }
};

struct Box3 {
    Vector3 low{}, high{};
    [[nodiscard]] Vector3 side() const { return high - low; }
    [[nodiscard]] double diagonal() const { return norm(high - low); }
    [[nodiscard]] double longest_side() const {
        return std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
    }
    [[nodiscard]] bool is_apart(const Box3& other) const {
        for (int a = 0; a < 3; ++a) {
            if (low[a] > other.high[a] || high[a] < other.low[a]) return true;
        }
        return false;
    }
    void include(const Vector3& p) {
        for (int a = 0; a < 3; ++a) low[a] = std::min(low[a], p[a]), high[a] = std::max(high[a], p[a]);
    }
    void include(const Box3& other) { include(other.low), include(other.high); }
    [[nodiscard]] Box3 grown(double margin) const {
        const Vector3 m{margin, margin, margin};
        return {low - m, high + m};
    }
    /// Holds nothing; to be grown by include().
    static Box3 empty() {
        constexpr double infinite = std::numeric_limits<double>::infinity();
        return {{infinite, infinite, infinite}, {-infinite, -infinite, -infinite}};
    }
};
/// Box around the points; not empty.
Box3 bounding_box(std::span<const Vector3> points);

/// Twice the area times the unit normal of a triangle.
inline Vector3 area_vector(const std::array<Vector3, 3>& c) {
    return cross(c[1] - c[0], c[2] - c[0]);
}
double surface_area(const TriangleMesh& mesh);
/// Volume enclosed by a closed mesh, < 0 if its triangles are turned inside out.
double signed_volume(const TriangleMesh& mesh);
/// Centroid of the solid enclosed by a closed mesh of nonzero volume.
Vector3 volume_centroid(const TriangleMesh& mesh);

/// How the triangles hang together. Edges are counted once; points are the same if their index is the same.
struct MeshTopology {
    std::size_t boundary_edges = 0;      ///< edges of one triangle only
    std::size_t crowded_edges = 0;       ///< edges of three or more triangles (non-manifold)
    std::size_t inconsistent_edges = 0;  ///< edges whose two triangles have opposite orientation
    std::size_t unbalanced_edges = 0;    ///< edges not run through equally often in both directions
    /// True if the surface has no boundary (as a chain), so that winding numbers are integers.
    [[nodiscard]] bool closed() const { return unbalanced_edges == 0; }
};
MeshTopology topology(const TriangleMesh& mesh);

/// What clean() removed.
struct CleaningReport {
    std::size_t merged_points = 0;         ///< points with exactly the coordinates of another
    std::size_t unused_points = 0;         ///< points of no triangle (only in meshes with triangles)
    std::size_t degenerate_triangles = 0;  ///< triangles with two equal corners
    std::size_t repeated_triangles = 0;    ///< triangles with the same three corners as another
};
/// Merges points of equal coordinates; drops triangles with two equal corners, repeated triangles and unused points.
CleaningReport clean(TriangleMesh& mesh);

/// Connected pieces of a surface.
struct Patches {
    std::vector<int> of_triangle;  ///< [triangles] number of the patch of each triangle
    int count = 0;
};
/// Patches joined at edges of exactly two triangles (across_all_edges: at any common point).
Patches patches(const TriangleMesh& mesh, bool across_all_points = false);

/// Turns triangles so that neighbours in a patch agree, following the majority of each patch (weighted by area).
/// @return  number of triangles that were turned
std::size_t orient_patches(TriangleMesh& mesh, const Patches& patches);

/// Leaves out triangles at edges of three or more, and at edges whose two triangles face different sides.
void leave_out_inconsistent(TriangleMesh& mesh);

/// The same surface seen from its other side.
void turn_inside_out(TriangleMesh& mesh);

/// Mirror image: x -> -x, with the orientation of the triangles put right.
void mirror(TriangleMesh& mesh);

}  // namespace morphodesic::datasets

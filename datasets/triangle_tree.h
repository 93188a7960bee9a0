#pragma once

#include <vector>

#include "datasets/triangle_mesh.h"

namespace morphodesic::datasets {

/// Boxes around the triangles of a mesh, for questions about points in space.
class TriangleTree {
public:
    /// @throws std::invalid_argument if there are no triangles
    explicit TriangleTree(const TriangleMesh& mesh);

    /// Generalised winding number of the triangles: 1 inside and 0 outside a closed surface, in between where it has
    /// holes, so that > 1/2 closes them smoothly. Far triangles count by their moments, near ones exactly; error below
    /// about 0.06, and much smaller near the surface.
    /// Source: Barill, Dickson, Schmidt, Levin, Jacobson, Fast winding numbers for soups and clouds, 2018.
    [[nodiscard]] double winding_number(const Vector3& x) const;

    /// True if the ray from origin meets a triangle.
    [[nodiscard]] bool is_blocked(const Vector3& origin, const Vector3& direction) const;

    struct Nearest {
        double distance;      ///< bound if no triangle is nearer
        Vector3 area_vector;  ///< of the nearest triangle: normal times twice its area; zero if there is none
        Vector3 point;        ///< of that triangle; x if there is none
    };
    /// The nearest triangle within a bound.
    [[nodiscard]] Nearest nearest(const Vector3& x, double bound) const;

private:
    struct Node {
        Vector3 low{}, high{};
        Vector3 centre{};                ///< area-weighted
        Vector3 dipole{};                ///< sum of area times normal
        std::array<double, 9> moment{};  ///< sum of (triangle's centre - centre) (x) area times normal
        double radius = 0.0;             ///< no corner is farther from the centre
        int first = 0, last = 0;         ///< triangles
        int child = -1;                  ///< the first of two children; -1: a leaf
    };
    void build(int node);

    std::vector<std::array<Vector3, 3>> triangles_;
    std::vector<Vector3> centres_, dipoles_;  ///< of the triangles
    std::vector<double> far_;                 ///< squared distance from which the dipole stands for the triangle
    std::vector<Node> nodes_;
};

}  // namespace morphodesic::datasets

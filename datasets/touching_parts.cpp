#include "datasets/touching_parts.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "datasets/interruption.h"

namespace morphodesic::datasets {
namespace {

constexpr double widest_slit = 0.01;  // cells
/// In cells^2, of both faces together: balls that meet at a point have 5 of it.
constexpr double least_touching_area = 16.0;
constexpr double sample_area = 4.0;  // cells^2, of the surface per sample

/// Which boxes have a common point with which others.
std::vector<std::vector<int>> neighbours(const std::vector<Box3>& boxes) {
    std::vector<int> order(boxes.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int a, int b) { return boxes[a].low[0] < boxes[b].low[0]; });
    std::vector<std::vector<int>> result(boxes.size());
    for (auto a = order.begin(); a != order.end(); ++a) {
        for (auto b = a + 1; b != order.end() && boxes[*b].low[0] <= boxes[*a].high[0]; ++b) {
            if (boxes[*a].is_apart(boxes[*b])) continue;
            result[*a].push_back(*b);
            result[*b].push_back(*a);
        }
    }
    return result;
}

/// Whether there is solid on the outer side of a face too.
bool has_solid_outside(const TriangleTree& surface, const Vector3& on_face, const Vector3& area_vector, double slit) {
    return surface.winding_number(on_face + (slit / norm(area_vector)) * area_vector) > 0.5;
}

/// Area of a triangle with solid on its outer side, from evenly spread samples.
double area_within(const TriangleTree& surface, const std::array<Vector3, 3>& c, double cell) {
    const Vector3 n = area_vector(c);
    const double area = 0.5 * norm(n);
    if (!(area > 0.0)) return 0.0;
    const int samples = static_cast<int>(std::min(std::ceil(area / (sample_area * cell * cell)), 1e5));
    int within = 0;
    for (int s = 0; s < samples; ++s) {  // the sequence with the plastic number; a single one is the centre
        double u = std::fmod(1.0 / 3.0 + 0.7548776662466927 * s, 1.0);
        double v = std::fmod(1.0 / 3.0 + 0.5698402909980532 * s, 1.0);
        if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
        const Vector3 x = c[0] + u * (c[1] - c[0]) + v * (c[2] - c[0]);
        within += has_solid_outside(surface, x, n, widest_slit * cell) ? 1 : 0;
    }
    return area * within / samples;
}

}  // namespace

bool parts_touch(const TriangleMesh& mesh, const Patches& patch, double cell) {
    if (patch.count == 1) return false;
    const auto box_of = [&](std::size_t t) { return bounding_box(mesh.corners(t)).grown(widest_slit * cell); };
    std::vector<Box3> boxes(patch.count, Box3::empty());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) boxes[patch.of_triangle[t]].include(box_of(t));
    const std::vector<std::vector<int>> near = neighbours(boxes);
    std::vector<std::size_t> candidates;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Box3 box = box_of(t);
        const auto& others = near[patch.of_triangle[t]];
        if (std::any_of(others.begin(), others.end(), [&](int p) { return !boxes[p].is_apart(box); }))
            candidates.push_back(t);
    }
    if (candidates.empty()) return false;
    const TriangleTree surface(mesh);
    std::vector<double> within(candidates.size());
    tbb::parallel_for(std::size_t{0}, candidates.size(), [&](std::size_t i) {
        interruption_point();
        within[i] = area_within(surface, mesh.corners(candidates[i]), cell);
    });
    return std::accumulate(within.begin(), within.end(), 0.0) > least_touching_area * cell * cell;
}

void close_slits(const TriangleTree& surface, const Lattice& lattice, std::vector<std::int8_t>& winding) {
    const double slit = widest_slit * lattice.spacing;
    const int nx = lattice.nodes[0], ny = lattice.nodes[1], nz = lattice.nodes[2];  // clang 14 captures no bindings
    tbb::parallel_for(0, nz, [&](int k) {
        interruption_point();
        for (int j = 0; j < ny; ++j) {
            for (int i = 0; i < nx; ++i) {
                auto& w = winding[lattice.index(i, j, k)];
                if (w > 0) continue;
                const auto face = surface.nearest(lattice.position(i, j, k), slit);
                if (norm(face.area_vector) > 0.0 && has_solid_outside(surface, face.point, face.area_vector, slit))
                    w = 1;
            }
        }
    });
}

}  // namespace morphodesic::datasets

#include "datasets/flat_lids.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "datasets/interruption.h"
#include "datasets/principal_axes.h"

namespace morphodesic::datasets {
namespace {

constexpr double wide = 0.15;   // of the size: narrower openings are holes
constexpr double plane = 0.03;  // of the width: the lids of less uneven rims are made plane
constexpr double full = 0.3;    // of the disk of that width: a chain of small holes is no wide one
constexpr double bent = 0.3;    // sine of the angle by which walls lean over the opening: then they close round

/// Number of the lid of each free point, -1 for the others. Free points joined by triangles are of one lid.
std::vector<int> lids_of(const TriangleMesh& mesh, const std::vector<char>& is_free, int& count) {
    std::vector<std::vector<int>> joined(mesh.points.size());
    for (const auto& t : mesh.triangles) {
        for (int i = 0; i < 3; ++i) {
            const int a = t[i], b = t[(i + 1) % 3];
            if (is_free[a] && is_free[b]) joined[a].push_back(b), joined[b].push_back(a);
        }
    }
    std::vector<int> lid(mesh.points.size(), -1), queue;
    count = 0;
    for (std::size_t start = 0; start < lid.size(); ++start) {
        if (!is_free[start] || lid[start] >= 0) continue;
        lid[start] = count;
        queue.assign(1, static_cast<int>(start));
        while (!queue.empty()) {
            const int i = queue.back();
            queue.pop_back();
            for (const int j : joined[i]) {
                if (lid[j] < 0) lid[j] = count, queue.push_back(j);
            }
        }
        ++count;
    }
    return lid;
}

struct Lid {
    Vector3 facing{};      ///< sum of area vectors
    std::vector<int> rim;  ///< points of the scan that it ends at, some of them repeated
};

struct Plane {
    Vector3 centre{}, normal{};
    double width = 0.0, unevenness = 0.0;
};
Plane plane_through(const TriangleMesh& mesh, const std::vector<int>& rim) {
    Plane result;
    const PrincipalAxes axes = principal_axes(rim.size(), [&](std::size_t i) { return mesh.points[rim[i]]; });
    result.centre = axes.mean;
    result.normal = axes.normal();
    result.unevenness = std::sqrt(std::max(axes.variances[0], 0.0));
    for (const int i : rim) result.width = std::max(result.width, 2.0 * norm(mesh.points[i] - axes.mean));
    return result;
}

/// How far the walls lean over the opening at its rim: mean sine of the angle, in [-1, 1].
double lean(const TriangleMesh& mesh, const std::vector<int>& rim, const TriangleTree& scan, const Vector3& normal,
            double far) {
    double sum = 0.0;
    for (const int i : rim) {
        const Vector3 n = scan.nearest(mesh.points[i], far).area_vector;
        if (norm(n) > 0) sum += dot(n, normal) / norm(n);
    }
    return sum / static_cast<double>(rim.size());
}

/// How far beyond the plane all but a tenth of the rim's points end.
double outermost(const TriangleMesh& mesh, const std::vector<int>& rim, const Vector3& centre, const Vector3& normal) {
    std::vector<double> height;
    for (const int i : rim) height.push_back(dot(mesh.points[i] - centre, normal));
    const auto nth = height.begin() + static_cast<std::ptrdiff_t>(height.size() * 9 / 10);
    std::nth_element(height.begin(), nth, height.end());
    return *nth;
}

}  // namespace

std::size_t flatten_lids(TriangleMesh& rebuilt, std::vector<char>& is_free, const TriangleTree& scan, double ragged,
                         double size) {
    int count = 0;
    const std::vector<int> lid = lids_of(rebuilt, is_free, count);
    const auto lid_at = [&](const std::array<int, 3>& t) { return std::max({lid[t[0]], lid[t[1]], lid[t[2]]}); };
    std::vector<Lid> lids(static_cast<std::size_t>(count));
    std::vector<Vector3> normal(rebuilt.points.size(), Vector3{});
    for (std::size_t t = 0; t < rebuilt.triangles.size(); ++t) {
        const int of = lid_at(rebuilt.triangles[t]);
        if (of < 0) continue;
        const Vector3 n = area_vector(rebuilt.corners(t));
        lids[of].facing = lids[of].facing + n;
        for (const int i : rebuilt.triangles[t]) normal[i] = normal[i] + n;
    }
    // Small holes in the walls may hang together with it; they face elsewhere.
    std::vector<char> faces_out(lid.size(), 0);
    for (std::size_t i = 0; i < lid.size(); ++i) {
        if (lid[i] < 0) continue;
        const Vector3& facing = lids[lid[i]].facing;
        faces_out[i] = dot(normal[i], facing) > 0.7 * norm(normal[i]) * norm(facing);
    }
    for (const auto& t : rebuilt.triangles) {
        if (lid_at(t) < 0 || std::none_of(t.begin(), t.end(), [&](int i) { return faces_out[i] != 0; })) continue;
        for (const int i : t) {
            if (!is_free[i]) lids[lid_at(t)].rim.push_back(i);
        }
    }
    std::size_t flat = 0;
    std::vector<char> is_flat(lids.size(), 0);
    std::vector<Plane> planes(lids.size());
    for (std::size_t l = 0; l < lids.size(); ++l) {
        if (lids[l].rim.size() < 8) continue;
        Plane& p = planes[l] = plane_through(rebuilt, lids[l].rim);
        if (p.width < wide * size) continue;
        if (0.5 * norm(lids[l].facing) < full * 0.25 * std::numbers::pi * p.width * p.width) continue;
        const Vector3 outward = dot(p.normal, lids[l].facing) < 0 ? -1.0 * p.normal : p.normal;
        if (lean(rebuilt, lids[l].rim, scan, outward, size) > bent) continue;
        p.centre = p.centre + std::min(ragged, outermost(rebuilt, lids[l].rim, p.centre, outward)) * outward;
        is_flat[l] = 1;
        ++flat;
    }
    for (std::size_t i = 0; i < lid.size(); ++i) {
        if (!faces_out[i] || !is_flat[lid[i]]) continue;
        is_free[i] = 0;
        const Plane& p = planes[lid[i]];
        if (p.unevenness > plane * p.width) continue;
        rebuilt.points[i] = rebuilt.points[i] - dot(rebuilt.points[i] - p.centre, p.normal) * p.normal;
    }
    return flat;
}

}  // namespace morphodesic::datasets

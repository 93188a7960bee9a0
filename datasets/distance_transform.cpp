#include "datasets/distance_transform.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include "datasets/interruption.h"

namespace morphodesic::datasets {
namespace {

using Point3f = std::array<float, 3>;

/// Hands on nearest points from each plane across an axis to the next one, both ways. A node looks at the nine nodes
/// before it, so everything within the pyramid of 45 degrees around the direction is reached.
class Sweeper {
public:
    Sweeper(const Lattice& lattice, const std::vector<Point3f>& points, std::vector<std::int32_t>& nearest,
            std::vector<float>& distance2)
        : nodes_(lattice.nodes), points_(points), nearest_(nearest), distance2_(distance2) {
        stride_ = {1, nodes_[0], static_cast<std::ptrdiff_t>(nodes_[0]) * nodes_[1]};
    }

    void sweep(int axis, int step) {
        const int a = (axis + 1) % 3, b = (axis + 2) % 3, n = nodes_[axis];
        // the axis that runs faster in memory is the inner one
        const int inner = stride_[a] < stride_[b] ? a : b, outer = inner == a ? b : a;
        for (int plane = 1; plane < n; ++plane) {
            const int here = step > 0 ? plane : n - 1 - plane;
            tbb::parallel_for(tbb::blocked_range<int>(0, nodes_[outer], 16), [&](const tbb::blocked_range<int>& rows) {
                for (int v = rows.begin(); v < rows.end(); ++v) {
                    for (int u = 0; u < nodes_[inner]; ++u) update(axis, inner, outer, here, u, v, step);
                }
            });
        }
    }

    /// Every node looks once more at all its neighbours, which mends most of the wrong choices.
    void polish() {
        const std::vector<std::int32_t> before = nearest_;
        tbb::parallel_for(tbb::blocked_range<int>(0, nodes_[2], 4), [&](const tbb::blocked_range<int>& slab) {
            for (int k = slab.begin(); k < slab.end(); ++k) {
                for (int j = 0; j < nodes_[1]; ++j) {
                    for (int i = 0; i < nodes_[0]; ++i) polish_node(before, i, j, k);
                }
            }
        });
    }

private:
    void polish_node(const std::vector<std::int32_t>& before, int i, int j, int k) {
        const std::ptrdiff_t me = i + j * stride_[1] + k * stride_[2];
        const Point3f x{static_cast<float>(i), static_cast<float>(j), static_cast<float>(k)};
        const std::int32_t mine = before[me];
        for (int c = std::max(k - 1, 0); c <= std::min(k + 1, nodes_[2] - 1); ++c) {
            for (int b = std::max(j - 1, 0); b <= std::min(j + 1, nodes_[1] - 1); ++b) {
                for (int a = std::max(i - 1, 0); a <= std::min(i + 1, nodes_[0] - 1); ++a) {
                    const std::int32_t candidate = before[a + b * stride_[1] + c * stride_[2]];
                    if (candidate < 0 || candidate == mine) continue;
                    const Point3f& p = points_[candidate];
                    const float d0 = p[0] - x[0], d1 = p[1] - x[1], d2 = p[2] - x[2];
                    const float distance2 = d0 * d0 + d1 * d1 + d2 * d2;
                    if (distance2 < distance2_[me]) distance2_[me] = distance2, nearest_[me] = candidate;
                }
            }
        }
    }

    void update(int axis, int inner, int outer, int here, int u, int v, int step) {
        const std::ptrdiff_t me = here * stride_[axis] + u * stride_[inner] + v * stride_[outer];
        const std::ptrdiff_t before = me - step * stride_[axis];
        Point3f x;
        x[axis] = static_cast<float>(here), x[inner] = static_cast<float>(u), x[outer] = static_cast<float>(v);
        std::int32_t best = nearest_[me];
        float best2 = distance2_[me];
        const int v0 = v > 0 ? -1 : 0, v1 = v + 1 < nodes_[outer] ? 1 : 0;
        const int u0 = u > 0 ? -1 : 0, u1 = u + 1 < nodes_[inner] ? 1 : 0;
        for (int dv = v0; dv <= v1; ++dv) {
            for (int du = u0; du <= u1; ++du) {
                const std::int32_t candidate = nearest_[before + du * stride_[inner] + dv * stride_[outer]];
                if (candidate < 0 || candidate == best) continue;
                const Point3f& p = points_[candidate];
                const float d0 = p[0] - x[0], d1 = p[1] - x[1], d2 = p[2] - x[2];
                const float distance2 = d0 * d0 + d1 * d1 + d2 * d2;
                if (distance2 < best2) best2 = distance2, best = candidate;
            }
        }
        nearest_[me] = best;
        distance2_[me] = best2;
    }

    std::array<int, 3> nodes_;
    std::array<std::ptrdiff_t, 3> stride_{};
    const std::vector<Point3f>& points_;
    std::vector<std::int32_t>& nearest_;
    std::vector<float>& distance2_;
};

}  // namespace

std::vector<float> distance_to_points(const Lattice& lattice, const std::vector<Vector3>& points) {
    if (points.empty()) throw std::invalid_argument("distance_to_points: no points");
    std::vector<Point3f> in_nodes;  // in units of nodes
    in_nodes.reserve(points.size());
    for (const auto& p : points) {
        Point3f q;
        for (int a = 0; a < 3; ++a) q[a] = static_cast<float>((p[a] - lattice.origin[a]) / lattice.spacing);
        in_nodes.push_back(q);
    }
    std::vector<std::int32_t> nearest(lattice.node_count(), -1);
    std::vector<float> distance2(lattice.node_count(), std::numeric_limits<float>::max());
    for (std::size_t s = 0; s < in_nodes.size(); ++s) {
        interruption_point(s);
        std::array<int, 3> low, high;
        for (int a = 0; a < 3; ++a) {
            const float floor = std::floor(in_nodes[s][a]);
            const float last = static_cast<float>(lattice.nodes[a] - 1);
            low[a] = static_cast<int>(std::clamp(floor, 0.0F, last));
            high[a] = static_cast<int>(std::clamp(floor + 1.0F, 0.0F, last));
        }
        for (int k = low[2]; k <= high[2]; ++k) {
            for (int j = low[1]; j <= high[1]; ++j) {
                for (int i = low[0]; i <= high[0]; ++i) {
                    const float d0 = in_nodes[s][0] - static_cast<float>(i);
                    const float d1 = in_nodes[s][1] - static_cast<float>(j);
                    const float d2 = in_nodes[s][2] - static_cast<float>(k);
                    const float d = d0 * d0 + d1 * d1 + d2 * d2;
                    const std::size_t node = lattice.index(i, j, k);
                    if (d < distance2[node]) distance2[node] = d, nearest[node] = static_cast<std::int32_t>(s);
                }
            }
        }
    }
    Sweeper sweeper(lattice, in_nodes, nearest, distance2);
    for (const int axis : {2, 1, 0}) {
        interruption_point();
        sweeper.sweep(axis, 1);
        sweeper.sweep(axis, -1);
    }
    sweeper.polish();
    for (auto& d : distance2) d = static_cast<float>(std::sqrt(d) * lattice.spacing);
    return distance2;
}

std::vector<Vector3> surface_samples(const TriangleMesh& mesh, double spacing) {
    std::vector<Vector3> samples = mesh.points;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        interruption_point(t);
        const auto c = mesh.corners(t);
        const double longest = std::max({norm(c[1] - c[0]), norm(c[2] - c[1]), norm(c[0] - c[2])});
        const int n = static_cast<int>(std::ceil(longest / spacing));
        for (int i = 0; i <= n && n > 1; ++i) {
            for (int j = 0; j <= n - i; ++j) {
                const double u = static_cast<double>(i) / n, v = static_cast<double>(j) / n;
                samples.push_back((1.0 - u - v) * c[0] + u * c[1] + v * c[2]);
            }
        }
    }
    return samples;
}

}  // namespace morphodesic::datasets

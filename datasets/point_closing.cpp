#include "datasets/point_closing.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "datasets/distance_transform.h"
#include "datasets/interruption.h"

namespace morphodesic::datasets {

std::vector<double> sorted_spacings(const std::vector<Vector3>& points) {
    const std::size_t stride = points.size() / 1000 + 1;
    std::vector<double> spacings((points.size() + stride - 1) / stride);
    tbb::parallel_for(std::size_t{0}, spacings.size(), [&](std::size_t s) {
        interruption_point();
        std::array<double, 7> nearest;
        nearest.fill(1e300);
        for (const auto& p : points) {
            const Vector3 r = p - points[s * stride];
            const double d = dot(r, r);
            if (d >= nearest.back()) continue;
            nearest.back() = d;
            std::inplace_merge(nearest.begin(), nearest.end() - 1, nearest.end());
        }
        spacings[s] = std::sqrt(nearest.back());
    });
    std::sort(spacings.begin(), spacings.end());
    return spacings;
}

namespace {

/// Nodes that a ball of the given radius reaches from the border without touching a point.
std::vector<char> reached_from_outside(const Lattice& lattice, const std::vector<float>& distance, double radius) {
    std::vector<char> reached(lattice.node_count(), 0);
    const int nx = lattice.nodes[0], ny = lattice.nodes[1], nz = lattice.nodes[2];  // clang 14 captures no bindings
    std::vector<std::size_t> queue;
    const auto visit = [&](int i, int j, int k) {
        const std::size_t n = lattice.index(i, j, k);
        if (!reached[n] && distance[n] > radius) reached[n] = 1, queue.push_back(n);
    };
    for (int k = 0; k < nz; ++k) {
        for (int j = 0; j < ny; ++j) visit(0, j, k), visit(nx - 1, j, k);
        for (int i = 0; i < nx; ++i) visit(i, 0, k), visit(i, ny - 1, k);
    }
    for (int j = 0; j < ny; ++j) {
        for (int i = 0; i < nx; ++i) visit(i, j, 0), visit(i, j, nz - 1);
    }
    while (!queue.empty()) {
        const std::size_t n = queue.back();
        queue.pop_back();
        const auto row = static_cast<std::size_t>(nx), plane = row * static_cast<std::size_t>(ny);
        const int i = static_cast<int>(n % row), j = static_cast<int>(n % plane / row), k = static_cast<int>(n / plane);
        if (i > 0) visit(i - 1, j, k);
        if (i + 1 < nx) visit(i + 1, j, k);
        if (j > 0) visit(i, j - 1, k);
        if (j + 1 < ny) visit(i, j + 1, k);
        if (k > 0) visit(i, j, k - 1);
        if (k + 1 < nz) visit(i, j, k + 1);
    }
    return reached;
}

}  // namespace

Closing closing(const Lattice& lattice, const std::vector<float>& distance, double radius) {
    const std::vector<char> outside = reached_from_outside(lattice, distance, radius);
    const int nx = lattice.nodes[0], ny = lattice.nodes[1], nz = lattice.nodes[2];  // clang 14 captures no bindings
    std::vector<Vector3> rim;  // where the ball's centre comes to a stop, between two nodes
    Closing result;
    for (int k = 0; k < nz; ++k) {
        interruption_point();
        for (int j = 0; j < ny; ++j) {
            for (int i = 0; i < nx; ++i) {
                const std::size_t n = lattice.index(i, j, k);
                if (!outside[n]) {
                    result.has_core |= distance[n] > radius + 0.5 * lattice.spacing;
                    continue;
                }
                const Vector3 x = lattice.position(i, j, k);
                for (int side = 0; side < 6; ++side) {
                    std::array<int, 3> m{i, j, k};
                    m[side / 2] += side % 2 ? 1 : -1;
                    if (m[side / 2] < 0 || m[side / 2] >= lattice.nodes[side / 2]) continue;
                    const std::size_t other = lattice.index(m[0], m[1], m[2]);
                    if (outside[other]) continue;
                    const double t = (distance[n] - radius) / std::max<double>(distance[n] - distance[other], 1e-12);
                    rim.push_back(x + std::clamp(t, 0.0, 1.0) * (lattice.position(m[0], m[1], m[2]) - x));
                }
            }
        }
    }
    result.values.assign(lattice.node_count(), static_cast<float>(-radius));
    if (rim.empty()) return result;
    const std::vector<float> depth = distance_to_points(lattice, rim);
    const double cell = std::pow(lattice.spacing, 3);
    for (std::size_t n = 0; n < depth.size(); ++n) {
        if (outside[n]) continue;
        result.values[n] = static_cast<float>(depth[n] - radius);
        if (result.values[n] > 0) result.volume += cell;
    }
    return result;
}

}  // namespace morphodesic::datasets

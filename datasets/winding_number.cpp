#include "datasets/winding_number.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "datasets/interruption.h"

namespace morphodesic::datasets {

std::vector<std::int8_t> winding_numbers(const TriangleMesh& mesh, const Lattice& lattice) {
    const int nx = lattice.nodes[0], ny = lattice.nodes[1], nz = lattice.nodes[2];  // clang 14 captures no bindings
    const double h = lattice.spacing;
    // Rows are shifted by a sliver, so that they pass through no corner of meshes made on a grid.
    const double shift_y = 1.234567e-7 * h, shift_z = 2.345678e-7 * h;
    std::vector<std::int8_t> winding(lattice.node_count(), 0);
    tbb::parallel_for(tbb::blocked_range<int>(0, nz, 4), [&](const tbb::blocked_range<int>& slab) {
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            interruption_point(t);
            const auto& corner = mesh.triangles[t];
            const auto c = mesh.corners(t);
            const double z0 = lattice.origin[2] + shift_z, y0 = lattice.origin[1] + shift_y;
            const double low_z = std::min({c[0][2], c[1][2], c[2][2]}), high_z = std::max({c[0][2], c[1][2], c[2][2]});
            const double low_y = std::min({c[0][1], c[1][1], c[2][1]}), high_y = std::max({c[0][1], c[1][1], c[2][1]});
            const auto first = [](double v, int least) { return std::max(static_cast<double>(least), std::ceil(v)); };
            const int k0 = static_cast<int>(std::min<double>(first((low_z - z0) / h, slab.begin()), slab.end()));
            const int k1 = static_cast<int>(std::min<double>(slab.end() - 1, std::floor((high_z - z0) / h)));
            if (k0 > k1) continue;
            const int j0 = static_cast<int>(std::min<double>(first((low_y - y0) / h, 0), ny));
            const int j1 = static_cast<int>(std::min<double>(ny - 1, std::floor((high_y - y0) / h)));
            const Vector3 n = area_vector(c);
            if (n[0] == 0.0) continue;  // parallel to the rows
            for (int k = k0; k <= k1; ++k) {
                for (int j = j0; j <= j1; ++j) {
                    const double y = y0 + j * h, z = z0 + k * h;
                    int left = 0;
                    for (int e = 0; e < 3; ++e) {
                        // Both triangles of an edge evaluate it from the same end: no row slips between them.
                        const int a = e, b = (e + 1) % 3;
                        const bool swap = corner[a] > corner[b];
                        const Vector3 &p = c[swap ? b : a], &q = c[swap ? a : b];
                        const bool is_left = (q[1] - p[1]) * (z - p[2]) - (q[2] - p[2]) * (y - p[1]) >= 0.0;
                        left += is_left != swap;
                    }
                    if (left != 0 && left != 3) continue;
                    const double slope_x = c[0][0] - (n[1] * (y - c[0][1]) + n[2] * (z - c[0][2])) / n[0];
                    const double x = std::clamp(slope_x, std::min({c[0][0], c[1][0], c[2][0]}),
                                                std::max({c[0][0], c[1][0], c[2][0]}));  // slivers
                    const double i = std::ceil((x - lattice.origin[0]) / h);
                    if (i >= nx) continue;
                    // n[0] < 0: the row enters the solid
                    auto& w = winding[lattice.index(static_cast<int>(std::max(i, 0.0)), j, k)];
                    w = static_cast<std::int8_t>(std::clamp(w + (left == 3 ? -1 : 1), -127, 127));
                }
            }
        }
        for (int k = slab.begin(); k < slab.end(); ++k) {
            for (int j = 0; j < ny; ++j) {
                int sum = 0;
                for (int i = 0; i < nx; ++i) {
                    auto& w = winding[lattice.index(i, j, k)];
                    sum += w;
                    w = static_cast<std::int8_t>(std::clamp(sum, -127, 127));
                }
            }
        }
    });
    return winding;
}

}  // namespace morphodesic::datasets

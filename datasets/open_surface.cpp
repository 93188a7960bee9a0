#include "datasets/open_surface.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "datasets/interruption.h"
#include "datasets/nested_shells.h"
#include "datasets/voxelize.h"

namespace morphodesic::datasets {

Turned turn_patches_outward(TriangleMesh& mesh, const Patches& patch, const TriangleTree& surface) {
    constexpr int directions = 24;
    const double step = 1e-4 * bounding_box(mesh.points).diagonal();
    std::vector<std::vector<int>> members(patch.count);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        members[patch.of_triangle[t]].push_back(static_cast<int>(t));
    }
    PatchFate fate{std::vector<char>(patch.count, 0), std::vector<char>(patch.count, 0)};
    const double total_area = surface_area(mesh);
    tbb::parallel_for(0, patch.count, [&](int p) {
        TriangleMesh part;  // without points: topology only compares indices
        double area = 0.0, volume = 0.0;
        for (const int t : members[p]) {
            part.triangles.push_back(mesh.triangles[t]);
            const auto c = mesh.corners(t);
            area += 0.5 * norm(area_vector(c));
            volume += dot(c[0] - mesh.points[0], cross(c[1] - mesh.points[0], c[2] - mesh.points[0]));
        }
        if (topology(part).closed()) {
            fate.turn[p] = volume < 0;
            return;
        }
        // Samples evenly spaced in area.
        const int samples = std::clamp(static_cast<int>(1000.0 * area / total_area), 3, 500);
        double walked = 0.0;
        int taken = 0, front = 0, back = 0;
        for (const int t : members[p]) {
            const auto c = mesh.corners(t);
            const Vector3 n = area_vector(c);
            walked += 0.5 * norm(n);
            if (walked < area * (taken + 0.5) / samples) continue;
            interruption_point();
            while (taken < samples && walked >= area * (taken + 0.5) / samples) ++taken;
            const Vector3 unit = (1.0 / norm(n)) * n, centre = (1.0 / 3.0) * (c[0] + c[1] + c[2]);
            for (int d = 0; d < directions; ++d) {  // spiral of evenly spread directions
                const double z = 1.0 - (2.0 * d + 1.0) / directions, r = std::sqrt(1.0 - z * z), angle = 2.399963 * d;
                Vector3 direction{r * std::cos(angle), r * std::sin(angle), z};
                if (dot(direction, unit) < 0) direction = -1.0 * direction;
                front += !surface.is_blocked(centre + step * unit, direction);
                back += !surface.is_blocked(centre - step * unit, -1.0 * direction);
            }
        }
        fate.turn[p] = back > front;
        fate.hidden[p] = front + back < samples * directions / 50;  // 1 %
    });
    Turned result;
    result.filled_cavity = keep_cavity_walls(mesh, patch, fate);
    std::vector<std::array<int, 3>> kept;
    kept.reserve(mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const int p = patch.of_triangle[t];
        if (fate.hidden[p]) {
            ++result.hidden;
            continue;
        }
        kept.push_back(mesh.triangles[t]);
        if (fate.turn[p]) std::swap(kept.back()[1], kept.back()[2]), ++result.turned;
    }
    if (kept.empty()) return {};  // nothing sees the outside: leave it to the winding number
    mesh.triangles = std::move(kept);
    return result;
}

namespace {

/// Generalised winding number minus 1/2 at the nodes. It is computed near the triangles and where it may pass 1/2 in a
/// hole; elsewhere a neighbour's value will do: it is harmonic off the surface, so it changes little where it is near 0
/// or 1 and no triangle lies between.
std::vector<float> winding_above_half(const TriangleTree& tree, const Lattice& lattice,
                                      const std::vector<float>& distance) {
    constexpr int block = 4;
    const double near = 1.05 * lattice.spacing;
    const int nx = lattice.nodes[0], ny = lattice.nodes[1], nz = lattice.nodes[2];  // clang 14 captures no bindings
    const std::array<int, 3> corners{(nx - 1) / block + 2, (ny - 1) / block + 2, (nz - 1) / block + 2};
    const auto corner_index = [&](int i, int j, int k) {
        return i + static_cast<std::size_t>(corners[0]) * (j + static_cast<std::size_t>(corners[1]) * k);
    };
    const auto evaluated = [&](int i, int j, int k) {
        return static_cast<float>(tree.winding_number(lattice.position(i, j, k)) - 0.5);
    };
    std::vector<float> coarse(static_cast<std::size_t>(corners[0]) * corners[1] * corners[2]);
    tbb::parallel_for(0, corners[2], [&](int k) {
        for (int j = 0; j < corners[1]; ++j) {
            interruption_point();
            for (int i = 0; i < corners[0]; ++i)
                coarse[corner_index(i, j, k)] = evaluated(i * block, j * block, k * block);
        }
    });

    enum State : char { open, known, copied };
    std::vector<float> result(lattice.node_count());
    std::vector<char> state(lattice.node_count(), open);
    tbb::parallel_for(0, corners[2] - 1, [&](int bk) {
        for (int bj = 0; bj + 1 < corners[1]; ++bj) {
            interruption_point();
            for (int bi = 0; bi + 1 < corners[0]; ++bi) {
                int above = 0;
                bool may_pass_half = false, has_surface = false;
                for (int c = 0; c < 8; ++c) {
                    const float w = coarse[corner_index(bi + (c & 1), bj + (c >> 1 & 1), bk + (c >> 2))];
                    above += w > 0;
                    may_pass_half |= std::abs(w) < 0.15F;
                }
                may_pass_half |= above != 0 && above != 8;
                const int i1 = std::min(nx, (bi + 1) * block), j1 = std::min(ny, (bj + 1) * block);
                const int k1 = std::min(nz, (bk + 1) * block);
                for (int k = bk * block; k < k1; ++k) {
                    for (int j = bj * block; j < j1; ++j) {
                        for (int i = bi * block; i < i1; ++i) {
                            const std::size_t n = lattice.index(i, j, k);
                            if (distance[n] > near) continue;
                            has_surface = true;
                            result[n] = evaluated(i, j, k);
                            state[n] = known;
                        }
                    }
                }
                if (has_surface || may_pass_half) continue;
                for (int k = bk * block; k < k1; ++k) {
                    for (int j = bj * block; j < j1; ++j) {
                        for (int i = bi * block; i < i1; ++i) {
                            result[lattice.index(i, j, k)] = coarse[corner_index(bi, bj, bk)];
                            state[lattice.index(i, j, k)] = known;
                        }
                    }
                }
            }
        }
    });
    // Two rounds, so that a copy of a copy is the farthest a value travels.
    const std::array<std::ptrdiff_t, 3> stride{1, nx, static_cast<std::ptrdiff_t>(nx) * ny};
    for (int round = 0; round < 2; ++round) {
        std::vector<std::pair<std::size_t, float>> copies;
        for (int k = 1; k < nz - 1; ++k) {
            for (int j = 1; j < ny - 1; ++j) {
                for (int i = 1; i < nx - 1; ++i) {
                    const std::size_t n = lattice.index(i, j, k);
                    if (state[n] != open) continue;
                    for (int side = 0; side < 6; ++side) {
                        const std::size_t other = side % 2 ? n + stride[side / 2] : n - stride[side / 2];
                        if (state[other] == open || std::abs(result[other]) < 0.4F) continue;
                        copies.emplace_back(n, result[other]);
                        break;
                    }
                }
            }
        }
        for (const auto& [n, value] : copies) result[n] = value, state[n] = copied;
    }
    tbb::parallel_for(0, nz, [&](int k) {
        for (int j = 0; j < ny; ++j) {
            interruption_point();
            for (int i = 0; i < nx; ++i) {
                const std::size_t n = lattice.index(i, j, k);
                if (state[n] == open) result[n] = evaluated(i, j, k);
            }
        }
    });
    return result;
}

}  // namespace

TriangleMesh rebuilt_open(const TriangleTree& tree, const Lattice& lattice, const std::vector<float>& distance) {
    const auto h = static_cast<float>(lattice.spacing);
    const std::vector<float> w = winding_above_half(tree, lattice, distance);
    const int nx = lattice.nodes[0], ny = lattice.nodes[1], nz = lattice.nodes[2];  // clang 14 captures no bindings
    std::vector<float> values(lattice.node_count(), -3.0F * h);
    tbb::parallel_for(1, nz - 1, [&](int k) {
        for (int j = 1; j < ny - 1; ++j) {
            for (int i = 1; i < nx - 1; ++i) {
                const std::size_t n = lattice.index(i, j, k);
                float size = std::min(distance[n], 3.0F * h);
                if (distance[n] > h) {
                    const float gx = w[lattice.index(i + 1, j, k)] - w[lattice.index(i - 1, j, k)];
                    const float gy = w[lattice.index(i, j + 1, k)] - w[lattice.index(i, j - 1, k)];
                    const float gz = w[lattice.index(i, j, k + 1)] - w[lattice.index(i, j, k - 1)];
                    const float slope = std::sqrt(gx * gx + gy * gy + gz * gz) / (2.0F * h);
                    if (std::abs(w[n]) < slope * size) size = std::abs(w[n]) / slope;
                }
                values[n] = w[n] > 0 ? size : -size;
            }
        }
    });

    return isosurface(lattice, values);
}

}  // namespace morphodesic::datasets

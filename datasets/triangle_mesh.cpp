#include "datasets/triangle_mesh.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <numeric>
#include <unordered_map>

#include "datasets/interruption.h"

namespace morphodesic::datasets {
namespace {

/// One side of a triangle, named by its two points in ascending order.
struct HalfEdge {
    int low, high, triangle;
    bool forward;  ///< the triangle runs from low to high
};

std::vector<HalfEdge> sorted_half_edges(const TriangleMesh& mesh) {
    std::vector<HalfEdge> edges;
    edges.reserve(3 * mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (int c = 0; c < 3; ++c) {
            const int a = mesh.triangles[t][c], b = mesh.triangles[t][(c + 1) % 3];
            edges.push_back({std::min(a, b), std::max(a, b), static_cast<int>(t), a < b});
        }
    }
    const auto by_points = [](const HalfEdge& a, const HalfEdge& b) {
        return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
    };
    // Piece by piece, so that it may be given up in between.
    constexpr std::size_t piece = std::size_t{1} << 20;
    const auto at = [&](std::size_t i) {
        return edges.begin() + static_cast<std::ptrdiff_t>(std::min(i, edges.size()));
    };
    for (std::size_t i = 0; i < edges.size(); i += piece) {
        interruption_point();
        std::sort(at(i), at(i + piece), by_points);
    }
    for (std::size_t width = piece; width < edges.size(); width *= 2) {
        for (std::size_t i = 0; i + width < edges.size(); i += 2 * width) {
            interruption_point();
            std::inplace_merge(at(i), at(i + width), at(i + 2 * width), by_points);
        }
    }
    interruption_point();
    return edges;
}

/// Calls visit(first, last) for the half edges of each edge.
template <class Visit>
void for_each_edge(const std::vector<HalfEdge>& edges, Visit&& visit) {
    for (std::size_t i = 0; i < edges.size();) {
        std::size_t j = i + 1;
        while (j < edges.size() && edges[j].low == edges[i].low && edges[j].high == edges[i].high) ++j;
        visit(i, j);
        i = j;
    }
}

/// Two neighbouring triangles and whether their orientations agree.
struct Neighbours {
    int a, b;
    bool agree;
};
std::vector<Neighbours> manifold_neighbours(const TriangleMesh& mesh) {
    const auto edges = sorted_half_edges(mesh);
    std::vector<Neighbours> result;
    for_each_edge(edges, [&](std::size_t i, std::size_t j) {
        if (j - i == 2) {
            result.push_back({edges[i].triangle, edges[i + 1].triangle, edges[i].forward != edges[i + 1].forward});
        }
    });
    return result;
}

struct PointHash {
    std::size_t operator()(const Vector3& p) const {
        std::uint64_t h = 0x9e3779b97f4a7c15ULL;
        for (const double x : p) {
            h ^= std::bit_cast<std::uint64_t>(x);
            h *= 0xff51afd7ed558ccdULL;
            h ^= h >> 32;
        }
        return h;
    }
};

int find_root(std::vector<int>& parent, int i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

Patches numbered(std::vector<int>& parent, const std::vector<int>& of_triangle_node) {
    Patches result;
    std::vector<int> number(parent.size(), -1);
    result.of_triangle.reserve(of_triangle_node.size());
    for (const int node : of_triangle_node) {
        int& n = number[find_root(parent, node)];
        if (n < 0) n = result.count++;
        result.of_triangle.push_back(n);
    }
    return result;
}

}  // namespace

Box3 bounding_box(std::span<const Vector3> points) {
    Box3 box{points.front(), points.front()};
    for (const auto& p : points) box.include(p);
    return box;
}

double surface_area(const TriangleMesh& mesh) {
    double sum = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) sum += norm(area_vector(mesh.corners(t)));
    return 0.5 * sum;
}

double signed_volume(const TriangleMesh& mesh) {
    if (mesh.points.empty()) return 0.0;
    const Vector3 o = mesh.points.front();  // near the surface, so that far from the origin no digits are lost
    double sum = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto c = mesh.corners(t);
        sum += dot(c[0] - o, cross(c[1] - o, c[2] - o));
    }
    return sum / 6.0;
}

Vector3 volume_centroid(const TriangleMesh& mesh) {
    const Vector3 o = mesh.points.front();
    Vector3 moment{};
    double volume = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto c = mesh.corners(t);
        const Vector3 a = c[0] - o, b = c[1] - o, d = c[2] - o;
        const double six_volumes = dot(a, cross(b, d));
        volume += six_volumes;
        moment = moment + (six_volumes / 4.0) * (a + b + d);
    }
    return o + (1.0 / volume) * moment;
}

MeshTopology topology(const TriangleMesh& mesh) {
    MeshTopology result;
    const auto edges = sorted_half_edges(mesh);
    for_each_edge(edges, [&](std::size_t i, std::size_t j) {
        const auto forward =
            std::count_if(edges.begin() + static_cast<std::ptrdiff_t>(i),
                          edges.begin() + static_cast<std::ptrdiff_t>(j), [](const HalfEdge& e) { return e.forward; });
        const bool balanced = 2 * static_cast<std::size_t>(forward) == j - i;
        if (j - i == 1) ++result.boundary_edges;
        if (j - i > 2) ++result.crowded_edges;
        if (j - i == 2 && !balanced) ++result.inconsistent_edges;
        if (!balanced) ++result.unbalanced_edges;
    });
    return result;
}

CleaningReport clean(TriangleMesh& mesh) {
    CleaningReport report;
    const bool is_cloud = mesh.triangles.empty();
    std::unordered_map<Vector3, int, PointHash> index_of;
    index_of.reserve(mesh.points.size());
    std::vector<Vector3> points;
    std::vector<int> merged(mesh.points.size());
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        interruption_point(i);
        const Vector3 p = mesh.points[i] + Vector3{};  // -0 becomes 0
        const auto [it, is_new] = index_of.try_emplace(p, static_cast<int>(points.size()));
        if (is_new) points.push_back(p);
        merged[i] = it->second;
    }
    report.merged_points = mesh.points.size() - points.size();
    mesh.points = std::move(points);

    std::vector<std::array<int, 3>> kept;
    kept.reserve(mesh.triangles.size());
    for (auto t : mesh.triangles) {
        for (int& c : t) c = merged[c];
        // A sliver between three different points stays: without it its neighbours would have a crack between them.
        if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) {
            kept.push_back(t);
        } else {
            ++report.degenerate_triangles;
        }
    }
    std::vector<std::pair<std::array<int, 3>, int>> sorted;
    sorted.reserve(kept.size());
    for (std::size_t i = 0; i < kept.size(); ++i) {
        auto key = kept[i];
        std::sort(key.begin(), key.end());
        sorted.emplace_back(key, static_cast<int>(i));
    }
    interruption_point();
    std::sort(sorted.begin(), sorted.end());
    interruption_point();
    std::vector<char> repeated(kept.size(), 0);
    for (std::size_t i = 1; i < sorted.size(); ++i) {
        if (sorted[i].first == sorted[i - 1].first) {
            repeated[sorted[i].second] = 1;
            ++report.repeated_triangles;
        }
    }
    mesh.triangles.clear();
    for (std::size_t i = 0; i < kept.size(); ++i) {
        if (!repeated[i]) mesh.triangles.push_back(kept[i]);
    }
    if (!is_cloud) {
        std::vector<int> new_index(mesh.points.size(), -1);
        std::vector<Vector3> used;
        for (auto& t : mesh.triangles) {
            for (int& c : t) {
                if (new_index[c] < 0) {
                    new_index[c] = static_cast<int>(used.size());
                    used.push_back(mesh.points[c]);
                }
                c = new_index[c];
            }
        }
        report.unused_points = mesh.points.size() - used.size();
        mesh.points = std::move(used);
    }
    return report;
}

Patches patches(const TriangleMesh& mesh, bool across_all_points) {
    std::vector<int> node(mesh.triangles.size());
    std::vector<int> parent(across_all_points ? mesh.points.size() : mesh.triangles.size());
    std::iota(parent.begin(), parent.end(), 0);
    if (across_all_points) {
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            const auto& c = mesh.triangles[t];
            node[t] = c[0];
            parent[find_root(parent, c[1])] = find_root(parent, c[0]);
            parent[find_root(parent, c[2])] = find_root(parent, c[0]);
        }
    } else {
        std::iota(node.begin(), node.end(), 0);
        for (const auto& n : manifold_neighbours(mesh)) parent[find_root(parent, n.a)] = find_root(parent, n.b);
    }
    return numbered(parent, node);
}

std::size_t orient_patches(TriangleMesh& mesh, const Patches& patches) {
    const auto pairs = manifold_neighbours(mesh);
    std::vector<std::vector<std::pair<int, bool>>> next(mesh.triangles.size());
    for (const auto& p : pairs) {
        next[p.a].emplace_back(p.b, p.agree);
        next[p.b].emplace_back(p.a, p.agree);
    }
    interruption_point();
    std::vector<signed char> turned(mesh.triangles.size(), -1);
    std::vector<double> kept_area(patches.count, 0.0), turned_area(patches.count, 0.0);
    std::vector<int> queue;
    for (std::size_t start = 0; start < mesh.triangles.size(); ++start) {
        if (turned[start] >= 0) continue;
        turned[start] = 0;
        queue.assign(1, static_cast<int>(start));
        while (!queue.empty()) {
            const int t = queue.back();
            queue.pop_back();
            interruption_point(static_cast<std::size_t>(t));
            (turned[t] ? turned_area : kept_area)[patches.of_triangle[t]] += norm(area_vector(mesh.corners(t)));
            for (const auto& [other, agree] : next[t]) {
                if (turned[other] >= 0) continue;
                turned[other] = agree ? turned[t] : !turned[t];
                queue.push_back(other);
            }
        }
    }
    std::size_t count = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const int p = patches.of_triangle[t];
        if ((turned[t] != 0) != (turned_area[p] > kept_area[p])) {
            std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
            ++count;
        }
    }
    return count;
}

void leave_out_inconsistent(TriangleMesh& mesh) {
    const auto edges = sorted_half_edges(mesh);
    std::vector<char> out(mesh.triangles.size(), 0);
    for_each_edge(edges, [&](std::size_t i, std::size_t j) {
        if (j - i == 1 || (j - i == 2 && edges[i].forward != edges[i + 1].forward)) return;
        for (std::size_t e = i; e < j; ++e) out[edges[e].triangle] = 1;
    });
    std::size_t kept = 0;
    for (std::size_t t = 0; t < out.size(); ++t) {
        if (!out[t]) mesh.triangles[kept++] = mesh.triangles[t];
    }
    mesh.triangles.resize(kept);
}

void turn_inside_out(TriangleMesh& mesh) {
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
}

void mirror(TriangleMesh& mesh) {
    for (auto& p : mesh.points) p[0] = -p[0];
    turn_inside_out(mesh);
}

}  // namespace morphodesic::datasets

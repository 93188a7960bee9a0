#include "datasets/strays.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <utility>

#include "datasets/interruption.h"

namespace morphodesic::datasets {
namespace {

constexpr double most = 0.01;   // share of the area or of the points
constexpr double margin = 0.5;  // of the object's longest side: what is nearer may belong to it and costs few cells
constexpr double link = 0.1;    // of the object's longest side: points that are nearer to each other hang together

/// Which piece each triangle or point is of.
struct Pieces {
    std::vector<int> of_item;
    int count = 0;
};

/// Box around what is left when the share of strays is cut away on each side.
/// @param box_of, weight_of  (item) -> Box3, its share of the whole in any units
template <class BoxOf, class WeightOf>
Box3 core_box(std::size_t items, BoxOf&& box_of, WeightOf&& weight_of) {
    Box3 core;
    double total = 0.0;
    for (std::size_t i = 0; i < items; ++i) total += weight_of(i);
    std::vector<std::pair<double, double>> ends(items);  // place, weight
    const auto beyond_strays = [&] {
        interruption_point();
        std::sort(ends.begin(), ends.end());
        double passed = 0.0;
        for (const auto& [place, weight] : ends) {
            passed += weight;
            if (passed > most * total) return place;
        }
        return ends.back().first;
    };
    for (int a = 0; a < 3; ++a) {
        for (std::size_t i = 0; i < items; ++i) ends[i] = {box_of(i).low[a], weight_of(i)};
        core.low[a] = beyond_strays();
        for (std::size_t i = 0; i < items; ++i) ends[i] = {-box_of(i).high[a], weight_of(i)};
        core.high[a] = -beyond_strays();
    }
    return core;
}

/// The core and all around it that is not far.
Box3 surroundings(const Box3& core) {
    return core.grown(margin * core.longest_side());
}

/// Which pieces lie outside of a box with all they have [pieces].
template <class BoxOf>
std::vector<char> pieces_outside(const Box3& box, const Pieces& piece, BoxOf&& box_of) {
    std::vector<Box3> around(piece.count, Box3::empty());
    for (std::size_t i = 0; i < piece.of_item.size(); ++i) around[piece.of_item[i]].include(box_of(i));
    std::vector<char> outside(piece.count);
    for (int p = 0; p < piece.count; ++p) outside[p] = around[p].is_apart(box) ? 1 : 0;
    return outside;
}

/// Takes closed pieces that are more than specks off the list of far ones.
void keep_parts(const TriangleMesh& mesh, const Pieces& piece, double speck_fraction, std::vector<char>& is_far) {
    std::vector<TriangleMesh> far(piece.count);  // without points: topology only compares indices
    std::vector<double> volume(piece.count, 0.0);
    std::vector<Vector3> origin(piece.count);  // on the piece, so that far away no digits are lost
    const Vector3* rest_origin = nullptr;
    double rest = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const int p = piece.of_item[t];
        const auto c = mesh.corners(t);
        if (is_far[p] == 0) {
            if (rest_origin == nullptr) rest_origin = &mesh.points[mesh.triangles[t][0]];
            rest += dot(c[0] - *rest_origin, cross(c[1] - *rest_origin, c[2] - *rest_origin));
            continue;
        }
        if (far[p].triangles.empty()) origin[p] = c[0];
        far[p].triangles.push_back(mesh.triangles[t]);
        volume[p] += dot(c[0] - origin[p], cross(c[1] - origin[p], c[2] - origin[p]));
    }
    for (int p = 0; p < piece.count; ++p) {
        if (is_far[p] == 0 || !topology(far[p]).closed()) continue;
        is_far[p] = std::abs(volume[p]) < speck_fraction * std::abs(rest) ? 1 : 0;
    }
}

/// Points that hang together: those in neighbouring cells of a grid.
Pieces groups_of(const std::vector<Vector3>& points, const Vector3& origin, double cell) {
    constexpr std::int64_t half = std::int64_t{1} << 20;  // cells farther away count as one
    using Cell = std::array<std::int64_t, 3>;
    const auto cell_of = [&](const Vector3& p) {
        Cell c;
        for (int a = 0; a < 3; ++a) {
            const double place = std::floor((p[a] - origin[a]) / cell);
            c[a] = static_cast<std::int64_t>(std::clamp(place, 1.0 - half, half - 2.0)) + half;
        }
        return c;
    };
    const auto key = [](const Cell& c) { return (c[2] << 42) | (c[1] << 21) | c[0]; };
    std::unordered_map<std::int64_t, int> group;
    for (const auto& p : points) group.emplace(key(cell_of(p)), -1);
    Pieces result;
    std::vector<Cell> queue;
    for (const auto& p : points) {
        queue.push_back(cell_of(p));
        if (int& first = group.at(key(queue.back())); first < 0) first = result.count++;
        const int number = group.at(key(queue.back()));
        result.of_item.push_back(number);
        while (!queue.empty()) {
            const Cell c = queue.back();
            queue.pop_back();
            for (int n = 0; n < 27; ++n) {
                const Cell other{c[0] + n % 3 - 1, c[1] + n / 3 % 3 - 1, c[2] + n / 9 - 1};
                const auto found = group.find(key(other));
                if (found == group.end() || found->second >= 0) continue;
                found->second = number;
                queue.push_back(other);
            }
        }
    }
    return result;
}

/// Drops the items of far pieces, unless together they are too many.
template <class Item, class WeightOf>
Strays drop(std::vector<Item>& items, const Pieces& piece, const std::vector<char>& is_far, WeightOf&& weight_of) {
    Strays strays;
    double total = 0.0, far = 0.0;
    for (std::size_t i = 0; i < items.size(); ++i) {
        total += weight_of(i);
        if (is_far[piece.of_item[i]] != 0) far += weight_of(i), ++strays.count;
    }
    if (strays.count == 0 || far > most * total) return {};
    strays.share = far / total;
    std::vector<Item> kept;
    kept.reserve(items.size() - strays.count);
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (is_far[piece.of_item[i]] == 0) kept.push_back(items[i]);
    }
    items = std::move(kept);
    return strays;
}

}  // namespace

Strays leave_out_strays(TriangleMesh& mesh, double speck_fraction) {
    const Patches patch = patches(mesh, true);
    const Pieces piece{patch.of_triangle, patch.count};
    if (piece.count == 1) return {};
    const auto box_of = [&](std::size_t t) { return bounding_box(mesh.corners(t)); };
    const auto area_of = [&](std::size_t t) { return norm(area_vector(mesh.corners(t))); };
    const Box3 near = surroundings(core_box(mesh.triangles.size(), box_of, area_of));
    std::vector<char> is_far = pieces_outside(near, piece, box_of);
    if (std::count(is_far.begin(), is_far.end(), 0) == piece.count) return {};
    keep_parts(mesh, piece, speck_fraction, is_far);
    const Strays strays = drop(mesh.triangles, piece, is_far, area_of);
    if (strays.count > 0) clean(mesh);  // points of no triangle would count in every box
    return strays;
}

Strays leave_out_strays(std::vector<Vector3>& points) {
    const auto box_of = [&](std::size_t i) { return Box3{points[i], points[i]}; };
    const auto one = [](std::size_t) { return 1.0; };
    const Box3 core = core_box(points.size(), box_of, one);
    const Box3 near = surroundings(core), all = bounding_box(points);
    const double length = core.longest_side();
    // No point is far, or there is no object.
    bool is_all_near = true;
    for (int a = 0; a < 3; ++a) is_all_near &= all.low[a] >= near.low[a] && all.high[a] <= near.high[a];
    if (is_all_near || !(length > 0.0)) return {};
    const Pieces group = groups_of(points, core.low, link * length);
    return drop(points, group, pieces_outside(near, group, box_of), one);
}

}  // namespace morphodesic::datasets

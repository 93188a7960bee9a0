#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>

#include "datasets/distance_transform.h"
#include "datasets/interruption.h"
#include "datasets/note_text.h"
#include "datasets/open_surface.h"
#include "datasets/point_closing.h"
#include "datasets/point_surface.h"
#include "datasets/read_error.h"
#include "datasets/scan_checks.h"
#include "datasets/solidify.h"
#include "datasets/strays.h"
#include "datasets/triangle_tree.h"
#include "datasets/voxelize.h"

namespace morphodesic::datasets {
namespace {

constexpr double largest_ball = 0.25;   // of the length: a larger one would lie in the object rather than on it
constexpr double deep_inside = 0.03;    // of the size: points there are no noise of the surface
constexpr double most_uneven = 0.25;    // of the reach of a plane; where points fill space it is 0.3 to 0.45
constexpr double most_off = 0.01;       // of the points: more off a surface do not belong to it
constexpr double least_unused = 0.005;  // of the points: fewer are not worth a note

/// Points that are not on the surface that was made of a cloud.
struct UnusedPoints {
    std::size_t off = 0;      ///< farther from it than looked for
    std::size_t outside = 0;  ///< of these, those outside of the solid
    std::size_t deep = 0;     ///< those far inside
};
/// @param far   from this distance on a point is off the surface
/// @param deep  from this distance on one inside is no noise of the surface, >= far
UnusedPoints unused_points(const std::vector<Vector3>& points, const TriangleMesh& mesh, double far, double deep) {
    const TriangleTree surface(mesh);
    std::atomic<std::size_t> off = 0, outside = 0, inside = 0;
    tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
        interruption_point(i, 64);
        const double distance = surface.nearest(points[i], deep).distance;
        if (distance < far) return;
        ++off;
        if (surface.winding_number(points[i]) < 0.5) {
            ++outside;
        } else if (distance >= deep) {
            ++inside;
        }
    });
    return {off, outside, inside};
}

/// Whole parts may be too sparse to be closed, and what lies in the middle of a solid may have been the wall of a
/// cavity.
void note_unused(const UnusedPoints& unused, std::size_t points, Solid& solid) {
    const auto note = [&](std::size_t number, const char* where, const char* why) {
        const double share = static_cast<double>(number) / static_cast<double>(points);
        if (share < least_unused) return;
        solid.notes.push_back(count(number, "point") + " (" + percent(share) + ") " + (number == 1 ? "lies " : "lie ") +
                              where + ": " + why + ".");
    };
    note(unused.outside, "outside of the solid", "too sparse to be closed, or stray");
    note(unused.deep, "deep within the solid", "if they are the wall of a cavity, it was filled");
}

double typical_spacing(const std::vector<Vector3>& points) {
    const std::vector<double> spacings = sorted_spacings(points);
    return spacings[spacings.size() / 2];
}

/// One point, the mean, for all in a cell of a grid.
std::vector<Vector3> thinned(const std::vector<Vector3>& points, double cell) {
    const Vector3 low = bounding_box(points).low;
    using Key = std::array<std::int64_t, 3>;
    std::vector<std::pair<Key, std::size_t>> order(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        for (int a = 0; a < 3; ++a)
            order[i].first[a] = static_cast<std::int64_t>(std::floor((points[i][a] - low[a]) / cell));
        order[i].second = i;
    }
    std::sort(order.begin(), order.end());
    std::vector<Vector3> result;
    for (std::size_t i = 0, end = 0; i < order.size(); i = end) {
        Vector3 sum{};
        for (end = i; end < order.size() && order[end].first == order[i].first; ++end)
            sum = sum + points[order[end].second];
        result.push_back((1.0 / static_cast<double>(end - i)) * sum);
    }
    return result;
}

/// The solid whose surface runs through the points, if they lie on that of one: triangles between neighbours, closed as
/// scans are.
/// @throws ReadError if the triangles enclose nothing, or too much would be made up
std::optional<Solid> solid_between_neighbours(const std::vector<Vector3>& points, const std::filesystem::path& file,
                                              const SolidifyOptions& options, std::vector<std::string> notes) {
    const Box3 box = bounding_box(points);
    double spacing = typical_spacing(points);
    // More points than the grid can show cost time, and where noise is wider than their distances triangles are a mess.
    // Copies of a point, a rounding apart, are no neighbours.
    const double finest = 0.5 * box.longest_side() / options.cells;
    PointSurface surface = surface_through(thinned(points, spacing < finest ? finest : 0.2 * spacing));
    for (int round = 0; round < 3 && surface.unevenness > most_uneven; ++round) {
        spacing = typical_spacing(surface.mesh.points);
        surface = surface_through(thinned(surface.mesh.points, 1.4 * spacing));
    }
    TriangleMesh& mesh = surface.mesh;
    if (mesh.triangles.empty()) return std::nullopt;
    std::string what = "A cloud of " + count(points.size(), "point");
    if (10 * mesh.points.size() < 9 * points.size()) what += ", thinned to " + std::to_string(mesh.points.size()) + ",";
    what += " was joined to triangles";
    spacing = typical_spacing(mesh.points);
    clean(mesh);
    TriangleMesh drawn = mesh;
    Solid solid;
    if (topology(mesh).closed()) {
        solid = solid_from_triangles(std::move(mesh), file, options);
        notes.push_back(what + ", which close.");
        solid.notes.insert(solid.notes.begin(), notes.begin(), notes.end());
    } else {
        const Turned outward = turn_patches_outward(mesh, patches(mesh), TriangleTree(mesh));
        if (outward.filled_cavity) notes.emplace_back("An inner cavity was filled, as its wall is too open.");
        solid = closed_by_winding_numbers(std::move(mesh), what, file, options, std::move(notes), spacing);
    }
    const double far = 2.0 * spacing, deep = std::max(far, deep_inside * box.diagonal());
    const UnusedPoints unused = unused_points(points, solid.mesh, far, deep);
    if (static_cast<double>(unused.off) > most_off * static_cast<double>(points.size())) return std::nullopt;
    note_unused(unused, points.size(), solid);
    solid.drawn = std::move(drawn);
    solid.spacing = spacing;
    return solid;
}

/// Says why neither triangles nor a ball find an inside.
/// @param refusal  what the triangles were refused for
[[noreturn]] void refuse_points(const std::vector<Vector3>& points, double typical,
                                const std::optional<ReadError>& refusal, const std::filesystem::path& file) {
    const Box3 box = bounding_box(points);
    const double longest = box.longest_side(), size = box.diagonal();
    // Between two walls a ball that passes through no gap between points leaves a volume, on a single one (almost)
    // none.
    const double area = static_cast<double>(points.size()) * std::numbers::pi / 6.0 * typical * typical;
    const Lattice fine = lattice_around(box, longest / 72, 2.0 * typical);
    const double thickness = 2.0 * closing(fine, distance_to_points(fine, points), 2.0 * typical).volume / area;
    if (thickness > 1.5 * typical && thickness < 10.0 * typical) {
        throw ReadError(file,
                        "the points are too few for so thin a solid: it is about " + percent(thickness / size) +
                            " of its size thick, and between neighbours lie " + percent(typical / size),
                        "use a cloud of several times as many points, or a mesh");
    }
    if (refusal) throw ReadError(*refusal);
    throw ReadError(file, "the points enclose no volume (a scan of one side, or one with very wide gaps)",
                    "use points from all sides of the object");
}

/// What a ball that fits through no gap between the points cannot reach from outside.
/// @param refusal  what the triangles between them were refused for, if they were
/// @throws ReadError if it reaches everything
Solid rolled_around(const std::vector<Vector3>& points, const std::optional<ReadError>& refusal,
                    const std::filesystem::path& file, const SolidifyOptions& options, std::vector<std::string> notes) {
    const double typical = typical_spacing(points);
    const Box3 box = bounding_box(points);
    const double size = box.diagonal();
    // From the typical gap between points up to the widest that may be closed; the first that holds tight: a ball a
    // quarter larger finds (almost) the same solid, so no leak was left.
    const double longest = box.longest_side();
    const double widest = std::min(0.5 * options.close_gaps * size, largest_ball * longest);
    double radius = 0.0, tight_volume = 0.0;
    {
        const Lattice coarse = lattice_around(box, longest / 72, widest);
        const std::vector<float> distance = distance_to_points(coarse, points);
        Closing before = closing(coarse, distance, typical);
        for (double r = typical; r <= widest && radius == 0.0;) {
            const double next = 1.25 * r;
            Closing after = closing(coarse, distance, next);
            if (before.has_core && after.volume <= 1.2 * before.volume) radius = r, tight_volume = before.volume;
            before = std::move(after);
            r = next;
        }
    }
    if (radius == 0.0) refuse_points(points, typical, refusal, file);
    const double h = std::max(longest / options.cells, radius / 8.0);
    const Lattice lattice = lattice_around(box, h, 2.0 * radius);
    const std::vector<float> distance = distance_to_points(lattice, points);
    Closing closed = closing(lattice, distance, radius);
    for (int round = 0; round < 5 && closed.volume < 0.85 * tight_volume; ++round) {  // a leak the coarse nodes hid
        radius *= 1.12;
        closed = closing(lattice, distance, radius);
    }
    TriangleMesh rebuilt = isosurface(lattice, closed.values);
    notes.push_back("A cloud of " + count(points.size(), "point") + "; the inside is what a ball of radius " +
                    percent(radius / size) + " of the object's size cannot reach between them.");
    if (rebuilt.triangles.empty()) return finished_solid(std::move(rebuilt), file, options, std::move(notes));
    const auto is_new = [&](const Piece& piece, double& gap) {
        std::array<int, 3> node;
        for (int a = 0; a < 3; ++a) node[a] = static_cast<int>(std::lround((piece.centre[a] - lattice.origin[a]) / h));
        gap = distance[lattice.index(node[0], node[1], node[2])];
        return gap > 2.0 * typical;
    };
    judge_new_surface(new_surface(rebuilt, is_new), size, file, options, notes);
    Solid solid = finished_solid(std::move(rebuilt), file, options, std::move(notes));
    const double far = 2.0 * radius, deep = std::max(far, deep_inside * size);
    note_unused(unused_points(points, solid.mesh, far, deep), points.size(), solid);
    return solid;
}

int parts_of(const Solid& solid) {
    return patches(solid.mesh, true).count;
}

}  // namespace

Solid solid_from_points(std::vector<Vector3> points, const std::filesystem::path& file,
                        const SolidifyOptions& options) {
    TriangleMesh cloud{std::move(points), {}};
    clean(cloud);
    std::vector<std::string> notes;
    if (!cloud.points.empty()) note_strays(leave_out_strays(cloud.points), "stray point", "points", notes);
    if (cloud.points.size() < 50) {
        throw ReadError(file, "only " + count(cloud.points.size(), "different point") + ", too few for a surface",
                        "use a denser point cloud or a mesh");
    }
    refuse_flat(cloud.points, file);
    std::optional<Solid> joined;
    std::optional<ReadError> refusal;
    try {
        joined = solid_between_neighbours(cloud.points, file, options, notes);
    } catch (const ReadError& error) {
        refusal = error;
    }
    if (joined && parts_of(*joined) == 1) return *std::move(joined);
    // Points that lie on no surface, or so sparsely on it, as on thin parts, that the triangles fall to pieces.
    try {
        Solid rolled = rolled_around(cloud.points, refusal, file, options, std::move(notes));
        if (!joined || parts_of(rolled) < parts_of(*joined)) return rolled;
    } catch (const ReadError&) {
        if (!joined) throw;
    }
    return *std::move(joined);
}

}  // namespace morphodesic::datasets

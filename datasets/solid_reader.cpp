#include "datasets/solid_reader.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>

#include "datasets/distance_transform.h"
#include "datasets/import.h"
#include "datasets/interruption.h"
#include "datasets/mesh_reader.h"
#include "datasets/point_cloud_reader.h"
#include "datasets/read_error.h"
#include "datasets/scan_checks.h"
#include "datasets/solidify.h"
#include "datasets/triangle_tree.h"
#include "datasets/vdb_files.h"
#include "datasets/volume.h"
#include "datasets/voxelize.h"

namespace morphodesic::datasets {
namespace {

/// Name or path against a pattern in which * stands for any characters.
bool matches(std::string_view name, std::string_view pattern) {
    if (pattern.empty()) return name.empty();
    if (pattern.front() == '*') {
        return matches(name, pattern.substr(1)) || (!name.empty() && matches(name.substr(1), pattern));
    }
    return !name.empty() && name.front() == pattern.front() && matches(name.substr(1), pattern.substr(1));
}

std::vector<std::string_view> patterns_of(std::string_view list) {
    std::vector<std::string_view> patterns;
    for (std::size_t begin = 0; begin < list.size();) {
        const std::size_t end = std::min(list.find(',', begin), list.size());
        std::string_view pattern = list.substr(begin, end - begin);
        while (pattern.starts_with(' ')) pattern.remove_prefix(1);
        while (pattern.ends_with(' ')) pattern.remove_suffix(1);
        if (!pattern.empty()) patterns.push_back(pattern);
        begin = end + 1;
    }
    return patterns;
}

bool fits(const std::string& name, std::string_view pattern) {
    const std::string_view file = std::string_view(name).substr(name.rfind('/') + 1);  // npos + 1 is 0
    return matches(name, pattern) || matches(file, pattern);
}

}  // namespace

LevelSet<3> SolidGeometry::signed_distance(const DyadicGrid<3>& grid, const Placement<3>& placement) const {
    TriangleMesh placed = mesh_;
    for (auto& p : placed.points) p = placement(p);
    return datasets::signed_distance(placed, grid);
}

ScalarField<3> SolidGeometry::occlusion_mask(const DyadicGrid<3>& grid, const Placement<3>& placement) const {
    if (invented_.empty()) return {};
    TriangleMesh invented, seen;
    invented.points = seen.points = mesh_.points;
    for (std::size_t t = 0, next = 0; t < mesh_.triangles.size(); ++t) {
        const bool is_new = next < invented_.size() && invented_[next] == t;
        (is_new ? invented : seen).triangles.push_back(mesh_.triangles[t]);
        next += is_new ? 1 : 0;
    }
    if (seen.triangles.empty()) return {};
    for (auto* mesh : {&invented, &seen}) {
        for (auto& p : mesh->points) p = placement(p);
        clean(*mesh);  // points of the other one must not count
    }
    const TriangleTree new_tree(invented), seen_tree(seen);
    const LevelSet<3> u = signed_distance(grid, placement);
    const double h = grid.spacing(), spacing = 0.7 * h;
    // Distances to samples are too large by less than `off`. That decides for most nodes, and far from a surface, where
    // many triangles are almost equally near, the exact ones take long.
    const int n = grid.nodes_per_axis();
    const Lattice lattice{{n, n, n}, {0.0, 0.0, 0.0}, h};
    const std::vector<float> sampled_new = distance_to_points(lattice, surface_samples(invented, spacing)),
                             sampled_seen = distance_to_points(lattice, surface_samples(seen, spacing));
    const double off = 1.2 * h;
    ScalarField<3> chi(grid, 1.0);
    tbb::parallel_for(std::size_t{0}, chi.values.size(), [&](std::size_t i) {
        interruption_point(i);
        if (u.values[i] > h) return;
        const double farther = sampled_new[i] - sampled_seen[i];
        // From so far away the samples are as good as the surface within a tenth of a cell.
        const bool from_afar = std::min(sampled_new[i], sampled_seen[i]) > 8 * h;
        if (from_afar || farther > 1.5 * h + off || farther < 0.5 * h - off) {
            chi.values[i] = std::clamp(farther / h - 0.5, 0.0, 1.0);
            return;
        }
        const Point<3> x = grid.position(grid.node(i));
        const double to_seen = seen_tree.nearest(x, 1.001 * sampled_seen[i]).distance;
        // Points beyond the rim of a hole are as near to one as to the other.
        const double to_new = new_tree.nearest(x, to_seen + 2 * h).distance;
        chi.values[i] = std::clamp((to_new - to_seen) / h - 0.5, 0.0, 1.0);
    });
    return chi;
}

namespace {

/// Triangles of a closed mesh that lie off the triangles of the scan it was made from.
/// @param spacing  of the points of a cloud, see least_gap
std::vector<std::size_t> invented_triangles(const TriangleMesh& closed, const TriangleMesh& scan, double spacing) {
    const Box3 box = bounding_box(closed.points);
    const double cell = std::max({box.side()[0], box.side()[1], box.side()[2]}) / SolidifyOptions{}.cells;
    const double off = least_gap(cell, spacing);
    const TriangleTree tree(scan);
    std::vector<char> is_new(closed.triangles.size(), 0);
    tbb::parallel_for(std::size_t{0}, is_new.size(), [&](std::size_t t) {
        const auto c = closed.corners(t);
        is_new[t] = tree.nearest((1.0 / 3.0) * (c[0] + c[1] + c[2]), off).distance >= off ? 1 : 0;
    });
    std::vector<std::size_t> result;
    for (std::size_t t = 0; t < is_new.size(); ++t) {
        if (is_new[t] != 0) result.push_back(t);
    }
    return result;
}

}  // namespace

RawShape<3> read_shape_3d(const ShapeSource& source, const ImportOptions& options) {
    for (const std::string& problem : options.problems()) throw std::invalid_argument(problem);
    SolidifyOptions solidify;
    solidify.close_gaps = options.close_gaps;
    solidify.speck_fraction = options.speck_fraction;
    solidify.smooth_noise = options.noise == "smooth";
    MeshFile file;
    bool is_level = false;  // bounded by a level of a volume
    TriangleMesh seen;      // what of the surface was in the file, if that is not all
    if (is_point_cloud(source.path)) {
        file.mesh.points = read_point_cloud(source.path, options.max_megabytes, file.notes);
    } else if (is_vdb(source.path)) {
        file.mesh = read_vdb_surface(source.path, options.isovalue, options.max_megabytes, file.notes);
        if (options.inside != "auto") {
            file.notes.emplace_back("--inside has no effect: a VDB grid says itself on which side the object is.");
        }
        is_level = true;
    } else if (is_volume(source.path)) {
        Volume volume = read_volume(source.path, options.max_megabytes);
        VolumeSurface surface = surface_of(source.path, volume, options.isovalue, options.inside);
        file.mesh = std::move(surface.mesh);
        seen = std::move(surface.seen);
        file.notes = std::move(volume.notes);
        is_level = true;
    } else {
        file = read_mesh(source.path, options.max_megabytes);
    }
    const bool hides = options.border == "hides";
    if (hides && !is_level && !file.mesh.triangles.empty() && !topology(file.mesh).closed()) seen = file.mesh;
    Solid solid = is_level && topology(file.mesh).closed()
                      ? finished_solid(std::move(file.mesh), source.path, solidify, {})
                  : file.mesh.triangles.empty() ? solid_from_points(std::move(file.mesh.points), source.path, solidify)
                                                : solid_from_triangles(std::move(file.mesh), source.path, solidify);
    if (!solid.drawn.triangles.empty() && !topology(solid.drawn).closed()) seen = std::move(solid.drawn);
    std::vector<std::size_t> invented;
    if (hides && !seen.triangles.empty()) invented = invented_triangles(solid.mesh, seen, solid.spacing);
    const std::vector<std::string_view> mirrored = patterns_of(options.mirror);
    if (std::any_of(mirrored.begin(), mirrored.end(), [&](auto pattern) { return fits(source.name, pattern); })) {
        mirror(solid.mesh);
        solid.centroid[0] = -solid.centroid[0];
        solid.notes.emplace_back("Mirrored, as --mirror asks.");
    }
    RawShape<3> raw;
    raw.source = source;
    raw.centroid = solid.centroid;
    raw.volume = solid.volume;
    raw.components = patches(solid.mesh).count;
    for (const auto& p : solid.mesh.points) raw.extent_radius = std::max(raw.extent_radius, norm(p - solid.centroid));
    raw.notes = std::move(file.notes);
    raw.notes.insert(raw.notes.end(), solid.notes.begin(), solid.notes.end());
    // Under --normalize none a file made in the coordinates of the cube keeps them; of others it keeps the size.
    const Box3 box = bounding_box(solid.mesh.points);
    if (*std::min_element(box.low.begin(), box.low.end()) > 0.0 &&
        *std::max_element(box.high.begin(), box.high.end()) < 1.0) {
        raw.frame_high = {1.0, 1.0, 1.0};
    } else {
        const double half = box.longest_side() < 1.0 ? 0.5 : 0.7 * box.longest_side();
        const Vector3 centre = box.low + 0.5 * box.side(), reach{half, half, half};
        raw.frame_low = centre - reach;
        raw.frame_high = centre + reach;
    }
    raw.bytes = sizeof(Vector3) * solid.mesh.points.size() + sizeof(std::array<int, 3>) * solid.mesh.triangles.size();
    raw.geometry = std::make_shared<SolidGeometry>(std::move(solid.mesh), std::move(invented));
    return raw;
}

template <>
RawShape<3> read_shape<3>(const ShapeSource& source, const ImportOptions& options) {
    return read_shape_3d(source, options);
}

std::string mirror_remark(const std::string& mirror, const std::vector<ShapeSource>& sources) {
    std::string unused;
    for (const std::string_view pattern : patterns_of(mirror)) {
        const bool used = std::any_of(sources.begin(), sources.end(), [&](const ShapeSource& source) {
            return source.dimension == 3 && fits(source.name, pattern);
        });
        if (!used) unused += (unused.empty() ? "" : ", ") + std::string(pattern);
    }
    if (unused.empty()) return "";
    const bool solids = std::any_of(sources.begin(), sources.end(), [](const auto& s) { return s.dimension == 3; });
    return "--mirror has no effect for " + unused +
           (solids ? ": no solid has such a name." : ": it mirrors solids, and these are images.");
}

}  // namespace morphodesic::datasets

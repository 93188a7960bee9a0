#include "datasets/solid_reader.h"

#include <algorithm>
#include <stdexcept>
#include <string_view>

#include "datasets/import.h"
#include "datasets/mesh_reader.h"
#include "datasets/point_cloud_reader.h"
#include "datasets/read_error.h"
#include "datasets/solidify.h"
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

bool is_listed(const std::string& name, const std::string& list) {
    const std::string_view file = std::string_view(name).substr(name.rfind('/') + 1);  // npos + 1 is 0
    for (std::size_t begin = 0; begin < list.size();) {
        const std::size_t end = std::min(list.find(',', begin), list.size());
        std::string_view pattern = std::string_view(list).substr(begin, end - begin);
        while (pattern.starts_with(' ')) pattern.remove_prefix(1);
        while (pattern.ends_with(' ')) pattern.remove_suffix(1);
        if (!pattern.empty() && (matches(name, pattern) || matches(file, pattern))) return true;
        begin = end + 1;
    }
    return false;
}

}  // namespace

LevelSet<3> SolidGeometry::signed_distance(const DyadicGrid<3>& grid, const Placement<3>& placement) const {
    TriangleMesh placed = mesh_;
    for (auto& p : placed.points) p = placement(p);
    return datasets::signed_distance(placed, grid);
}

RawShape<3> read_shape_3d(const ShapeSource& source, const ImportOptions& options) {
    for (const std::string& problem : options.problems()) throw std::invalid_argument(problem);
    SolidifyOptions solidify;
    solidify.close_gaps = options.close_gaps;
    solidify.speck_fraction = options.speck_fraction;
    MeshFile file;
    bool is_level = false;  // bounded by a level of a volume
    if (is_point_cloud(source.path)) {
        file.mesh.points = read_point_cloud(source.path, options.max_megabytes, file.notes);
    } else if (is_vdb(source.path)) {
        file.mesh = read_vdb_surface(source.path, options.isovalue, options.max_megabytes, file.notes);
        is_level = true;
    } else if (is_volume(source.path)) {
        Volume volume = read_volume(source.path, options.max_megabytes);
        file.mesh = surface_of(source.path, volume, options.isovalue);
        file.notes = std::move(volume.notes);
        is_level = true;
    } else {
        file = read_mesh(source.path, options.max_megabytes);
    }
    Solid solid = is_level && topology(file.mesh).closed()
                      ? finished_solid(std::move(file.mesh), source.path, solidify, {})
                  : file.mesh.triangles.empty() ? solid_from_points(std::move(file.mesh.points), source.path, solidify)
                                                : solid_from_triangles(std::move(file.mesh), source.path, solidify);
    if (is_listed(source.name, options.mirror)) {
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
    // A file made in the coordinates of the cube keeps them under --normalize none; around others there is room.
    const Box3 box = bounding_box(solid.mesh.points);
    if (*std::min_element(box.low.begin(), box.low.end()) > 0.0 &&
        *std::max_element(box.high.begin(), box.high.end()) < 1.0) {
        raw.frame_high = {1.0, 1.0, 1.0};
    } else {
        raw.frame_low = box.low - 0.2 * box.side();
        raw.frame_high = box.high + 0.2 * box.side();
    }
    raw.geometry = std::make_shared<SolidGeometry>(std::move(solid.mesh));
    return raw;
}

template <>
RawShape<3> read_shape<3>(const ShapeSource& source, const ImportOptions& options) {
    return read_shape_3d(source, options);
}

}  // namespace morphodesic::datasets

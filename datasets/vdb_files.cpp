#include "datasets/vdb_files.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "datasets/bytes.h"
#include "datasets/collection_folder.h"
#include "datasets/level_set_surface.h"
#include "datasets/read_error.h"
#include "datasets/solidify.h"
#include "datasets/text_scan.h"
#include "datasets/vdb_check.h"
#include "datasets/vdb_values.h"
#include "datasets/voxelize.h"

namespace morphodesic::datasets {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t largest_voxel_count = 512ULL * 512 * 512;

void write_ply_content(const fs::path& file, const TriangleMesh& mesh, const std::vector<NamedField>& fields) {
    std::string out = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(mesh.points.size()) +
                      "\nproperty float x\nproperty float y\nproperty float z\n";
    for (const auto& f : fields) out += "property float " + f.name + "\n";
    out += "element face " + std::to_string(mesh.triangles.size()) +
           "\nproperty list uchar int vertex_indices\nend_header\n";
    for (const auto& p : mesh.points) {
        for (const double x : p) put(out, static_cast<float>(x));
        for (const auto& f : fields) put(out, static_cast<float>(value_at(*f.field, p)));
    }
    for (const auto& t : mesh.triangles) {
        put(out, std::uint8_t{3});
        for (const int c : t) put(out, static_cast<std::int32_t>(c));
    }
    write_text_file(file, out);
}

}  // namespace

bool is_vdb(const fs::path& file) {
    return TextScan::is_word(file.extension().string(), ".vdb");
}

TriangleMesh read_vdb_surface(const fs::path& file, const std::string& isovalue, double max_megabytes,
                              std::vector<std::string>& notes) {
    CheckedVdb checked = check_vdb(file, max_megabytes, largest_voxel_count);
    openvdb::FloatGrid::Ptr grid;
    if (!checked.content.empty()) {
        grid = read_vdb_values(std::move(checked.content), file);
        if (checked.grid_count > 1) {
            notes.push_back("Of " + std::to_string(checked.grid_count) + " grids, \"" + shortened(checked.grid_name) +
                            "\" was used.");
        }
    }
    if (!grid) throw ReadError(file, "there is no grid of numbers in it", "save a level set, a density or a mask");
    if (!grid->transform().isLinear()) throw ReadError(file, "its grid is not a regular one", "resample it");
    const openvdb::CoordBBox box = grid->evalActiveVoxelBoundingBox();
    if (box.empty()) throw ReadError(file, "its grid is empty", "export or download the file again");
    if (box.volume() > largest_voxel_count) {
        throw ReadError(file, "its grid spans more voxels than 512 x 512 x 512", "resample the volume");
    }
    const openvdb::GridClass said = grid->getGridClass();
    float low = grid->background(), high = low;
    if (said != openvdb::GRID_LEVEL_SET) {
        for (auto it = grid->cbeginValueOn(); it; ++it) low = std::min(low, *it), high = std::max(high, *it);
    }
    // A density is 0 where there is nothing; a distance is positive there.
    const bool looks_like_distances = said == openvdb::GRID_UNKNOWN && grid->background() > 0 && low < 0;
    if (looks_like_distances && isovalue == "auto") {
        notes.emplace_back("The grid does not say what it holds; it was taken for a signed distance, negative inside.");
    }
    const bool is_level_set = said == openvdb::GRID_LEVEL_SET || looks_like_distances;
    double value = is_level_set ? 0.0 : 0.5;
    if (isovalue != "auto") {
        TextScan::number(isovalue, value);
    } else if (!is_level_set) {
        notes.emplace_back("The surface is where the density passes 0.5; --isovalue chooses another value.");
    }
    if (!is_level_set && !(low < value && value < high)) {
        char text[96];
        std::snprintf(text, sizeof text, "its values run from %g to %g, so there is no surface at %g", low, high,
                      value);
        throw ReadError(file, text, "choose --isovalue between them");
    }
    TriangleMesh mesh;
    try {
        mesh = surface_of(*grid, value);
    } catch (const openvdb::Exception&) {
        throw ReadError(file, "some of its values are NaN or infinite, so there is no closed surface",
                        "export it again with numbers everywhere");
    }
    if (signed_volume(mesh) < 0) {
        turn_inside_out(mesh);
    }
    return mesh;
}

double value_at(const ScalarField<3>& field, const Vector3& x) {
    const int n = field.grid.cells_per_axis();
    std::array<int, 3> cell;
    std::array<double, 3> t;
    for (int a = 0; a < 3; ++a) {
        const double p = std::clamp(x[a] * n, 0.0, static_cast<double>(n));
        cell[a] = std::min(static_cast<int>(p), n - 1);
        t[a] = p - cell[a];
    }
    double sum = 0.0;
    for (int c = 0; c < 8; ++c) {
        double weight = 1.0;
        std::array<int, 3> node;
        for (int a = 0; a < 3; ++a) {
            const int up = c >> a & 1;
            node[a] = cell[a] + up;
            weight *= up ? t[a] : 1.0 - t[a];
        }
        if (weight > 0.0) sum += weight * field.values[field.grid.index(node)];
    }
    return sum;
}

void write_vdb(const fs::path& file, const LevelSet<3>& shape, const std::vector<NamedField>& fields) {
    openvdb::initialize();
    const int n = shape.grid.nodes_per_axis();
    const double h = shape.grid.spacing();
    const float band = static_cast<float>(4.0 * h);
    const openvdb::CoordBBox nodes(openvdb::Coord(0), openvdb::Coord(n - 1));
    const auto dense_copy = [&](const std::vector<float>& values, float background) {
        auto grid = openvdb::FloatGrid::create(background);
        const openvdb::tools::Dense<float, openvdb::tools::LayoutXYZ> dense(nodes, const_cast<float*>(values.data()));
        openvdb::tools::copyFromDense(dense, *grid, 0.0F);
        grid->setTransform(openvdb::math::Transform::createLinearTransform(h));
        return grid;
    };
    std::vector<float> outward(shape.values.size());
    for (std::size_t i = 0; i < outward.size(); ++i)
        outward[i] = std::clamp(static_cast<float>(-shape.values[i]), -band, band);
    openvdb::GridPtrVec grids;
    auto level_set = dense_copy(outward, band);
    level_set->setGridClass(openvdb::GRID_LEVEL_SET);
    level_set->setName("shape");
    grids.push_back(level_set);
    for (const auto& f : fields) {
        std::vector<float> values(outward.size(), 0.0F);
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (outward[i] < band) values[i] = static_cast<float>(f.field->values[i]);
        }
        auto grid = dense_copy(values, 0.0F);
        grid->setGridClass(openvdb::GRID_FOG_VOLUME);
        grid->setName(f.name);
        grids.push_back(grid);
    }
    try {
        openvdb::io::File out(file.string());
        out.write(grids);
        out.close();
    } catch (const openvdb::Exception&) {
        throw WriteError(file);
    }
}

void write_ply(const fs::path& file, const LevelSet<3>& shape, const std::vector<NamedField>& fields) {
    const int n = shape.grid.nodes_per_axis();
    const Lattice lattice{{n, n, n}, {0.0, 0.0, 0.0}, shape.grid.spacing()};
    std::vector<float> values(shape.values.begin(), shape.values.end());
    write_ply_content(file, isosurface(lattice, values), fields);
}

void write_ply(const fs::path& file, const TriangleMesh& mesh) {
    write_ply_content(file, mesh, {});
}

}  // namespace morphodesic::datasets

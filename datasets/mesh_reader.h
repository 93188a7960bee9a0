#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "datasets/triangle_mesh.h"

namespace morphodesic::datasets {

/// A mesh as the file has it: polygons cut into triangles, nothing repaired. Without triangles: a point cloud.
struct MeshFile {
    TriangleMesh mesh;
    std::vector<std::string> notes;
};

/// Reads OBJ, PLY (text and binary), STL (text and binary) and OFF.
/// @throws ReadError if the file is damaged, too large or not a mesh
MeshFile read_mesh(const std::filesystem::path& file, double max_megabytes = 1000.0);

}  // namespace morphodesic::datasets

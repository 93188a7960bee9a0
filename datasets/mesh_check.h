#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/triangle_mesh.h"

namespace morphodesic::datasets {

enum class MeshFormat { obj, ply, stl, off };

/// A mesh file that keeps its promises: all counts, indices and numbers have been looked at, so that a parser can be
/// let loose on it.
struct CheckedMesh {
    MeshFormat format = MeshFormat::ply;
    std::string content;  ///< what to parse: the file, or for OBJ and OFF its points and faces written out plainly
    std::size_t point_count = 0;
    std::size_t face_count = 0;   ///< triangles, quads, polygons; 0: a point cloud
    std::vector<Vector3> points;  ///< of a point cloud; empty if there are faces
    std::vector<std::string> notes;
};

/// Larger meshes are refused before memory is asked for.
inline constexpr std::size_t largest_face_count = 20'000'000;

/// The bytes of a file.
/// @throws ReadError if it cannot be read, is empty or larger than max_megabytes
std::string file_content(const std::filesystem::path& file, double max_megabytes);

/// Format by content, else by the ending of the name.
/// @throws ReadError if it is none of the four
MeshFormat mesh_format(const std::filesystem::path& file, std::string_view content);

/// Walks through the whole file: truncated data, counts that lie, indices out of range, coordinates that are not
/// finite.
/// @throws ReadError
CheckedMesh check_mesh(const std::filesystem::path& file, std::string content);

}  // namespace morphodesic::datasets

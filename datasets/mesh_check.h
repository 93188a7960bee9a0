#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/triangle_mesh.h"

namespace morphodesic::datasets {

enum class MeshFormat { obj, ply, stl, off };

/// A mesh file that keeps its promises: all counts, indices and numbers have been looked at. Materials, textures,
/// normals, groups, colours and curves are no part of a shape.
struct CheckedMesh {
    std::vector<Vector3> points;  ///< as the file has them, in double precision
    std::vector<int> face_sizes;  ///< [faces] numbers of corners, at least 3; empty: a point cloud
    std::vector<int> corners;     ///< of all faces, one after the other: numbers of points
    std::vector<std::string> notes;
};

/// Larger meshes are refused before memory is asked for.
inline constexpr std::size_t largest_face_count = 20'000'000;
/// Points are numbered by int.
inline constexpr std::size_t largest_point_count = 2'147'483'647;
/// Polygons of more corners are refused: cutting them takes too long.
inline constexpr std::size_t most_corners = 10'000;

/// Larger coordinates are refused: the cubes of their differences must stay in the range of numbers.
inline constexpr double largest_coordinate = 1e18;

/// What is wrong with a coordinate, as it follows "a coordinate is"; nullptr if nothing is.
const char* coordinate_problem(double x);

/// @throws ReadError if there are more faces than largest_face_count
void check_face_count(const std::filesystem::path& file, std::size_t faces);
/// @param face  its number, from 0
/// @throws ReadError if it has more corners than most_corners
void check_corner_count(const std::filesystem::path& file, std::size_t face, std::size_t corners);

/// The bytes of a file.
/// @throws ReadError if it cannot be read, is empty or larger than max_megabytes
std::string file_content(const std::filesystem::path& file, double max_megabytes);

/// Format by content, else by the ending of the name.
/// @throws ReadError if it is none of the four
MeshFormat mesh_format(const std::filesystem::path& file, std::string_view content);

/// Walks through the whole file: truncated data, counts that lie, indices out of range, coordinates that are not
/// finite.
/// @throws ReadError
CheckedMesh check_mesh(const std::filesystem::path& file, const std::string& content);

}  // namespace morphodesic::datasets

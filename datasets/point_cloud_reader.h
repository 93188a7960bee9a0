#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "datasets/triangle_mesh.h"

namespace morphodesic::datasets {

/// True for the formats read here: .pcd, .xyz (PLY without faces is read by read_mesh).
bool is_point_cloud(const std::filesystem::path& file);

/// Points of a PCD file (text or binary) or of a text file with x y z at the beginning of each line. Points with a
/// coordinate that is not finite are left out of PCD files, where they mean "nothing seen here".
/// @param notes  receives a sentence if points were left out
/// @throws ReadError
std::vector<Vector3> read_point_cloud(const std::filesystem::path& file, double max_megabytes,
                                      std::vector<std::string>& notes);

}  // namespace morphodesic::datasets

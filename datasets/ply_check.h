#pragma once

#include <filesystem>
#include <string_view>

#include "datasets/mesh_check.h"

namespace morphodesic::datasets {

/// check_mesh for PLY, text and binary of both byte orders. Elements other than points and faces are skipped.
CheckedMesh check_ply(const std::filesystem::path& file, std::string_view content);

}  // namespace morphodesic::datasets

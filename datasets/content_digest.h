#pragma once

#include <filesystem>
#include <string>

#include "datasets/shape.h"

namespace morphodesic::datasets {

/// Hexadecimal digest (128 bit, XXH3) of level, level set values as 32-bit floats and occlusion mask. Name and label do
/// not enter; values that differ by less than a float can tell do not either.
template <int Dim>
std::string content_digest(const LevelSet<Dim>& level_set, const ScalarField<Dim>& occlusion_mask = {});

/// Hexadecimal digest of a file's bytes: tells a later run that a file has not changed.
/// @throws ReadError if the file cannot be read
std::string file_digest(const std::filesystem::path& file);

}  // namespace morphodesic::datasets

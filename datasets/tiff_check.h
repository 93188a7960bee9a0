#pragma once

#include <filesystem>
#include <string_view>

namespace morphodesic::datasets {

/// Unpacks the first page of a TIFF once and throws it away. What decodes pictures goes on after an error, with zeros
/// for what is lacking, and mixes up colours of more than 8 bits that lie in planes of their own.
/// @param width, height  by the header: those that the decoder will find, too
/// @throws ReadError if anything is damaged or missing, if the colours lie in such planes, or if the sizes differ
void require_sound_tiff(const std::filesystem::path& file, std::string_view bytes, double width, double height);

}  // namespace morphodesic::datasets

#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/image_pixels.h"

namespace morphodesic::datasets {

/// First frame of a GIF as red, green, blue, alpha (alpha 0 where the frame is transparent or leaves the screen free).
/// @throws ReadError if the file is damaged or a frame has more pixels than the limit
PixelImage read_gif(const std::filesystem::path& file, std::string_view bytes, double max_megapixels,
                    std::vector<std::string>& notes);

}  // namespace morphodesic::datasets

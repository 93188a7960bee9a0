#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace morphodesic::datasets {

enum class ImageFormat { png, jpeg, bmp, tiff, pnm, webp, gif };

/// What an image file says about itself, before any memory for pixels is asked for.
struct ImageHeader {
    ImageFormat format = ImageFormat::png;
    double width = 0.0, height = 0.0;  ///< pixels; as doubles, because a header may lie beyond any integer type
    bool several = false;              ///< TIFF with more than one page, animated WebP
};

/// Reads the header of an image from the bytes of its file. The format is told by the content, not by the name.
/// @throws ReadError if this is no image, if the file is cut off, or if the image has more pixels than the limit
ImageHeader read_image_header(const std::filesystem::path& file, std::string_view bytes, double max_megapixels);

}  // namespace morphodesic::datasets

#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace morphodesic::datasets {

/// A decoded image: row 0 on top, channels interleaved: grey (1), red green blue (3), or these with alpha last (2, 4).
struct PixelImage {
    int width = 0, height = 0, channels = 1;
    double max_value = 255.0;           ///< value of white
    std::vector<std::uint16_t> values;  ///< [height x width x channels]

    [[nodiscard]] bool has_alpha() const { return channels == 2 || channels == 4; }
    [[nodiscard]] int colours() const { return channels >= 3 ? 3 : 1; }
    [[nodiscard]] const std::uint16_t* at(std::size_t pixel) const {
        return values.data() + pixel * static_cast<std::size_t>(channels);
    }
    [[nodiscard]] std::size_t pixel_count() const {
        return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    }
};

/// Decodes PNG, JPEG, BMP, TIFF, PNM, WebP or GIF. Images that are cut off or damaged are refused, not read in part.
/// @param notes  receives a sentence if only the first of several pages or frames is used
/// @throws ReadError
PixelImage read_pixels(const std::filesystem::path& file, double max_megapixels, std::vector<std::string>& notes);

/// Writes an 8-bit grey or grey-alpha or colour image as PNG.
/// @throws WriteError
void write_png(const std::filesystem::path& file, const PixelImage& image);

}  // namespace morphodesic::datasets

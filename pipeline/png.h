#pragma once

#include <array>
#include <string>
#include <vector>

namespace morphodesic::pipeline {

/// Pixels in rows from the top, red green blue alpha, not premultiplied.
struct RgbaImage {
    int width = 0, height = 0;
    std::vector<unsigned char> pixels;  ///< [height x width x 4]

    RgbaImage() = default;
    RgbaImage(int w, int h)
        : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h) * 4) {}
    void set(int column, int row, const std::array<unsigned char, 4>& colour) {
        const std::size_t at =
            4 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column));
        for (std::size_t c = 0; c < 4; ++c) pixels[at + c] = colour[c];
    }
};

/// The bytes of a PNG file. The only file of this folder that includes OpenCV is png.cpp.
/// @throws std::runtime_error if the picture cannot be encoded
[[nodiscard]] std::string encode_png(const RgbaImage& image);

}  // namespace morphodesic::pipeline

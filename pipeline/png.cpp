#include "pipeline/png.h"

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

namespace morphodesic::pipeline {

std::string encode_png(const RgbaImage& image) {
    cv::Mat bgra(image.height, image.width, CV_8UC4);
    for (int row = 0; row < image.height; ++row) {
        auto* out = bgra.ptr<unsigned char>(row);
        const unsigned char* in =
            image.pixels.data() + 4 * static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width);
        for (int i = 0; i < image.width; ++i, in += 4, out += 4) {
            out[0] = in[2];
            out[1] = in[1];
            out[2] = in[0];
            out[3] = in[3];
        }
    }
    std::vector<unsigned char> bytes;
    if (!cv::imencode(".png", bgra, bytes, {cv::IMWRITE_PNG_COMPRESSION, 9})) {
        throw std::runtime_error("a picture could not be encoded as PNG");
    }
    return {bytes.begin(), bytes.end()};
}

}  // namespace morphodesic::pipeline

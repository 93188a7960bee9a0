#pragma once

#include <cmath>
#include <filesystem>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <string>

#include "datasets/import.h"

namespace morphodesic::tests {

/// Grey picture of {inside(x, y)} with x to the right and y up in pixels, in [0,1]; samples^2 samples per pixel (1:
/// black and white).
inline cv::Mat picture(int width, int height, int samples, const std::function<bool(double, double)>& inside) {
    cv::Mat image(height, width, CV_32F);
    for (int row = 0; row < height; ++row) {
        for (int column = 0; column < width; ++column) {
            int hits = 0;
            for (int b = 0; b < samples; ++b) {
                for (int a = 0; a < samples; ++a) {
                    if (inside(column + (a + 0.5) / samples, height - row - (b + 0.5) / samples)) ++hits;
                }
            }
            image.at<float>(row, column) = static_cast<float>(hits) / static_cast<float>(samples * samples);
        }
    }
    return image;
}

inline cv::Mat disk_picture(int side, double x, double y, double radius, int samples = 16) {
    return picture(side, side, samples, [=](double px, double py) { return std::hypot(px - x, py - y) < radius; });
}

/// Coverage as a picture of another depth, from background to object.
inline cv::Mat toned(const cv::Mat& coverage, double background, double object, int depth = CV_8U) {
    cv::Mat result;
    coverage.convertTo(result, depth, object - background, background);
    return result;
}

inline std::filesystem::path save(const std::filesystem::path& file, const cv::Mat& image,
                                  const std::vector<int>& parameters = {}) {
    std::filesystem::create_directories(file.parent_path());
    if (!cv::imwrite(file.string(), image, parameters)) throw std::runtime_error("cannot write " + file.string());
    return file;
}

inline datasets::RawShape<2> read(const std::filesystem::path& file, const datasets::ImportOptions& options = {}) {
    return datasets::read_shape<2>(datasets::single_source(file), options);
}

/// Largest error in pixels of the signed distance to a disk, over all nodes of a grid laid on the picture.
inline double disk_error(const datasets::RawShape<2>& raw, double x, double y, double radius, int level = 6) {
    datasets::NormalizeOptions options;
    options.mode = "none";
    options.level = level;
    const auto shape = datasets::normalize(raw, options);
    double worst = 0.0;
    for (std::size_t i = 0; i < shape.level_set.values.size(); ++i) {
        const Point<2> p = shape.level_set.grid.position(shape.level_set.grid.node(i));
        const double exact = radius - std::hypot(p[0] / shape.scale - x, p[1] / shape.scale - y);
        worst = std::max(worst, std::abs(shape.level_set.values[i] / shape.scale - exact));
    }
    return worst;
}

}  // namespace morphodesic::tests

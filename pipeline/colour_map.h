#pragma once

#include <array>
#include <string>
#include <vector>

namespace morphodesic::pipeline {

/// Red, green, blue.
using Colour = std::array<unsigned char, 3>;

/// Perceptually uniform map from blue (0) over violet and red to orange (1): equal steps of the value are equal steps
/// in the OKLab colour space, and the lightness only grows. Values outside [0, 1] are clamped, NaN is 0. Source:
/// Ottosson, A perceptual color space for image processing, 2020.
[[nodiscard]] Colour dissipation_colour(double value);

/// "#rrggbb" of n equally spaced values from 0 to 1, n >= 2.
[[nodiscard]] std::vector<std::string> dissipation_colours(int n);

}  // namespace morphodesic::pipeline

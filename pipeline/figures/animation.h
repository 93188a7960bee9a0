#pragma once

#include <string>
#include <vector>

#include "datasets/solid_pictures.h"
#include "geodesic/discrete_geodesic.h"
#include "pipeline/png.h"

namespace morphodesic::pipeline {

/// The bytes of an animated WebP file that repeats for ever.
/// @param milliseconds  that each frame is shown
/// @throws std::runtime_error if the frames cannot be encoded
[[nodiscard]] std::string encode_animation(const std::vector<RgbaImage>& frames, int milliseconds);

/// A path there and back, at `frames` times by (8), on white, coloured by its dissipation.
[[nodiscard]] std::string path_animation(const GeodesicResult<2>& path, int pixels, int frames);
[[nodiscard]] std::string path_animation(const GeodesicResult<3>& path, const datasets::View& camera, int frames);

}  // namespace morphodesic::pipeline

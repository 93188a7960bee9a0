#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "datasets/image_pixels.h"
#include "datasets/outline.h"

namespace morphodesic::datasets {

/// Which share of every pixel belongs to the object.
///
/// auto: the background is the most common colour along the border of the image, or what is transparent if most of the
/// border is (a frame around the picture does not count, and uneven light is evened out); the object is what differs
/// from it, split by Otsu's threshold on the distance of colours. dark, light: Otsu's threshold on the brightness.
/// alpha: what is opaque. In images of two tones the outline lies half-way between them, which is exact for
/// anti-aliased edges; in others it lies at the threshold.
/// @param foreground  auto | dark | light | alpha
/// @param hidden      if not empty: pixels above 1/2 are not looked at and get no object
/// @param notes       receives a sentence if the choice was not clear
/// @throws ReadError  if there is no object, or nothing but object
Coverage object_coverage(const PixelImage& image, const std::string& foreground, const Coverage& hidden,
                         const std::filesystem::path& file, std::vector<std::string>& notes);

/// Pixels of (about) the occluder's colour, with a seam of one pixel where colours mix. 1 = hidden.
/// @param occluder  "#rrggbb", or alpha for what is transparent
Coverage occluder_pixels(const PixelImage& image, const std::string& occluder);

}  // namespace morphodesic::datasets

#pragma once

#include "datasets/import_options.h"
#include "datasets/raw_shape.h"

namespace morphodesic::datasets {

/// Reads the shape that an image shows. File units are pixels: x to the right, y up, origin in the lower left corner.
/// Holes and parts are kept; specks and pinholes below options.speck_fraction of the area are removed, which is noted.
/// If source.mask_path is set, that image of the same size says where the shape is hidden (white).
/// @throws ReadError
RawShape<2> read_shape_2d(const ShapeSource& source, const ImportOptions& options = {});

}  // namespace morphodesic::datasets

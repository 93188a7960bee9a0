#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "datasets/outline.h"
#include "datasets/shape.h"

namespace morphodesic::datasets {

/// A shape drawn by a formula: the union of polygons that may overlap (non-zero winding rule: counter-clockwise
/// polygons add, clockwise ones cut holes) in the unit square, y up.
struct Drawing {
    std::string name;                                             ///< file name without ending
    std::string label;                                            ///< class label
    std::vector<std::pair<std::string, std::string>> parameters;  ///< what it was drawn from: (name, value)
    std::vector<Loop> polygons;
};

/// Closed polygons of common parts, counter-clockwise; `corners` per full turn.
Loop disk_polygon(const Point<2>& centre, double radius, int corners = 256);
/// All points within a distance of a segment.
Loop capsule_polygon(const Point<2>& a, const Point<2>& b, double radius, int corners = 128);

/// Anti-aliased picture: exact in x, 16 lines per pixel in y.
/// @param side  width and height in pixels, 8 to 8192
Coverage rasterize(const Drawing& drawing, int side);

/// The drawing where it stands in the unit square (or, if centred, with its centroid in the middle), on a grid.
Shape<2> shape_of(const Drawing& drawing, int level, bool centred = true);

/// Writes side x side PNG files (black on white), labels.csv (file,label) and parameters.csv into a folder, which is
/// created if need be.
/// @throws ReadError   if the folder holds other shapes, which would get into the collection
/// @throws WriteError  if a file cannot be written
void write_collection(const std::filesystem::path& folder, const std::vector<Drawing>& drawings, int side);

}  // namespace morphodesic::datasets

#pragma once

#include <vector>

#include "geodesic/grid/dyadic_grid.h"

namespace morphodesic::datasets {

/// Share of every pixel that the object covers, [height x width], row 0 on top, in [0,1].
struct Coverage {
    int width = 0, height = 0;
    std::vector<float> values;

    [[nodiscard]] float at(int column, int row) const {
        return values[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(column)];
    }
};

using Loop = std::vector<Point<2>>;  ///< closed polygon, the last vertex is joined to the first

/// Closed polygons around an object, counter-clockwise around its parts, clockwise around its holes (y up), disjoint.
struct Outline {
    std::vector<Loop> loops;
};

struct OutlineMoments {
    double area = 0.0;           ///< holes subtracted
    Point<2> centroid{};         ///< of the object, not of its outline
    double extent_radius = 0.0;  ///< largest distance of a vertex from the centroid
};

/// Signed area, > 0 if counter-clockwise.
double signed_area(const Loop& loop);

OutlineMoments moments(const Outline& outline);

/// The line of half coverage in pixel units: x to the right, y up, origin in the lower left corner of the image. Beyond
/// the image there is no object, so a shape that touches the border is closed along the border. Where two parts meet at
/// a corner they are joined. An anti-aliased image tells the line to 0.12 pixel (0.05 root mean square,
/// measured on disks). A black and white one only tells between which two pixels it passes; local parabolas smooth its
/// stair-case without leaving that interval (0.5 pixel, 0.14 root mean square; 0.25 without them).
Outline outline_of(const Coverage& coverage);

struct SpeckRemoval {
    int specks = 0, pinholes = 0;  ///< loops removed
    double removed_area = 0.0;     ///< of specks and pinholes together
};

/// Removes the parts and holes with less than a share of the area of the whole object.
SpeckRemoval remove_specks(Outline& outline, double fraction);

}  // namespace morphodesic::datasets

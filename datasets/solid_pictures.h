#pragma once

#include <string>

#include "datasets/image_pixels.h"
#include "geodesic/grid/fields.h"

namespace morphodesic::datasets {

/// Where a solid is looked at from: degrees around the vertical axis and above the horizon.
struct View {
    int width = 320, height = 320;  ///< pixels, 16 to 4096
    double azimuth = 35.0, elevation = 20.0;
    int up_axis = 2;    ///< axis of the cube that points up in the picture: 0, 1 or 2
    double zoom = 1.0;  ///< 1: the ball of the largest normalised shape fills the picture
};

/// Colours for values: blue-violet at low over green to yellow at high (viridis).
struct ColourRange {
    double low = 0.0, high = 1.0;
};

/// Shaded view of a solid from outside, by OpenVDB's ray tracer for level sets: red, green, blue, alpha of 8 bits; the
/// background is transparent. No graphics card or display is needed.
/// @param colour  scalar field on any grid, e.g. dissipation; nullptr: one colour
PixelImage shaded_view(const LevelSet<3>& shape, const View& view = {}, const ScalarField<3>* colour = nullptr,
                       const ColourRange& range = {});

/// Plane through a solid: level lines of u as stripes (their width is the distance between lines), the object in
/// colour, the background grey, its contour black. Axis 0 of the picture is the lower remaining axis, the higher one
/// points up.
/// @param across    axis perpendicular to the plane
/// @param position  of the plane, in [0,1]
PixelImage slice_picture(const LevelSet<3>& shape, int across, double position, int pixels = 320,
                         const ScalarField<3>* colour = nullptr, const ColourRange& range = {});

/// Largest value of a field where the shape is (u > 0): a range for colours common to several pictures.
ColourRange colour_range(const LevelSet<3>& shape, const ScalarField<3>& field);

}  // namespace morphodesic::datasets

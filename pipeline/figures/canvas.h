#pragma once

#include <functional>
#include <string>

#include "geodesic/grid/fields.h"
#include "pipeline/colour_map.h"
#include "pipeline/png.h"
#include "reports/svg.h"

namespace morphodesic::pipeline {

/// A rectangle of a figure that shows a part of the unit square.
struct Panel {
    double x = 0, y = 0, width = 160, height = 160;  ///< in the figure, pixels of the SVG
    Point<2> centre{0.5, 0.5};                       ///< point of the unit square in the middle
    double span = 0.8;                               ///< width of the part that is shown, in units of the square

    [[nodiscard]] double scale() const { return width / span; }
    [[nodiscard]] std::pair<double, double> at(const Point<2>& p) const {
        return {x + 0.5 * width + (p[0] - centre[0]) * scale(), y + 0.5 * height - (p[1] - centre[1]) * scale()};
    }
    [[nodiscard]] Point<2> back(double px, double py) const {
        return {centre[0] + (px - x - 0.5 * width) / scale(), centre[1] - (py - y - 0.5 * height) / scale()};
    }
};

using ColourMap = std::function<Colour(double)>;  ///< of a value in [0, 1]

[[nodiscard]] std::string hex(const Colour& colour);

/// The shape as an area or its contour as a line, from {u = value}.
void fill_shape(reports::Svg& svg, const Panel& panel, const LevelSet<2>& u, const std::string& fill,
                const std::string& stroke = {}, double thickness = 1);
void outline_shape(reports::Svg& svg, const Panel& panel, const LevelSet<2>& u, const std::string& colour,
                   double thickness = 1, double value = 0.0);

/// A picture over the panel, colour_at(point of the unit square) -> colour; raster of `density` pixels per SVG pixel.
void paint(reports::Svg& svg, const Panel& panel, const std::function<Colour(const Point<2>&)>& colour_at,
           double density = 3);
/// The same inside the shape only, with its contour as a thin line on top.
void paint_inside(reports::Svg& svg, const Panel& panel, const LevelSet<2>& u,
                  const std::function<Colour(const Point<2>&)>& colour_at, const std::string& stroke = "#1b2430",
                  double density = 3);

/// Horizontal colour bar with ticks and a title (quantity and unit) above it; about 42 pixels high with its numbers.
void colour_bar(reports::Svg& svg, double x, double y, double width, const ColourMap& map, double low, double high,
                const std::string& title);

/// A value of a nodal field.
[[nodiscard]] double sample(const ScalarField<2>& field, const Point<2>& x);
/// Level-line texture: bands of u of the given width, light and dark by turns with a soft edge; object and background
/// in different colours, so that both the contour and the level lines are seen in grey print.
[[nodiscard]] Colour level_line_colour(double u, double width);

/// Line integral convolution (Cabral and Leedom 1993) of white noise along a vector field inside a shape.
/// @param field   displacement or velocity
/// @param pixels  along the side of the part of the unit square that the panel shows
/// @return        grey values in [0, 1], [pixels x pixels], row 0 on top; 0.5 outside
[[nodiscard]] std::vector<double> line_integral_convolution(const VectorField<2>& field, const LevelSet<2>& inside,
                                                            const Panel& panel, int pixels);

}  // namespace morphodesic::pipeline

#pragma once

#include <vector>

#include "datasets/drawing.h"
#include "geodesic/discrete_geodesic.h"
#include "pipeline/figures/canvas.h"
#include "pipeline/figures/figure.h"
#include "pipeline/path_pictures.h"

namespace morphodesic::pipeline {

/// Polygons as a shape on a grid fine enough for the geodesic and for smooth pictures; where it stands, not centred.
[[nodiscard]] LevelSet<2> level_set_of(std::vector<datasets::Loop> polygons, const GeodesicOptions& options,
                                       bool centred = true);

/// Font of the letters whose geodesics are known best.
inline constexpr const char* bold_font = "DejaVuSans-Bold";

/// A letter of a font as a shape.
/// @param area  it is scaled to this area of the unit square; 0: as the collection of letters has it
/// @throws std::invalid_argument without the font
[[nodiscard]] LevelSet<2> letter_shape(const std::string& character, const std::string& font,
                                       const GeodesicOptions& options, double area = 0.0);

/// Distance of concentric balls, by the motion v = (r'/r) x of constant divergence: in the plane
/// sqrt(pi (2 lambda + 2 mu)) |r1 - r0|, in space sqrt(pi (6 lambda + 4 mu)) 2/3 |r1^(3/2) - r0^(3/2)|.
[[nodiscard]] double distance_of_balls(int dimension, const GeodesicOptions& options, double r0, double r1);

/// Panels side by side, one per shape of a path, in the figure from (x, y) on.
struct Row {
    double x = 10, y = 10, cell = 100, gap = 4, span = 0.8;
    Point<2> centre{0.5, 0.5};
    double aspect = 1.0;  ///< height of a panel / its width

    [[nodiscard]] Panel panel(std::size_t k) const {
        return {x + static_cast<double>(k) * (cell + gap), y, cell, cell * aspect, centre, span};
    }
};

/// Shapes 0 .. K-1 coloured by dissipation with the common end of the scale `high`.
void draw_dissipation(reports::Svg& svg, const Row& row, const GeodesicResult<2>& path,
                      const std::vector<ScalarField<2>>& rates, double high);
/// Level-line texture of shapes 0 .. K, with their contours.
void draw_level_lines(reports::Svg& svg, const Row& row, const GeodesicResult<2>& path, double band);
/// Shapes 0 .. K as areas.
void draw_shapes(reports::Svg& svg, const Row& row, const std::vector<LevelSet<2>>& shapes, const std::string& fill);

/// A path with the words on its left.
struct LabelledPath {
    std::vector<std::string> words;
    const GeodesicResult<2>* path = nullptr;
};
/// For each path the shapes and below them their dissipation, with one colour bar for all; the whole document.
[[nodiscard]] std::string paths_with_dissipation(const std::string& title, const std::vector<LabelledPath>& paths,
                                                 double span);

/// Title of the colour bar of the dissipation.
inline constexpr const char* dissipation_title = "viscous dissipation rate density (1), mu per squared path time";

/// "length 0.347 (+- 0.01), min det 0.4": what a path amounts to, for captions.
template <int Dim>
[[nodiscard]] std::string path_summary(const GeodesicResult<Dim>& path);

/// A check that the solve ended as it should and no step folds.
template <int Dim>
[[nodiscard]] FigureCheck solved(const std::string& what, const GeodesicResult<Dim>& path);

/// One row per shape: step, area, perimeter, Euler number, parts, E_deform, E_match, length of the step that leads to
/// it. Columns are set by the first call.
template <int Dim>
void add_path_numbers(FigureTable& table, const std::string& name, const GeodesicResult<Dim>& path);

}  // namespace morphodesic::pipeline

#include "pipeline/figures/path_rows.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/synthetic.h"
#include "geodesic/grid/measures.h"
#include "geodesic/solver/volume_constraint.h"
#include "pipeline/path_pictures.h"
#include "pipeline/run_settings.h"

namespace morphodesic::pipeline {

LevelSet<2> level_set_of(std::vector<datasets::Loop> polygons, const GeodesicOptions& options, bool centred) {
    datasets::Drawing drawing;
    drawing.name = "shape";
    drawing.polygons = std::move(polygons);
    return datasets::shape_of(drawing, shape_level(2, options), centred).level_set;
}

LevelSet<2> letter_shape(const std::string& character, const std::string& font, const GeodesicOptions& options,
                         double area) {
    datasets::LettersOptions letters;
    letters.count = 1;
    letters.variation = 0.0;
    letters.characters = character;
    for (const auto& file : datasets::installed_fonts(character)) {
        if (file.stem() == font) letters.fonts = {file};
    }
    if (letters.fonts.empty()) {
        throw std::invalid_argument("the font " + font +
                                    " is not installed; install the packages fonts-dejavu-core and fonts-dejavu-extra");
    }
    datasets::Drawing drawing = datasets::letters(letters).front();
    const auto place = [&] { return datasets::shape_of(drawing, shape_level(2, options)).level_set; };
    LevelSet<2> shape = place();
    for (int round = 0; round < 3 && area > 0; ++round) {
        const double scale = std::sqrt(area / enclosed_volume<2>(shape.grid, shape.values.data()));
        for (datasets::Loop& loop : drawing.polygons) {
            for (Point<2>& p : loop) p = {0.5 + scale * (p[0] - 0.5), 0.5 + scale * (p[1] - 0.5)};
        }
        shape = place();
    }
    return shape;
}

double distance_of_balls(int dimension, const GeodesicOptions& o, double r0, double r1) {
    if (dimension == 2) return std::sqrt(std::numbers::pi * (2 * o.lambda + 2 * o.mu)) * std::abs(r1 - r0);
    return std::sqrt(std::numbers::pi * (6 * o.lambda + 4 * o.mu)) * 2.0 / 3.0 *
           std::abs(std::pow(r1, 1.5) - std::pow(r0, 1.5));
}

void draw_dissipation(reports::Svg& svg, const Row& row, const GeodesicResult<2>& path,
                      const std::vector<ScalarField<2>>& rates, double high) {
    for (std::size_t k = 0; k < rates.size(); ++k) {
        paint_inside(svg, row.panel(k), path.shapes[k],
                     [&](const Point<2>& x) { return dissipation_colour(sample(rates[k], x) / high); });
    }
}

void draw_level_lines(reports::Svg& svg, const Row& row, const GeodesicResult<2>& path, double band) {
    for (std::size_t k = 0; k < path.shapes.size(); ++k) {
        const Panel panel = row.panel(k);
        paint(svg, panel, [&](const Point<2>& x) { return level_line_colour(sample(path.shapes[k], x), band); });
        outline_shape(svg, panel, path.shapes[k], "#1b2430", 1.0);
    }
}

void draw_shapes(reports::Svg& svg, const Row& row, const std::vector<LevelSet<2>>& shapes, const std::string& fill) {
    for (std::size_t k = 0; k < shapes.size(); ++k) fill_shape(svg, row.panel(k), shapes[k], fill);
}

std::string paths_with_dissipation(const std::string& title, const std::vector<LabelledPath>& paths, double span) {
    std::vector<ScalarField<2>> all;
    std::vector<LevelSet<2>> bodies;
    std::vector<std::vector<ScalarField<2>>> rates;
    for (const LabelledPath& labelled : paths) {
        rates.push_back(dissipation_of_steps(*labelled.path));
        all.insert(all.end(), rates.back().begin(), rates.back().end());
        bodies.insert(bodies.end(), labelled.path->shapes.begin(), labelled.path->shapes.end() - 1);
    }
    const double high = upper_end<2>(all, bodies);
    const double width = 90 + 104.0 * static_cast<double>(paths.front().path->shapes.size());
    reports::Svg svg(width, 60 + 216.0 * static_cast<double>(paths.size()));
    Row row{80, 8, 100, 4, span, {0.5, 0.5}, 1.0};
    for (std::size_t i = 0; i < paths.size(); ++i) {
        for (std::size_t line = 0; line < paths[i].words.size(); ++line) {
            svg.text(8, row.y + 45 + 15 * static_cast<double>(line), paths[i].words[line], 11);
        }
        draw_shapes(svg, row, paths[i].path->shapes, "#565f6c");
        row.y += 104;
        draw_dissipation(svg, row, *paths[i].path, rates[i], high);
        row.y += 112;
    }
    colour_bar(svg, 0.5 * width - 200, row.y + 6, 400, dissipation_colour, 0, high, dissipation_title);
    return svg.document(title);
}

template <int Dim>
std::string path_summary(const GeodesicResult<Dim>& path) {
    return "length " + rounded(path.path_length) + " (error bar " + rounded(path.error, 2) + "), path energy " +
           rounded(path.path_energy) + ", level " + std::to_string(path.options.level) +
           ", K = " + std::to_string(path.options.time_steps) + ", least det " + rounded(path.min_det, 2);
}

template <int Dim>
FigureCheck solved(const std::string& what, const GeodesicResult<Dim>& path) {
    return {what + ": solve", std::string(to_string(path.termination)) + ", least det " + rounded(path.min_det, 2),
            "converged, det > 0 everywhere", path.termination == Termination::converged && path.min_det > 0,
            "only a solve that ended by itself is a geodesic, and (2) asks for one-to-one deformations"};
}

template <int Dim>
void add_path_numbers(FigureTable& table, const std::string& name, const GeodesicResult<Dim>& path) {
    if (table.columns.empty()) {
        table.columns = {"path",
                         "step",
                         Dim == 2 ? "area" : "volume",
                         Dim == 2 ? "perimeter" : "surface",
                         "euler_number",
                         "parts",
                         "deformation_energy",
                         "mismatch_energy",
                         "step_length",
                         "path_length",
                         "path_energy"};
    }
    for (std::size_t k = 0; k < path.shapes.size(); ++k) {
        const ShapeMeasures m = measure(path.shapes[k]);
        std::vector<std::string> row{name,
                                     std::to_string(k),
                                     exact(m.volume),
                                     exact(m.surface),
                                     std::to_string(m.euler),
                                     std::to_string(m.components)};
        if (k == 0) {
            row.insert(row.end(), {"", "", ""});
        } else {
            row.insert(row.end(), {exact(path.deformation_energy[k - 1]), exact(path.mismatch_energy[k - 1]),
                                   exact(std::sqrt(path.deformation_energy[k - 1]))});
        }
        row.insert(row.end(), {exact(path.path_length), exact(path.path_energy)});
        table.add(std::move(row));
    }
}

template std::string path_summary<2>(const GeodesicResult<2>&);
template std::string path_summary<3>(const GeodesicResult<3>&);
template FigureCheck solved<2>(const std::string&, const GeodesicResult<2>&);
template FigureCheck solved<3>(const std::string&, const GeodesicResult<3>&);
template void add_path_numbers<2>(FigureTable&, const std::string&, const GeodesicResult<2>&);
template void add_path_numbers<3>(FigureTable&, const std::string&, const GeodesicResult<3>&);

}  // namespace morphodesic::pipeline

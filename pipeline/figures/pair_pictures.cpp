#include "pipeline/figures/pair_pictures.h"

#include <algorithm>
#include <cmath>
#include <fstream>

#include "geodesic/grid/q1_element.h"
#include "geodesic/solver/path_interpolation.h"
#include "pipeline/figures/animation.h"
#include "pipeline/figures/solid_rows.h"
#include "pipeline/solid_paths.h"
#include "pipeline/store_error.h"
#include "reports/figures.h"

namespace morphodesic::pipeline {
namespace {

/// Lines of a regular grid, carried along by a deformation, inside a panel.
void draw_grid(reports::Svg& svg, const Panel& panel, const Deformation<2>& phi) {
    constexpr int lines = 20, points = 80;
    const double low = panel.centre[0] - 0.5 * panel.span;
    for (int axis = 0; axis < 2; ++axis) {
        for (int i = 0; i <= lines; ++i) {
            std::vector<std::pair<double, double>> line;
            for (int j = 0; j <= points; ++j) {
                const double along = low + panel.span * j / points, fixed = low + panel.span * i / lines;
                const Point<2> x = axis == 0 ? Point<2>{along, fixed} : Point<2>{fixed, along};
                Point<2> y = x;
                for (std::size_t a = 0; a < 2; ++a) {
                    y[a] += q1::value(phi.grid(), phi.displacement.components[a].data(), x);
                }
                const auto place = panel.at(y);
                line.emplace_back(std::clamp(place.first, panel.x, panel.x + panel.width),
                                  std::clamp(place.second, panel.y, panel.y + panel.height));
            }
            svg.polyline(line, "#7d8896", 0.6);
        }
    }
}

/// Bars of energy and length of the steps.
template <int Dim>
void draw_steps(reports::Svg& svg, double x, double y, double width, const GeodesicResult<Dim>& path) {
    const std::size_t steps = path.deformation_energy.size();
    const auto bars = [&](double at, const std::string& title, const std::string& colour, const auto& value) {
        double high = 0;
        for (std::size_t k = 0; k < steps; ++k) high = std::max(high, value(k));
        const reports::Scale sx{0.5, static_cast<double>(steps) + 0.5, at + 60, at + width},
            sy{0, 1.1 * std::max(high, 1e-300), y + 120, y + 16};
        for (const double v : reports::ticks(sy.low, sy.high, 4)) {
            svg.line(sx.from, sy(v), sx.to, sy(v), "#e6e9ee");
            svg.text(sx.from - 6, sy(v), rounded(v, 3), 10, "end");
        }
        const double bar = 0.6 * (sx.to - sx.from) / static_cast<double>(steps);
        for (std::size_t k = 0; k < steps; ++k) {
            const double centre = sx(static_cast<double>(k + 1));
            svg.rect(centre - bar / 2, sy(value(k)), bar, sy.from - sy(value(k)), colour);
            svg.text(centre, sy.from + 11, std::to_string(k + 1), 10, "middle");
        }
        svg.line(sx.from, sy.from, sx.to, sy.from, "#8b95a3");
        svg.text((sx.from + sx.to) / 2, y, title, 11, "middle");
    };
    bars(x, "deformation energy of the step", "#1f4e8c", [&](std::size_t k) { return path.deformation_energy[k]; });
    bars(x + width + 30, "length of the step", "#3f7f6b",
         [&](std::size_t k) { return std::sqrt(path.deformation_energy[k]); });
}

void write(const std::filesystem::path& file, const std::string& bytes) {
    std::ofstream stream(file, std::ios::binary);
    stream << bytes;
    stream.close();
    if (!stream) throw StoreError(file, "cannot be written; is the disk full or the folder protected?");
}

}  // namespace

template <int Dim>
Figure path_figure_of(const GeodesicResult<Dim>& path, const SolidView& view) {
    Figure figure;
    figure.name = "path";
    figure.title = "Discrete geodesic, path length " + rounded(path.path_length);
    add_path_numbers(figure.numbers, "path", path);
    const std::size_t shapes = path.shapes.size();
    const double cell = Dim == 2 ? 120 : 200, left = 86,
                 width = std::max(left + 10 + (cell + 4) * static_cast<double>(shapes), 620.0);
    reports::Svg svg(width, Dim == 2 ? 4 * (cell + 4) + 250 : 4 * (0.8 * cell + 4) + 270);
    Row row{left, 8, cell, 4, 0.92, {0.5, 0.5}, Dim == 2 ? 1.0 : 0.8};
    const auto name = [&](const char* first, const char* second = "") {
        const double middle = row.y + 0.5 * row.aspect * cell;
        svg.text(6, *second != 0 ? middle - 7 : middle, first, 11);
        svg.text(6, middle + 8, second, 11);
    };
    if constexpr (Dim == 2) {
        const auto rates = dissipation_of_steps(path);
        const double high = upper_end<2>(rates, path.shapes);
        name("shapes");
        draw_shapes(svg, row, path.shapes, "#565f6c");
        row.y += cell + 4;
        name("dissipation");
        draw_dissipation(svg, row, path, rates, high);
        row.y += cell + 8;
        colour_bar(svg, width / 2 - 200, row.y, 400, dissipation_colour, 0, high, dissipation_title);
        row.y += 40;
        name("level lines,", "every 0.02");
        draw_level_lines(svg, row, path, 0.02);
        row.y += cell + 4;
        name("deformed", "grid");
        for (std::size_t k = 0; k < shapes; ++k) {
            const Panel panel = row.panel(k);
            fill_shape(svg, panel, path.shapes[k], "#d9dee5");
            draw_grid(svg, panel, deformation_at(path, static_cast<double>(k) / static_cast<double>(shapes - 1)));
            outline_shape(svg, panel, path.shapes[k], "#1b2430", 1.2);
        }
        row.y += cell + 26;
    } else {
        SolidView sized = view;
        sized.camera.width = 320;
        sized.camera.height = 256;
        sized.camera.zoom = fitting_zoom(path.shapes, sized.camera);
        const auto draw = [&](const std::vector<RgbaImage>& frames) {
            for (std::size_t k = 0; k < frames.size(); ++k) {
                const Panel panel = row.panel(k);
                svg.image(panel.x, panel.y, panel.width, panel.height, encode_png(frames[k]));
            }
            row.y += 0.8 * cell + 4;
        };
        std::vector<RgbaImage> bodies;
        for (const LevelSet<3>& u : path.shapes) bodies.push_back(shaded_picture(u, sized.camera));
        name("shapes");
        draw(bodies);
        const SolidFrames coloured = dissipation_pictures(path, sized);
        name("dissipation");
        draw(coloured.frames);
        row.y += 10;
        colour_bar(svg, width / 2 - 200, row.y, 400, dissipation_colour, 0, coloured.highest, dissipation_title);
        row.y += 40;
        name("level lines,", "every 0.02");
        draw(cut_pictures(path.shapes, sized, level_lines_in_plane(0.02)));
        name("deformed", "grid");
        draw(cut_pictures(path.shapes, sized, grid_in_plane(path, sized.slice_axis, 0.05)));
        row.y += 24;
    }
    draw_steps(svg, 10, row.y, std::min(0.5 * (width - 60), 380.0), path);
    figure.svg = svg.document(figure.title);
    figure.caption = path_summary(path);
    figure.checks = {solved("path", path)};
    return figure;
}

template <int Dim>
std::vector<std::string> write_pair_pictures(const std::filesystem::path& folder, const GeodesicResult<Dim>& path,
                                             const SolidView& view) {
    const Figure figure = path_figure_of(path, view);
    std::vector<std::string> names{"path.png", "path.svg", "path.csv", "path.webp"};
    write(folder / names[0], reports::svg_to_png(figure.svg, figure.png_width));
    write(folder / names[1], figure.svg);
    write(folder / names[2], figure.numbers.csv());
    if constexpr (Dim == 2) {
        write(folder / names[3], path_animation(path, 256, 25));
    } else {
        SolidView sized = view;
        sized.camera.width = sized.camera.height = 256;
        sized.camera.zoom = fitting_zoom(path.shapes, sized.camera);
        write(folder / names[3], path_animation(path, sized.camera, 17));
    }
    return names;
}

template Figure path_figure_of<2>(const GeodesicResult<2>&, const SolidView&);
template Figure path_figure_of<3>(const GeodesicResult<3>&, const SolidView&);
template std::vector<std::string> write_pair_pictures<2>(const std::filesystem::path&, const GeodesicResult<2>&,
                                                         const SolidView&);
template std::vector<std::string> write_pair_pictures<3>(const std::filesystem::path&, const GeodesicResult<3>&,
                                                         const SolidView&);

}  // namespace morphodesic::pipeline

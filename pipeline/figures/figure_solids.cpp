// Figure 1 (letters and quadrupeds) and figure 6 (the quadrupeds with a slicing plane).
#include <algorithm>
#include <cmath>

#include "geodesic/grid/measures.h"
#include "pipeline/figures/animation.h"
#include "pipeline/figures/solid_rows.h"
#include "pipeline/solid_paths.h"

namespace morphodesic::pipeline {
namespace {

void draw_frames(reports::Svg& svg, const Row& row, const std::vector<RgbaImage>& frames) {
    for (std::size_t k = 0; k < frames.size(); ++k) {
        const Panel panel = row.panel(k);
        svg.image(panel.x, panel.y, panel.width, panel.height, encode_png(frames[k]));
    }
}

}  // namespace

Figure figure_letters_and_solids(const FigureOptions& options) {
    const GeodesicOptions settings = options.geodesic();
    const auto letters = compute_discrete_geodesic<2>(letter_shape("A", "DejaVuSans-Bold", settings),
                                                      letter_shape("B", "DejaVuSans-Bold", settings), settings);
    const GeodesicResult<3>& animals = quadruped_path(options);
    Figure figure;
    figure.name = "figure-1";
    figure.title = "Discrete geodesics: cat-like to lion-like quadruped, letter A to letter B";
    add_path_numbers(figure.numbers, "A to B", letters);
    add_path_numbers(figure.numbers, "cat to lion", animals);
    const std::size_t shapes = letters.shapes.size();
    reports::Svg svg(20 + 124.0 * static_cast<double>(shapes), 672);
    Row row{10, 8, 120, 4, 0.78, {0.5, 0.5}, 0.72};
    const SolidView view = side_view(options.quick ? 120 : 360, row.aspect);
    std::vector<RgbaImage> bodies;
    for (const auto& u : animals.shapes) bodies.push_back(shaded_picture(u, view.camera));
    draw_frames(svg, row, bodies);
    row.y += 92;
    const SolidFrames coloured = dissipation_pictures(animals, view);
    draw_frames(svg, row, coloured.frames);
    row.y += 100;
    row.aspect = 1.0;
    const double middle = 0.5 * (20 + 124.0 * static_cast<double>(shapes));
    colour_bar(svg, middle - 200, row.y, 400, dissipation_colour, 0, coloured.highest,
               std::string("cat to lion: ") + dissipation_title);
    row.y += 46;
    draw_shapes(svg, row, letters.shapes, "#565f6c");
    row.y += 122;
    const auto rates = dissipation_of_steps(letters);
    const double high = upper_end<2>(rates, letters.shapes);
    draw_dissipation(svg, row, letters, rates, high);
    row.y += 124;
    draw_level_lines(svg, row, letters, 0.02);
    row.y += 134;
    colour_bar(svg, middle - 200, row.y, 400, dissipation_colour, 0, high, std::string("A to B: ") + dissipation_title);
    figure.svg = svg.document(figure.title);
    figure.caption =
        "Top: quadrupeds, below coloured by the rate of dissipation. Bottom: letters, their dissipation, and "
        "the level lines of u as bands of width 0.02, with the contour. Cat to lion: " +
        path_summary(animals) + "; A to B: " + path_summary(letters) + ".";
    const int first = measure(letters.shapes.front()).euler, last = measure(letters.shapes.back()).euler;
    figure.checks = {
        solved("A to B", letters),
        solved("cat to lion", animals),
        {"Euler numbers of A and B", std::to_string(first) + ", " + std::to_string(last),
         "0 (one hole) and -1 (two holes): the topology changes on the way", first == 0 && last == -1,
         "that is what A and B are"},
        {"Euler numbers of cat and lion",
         std::to_string(measure(animals.shapes.front()).euler) + ", " +
             std::to_string(measure(animals.shapes.back()).euler),
         "1: no tunnels", measure(animals.shapes.front()).euler == 1 && measure(animals.shapes.back()).euler == 1,
         "an animal on four legs is a ball to topology"}};
    return figure;
}

Figure figure_sliced_solids(const FigureOptions& options) {
    const GeodesicResult<3>& animals = quadruped_path(options);
    Figure figure;
    figure.name = "figure-6";
    figure.title = "Cat to lion: dissipation on the shapes, and a slicing plane with the level lines of u";
    add_path_numbers(figure.numbers, "cat to lion", animals);
    const std::size_t shapes = animals.shapes.size();
    // Two lines of panels each, so that the solids are large.
    const std::size_t columns = (shapes + 1) / 2;
    const int pixels = options.quick ? 160 : 520;
    const double width = 20 + 204.0 * static_cast<double>(columns);
    Row row{10, 8, 200, 4, 0.8, {0.5, 0.5}, 0.72};
    constexpr double cut_aspect = 0.86;
    const auto lines_of = [&](std::size_t count) { return static_cast<double>((count + columns - 1) / columns); };
    reports::Svg svg(width, 70 + lines_of(shapes - 1) * (row.aspect * row.cell + 4) +
                                lines_of(shapes) * (cut_aspect * row.cell + 4));
    const auto lines = [&](const std::vector<RgbaImage>& frames, std::size_t count) {
        for (std::size_t from = 0; from < count; from += columns) {
            draw_frames(svg, row,
                        {frames.begin() + static_cast<std::ptrdiff_t>(from),
                         frames.begin() + static_cast<std::ptrdiff_t>(std::min(from + columns, count))});
            row.y += row.aspect * row.cell + 4;
        }
    };
    const SolidFrames coloured = dissipation_pictures(animals, side_view(pixels, row.aspect));
    lines(coloured.frames, shapes - 1);
    row.y += 14;
    colour_bar(svg, width / 2 - 200, row.y, 400, dissipation_colour, 0, coloured.highest, dissipation_title);
    row.y += 44;
    row.aspect = cut_aspect;
    lines(cut_pictures(animals.shapes, side_view(pixels, row.aspect), level_lines_in_plane(0.02)), shapes);
    figure.files.push_back({"figure-6.webp", path_animation(animals, side_view(options.quick ? 96 : 360, 0.72).camera,
                                                            options.quick ? 5 : 25)});
    figure.svg = svg.document(figure.title);
    figure.caption =
        "Top: shapes 0 to K - 1 coloured by the rate of dissipation of their step. Bottom: shapes 0 to K cut "
        "along the plane of symmetry; bands of u of width 0.02 in the plane, half transparent outside; the solids are "
        "cut "
        "there. The animation shows the shapes between the steps, too, by (6)-(8). " +
        path_summary(animals) + ".";
    double shortest = 1e300, longest = 0;
    for (const double e : animals.deformation_energy) {
        shortest = std::min(shortest, std::sqrt(e));
        longest = std::max(longest, std::sqrt(e));
    }
    figure.checks = {solved("cat to lion", animals),
                     {"longest step against the shortest", rounded(longest / shortest, 3),
                      "below 1.5: walked at an even pace", longest < 1.5 * shortest,
                      "the minimiser of a sum of squares has equal steps; a step of 1.5 would cost 25 % more energy"}};
    return figure;
}

}  // namespace morphodesic::pipeline

// Figure 4 (stretching against bending) and figure 5 (dumbbells: compression against transport).
#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/synthetic.h"
#include "geodesic/grid/measures.h"
#include "geodesic/grid/q1_element.h"
#include "geodesic/solver/path_interpolation.h"
#include "pipeline/figures/path_rows.h"
#include "reports/text.h"

namespace morphodesic::pipeline {
namespace {

using datasets::Loop;

/// A limb with round ends whose middle line is a circular arc from `root`, of the given length, starting in direction
/// `angle` and turning by `bend` (radians).
std::vector<Loop> limb(Point<2> root, double angle, double bend, double length, double radius) {
    constexpr int parts = 24;
    std::vector<Loop> result;
    for (int i = 0; i < parts; ++i) {
        const double direction = angle + bend * (i + 0.5) / parts;
        const Point<2> next{root[0] + length / parts * std::cos(direction),
                            root[1] + length / parts * std::sin(direction)};
        result.push_back(datasets::capsule_polygon(root, next, radius));
        root = next;
    }
    return result;
}

/// A round body with limbs around it.
std::vector<Loop> creature(double body, int limbs, double bend, double length, double radius) {
    std::vector<Loop> result{datasets::disk_polygon({0.5, 0.5}, body)};
    for (int i = 0; i < limbs; ++i) {
        const double angle = std::numbers::pi * (0.5 + 2.0 * i / limbs);
        const Point<2> root{0.5 + 0.8 * body * std::cos(angle), 0.5 + 0.8 * body * std::sin(angle)};
        for (auto& loop : limb(root, angle, i % 2 == 0 ? bend : -bend, length, radius))
            result.push_back(std::move(loop));
    }
    return result;
}

/// Gradient [i][j] = d_j w_i of a displacement in the middle of the cell that holds x.
std::array<double, 4> cell_gradient(const VectorField<2>& w, const Point<2>& x) {
    const auto at = q1::locate(w.grid, x);
    const auto offsets = q1::corner_offsets(w.grid);
    std::array<double, 4> g{};
    for (std::size_t i = 0; i < 2; ++i) {
        for (int j = 0; j < 2; ++j) {
            for (int c = 0; c < 4; ++c) {
                g[2 * i + static_cast<std::size_t>(j)] +=
                    q1::shape_slope<2>(c, {0.5, 0.5}, j) * w.grid.cells_per_axis() *
                    w.components[i][at.node + offsets[static_cast<std::size_t>(c)]];
            }
        }
    }
    return g;
}

/// Largest |principal stretch - 1| of I + g.
double largest_strain(const std::array<double, 4>& g) {
    const double a = 1 + g[0], b = g[1], c = g[2], d = 1 + g[3];
    const double sum = std::hypot(a + d, c - b), difference = std::hypot(a - d, b + c);  // of the singular values
    return std::max(std::abs(0.5 * (sum + difference) - 1), std::abs(0.5 * (sum - difference) - 1));
}

/// Share of the first shape's area in which the whole path strains less than `limit`.
double isometric_share(const GeodesicResult<2>& path, double limit) {
    const auto phi = deformation_at(path, 1.0);
    const auto& first = path.shapes.front();
    const double kept = volume_where(
        first, [&](const Point<2>& x) { return largest_strain(cell_gradient(phi.displacement, x)) < limit; });
    return kept / measure(first).volume;
}

VectorField<2> velocity(const GeodesicResult<2>& path, std::size_t k) {
    VectorField<2> v = path.deformations[k].displacement;
    for (auto& component : v.components) {
        for (double& value : component) value *= static_cast<double>(path.deformations.size());
    }
    return v;
}

ScalarField<2> speed(const VectorField<2>& v) {
    ScalarField<2> s(v.grid);
    for (std::size_t i = 0; i < s.values.size(); ++i) s.values[i] = std::hypot(v.components[0][i], v.components[1][i]);
    return s;
}

/// Root mean square over the shape of div v, and of |eps(v)|.
std::pair<double, double> divergence_and_strain(const VectorField<2>& v, const LevelSet<2>& u) {
    double divergence = 0, strain = 0, volume = 0;
    const double h = u.grid.spacing();
    q1::for_each_cell(u.grid, [&](std::size_t node) {
        Point<2> x = u.grid.position(u.grid.node(node));
        x = {x[0] + 0.5 * h, x[1] + 0.5 * h};
        if (sample(u, x) < h) return;  // the rim of the diffuse contour is not the object
        const auto g = cell_gradient(v, x);
        divergence += (g[0] + g[3]) * (g[0] + g[3]);
        strain += g[0] * g[0] + g[3] * g[3] + 0.5 * (g[1] + g[2]) * (g[1] + g[2]);
        volume += 1;
    });
    volume = std::max(volume, 1.0);
    return {std::sqrt(divergence / volume), std::sqrt(strain / volume)};
}

double area_of_end(const LevelSet<2>& u, bool left) {
    return volume_where(u, [left](const Point<2>& p) { return (p[0] < 0.5) == left; });
}

/// Area of the two ends (halves of the square) over time, as two lines.
void draw_end_areas(reports::Svg& svg, double x, double y, double width, double height, const GeodesicResult<2>& path) {
    const std::size_t steps = path.deformations.size();
    std::vector<std::pair<double, double>> left, right;
    double high = 0;
    for (const auto& u : path.shapes) high = std::max({high, area_of_end(u, true), area_of_end(u, false)});
    const reports::Scale sx{0, static_cast<double>(steps), x + 34, x + width - 14},
        sy{0, 1.15 * high, y + height - 22, y + 8};
    for (std::size_t k = 0; k <= steps; ++k) {
        left.emplace_back(sx(static_cast<double>(k)), sy(area_of_end(path.shapes[k], true)));
        right.emplace_back(sx(static_cast<double>(k)), sy(area_of_end(path.shapes[k], false)));
    }
    for (const double v : reports::ticks(0, sy.high, 3)) {
        svg.line(sx.from, sy(v), sx.to, sy(v), "#e6e9ee");
        svg.text(sx.from - 4, sy(v), reports::short_number(v), 8, "end");
    }
    svg.line(sx.from, sy.from, sx.to, sy.from, "#8b95a3");
    svg.polyline(left, "#1b2430", 1.6);
    svg.polyline(right, "#8f9aa8", 1.6);
    svg.text(left.front().first + 3, left.front().second - 7, "left end", 8);
    svg.text(right.back().first, right.back().second - 7, "right end", 8, "end", "#5b6573");
    svg.text((sx.from + sx.to) / 2, sy.from + 12, "area over time", 9, "middle");
}

}  // namespace

Figure figure_isometry(const FigureOptions& options) {
    GeodesicOptions settings = options.geodesic();
    if (options.quick) settings.level = 6;  // limbs are thinner than the cells of coarser grids
    Figure figure;
    figure.name = "figure-4";
    figure.title = "Two geodesics: one stretches, the other bends and keeps lengths";
    const auto stretched =
        compute_discrete_geodesic<2>(level_set_of(creature(0.13, 3, 0.0, 0.10, 0.055), settings),
                                     level_set_of(creature(0.13, 3, 0.0, 0.24, 0.055), settings), settings);
    const auto bent =
        compute_discrete_geodesic<2>(level_set_of(creature(0.12, 4, -0.5, 0.27, 0.028), settings),
                                     level_set_of(creature(0.12, 4, 0.5, 0.27, 0.028), settings), settings);
    const std::size_t shapes = stretched.shapes.size();
    const double width = 80 + 104.0 * static_cast<double>(shapes);
    reports::Svg svg(width, 500);
    Row row{70, 8, 100, 4, 0.78, {0.5, 0.5}, 1.0};
    for (const auto* path : {&stretched, &bent}) {
        const auto rates = dissipation_of_steps(*path);
        const double high = upper_end<2>(rates, path->shapes);
        svg.text(8, row.y + 50, path == &stretched ? "stretching" : "bending", 11);
        draw_shapes(svg, row, path->shapes, "#565f6c");
        row.y += 104;
        draw_dissipation(svg, row, *path, rates, high);
        row.y += 106;
        colour_bar(svg, 0.5 * width - 200, row.y, 400, dissipation_colour, 0, high, dissipation_title);
        row.y += 40;
        add_path_numbers(figure.numbers, path == &stretched ? "stretching" : "bending", *path);
    }
    figure.svg = svg.document(figure.title);
    const double share_stretched = isometric_share(stretched, 0.05), share_bent = isometric_share(bent, 0.05);
    for (const auto& [name, share] : {std::pair{"stretching", share_stretched}, std::pair{"bending", share_bent}}) {
        std::vector<std::string> summary(figure.numbers.columns.size());
        summary[0] = std::string(name) + ", share of the area with strain below 5 %";
        summary[2] = exact(share);
        figure.numbers.add(std::move(summary));
    }
    figure.caption =
        "Above, arms grow out of a body; below, arms swing over. Strain: largest |principal stretch - 1| of the "
        "deformation of the whole path, (7) at t = 1. Stretching: " +
        path_summary(stretched) + "; bending: " + path_summary(bent) + ".";
    figure.checks = {
        solved("stretching", stretched),
        solved("bending", bent),
        {"share of the area with strain below 5 %, stretching", rounded(100 * share_stretched, 3) + " %", "below 50 %",
         share_stretched < 0.5, "stretching is the major effect: most of the area is strained"},
        {"share of the area with strain below 5 %, bending", rounded(100 * share_bent, 3) + " %", "above 50 %",
         share_bent > 0.5, "isometry is kept locally: in most of the area"}};
    return figure;
}

Figure figure_dumbbells(const FigureOptions& options) {
    GeodesicOptions settings = options.geodesic();
    const Point<2> left{0.30, 0.5}, right{0.70, 0.5};
    constexpr double large = 0.125, small = 0.085, neck = 0.05;
    const auto dumbbell = [&](double left_radius, double right_radius) {
        return level_set_of({datasets::disk_polygon(left, left_radius), datasets::disk_polygon(right, right_radius),
                             datasets::capsule_polygon(left, right, neck)},
                            settings, false);
    };
    const auto a = dumbbell(large, small), b = dumbbell(small, large);
    Figure figure;
    figure.name = "figure-5";
    figure.title = "Dumbbells: ends that shrink and grow, and mass that flows from end to end";
    figure.numbers.columns = {"lambda_over_mu",  "step",        "left_end_area", "right_end_area", "area", "rms_div_v",
                              "rms_strain_rate", "path_length", "path_energy"};
    std::vector<GeodesicResult<2>> paths;
    for (const double ratio : {0.01, 100.0}) {
        settings.lambda = ratio * settings.mu;
        paths.push_back(compute_discrete_geodesic<2>(a, b, settings));
    }
    const std::size_t steps = paths[0].deformations.size(), columns = options.quick ? 2 : 3;
    const double cell = 300, high_cell = 0.55 * cell;
    const std::size_t rows = steps / columns + 1;  // one place more, for the areas
    reports::Svg svg(40 + 2 * (cell / 1.5 + 6) * static_cast<double>(columns),
                     100 + static_cast<double>(rows) * (high_cell / 1.5 + 6));
    std::vector<double> mean_divergence, mean_strain;
    double x0 = 10;
    for (const auto& path : paths) {
        std::vector<ScalarField<2>> speeds;
        for (std::size_t k = 0; k < steps; ++k) speeds.push_back(speed(velocity(path, k)));
        const double high = upper_end<2>(speeds, path.shapes, 0.99);
        double divergence = 0, strain = 0;
        for (std::size_t k = 0; k < steps; ++k) {
            const VectorField<2> v = velocity(path, k);
            const Panel panel{x0 + static_cast<double>(k % columns) * (cell / 1.5 + 6),
                              34 + static_cast<double>(k / columns) * (high_cell / 1.5 + 6),
                              cell / 1.5,
                              high_cell / 1.5,
                              {0.5, 0.5},
                              0.74};
            const int pixels = static_cast<int>(panel.width * 3);
            const auto grain = line_integral_convolution(v, path.shapes[k], panel, pixels);
            paint_inside(svg, panel, path.shapes[k], [&](const Point<2>& p) {
                const auto [px, py] = panel.at(p);
                const auto column = static_cast<std::size_t>(std::clamp((px - panel.x) * 3, 0.0, pixels - 1.0));
                const auto row = static_cast<std::size_t>(std::clamp((py - panel.y) * 3, 0.0, pixels - 1.0));
                const double g = 0.62 + 0.55 * grain[row * static_cast<std::size_t>(pixels) + column];
                Colour c = dissipation_colour(sample(speeds[k], p) / high);
                for (auto& channel : c) channel = static_cast<unsigned char>(std::lround(std::min(255.0, g * channel)));
                return c;
            });
            const auto [d, e] = divergence_and_strain(v, path.shapes[k]);
            divergence += d * d / static_cast<double>(steps);
            strain += e * e / static_cast<double>(steps);
        }
        for (std::size_t k = 0; k <= steps; ++k) {
            const auto& u = path.shapes[k];
            const auto [d, e] = k < steps ? divergence_and_strain(velocity(path, k), u)
                                          : std::pair<double, double>{std::nan(""), std::nan("")};
            figure.numbers.add({exact(path.options.lambda / path.options.mu), std::to_string(k),
                                exact(area_of_end(u, true)), exact(area_of_end(u, false)), exact(measure(u).volume),
                                exact(d), exact(e), exact(path.path_length), exact(path.path_energy)});
        }
        draw_end_areas(svg, x0 + static_cast<double>(steps % columns) * (cell / 1.5 + 6),
                       34 + static_cast<double>(steps / columns) * (high_cell / 1.5 + 6), cell / 1.5, high_cell / 1.5,
                       path);
        mean_divergence.push_back(std::sqrt(divergence));
        mean_strain.push_back(std::sqrt(strain));
        const double width = static_cast<double>(columns) * (cell / 1.5 + 6);
        svg.text(x0 + width / 2, 16, "lambda / mu = " + rounded(path.options.lambda / path.options.mu), 13, "middle");
        colour_bar(svg, x0 + width / 2 - 150, 52 + static_cast<double>(rows) * (high_cell / 1.5 + 6), 300,
                   dissipation_colour, 0, high, "speed |v|, width of the unit square per path time");
        x0 += width + 20;
    }
    figure.svg = svg.document(figure.title);
    figure.caption =
        "Shapes 0 to K - 1, colour: speed |v|, texture: line integral convolution along v. Left, volume may "
        "change at little cost: each end shrinks or grows by itself. Right, it may not: mass flows through the "
        "neck. lambda / mu = 0.01: " +
        path_summary(paths[0]) + "; 100: " + path_summary(paths[1]) + ".";
    // Speed in the neck tells transport from compression.
    const auto neck_speed = [&](const GeodesicResult<2>& path) {
        double sum = 0;
        for (std::size_t k = 0; k < steps; ++k) sum += sample(speed(velocity(path, k)), {0.5, 0.5});
        return sum / static_cast<double>(steps);
    };
    const double slow = neck_speed(paths[0]), fast = neck_speed(paths[1]);
    const double share0 = mean_divergence[0] / mean_strain[0], share1 = mean_divergence[1] / mean_strain[1];
    // Energies of the two kinds of motion are balanced where lambda/2 (tr eps)^2 is as large as mu |eps|^2: at
    // sqrt(2 mu / lambda) = 0.14.
    const double most = std::sqrt(2.0 / 100);
    figure.checks = {
        solved("lambda/mu = 0.01", paths[0]),
        solved("lambda/mu = 100", paths[1]),
        {"rms div v / rms |eps(v)|, lambda/mu = 100", rounded(share1, 3),
         "below " + rounded(most, 2) + " (0.01: " + rounded(share0, 3) + ")", share1 < most && share0 > most,
         "sqrt(2 mu / lambda): beyond it the change of volume would cost more than the change of form"},
        {"mean speed in the middle of the neck, lambda/mu = 100", rounded(fast, 3),
         "above that of 0.01: " + rounded(slow, 3), fast > slow,
         "mass passes the neck; where it does not, the middle is at rest by symmetry"}};
    return figure;
}

}  // namespace morphodesic::pipeline

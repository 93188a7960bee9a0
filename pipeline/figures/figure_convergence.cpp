// Convergence in K and h, and the closed form of the disk.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/synthetic.h"
#include "pipeline/figures/axes.h"
#include "pipeline/figures/path_rows.h"

namespace morphodesic::pipeline {
Figure figure_convergence(const FigureOptions& options) {
    Figure figure;
    figure.name = "convergence";
    figure.title = "Path length from A to B against time steps and grid size";
    figure.numbers.columns = {
        "study",       "level",  "steps_K", "eta", "path_length", "error_bar", "extrapolated_length",
        "path_energy", "seconds"};
    GeodesicOptions settings = options.geodesic();
    if (!options.quick) settings.tolerance = 1e-4;  // the model is looked at, not where the minimiser stops
    const int level = options.quick ? 5 : 6;
    const int most_steps = options.quick ? 8 : 16, finest = options.quick ? 6 : 7;
    GeodesicOptions fine = settings;
    fine.level = finest;
    const auto a = letter_shape("A", "DejaVuSans-Bold", fine), b = letter_shape("B", "DejaVuSans-Bold", fine);
    Series growing, fixed, in_h, bars;
    const auto add = [&](const char* study, const GeodesicOptions& o) {
        const auto path = compute_discrete_geodesic<2>(a, b, o);
        figure.numbers.add({study, std::to_string(o.level), std::to_string(o.time_steps), exact(o.eta(o.time_steps)),
                            exact(path.path_length), exact(path.error), exact(path.extrapolated_length),
                            exact(path.path_energy), exact(path.seconds)});
        return path;
    };
    for (int k = 1; k <= most_steps; k *= 2) {
        GeodesicOptions o = settings;
        o.level = level;
        o.time_steps = k;
        growing.emplace_back(std::log2(k), add("steps, eta = 25 K", o).path_length);
        o.mismatch_weight = 200;
        fixed.emplace_back(std::log2(k), add("steps, eta = 200", o).path_length);
    }
    std::vector<GeodesicResult<2>> levels;
    for (int l = 4; l <= finest; ++l) {
        GeodesicOptions o = settings;
        o.level = l;
        o.time_steps = 4;
        levels.push_back(add("levels", o));
        in_h.emplace_back(l, levels.back().path_length);
    }
    reports::Svg svg(900, 330);
    const auto [low, high] = range_of({growing, fixed});
    const reports::Scale x{0, std::log2(most_steps), 80, 420}, y{low, high, 270, 30};
    draw_log2_axes(svg, x, y, "time steps K, level " + std::to_string(level), "path length",
                   [](int e) { return std::to_string(1 << e); });
    plot(svg, x, y, growing, "#1f4e8c");
    plot(svg, x, y, fixed, "#c2603a");
    svg.text(x(growing.back().first) - 6, y(growing.back().second) - 14, "eta = 25 K", 11, "end", "#1f4e8c", true,
             "#ffffff");
    svg.text(x(fixed.back().first) - 6, y(fixed.back().second) + 16, "eta = 200", 11, "end", "#c2603a", true,
             "#ffffff");
    Series upper;
    for (const auto& path : levels) upper.emplace_back(path.options.level, path.path_length + path.error);
    const auto [low_h, high_h] = range_of({in_h, Series(upper.begin() + 1, upper.end())});
    const reports::Scale xh{4, static_cast<double>(finest), 520, 860}, yh{low_h, high_h, 270, 30};
    draw_log2_axes(svg, xh, yh, "grid size h, K = 4", "path length",
                   [](int e) { return "1/" + std::to_string(1 << e); });
    for (std::size_t i = 1; i < levels.size(); ++i) {
        const double px = xh(levels[i].options.level);
        svg.line(px, yh(std::max(levels[i].path_length - levels[i].error, low_h)), px,
                 yh(levels[i].path_length + levels[i].error), "#8fa5c2", 1.5);
        svg.circle(px + 5, yh(std::clamp(levels[i].extrapolated_length, low_h, high_h)), 3, "#ffffff", "#1f4e8c", 1.2);
    }
    plot(svg, xh, yh, in_h, "#1f4e8c");
    figure.svg = svg.document(figure.title);
    figure.caption =
        "Letters A to B. Left: with eta = 25 K the length settles with the number of time steps, with fixed eta it "
        "does not. Right: length against grid size with error bars (lines) and extrapolated values (circles).";
    // From K = 4 on: K = 1 and 2 are too coarse in time for anything but a first guess.
    const auto spread = [](const Series& series) {
        const auto [low_k, high_k] = range_of({Series(series.begin() + 2, series.end())});
        const double margin = (high_k - low_k) / 12;  // that range_of adds
        return (high_k - margin) / (low_k + margin) - 1;
    };
    const double settled = spread(growing), drifting = spread(fixed);
    figure.checks = {
        {"spread of the length over K = 4 to " + std::to_string(most_steps) + ", eta = 25 K",
         rounded(100 * settled, 2) + " %",
         options.quick ? "below 10 %"
                       : "below 7 % and below half of that with eta = 200: " + rounded(100 * drifting, 2) + " %",
         options.quick ? settled < 0.1 : settled < 0.07 && 2 * settled < drifting,
         "an independent prototype had 1.5 % and 17 %; closing the feet of the A costs eta times an area of the "
         "grid's size"}};
    const auto &last = levels.back(), &before = levels[levels.size() - 2];
    const double change = std::abs(last.path_length - before.path_length);
    figure.checks.push_back({"change of the length by the last halving of h", rounded(change, 2),
                             "within the error bars of the two: " + rounded(before.error + last.error, 2),
                             change <= before.error + last.error, "that is what the error bars promise"});
    return figure;
}

Figure figure_disk(const FigureOptions& options) {
    Figure figure;
    figure.name = "disk";
    figure.title = "Concentric disks: the closed form";
    const GeodesicOptions base = options.geodesic();
    constexpr double r0 = 0.20, r1 = 0.25;
    const double exact_length = distance_of_balls(2, base, r0, r1);
    figure.numbers.columns = {"level",     "steps_K",     "path_length",   "extrapolated_length",
                              "error_bar", "closed_form", "relative_error"};
    const int finest = options.quick ? 6 : 8;
    Series lengths, extrapolated;
    GeodesicResult<2> last;
    for (int level = 4; level <= finest; ++level) {
        GeodesicOptions o = base;
        o.level = level;
        o.time_steps = 4;
        const DyadicGrid<2> grid(level);
        last = compute_discrete_geodesic<2>(datasets::ball<2>(grid, {0.5, 0.5}, r0),
                                            datasets::ball<2>(grid, {0.5, 0.5}, r1), o);
        lengths.emplace_back(level, last.path_length);
        if (level > 5) extrapolated.emplace_back(level, last.extrapolated_length);
        figure.numbers.add({std::to_string(level), "4", exact(last.path_length), exact(last.extrapolated_length),
                            exact(last.error), exact(exact_length), exact(last.path_length / exact_length - 1)});
    }
    reports::Svg svg(900, 330);
    // The motion v = (r'/r) x: constant rate of dissipation.
    const Panel panel{40, 30, 240, 240, {0.5, 0.5}, 0.62};
    const auto rates = dissipation_of_steps(last);
    const double high = upper_end<2>(rates, last.shapes, 0.9) * 1.2;
    paint_inside(svg, panel, last.shapes[0],
                 [&](const Point<2>& p) { return dissipation_colour(sample(rates[0], p) / high); });
    outline_shape(svg, panel, last.shapes.back(), "#1b2430", 1.5);
    const auto& w = last.deformations[0].displacement;
    for (int i = 0; i < 16; ++i) {
        for (const double r : {0.05, 0.10, 0.15}) {
            const double angle = 2 * std::numbers::pi * (i + 0.5) / 16;
            const Point<2> p{0.5 + r * std::cos(angle), 0.5 + r * std::sin(angle)};
            const auto component = [&](std::size_t c) {
                ScalarField<2> field(w.grid);
                field.values = w.components[c];
                return sample(field, p);
            };
            const Point<2> q{p[0] + 4 * component(0), p[1] + 4 * component(1)};
            const auto [x1, y1] = panel.at(p);
            const auto [x2, y2] = panel.at(q);
            svg.line(x1, y1, x2, y2, "#ffffff", 1.4);
            svg.circle(x2, y2, 1.8, "#ffffff");
        }
    }
    colour_bar(svg, 60, 284, 200, dissipation_colour, 0, high, "dissipation rate density (1), mu / time^2");
    const auto [low, top] = range_of({lengths, extrapolated, {{4, exact_length}}});
    const reports::Scale x{4, static_cast<double>(finest), 420, 860}, y{low, top, 270, 30};
    draw_log2_axes(svg, x, y, "grid size h, K = 4", "path length", [](int e) { return "1/" + std::to_string(1 << e); });
    svg.line(x.from, y(exact_length), x.to, y(exact_length), "#1b2430", 1.4, "6 4");
    svg.text(x.from + 8, y(exact_length) - 10, "closed form " + rounded(exact_length, 5), 11, "start", "#1b2430", true,
             "#ffffff");
    plot(svg, x, y, lengths, "#1f4e8c");
    plot(svg, x, y, extrapolated, "#c2603a");
    svg.text(x(lengths.back().first) - 6, y(lengths.back().second) + 16, "computed", 11, "end", "#1f4e8c", true,
             "#ffffff");
    if (!extrapolated.empty()) {
        svg.text(x(extrapolated.back().first) - 6, y(extrapolated.back().second) + 16, "extrapolated to h = 0", 11,
                 "end", "#c2603a", true, "#ffffff");
    }
    figure.svg = svg.document(figure.title);
    const double error = std::abs(last.path_length / exact_length - 1),
                 extrapolated_error = std::abs(last.extrapolated_length / exact_length - 1);
    figure.caption = "Disks of radius 0.20 and 0.25: the distance is sqrt(pi (2 lambda + 2 mu)) |r1 - r0| = " +
                     rounded(exact_length, 5) + ". Left: the first step, arrows: four times the displacement.";
    figure.checks = {{"error of the length on the finest grid", rounded(100 * error, 2) + " %",
                      options.quick ? "below 8.2 %" : "below 2.7 %", error < (options.quick ? 0.082 : 0.027),
                      "what an independent prototype with eps = h had on this grid"},
                     {"error of the extrapolated length", rounded(100 * extrapolated_error, 2) + " %",
                      options.quick ? "below 5 %" : "below 1 %", extrapolated_error < (options.quick ? 0.05 : 0.01),
                      "half of the first-order error and less; the prototype had 0.5 % from 1/128 and 1/256"}};
    return figure;
}

}  // namespace morphodesic::pipeline

// Figure 3: discrete geodesics on the sphere, single level against cascade.
#include <cmath>
#include <numbers>
#include <optional>

#include "pipeline/figures/canvas.h"
#include "pipeline/figures/figure.h"
#include "pipeline/figures/sphere_geodesic.h"

namespace morphodesic::pipeline {
namespace {

constexpr GeographicPosition johannesburg{-26.20, 28.05}, kyoto{35.01, 135.77};
constexpr double earth_radius = 6371.0;  // km

using Line = std::vector<std::pair<double, double>>;

/// Meridians and parallels as polylines of points on the sphere.
std::vector<std::vector<Point<3>>> graticule(double spacing) {
    std::vector<std::vector<Point<3>>> lines;
    for (double longitude = -180; longitude < 180 - 1e-9; longitude += spacing) {
        auto& line = lines.emplace_back();
        for (double latitude = -84; latitude <= 84.01; latitude += 2)
            line.push_back(StereographicMap::sphere({latitude, longitude}));
    }
    for (double latitude = -90 + spacing; latitude < 90 - 1e-9; latitude += spacing) {
        auto& line = lines.emplace_back();
        for (double longitude = -180; longitude <= 180.01; longitude += 2)
            line.push_back(StereographicMap::sphere({latitude, longitude}));
    }
    return lines;
}

std::string path_colour(std::size_t level, std::size_t count) {
    return hex(dissipation_colour(count > 1 ? static_cast<double>(level) / static_cast<double>(count - 1) : 1.0));
}

/// Something drawn in a view: points of the sphere become places in the figure where they are seen.
template <class View>
void draw_line(reports::Svg& svg, const View& view, const std::vector<Point<3>>& points, const std::string& colour,
               double thickness) {
    Line line;
    for (const Point<3>& x : points) {
        const auto place = view(x);
        if (place) {
            line.push_back(*place);
            continue;
        }
        if (line.size() > 1) svg.polyline(line, colour, thickness);
        line.clear();
    }
    if (line.size() > 1) svg.polyline(line, colour, thickness);
}

template <class View>
void draw_scene(reports::Svg& svg, const View& view, const StereographicMap& map, const std::vector<SpherePath>& levels,
                bool straight_in_map) {
    for (const auto& line : graticule(15)) draw_line(svg, view, line, "#cfd6df", 0.6);
    for (std::size_t i = 0; i < levels.size(); ++i) {
        std::vector<Point<3>> points;
        const auto& vertices = levels[i].points;
        for (std::size_t k = 0; k + 1 < vertices.size(); ++k) {
            const int parts = straight_in_map ? 1 : static_cast<int>(1 + 192 / vertices.size());
            for (int s = 0; s < parts; ++s) {
                // On the globe the straight pieces of the map are drawn as what they are there: curves.
                const double t = static_cast<double>(s) / parts;
                points.push_back(map.to_sphere({(1 - t) * vertices[k][0] + t * vertices[k + 1][0],
                                                (1 - t) * vertices[k][1] + t * vertices[k + 1][1]}));
            }
            if (k + 2 == vertices.size()) points.push_back(map.to_sphere(vertices[k + 1]));
        }
        const bool finest = i + 1 == levels.size();
        draw_line(svg, view, points, path_colour(i, levels.size()), finest ? 2.6 : 1.4);
        if (vertices.size() > 2 && vertices.size() <= 17) {
            for (std::size_t k = 1; k + 1 < vertices.size(); ++k) {
                if (const auto place = view(map.to_sphere(vertices[k])))
                    svg.circle(place->first, place->second, 2.4, path_colour(i, levels.size()), "#ffffff", 0.6);
            }
        }
    }
    const auto city = [&](const GeographicPosition& at, const char* name, const char* anchor, double dx, double dy) {
        if (const auto place = view(StereographicMap::sphere(at))) {
            svg.circle(place->first, place->second, 4, "#1b2430", "#ffffff", 1);
            svg.text(place->first + dx, place->second + dy, name, 12, anchor, "#1b2430", true, "#ffffff");
        }
    };
    city(johannesburg, "Johannesburg", "middle", 0, 15);
    city(kyoto, "Kyoto", "start", 8, -8);
}

}  // namespace

Figure figure_sphere(const FigureOptions& options) {
    const int steps = options.quick ? 64 : 256;
    const StereographicMap map(GeographicPosition{90, 0});  // from the south pole, as the paper's figure
    const Point<3> start = StereographicMap::sphere(johannesburg), end = StereographicMap::sphere(kyoto);
    const Point<2> a = map.to_plane(start), b = map.to_plane(end);
    const double angle = great_circle_distance(start, end);

    Figure figure;
    figure.name = "figure-3";
    figure.title = "Discrete geodesics from Johannesburg to Kyoto, K = 1, 2, 4, ..., " + std::to_string(steps);
    figure.numbers.columns = {
        "method",      "tolerance_radians", "steps_K",      "relaxation_steps",         "relaxation_steps_all_levels",
        "path_length", "great_circle",      "length_error", "largest_deviation_radians"};
    // The same stop for both; several of them, because the comparison depends on it.
    constexpr double headline = 3e-5;
    std::vector<SpherePath> shown;
    long single_steps = 0, cascade_steps = 0;
    double single_deviation = 0, cascade_deviation = 0, cascade_error = 0;
    for (const double tolerance : {1e-4, 3e-5, 1e-5, 1e-6}) {
        const SpherePath single = single_level_geodesic(map, a, b, steps, tolerance);
        const auto levels = cascadic_geodesics(map, a, b, steps, tolerance);
        const auto row = [&](const char* method, const SpherePath& path, long all) {
            figure.numbers.add({method, exact(tolerance), std::to_string(path.points.size() - 1),
                                std::to_string(path.relaxation_steps), std::to_string(all), exact(path.length),
                                exact(angle), exact(path.length - angle), exact(path.largest_deviation)});
        };
        row("single_level", single, single.relaxation_steps);
        long all = 0;
        for (const SpherePath& path : levels) row("cascade", path, all += path.relaxation_steps);
        if (tolerance == headline) {
            shown = levels;
            single_steps = single.relaxation_steps;
            cascade_steps = all;
            single_deviation = single.largest_deviation;
            cascade_deviation = levels.back().largest_deviation;
            cascade_error = std::abs(levels.back().length - angle);
        }
    }

    reports::Svg svg(900, 470);
    const double globe = 190, gx = 225, gy = 225;
    const StereographicMap eye(GeographicPosition{12, 84});
    svg.circle(gx, gy, globe, "#f6f8fb", "#8b95a3", 1);
    draw_scene(
        svg,
        [&](const Point<3>& x) -> std::optional<std::pair<double, double>> {
            const Point<3> f = eye.frame(x);
            if (f[2] < 0) return std::nullopt;
            return std::pair{gx + globe * f[0], gy - globe * f[1]};
        },
        map, shown, false);
    const double mx = 480, my = 35, side = 380, reach = 1.3;
    const Point<2> middle{0.5, -0.5};
    svg.rect(mx, my, side, side, "#f6f8fb", "#8b95a3");
    draw_scene(
        svg,
        [&](const Point<3>& x) -> std::optional<std::pair<double, double>> {
            const Point<2> p = map.to_plane(x);
            const Point<2> q{p[0] - middle[0], p[1] - middle[1]};
            if (std::abs(q[0]) > reach || std::abs(q[1]) > reach) return std::nullopt;
            return std::pair{mx + side / 2 + side / 2 * q[0] / reach, my + side / 2 - side / 2 * q[1] / reach};
        },
        map, shown, true);
    svg.text(gx, 18, "on the globe", 12, "middle");
    svg.text(mx + side / 2, 18, "in the stereographic projection", 12, "middle");
    for (std::size_t i = 0; i < shown.size(); ++i) {
        const double x = 130 + 74 * static_cast<double>(i);
        svg.line(x, 448, x + 22, 448, path_colour(i, shown.size()), i + 1 == shown.size() ? 2.6 : 1.6);
        svg.text(x + 27, 448, std::to_string(1 << i), 11);
    }
    svg.text(40, 448, "time steps K", 11);

    figure.svg = svg.document(figure.title);
    figure.caption =
        "Left: on the globe; right: in the stereographic projection from the south pole (every 15 degrees). "
        "Vertices are moved one by one to the least sum of squared distances to their neighbours, until no "
        "vertex of a sweep moves by more than " +
        rounded(headline) + " of the earth's radius. One level: " + std::to_string(single_steps) +
        " such steps; cascade over K: " + std::to_string(cascade_steps) +
        " (paper: 917235 and 2593). The great circle is " + rounded(angle * earth_radius, 5) + " km.";
    const double gain = static_cast<double>(single_steps) / static_cast<double>(cascade_steps);
    figure.checks = {
        {"relaxation steps, one level", std::to_string(single_steps), "paper: 917235 (K = 256)",
         single_steps > cascade_steps},
        {"relaxation steps, cascade", std::to_string(cascade_steps), "paper: 2593; fewer than a hundredth of one level",
         gain > (options.quick ? 10 : 100)},
        {"largest distance from the great circle, cascade", rounded(cascade_deviation * earth_radius, 3) + " km",
         "not more than on one level (" + rounded(single_deviation * earth_radius, 3) + " km)",
         cascade_deviation <= single_deviation},
        {"error of the length, cascade", rounded(cascade_error * earth_radius * 1000, 3) + " m", "below 100 m",
         cascade_error * earth_radius * 1000 < 100}};
    return figure;
}

}  // namespace morphodesic::pipeline

// Figure 3: discrete geodesics on the sphere, single level against cascade.
#include <cmath>
#include <numbers>
#include <optional>

#include "pipeline/figures/canvas.h"
#include "pipeline/figures/coastlines.h"
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

/// A coast as points of the sphere, two degrees apart at most, so that its pieces bend as they should in any view.
std::vector<Point<3>> coast_points(const Coast& coast) {
    std::vector<Point<3>> points;
    for (std::size_t i = 0; i < coast.size(); ++i) {
        const GeographicPosition &from = coast[i], &to = coast[(i + 1) % coast.size()];
        const double lat = to.latitude - from.latitude, lon = to.longitude - from.longitude;
        const int parts = 1 + static_cast<int>(std::max(std::abs(lat), std::abs(lon)) / 2);
        for (int s = 0; s < parts; ++s) {
            points.push_back(
                StereographicMap::sphere({from.latitude + lat * s / parts, from.longitude + lon * s / parts}));
        }
    }
    return points;
}

/// The part of a polygon on one side of a line parallel to an axis (Sutherland and Hodgman).
Line clipped(const Line& polygon, bool horizontal, double limit, double side) {
    const auto inside = [&](const std::pair<double, double>& p) {
        return side * ((horizontal ? p.first : p.second) - limit);
    };
    Line result;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const auto &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
        const double a = inside(p), b = inside(q);
        if (a >= 0) result.push_back(p);
        if ((a >= 0) != (b >= 0)) {
            const double t = a / (a - b);
            result.emplace_back(p.first + t * (q.first - p.first), p.second + t * (q.second - p.second));
        }
    }
    return result;
}

/// @param outline  a coast in the figure, cut off where the view ends
template <class View, class Outline>
void draw_scene(reports::Svg& svg, const View& view, const Outline& outline, const StereographicMap& map,
                const std::vector<SpherePath>& levels, bool straight_in_map) {
    for (const auto& [coasts, fill] : {std::pair{&coastlines(), "#d9ddd6"}, std::pair{&inland_seas(), "#f6f8fb"}}) {
        for (const Coast& coast : *coasts) {
            auto points = coast_points(coast);
            svg.area({outline(points)}, fill);
            points.push_back(points.front());
            draw_line(svg, view, points, "#8f9a92", 0.7);
        }
    }
    for (const auto& line : graticule(15)) draw_line(svg, view, line, "#bcc5cf", 0.5);
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
    figure.numbers.columns = {"method",
                              "stop",
                              "tolerance_radians",
                              "steps_K",
                              "relaxation_steps",
                              "relaxation_steps_all_levels",
                              "path_length",
                              "great_circle",
                              "length_error",
                              "largest_deviation_radians"};
    struct Comparison {
        SpherePath single;
        std::vector<SpherePath> levels;
        long cascade_steps = 0;
        [[nodiscard]] double gain() const {
            return static_cast<double>(single.relaxation_steps) / static_cast<double>(cascade_steps);
        }
    };
    const auto compare = [&](const RelaxationStop& stop) {
        Comparison c{single_level_geodesic(map, a, b, steps, stop), cascadic_geodesics(map, a, b, steps, stop)};
        const auto row = [&](const char* method, const SpherePath& path, long all) {
            figure.numbers.add({method, stop.measure == RelaxationStop::Measure::move ? "move" : "distance",
                                exact(stop.tolerance), std::to_string(path.points.size() - 1),
                                std::to_string(path.relaxation_steps), std::to_string(all), exact(path.length),
                                exact(angle), exact(path.length - angle), exact(path.largest_deviation)});
        };
        row("single_level", c.single, c.single.relaxation_steps);
        for (const SpherePath& path : c.levels) row("cascade", path, c.cascade_steps += path.relaxation_steps);
        return c;
    };
    // Counted twice: with the stop that the paper's numbers suggest, by the size of the moves, and to equal accuracy;
    // many small moves end the first one far from the geodesic on a single level.
    for (const double tolerance : {1e-4, 1e-5, 1e-6}) compare({RelaxationStop::Measure::move, tolerance});
    const Comparison by_move = compare({RelaxationStop::Measure::move, 3e-5});
    const Comparison by_distance = compare({RelaxationStop::Measure::distance, 1e-3});
    const std::vector<SpherePath>& shown = by_distance.levels;

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
        [&](const std::vector<Point<3>>& coast) {
            Line line;
            for (const Point<3>& x : coast) {
                // What lies behind the horizon is drawn together onto the rim.
                const Point<3> f = eye.frame(x);
                const double shrink = f[2] < 0 ? 1 / std::max(std::hypot(f[0], f[1]), 1e-9) : 1.0;
                line.emplace_back(gx + globe * shrink * f[0], gy - globe * shrink * f[1]);
            }
            return line;
        },
        map, shown, false);
    const double mx = 480, my = 35, side = 380, reach = 1.3;
    const Point<2> middle{0.5, -0.5};
    svg.rect(mx, my, side, side, "#f6f8fb", "#8b95a3");
    const auto on_map = [&](const Point<3>& x) {
        const Point<2> p = map.to_plane(x);
        return std::pair{mx + side / 2 * (1 + (p[0] - middle[0]) / reach),
                         my + side / 2 * (1 - (p[1] - middle[1]) / reach)};
    };
    draw_scene(
        svg,
        [&](const Point<3>& x) -> std::optional<std::pair<double, double>> {
            const auto p = on_map(x);
            if (p.first < mx || p.first > mx + side || p.second < my || p.second > my + side) return std::nullopt;
            return p;
        },
        [&](const std::vector<Point<3>>& coast) {
            Line line;
            for (const Point<3>& x : coast) line.push_back(on_map(x));
            line = clipped(clipped(line, true, mx, 1), true, mx + side, -1);
            return clipped(clipped(line, false, my, 1), false, my + side, -1);
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
    const auto km = [](double radians) { return rounded(radians * earth_radius, 3) + " km"; };
    const auto count = [](long n) { return std::to_string(n); };
    const double cascade_error = std::abs(by_distance.levels.back().length - angle);
    figure.caption =
        "Left: on the globe; right: in the stereographic projection from the south pole (graticule: 15 degrees, coasts "
        "drawn by hand). Vertices are moved one by one to the least sum of squared distances to their neighbours. "
        "Until "
        "none is farther than 1e-3 of the earth's radius (6.4 km) from its place on the great circle this takes " +
        count(by_distance.single.relaxation_steps) + " moves on one level and " + count(by_distance.cascade_steps) +
        " with the cascade over K. If a sweep with moves below 3e-5 ends it (paper: 917235 and 2593): " +
        count(by_move.single.relaxation_steps) + ", but then " + km(by_move.single.largest_deviation) + " away, and " +
        count(by_move.cascade_steps) + ", " + km(by_move.levels.back().largest_deviation) +
        " away. The great circle is " + rounded(angle * earth_radius, 5) + " km.";
    const double wanted_gain = options.quick ? 20 : 350;
    const std::string gain_reason = options.quick ? "the gain grows with K^2; 350 at K = 256 is 22 at K = 64"
                                                  : "the paper's gain at K = 256: 917235 / 2593 = 354";
    figure.checks = {
        {"relaxation steps to 6.4 km, one level / cascade",
         count(by_distance.single.relaxation_steps) + " / " + count(by_distance.cascade_steps) + " = " +
             rounded(by_distance.gain(), 3),
         "at least " + rounded(wanted_gain, 3), by_distance.gain() >= wanted_gain, gain_reason},
        {"relaxation steps until moves are below 3e-5, one level / cascade",
         count(by_move.single.relaxation_steps) + " / " + count(by_move.cascade_steps) + " = " +
             rounded(by_move.gain(), 3),
         "at least " + rounded(wanted_gain, 3), by_move.gain() >= wanted_gain, gain_reason},
        {"largest distance from the great circle at that stop, cascade", km(by_move.levels.back().largest_deviation),
         "not more than on one level (" + km(by_move.single.largest_deviation) + ")",
         by_move.levels.back().largest_deviation <= by_move.single.largest_deviation,
         "fewer steps must not be paid with accuracy"},
        {"error of the length, cascade, stopped at 6.4 km", rounded(cascade_error * earth_radius * 1000, 3) + " m",
         "below 100 m", cascade_error * earth_radius * 1000 < 100,
         "a path that swings 6.4 km to the sides in m half waves is 8 m^2 m longer; 100 m allows three"}};
    return figure;
}

}  // namespace morphodesic::pipeline

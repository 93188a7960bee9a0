#include "pipeline/figures/canvas.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "geodesic/grid/contour.h"
#include "geodesic/grid/q1_element.h"
#include "reports/text.h"

namespace morphodesic::pipeline {
namespace {

using Area = std::vector<std::vector<std::pair<double, double>>>;

Area placed(const Panel& panel, const std::vector<ContourLoop>& loops) {
    Area area;
    for (const ContourLoop& loop : loops) {
        auto& placed_loop = area.emplace_back();
        for (const Point<2>& p : loop) placed_loop.push_back(panel.at(p));
    }
    return area;
}

double slope_at(const LevelSet<2>& u, const Point<2>& x) {
    const double h = 0.5 * u.grid.spacing();
    const double dx = sample(u, {x[0] + h, x[1]}) - sample(u, {x[0] - h, x[1]});
    const double dy = sample(u, {x[0], x[1] + h}) - sample(u, {x[0], x[1] - h});
    return std::hypot(dx, dy) / (2 * h);
}

/// Calls pixel(column, row, point of the square) -> rgba for a raster over the panel.
template <class Pixel>
void raster(reports::Svg& svg, const Panel& panel, double density, const Pixel& pixel) {
    RgbaImage image(static_cast<int>(std::lround(panel.width * density)),
                    static_cast<int>(std::lround(panel.height * density)));
    oneapi::tbb::parallel_for(0, image.height, [&](int row) {
        for (int column = 0; column < image.width; ++column) {
            const double px = panel.x + (column + 0.5) * panel.width / image.width;
            const double py = panel.y + (row + 0.5) * panel.height / image.height;
            image.set(column, row, pixel(panel.back(px, py)));
        }
    });
    svg.image(panel.x, panel.y, panel.width, panel.height, encode_png(image));
}

/// Noise that depends on the pixel only: the same pictures on every machine.
double noise(int column, int row) {
    auto z = static_cast<std::uint64_t>(column) * 0x9E3779B97F4A7C15ULL +
             static_cast<std::uint64_t>(row) * 0xC2B2AE3D27D4EB4FULL + 0x165667B19E3779F9ULL;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1.0p-53;
}

}  // namespace

std::string hex(const Colour& c) {
    char text[8];
    std::snprintf(text, sizeof text, "#%02x%02x%02x", c[0], c[1], c[2]);
    return text;
}

double sample(const ScalarField<2>& field, const Point<2>& x) {
    return q1::value(field.grid, field.values.data(), x);
}

void fill_shape(reports::Svg& svg, const Panel& panel, const LevelSet<2>& u, const std::string& fill,
                const std::string& stroke, double thickness) {
    svg.area(placed(panel, contour(u)), fill, stroke, thickness);
}

void outline_shape(reports::Svg& svg, const Panel& panel, const LevelSet<2>& u, const std::string& colour,
                   double thickness, double value) {
    svg.area(placed(panel, contour(u, value)), {}, colour, thickness);
}

void paint(reports::Svg& svg, const Panel& panel, const std::function<Colour(const Point<2>&)>& colour_at,
           double density) {
    raster(svg, panel, density, [&](const Point<2>& x) {
        const Colour c = colour_at(x);
        return std::array<unsigned char, 4>{c[0], c[1], c[2], 255};
    });
}

void paint_inside(reports::Svg& svg, const Panel& panel, const LevelSet<2>& u,
                  const std::function<Colour(const Point<2>&)>& colour_at, const std::string& stroke, double density) {
    const double pixel = 1.0 / (panel.scale() * density);
    raster(svg, panel, density, [&](const Point<2>& x) {
        const double value = sample(u, x);
        if (value < -2 * u.grid.spacing()) return std::array<unsigned char, 4>{};
        const double coverage = std::clamp(0.5 + value / (std::max(slope_at(u, x), 0.25) * pixel), 0.0, 1.0);
        if (coverage <= 0) return std::array<unsigned char, 4>{};
        const Colour c = colour_at(x);
        return std::array<unsigned char, 4>{c[0], c[1], c[2], static_cast<unsigned char>(std::lround(255 * coverage))};
    });
    if (!stroke.empty()) outline_shape(svg, panel, u, stroke, 0.7);
}

void colour_bar(reports::Svg& svg, double x, double y, double width, const ColourMap& map, double low, double high,
                const std::string& title) {
    constexpr int steps = 128;
    std::vector<std::string> colours;
    for (int i = 0; i < steps; ++i) colours.push_back(hex(map(static_cast<double>(i) / (steps - 1))));
    if (!(high > low)) high = low + 1;  // nothing moves
    svg.text(x + width / 2, y, title, 11, "middle");
    svg.image(x, y + 9, width, 10, reports::raster_png(steps, 1, colours), true);
    svg.rect(x, y + 9, width, 10, "none", "#5b6573");
    const reports::Scale scale{low, high, x, x + width};
    for (const double v : reports::ticks(low, high, 4)) {
        svg.line(scale(v), y + 19, scale(v), y + 22, "#5b6573");
        svg.text(scale(v), y + 29, reports::short_number(v), 9, "middle");
    }
}

Colour level_line_colour(double u, double width) {
    // A soft triangle wave of u: dark in the middle of every second band.
    const double phase = u / (2 * width) - std::floor(u / (2 * width));
    const double wave = std::clamp(0.5 + 2.2 * (std::abs(2 * phase - 1) - 0.5), 0.0, 1.0);
    const std::array<double, 3> dark =
        u > 0 ? std::array<double, 3>{148, 52, 30} : std::array<double, 3>{120, 146, 170};
    const std::array<double, 3> light =
        u > 0 ? std::array<double, 3>{232, 150, 84} : std::array<double, 3>{228, 236, 242};
    Colour colour{};
    for (std::size_t c = 0; c < 3; ++c) {
        colour[c] = static_cast<unsigned char>(std::lround(dark[c] + wave * (light[c] - dark[c])));
    }
    return colour;
}

std::vector<double> line_integral_convolution(const VectorField<2>& field, const LevelSet<2>& inside,
                                              const Panel& panel, int pixels) {
    const auto n = static_cast<std::size_t>(pixels);
    std::vector<double> result(n * n, 0.5);
    const double pixel = panel.span / pixels;
    const auto place = [&](double column, double row) -> Point<2> {
        return {panel.centre[0] + (column + 0.5) * pixel - 0.5 * panel.span,
                panel.centre[1] - (row + 0.5) * pixel + 0.5 * panel.span * panel.height / panel.width};
    };
    const double longest = 0.04 * pixels;  // half length of a streamline, pixels
    oneapi::tbb::parallel_for(0, pixels, [&](int row) {
        for (int column = 0; column < pixels; ++column) {
            if (sample(inside, place(column, row)) < -inside.grid.spacing()) continue;
            double sum = 0.0, weight = 0.0;
            for (const double direction : {1.0, -1.0}) {
                double x = column, y = row;
                for (double length = 0; length < longest; length += 0.7) {
                    const double w = 0.5 * (1 + std::cos(3.141592653589793 * length / longest));
                    // Noise grains two pixels wide, so that the texture survives being scaled down.
                    sum += w * noise(static_cast<int>(std::floor(x / 2)), static_cast<int>(std::floor(y / 2)));
                    weight += w;
                    const Point<2> p = place(x, y);
                    if (sample(inside, p) < -inside.grid.spacing()) break;
                    const double vx = q1::value(field.grid, field.components[0].data(), p);
                    const double vy = q1::value(field.grid, field.components[1].data(), p);
                    const double speed = std::hypot(vx, vy);
                    if (speed < 1e-12) break;
                    x += 0.7 * direction * vx / speed;
                    y -= 0.7 * direction * vy / speed;
                }
            }
            // The mean of many grains lies near 1/2: stretch the contrast.
            result[static_cast<std::size_t>(row) * n + static_cast<std::size_t>(column)] =
                std::clamp(0.5 + 2.4 * (sum / weight - 0.5), 0.0, 1.0);
        }
    });
    return result;
}

}  // namespace morphodesic::pipeline

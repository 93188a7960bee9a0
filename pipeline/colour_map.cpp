#include "pipeline/colour_map.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace morphodesic::pipeline {
namespace {

using Lab = std::array<double, 3>;

double to_linear(double c) {
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}
double from_linear(double c) {
    return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
}

Lab to_oklab(const Colour& colour) {
    const double r = to_linear(colour[0] / 255.0), g = to_linear(colour[1] / 255.0), b = to_linear(colour[2] / 255.0);
    const double l = std::cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
    const double m = std::cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
    const double s = std::cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
    return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
            1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
            0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

Colour from_oklab(const Lab& lab) {
    const auto cube = [](double x) { return x * x * x; };
    const double l = cube(lab[0] + 0.3963377774 * lab[1] + 0.2158037573 * lab[2]);
    const double m = cube(lab[0] - 0.1055613458 * lab[1] - 0.0638541728 * lab[2]);
    const double s = cube(lab[0] - 0.0894841775 * lab[1] - 1.2914855480 * lab[2]);
    const Lab rgb{4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
                  -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
                  -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
    Colour colour{};
    for (std::size_t c = 0; c < 3; ++c) {
        colour[c] = static_cast<unsigned char>(
            std::lround(255 * std::clamp(from_linear(std::clamp(rgb[c], 0.0, 1.0)), 0.0, 1.0)));
    }
    return colour;
}

/// Fixed points in OKLab and their places in [0, 1], spaced by their distance.
struct Anchors {
    std::vector<Lab> colours;
    std::vector<double> places;

    Anchors() {
        for (const Colour& colour : {Colour{38, 63, 158}, Colour{122, 62, 176}, Colour{196, 60, 122},
                                     Colour{229, 84, 62}, Colour{246, 162, 60}}) {
            colours.push_back(to_oklab(colour));
            const std::size_t n = colours.size();
            double step = 0.0;
            if (n > 1) {
                for (std::size_t c = 0; c < 3; ++c) step += std::pow(colours[n - 1][c] - colours[n - 2][c], 2);
            }
            places.push_back(n > 1 ? places.back() + std::sqrt(step) : 0.0);
        }
        for (double& place : places) place /= places.back();
    }
};

}  // namespace

Colour dissipation_colour(double value) {
    static const Anchors anchors;
    const double v = std::isnan(value) ? 0.0 : std::clamp(value, 0.0, 1.0);
    std::size_t i = 1;
    while (i + 1 < anchors.places.size() && anchors.places[i] < v) ++i;
    const double t = (v - anchors.places[i - 1]) / (anchors.places[i] - anchors.places[i - 1]);
    Lab lab{};
    for (std::size_t c = 0; c < 3; ++c) lab[c] = (1 - t) * anchors.colours[i - 1][c] + t * anchors.colours[i][c];
    return from_oklab(lab);
}

std::vector<std::string> dissipation_colours(int n) {
    std::vector<std::string> colours;
    for (int i = 0; i < n; ++i) {
        const Colour c = dissipation_colour(static_cast<double>(i) / (n - 1));
        char text[8];
        std::snprintf(text, sizeof text, "#%02x%02x%02x", c[0], c[1], c[2]);
        colours.emplace_back(text);
    }
    return colours;
}

}  // namespace morphodesic::pipeline

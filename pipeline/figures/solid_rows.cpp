#include "pipeline/figures/solid_rows.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "datasets/normalize.h"
#include "datasets/voxelize.h"
#include "geodesic/grid/q1_element.h"
#include "pipeline/path_pictures.h"

namespace morphodesic::pipeline {
namespace {

double value(const LevelSet<3>& u, const Point<3>& x) {
    return q1::value(u.grid, u.values.data(), x);
}

bool in_cube(const Point<3>& x) {
    return std::all_of(x.begin(), x.end(), [](double c) { return c >= 0 && c <= 1; });
}

}  // namespace

LevelSet<3> solid_shape(const datasets::GeneratedSolid& solid, double scale, int level) {
    datasets::TriangleMesh mesh = solid.mesh;
    const datasets::Vector3 centre = datasets::volume_centroid(mesh);
    for (auto& p : mesh.points) {
        for (std::size_t a = 0; a < 3; ++a) p[a] = 0.5 + scale * (p[a] - centre[a]);
    }
    return datasets::signed_distance(mesh, DyadicGrid<3>(level));
}

double fitting_scale(const std::vector<datasets::GeneratedSolid>& solids) {
    std::vector<double> radii;
    for (const auto& solid : solids) {
        const datasets::Vector3 centre = datasets::volume_centroid(solid.mesh);
        double radius = 0;
        for (const auto& p : solid.mesh.points)
            radius = std::max(radius, std::hypot(p[0] - centre[0], p[1] - centre[1], p[2] - centre[2]));
        radii.push_back(radius);
    }
    return datasets::common_scale(radii);
}

RgbaImage cut_picture(const LevelSet<3>& u, int pixels, double band) {
    // The view of path_pictures: from the front right and above.
    const double c = 0.8660254037844387, s = 0.5, c2 = 0.9396926207859084, s2 = 0.3420201433325687;
    const Point<3> right{c, s, 0}, forward{-s * c2, c * c2, -s2}, up{-s * s2, c * s2, c2};
    const double step = 0.5 * u.grid.spacing(), pixel = 2 * picture_radius / pixels;
    RgbaImage image(pixels, pixels);
    oneapi::tbb::parallel_for(0, pixels, [&](int row) {
        for (int column = 0; column < pixels; ++column) {
            const double across = (column + 0.5) * pixel - picture_radius, high = picture_radius - (row + 0.5) * pixel;
            const auto place = [&](double depth) {
                Point<3> x{};
                for (std::size_t a = 0; a < 3; ++a) {
                    x[a] = 0.5 + across * right[a] + high * up[a] + depth * forward[a];
                }
                return x;
            };
            const double plane = -(across * right[1] + high * up[1]) / forward[1];  // depth where y = 1/2
            // Shaded surface behind the plane.
            std::optional<double> light;
            double before = -1.0;
            for (double depth = plane; depth < 0.75 && !light; depth += step) {
                const Point<3> x = place(depth);
                const double now = in_cube(x) ? value(u, x) : -1.0;
                if (now >= 0 && before < 0 && depth > plane) {
                    Point<3> g{};
                    double length = 0;
                    for (std::size_t a = 0; a < 3; ++a) {
                        Point<3> low = x, top = x;
                        low[a] -= step;
                        top[a] += step;
                        g[a] = value(u, top) - value(u, low);
                        length += g[a] * g[a];
                    }
                    length = std::max(std::sqrt(length), 1e-12);
                    double sum = 0;
                    for (std::size_t a = 0; a < 3; ++a)
                        sum -= g[a] / length * (0.55 * up[a] - 0.35 * right[a] - 0.75 * forward[a]);
                    light = 0.45 + 0.55 * std::max(sum, 0.0);
                }
                before = now;
            }
            const Point<3> p = place(plane);
            const bool window = std::abs(p[0] - 0.5) < 0.40 && std::abs(p[2] - 0.5) < 0.30;
            std::array<double, 4> colour{0, 0, 0, 0};
            if (light) colour = {150 * *light, 170 * *light, 205 * *light, 1.0};
            if (window) {
                const double here = value(u, p);
                const Colour lines = level_line_colour(here, band);
                const double slope = 1.0 / pixel;
                const double inside = std::clamp(0.5 + here * slope, 0.0, 1.0);
                const double alpha = 0.45 + 0.55 * inside;
                const double rim = std::clamp(1.6 - std::abs(here) * slope, 0.0, 1.0);  // the contour as a dark line
                for (std::size_t a = 0; a < 3; ++a) {
                    const double front = (1 - rim) * lines[a] + rim * 27.0;
                    colour[a] =
                        (alpha * front + (1 - alpha) * colour[3] * colour[a]) / (alpha + (1 - alpha) * colour[3]);
                }
                colour[3] = alpha + (1 - alpha) * colour[3];
            }
            std::array<unsigned char, 4> rgba{};
            for (std::size_t a = 0; a < 3; ++a)
                rgba[a] = static_cast<unsigned char>(std::lround(std::clamp(colour[a], 0.0, 255.0)));
            rgba[3] = static_cast<unsigned char>(std::lround(255 * colour[3]));
            image.set(column, row, rgba);
        }
    });
    return image;
}

const GeodesicResult<3>& quadruped_path(const FigureOptions& options) {
    static std::map<bool, GeodesicResult<3>> known;
    if (const auto it = known.find(options.quick); it != known.end()) return it->second;
    const GeodesicOptions settings = options.geodesic(3);
    datasets::CollectionOptions collection;
    collection.count = 2;
    collection.variation = 0.5;
    const auto animals = datasets::quadrupeds(collection);
    const double scale = fitting_scale(animals);
    return known[options.quick] =
               compute_discrete_geodesic<3>(solid_shape(animals[0], scale, settings.level),
                                            solid_shape(animals[1], scale, settings.level), settings);
}

}  // namespace morphodesic::pipeline

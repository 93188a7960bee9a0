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

namespace {

/// Parallel rays of the pictures of solids: from the front right and above, z up.
struct Camera {
    Point<3> right{0.8660254037844387, 0.5, 0}, forward, up;
    double pixel;

    explicit Camera(int pixels) : pixel(2 * picture_radius / pixels) {
        constexpr double c = 0.8660254037844387, s = 0.5, c2 = 0.9396926207859084, s2 = 0.3420201433325687;
        forward = {-s * c2, c * c2, -s2};
        up = {-s * s2, c * s2, c2};
    }
    [[nodiscard]] Point<3> at(double across, double high, double depth) const {
        Point<3> x{};
        for (std::size_t a = 0; a < 3; ++a) x[a] = 0.5 + across * right[a] + high * up[a] + depth * forward[a];
        return x;
    }
};

/// First point of the surface on a ray from `from` on, and how bright it is.
struct Surface {
    Point<3> x{};
    double brightness = 1.0;
};

std::optional<Surface> surface_on_ray(const LevelSet<3>& u, const Camera& camera, double across, double high,
                                      double from) {
    const double step = 0.5 * u.grid.spacing();
    double before = -1.0;
    for (double depth = from; depth < 0.75; depth += step) {
        Point<3> x = camera.at(across, high, depth);
        const double now = in_cube(x) ? value(u, x) : -1.0;
        if (now >= 0 && before < 0 && depth > from) {
            x = camera.at(across, high, depth - step * now / (now - before));
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
            double light = 0;  // from the upper left behind the viewer; the normal is against grad u
            for (std::size_t a = 0; a < 3; ++a) {
                light -= g[a] / length * (0.55 * camera.up[a] - 0.35 * camera.right[a] - 0.75 * camera.forward[a]);
            }
            return Surface{x, 0.45 + 0.55 * std::max(light, 0.0)};
        }
        before = now;
    }
    return std::nullopt;
}

/// Calls paint(across, high) -> rgba for every pixel, places in units of the cube from the middle.
template <class Paint>
RgbaImage drawn(int pixels, const Paint& paint) {
    RgbaImage image(pixels, pixels);
    const double pixel = 2 * picture_radius / pixels;
    oneapi::tbb::parallel_for(0, pixels, [&](int row) {
        for (int column = 0; column < pixels; ++column) {
            const std::array<double, 4> c =
                paint((column + 0.5) * pixel - picture_radius, picture_radius - (row + 0.5) * pixel);
            std::array<unsigned char, 4> rgba{};
            for (std::size_t a = 0; a < 3; ++a) {
                rgba[a] = static_cast<unsigned char>(std::lround(std::clamp(c[a], 0.0, 255.0)));
            }
            rgba[3] = static_cast<unsigned char>(std::lround(255 * std::clamp(c[3], 0.0, 1.0)));
            image.set(column, row, rgba);
        }
    });
    return image;
}

}  // namespace

RgbaImage solid_picture(const LevelSet<3>& u, int pixels, const ScalarField<3>* rate, double high_rate) {
    const Camera camera(pixels);
    return drawn(pixels, [&](double across, double high) -> std::array<double, 4> {
        const auto hit = surface_on_ray(u, camera, across, high, -0.75);
        if (!hit) return {};
        Colour c{150, 170, 205};
        if (rate != nullptr) c = dissipation_colour(value(*rate, hit->x) / high_rate);
        return {c[0] * hit->brightness, c[1] * hit->brightness, c[2] * hit->brightness, 1.0};
    });
}

SolidFrames dissipation_pictures(const GeodesicResult<3>& path, int pixels) {
    const auto rates = dissipation_rates(path);
    std::vector<double> inside;
    for (std::size_t k = 0; k < rates.size(); ++k) {
        for (std::size_t i = 0; i < rates[k].values.size(); ++i) {
            if (path.shapes[k].values[i] > 0) inside.push_back(rates[k].values[i]);
        }
    }
    SolidFrames frames;
    if (!inside.empty()) {
        const auto at = inside.begin() + static_cast<std::ptrdiff_t>(0.98 * static_cast<double>(inside.size() - 1));
        std::nth_element(inside.begin(), at, inside.end());
        frames.highest = std::max(*at, 1e-300);
    }
    for (std::size_t k = 0; k < rates.size(); ++k) {
        frames.frames.push_back(solid_picture(path.shapes[k], pixels, &rates[k], frames.highest));
    }
    return frames;
}

RgbaImage cut_picture(const LevelSet<3>& u, int pixels, double band) {
    const Camera camera(pixels);
    return drawn(pixels, [&](double across, double high) {
        const double depth = -(across * camera.right[1] + high * camera.up[1]) / camera.forward[1];  // where y = 1/2
        std::array<double, 4> colour{};
        if (const auto hit = surface_on_ray(u, camera, across, high, depth)) {
            colour = {150 * hit->brightness, 170 * hit->brightness, 205 * hit->brightness, 1.0};
        }
        const Point<3> p = camera.at(across, high, depth);
        if (std::abs(p[0] - 0.5) < 0.40 && std::abs(p[2] - 0.5) < 0.30) {
            const double here = value(u, p) / camera.pixel;  // in pixels
            const Colour lines = level_line_colour(value(u, p), band);
            const double alpha = 0.45 + 0.55 * std::clamp(0.5 + here, 0.0, 1.0);
            const double rim = std::clamp(1.6 - std::abs(here), 0.0, 1.0);  // the contour as a dark line
            const double total = alpha + (1 - alpha) * colour[3];
            for (std::size_t a = 0; a < 3; ++a) {
                const double front = (1 - rim) * lines[a] + rim * 27.0;
                colour[a] = (alpha * front + (1 - alpha) * colour[3] * colour[a]) / total;
            }
            colour[3] = total;
        }
        return colour;
    });
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

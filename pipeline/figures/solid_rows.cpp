#include "pipeline/figures/solid_rows.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "datasets/normalize.h"
#include "datasets/voxelize.h"
#include "geodesic/grid/q1_element.h"
#include "geodesic/solver/path_interpolation.h"
#include "pipeline/solid_paths.h"

namespace morphodesic::pipeline {
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

SolidView side_view(int pixels, double aspect, double zoom) {
    SolidView view;
    view.camera.azimuth = -60;
    view.camera.width = pixels;
    view.camera.height = static_cast<int>(std::lround(aspect * pixels));
    view.camera.zoom = zoom / aspect;  // as wide as a square picture, without its empty strips
    view.slice_axis = 1;
    return view;
}

double fitting_zoom(const std::vector<LevelSet<3>>& shapes, datasets::View camera) {
    const datasets::ViewAxes axes = datasets::axes_of(camera);
    const double shorter = std::min(camera.width, camera.height);
    double radius = 0.05;  // half width that the shorter side of the picture must show
    for (const LevelSet<3>& u : shapes) {
        for (std::size_t i = 0; i < u.values.size(); ++i) {
            if (!(u.values[i] > 0)) continue;
            const Point<3> x = u.grid.position(u.grid.node(i));
            double right = 0, up = 0;
            for (std::size_t a = 0; a < 3; ++a) {
                right += (x[a] - 0.5) * axes.right[a];
                up += (x[a] - 0.5) * axes.up[a];
            }
            radius =
                std::max({radius, std::abs(right) * shorter / camera.width, std::abs(up) * shorter / camera.height});
        }
    }
    camera.zoom = 1.0;
    return datasets::view_radius(camera) / (1.12 * radius);
}

SolidFrames dissipation_pictures(const GeodesicResult<3>& path, const SolidView& view) {
    const auto rates = dissipation_of_steps(path);
    SolidFrames frames;
    frames.highest = upper_end<3>(rates, path.shapes);
    for (std::size_t k = 0; k < rates.size(); ++k) {
        frames.frames.push_back(shaded_picture(path.shapes[k], view.camera, &rates[k], frames.highest));
    }
    return frames;
}

std::vector<RgbaImage> cut_pictures(const std::vector<LevelSet<3>>& shapes, const SolidView& view,
                                    const PlaneColour& plane) {
    const datasets::ViewAxes axes = datasets::axes_of(view.camera);
    const auto across = static_cast<std::size_t>(view.slice_axis);
    const double side = axes.from[across] < 0 ? 1.0 : -1.0;  // the half away from the viewer stays
    const double width =
        2 * datasets::view_radius(view.camera) * view.camera.width / std::min(view.camera.width, view.camera.height);
    const double pixel = width / view.camera.width;
    // The plane reaches a little beyond the shapes.
    Point<3> reach{};
    for (const LevelSet<3>& u : shapes) {
        for (std::size_t i = 0; i < u.values.size(); ++i) {
            if (!(u.values[i] > 0)) continue;
            const Point<3> x = u.grid.position(u.grid.node(i));
            for (std::size_t a = 0; a < 3; ++a) reach[a] = std::max(reach[a], std::abs(x[a] - 0.5) + 0.06);
        }
    }
    std::vector<RgbaImage> pictures;
    for (std::size_t k = 0; k < shapes.size(); ++k) {
        const LevelSet<3>& u = shapes[k];
        LevelSet<3> half = u;
        for (std::size_t i = 0; i < half.values.size(); ++i) {
            const double beyond = side * (half.grid.position(half.grid.node(i))[across] - 0.5);
            half.values[i] = std::min(half.values[i], beyond);
        }
        RgbaImage image = shaded_picture(half, view.camera);
        if (std::abs(axes.from[across]) < 0.1) {  // the plane is seen from its edge
            pictures.push_back(std::move(image));
            continue;
        }
        oneapi::tbb::parallel_for(0, image.height, [&](int row) {
            for (int column = 0; column < image.width; ++column) {
                const double right = (column + 0.5 - 0.5 * image.width) * pixel;
                const double up = (0.5 * image.height - row - 0.5) * pixel;
                const double depth = -(right * axes.right[across] + up * axes.up[across]) / axes.from[across];
                Point<3> x{};
                bool on_plane = true;
                for (std::size_t a = 0; a < 3; ++a) {
                    x[a] = 0.5 + right * axes.right[a] + up * axes.up[a] + depth * axes.from[a];
                    on_plane = on_plane && (a == across || std::abs(x[a] - 0.5) < reach[a]);
                }
                if (!on_plane) continue;
                const double value = q1::value(u.grid, u.values.data(), x), in_pixels = value / pixel;
                const Colour colour = plane(k, x, value);
                const double alpha = 0.45 + 0.55 * std::clamp(0.5 + in_pixels, 0.0, 1.0);
                const double rim = std::clamp(1.6 - std::abs(in_pixels), 0.0, 1.0);  // the contour as a dark line
                auto* behind = image.pixels.data() + 4 * (static_cast<std::size_t>(row) * image.width + column);
                const double covered = (1 - alpha) * behind[3] / 255.0, total = alpha + covered;
                for (std::size_t a = 0; a < 3; ++a) {
                    const double front = (1 - rim) * colour[a] + rim * 27.0;
                    behind[a] = static_cast<unsigned char>(std::lround((alpha * front + covered * behind[a]) / total));
                }
                behind[3] = static_cast<unsigned char>(std::lround(255 * total));
            }
        });
        pictures.push_back(std::move(image));
    }
    return pictures;
}

PlaneColour level_lines_in_plane(double band) {
    return [band](std::size_t, const Point<3>&, double u) { return level_line_colour(u, band); };
}

PlaneColour grid_in_plane(const GeodesicResult<3>& path, int slice_axis, double spacing) {
    return [&path, slice_axis, spacing](std::size_t k, const Point<3>& x, double u) {
        Point<3> start = x;
        for (std::size_t step = k; step > 0; --step) start = inverse_at(path.deformations[step - 1], start);
        double line = 0.0;  // lines are a twelfth of their distance wide
        for (int a = 0; a < 3; ++a) {
            if (a == slice_axis) continue;
            const double cells = (start[static_cast<std::size_t>(a)] - 0.5) / spacing;
            const double off = std::abs(cells - std::round(cells));
            line = std::max(line, std::clamp(1.5 - off * 24, 0.0, 1.0));
        }
        const Colour ground = u > 0 ? Colour{226, 206, 186} : Colour{236, 240, 244};
        Colour colour{};
        for (std::size_t c = 0; c < 3; ++c) {
            colour[c] = static_cast<unsigned char>(std::lround((1 - 0.65 * line) * ground[c]));
        }
        return colour;
    };
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

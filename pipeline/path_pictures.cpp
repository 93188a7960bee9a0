#include "pipeline/path_pictures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "pipeline/colour_map.h"

namespace morphodesic::pipeline {
namespace {

/// Multilinear value of nodal values at a point; points outside the cube are moved to its boundary.
template <int Dim>
double value_at(const DyadicGrid<Dim>& grid, const std::vector<double>& values, const Point<Dim>& x) {
    typename DyadicGrid<Dim>::Index cell{};
    Point<Dim> t{};
    for (int a = 0; a < Dim; ++a) {
        const double s = std::clamp(x[a], 0.0, 1.0) * grid.cells_per_axis();
        cell[a] = std::min(static_cast<int>(s), grid.cells_per_axis() - 1);
        t[a] = s - cell[a];
    }
    double sum = 0.0;
    for (int corner = 0; corner < (1 << Dim); ++corner) {
        auto node = cell;
        double weight = 1.0;
        for (int a = 0; a < Dim; ++a) {
            const int bit = corner >> a & 1;
            node[a] += bit;
            weight *= bit ? t[a] : 1 - t[a];
        }
        sum += weight * values[grid.index(node)];
    }
    return sum;
}

template <int Dim>
Point<Dim> gradient_at(const LevelSet<Dim>& u, const Point<Dim>& x) {
    const double h = 0.5 * u.grid.spacing();
    Point<Dim> g{};
    for (int a = 0; a < Dim; ++a) {
        Point<Dim> low = x, high = x;
        low[a] -= h;
        high[a] += h;
        g[a] = (value_at<Dim>(u.grid, u.values, high) - value_at<Dim>(u.grid, u.values, low)) / (2 * h);
    }
    return g;
}

template <int Dim>
double norm(const Point<Dim>& g) {
    double sum = 0.0;
    for (const double x : g) sum += x * x;
    return std::sqrt(sum);
}

/// What a pixel sees: where, how much of the pixel is covered, and how bright the surface is.
template <int Dim>
struct Hit {
    Point<Dim> x{};
    double coverage = 0.0;
    double brightness = 1.0;
};

/// In 2D the pixel's own place; coverage from the distance to the contour in pixels.
std::optional<Hit<2>> look(const LevelSet<2>& u, double column, double row, double pixel) {
    Hit<2> hit;
    hit.x = {0.5 + column, 0.5 + row};
    const double value = value_at<2>(u.grid, u.values, hit.x);
    const double slope = std::max(norm<2>(gradient_at<2>(u, hit.x)), 0.25);
    hit.coverage = std::clamp(0.5 + value / (slope * pixel), 0.0, 1.0);
    if (hit.coverage <= 0) return std::nullopt;
    return hit;
}

/// In 3D the first point of the surface on a parallel ray, seen obliquely from above (z up), with diffuse light.
std::optional<Hit<3>> look(const LevelSet<3>& u, double column, double row, double) {
    const double c = 0.8660254037844387, s = 0.5, c2 = 0.9396926207859084, s2 = 0.3420201433325687;
    const Point<3> right{c, s, 0}, forward{-s * c2, c * c2, -s2}, up{-s * s2, c * s2, c2};
    const auto place = [&](double depth) {
        Point<3> x{};
        for (int a = 0; a < 3; ++a) x[a] = 0.5 + column * right[a] + row * up[a] + depth * forward[a];
        return x;
    };
    const double step = 0.5 * u.grid.spacing();
    double before = -std::numeric_limits<double>::infinity();
    for (double depth = -0.7; depth <= 0.7; depth += step) {
        const Point<3> at = place(depth);
        const bool inside_cube = std::all_of(at.begin(), at.end(), [](double a) { return a >= 0 && a <= 1; });
        const double value = inside_cube ? value_at<3>(u.grid, u.values, at) : -1.0;
        if (value >= 0 && std::isfinite(before)) {
            Hit<3> hit;
            hit.x = place(depth - step * value / (value - before));
            hit.coverage = 1.0;
            const Point<3> g = gradient_at<3>(u, hit.x);
            const double length = std::max(norm<3>(g), 1e-12);
            // Light from the upper left behind the viewer; the normal points out of the object, against grad u.
            double light = 0.0;
            for (int a = 0; a < 3; ++a) light -= g[a] / length * (0.55 * up[a] - 0.35 * right[a] - 0.75 * forward[a]);
            hit.brightness = 0.45 + 0.55 * std::max(light, 0.0);
            return hit;
        }
        before = value;
    }
    return std::nullopt;
}

/// Calls paint(hit) -> Colour for every pixel that sees the shape.
template <int Dim, class Paint>
RgbaImage draw(const LevelSet<Dim>& u, int pixels, const Paint& paint) {
    RgbaImage image(pixels, pixels);
    const double pixel = 2 * picture_radius / pixels;
    for (int row = 0; row < pixels; ++row) {
        for (int column = 0; column < pixels; ++column) {
            const auto hit =
                look(u, (column + 0.5) * pixel - picture_radius, picture_radius - (row + 0.5) * pixel, pixel);
            if (!hit || hit->coverage <= 0) continue;
            const Colour colour = paint(*hit);
            std::array<unsigned char, 4> rgba{0, 0, 0, static_cast<unsigned char>(std::lround(255 * hit->coverage))};
            for (std::size_t c = 0; c < 3; ++c) {
                rgba[c] = static_cast<unsigned char>(std::lround(std::min(colour[c] * hit->brightness, 255.0)));
            }
            image.set(column, row, rgba);
        }
    }
    return image;
}

/// phi^-1(y) by fixed-point iteration; the steps of a path are small deformations.
template <int Dim>
Point<Dim> inverse(const Deformation<Dim>& phi, const Point<Dim>& y) {
    Point<Dim> x = y;
    for (int i = 0; i < 20; ++i) {
        Point<Dim> next = y;
        for (int a = 0; a < Dim; ++a) next[a] -= value_at<Dim>(phi.grid(), phi.displacement.components[a], x);
        x = next;
    }
    return x;
}

/// Value below which the given share of the samples lies.
double quantile(std::vector<double> samples, double share) {
    if (samples.empty()) return 0.0;
    const auto at = samples.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(samples.size() - 1));
    std::nth_element(samples.begin(), at, samples.end());
    return *at;
}

}  // namespace

template <int Dim>
ScalarField<Dim> dissipation_rate(const Deformation<Dim>& phi, double tau, double lambda, double mu) {
    const DyadicGrid<Dim>& grid = phi.grid();
    ScalarField<Dim> rate(grid);
    for (std::size_t i = 0; i < grid.node_count(); ++i) {
        const auto node = grid.node(i);
        double gradient[Dim][Dim];
        for (int b = 0; b < Dim; ++b) {
            auto low = node, high = node;
            low[b] = std::max(node[b] - 1, 0);
            high[b] = std::min(node[b] + 1, grid.cells_per_axis());
            const double width = (high[b] - low[b]) * grid.spacing() * tau;
            for (int a = 0; a < Dim; ++a) {
                const auto& d = phi.displacement.components[a];
                gradient[a][b] = (d[grid.index(high)] - d[grid.index(low)]) / width;
            }
        }
        double trace = 0.0, square = 0.0;
        for (int a = 0; a < Dim; ++a) {
            trace += gradient[a][a];
            for (int b = 0; b < Dim; ++b) {
                const double strain = 0.5 * (gradient[a][b] + gradient[b][a]);
                square += strain * strain;
            }
        }
        rate.values[i] = 0.5 * lambda * trace * trace + mu * square;
    }
    return rate;
}

template <int Dim>
RgbaImage shape_picture(const LevelSet<Dim>& u, int pixels) {
    return draw(u, pixels, [](const Hit<Dim>&) { return Dim == 2 ? Colour{47, 62, 92} : Colour{150, 170, 205}; });
}

template <int Dim>
PathPictures path_pictures(const GeodesicResult<Dim>& path, int pixels) {
    const std::size_t steps = path.deformations.size();
    std::vector<ScalarField<Dim>> rates;
    for (const Deformation<Dim>& phi : path.deformations) {
        rates.push_back(dissipation_rate(phi, 1.0 / static_cast<double>(steps), path.options.lambda, path.options.mu));
    }
    PathPictures pictures;
    std::vector<double> inside;
    for (std::size_t k = 0; k < steps; ++k) {
        for (std::size_t i = 0; i < rates[k].values.size(); ++i) {
            if (path.shapes[k].values[i] > 0) inside.push_back(rates[k].values[i]);
        }
    }
    pictures.highest = quantile(std::move(inside), 0.98);
    const double unit = std::max(pictures.highest, 1e-300);
    for (std::size_t k = 0; k <= steps && steps > 0; ++k) {
        const bool last = k == steps;
        const ScalarField<Dim>& rate = rates[last ? steps - 1 : k];
        pictures.frames.push_back(draw(path.shapes[k], pixels, [&](const Hit<Dim>& hit) {
            const Point<Dim> x = last ? inverse<Dim>(path.deformations[steps - 1], hit.x) : hit.x;
            return dissipation_colour(value_at<Dim>(rate.grid, rate.values, x) / unit);
        }));
    }
    return pictures;
}

template ScalarField<2> dissipation_rate<2>(const Deformation<2>&, double, double, double);
template ScalarField<3> dissipation_rate<3>(const Deformation<3>&, double, double, double);
template RgbaImage shape_picture<2>(const LevelSet<2>&, int);
template RgbaImage shape_picture<3>(const LevelSet<3>&, int);
template PathPictures path_pictures<2>(const GeodesicResult<2>&, int);
template PathPictures path_pictures<3>(const GeodesicResult<3>&, int);

}  // namespace morphodesic::pipeline

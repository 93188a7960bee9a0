#include "pipeline/path_pictures.h"

#include <algorithm>
#include <cmath>
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

/// What a pixel sees: where, and how much of the pixel is covered.
template <int Dim>
struct Hit {
    Point<Dim> x{};
    double coverage = 0.0;
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
                rgba[c] = colour[c];
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
std::vector<ScalarField<Dim>> dissipation_of_frames(const GeodesicResult<Dim>& path) {
    std::vector<ScalarField<Dim>> rates;
    const std::size_t steps = path.deformations.size();
    for (const Deformation<Dim>& phi : path.deformations) {
        rates.push_back(dissipation_rate(phi, 1.0 / static_cast<double>(steps), path.options.lambda, path.options.mu));
    }
    if (steps == 0) return rates;
    const LevelSet<Dim>& end = path.shapes.back();
    ScalarField<Dim> carried(rates.back().grid);
    for (std::size_t i = 0; i < carried.values.size(); ++i) {
        if (end.values[i] < -4 * end.grid.spacing()) continue;  // too far outside for any picture
        const Point<Dim> y = carried.grid.position(carried.grid.node(i));
        carried.values[i] =
            value_at<Dim>(rates.back().grid, rates.back().values, inverse<Dim>(path.deformations.back(), y));
    }
    rates.push_back(std::move(carried));
    return rates;
}

template <int Dim>
double highest_rate(const GeodesicResult<Dim>& path, const std::vector<ScalarField<Dim>>& rates) {
    std::vector<double> inside;
    for (std::size_t k = 0; k + 1 < rates.size(); ++k) {
        for (std::size_t i = 0; i < rates[k].values.size(); ++i) {
            if (path.shapes[k].values[i] > 0) inside.push_back(rates[k].values[i]);
        }
    }
    return quantile(std::move(inside), 0.98);
}

template <>
RgbaImage shape_picture<2>(const LevelSet<2>& u, int pixels, const SolidView&) {
    return draw(u, pixels, [](const Hit<2>&) { return Colour{47, 62, 92}; });
}

template <>
PathPictures path_pictures<2>(const GeodesicResult<2>& path, int pixels, const SolidView&) {
    const std::vector<ScalarField<2>> rates = dissipation_of_frames(path);
    PathPictures pictures;
    pictures.highest = highest_rate(path, rates);
    const double unit = std::max(pictures.highest, 1e-300);
    for (std::size_t k = 0; k < rates.size(); ++k) {
        pictures.frames.push_back(draw(path.shapes[k], pixels, [&](const Hit<2>& hit) {
            return dissipation_colour(value_at<2>(rates[k].grid, rates[k].values, hit.x) / unit);
        }));
    }
    return pictures;
}

template ScalarField<2> dissipation_rate<2>(const Deformation<2>&, double, double, double);
template ScalarField<3> dissipation_rate<3>(const Deformation<3>&, double, double, double);
template std::vector<ScalarField<2>> dissipation_of_frames<2>(const GeodesicResult<2>&);
template std::vector<ScalarField<3>> dissipation_of_frames<3>(const GeodesicResult<3>&);
template double highest_rate<2>(const GeodesicResult<2>&, const std::vector<ScalarField<2>>&);
template double highest_rate<3>(const GeodesicResult<3>&, const std::vector<ScalarField<3>>&);

}  // namespace morphodesic::pipeline

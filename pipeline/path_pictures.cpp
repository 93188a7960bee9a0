#include "pipeline/path_pictures.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "geodesic/energy/stored_energy_density.h"
#include "geodesic/grid/q1_element.h"
#include "geodesic/solver/path_interpolation.h"
#include "pipeline/colour_map.h"

namespace morphodesic::pipeline {
namespace {

template <int Dim>
double value_at(const ScalarField<Dim>& field, const Point<Dim>& x) {
    return q1::value(field.grid, field.values.data(), x);
}

template <int Dim>
Point<Dim> gradient_at(const LevelSet<Dim>& u, const Point<Dim>& x) {
    const double h = 0.5 * u.grid.spacing();
    Point<Dim> g{};
    for (int a = 0; a < Dim; ++a) {
        Point<Dim> low = x, high = x;
        low[a] -= h;
        high[a] += h;
        g[a] = (value_at<Dim>(u, high) - value_at<Dim>(u, low)) / (2 * h);
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
    const double value = value_at<2>(u, hit.x);
    const double slope = std::max(norm<2>(gradient_at<2>(u, hit.x)), 0.25);
    hit.coverage = std::clamp(0.5 + value / (slope * pixel), 0.0, 1.0);
    if (hit.coverage <= 0) return std::nullopt;
    return hit;
}

/// Calls paint(hit) -> Colour for every pixel that sees the shape.
/// @param radius  half width of the picture
template <int Dim, class Paint>
RgbaImage draw(const LevelSet<Dim>& u, int pixels, double radius, const Paint& paint) {
    RgbaImage image(pixels, pixels);
    const double pixel = 2 * radius / pixels;
    for (int row = 0; row < pixels; ++row) {
        for (int column = 0; column < pixels; ++column) {
            const auto hit = look(u, (column + 0.5) * pixel - radius, radius - (row + 0.5) * pixel, pixel);
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
        std::array<double, Dim * Dim> gradient{};
        for (int b = 0; b < Dim; ++b) {
            auto low = node, high = node;
            low[b] = std::max(node[b] - 1, 0);
            high[b] = std::min(node[b] + 1, grid.cells_per_axis());
            const double width = (high[b] - low[b]) * grid.spacing() * tau;
            for (int a = 0; a < Dim; ++a) {
                const auto& d = phi.displacement.components[a];
                gradient[static_cast<std::size_t>(a * Dim + b)] = (d[grid.index(high)] - d[grid.index(low)]) / width;
            }
        }
        rate.values[i] = morphodesic::dissipation_rate<Dim>(gradient, lambda, mu);
    }
    return rate;
}

template <int Dim>
std::vector<ScalarField<Dim>> dissipation_of_steps(const GeodesicResult<Dim>& path) {
    std::vector<ScalarField<Dim>> rates;
    const double tau = 1.0 / static_cast<double>(std::max<std::size_t>(path.deformations.size(), 1));
    for (const Deformation<Dim>& phi : path.deformations) {
        rates.push_back(dissipation_rate(phi, tau, path.options.lambda / path.options.mu, 1.0));
    }
    return rates;
}

template <int Dim>
ScalarField<Dim> carried_rate(const GeodesicResult<Dim>& path, const std::vector<ScalarField<Dim>>& rates, double t,
                              const LevelSet<Dim>& shape) {
    const double steps = static_cast<double>(path.deformations.size());
    const auto step = static_cast<std::size_t>(std::clamp(std::ceil(t * steps) - 1, 0.0, steps - 1));
    const double share = t * steps - static_cast<double>(step);
    ScalarField<Dim> carried(shape.grid);
    for (std::size_t i = 0; i < carried.values.size(); ++i) {
        if (shape.values[i] < -4 * shape.grid.spacing()) continue;  // too far outside for any picture
        const Point<Dim> y = carried.grid.position(carried.grid.node(i));
        carried.values[i] = value_at<Dim>(rates[step], inverse_at(path.deformations[step], y, share));
    }
    return carried;
}

template <int Dim>
std::vector<ScalarField<Dim>> dissipation_of_frames(const GeodesicResult<Dim>& path) {
    std::vector<ScalarField<Dim>> rates = dissipation_of_steps(path);
    const std::size_t steps = rates.size();
    if (steps == 0) return rates;
    rates.push_back(carried_rate(path, rates, 1.0, path.shapes.back()));
    return rates;
}

template <int Dim>
double upper_end(std::span<const ScalarField<Dim>> fields, const std::vector<LevelSet<Dim>>& shapes, double share) {
    std::vector<double> inside;
    for (std::size_t k = 0; k < fields.size() && k < shapes.size(); ++k) {
        for (std::size_t i = 0; i < fields[k].values.size(); ++i) {
            if (shapes[k].values[i] > 0) inside.push_back(fields[k].values[i]);
        }
    }
    return quantile(std::move(inside), share);
}

template <int Dim>
double picture_reach(const LevelSet<Dim>& u, const SolidView& view, bool with_slice) {
    const datasets::ViewAxes axes = Dim == 3 ? datasets::axes_of(view.camera) : datasets::ViewAxes{};
    double reach = 0.0;
    for (std::size_t i = 0; i < u.values.size(); ++i) {
        if (u.values[i] <= 0.0) continue;
        const Point<Dim> x = u.grid.position(u.grid.node(i));
        double right = 0.0, up = 0.0;
        for (int a = 0; a < Dim; ++a) {
            const auto axis = static_cast<std::size_t>(a);
            const double offset = x[axis] - 0.5;
            right += axes.right[axis] * offset;
            up += axes.up[axis] * offset;
            if (Dim == 2) reach = std::max(reach, std::abs(offset));
        }
        if constexpr (Dim == 3) {
            const Point<3> turned = datasets::turned(view.camera.turn, {x[0] - 0.5, x[1] - 0.5, x[2] - 0.5});
            for (std::size_t a = 0; with_slice && a < 3; ++a) {
                if (static_cast<int>(a) != view.slice_axis) reach = std::max(reach, std::abs(turned[a]));
            }
        }
        reach = std::max({reach, std::abs(right), std::abs(up)});
    }
    return reach;
}

template <int Dim>
SolidView near_view(const SolidView& view, double reach) {
    SolidView result = view;
    result.camera.zoom = 1.0;
    const double radius = Dim == 2 ? picture_radius : datasets::view_radius(result.camera);
    result.camera.zoom = std::max(1.0, radius / (1.15 * std::max(reach, 0.02)));
    return result;
}

template <>
RgbaImage shape_picture<2>(const LevelSet<2>& u, int pixels, const SolidView& view) {
    return draw(u, pixels, picture_radius / view.camera.zoom, [](const Hit<2>&) { return Colour{47, 62, 92}; });
}

template <>
PathPictures path_pictures<2>(const GeodesicResult<2>& path, int pixels, const SolidView& view) {
    const std::vector<ScalarField<2>> rates = dissipation_of_frames(path);
    PathPictures pictures;
    pictures.highest = upper_end<2>(std::span(rates).first(path.deformations.size()), path.shapes);
    const double unit = std::max(pictures.highest, 1e-300);
    for (std::size_t k = 0; k < rates.size(); ++k) {
        pictures.frames.push_back(
            draw(path.shapes[k], pixels, picture_radius / view.camera.zoom,
                 [&](const Hit<2>& hit) { return dissipation_colour(value_at<2>(rates[k], hit.x) / unit); }));
    }
    return pictures;
}

template double picture_reach<2>(const LevelSet<2>&, const SolidView&, bool);
template double picture_reach<3>(const LevelSet<3>&, const SolidView&, bool);
template SolidView near_view<2>(const SolidView&, double);
template SolidView near_view<3>(const SolidView&, double);
template ScalarField<2> dissipation_rate<2>(const Deformation<2>&, double, double, double);
template ScalarField<3> dissipation_rate<3>(const Deformation<3>&, double, double, double);
template std::vector<ScalarField<2>> dissipation_of_frames<2>(const GeodesicResult<2>&);
template std::vector<ScalarField<3>> dissipation_of_frames<3>(const GeodesicResult<3>&);
template std::vector<ScalarField<2>> dissipation_of_steps<2>(const GeodesicResult<2>&);
template std::vector<ScalarField<3>> dissipation_of_steps<3>(const GeodesicResult<3>&);
template ScalarField<2> carried_rate<2>(const GeodesicResult<2>&, const std::vector<ScalarField<2>>&, double,
                                        const LevelSet<2>&);
template ScalarField<3> carried_rate<3>(const GeodesicResult<3>&, const std::vector<ScalarField<3>>&, double,
                                        const LevelSet<3>&);
template double upper_end<2>(std::span<const ScalarField<2>>, const std::vector<LevelSet<2>>&, double);
template double upper_end<3>(std::span<const ScalarField<3>>, const std::vector<LevelSet<3>>&, double);

}  // namespace morphodesic::pipeline

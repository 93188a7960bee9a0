#include "geodesic/energy/area_energy.h"

#include <cmath>
#include <numbers>

#include "geodesic/grid/q1_element.h"
#include "geodesic/kernels/quadrature.h"

namespace morphodesic {

template <int Dim>
double area_energy(const DyadicGrid<Dim>& grid, const double* u, double eps, double factor, double* gradient) {
    constexpr int corners = 1 << Dim;
    const auto offsets = q1::corner_offsets(grid);
    const double inverse_h = grid.cells_per_unit();
    constexpr auto& points = kernels::quadrature::points<Dim, kernels::Quadrature::many>;
    const double quadrature_weight = std::pow(grid.spacing(), Dim) / static_cast<double>(points.size());
    double values[points.size()][corners], slopes[points.size()][corners][Dim];
    for (std::size_t q = 0; q < points.size(); ++q) {
        const Point<Dim>& x = points[q];
        for (int c = 0; c < corners; ++c) {
            values[q][c] = q1::shape<Dim>(c, x);
            for (int a = 0; a < Dim; ++a) slopes[q][c][a] = q1::shape_slope<Dim>(c, x, a) * inverse_h;
        }
    }
    double sum = 0.0;
    q1::for_each_cell(grid, [&](std::size_t node) {
        for (std::size_t q = 0; q < points.size(); ++q) {
            double here = 0.0, slope[Dim] = {}, square = 1e-6;
            for (int c = 0; c < corners; ++c) {
                const double value = u[node + offsets[static_cast<std::size_t>(c)]];
                here += values[q][c] * value;
                for (int a = 0; a < Dim; ++a) slope[a] += slopes[q][c][a] * value;
            }
            for (int a = 0; a < Dim; ++a) square += slope[a] * slope[a];
            const double norm = std::sqrt(square), below = eps * eps + here * here;
            const double delta = eps / (std::numbers::pi * below);
            sum += quadrature_weight * delta * norm;
            if (gradient == nullptr) continue;
            // d/du of delta |grad u|: delta' |grad u| theta + delta grad u . grad theta / |grad u|.
            const double scale = factor * quadrature_weight;
            const double in_value = -scale * 2.0 * here / below * delta * norm, in_slope = scale * delta / norm;
            for (int c = 0; c < corners; ++c) {
                double part = in_value * values[q][c];
                for (int a = 0; a < Dim; ++a) part += in_slope * slope[a] * slopes[q][c][a];
                gradient[node + offsets[static_cast<std::size_t>(c)]] += part;
            }
        }
    });
    return sum;
}

template double area_energy<2>(const DyadicGrid<2>&, const double*, double, double, double*);
template double area_energy<3>(const DyadicGrid<3>&, const double*, double, double, double*);

}  // namespace morphodesic

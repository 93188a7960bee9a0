#include "geodesic/energy/end_stiffness.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "geodesic/energy/path_energy.h"
#include "geodesic/grid/node_loop.h"
#include "geodesic/grid/q1_element.h"

namespace morphodesic {

template <int Dim>
double end_deformation_energy(const Deformation<Dim>& phi, const LevelSet<Dim>& after, const GeodesicOptions& options) {
    const auto& grid = phi.grid();
    const auto& w = phi.displacement.components;
    LevelSet<Dim> pulled_back(grid);
    for_nodes(grid, [&](std::size_t i) {
        Point<Dim> y = grid.position(grid.node(i));
        for (std::size_t a = 0; a < Dim; ++a) y[a] = std::clamp(y[a] + w[a][i], 0.0, 1.0);
        pulled_back.values[i] = q1::value(grid, after.values.data(), y);
    });
    PathEnergy<Dim> energy(pulled_back, after, 1, options);
    std::vector<double> x;
    x.reserve(energy.layout().size());
    for (const auto& component : w) x.insert(x.end(), component.begin(), component.end());
    const PathTerms terms = energy.evaluate(x, {});
    return std::isfinite(terms.total) ? terms.deformation.front() : std::numeric_limits<double>::infinity();
}

template double end_deformation_energy<2>(const Deformation<2>&, const LevelSet<2>&, const GeodesicOptions&);
template double end_deformation_energy<3>(const Deformation<3>&, const LevelSet<3>&, const GeodesicOptions&);

}  // namespace morphodesic

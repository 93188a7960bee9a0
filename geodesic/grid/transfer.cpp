#include "geodesic/grid/transfer.h"

#include <cassert>
#include <stdexcept>

namespace morphodesic {

namespace {

/// Visits the pairs (coarse node, fine node, weight) of multilinear prolongation.
template <int Dim, class Visitor>
void for_each_weight(const DyadicGrid<Dim>& grid, Visitor&& visit) {
    const DyadicGrid<Dim> fine(grid.level() + 1);
    typename DyadicGrid<Dim>::Index i{};
    for (std::size_t f = 0; f < fine.node_count(); ++f) {
        for (int corner = 0; corner < (1 << Dim); ++corner) {
            typename DyadicGrid<Dim>::Index c{};
            double weight = 1.0;
            bool used = true;
            for (int a = 0; a < Dim; ++a) {
                const int up = (corner >> a) & 1;
                c[a] = i[a] / 2 + up;
                if (i[a] & 1) {
                    weight *= 0.5;
                } else if (up) {
                    used = false;
                }
            }
            if (used) visit(grid.index(c), f, weight);
        }
        for (int a = 0; a < Dim && ++i[a] == fine.nodes_per_axis(); ++a) i[a] = 0;
    }
}

}  // namespace

template <int Dim>
void prolong(const DyadicGrid<Dim>& grid, std::span<const double> coarse, std::span<double> fine) {
    assert(coarse.size() == grid.node_count() && fine.size() == DyadicGrid<Dim>(grid.level() + 1).node_count());
    for (double& v : fine) v = 0.0;
    for_each_weight(grid, [&](std::size_t c, std::size_t f, double weight) { fine[f] += weight * coarse[c]; });
}

template <int Dim>
void prolong_transposed(const DyadicGrid<Dim>& grid, std::span<const double> fine, std::span<double> coarse) {
    assert(coarse.size() == grid.node_count() && fine.size() == DyadicGrid<Dim>(grid.level() + 1).node_count());
    for (double& v : coarse) v = 0.0;
    for_each_weight(grid, [&](std::size_t c, std::size_t f, double weight) { coarse[c] += weight * fine[f]; });
}

template <int Dim>
ScalarField<Dim> restricted(const ScalarField<Dim>& field, int level) {
    if (level > field.grid.level()) throw std::invalid_argument("restricted: the field is coarser than the level");
    if (level == field.grid.level()) return field;
    ScalarField<Dim> coarse{DyadicGrid<Dim>(level)};
    const int factor = 1 << (field.grid.level() - level);
    typename DyadicGrid<Dim>::Index i{};
    for (double& value : coarse.values) {
        auto at = i;
        for (int& a : at) a *= factor;
        value = field.values[field.grid.index(at)];
        for (int a = 0; a < Dim && ++i[a] == coarse.grid.nodes_per_axis(); ++a) i[a] = 0;
    }
    return coarse;
}

template void prolong<2>(const DyadicGrid<2>&, std::span<const double>, std::span<double>);
template void prolong<3>(const DyadicGrid<3>&, std::span<const double>, std::span<double>);
template void prolong_transposed<2>(const DyadicGrid<2>&, std::span<const double>, std::span<double>);
template void prolong_transposed<3>(const DyadicGrid<3>&, std::span<const double>, std::span<double>);
template ScalarField<2> restricted<2>(const ScalarField<2>&, int);
template ScalarField<3> restricted<3>(const ScalarField<3>&, int);

}  // namespace morphodesic

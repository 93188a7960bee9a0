#include "geodesic/grid/transfer.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

namespace morphodesic {

template <int Dim, class Real>
void add_prolonged(const DyadicGrid<Dim>& grid, const Real* coarse, Real* fine) {
    const std::ptrdiff_t row = grid.nodes(0), rows = grid.nodes(1), fine_row = 2 * row - 1, fine_rows = 2 * rows - 1;
    std::vector<Real> line(static_cast<std::size_t>(row));
    for (int z = 0; z < (Dim == 3 ? 2 * grid.nodes(Dim - 1) - 1 : 1); ++z) {
        for (int y = 0; y < fine_rows; ++y) {
            // Mean of the coarse rows around this fine row: one, two or four of them.
            const Real* low = coarse + ((z / 2) * rows + y / 2) * row;
            const Real* high = (y & 1) ? low + row : low;
            const std::ptrdiff_t up = (z & 1) ? rows * row : 0;
            for (std::ptrdiff_t x = 0; x < row; ++x) {
                line[static_cast<std::size_t>(x)] = Real(0.25) * ((low[x] + high[x]) + (low[x + up] + high[x + up]));
            }
            Real* out = fine + (z * fine_rows + y) * fine_row;
            for (std::size_t x = 0; x + 1 < line.size(); ++x) {
                out[2 * x] += line[x];
                out[2 * x + 1] += Real(0.5) * (line[x] + line[x + 1]);
            }
            out[fine_row - 1] += line.back();
        }
    }
}

template <int Dim, class Real>
void restrict_residual(const DyadicGrid<Dim>& grid, const Real* fine, Real* coarse) {
    const std::ptrdiff_t row = grid.nodes(0), rows = grid.nodes(1), fine_row = 2 * row - 1, fine_rows = 2 * rows - 1;
    std::fill(coarse, coarse + grid.node_count(), Real(0));
    std::vector<Real> line(static_cast<std::size_t>(fine_row));
    const int reach = Dim == 3 ? 1 : 0;
    for (int z = Dim == 3 ? 1 : 0; z < (Dim == 3 ? grid.cells(Dim - 1) : 1); ++z) {
        for (int y = 1; y < rows - 1; ++y) {
            // Weighted sum of the fine rows around this coarse row, then along the row.
            std::fill(line.begin(), line.end(), Real(0));
            for (int dz = -reach; dz <= reach; ++dz) {
                for (int dy = -1; dy <= 1; ++dy) {
                    const Real weight = (dy == 0 ? Real(1) : Real(0.5)) * (dz == 0 ? Real(1) : Real(0.5));
                    const Real* from = fine + ((2 * z + dz) * fine_rows + 2 * y + dy) * fine_row;
                    for (std::ptrdiff_t x = 0; x < fine_row; ++x) line[static_cast<std::size_t>(x)] += weight * from[x];
                }
            }
            Real* out = coarse + (z * rows + y) * row;
            for (std::size_t x = 1; x + 1 < static_cast<std::size_t>(row); ++x) {
                out[x] = line[2 * x] + Real(0.5) * (line[2 * x - 1] + line[2 * x + 1]);
            }
        }
    }
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
        for (std::size_t a = 0; a < Dim && ++i[a] == coarse.grid.nodes_per_axis(); ++a) i[a] = 0;
    }
    return coarse;
}

#define MORPHODESIC_INSTANTIATE(Dim, Real)                                              \
    template void add_prolonged<Dim, Real>(const DyadicGrid<Dim>&, const Real*, Real*); \
    template void restrict_residual<Dim, Real>(const DyadicGrid<Dim>&, const Real*, Real*);
MORPHODESIC_INSTANTIATE(2, double)
MORPHODESIC_INSTANTIATE(3, double)
MORPHODESIC_INSTANTIATE(2, float)
MORPHODESIC_INSTANTIATE(3, float)
#undef MORPHODESIC_INSTANTIATE
template ScalarField<2> restricted<2>(const ScalarField<2>&, int);
template ScalarField<3> restricted<3>(const ScalarField<3>&, int);

}  // namespace morphodesic

#include "geodesic/solver/path_window.h"

#include <algorithm>
#include <cmath>

namespace morphodesic {

namespace {

// Room around the shapes: with less the energy rises, since the background near them cannot give way; see
// MEASUREMENTS.md.
template <int Dim>
constexpr double room = Dim == 2 ? 0.08 : 0.16;
// A box has whole vectors of cells on axis 0, and halves well: up to so many units of cells on each axis.
constexpr int units = 8;
// A larger share of the cube is not worth it.
constexpr double largest_share = 0.8;

}  // namespace

template <int Dim>
std::optional<PathWindow<Dim>> PathWindow<Dim>::around(const PathState<Dim>& path, const LevelSet<Dim>& first,
                                                       const LevelSet<Dim>& last) {
    const auto& cube = path.layout.grid;
    const int cells = cube.cells_per_axis(), steps = path.layout.time_steps;
    Index low, high;
    low.fill(cells);
    high.fill(0);
    for (int k = 0; k <= steps; ++k) {
        const double* u = shape_of(path, first, last, k);
        for (std::size_t row = 0; row < cube.node_count(); row += cube.stride(1)) {
            const double *begin = u + row, *end = begin + cube.nodes(0);
            const auto inside = [](double v) { return v > 0; };
            const double* from = std::find_if(begin, end, inside);
            if (from == end) continue;
            const double* to = end - 1;
            while (!inside(*to)) --to;
            Index at = cube.node(row);
            low[0] = std::min(low[0], static_cast<int>(from - begin));
            high[0] = std::max(high[0], static_cast<int>(to - begin));
            for (std::size_t a = 1; a < Dim; ++a) {
                low[a] = std::min(low[a], at[a]);
                high[a] = std::max(high[a], at[a]);
            }
        }
    }
    const int margin = static_cast<int>(std::ceil(room<Dim> * cells));
    double share = 1.0;
    Index size{};
    for (std::size_t a = 0; a < Dim; ++a) {
        const int unit = std::max(cells / units, a == 0 ? kernels::single_lanes : 1);
        const int needed = std::max(high[a] - low[a], 0) + 2 * margin;
        size[a] = std::min((needed + unit - 1) / unit * unit, cells);
        low[a] = std::clamp((low[a] + high[a] - size[a]) / 2, 0, cells - size[a]);
        share *= static_cast<double>(size[a]) / cells;
    }
    if (share > largest_share) return std::nullopt;
    return PathWindow(DyadicGrid<Dim>(cube.level(), size), low);
}

template <int Dim>
template <class Visitor>
void PathWindow<Dim>::for_rows_in(const DyadicGrid<Dim>& cube, const Visitor& visit) const {
    for (std::size_t row = 0; row < grid_.node_count(); row += grid_.stride(1)) {
        Index at = grid_.node(row);
        for (std::size_t a = 0; a < Dim; ++a) at[a] += low_[a];
        visit(static_cast<std::ptrdiff_t>(cube.index(at)), static_cast<std::ptrdiff_t>(row));
    }
}

template <int Dim>
ScalarField<Dim> PathWindow<Dim>::cut_out(const ScalarField<Dim>& field) const {
    ScalarField<Dim> part(grid_);
    for_rows_in(field.grid, [&](std::ptrdiff_t from, std::ptrdiff_t to) {
        std::copy_n(field.values.begin() + from, grid_.nodes(0), part.values.begin() + to);
    });
    return part;
}

template <int Dim>
PathState<Dim> PathWindow<Dim>::cut_out(const PathState<Dim>& path) const {
    PathState<Dim> part{{grid_, path.layout.time_steps}, {}};
    part.x.resize(part.layout.size());
    for (std::size_t f = 0; f < static_cast<std::size_t>(path.layout.field_count()); ++f) {
        const double* source = path.x.data() + f * path.layout.nodes();
        double* target = part.x.data() + f * part.layout.nodes();
        for_rows_in(path.layout.grid, [&](std::ptrdiff_t from, std::ptrdiff_t to) {
            std::copy_n(source + from, grid_.nodes(0), target + to);
        });
    }
    return part;
}

template <int Dim>
void PathWindow<Dim>::put_back(const PathState<Dim>& part, PathState<Dim>& path) const {
    for (std::size_t f = 0; f < static_cast<std::size_t>(path.layout.field_count()); ++f) {
        const double* source = part.x.data() + f * part.layout.nodes();
        double* target = path.x.data() + f * path.layout.nodes();
        for_rows_in(path.layout.grid, [&](std::ptrdiff_t to, std::ptrdiff_t from) {
            std::copy_n(source + from, grid_.nodes(0), target + to);
        });
    }
}

template class PathWindow<2>;
template class PathWindow<3>;

}  // namespace morphodesic

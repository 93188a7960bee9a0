#include "geodesic/solver/path_window.h"

#include <algorithm>
#include <cmath>

namespace morphodesic {

namespace {

// Room around the shapes: with less the energy rises, since the background near them cannot give way. Where cells are
// small so many of them are enough, as the coarser levels have moved what is farther away; see MEASUREMENTS.md.
template <int Dim>
constexpr double room = Dim == 2 ? 0.08 : 0.16;
template <int Dim>
constexpr int room_cells = Dim == 2 ? 6 : 11;

/// Sides of the window around a box with these sides, all in cells. It has whole vectors of cells on axis 0, and halves
/// well.
template <int Dim>
std::array<int, Dim> padded(int cells, const std::array<int, Dim>& sides) {
    const int margin = std::min(static_cast<int>(std::ceil(room<Dim> * cells)), room_cells<Dim>);
    const int unit = std::max(cells / 16, std::min(cells / 8, 8));
    std::array<int, Dim> result;
    for (std::size_t a = 0; a < Dim; ++a) {
        const int multiple = std::max(unit, a == 0 ? kernels::single_lanes : 1);
        result[a] = std::min((sides[a] + 2 * margin + multiple - 1) / multiple * multiple, cells);
    }
    return result;
}

// A larger share of the cube is not worth it.
constexpr double largest_share = 0.8;

/// Share of the cube in a box with these sides, in cells; 1 where that is not worth it.
template <int Dim>
double share_of(int cells, const std::array<int, Dim>& sides) {
    double share = 1.0;
    for (const int side : sides) share *= static_cast<double>(side) / cells;
    return share > largest_share ? 1.0 : share;
}

}  // namespace

template <int Dim>
double window_share(int level, const std::array<double, Dim>& sides) {
    const int cells = 1 << level;
    std::array<int, Dim> needed;
    for (std::size_t a = 0; a < Dim; ++a) needed[a] = static_cast<int>(std::ceil(sides[a] * cells));
    return share_of<Dim>(cells, padded<Dim>(cells, needed));
}

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
    Index size;
    for (std::size_t a = 0; a < Dim; ++a) size[a] = std::max(high[a] - low[a], 0);
    size = padded<Dim>(cells, size);
    if (share_of<Dim>(cells, size) == 1.0) return std::nullopt;
    for (std::size_t a = 0; a < Dim; ++a) {
        low[a] = std::clamp((low[a] + high[a] - size[a]) / 2, 0, cells - size[a]);
    }
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

template double window_share<2>(int, const std::array<double, 2>&);
template double window_share<3>(int, const std::array<double, 3>&);
template class PathWindow<2>;
template class PathWindow<3>;

}  // namespace morphodesic

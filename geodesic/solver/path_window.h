#pragma once

#include <array>
#include <optional>

#include "geodesic/solver/cascade.h"

namespace morphodesic {

/// Share of the cube in the window around shapes that lie in a box with these sides; 1 where no window is taken.
/// @param level  one on which paths are minimised in windows, from 5 on
/// @param sides  in units of the cube
template <int Dim>
[[nodiscard]] double window_share(int level, const std::array<double, Dim>& sides);

/// Box of cells around all shapes of a path, with room for the background between them and its faces. A path is
/// minimised there while what is outside stays as the level before left it: far from the shapes the background is soft
/// and its motion smooth.
template <int Dim>
class PathWindow {
public:
    /// @return nothing where the box would save little
    static std::optional<PathWindow> around(const PathState<Dim>& path, const LevelSet<Dim>& first,
                                            const LevelSet<Dim>& last);

    /// The part of the cube, with coordinates counted from the corner of the box.
    [[nodiscard]] const DyadicGrid<Dim>& grid() const { return grid_; }

    [[nodiscard]] ScalarField<Dim> cut_out(const ScalarField<Dim>& field) const;
    [[nodiscard]] PathState<Dim> cut_out(const PathState<Dim>& path) const;
    /// Writes the part back into the path it was cut out of.
    void put_back(const PathState<Dim>& part, PathState<Dim>& path) const;

private:
    using Index = typename DyadicGrid<Dim>::Index;
    PathWindow(const DyadicGrid<Dim>& grid, const Index& low) : grid_(grid), low_(low) {}

    /// visit(index of the first node of a row in the cube, the same in the box)
    template <class Visitor>
    void for_rows_in(const DyadicGrid<Dim>& cube, const Visitor& visit) const;

    DyadicGrid<Dim> grid_;
    Index low_;  // of its corner in the cube
};

}  // namespace morphodesic

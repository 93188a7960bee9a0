#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "datasets/shape_source.h"
#include "geodesic/grid/fields.h"

namespace morphodesic::datasets {

/// x in units of the cube = scale * (x in file units) + offset, scale > 0.
template <int Dim>
struct Placement {
    double scale = 1.0;
    Point<Dim> offset{};

    [[nodiscard]] Point<Dim> operator()(const Point<Dim>& x) const {
        Point<Dim> y{};
        for (int a = 0; a < Dim; ++a) y[a] = scale * x[a] + offset[a];
        return y;
    }
};

/// The object of a file in file units (pixels with y up, millimetres, ...); every reader has its own kind.
template <int Dim>
class Geometry {
public:
    virtual ~Geometry() = default;

    /// Signed distance to the placed object at the nodes of the grid, > 0 inside, in units of the cube [N].
    [[nodiscard]] virtual LevelSet<Dim> signed_distance(const DyadicGrid<Dim>& grid,
                                                        const Placement<Dim>& placement) const = 0;

    /// chi in [0,1] at the nodes, 0 where the placed object is unknown; empty values if it is known everywhere.
    [[nodiscard]] virtual ScalarField<Dim> occlusion_mask(const DyadicGrid<Dim>& grid,
                                                          const Placement<Dim>& placement) const {
        (void)grid, (void)placement;
        return {};
    }
};

/// A file that has been read but not yet been given its place and size in the unit cube.
template <int Dim>
struct RawShape {
    ShapeSource source;
    std::shared_ptr<const Geometry<Dim>> geometry;
    Point<Dim> centroid{};       ///< of the object, file units
    double volume = 0.0;         ///< area (volume) of the object, file units^Dim, > 0
    double extent_radius = 0.0;  ///< largest distance of the object from its centroid, file units, > 0
    int components = 0;          ///< parts that the object has; 0: not counted
    int holes = -1;              ///< holes in them (2D); -1: not counted
    Point<Dim> frame_low{};      ///< corner of what --normalize none maps to the unit cube: the image; of solids a cube
                                 ///< of side 1, larger only if they do not fit into that
    Point<Dim> frame_high{};     ///< the opposite corner
    std::size_t bytes = 0;       ///< memory of a solid's geometry; 0: not counted
    std::vector<std::string> notes;  ///< what was done to the input and a user should know, one sentence each
};

}  // namespace morphodesic::datasets

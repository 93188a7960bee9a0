#pragma once

#include "datasets/outline.h"
#include "datasets/raw_shape.h"

namespace morphodesic::datasets {

/// Where an image is hidden, in the pixel units of its outline. Empty pixels: nothing is hidden.
struct HiddenPixels {
    Coverage pixels;  ///< 1 = hidden; continued beyond the image by its border
    /// All that lies beyond this side of the image is hidden as well.
    bool left = false, right = false, bottom = false, top = false;
};

/// A plane object given by its outline; distances are exact.
class OutlineGeometry final : public Geometry<2> {
public:
    explicit OutlineGeometry(Outline outline, HiddenPixels hidden = {})
        : outline_(std::move(outline)), hidden_(std::move(hidden)) {}

    [[nodiscard]] const Outline& outline() const { return outline_; }

    /// Cost: about N log(vertices); every node searches a tree of boxes around the segments, starting with the bound
    /// that its neighbour gives.
    [[nodiscard]] LevelSet<2> signed_distance(const DyadicGrid<2>& grid, const Placement<2>& placement) const override;

    /// chi = 1 - the share of the cell around the node that is hidden.
    [[nodiscard]] ScalarField<2> occlusion_mask(const DyadicGrid<2>& grid,
                                                const Placement<2>& placement) const override;

private:
    Outline outline_;
    HiddenPixels hidden_;
};

/// Signed distance to an outline in units of the cube at the nodes of a grid, > 0 inside [N].
LevelSet<2> signed_distance(const Outline& outline, const DyadicGrid<2>& grid, const Placement<2>& placement = {});

/// An outline as a raw shape, e.g. one that a formula made.
RawShape<2> raw_shape_of(const ShapeSource& source, Outline outline, HiddenPixels hidden = {});

}  // namespace morphodesic::datasets

#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "datasets/image_pixels.h"
#include "geodesic/grid/fields.h"

namespace morphodesic::datasets {

/// Rotation matrix, row-major.
using Rotation = std::array<double, 9>;
inline constexpr Rotation unturned{1, 0, 0, 0, 1, 0, 0, 0, 1};

/// Where a solid is looked at from: degrees around the vertical axis and above the horizon.
struct View {
    int width = 320, height = 320;  ///< pixels, 16 to 4096
    double azimuth = 35.0, elevation = 20.0;
    int up_axis = 2;           ///< axis of the cube that points up in the picture: 0, 1 or 2
    double zoom = 1.0;         ///< 1: the ball of the largest normalised shape fills the picture
    Rotation turn = unturned;  ///< how the solid is turned about the middle of the cube before it is looked at
};

/// Directions of a view in the cube of the solid as it is stored, unit vectors: to the right and up in the picture, and
/// towards the viewer.
struct ViewAxes {
    std::array<double, 3> right{}, up{}, from{};
};
ViewAxes axes_of(const View& view);

/// Colours for values.
struct ColourRange {
    double low = 0.0, high = 1.0;
    /// Red, green and blue in [0,1] for 0 (low) to 1 (high); empty: blue-violet over green to yellow (viridis).
    std::function<std::array<double, 3>(double)> map = {};
};

/// The axis of a collection that points up, by the custom of its file formats: y for OBJ and OFF, z for the others.
/// @param files  names; the majority decides
int up_axis_by_custom(const std::vector<std::string>& files);

/// A viewpoint for a whole collection: 25 degrees off the side on which the solids, taken together, are widest.
class CommonView {
public:
    explicit CommonView(int up_axis) : up_axis_(up_axis) {}
    /// @param turn  how the solid is turned about the middle of the cube first
    void add(const LevelSet<3>& shape, const Rotation& turn = unturned);
    [[nodiscard]] View view() const;
    /// Degrees around the vertical axis to the direction in which the solids are longest, modulo 180; none if round.
    [[nodiscard]] std::optional<double> longest() const;
    /// Horizontal axis along which the solids are thinnest: across it slices show most.
    [[nodiscard]] int slice_axis() const;

private:
    int up_axis_;
    double moments_[3]{};  ///< of the horizontal axes a = up + 1, b = up + 2 (modulo 3): aa, bb, ab
};

/// Shaded view of a solid from outside, by OpenVDB's ray tracer for level sets: red, green, blue, alpha of 8 bits; the
/// background is transparent. No graphics card or display is needed.
/// @param colour  scalar field on any grid, e.g. dissipation; nullptr: one colour
PixelImage shaded_view(const LevelSet<3>& shape, const View& view = {}, const ScalarField<3>* colour = nullptr,
                       const ColourRange& range = {});

/// Where to cut solids across an axis so that the cuts are large: the place in [0,1] with the largest area of all cuts
/// together, the one nearest to the middle of those that have nearly as much.
/// @param turn  how the solids are turned about the middle of the cube first
double slice_position(std::span<const LevelSet<3>> shapes, int across, const Rotation& turn = unturned);

/// Plane through a solid: level lines of u as stripes (their width is the distance between lines: 0.04, or less if
/// less of the cube is shown), the object in colour, the background grey, its contour black.
/// @param across    axis perpendicular to the plane
/// @param position  of the plane, in [0,1]
/// @param up_axis   axis that points up in the picture, not `across`; -1: the higher one of the other two
/// @param radius    half width of what is shown, around the middle of the cube
/// @param turn      how the solid is turned about the middle of the cube first
PixelImage slice_picture(const LevelSet<3>& shape, int across, double position, int pixels = 320,
                         const ScalarField<3>* colour = nullptr, const ColourRange& range = {}, int up_axis = -1,
                         double radius = 0.5, const Rotation& turn = unturned);

/// A direction of the solid as it is stored, after turning: R d.
std::array<double, 3> turned(const Rotation& turn, const std::array<double, 3>& direction);
/// A direction of the turned solid in the cube of the solid as it is stored: R^T d.
std::array<double, 3> turned_back(const Rotation& turn, const std::array<double, 3>& direction);

/// The view's picture shows so much around the middle of the cube, half width.
double view_radius(const View& view);

/// Largest value of a field where the shape is (u > 0): a range for colours common to several pictures.
ColourRange colour_range(const LevelSet<3>& shape, const ScalarField<3>& field);

}  // namespace morphodesic::datasets

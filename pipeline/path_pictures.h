#pragma once

#include <span>
#include <vector>

#include "datasets/solid_pictures.h"
#include "geodesic/discrete_geodesic.h"
#include "pipeline/png.h"

namespace morphodesic::pipeline {

/// Half width of the part of the unit cube that pictures show, around its centre: shapes reach 0.36 from it.
inline constexpr double picture_radius = 0.4;

/// How the solids of a study are looked at; of plane shapes only the zoom of the camera counts (1: picture_radius).
struct SolidView {
    datasets::View camera;
    int slice_axis = 1;  ///< slices are perpendicular to it, where they are large
};

/// Half width of the smallest picture around the middle of the cube that shows the whole shape.
/// @param with_slice  the slices of solids, too
template <int Dim>
[[nodiscard]] double picture_reach(const LevelSet<Dim>& u, const SolidView& view = {}, bool with_slice = false);
/// The view so near that shapes of this reach fill the picture but for a margin; never farther than with zoom 1.
template <int Dim>
[[nodiscard]] SolidView near_view(const SolidView& view, double reach);

/// A shape in one colour on a transparent background, anti-aliased; solids are shaded.
template <int Dim>
[[nodiscard]] RgbaImage shape_picture(const LevelSet<Dim>& u, int pixels, const SolidView& view = {});
template <>
RgbaImage shape_picture<2>(const LevelSet<2>& u, int pixels, const SolidView& view);
template <>
RgbaImage shape_picture<3>(const LevelSet<3>& u, int pixels, const SolidView& view);

/// Frames 0 .. K of a path. Frame k < K is coloured by the dissipation of the step that starts there, frame K by that
/// of the step that ends there.
struct PathPictures {
    std::vector<RgbaImage> frames;
    double highest = 0.0;  ///< value of the last colour: 98 % of the object have less; the first colour is 0
};

/// Colours show the viscous dissipation rate density (1) of [WBRS09], lambda/2 (tr eps)^2 + mu tr eps^2, of the
/// velocity v = (phi_k - id) / tau, in units of mu / time^2 (the path takes the time 1).
/// Frames of solids have two parts: the shaded view, and below it a slice with stripes of the level set.
template <int Dim>
[[nodiscard]] PathPictures path_pictures(const GeodesicResult<Dim>& path, int pixels, const SolidView& view = {});
template <>
PathPictures path_pictures<2>(const GeodesicResult<2>& path, int pixels, const SolidView& view);
template <>
PathPictures path_pictures<3>(const GeodesicResult<3>& path, int pixels, const SolidView& view);

/// Nodal values of that density for one step, eps by central differences of the displacement.
/// @param lambda, mu  of the dissipation; for values in units of mu: lambda / mu and 1
template <int Dim>
[[nodiscard]] ScalarField<Dim> dissipation_rate(const Deformation<Dim>& phi, double tau, double lambda, double mu);

/// That density of every step in units of mu; field k - 1 lives on shape k - 1.
template <int Dim>
[[nodiscard]] std::vector<ScalarField<Dim>> dissipation_of_steps(const GeodesicResult<Dim>& path);

/// That density for the frames 0 .. K: of the step that starts there; at the last frame that of the last step, carried
/// along by it.
template <int Dim>
[[nodiscard]] std::vector<ScalarField<Dim>> dissipation_of_frames(const GeodesicResult<Dim>& path);

/// The rate of the step in which the time t in [0, 1] lies, carried along to t: where the shape of that time is, and
/// near.
/// @param rates  dissipation_of_steps(path)
template <int Dim>
[[nodiscard]] ScalarField<Dim> carried_rate(const GeodesicResult<Dim>& path, const std::vector<ScalarField<Dim>>& rates,
                                            double t, const LevelSet<Dim>& shape);

/// Value below which the given share of the fields' nodes inside the shapes lies: the end of a colour scale. Field k
/// belongs to shape k; shapes beyond the last field do not count.
template <int Dim>
[[nodiscard]] double upper_end(std::span<const ScalarField<Dim>> fields, const std::vector<LevelSet<Dim>>& shapes,
                               double share = 0.98);

}  // namespace morphodesic::pipeline

#pragma once

#include <span>
#include <string>
#include <vector>

#include "datasets/raw_shape.h"
#include "datasets/shape.h"

namespace morphodesic::datasets {

/// No normalised shape reaches farther than this from the centre of the cube. Deformations are the identity on the
/// boundary of the cube, so a shape needs free space around it to move; and a shape within a ball keeps that space
/// whatever way alignment turns it.
inline constexpr double largest_extent_radius = 0.36;

/// Area (volume) of a shape that --normalize each has scaled, in units of the cube, unless it would then not fit.
template <int Dim>
inline constexpr double unit_volume = Dim == 2 ? 0.1 : 0.03;

struct NormalizeOptions {
    std::string mode = "common";  ///< common | each | none
    double scale =
        0.0;        ///< for common: cube units per file unit, see common_scale; 0: the shape is scaled to fit alone
    int level = 6;  ///< grid with 2^level + 1 nodes per axis, 1 <= level <= 10
    int solved_level = 0;  ///< level on which the shape will be looked at, which notes are about; 0: level

    [[nodiscard]] std::vector<std::string> problems() const;  ///< every violated constraint; empty if usable
};

/// The one scale of a collection, such that its largest shape just fits.
/// @param extent_radii  RawShape::extent_radius of every shape, file units, > 0; not empty
double common_scale(std::span<const double> extent_radii);

/// Where a shape goes in the cube: the centroid (mode none: the middle of the frame) to the centre, and its scale.
/// Mode none maps the frame of an image to the square; solids keep their size.
/// @param notes  if not null, receives a sentence where the mode's size had to be given up
/// @throws ReadError in mode none if a solid is larger than the cube
template <int Dim>
Placement<Dim> placement_of(const RawShape<Dim>& raw, const NormalizeOptions& options,
                            std::vector<std::string>* notes = nullptr);

/// The shape in its place, as a signed distance at the nodes of the grid, with its content digest.
/// @throws std::invalid_argument if the options have problems
/// @throws ReadError if nothing of the shape is left on the grid (thinner than a cell everywhere)
template <int Dim>
Shape<Dim> normalize(const RawShape<Dim>& raw, const NormalizeOptions& options);

}  // namespace morphodesic::datasets

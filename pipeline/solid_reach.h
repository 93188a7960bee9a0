#pragma once

#include <array>
#include <span>

#include "geodesic/grid/fields.h"

namespace morphodesic::pipeline {

/// How far a solid reaches from its centroid, in units of the cube: from this follows how much of the cube the windows
/// (PathWindow) of its pairs take, before any pair is aligned.
struct SolidReach {
    std::array<double, 3> low{}, high{};  ///< along the axes of its own frame; low is negative
    double radius = 0.0;                  ///< in any direction

    /// A principal axis that cannot be taken for another one: alignments lay it on that of a shape that has one, too.
    struct Axis {
        bool clear = false;
        std::array<double, 3> direction{};
        double along = 0.0, across = 0.0;  ///< of the cylinder about the axis that holds the solid, half the length
    };
    Axis longest, shortest;
    double between = 0.0;  ///< along the third axis

    [[nodiscard]] SolidReach scaled(double factor) const;
};

/// @param u  signed distance; read on level 5 if it is finer, and a cell of that larger than it is
[[nodiscard]] SolidReach reach_of(const LevelSet<3>& u);

/// Of a solid of which only the radius is known.
[[nodiscard]] SolidReach reach_of_ball(double radius);

/// Largest share of the cube that the window of a pair takes: `moved` is aligned with `fixed`.
/// @param rigid  turned and moved; else neither
[[nodiscard]] double window_share(const SolidReach& moved, const SolidReach& fixed, int level, bool rigid);

/// The largest of all pairs, either way round; 1 without pairs.
[[nodiscard]] double largest_window_share(std::span<const SolidReach> reaches, int level, bool rigid);

}  // namespace morphodesic::pipeline

#pragma once

#include <array>
#include <vector>

#include "datasets/solid_pictures.h"
#include "pipeline/study_data.h"

namespace morphodesic::pipeline {

/// How the solid `first` has to be turned to lie as `second`, and how far they are from each other.
struct PairTurn {
    std::size_t first, second;
    double distance;
    datasets::Rotation turn;
};

/// The solids of a collection in common frames.
struct CommonFrames {
    std::vector<datasets::Rotation> turns;  ///< of every solid into the frame of its group
    std::vector<std::size_t> groups;        ///< of every solid, 0, 1, ... by first appearance
};

/// Rotations of n solids into one frame, that of as many files as possible: files of other axis orders are turned.
/// Solids are joined nearest first (as in single linkage). All known pairs between two groups say how these lie to each
/// other; where most of them do not agree (solids too unlike, or round), nothing is known and the groups stay apart.
/// What lies within 30 degrees of its group's frame is not turned.
/// @param labels  classes, one per solid: different classes stay apart; "" joins any
CommonFrames common_frames(const std::vector<std::string>& labels, std::vector<PairTurn> pairs);

/// The turns that the alignments of a study's geodesics found; files of equal content lie equally.
std::vector<PairTurn> pair_turns(const StudyData& data);

/// Angle of a rotation in degrees, 0 to 180.
double turn_angle(const datasets::Rotation& rotation);

/// a after b.
datasets::Rotation product(const datasets::Rotation& a, const datasets::Rotation& b);

}  // namespace morphodesic::pipeline

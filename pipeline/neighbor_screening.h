#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "geodesic/solver/geodesic_options.h"

namespace morphodesic::pipeline {

/// Settings from coarse to fine on which a study with --neighbors solves pairs; the last ones are those of the study.
/// One entry alone (every pair is solved finely) if the study itself is as coarse as the first round, or if the
/// number of neighbours is 0.
[[nodiscard]] std::vector<GeodesicOptions> screening_levels(const GeodesicOptions& options, int neighbors);

/// What the distance of a pair is on one level; NaN if the pair has no trustworthy distance there.
struct PairMeasurement {
    double distance = 0.0;
    double error = 0.0;
};

/// State of a screening, a pure function of what is measured: whoever has the same measurements asks for the same
/// pairs, in whatever order and on whatever machine they were made.
///
/// Level by level, from coarse to fine, among the pairs that were measured on the level before:
///  1. the k nearest of every shape, and one pair more of every shape (a ring through all shapes, for a fair view
///     on pairs that are not near) are measured on the next level; pairs without a distance are always among them;
///  2. from these follow the factor (median, of the ring) and the least factor (2 % quantile) from a coarse to a fine distance;
///     together they are the error bar of a coarse distance;
///  3. every pair whose coarse distance times the least factor is not beyond the k-th nearest fine one of either shape
///     is measured too: it can be among the k nearest. The k-th nearest only come nearer by that, so nothing is left.
/// All other pairs keep their coarse distance times the factor, but not less than the k-th nearest of both shapes, so
/// that nobody takes them for neighbours. Their bar is the spread of the factors, or that of the solver if larger.
struct Screening {
    struct Pair {
        double distance = 0.0;  ///< in terms of the finest level; NaN: no trustworthy one
        double error = 0.0;
        std::size_t level = 0;  ///< the finest that the pair was asked for on
    };
    std::size_t level = 0;                                     ///< of the pairs to measure next
    std::vector<std::pair<std::size_t, std::size_t>> missing;  ///< pairs i < j to measure next; empty: complete
    long asked = 0;                                            ///< pairs of this round, measured or not
    std::vector<Pair> pairs;  ///< condensed, in SciPy's order; those of finer levels only if the screening is complete
    std::vector<long> measured;  ///< per level: how many pairs are there, if complete
};

/// @param shapes     n; their order must be as good as random with regard to their form (content digests are)
/// @param neighbors  k >= 1
/// @param levels     >= 1
/// @param measured   the measurement of a pair i < j on a level; nothing if it has not been made
using Measured = std::function<std::optional<PairMeasurement>(std::size_t level, std::size_t i, std::size_t j)>;
[[nodiscard]] Screening screen_pairs(std::size_t shapes, int neighbors, std::size_t levels, const Measured& measured);

}  // namespace morphodesic::pipeline

#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "pipeline/neighbor_screening.h"
#include "pipeline/result_store.h"
#include "pipeline/run_settings.h"
#include "pipeline/wanted_pairs.h"

namespace morphodesic::pipeline {

/// The distance of a pair from the geodesics that make it.
struct PairDistance {
    bool complete = true;   ///< all of them are computed
    std::string problem;    ///< why one of them must not be used; empty if all may
    double distance = 0.0;  ///< mean path length, if complete and without problem
    double error = 0.0;     ///< mean bar, at least half the difference of two directions
};
using GeodesicRows = std::map<GeodesicKey, StoredGeodesic>;
[[nodiscard]] PairDistance distance_of_pair(const GeodesicRows& rows, const std::vector<GeodesicKey>& keys);

/// All sound rows of these settings by key. @param on_damage  see ResultStore::geodesics
[[nodiscard]] GeodesicRows rows_of(const ResultStore& store, const GeodesicOptions& options,
                                   const ResultStore::OnDamage& on_damage = {});

/// The usable shapes of a study.
[[nodiscard]] DifferentShapes different_shapes(const ResultStore& store);

/// A study computes its pairs in rounds: one round of all pairs, or, with PairSelection::neighbors, those of a
/// screening.
struct StudyRounds {
    std::vector<GeodesicOptions> levels;  ///< from coarse to fine; the last one is that of the study
    std::vector<GeodesicRows> rows;       ///< per level
    DifferentShapes shapes;
    Screening screening;  ///< of the shapes in order; only if there is more than one level

    [[nodiscard]] bool screened() const { return levels.size() > 1; }
    /// The geodesics to compute next on levels[screening.level]; both directions where the study wants both.
    [[nodiscard]] std::set<GeodesicKey> missing(bool both_directions) const;
    /// How many geodesics a complete screening asked for on all levels but the coarsest.
    [[nodiscard]] long geodesics_of_finer_levels(bool both_directions) const;
};
[[nodiscard]] StudyRounds rounds_of(const ResultStore& store, const RunSettings& settings,
                                    const ResultStore::OnDamage& on_damage = {});

}  // namespace morphodesic::pipeline

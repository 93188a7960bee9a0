#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "analysis/diagnostics.h"
#include "analysis/distance_matrix.h"
#include "pipeline/result_store.h"
#include "pipeline/run_settings.h"

namespace morphodesic::pipeline {

/// Something that could not be used or computed: a file, or a pair of files.
struct StudyFailure {
    std::string a, b;  ///< b is empty for a file
    std::string reason;
    bool cut_off = false;  ///< nothing is wrong with the file, but no chain of distances joins it to the others
};

/// Of a large study few pairs have one at first, or ever: those without take no room.
using Geodesics = std::vector<std::shared_ptr<const StoredGeodesic>>;

/// The rows of a store that belong to one set of settings, by the names of the files.
struct StudyData {
    int dimension = 2;
    RunSettings settings;
    std::string common_scale;  ///< cube units per unit of the files; empty: not one for all
    std::string settings_hash;
    std::vector<StoredShape> shapes;  ///< usable files, sorted by name
    std::vector<StoredShape> unusable;
    /// Path lengths with error bars, the mean where both directions are computed; of pairs that a screening left coarse
    /// an estimate of it (see Screening); missing where no distance is trustworthy.
    analysis::DistanceMatrix distances;
    /// Condensed as the matrix; none for files of equal content (distance 0) and for pairs that are not computed yet;
    /// empty for a given table.
    Geodesics pairs, backward;  ///< and the other way round: empty unless both are computed
    /// Settings from coarse to fine; more than one if the study screens its pairs (PairSelection::neighbors).
    std::vector<GeodesicOptions> levels;
    std::vector<unsigned char> level_of;  ///< condensed: the level that `pairs`, `backward` and the distance are of
    long pairs_coarse = 0;                ///< distances that are estimates from coarse levels
    std::string coarse_note;              ///< says so, if there are any
    std::vector<bool> first_is_a;         ///< condensed: the path of `pairs` runs from the first to the second name
    std::vector<StudyFailure> failures;
    std::string unfinished;  ///< a sentence if shapes are missing, see unfinished_reading; else empty
    std::map<std::size_t, StudyFailure>
        damaged;                       ///< condensed index: pairs with a damaged result; they are missing, too
    long pairs_missing = 0;            ///< not computed yet; of a screening: of its present round
    std::vector<std::string> remarks;  ///< what a user should know of the shapes or the table, one sentence each
    bool given = false;                ///< a table of distances: shapes have names and classes only, pairs no geodesics
    std::vector<analysis::DirectedPair> given_directions;  ///< of a table that is not symmetric

    /// The geodesic of a pair, and the one the other way round; nullptr if there is none.
    [[nodiscard]] const StoredGeodesic* geodesic(std::size_t pair) const { return entry(pairs, pair); }
    [[nodiscard]] const StoredGeodesic* backward_geodesic(std::size_t pair) const { return entry(backward, pair); }
    /// Solved with the settings of the study; else the distance is an estimate from coarse levels.
    [[nodiscard]] bool refined(std::size_t pair) const { return level_of[pair] + std::size_t{1} == levels.size(); }
    /// The settings that the geodesics of a pair were computed with.
    [[nodiscard]] const GeodesicOptions& geodesic_of(std::size_t pair) const { return levels[level_of[pair]]; }
    [[nodiscard]] std::size_t index(std::size_t i, std::size_t j) const { return distances.index(i, j); }

private:
    static const StoredGeodesic* entry(const Geodesics& from, std::size_t pair) {
        return pair < from.size() ? from[pair].get() : nullptr;
    }
};

/// @throws std::invalid_argument if nothing was ingested, StoreError
[[nodiscard]] StudyData load_study(const ResultStore& store);

}  // namespace morphodesic::pipeline

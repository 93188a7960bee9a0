#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "geodesic/discrete_geodesic.h"
#include "pipeline/collection.h"
#include "pipeline/progress.h"
#include "pipeline/result_store.h"
#include "pipeline/wanted_pairs.h"

namespace morphodesic::pipeline {

struct PairGraphOptions {
    GeodesicOptions geodesic;
    bool solve = true;  ///< false: take the shapes in, compute nothing
    bool both_directions = false;
    std::optional<std::set<GeodesicKey>> only;       ///< of all geodesics these, if given
    int threads = 1;                                 ///< >= 1; the results do not depend on it
    int pairs_in_flight = 1;                         ///< >= 1: pairs in memory at once
    std::size_t shape_bytes = std::size_t{1} << 30;  ///< shapes beyond this are read from the store when needed
    std::function<bool()> stop;                      ///< true: drop the pairs in flight and end; may be empty
    /// Called before the store is changed, which is when the first usable shape is there; may be empty.
    std::function<void()> begin;
};

struct PairGraphSummary {
    long shapes = 0;         ///< usable files
    long shapes_failed = 0;  ///< files with a problem
    long pairs_total = 0;    ///< geodesics between different shapes: files with equal content count once
    long pairs_stored = 0;   ///< were in the store before
    long pairs_solved = 0;   ///< computed now
    long pairs_failed = 0;   ///< of these: without a trustworthy distance
    bool stopped = false;
    std::vector<StoredShape> unusable;  ///< the files with a problem
};

/// From files to rows in one flow graph:
///
///     input -> import -> schedule (serial: stores shapes, emits pairs that are not stored)
///       -> queue -> limiter (pairs in memory) -> solve -> record (serial) -> decrements the limiter
///
/// Where no shape can be used nothing is stored: what the study had before is worth more than a list of problems.
/// A pair that fails is a row with the reason. A store that fails ends the run with StoreError; what is in it stays.
template <int Dim>
PairGraphSummary run_pair_graph(const Collection& collection, ResultStore& store, const PairGraphOptions& options,
                                Progress& progress);

/// Solves one pair as the graph does; what the solver throws becomes the row's failure.
/// @param path  receives the path as computed (in_pose_of_last turns it for pictures); nothing if there is none
template <int Dim>
[[nodiscard]] StoredGeodesic solve_pair(const ImportedShape<Dim>& a, const ImportedShape<Dim>& b,
                                        const GeodesicOptions& options, const std::function<bool()>& stop,
                                        GeodesicResult<Dim>* path = nullptr);

}  // namespace morphodesic::pipeline

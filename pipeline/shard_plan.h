#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/result_store.h"
#include "pipeline/run_settings.h"
#include "pipeline/wanted_pairs.h"

namespace morphodesic::pipeline {

/// Two runs of consecutive shapes; the pairs of one of the first with one of the second. A shard reads their shapes
/// once.
struct Tile {
    std::size_t rows_begin = 0, rows_end = 0, columns_begin = 0, columns_end = 0;  ///< numbers in ShardPlan::shapes
    int shard = 1;
    std::string missing;  ///< one character per geodesic of the tile: '1' to compute; empty: all of them
};

/// Who computes what of a study. Everything that a shard needs: with the level sets it is one file, plan.sqlite.
struct ShardPlan {
    int shards = 1;
    int dimension = 2;
    RunSettings settings;      ///< of the study
    GeodesicOptions geodesic;  ///< those of this round: coarser ones while a study screens its pairs
    std::vector<DifferentShapes::value_type> shapes;  ///< by content digest; sorted
    std::vector<Tile> tiles;

    /// All geodesics of a tile, whether they are to be computed or not, in the order of Tile::missing.
    [[nodiscard]] std::vector<GeodesicKey> geodesics_of(const Tile& tile) const;
    /// Those of a tile that are to be computed.
    [[nodiscard]] std::vector<GeodesicKey> missing_of(const Tile& tile) const;
    [[nodiscard]] std::string text() const;
    std::string id;  ///< eight digits that tell plans apart: the digest of the text
    [[nodiscard]] std::string result_name(int shard) const;
    /// What merge says at the end of a workflow.
    [[nodiscard]] std::string merged_name() const { return "merged-" + id + ".json"; }
};

/// Tiles of what is missing in a store, in at most `shards` shards of about the same number of geodesics.
/// @param geodesic  settings of the geodesics; only: of all geodesics these, if given
/// @param missing  receives how many geodesics are to be computed
[[nodiscard]] ShardPlan make_plan(const ResultStore& store, const RunSettings& settings,
                                  const GeodesicOptions& geodesic, const std::optional<std::set<GeodesicKey>>& only,
                                  int dimension, int shards, long& missing);

/// Writes plan and level sets to a file that is never changed again, so that many machines may read it at once.
void write_plan(const ShardPlan& plan, const ResultStore& store, const std::filesystem::path& file);
/// @throws StoreError if the file is no plan or was made by another version
[[nodiscard]] ShardPlan read_plan(const ResultStore& plan_file);

}  // namespace morphodesic::pipeline

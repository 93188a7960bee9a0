#include "pipeline/shard_plan.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numeric>

#include "pipeline/collection.h"
#include "pipeline/digest.h"
#include "pipeline/study_rounds.h"

namespace morphodesic::pipeline {
namespace {

using nlohmann::json;
constexpr int plan_version = 4;

std::string id_of(const std::string& text) {
    return digest(text).substr(0, 8);
}

}  // namespace

std::vector<GeodesicKey> ShardPlan::geodesics_of(const Tile& tile) const {
    std::vector<GeodesicKey> keys;
    for (std::size_t i = tile.rows_begin; i < tile.rows_end; ++i) {
        for (std::size_t j = std::max(i + 1, tile.columns_begin); j < tile.columns_end; ++j) {
            for (GeodesicKey& key : geodesics_of_pair(shapes[i], shapes[j], settings.pairs.both_directions)) {
                keys.push_back(std::move(key));
            }
        }
    }
    return keys;
}

std::vector<GeodesicKey> ShardPlan::missing_of(const Tile& tile) const {
    std::vector<GeodesicKey> keys = geodesics_of(tile);
    if (tile.missing.empty()) return keys;
    std::vector<GeodesicKey> chosen;
    for (std::size_t k = 0; k < keys.size(); ++k) {
        if (k < tile.missing.size() && tile.missing[k] == '1') chosen.push_back(std::move(keys[k]));
    }
    return chosen;
}

std::string ShardPlan::text() const {
    json list = json::array(), digests = json::array();
    for (const Tile& t : tiles) {
        list.push_back({t.shard, t.rows_begin, t.rows_end, t.columns_begin, t.columns_end, t.missing});
    }
    for (const auto& [digest, traits] : shapes) {
        digests.push_back({digest, traits.masked, traits.volume, traits.extent_radius, traits.fullness});
    }
    return json{{"format", "morphodesic plan"},
                {"version", plan_version},
                {"solver_revision", solver_revision},
                {"shards", shards},
                {"dimension", dimension},
                {"settings", canonical_text(settings)},
                {"geodesic", canonical_text(geodesic)},
                {"shapes", digests},
                {"tiles", list}}
        .dump();
}

std::string ShardPlan::result_name(int shard) const {
    char name[80];
    std::snprintf(name, sizeof name, "%s-%04d-of-%04d.jsonl", id.c_str(), shard, shards);
    return name;
}

ShardPlan make_plan(const ResultStore& store, const RunSettings& settings, const GeodesicOptions& geodesic,
                    const std::optional<std::set<GeodesicKey>>& only, int dimension, int shards, long& missing) {
    ShardPlan plan;
    plan.shards = shards;
    plan.dimension = dimension;
    plan.settings = settings;
    plan.geodesic = geodesic;
    const DifferentShapes different = different_shapes(store);
    for (const auto& shape : different) plan.shapes.push_back(shape);
    const auto stored = store.stored_pairs(settings_hash(geodesic));

    // About eight tiles for every shard, so that the shards come out even; not so small that shapes are read for a few
    // pairs only where there are many.
    const std::size_t n = plan.shapes.size();
    const double wanted = std::sqrt(16.0 * shards);
    const auto blocks =
        std::clamp<std::size_t>(static_cast<std::size_t>(std::ceil(wanted)), 1, std::max<std::size_t>(n, 1));
    std::vector<long> load;
    missing = 0;
    for (std::size_t r = 0; r < blocks; ++r) {
        for (std::size_t c = r; c < blocks; ++c) {
            Tile tile{r * n / blocks, (r + 1) * n / blocks, c * n / blocks, (c + 1) * n / blocks, 1, ""};
            const auto keys = plan.geodesics_of(tile);
            for (const GeodesicKey& key : keys) {
                const bool to_compute = !stored.contains(key) && (!only || only->contains(key));
                tile.missing += to_compute ? '1' : '0';
            }
            const auto count = std::count(tile.missing.begin(), tile.missing.end(), '1');
            if (count == 0) continue;
            if (static_cast<std::size_t>(count) == keys.size()) tile.missing.clear();
            missing += count;
            load.push_back(count);
            plan.tiles.push_back(std::move(tile));
        }
    }
    // The largest tile goes to the shard that has least.
    std::vector<std::size_t> order(plan.tiles.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t x, std::size_t y) { return load[x] > load[y]; });
    std::vector<long> total(static_cast<std::size_t>(shards), 0);
    for (const std::size_t t : order) {
        const auto least = std::min_element(total.begin(), total.end());
        *least += load[t];
        plan.tiles[t].shard = static_cast<int>(least - total.begin()) + 1;
    }
    plan.id = id_of(plan.text());
    return plan;
}

void write_plan(const ShardPlan& plan, const ResultStore& store, const std::filesystem::path& file) {
    const std::filesystem::path temporary = file.string() + ".part";
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    {
        ResultStore out(temporary, ResultStore::Access::write);
        out.set_fact("plan", plan.text());
        with_dimension(plan.dimension, [&]<int Dim>() {
            for (const auto& [digest, traits] : plan.shapes) {
                ScalarField<Dim> mask;
                const LevelSet<Dim> level_set = store.level_set<Dim>(digest, &mask);
                out.put_level_set<Dim>(digest, level_set, mask);
            }
        });
        out.finish_as_one_file();
    }
    std::error_code error;
    std::filesystem::rename(temporary, file, error);
    if (error) throw StoreError(file, "the plan cannot be written: " + error.message());
}

ShardPlan read_plan(const ResultStore& plan_file) {
    const auto text = plan_file.fact("plan");
    if (!text) throw StoreError(plan_file.file(), "is not a plan; make one with: morphodesic plan STUDY --shards N");
    const json j = json::parse(*text);
    if (j.at("version") != plan_version || j.at("solver_revision") != solver_revision) {
        throw StoreError(plan_file.file(),
                         "was made by another version of morphodesic, whose numbers are not to be mixed with those of "
                         "this one; plan anew, with the same program on all machines");
    }
    ShardPlan plan;
    plan.shards = j.at("shards");
    plan.dimension = j.at("dimension");
    plan.settings = settings_from_text(j.at("settings").get<std::string>());
    plan.geodesic = settings_from_text(j.at("geodesic").get<std::string>()).geodesic;
    for (const json& shape : j.at("shapes"))
        plan.shapes.emplace_back(shape[0].get<std::string>(), ShapeTraits{shape[1], shape[2], shape[3], shape[4]});
    for (const json& t : j.at("tiles")) plan.tiles.push_back({t[1], t[2], t[3], t[4], t[0], t[5]});
    plan.id = id_of(*text);
    return plan;
}

}  // namespace morphodesic::pipeline

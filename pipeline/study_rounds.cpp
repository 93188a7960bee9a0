#include "pipeline/study_rounds.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "analysis/distance_matrix.h"

namespace morphodesic::pipeline {
namespace {

/// The shapes by number, as a screening knows them.
std::vector<const DifferentShapes::value_type*> in_order(const DifferentShapes& shapes) {
    std::vector<const DifferentShapes::value_type*> order;
    for (const auto& shape : shapes) order.push_back(&shape);
    return order;
}

}  // namespace

PairDistance distance_of_pair(const GeodesicRows& rows, const std::vector<GeodesicKey>& keys) {
    PairDistance pair;
    std::vector<double> lengths;
    const auto count = static_cast<double>(keys.size());
    for (const GeodesicKey& key : keys) {
        const auto found = rows.find(key);
        pair.complete = pair.complete && found != rows.end();
        if (found == rows.end()) continue;
        const StoredGeodesic& row = found->second;
        if (pair.problem.empty()) pair.problem = row.problem();
        pair.distance += row.path_length / count;
        pair.error += row.error / count;
        lengths.push_back(row.path_length);
    }
    // Two directions that differ by more than their bars say that the bars are too short.
    if (!lengths.empty()) pair.error = std::max(pair.error, std::abs(lengths.front() - lengths.back()) / 2);
    return pair;
}

GeodesicRows rows_of(const ResultStore& store, const GeodesicOptions& options, const ResultStore::OnDamage& on_damage) {
    GeodesicRows rows;
    for (StoredGeodesic& row : store.geodesics(settings_hash(options), on_damage)) {
        GeodesicKey key(row.a, row.b);
        rows.emplace(std::move(key), std::move(row));
    }
    return rows;
}

DifferentShapes different_shapes(const ResultStore& store) {
    const std::set<std::string> masked = store.masked_level_sets();
    DifferentShapes shapes;
    for (const StoredShape& shape : store.shapes()) {
        if (!shape.problem.empty() || shape.content_digest.empty()) continue;
        add_shape(shapes, shape.content_digest, traits_of(shape, masked.contains(shape.content_digest)));
    }
    return shapes;
}

std::set<GeodesicKey> StudyRounds::missing(bool both_directions) const {
    const auto order = in_order(shapes);
    std::set<GeodesicKey> keys;
    const GeodesicRows& there = rows[screening.level];
    for (const auto& [i, j] : screening.missing) {
        for (GeodesicKey& key : geodesics_of_pair(*order[i], *order[j], both_directions)) {
            if (!there.contains(key)) keys.insert(std::move(key));
        }
    }
    return keys;
}

long StudyRounds::geodesics_of_finer_levels(bool both_directions) const {
    const auto order = in_order(shapes);
    long count = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
        for (std::size_t j = i + 1; j < order.size(); ++j) {
            const auto pair = analysis::DistanceMatrix::condensed_index(order.size(), i, j);
            const auto levels_of_pair = static_cast<long>(screening.pairs[pair].level);  // but the coarsest
            if (levels_of_pair == 0) continue;
            count +=
                levels_of_pair * static_cast<long>(geodesics_of_pair(*order[i], *order[j], both_directions).size());
        }
    }
    return count;
}

StudyRounds rounds_of(const ResultStore& store, const RunSettings& settings, const ResultStore::OnDamage& on_damage) {
    StudyRounds rounds;
    rounds.levels = screening_levels(settings.geodesic, settings.pairs.neighbors);
    for (const GeodesicOptions& level : rounds.levels) rounds.rows.push_back(rows_of(store, level, on_damage));
    rounds.shapes = different_shapes(store);
    if (!rounds.screened()) return rounds;
    const auto order = in_order(rounds.shapes);
    // Asked for several times: by the numbers of the shapes it is found faster than by their digests.
    const std::size_t n = order.size();
    std::map<std::string, std::size_t> number;
    for (std::size_t i = 0; i < n; ++i) number.emplace(order[i]->first, i);
    std::vector<std::map<std::size_t, PairMeasurement>> known(rounds.levels.size());
    for (std::size_t level = 0; level < known.size(); ++level) {
        for (const auto& [key, row] : rounds.rows[level]) {
            const auto a = number.find(key.first), b = number.find(key.second);
            if (a == number.end() || b == number.end()) continue;  // of a file that has left the collection
            const auto [i, j] = std::minmax(a->second, b->second);
            const auto keys = geodesics_of_pair(*order[i], *order[j], settings.pairs.both_directions);
            if (key != keys.front()) continue;
            const PairDistance pair = distance_of_pair(rounds.rows[level], keys);
            if (!pair.complete) continue;
            const bool trusted = pair.problem.empty();
            known[level].emplace(i * n + j, PairMeasurement{trusted ? pair.distance : analysis::missing, pair.error});
        }
    }
    const Measured measured = [&](std::size_t level, std::size_t i, std::size_t j) -> std::optional<PairMeasurement> {
        const auto found = known[level].find(i * n + j);
        return found == known[level].end() ? std::nullopt : std::optional(found->second);
    };
    rounds.screening = screen_pairs(order.size(), settings.pairs.neighbors, rounds.levels.size(), measured);
    return rounds;
}

}  // namespace morphodesic::pipeline

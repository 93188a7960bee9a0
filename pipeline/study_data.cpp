#include "pipeline/study_data.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "pipeline/wanted_pairs.h"

namespace morphodesic::pipeline {

StudyData load_study(const ResultStore& store) {
    StudyData data;
    const auto text = store.fact("settings");
    if (!text) throw StoreError(store.file(), "the study has no settings yet; make it with: morphodesic run FOLDER");
    data.settings = settings_from_text(*text);
    data.settings_hash = settings_hash(data.settings.geodesic);
    data.dimension = store.fact("dimension") == "3" ? 3 : 2;
    std::vector<std::string> names;
    for (StoredShape& shape : store.shapes()) {
        if (shape.problem.empty() && !shape.content_digest.empty()) {
            names.push_back(shape.name);
            data.shapes.push_back(std::move(shape));
        } else {
            data.failures.push_back({shape.name, "", shape.problem.empty() ? "not read yet" : shape.problem});
            data.unusable.push_back(std::move(shape));
        }
    }
    data.distances = analysis::DistanceMatrix(names);
    data.pairs.resize(data.distances.pair_count());
    data.first_is_a.resize(data.distances.pair_count(), true);

    data.backward.resize(data.distances.pair_count());
    const std::set<std::string> masked = store.masked_level_sets();
    const bool both = data.settings.pairs.both_directions;

    std::map<GeodesicKey, StoredGeodesic> rows;
    for (StoredGeodesic& row :
         store.geodesics(data.settings_hash, [&](const std::string& damage) { data.remarks.push_back(damage); })) {
        const auto key = std::pair(row.a, row.b);
        rows.emplace(key, std::move(row));
    }
    for (std::size_t i = 0; i < data.shapes.size(); ++i) {
        for (std::size_t j = i + 1; j < data.shapes.size(); ++j) {
            const std::string &a = data.shapes[i].content_digest, &b = data.shapes[j].content_digest;
            if (a == b) {
                data.distances.set(i, j, 0.0, 0.0);
                continue;
            }
            const auto keys = geodesics_of_pair(a, masked.contains(a), b, masked.contains(b), both);
            const std::size_t p = data.index(i, j);
            data.first_is_a[p] = keys.front().first == a;
            std::string problem;
            bool complete = true;
            double length = 0.0, error = 0.0;
            std::vector<double> lengths;
            for (const GeodesicKey& key : keys) {
                const auto found = rows.find(key);
                complete = complete && found != rows.end();
                if (found == rows.end()) continue;
                const StoredGeodesic& row = found->second;
                (&key == &keys.front() ? data.pairs : data.backward)[p] = row;
                if (problem.empty()) problem = row.problem();
                length += row.path_length / static_cast<double>(keys.size());
                error += row.error / static_cast<double>(keys.size());
                lengths.push_back(row.path_length);
            }
            if (!problem.empty()) {
                data.failures.push_back({data.shapes[i].name, data.shapes[j].name, problem});
            } else if (!complete) {
                ++data.pairs_missing;
            } else {
                // Two directions that differ by more than their bars say that the bars are too short.
                data.distances.set(i, j, length, std::max(error, std::abs(lengths.front() - lengths.back()) / 2));
            }
        }
    }
    return data;
}

}  // namespace morphodesic::pipeline

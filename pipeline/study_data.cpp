#include "pipeline/study_data.h"

#include <map>
#include <utility>

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

    std::map<std::pair<std::string, std::string>, StoredGeodesic> rows;
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
            auto found = rows.find({a, b});
            if (found == rows.end()) {
                found = rows.find({b, a});
                data.first_is_a[data.index(i, j)] = false;
            }
            if (found == rows.end()) {
                ++data.pairs_missing;
                continue;
            }
            const std::string problem = found->second.problem();
            if (problem.empty()) {
                data.distances.set(i, j, found->second.path_length, found->second.error);
            } else {
                data.failures.push_back({data.shapes[i].name, data.shapes[j].name, problem});
            }
            data.pairs[data.index(i, j)] = found->second;
        }
    }
    return data;
}

}  // namespace morphodesic::pipeline

#include "pipeline/study_data.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "pipeline/collection.h"
#include "pipeline/study_rounds.h"
#include "pipeline/wanted_pairs.h"
#include "reports/text.h"

namespace morphodesic::pipeline {
namespace {

/// Files of equal content: each is the nearest neighbour of the other, which accuracies count.
std::string remark_on_equal(const std::vector<StoredShape>& shapes) {
    std::map<std::string, std::vector<const StoredShape*>> same;
    for (const StoredShape& shape : shapes) same[shape.content_digest].push_back(&shape);
    std::size_t files = 0;
    const std::vector<const StoredShape*>* example = nullptr;
    for (const auto& [content, group] : same) {
        if (group.size() < 2) continue;
        files += group.size();
        if (example == nullptr || group.front()->name < example->front()->name) example = &group;
    }
    if (files == 0) return "";
    return std::to_string(files) + " of the " + std::to_string(shapes.size()) +
           " shapes are equal to another one (such as " + (*example)[0]->name + " and " + (*example)[1]->name +
           "): their distance is 0, and they are nearest neighbours of each other.";
}

/// Long shapes do not have the volume of the others in the cube, see datasets::placement_of.
std::string remark_on_sizes(const StudyData& data) {
    if (data.settings.normalize != "each" || data.shapes.empty()) return "";
    const auto less = [](const StoredShape& a, const StoredShape& b) { return a.volume < b.volume; };
    const auto [small, large] = std::minmax_element(data.shapes.begin(), data.shapes.end(), less);
    constexpr double much = 0.05;
    const double spread = 1.0 - small->volume / large->volume;
    if (!(spread > much)) return "";
    const std::string size = data.dimension == 2 ? "area" : "volume";
    return "--normalize each could not make all shapes equally large, as long ones do not fit into the cube then: " +
           small->name + " has " + reports::share_text(1.0 - spread) + " of the " + size + " of " + large->name +
           ", and distances count that, too.";
}

/// A mask counts at the first shape of a path, see GeodesicOptions.
std::string remark_on_masks(const std::vector<StoredShape>& shapes, const DifferentShapes& traits) {
    const auto hidden = std::count_if(shapes.begin(), shapes.end(),
                                      [&](const StoredShape& shape) { return traits.at(shape.content_digest).masked; });
    if (hidden < 2) return "";
    return std::to_string(hidden) +
           " shapes are partly hidden; of a pair of these only what the first one hides (path_from in pairs.csv) is "
           "left out of account, and what is hidden of the other counts as if it were not there.";
}

}  // namespace

StudyData load_study(const ResultStore& store) {
    StudyData data;
    data.settings = settings_of_study(store);
    data.settings_hash = settings_hash(data.settings.geodesic);
    if (data.settings.normalize == "common") data.common_scale = store.fact("common_scale").value_or("");
    data.dimension = store.fact("dimension") == "3" ? 3 : 2;
    data.unfinished = unfinished_reading(store);
    if (!data.unfinished.empty()) data.failures.push_back({"", "", data.unfinished});
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
    const bool both = data.settings.pairs.both_directions;
    if (both) data.backward.resize(data.distances.pair_count());
    std::set<std::pair<std::string, std::string>> damaged;
    const StudyRounds rounds =
        rounds_of(store, data.settings, [&](const std::string& a, const std::string& b) { damaged.emplace(a, b); });
    for (std::string remark :
         {remark_on_equal(data.shapes), remark_on_sizes(data), remark_on_masks(data.shapes, rounds.shapes)}) {
        if (!remark.empty()) data.remarks.push_back(std::move(remark));
    }
    data.levels = rounds.levels;
    const std::size_t finest = rounds.levels.size() - 1;
    data.level_of.assign(data.distances.pair_count(), static_cast<unsigned char>(finest));
    const bool screened = rounds.screened() && rounds.screening.missing.empty();
    std::map<std::string, std::size_t> number;
    for (const auto& [digest, traits] : rounds.shapes) number.emplace(digest, number.size());

    for (std::size_t i = 0; i < data.shapes.size(); ++i) {
        for (std::size_t j = i + 1; j < data.shapes.size(); ++j) {
            const std::string &a = data.shapes[i].content_digest, &b = data.shapes[j].content_digest;
            if (a == b) {
                data.distances.set(i, j, 0.0, 0.0);
                continue;
            }
            const auto keys = geodesics_of_pair({a, rounds.shapes.at(a)}, {b, rounds.shapes.at(b)}, both);
            const std::size_t p = data.index(i, j);
            data.first_is_a[p] = keys.front().first == a;
            std::size_t level = finest;
            const Screening::Pair* estimate = nullptr;
            if (screened) {
                const auto [x, y] = std::minmax(number.at(a), number.at(b));
                estimate = &rounds.screening.pairs[analysis::DistanceMatrix::condensed_index(number.size(), x, y)];
                level = estimate->level;
            }
            data.level_of[p] = static_cast<unsigned char>(level);
            const GeodesicRows& rows = rounds.rows[level];
            const auto row = [&](const GeodesicKey& key) {
                const auto found = rows.find(key);
                return found == rows.end() ? nullptr : std::make_shared<const StoredGeodesic>(found->second);
            };
            data.pairs[p] = row(keys.front());
            if (keys.size() > 1) data.backward[p] = row(keys.back());
            const PairDistance pair = distance_of_pair(rows, keys);
            if (damaged.contains(keys.front()) || damaged.contains(keys.back())) {
                const StudyFailure failure{data.shapes[i].name, data.shapes[j].name,
                                           "its stored result is damaged; it is computed again by: morphodesic "
                                           "geodesics " +
                                               store.file().parent_path().string()};
                data.damaged.emplace(p, failure);
                data.failures.push_back(failure);
            }
            if (!pair.problem.empty()) {
                data.failures.push_back({data.shapes[i].name, data.shapes[j].name, pair.problem});
            } else if (!pair.complete) {
                ++data.pairs_missing;
            } else if (level == finest) {
                data.distances.set(i, j, pair.distance, pair.error);
            } else {
                data.distances.set(i, j, estimate->distance, estimate->error);
                ++data.pairs_coarse;
            }
        }
    }
    if (rounds.screened() && !screened) data.pairs_missing = static_cast<long>(rounds.screening.missing.size());
    if (data.pairs_coarse > 0) {
        data.coarse_note = std::to_string(data.pairs_coarse) + " of " + std::to_string(data.distances.pair_count()) +
                           " distances are estimates from coarse grids (--neighbors " +
                           std::to_string(data.settings.pairs.neighbors) + "): these pairs are not among the " +
                           std::to_string(data.settings.pairs.neighbors) +
                           " nearest of either shape. Column refined of pairs.csv is 0 for them; distances_refined.csv "
                           "leaves them out.";
    }
    return data;
}

}  // namespace morphodesic::pipeline

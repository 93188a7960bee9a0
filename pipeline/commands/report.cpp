// analyze, report, verify: from rows to files and back.
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "pipeline/collection.h"
#include "pipeline/commands.h"
#include "pipeline/commands/summary.h"
#include "pipeline/digest.h"
#include "pipeline/exports.h"
#include "pipeline/pair_graph.h"
#include "pipeline/stop_signals.h"

namespace morphodesic::pipeline {
namespace {

Summary summary_of(const StudyData& data, const StudyFolder& folder) {
    Summary summary;
    const auto pairs = static_cast<long>(data.distances.pair_count());
    summary.data = {{"study", folder.path().string()},
                    {"shapes", data.shapes.size()},
                    {"shapes_failed", data.unusable.size()},
                    {"pairs", pairs},
                    {"pairs_missing", data.pairs_missing}};
    summary.lines.push_back(std::to_string(data.shapes.size()) + " shapes, " + std::to_string(pairs) + " pairs");
    if (data.pairs_missing > 0) {
        summary.exit_code = some_failed;
        summary.lines.push_back(std::to_string(data.pairs_missing) +
                                " pairs are not computed yet; do it with: morphodesic "
                                "geodesics " +
                                folder.path().string());
    }
    return summary;
}

/// The sample of `verify`: the rows that come first in an order drawn by the seed.
std::vector<const StoredGeodesic*> sample(const StudyData& data, const StudyOptions& options) {
    std::vector<std::pair<std::string, const StoredGeodesic*>> rows;
    for (const auto* direction : {&data.pairs, &data.backward}) {
        for (const auto& pair : *direction) {
            if (!pair || !pair->problem().empty()) continue;
            rows.emplace_back(digest(std::to_string(options.seed) + pair->a + pair->b), &*pair);
        }
    }
    std::sort(rows.begin(), rows.end());
    std::vector<const StoredGeodesic*> chosen;
    for (const auto& [order, row] : rows) {
        if (chosen.size() == static_cast<std::size_t>(options.sample)) break;
        chosen.push_back(row);
    }
    return chosen;
}

}  // namespace

int analyze(const StudyOptions& options) {
    const StudyFolder folder(options.study);
    const ResultStore store(folder.store(), ResultStore::Access::read);
    const StudyData data = load_study(store);
    Summary summary = summary_of(data, folder);
    const AnalysedStudy analysed = analyse_study(data, options.analysis);
    export_tables(data, analysed, folder);
    summarise(analysed.model, summary);
    summary.lines.push_back("Tables: " + folder.path().string());
    summary.add_failures(data.failures);
    return summary.print(options.common);
}

int report(const StudyOptions& options) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(thread_count(options.common)));
    const StudyFolder folder(options.study);
    if (!std::filesystem::exists(folder.store())) ResultStore(folder.store(), ResultStore::Access::read);
    const StudyLock lock(folder);
    ResultStore store(folder.store(), ResultStore::Access::write);
    const StudyData data = load_study(store);
    Summary summary = summary_of(data, folder);
    Progress progress(Progress::style_of_stderr(options.common.quiet));
    export_report(data, store, folder, options, progress, summary);
    if (StopSignals::caught() != 0) return 128 + StopSignals::caught();
    summary.add_failures(data.failures);
    return summary.print(options.common);
}

int verify(const StudyOptions& options) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(thread_count(options.common)));
    const StudyFolder folder(options.study);
    const ResultStore store(folder.store(), ResultStore::Access::read);
    const StudyData data = load_study(store);
    Progress progress(Progress::style_of_stderr(options.common.quiet));
    Summary summary;
    std::vector<StudyFailure> differing;
    for (const std::string& damage : data.remarks) differing.push_back({"", "", damage});
    long checked = 0;
    std::map<std::string, std::size_t> by_digest;
    for (std::size_t i = 0; i < data.shapes.size(); ++i) by_digest.emplace(data.shapes[i].content_digest, i);
    std::map<std::string, const GeodesicOptions*> settings_of;
    for (const GeodesicOptions& level : data.levels) settings_of.emplace(settings_hash(level), &level);
    const std::vector<const StoredGeodesic*> chosen = sample(data, options);
    progress.begin_pairs(static_cast<long>(data.pairs.size()),
                         static_cast<long>(data.pairs.size()) - data.pairs_missing, static_cast<long>(chosen.size()),
                         1);
    with_dimension(data.dimension, [&]<int Dim>() {
        const auto shape = [&](const std::string& digest) {
            ImportedShape<Dim> result;
            result.row = data.shapes[by_digest.at(digest)];
            ScalarField<Dim> mask;
            result.level_set = std::make_shared<const LevelSet<Dim>>(store.level_set<Dim>(digest, &mask));
            if (!mask.values.empty()) result.mask = std::make_shared<const ScalarField<Dim>>(std::move(mask));
            return result;
        };
        for (const StoredGeodesic* row : chosen) {
            const StoredGeodesic& stored = *row;
            const ImportedShape<Dim> a = shape(stored.a), b = shape(stored.b);
            const StoredGeodesic again =
                solve_pair<Dim>(a, b, *settings_of.at(stored.settings_hash), [] { return StopSignals::caught() != 0; });
            if (StopSignals::caught() != 0) return;
            ++checked;
            progress.pair_done(again.problem().empty(), again.seconds);
            if (again.path_length == stored.path_length && again.min_det == stored.min_det) continue;
            char text[200];
            std::snprintf(text, sizeof text, "stored path length %.17g, computed again %.17g", stored.path_length,
                          again.path_length);
            differing.push_back({a.row.name, b.row.name, text});
        }
    });
    progress.end_pairs();
    if (StopSignals::caught() != 0) return 128 + StopSignals::caught();
    summary.data = {{"study", folder.path().string()}, {"checked", checked}, {"differing", differing.size()}};
    summary.lines.push_back(
        std::to_string(checked) + " pairs computed again: " +
        (differing.empty() ? "all equal to the store, bit by bit" : std::to_string(differing.size()) + " problems"));
    summary.add_failures(differing);
    return summary.print(options.common);
}

}  // namespace morphodesic::pipeline

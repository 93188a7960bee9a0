// analyze, report, verify: from rows to files and back.
#include "reports/report.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>

#include "pipeline/collection.h"
#include "pipeline/commands.h"
#include "pipeline/commands/summary.h"
#include "pipeline/digest.h"
#include "pipeline/exports.h"
#include "pipeline/given_matrix.h"
#include "pipeline/pair_graph.h"
#include "pipeline/report_provenance.h"
#include "pipeline/shape_cache.h"
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
    for (const std::string& remark : data.remarks) summary.add_remark(remark);
    if (data.given && data.pairs_missing > 0) {
        summary.lines.push_back(std::to_string(data.pairs_missing) +
                                (data.pairs_missing == 1 ? " pair has no distance" : " pairs have no distance"));
    } else {
        summary.add_missing_pairs(data, folder.path());
    }
    return summary;
}

/// The sample of `verify`: the rows that come first in an order drawn by the seed.
std::vector<const StoredGeodesic*> sampled_pairs(const StudyData& data, const StudyOptions& options) {
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

bool is_table(const StudyOptions& options) {
    return std::filesystem::is_regular_file(options.study);
}

/// @throws std::invalid_argument if options for tables are given with a study
void check_sources(const StudyOptions& options) {
    if (is_table(options)) return;
    if (!options.errors.empty() || !options.out.empty()) {
        throw std::invalid_argument(std::string(options.errors.empty() ? "--out" : "--errors") +
                                    " is for tables of distances; the study " + options.study.string() +
                                    " has its own folder and error bars");
    }
    if (options.asymmetric && options.compare.empty()) {
        throw std::invalid_argument(
            "--asymmetric is for tables of distances; for a study there is "
            "`morphodesic run --both-directions`");
    }
}

/// Tables of nothing must not take the place of those that the study had.
void refuse_without_usable_shapes(const StudyData& data, const StudyFolder& folder) {
    if (!data.shapes.empty()) return;
    const std::string first = data.failures.empty() ? "" : " (" + data.failures.front().reason + ")",
                      remedy = "; read the files again with: morphodesic run FOLDER --out " + folder.path().string();
    const bool damaged =
        std::any_of(data.unusable.begin(), data.unusable.end(), [](const auto& s) { return s.damaged; });
    if (damaged) throw StoreError(folder.path(), "the shapes of the study are damaged" + first + remedy);
    throw std::invalid_argument(folder.path().string() + ": the study has no shape that can be used" + first + remedy);
}

/// What is analysed, a study or a table of distances, and where the results go.
struct Subject {
    explicit Subject(const StudyOptions& options) : folder(folder_of(options)) {
        if (is_table(options)) {
            data = read_given_matrix(options.study, {options.errors, options.asymmetric});
            if (!options.labels.empty()) label_shapes(data, options.labels);
            folder.create();  // not for a table that is refused
            lock.emplace(folder);
        } else {
            expect_store(folder.store());
            lock.emplace(folder);
            data = load_study(ResultStore(folder.store(), ResultStore::Access::read));
            refuse_without_usable_shapes(data, folder);
            if (!options.labels.empty()) label_shapes(data, options.labels);
        }
    }

    StudyFolder folder;
    std::optional<StudyLock> lock;  // two that write the same tables at once would mix them
    StudyData data;

private:
    static StudyFolder folder_of(const StudyOptions& options) {
        if (!is_table(options)) return StudyFolder(options.study);
        if (!options.out.empty()) return StudyFolder(options.out);
        std::filesystem::path beside = options.study;
        return StudyFolder(beside.replace_extension(".analysis"));
    }
};

/// Analyses a study or a table; what comes of it is written by `write`.
/// @param write  called with subject, tables of results, model and summary
template <class Write>
int analyse_and(const StudyOptions& options, const Write& write) {
    const Subject subject(options);
    Summary summary = summary_of(subject.data, subject.folder);
    AnalysedStudy analysed = analyse_study(subject.data, options.analysis);
    if (StopSignals::caught() != 0) return stopped_by_signal("; nothing was written");
    add_findings(subject.data, options, analysed, summary);
    if (is_table(options)) add_provenance_of_table(options, subject.folder, analysed.model);
    write(subject, tables_of(subject.data, analysed), analysed.model, summary);
    return summary.print(options.common);
}

}  // namespace

int analyze(const StudyOptions& options) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(thread_count(options.common)));
    check_sources(options);
    return analyse_and(
        options, [&](const Subject& subject, RunFiles files, const reports::ReportModel& model, Summary& summary) {
            files.written.emplace_back("analysis.json", reports::to_json(model));
            subject.folder.write_together(files);
            summarise(model, summary);
            summary.lines.push_back("Tables: " + subject.folder.path().string());
            if (std::filesystem::exists(subject.folder.path() / "report.html")) {
                summary.add_remark(
                    "report.html, report.json and figures/ are those of an earlier run; `morphodesic report " +
                    options.study.string() + "` brings them up to date.");
            }
            summary.add_failures(subject.data.failures);
        });
}

int report(const StudyOptions& options) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(thread_count(options.common)));
    check_sources(options);
    if (is_table(options)) {
        return analyse_and(
            options, [](const Subject& subject, RunFiles tables, const reports::ReportModel& model, Summary& summary) {
                write_report(std::move(tables), model, subject.folder, summary);
                summary.add_failures(subject.data.failures);
            });
    }
    const StudyFolder folder(options.study);
    expect_store(folder.store());
    const StudyLock lock(folder);
    ResultStore store(folder.store(), ResultStore::Access::write);
    StudyData data = load_study(store);
    refuse_without_usable_shapes(data, folder);
    if (!options.labels.empty()) label_shapes(data, options.labels);
    Summary summary = summary_of(data, folder);
    Progress progress(Progress::style_of_stderr(options.common.quiet));
    if (!export_report(data, store, folder, options, progress, summary)) {
        return stopped_by_signal("; tables and report are as they were");
    }
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
    if (!data.unfinished.empty()) differing.push_back({"", "", data.unfinished});
    for (const auto& [pair, damage] : data.damaged) differing.push_back(damage);
    for (const StoredShape& shape : data.unusable) {
        if (shape.damaged) differing.push_back({shape.name, "", shape.problem});
    }
    long checked = 0;
    std::map<std::string, std::size_t> by_digest;
    for (std::size_t i = 0; i < data.shapes.size(); ++i) by_digest.emplace(data.shapes[i].content_digest, i);
    std::map<std::string, const GeodesicOptions*> settings_of;
    for (const GeodesicOptions& level : data.levels) settings_of.emplace(settings_hash(level), &level);
    const std::vector<const StoredGeodesic*> chosen = sampled_pairs(data, options);
    if (chosen.empty() && differing.empty()) {
        const std::string study = folder.path().string();
        throw std::invalid_argument(study + ": there is no trustworthy distance to verify" +
                                    (data.pairs_missing > 0 ? "; compute them with: morphodesic geodesics "
                                                            : "; what failed is said by: "
                                                              "morphodesic report ") +
                                    study);
    }
    progress.begin_pairs(static_cast<long>(data.pairs.size()),
                         static_cast<long>(data.pairs.size()) - data.pairs_missing, static_cast<long>(chosen.size()),
                         1);
    with_dimension(data.dimension, [&]<int Dim>() {
        const auto shape = [&](const std::string& digest) {
            return stored_shape<Dim>(data.shapes[by_digest.at(digest)], store);
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
    if (StopSignals::caught() != 0) return stopped_by_signal("");
    summary.data = {{"study", folder.path().string()}, {"checked", checked}, {"differing", differing.size()}};
    summary.lines.push_back(std::to_string(checked) + (checked == 1 ? " pair" : " pairs") + " computed again: " +
                            (differing.empty()       ? "all equal to the store, bit by bit"
                             : differing.size() == 1 ? "1 problem"
                                                     : std::to_string(differing.size()) + " problems"));
    summary.add_failures(differing);
    return summary.print(options.common);
}

}  // namespace morphodesic::pipeline

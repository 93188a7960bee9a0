// run, ingest, geodesics: from files to rows.
#include <tbb/global_control.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>

#include "pipeline/collection.h"
#include "pipeline/commands.h"
#include "pipeline/commands/summary.h"
#include "pipeline/exports.h"
#include "pipeline/memory_limits.h"
#include "pipeline/memory_model.h"
#include "pipeline/pair_graph.h"
#include "pipeline/progress.h"
#include "pipeline/stop_signals.h"
#include "pipeline/study_folder.h"
#include "pipeline/study_rounds.h"

namespace morphodesic::pipeline {
namespace {

namespace fs = std::filesystem;

/// A study folder that this process alone works on.
struct Workplace {
    explicit Workplace(const StudyOptions& options, bool may_create)
        : folder(options.study),
          threads(thread_count(options.common)),
          progress(Progress::style_of_stderr(options.common.quiet)),
          limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads)) {
        if (may_create)
            folder.create();
        else
            expect_store(folder.store());
        lock = std::make_unique<StudyLock>(folder);
        store = std::make_unique<ResultStore>(folder.store(), ResultStore::Access::write);
    }

    StudyFolder folder;
    int threads;
    Progress progress;
    tbb::global_control limit;
    std::unique_ptr<StudyLock> lock;
    std::unique_ptr<ResultStore> store;
};

/// Writes the settings down as those of the study; says so if they were others before.
void settle_settings(Workplace& at, const RunSettings& settings) {
    const std::string text = canonical_text(settings), hash = settings_hash(settings.geodesic);
    const auto before = at.store->fact("settings");
    if (before && settings_hash(settings_from_text(*before).geodesic) != hash) {
        at.progress.message(
            "The settings differ from those this study was made with. Distances are computed for the new ones; "
            "those of the old ones stay in the store and are never mixed with them.");
    }
    for (const GeodesicOptions& level : screening_levels(settings.geodesic, settings.pairs.neighbors)) {
        at.store->put_settings(settings_hash(level), canonical_text(level));
    }
    // The command that made the study no longer repeats it; `run` writes down the new one when it is done.
    if (before && *before != text) at.store->set_fact("command", "");
    at.store->set_fact("settings", text);
    at.store->set_fact("program", "morphodesic " MORPHODESIC_VERSION);
}

/// The rounds of a screening: all pairs on the coarsest level, then what that asks for, until nothing is missing.
template <int Dim>
PairGraphSummary compute_rounds(Workplace& at, const Collection& collection, const RunSettings& settings,
                                PairGraphOptions graph) {
    const auto levels = screening_levels(settings.geodesic, settings.pairs.neighbors);
    graph.geodesic = levels.front();
    PairGraphSummary sum = run_pair_graph<Dim>(collection, *at.store, graph, at.progress);
    const long coarsest = sum.pairs_total;
    graph.begin = nullptr;
    while (!sum.stopped && sum.shapes > 0 && levels.size() > 1 && graph.solve) {
        const StudyRounds rounds = rounds_of(*at.store, settings);
        if (rounds.screening.missing.empty()) {  // those that earlier runs refined count, too
            sum.pairs_total = coarsest + rounds.geodesics_of_finer_levels(settings.pairs.both_directions);
            sum.pairs_stored = sum.pairs_total - sum.pairs_solved;
            break;
        }
        graph.geodesic = levels[rounds.screening.level];
        graph.only = rounds.missing(settings.pairs.both_directions);
        at.progress.message("level " + std::to_string(graph.geodesic.level) + ": " +
                            std::to_string(rounds.screening.asked) + " of " +
                            std::to_string(rounds.screening.pairs.size()) + " pairs may be among the nearest");
        Collection usable = stored_collection(*at.store);
        std::erase_if(usable.entries, [](const CollectionEntry& e) { return !e.row.problem.empty(); });
        const PairGraphSummary round = run_pair_graph<Dim>(usable, *at.store, graph, at.progress);
        sum.pairs_stored += round.pairs_stored;
        sum.pairs_solved += round.pairs_solved;
        sum.pairs_total += round.pairs_total;
        sum.pairs_failed = rounds.screening.level + 1 == levels.size() ? sum.pairs_failed + round.pairs_failed : 0;
        sum.stopped = round.stopped;
        if (!sum.stopped && round.pairs_solved == 0) {
            throw StoreError(at.store->file(), "does not take the results of a round; give the same command again");
        }
    }
    return sum;
}

/// @param memory      empty: no pairs are solved
/// @param from_files  the collection is that of the folder, not of the store
PairGraphSummary compute(Workplace& at, const Collection& collection, const StudyOptions& options,
                         const std::optional<MemoryPlan>& memory, bool from_files) {
    PairGraphOptions graph;
    const bool solve = memory.has_value();
    graph.solve = solve;
    graph.both_directions = options.settings.pairs.both_directions;
    graph.threads = at.threads;
    graph.pairs_in_flight = at.threads;
    const GeodesicOptions& geodesic = options.settings.geodesic;
    if (solve) {
        at.progress.message(memory->sentence());
        graph.pairs_in_flight = memory->pairs_in_flight;
        graph.shape_bytes = memory->shapes;
    }
    graph.stop = [] { return StopSignals::caught() != 0; };
    graph.begin = [&] {
        if (from_files) settle_collection(options.collection, collection, *at.store);
        settle_settings(at, options.settings);
        if (from_files) begin_reading(*at.store, collection.entries.size(), options.command);
        if (!solve || !options.retry_failed) return;
        for (const GeodesicOptions& level : screening_levels(geodesic, options.settings.pairs.neighbors)) {
            at.store->remove_failures(settings_hash(level));
        }
    };
    return with_dimension(collection.dimension,
                          [&]<int Dim>() { return compute_rounds<Dim>(at, collection, options.settings, graph); });
}

/// Adds up the time of all runs of the study; a clock that jumps back takes nothing away.
double add_seconds(ResultStore& store, double seconds) {
    const double total = std::max(seconds, 0.0) + std::stod(store.fact("seconds").value_or("0"));
    store.set_fact("seconds", std::to_string(total));
    return total;
}

int stopped(const StudyOptions& options, const PairGraphSummary& done) {
    return stopped_by_signal(done.pairs_total == 0
                                 ? " before the first pair"
                                 : "; " + std::to_string(done.pairs_stored + done.pairs_solved) + " of " +
                                       std::to_string(done.pairs_total) + " pairs are in the store",
                             options.command);
}

/// The end of a run of which no file could be used; the study is as it was before.
int refused(const StudyOptions& options, const Collection& collection, const PairGraphSummary& done, double seconds) {
    Summary summary;
    summary.exit_code = bad_usage;
    summary.data = {
        {"study", options.study.string()}, {"shapes", 0}, {"shapes_failed", done.shapes_failed}, {"seconds", seconds}};
    summary.lines.emplace_back("No file could be used.");
    std::vector<StudyFailure> failures;
    for (const std::string& problem : collection.left_out) failures.push_back({"", "", problem});
    for (const StoredShape& shape : done.unusable) failures.push_back({shape.name, "", shape.problem});
    summary.add_failures(failures);
    return summary.print(options.common);
}

/// The pictures of a study must not be read as the shapes of one.
void refuse_results_as_shapes(const StudyOptions& options) {
    std::error_code error;
    if (fs::equivalent(options.collection, options.study, error)) {
        throw std::invalid_argument(options.collection.string() +
                                    ": is the folder of the shapes; the next run would read the pictures of the study "
                                    "as shapes. Choose another folder with --out, it may be inside this one");
    }
    if (fs::exists(StudyFolder(options.collection).store(), error)) {
        throw std::invalid_argument(options.collection.string() +
                                    ": is a study, not a folder of shapes; name the folder it was made from, or renew "
                                    "its report with: morphodesic report STUDY");
    }
}

/// Shapes are sampled once, when they are read: on another level they would be others than those that `run` compares.
/// @throws std::invalid_argument if the stored shapes are not those of the wanted level
void check_stored_level(const Collection& collection, const ResultStore& store, const StudyOptions& options) {
    const int wanted = shape_level(collection.dimension, options.settings.geodesic);
    for (const CollectionEntry& entry : collection.entries) {
        if (entry.row.content_digest.empty()) continue;
        const int kept = store.level_of(entry.row.content_digest);
        if (kept == wanted) return;
        throw std::invalid_argument(
            options.study.string() + ": its shapes are kept on level " + std::to_string(kept) + ", and --level " +
            std::to_string(options.settings.geodesic.level) + " needs them on level " + std::to_string(wanted) +
            "; read the files again with: morphodesic run " + store.fact("folder").value_or("FOLDER") + " --out " +
            options.study.string() + " and the same options");
    }
}

int execute(const StudyOptions& options, bool from_files, bool solve, bool with_report) {
    const double begin = steady_seconds();
    if (from_files && !fs::is_directory(options.collection)) {
        throw std::invalid_argument(options.collection.string() +
                                    (fs::exists(options.collection)
                                         ? ": is a file; name the folder that holds the shapes"
                                         : ": there is no such folder; make one with: morphodesic datasets letters"));
    }
    if (from_files) refuse_results_as_shapes(options);
    // What is refused must leave the study as it was.
    if (solve && !options.memory.empty()) static_cast<void>(size_from_text(options.memory));
    Workplace at(options, from_files);
    Collection collection;
    if (from_files) {
        collection = prepare_collection(options.collection, options.settings, *at.store, at.progress);
        if (StopSignals::caught() != 0) return stopped(options, {});
        if (collection.entries.empty()) {
            for (const std::string& problem : collection.left_out) std::cerr << "morphodesic: " << problem << "\n";
            const std::string& wanted = options.settings.dimension;
            std::cerr << "morphodesic: " << options.collection.string()
                      << (wanted == "2" ? ": no images found; expected are PNG, JPEG, BMP, TIFF, PGM, WebP or GIF; for "
                                          "solids leave --dimension 2 out"
                          : wanted == "3" ? ": no solids found; expected are meshes, point clouds or volumes; for "
                                            "images leave --dimension 3 out"
                                          : ": no shapes found; expected are images (PNG, JPEG, BMP, TIFF, PGM, WebP, "
                                            "GIF) or solids (meshes, point clouds, volumes)")
                      << "\n";
            return bad_usage;
        }
    } else {
        collection = stored_collection(*at.store);
        check_stored_level(collection, *at.store, options);
    }
    std::optional<MemoryPlan> memory;
    if (solve) {
        const GeodesicOptions& geodesic = options.settings.geodesic;
        const auto reaches = solid_reaches(collection, *at.store);
        memory = plan_memory(
            options.memory, collection.dimension, geodesic.level, shape_level(collection.dimension, geodesic),
            geodesic.time_steps, collection.entries.size(), at.threads,
            [&](int level) { return largest_window_share(reaches, level, geodesic.align == "rigid"); });
    }
    for (const std::string& remark : collection.remarks) at.progress.message(remark);
    const PairGraphSummary done = compute(at, collection, options, memory, from_files);
    const double seconds = steady_seconds() - begin;
    if (done.shapes == 0 && !done.stopped) return refused(options, collection, done, seconds);
    const double seconds_of_all = add_seconds(*at.store, seconds);
    if (done.stopped) return stopped(options, done);
    if (!options.command.empty() && with_report) at.store->set_fact("command", options.command);
    Summary summary;
    summary.data = {{"study", at.folder.path().string()},
                    {"shapes", done.shapes},
                    {"shapes_failed", done.shapes_failed},
                    {"seconds", seconds},
                    {"seconds_of_all_runs", seconds_of_all}};
    for (const std::string& remark : collection.remarks) summary.data["remarks"].push_back(remark);
    if (solve) {
        summary.data["geodesics"] = done.pairs_total;
        summary.data["pairs_from_store"] = done.pairs_stored;
        summary.data["pairs_computed"] = done.pairs_solved;
        summary.data["pairs_failed"] = done.pairs_failed;
    }
    const StudyData data = load_study(*at.store);
    if (solve) summary.data["pairs"] = data.distances.pair_count();
    if (solve && data.levels.size() > 1) {
        summary.data["pairs_coarse"] = data.pairs_coarse;
        summary.data["pairs_refined"] = static_cast<long>(data.distances.pair_count()) - data.pairs_coarse;
    }
    std::vector<StudyFailure> failures;
    for (const std::string& problem : collection.left_out) failures.push_back({"", "", problem});
    for (const StudyFailure& failure : data.failures) {
        if (solve || failure.b.empty()) failures.push_back(failure);
    }
    std::string head = std::to_string(done.shapes) + " shapes";
    if (solve) {
        const auto pairs = static_cast<long>(data.distances.pair_count());
        head += ", " + std::to_string(pairs) + " pairs";
        if (done.pairs_total != pairs) {
            head += "; " + std::to_string(done.pairs_total) + " geodesics";
            if (data.levels.size() > 1) {
                head += " on all levels of the screening";
            } else if (options.settings.pairs.both_directions) {
                head += ", both directions of each pair";
            }
        }
        head += " (" + std::to_string(done.pairs_stored) + " from the store, " + std::to_string(done.pairs_solved) +
                " computed)";
    }
    summary.lines.push_back(head + " in " + duration_text(seconds));
    if (!with_report && !solve) summary.add_notes(data.shapes);  // a report has them
    for (const std::string& remark : data.remarks) summary.add_remark(remark);
    if (!data.coarse_note.empty()) summary.lines.push_back(data.coarse_note);
    if (solve) summary.add_missing_pairs(data, at.folder.path());
    if (with_report) {
        if (!export_report(data, *at.store, at.folder, options, at.progress, summary)) return stopped(options, done);
    } else {
        summary.lines.push_back("Study: " + at.folder.path().string());
    }
    summary.add_failures(failures);
    return summary.print(options.common);
}

}  // namespace

int run(const StudyOptions& options) {
    return execute(options, true, true, true);
}
int ingest(const StudyOptions& options) {
    return execute(options, true, false, false);
}
int geodesics(const StudyOptions& options) {
    return execute(options, false, true, false);
}

std::string stored_settings(const fs::path& study) {
    const StudyFolder folder(study);
    if (!fs::exists(folder.store())) return "";
    return ResultStore(folder.store(), ResultStore::Access::glance).fact("settings").value_or("");
}

}  // namespace morphodesic::pipeline

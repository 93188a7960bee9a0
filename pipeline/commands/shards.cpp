// plan, shard, merge: one study on several processes or machines.
#include <sys/stat.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iostream>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include "pipeline/collection.h"
#include "pipeline/commands.h"
#include "pipeline/commands/summary.h"
#include "pipeline/memory_model.h"
#include "pipeline/pair_graph.h"
#include "pipeline/shape_cache.h"
#include "pipeline/shard_plan.h"
#include "pipeline/shard_results.h"
#include "pipeline/stop_signals.h"
#include "pipeline/study_folder.h"
#include "pipeline/study_rounds.h"
#include "pipeline/whole_tasks.h"

namespace morphodesic::pipeline {
namespace {

namespace fs = std::filesystem;

fs::path this_program() {
    std::error_code error;
    const fs::path program = fs::read_symlink("/proc/self/exe", error);
    if (error) throw StoreError("/proc/self/exe", "the program cannot find itself: " + error.message());
    return program;
}

/// Memory of a shard on one core, in whole megabytes, with some room.
long shard_megabytes(const ShardPlan& plan) {
    const GeodesicOptions& geodesic = plan.geodesic;
    std::size_t largest = 0;
    for (const Tile& t : plan.tiles) {
        largest = std::max(largest, t.rows_end - t.rows_begin + t.columns_end - t.columns_begin);
    }
    const std::size_t bytes =
        bytes_of_program + bytes_of_pair(plan.dimension, geodesic.level, geodesic.time_steps) +
        (largest + 2) * bytes_of_shape(plan.dimension, shape_level(plan.dimension, plan.settings.geodesic));
    return static_cast<long>(bytes >> 20) + 64;
}

std::string slurm_script(const ShardPlan& plan, const fs::path& folder, const fs::path& study) {
    const std::string program = shell_word(this_program().string()), at = shell_word(folder.string());
    return "#!/bin/bash\n"
           "# Computes a morphodesic study: sbatch " +
           std::string("shards.slurm") +
           "\n"
           "# Then: " +
           program + " merge " + shell_word(study.string()) +
           "\n"
           "#SBATCH --job-name=morphodesic\n"
           "#SBATCH --array=1-" +
           std::to_string(plan.shards) +
           "\n"
           "#SBATCH --ntasks=1\n"
           "#SBATCH --cpus-per-task=1\n"
           "#SBATCH --mem=" +
           std::to_string(shard_megabytes(plan)) +
           "M\n"
           "#SBATCH --requeue\n"
           "#SBATCH --open-mode=append\n"
           "set -u\n"
           "cd " +
           at + " || exit 3\n" + program + " shard plan.sqlite \"$SLURM_ARRAY_TASK_ID/" + std::to_string(plan.shards) +
           "\" --threads \"${SLURM_CPUS_PER_TASK:-1}\" --accept-failures\n";
}

std::string makeflow_text(const ShardPlan& plan) {
    std::string text =
        "# makeflow -T local shards.makeflow     (or -T wq, slurm, condor, k8s), in this folder\n"
        "CORES=1\nMEMORY=" +
        std::to_string(shard_megabytes(plan)) + "\nDISK=1000\n\n";
    std::string all;
    for (int shard = 1; shard <= plan.shards; ++shard) {
        const std::string result = plan.result_name(shard);
        all += " " + result;
        text += result + ": morphodesic plan.sqlite\n\t./morphodesic shard plan.sqlite " + std::to_string(shard) + "/" +
                std::to_string(plan.shards) + " --threads 1 --accept-failures --out " + result + "\n\n";
    }
    return text + plan.merged_name() + ": morphodesic" + all +
           "\n\tLOCAL ./morphodesic merge .. --json --accept-failures > " + plan.merged_name() + "\n";
}

/// Takes away what Makeflow wrote down about the workflow of another plan: it knows rules by their numbers, and would
/// take those of this plan for done. Also where the rules of this plan were done, but the store lost what they
/// computed.
void remove_stale_logs(const ShardPlan& plan, const fs::path& folder) {
    const std::string id = plan.id;
    bool stale = fs::exists(folder / plan.merged_name());
    std::ifstream log(folder / "shards.makeflow.makeflowlog");
    for (std::string line; !stale && std::getline(log, line);) {
        // "# FILE 1795861628052452 1938203f-0001-of-0002.jsonl 1 1073741824", from when a rule begins
        std::istringstream words(line);
        std::string hash, kind, time, name;
        words >> hash >> kind >> time >> name;
        const bool result = name.ends_with(".jsonl") || name.starts_with("merged-");
        stale = kind == "FILE" && result && name.find(id) == name.npos;
    }
    if (!stale) return;  // the next makeflow goes on where the last one was
    std::vector<fs::path> files{folder / plan.merged_name()};
    for (const auto& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        if (name.starts_with("shards.makeflow.") && name.ends_with("log")) files.push_back(entry.path());
    }
    for (const fs::path& file : files) {
        std::error_code error;
        fs::remove(file, error);
        if (error) {
            throw StoreError(file, "cannot be removed: " + error.message() +
                                       "; makeflow would take the rules of this plan for done: move it away, then "
                                       "plan again");
        }
    }
}

/// "3/16"
std::pair<int, int> shard_number(const std::string& text) {
    int numbers[2] = {0, 0};
    const char *at = text.data(), *end = at + text.size();
    const auto first = std::from_chars(at, end, numbers[0]);
    if (first.ec == std::errc() && first.ptr != end && *first.ptr == '/') {
        const auto second = std::from_chars(first.ptr + 1, end, numbers[1]);
        if (second.ec == std::errc() && second.ptr == end && numbers[0] >= 1 && numbers[0] <= numbers[1]) {
            return {numbers[0], numbers[1]};
        }
    }
    throw std::invalid_argument("the shard is \"" + text + "\"; it must be I/N with 1 <= I <= N, such as 3/16");
}

/// "1 row was", "2 rows were", "2 rows of others were"
std::string counted(long count, const std::string& noun, const std::string& of = "") {
    return std::to_string(count) + " " + noun + (count == 1 ? "" : "s") + of + (count == 1 ? " was" : " were");
}

/// Of two results for one pair the one that stays, whatever comes first: one with a distance, then the shorter path.
bool stays(const StoredGeodesic& x, const StoredGeodesic& y) {
    const bool good = x.problem().empty();
    if (good != y.problem().empty()) return good;
    return !good || x.path_length <= y.path_length;
}

/// Whether a store has all that a plan wanted; false if there is no plan.
bool plan_is_done(const fs::path& file, const ResultStore& store) {
    if (!fs::exists(file)) return false;
    const ShardPlan plan = read_plan(ResultStore(file, ResultStore::Access::read));
    const auto stored = store.stored_pairs(settings_hash(plan.geodesic));
    return std::all_of(plan.tiles.begin(), plan.tiles.end(), [&](const Tile& tile) {
        const auto keys = plan.missing_of(tile);
        return std::all_of(keys.begin(), keys.end(), [&](const GeodesicKey& key) { return stored.contains(key); });
    });
}

/// What became of the rows of a file.
struct MergedRows {
    long added = 0, known = 0;
    long strangers = 0;  ///< of shapes that the study does not have
    long differing = 0;  ///< known, with another path length
};

/// Takes rows of one setting into the store.
/// @param digests  of the shapes of the study
void merge_rows(const std::vector<StoredGeodesic>& rows, const std::string& settings,
                const std::set<std::string>& digests, ResultStore& store, MergedRows& merged) {
    std::map<GeodesicKey, StoredGeodesic> taken;  // what goes into the store
    for (const StoredGeodesic& row : rows) {
        if (!digests.contains(row.a) || !digests.contains(row.b)) {
            ++merged.strangers;
            continue;
        }
        const auto before = taken.find({row.a, row.b});
        const std::optional<StoredGeodesic> there =
            before != taken.end() ? before->second : store.geodesic(row.a, row.b, settings);
        if (!there) {
            ++merged.added;
        } else {
            ++merged.known;
            const bool same = there->path_length == row.path_length ||
                              (std::isnan(there->path_length) && std::isnan(row.path_length));
            if (!same) ++merged.differing;
            if (same || stays(*there, row)) continue;
        }
        taken.insert_or_assign(GeodesicKey(row.a, row.b), row);
    }
    std::vector<StoredGeodesic> rows_taken;
    for (auto& [key, row] : taken) rows_taken.push_back(std::move(row));
    store.put_geodesics(rows_taken);
}

template <int Dim>
long solve_shard(const ShardPlan& plan, int shard, const ResultStore& store, ShardWriter& out, const MemoryPlan& memory,
                 Progress& progress, long& failed) {
    std::set<GeodesicKey> done;
    for (const StoredGeodesic& row : out.before()) done.emplace(row.a, row.b);
    std::vector<std::vector<GeodesicKey>> tiles;
    long total = 0, missing = 0, solved = 0;
    for (const Tile& tile : plan.tiles) {
        if (tile.shard != shard) continue;
        std::vector<GeodesicKey> keys = plan.missing_of(tile);
        total += static_cast<long>(keys.size());
        std::erase_if(keys, [&](const GeodesicKey& key) { return done.contains(key); });
        missing += static_cast<long>(keys.size());
        if (!keys.empty()) tiles.push_back(std::move(keys));
    }
    progress.begin_pairs(total, total - missing, missing, memory.pairs_in_flight);
    const auto stop = [] { return StopSignals::caught() != 0; };
    tbb::task_arena arena(memory.pairs_in_flight);
    std::atomic<long> solved_now{0}, failed_now{0};
    for (const auto& keys : tiles) {
        ShapeCache<Dim> shapes(store, memory.shapes);  // those of the tile are read once
        arena.execute([&] {
            for_each_whole(keys.size(), [&](std::size_t k) {
                if (stop()) return;
                const StoredGeodesic row =
                    solve_pair<Dim>(shapes.get(keys[k].first), shapes.get(keys[k].second), plan.geodesic, stop);
                if (row.failure.empty() && row.termination == Termination::cancelled) return;
                out.append(row);
                ++solved_now;
                if (!row.problem().empty()) ++failed_now;
                progress.pair_done(row.problem().empty(), row.seconds);
            });
        });
        if (stop()) break;
    }
    progress.end_pairs();
    solved = solved_now;
    failed = failed_now;
    for (const StoredGeodesic& row : out.before()) failed += row.problem().empty() ? 0 : 1;
    return solved;
}

}  // namespace

int plan(const ShardOptions& options) {
    const StudyFolder folder(fs::absolute(options.study).lexically_normal());
    expect_store(folder.store());
    const StudyLock lock(folder);
    ResultStore store(folder.store(), ResultStore::Access::write);
    refuse_unfinished_reading(store);
    const RunSettings settings = settings_of_study(store);
    const StudyRounds rounds = rounds_of(store, settings);
    const GeodesicOptions& geodesic = rounds.screened() ? rounds.levels[rounds.screening.level] : settings.geodesic;
    store.put_settings(settings_hash(geodesic), canonical_text(geodesic));
    std::optional<std::set<GeodesicKey>> only;
    if (rounds.screened()) only = rounds.missing(settings.pairs.both_directions);
    long missing = 0;
    const ShardPlan plan =
        make_plan(store, settings, geodesic, only, store.fact("dimension") == "3" ? 3 : 2, options.shards, missing);
    Summary summary;
    const fs::path shards = folder.path() / "shards";
    std::error_code error;
    fs::create_directories(shards, error);
    if (error) throw StoreError(shards, "cannot be made: " + error.message());
    write_plan(plan, store, shards / "plan.sqlite");
    summary.data = {{"study", folder.path().string()},
                    {"plan", (shards / "plan.sqlite").string()},
                    {"id", plan.id},
                    {"shards", plan.shards},
                    {"tiles", plan.tiles.size()},
                    {"pairs", missing},
                    {"megabytes_per_shard", shard_megabytes(plan)}};
    summary.lines.push_back(std::to_string(missing) + (missing == 1 ? " geodesic" : " geodesics") + " to compute in " +
                            std::to_string(plan.tiles.size()) + " tiles and " + std::to_string(plan.shards) +
                            " shards; plan: " + (shards / "plan.sqlite").string());
    if (rounds.screened()) {
        summary.data["level"] = geodesic.level;
        summary.lines.push_back("This is a round of a screening (level " + std::to_string(geodesic.level) +
                                "); after merge, plan the next one, until merge says that all pairs are there");
    }
    if (options.format == "slurm") {
        folder.write("shards/shards.slurm", slurm_script(plan, shards, folder.path()));
        summary.data["script"] = (shards / "shards.slurm").string();
        summary.lines.push_back("Hand it in with: sbatch " + shell_word((shards / "shards.slurm").string()));
    } else if (options.format == "makeflow") {
        fs::remove(shards / "morphodesic", error);  // it may be running: a new file, not new bytes in the old one
        fs::copy_file(this_program(), shards / "morphodesic", error);
        if (error) throw StoreError(shards / "morphodesic", "cannot be written: " + error.message());
        remove_stale_logs(plan, shards);
        folder.write("shards/shards.makeflow", makeflow_text(plan));
        summary.data["script"] = (shards / "shards.makeflow").string();
        summary.lines.push_back("Compute it with: cd " + shell_word(shards.string()) +
                                " && makeflow -T local shards.makeflow");
    } else {
        summary.lines.push_back("Compute each with: morphodesic shard " + shell_word(folder.path().string()) + " I/" +
                                std::to_string(plan.shards));
    }
    summary.lines.push_back("Then: morphodesic merge " + shell_word(folder.path().string()));
    std::vector<StudyFailure> damaged;  // their pairs are not in the plan
    for (const StoredShape& shape : store.shapes()) {
        if (shape.damaged) damaged.push_back({shape.name, "", shape.problem});
    }
    summary.add_failures(damaged);
    return summary.print(options.common);
}

int shard(const ShardOptions& options) {
    const auto shard = shard_number(options.shard);
    const int number = shard.first, count = shard.second;
    const int threads = thread_count(options.common);
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    const fs::path file = fs::is_directory(options.study) ? options.study / "shards" / "plan.sqlite" : options.study;
    if (!fs::exists(file)) {
        throw std::invalid_argument(file.string() +
                                    ": there is no plan here; make one with: morphodesic plan STUDY "
                                    "--shards N");
    }
    const ResultStore store(file, ResultStore::Access::read);
    const ShardPlan plan = read_plan(store);
    if (count != plan.shards) {
        throw std::invalid_argument(options.shard + ": the plan has " + std::to_string(plan.shards) + " shards");
    }
    const GeodesicOptions& geodesic = plan.geodesic;
    std::vector<SolidReach> reaches;
    if (plan.dimension == 3) {
        for (const auto& shape : plan.shapes) reaches.push_back(reach_of(store.level_set<3>(shape.first)));
    }
    const MemoryPlan memory =
        plan_memory(options.memory, plan.dimension, geodesic.level, shape_level(plan.dimension, plan.settings.geodesic),
                    geodesic.time_steps, plan.shapes.size(), threads,
                    [&](int level) { return largest_window_share(reaches, level, geodesic.align == "rigid"); });
    Progress progress(Progress::style_of_stderr(options.common.quiet));
    progress.message(memory.sentence());
    const fs::path result =
        options.out.empty() ? fs::absolute(file).parent_path() / plan.result_name(number) : options.out;
    ShardWriter out(result, settings_hash(geodesic));
    long failed = 0;
    const long solved = with_dimension(plan.dimension, [&]<int Dim>() {
        return solve_shard<Dim>(plan, number, store, out, memory, progress, failed);
    });
    if (StopSignals::caught() != 0) {
        return stopped_by_signal("; what is finished is in " + result.string());
    }
    Summary summary;
    summary.data = {{"result", result.string()},
                    {"pairs_computed", solved},
                    {"pairs_from_file", out.before().size()},
                    {"pairs_failed", failed}};
    summary.lines.push_back("shard " + options.shard + ": " + std::to_string(solved) + " pairs computed, " +
                            std::to_string(out.before().size()) + " were in " + result.string());
    if (failed > 0) {
        if (!options.accept_failures) summary.exit_code = some_failed;
        summary.lines.push_back(std::to_string(failed) + " of them have no trustworthy distance; merge lists them");
    }
    return summary.print(options.common);
}

int merge(const ShardOptions& options) {
    const StudyFolder folder(options.study);
    expect_store(folder.store());
    const StudyLock lock(folder);
    ResultStore store(folder.store(), ResultStore::Access::write);
    std::vector<fs::path> files = options.files;
    if (files.empty() && fs::is_directory(folder.path() / "shards")) {
        for (const auto& entry : fs::directory_iterator(folder.path() / "shards")) {
            if (entry.path().extension() == ".jsonl") files.push_back(entry.path());
        }
    }
    if (files.empty()) {
        throw std::invalid_argument(folder.path().string() +
                                    ": there are no results of shards; compute them with: morphodesic shard STUDY I/N, "
                                    "or name the files");
    }
    std::sort(files.begin(), files.end());
    std::set<std::string> digests;
    for (const StoredShape& shape : store.shapes()) digests.insert(shape.content_digest);

    Summary summary;
    std::vector<StudyFailure> problems;
    std::vector<std::pair<std::string, std::string>> left_out;  // and what to do if it is missing
    long added = 0, known = 0;
    std::size_t usable = 0;
    for (const fs::path& file : files) {
        const ShardResults results = read_shard_results(file);
        if (!results.problem.empty()) {
            problems.push_back({file.string(), "", results.problem});
            continue;
        }
        MergedRows merged;
        long of_others = 0;
        bool any_known = false;
        for (const auto& [settings, rows] : results.rows) {
            if (store.settings(settings)) {
                any_known = true;
                merge_rows(rows, settings, digests, store, merged);
            } else {
                of_others += static_cast<long>(rows.size());
            }
        }
        if (!any_known) {
            problems.push_back({file.string(), "",
                                file.string() + ": was computed for settings that this study never had; merge it into "
                                                "the study it was planned for"});
            continue;
        }
        ++usable;
        added += merged.added;
        known += merged.known;
        if (results.damaged > 0) {
            left_out.emplace_back(file.string() + ": " + counted(results.damaged, "damaged line") + " left out",
                                  "run the shard again, it computes only what is missing");
        }
        if (of_others > 0) {
            left_out.emplace_back(
                file.string() + ": " + counted(of_others, "result", " of other settings") + " left out",
                "merge them into the study they were computed for");
        }
        if (results.of_other_version > 0) {
            left_out.emplace_back(
                file.string() + ": " +
                    counted(results.of_other_version, "result", " of another version of the program") + " left out",
                "compute them again with the same program as the study");
        }
        if (merged.strangers > 0) {
            problems.push_back({file.string(), "",
                                file.string() + ": " + counted(merged.strangers, "pair") +
                                    " left out, of shapes that the study does not have"});
        }
        if (merged.differing > 0) {
            problems.push_back({file.string(), "",
                                file.string() + ": " + std::to_string(merged.differing) +
                                    (merged.differing == 1 ? " pair has" : " pairs have") +
                                    " another path length than the store; of each the shorter path stays. "
                                    "Were the shards computed by different builds? `morphodesic verify` tells more"});
        }
    }
    const StudyData data = load_study(store);
    summary.data = {{"study", folder.path().string()},
                    {"files", files.size()},
                    {"pairs_added", added},
                    {"pairs_known", known},
                    {"pairs_missing", data.pairs_missing}};
    summary.lines.push_back(std::to_string(files.size()) + (files.size() == 1 ? " file: " : " files: ") +
                            counted(added, "geodesic") + " added, " + std::to_string(known) +
                            (known == 1 ? " was" : " were") + " in the store");
    if (data.pairs_missing > 0) {
        summary.add_shortfall(std::to_string(data.pairs_missing) +
                              (data.pairs_missing == 1 ? " pair is still missing" : " pairs are still missing") +
                              (data.levels.size() > 1 ? " in this round of the screening; plan it with: morphodesic "
                                                        "plan " +
                                                            shell_word(folder.path().string()) + " --shards N"
                                                      : ""));
    } else {
        summary.lines.push_back("All pairs are there. Report: morphodesic report " +
                                shell_word(folder.path().string()));
    }
    // A workflow ends well with a complete round of a screening, though another one may follow.
    const bool round_there = data.levels.size() > 1 && plan_is_done(folder.path() / "shards" / "plan.sqlite", store);
    // What a line that was left out held may have come from the same shard run again: then nothing is missing, nothing
    // to do.
    const bool complete = data.pairs_missing == 0 || round_there;
    for (const auto& [what, remedy] : left_out) {
        if (complete) {
            summary.add_remark(what + "; all pairs are there all the same");
        } else {
            problems.push_back({"", "", what + "; " + remedy});
        }
    }
    const bool all_there = problems.empty() && complete;
    for (const StudyFailure& failure : data.failures) problems.push_back(failure);
    summary.add_failures(problems);
    if (all_there && options.accept_failures) summary.exit_code = all_done;
    if (usable == 0) summary.exit_code = bad_usage;
    return summary.print(options.common);
}

}  // namespace morphodesic::pipeline

#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/study.h"
#include "pipeline/run_settings.h"

namespace morphodesic::pipeline {

/// How the program ends; also the exit code of the process. After a stop by a signal it is 128 + the signal's number.
enum ExitCode { all_done = 0, some_failed = 1, bad_usage = 2, environment_failed = 3 };

struct CommonOptions {
    bool json = false;   ///< print the summary as one JSON object on standard output
    bool quiet = false;  ///< no progress and no summary in words
    int threads = 0;     ///< 0: as many as the process may use
};

/// Options of run, ingest, geodesics, analyze, report and verify; each uses some of them.
struct StudyOptions {
    CommonOptions common;
    std::filesystem::path collection;  ///< folder of shapes: run, ingest
    std::filesystem::path study;       ///< study folder; empty: beside the collection
    RunSettings settings;
    std::string memory;         ///< run, geodesics: limit such as 4G; empty: 80 % of what is available
    bool retry_failed = false;  ///< compute pairs anew that failed before
    std::string paths = "12";   ///< none | nearest | all | a number: which paths are drawn, see choose_paths
    analysis::AnalysisOptions analysis;
    std::filesystem::path compare;  ///< analyze, report: another study or table to set beside this one; empty: none
    std::filesystem::path labels;   ///< analyze, report: table file,label that overrules the classes; empty: none
    std::filesystem::path errors;   ///< analyze, report of a table: table of its error bars; empty: none
    bool asymmetric = false;        ///< analyze, report of a table: its two sides are both directions
    std::filesystem::path
        place;                  ///< analyze, report: distances of further shapes, to be placed in the maps; empty: none
    std::filesystem::path out;  ///< analyze, report of a table: folder for the results; empty: beside the table
    int sample = 10;            ///< verify: pairs that are computed again
    unsigned seed = 1;          ///< verify: which ones
    std::string command;        ///< for the report: the command that repeats the study
};

/// Options of geodesic A B.
struct PairOptions {
    CommonOptions common;
    std::filesystem::path a, b;
    std::filesystem::path out;       ///< folder for the pictures; empty: none are written
    double scale = 0.0;              ///< for normalize common: cube units per file unit; 0: the larger shape just fits
    std::string direction = "auto";  ///< which end the path is computed from: auto, as studies choose; given: a
    RunSettings settings;
};

/// Options of plan, shard and merge; each uses some of them.
struct ShardOptions {
    CommonOptions common;
    std::filesystem::path study;               ///< study folder; shard: or the plan itself
    int shards = 0;                            ///< plan: how many
    std::string format = "list";               ///< plan: list | slurm | makeflow
    std::string shard;                         ///< shard: "I/N"
    std::string memory;                        ///< shard: limit such as 4G; empty: 80 % of what is available
    std::filesystem::path out;                 ///< shard: result file; empty: beside the plan
    bool accept_failures = false;              ///< shard, merge: exit code 0 also if pairs failed
    std::vector<std::filesystem::path> files;  ///< merge: result files; empty: all beside the plan
};

// One function per subcommand: options in; summary on standard output, progress on standard error, exit code out.
int run(const StudyOptions& options);
int ingest(const StudyOptions& options);
int geodesics(const StudyOptions& options);
int analyze(const StudyOptions& options);
int report(const StudyOptions& options);
int verify(const StudyOptions& options);
int geodesic(const PairOptions& options);
int plan(const ShardOptions& options);
int shard(const ShardOptions& options);
int merge(const ShardOptions& options);

/// The settings a study was made with; empty text if it has none yet.
[[nodiscard]] std::string stored_settings(const std::filesystem::path& study);

}  // namespace morphodesic::pipeline

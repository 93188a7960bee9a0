#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pipeline/commands.h"
#include "pipeline/study_data.h"

namespace morphodesic::pipeline {

/// What a command did: lines for people, an object for scripts, and the exit code.
struct Summary {
    int exit_code = all_done;
    std::vector<std::string> lines;
    nlohmann::ordered_json data = nlohmann::ordered_json::object();
    std::vector<StudyFailure>
        cut_off;  ///< found by the analysis: shapes that no chain of distances joins to the others

    /// Something worth knowing: a line, and an entry of "remarks" in the JSON object.
    void add_remark(const std::string& remark);
    /// The same for something that is lacking, which makes the exit code 1.
    void add_shortfall(const std::string& sentence);
    /// What was done to the files: files with the same notes in one line, the first twenty lines; in full as "notes" in
    /// the JSON object.
    void add_notes(const std::vector<StoredShape>& shapes);
    /// Says how many pairs of the study have no result yet, but for those whose damaged results are failures of their
    /// own.
    void add_missing_pairs(const StudyData& study, const std::filesystem::path& folder);
    /// Lists failures, then the shapes that are cut off, in words (the first twenty) and in full in the JSON object;
    /// makes the exit code 1 if there are any.
    void add_failures(std::vector<StudyFailure> failures);
    /// Prints lines or JSON as the options want it and returns the exit code.
    int print(const CommonOptions& options);

private:
    std::vector<std::string> shortfalls_;
};

/// Says that a signal stopped the command, and in what state; returns the exit code.
/// @param again  the command to go on with; empty: "the same command"
int stopped_by_signal(const std::string& state, const std::string& again = "");

/// A word of a command line as a shell takes it.
[[nodiscard]] std::string shell_word(const std::string& word);

/// Number of threads that --threads N means. @throws std::runtime_error if the system does not let them start
[[nodiscard]] int thread_count(const CommonOptions& options);

}  // namespace morphodesic::pipeline

#pragma once

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

    /// Lists failures in words (the first twenty) and in full in the JSON object; makes the exit code 1 if there are
    /// any.
    void add_failures(const std::vector<StudyFailure>& failures);
    /// Prints lines or JSON as the options want it and returns the exit code.
    int print(const CommonOptions& options);
};

/// Number of threads that --threads N means.
[[nodiscard]] int thread_count(const CommonOptions& options);

}  // namespace morphodesic::pipeline

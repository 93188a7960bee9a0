#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "analysis/classify.h"
#include "analysis/evaluation.h"
#include "pipeline/classify_options.h"
#include "pipeline/study_data.h"

namespace morphodesic::pipeline {

/// A template in the answer to a query.
struct TemplateRow {
    std::string name, label;
    double distance = 0.0, error = 0.0;
    bool refined = false;  ///< solved on the finest level; else estimated by the screening
    int level = 0, time_steps = 0;
    double turn = 0.0, scale = 1.0;  ///< alignment: degrees, change of size
    std::string hypothesis;
    double hidden_share = 0.0;  ///< of the template's area (volume)
};

/// One query and what was found.
struct QueryResult {
    std::string name, truth;  ///< truth: class, empty if unknown
    std::string mask;         ///< "none", "known" or "estimated"
    std::string problem;      ///< why the query could not be used; empty if it could
    analysis::Classification answer;
    std::vector<TemplateRow> templates;  ///< nearest first
    std::vector<std::string> notes;
    double seconds = 0.0;
};

/// A run of `classify`.
struct ClassificationRun {
    std::string templates;  ///< folder or study
    std::size_t template_count = 0;
    std::vector<std::string> classes;  ///< alphabetical
    ClassifyOptions options;
    GeodesicOptions geodesic;
    std::string normalize, preset, mask;
    std::vector<QueryResult> queries;
    std::optional<analysis::Calibration> calibration;
    std::optional<analysis::Retrieval> retrieval;  ///< of leave-one-out
    std::vector<std::string> remarks;
    std::vector<StudyFailure> failures;
    double seconds = 0.0;  ///< of the queries, wall clock

    // Filled by evaluate().
    long labelled = 0;         ///< queries of the templates' classes
    long labelled_failed = 0;  ///< more of these classes that could not be used, not among the labelled
    long right = 0;
    long accepted = 0, accepted_right = 0;   ///< of these
    long foreign = 0, foreign_rejected = 0;  ///< queries of no template's class
    std::optional<analysis::ConfusionMatrix> confusion;
    std::optional<analysis::Reliability> reliability;  ///< of the answers to labelled queries

    void evaluate();
};

/// One object with `accuracy` (null without labels) and `queries`; see reports/FORMAT.md.
[[nodiscard]] nlohmann::ordered_json to_json(const ClassificationRun& run);

/// One row per query.
[[nodiscard]] std::string queries_csv(const ClassificationRun& run);
/// One row per query and template.
[[nodiscard]] std::string ranking_csv(const ClassificationRun& run);

}  // namespace morphodesic::pipeline

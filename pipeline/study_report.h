#pragma once

#include <string>
#include <utility>
#include <vector>

#include "analysis/study.h"
#include "pipeline/study_data.h"
#include "reports/report_model.h"

namespace morphodesic::pipeline {

/// The numbers of a study, analysed: everything of the report but pictures and paths. Shapes that no chain of known
/// distances joins to the others stand among the failures, not among the shapes.
struct AnalysedStudy {
    reports::ReportModel model;
    analysis::AnalysisResult analysis;  ///< kept[i]: number in StudyData::shapes of shape i of the model
};
[[nodiscard]] AnalysedStudy analyse_study(const StudyData& data, const analysis::AnalysisOptions& options);

/// Pairs whose paths are worth a look, best first: between the medoids of the classes (else clusters), the nearest and
/// the farthest pair, then every shape with its nearest neighbour. Numbers of model shapes, a < b, no pair twice; only
/// pairs with a distance > 0.
/// @param choice  none | nearest | all | a number, see path_choice_problem
/// @throws std::invalid_argument for another word
[[nodiscard]] std::vector<std::pair<int, int>> choose_paths(const reports::ReportModel& model,
                                                            const std::string& choice);

/// What is wrong with a choice of paths; empty if it can be used.
[[nodiscard]] std::string path_choice_problem(const std::string& choice);

}  // namespace morphodesic::pipeline

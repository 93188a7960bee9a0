#pragma once

#include "pipeline/commands.h"
#include "pipeline/progress.h"
#include "pipeline/result_store.h"
#include "pipeline/study_data.h"
#include "pipeline/study_folder.h"
#include "pipeline/study_report.h"

namespace morphodesic::pipeline {

struct Summary;

/// distances.csv, distances.npy, pairs.csv, shapes.csv, clusters.csv, linkage.csv, embedding.csv, accuracy.csv: see
/// reports/FORMAT.md. Rows are sorted by name, doubles read back exactly, and distances.csv holds nothing that differs
/// from run to run. Of a given table neither pairs.csv nor shapes.csv; placed.csv where queries were placed in the
/// maps.
[[nodiscard]] RunFiles tables_of(const StudyData& data, const AnalysedStudy& analysed);

/// paths/, then the tables, report.json and report.html together, then figures/.
/// @param summary  receives where the report is and how well the distances know the classes
/// @return false if a signal stopped it: then the tables and the report are those of before
[[nodiscard]] bool export_report(const StudyData& data, ResultStore& store, const StudyFolder& folder,
                                 const StudyOptions& options, Progress& progress, Summary& summary);

/// The tables, report.json, report.html and figures/ of a complete model; the summary is told where they are.
void write_report(RunFiles tables, const reports::ReportModel& model, const StudyFolder& folder, Summary& summary);

/// What only some analyses have: another study or table beside this one (ReportModel::compare), and further shapes
/// placed in the maps (ReportModel::placed).
/// @throws analysis::ParseError if a table that the options name cannot be used
void add_findings(const StudyData& data, const StudyOptions& options, AnalysedStudy& analysed, Summary& summary);

/// Says in the summary how well the distances know the classes, how many clusters there are, and which shapes are cut
/// off from the others.
void summarise(const reports::ReportModel& model, Summary& summary);

}  // namespace morphodesic::pipeline

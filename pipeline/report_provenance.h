#pragma once

#include "pipeline/commands.h"
#include "pipeline/result_store.h"
#include "pipeline/study_data.h"
#include "pipeline/study_folder.h"
#include "reports/report_model.h"

namespace morphodesic::pipeline {

/// Where a study comes from, its settings and versions, the command that repeats it, and what lies beside its report.
void add_provenance(const StudyData& data, const ResultStore& store, const StudyFolder& folder,
                    const analysis::AnalysisOptions& options, reports::ReportModel& model);

/// The same for a table of distances.
void add_provenance_of_table(const StudyOptions& options, const StudyFolder& folder, reports::ReportModel& model);

}  // namespace morphodesic::pipeline

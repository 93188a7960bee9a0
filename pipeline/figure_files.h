#pragma once

#include "pipeline/study_folder.h"
#include "reports/report_model.h"

namespace morphodesic::pipeline {

/// figures/: every figure of the report as SVG, PDF and PNG (twice the size on the screen). Files of an earlier report
/// that show the same are left as they are, those of figures that there are no longer are removed.
/// @throws StoreError if the folder may not be written
void write_figures(const reports::ReportModel& model, const StudyFolder& folder);

}  // namespace morphodesic::pipeline

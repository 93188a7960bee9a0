#pragma once

#include <optional>

#include "analysis/study.h"
#include "pipeline/study_data.h"
#include "reports/report_model.h"

namespace morphodesic::pipeline {

/// Clustering by volume (area) alone beside that by geodesic distance: average linkage of the differences, cut into as
/// many clusters. Nothing if there are fewer than three shapes, or if their volumes differ by less than 1 % (they were
/// made equal, or are).
[[nodiscard]] std::optional<reports::VolumeComparison> compare_with_volumes(const StudyData& data,
                                                                            const analysis::AnalysisResult& analysed);

}  // namespace morphodesic::pipeline

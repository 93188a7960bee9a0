#pragma once

#include <optional>

#include "analysis/study.h"
#include "pipeline/study_data.h"
#include "reports/report_model.h"

namespace morphodesic::pipeline {

/// Volumes (areas) that differ by no more than this share are equal: they were made so, or are.
inline constexpr double equal_volumes = 0.01;

/// (largest - smallest) / largest volume of the analysed shapes; unknown where one has none.
[[nodiscard]] double volume_spread(const StudyData& data, const analysis::AnalysisResult& analysed);

/// Clustering by volume (area) alone beside that by geodesic distance: average linkage of the differences, cut into as
/// many clusters. Nothing if there are fewer than three shapes, or if their volumes are equal.
[[nodiscard]] std::optional<reports::VolumeComparison> compare_with_volumes(const StudyData& data,
                                                                            const analysis::AnalysisResult& analysed);

}  // namespace morphodesic::pipeline

#pragma once

#include <string>

#include "pipeline/study_data.h"
#include "reports/report_model.h"

namespace morphodesic::pipeline {

/// Two studies side by side, shapes matched by name: agreement of the distances, shapes whose neighbours moved, and the
/// settings in which they differ (none for given tables).
/// @param other_name  of the other study, for the reader
/// @param neighbours  k of the overlaps, >= 1
[[nodiscard]] reports::Comparison compare_studies(const StudyData& here, const StudyData& there,
                                                  const std::string& other_name, int neighbours);

}  // namespace morphodesic::pipeline

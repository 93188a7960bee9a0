#pragma once

#include <string>
#include <vector>

#include "reports/report_model.h"

namespace morphodesic::reports {

/// Version of the schema of report.json, see reports/FORMAT.md.
inline constexpr int report_schema = 1;

/// Every inconsistency of a model (array of a wrong length, shape number out of range), in words; empty if usable.
[[nodiscard]] std::vector<std::string> problems(const ReportModel& model);

/// report.json: stable key order, doubles that survive the round trip, null for unknown. Without pictures.
/// @throws std::invalid_argument with the first of problems(model), if any
[[nodiscard]] std::string to_json(const ReportModel& model);

/// report.html: one self-contained file that opens from disk and asks no network for anything.
/// @throws std::invalid_argument with the first of problems(model), if any
[[nodiscard]] std::string render_html(const ReportModel& model);

}  // namespace morphodesic::reports

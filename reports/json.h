#pragma once

#include <nlohmann/json.hpp>

#include "reports/report_model.h"

namespace morphodesic::reports {

/// The model as JSON with the keys of reports/FORMAT.md, in a fixed order.
/// @param digits  significant digits of the numbers in long arrays; 0: all that the round trip needs
[[nodiscard]] nlohmann::ordered_json model_json(const ReportModel& model, int digits = 0);

/// One path of the model; frames without their pictures.
[[nodiscard]] nlohmann::ordered_json path_json(const PathReport& path);

}  // namespace morphodesic::reports

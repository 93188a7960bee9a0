#pragma once

#include <cmath>
#include <nlohmann/json.hpp>

namespace morphodesic::reports {

/// A number as JSON has it: null for what is infinite or not known.
[[nodiscard]] inline nlohmann::ordered_json json_number(double value) {
    return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

}  // namespace morphodesic::reports

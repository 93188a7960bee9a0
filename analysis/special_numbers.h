#pragma once

#include <limits>

namespace morphodesic::analysis {

/// No bound, and no value: a pair without a trustworthy distance.
inline constexpr double infinity = std::numeric_limits<double>::infinity(),
                        nan = std::numeric_limits<double>::quiet_NaN();

}  // namespace morphodesic::analysis

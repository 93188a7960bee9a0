#pragma once

#include <cstddef>

namespace morphodesic::analysis {

/// c[j] = min(c[j], a + b[j]) for n entries; b and c do not overlap unless they are the same row.
void min_plus_update(std::size_t n, double a, const double* b, double* c);

struct SumsBelow {
    std::size_t count;  ///< indices k with a[k] + b[k] < limit
    double smallest;    ///< min over k of a[k] + b[k]; +infinity for n = 0
};
[[nodiscard]] SumsBelow sums_below(std::size_t n, const double* a, const double* b, double limit);

}  // namespace morphodesic::analysis

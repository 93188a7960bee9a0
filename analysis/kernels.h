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

/// One row of a Guttman transform, n other points in 2 or 3 dimensions stored axis by axis.
struct GuttmanRow {
    double sum[3];   ///< sum_j target_j / |x - x_j| (x - x_j), terms with x = x_j left out
    double misfit;   ///< sum_j (|x - x_j| - target_j)^2
    double squares;  ///< sum_j |x - x_j|^2
};
/// @param axes  2 or 3 arrays of n coordinates; @param x the point itself; @param target n disparities
/// The order of the sums follows the width of the processor's vectors.
[[nodiscard]] GuttmanRow guttman_row_2d(std::size_t n, const double* const axes[2], const double x[2],
                                        const double* target);
[[nodiscard]] GuttmanRow guttman_row_3d(std::size_t n, const double* const axes[3], const double x[3],
                                        const double* target);

}  // namespace morphodesic::analysis

#include "analysis/kernels.h"

#include <cmath>
#include <cstdint>
#include <limits>

// min_plus_update and sums_below: the same bits on every processor, whichever clone runs.
#if defined(MORPHODESIC_NO_CLONES) || !defined(__x86_64__)
#define MORPHODESIC_ANALYSIS_CLONES
#else
#define MORPHODESIC_ANALYSIS_CLONES __attribute__((target_clones("default", "avx2", "avx512f")))
#endif

namespace morphodesic::analysis {

MORPHODESIC_ANALYSIS_CLONES
void min_plus_update(std::size_t n, double a, const double* b, double* c) {
#pragma omp simd
    for (std::size_t j = 0; j < n; ++j) {
        const double sum = a + b[j];
        c[j] = sum < c[j] ? sum : c[j];
    }
}

MORPHODESIC_ANALYSIS_CLONES
SumsBelow sums_below(std::size_t n, const double* a, const double* b, double limit) {
    std::int64_t count = 0;
    double smallest = std::numeric_limits<double>::infinity();
#pragma omp simd reduction(+ : count) reduction(min : smallest)
    for (std::size_t k = 0; k < n; ++k) {
        const double sum = a[k] + b[k];
        count += sum < limit ? 1 : 0;
        smallest = sum < smallest ? sum : smallest;
    }
    return {static_cast<std::size_t>(count), smallest};
}

MORPHODESIC_ANALYSIS_CLONES
GuttmanRow guttman_row_2d(std::size_t n, const double* const axes[2], const double x[2], const double* target) {
    const double *x0 = axes[0], *x1 = axes[1];
    const double p0 = x[0], p1 = x[1];
    double s0 = 0.0, s1 = 0.0, misfit = 0.0, squares = 0.0;
#pragma omp simd reduction(+ : s0, s1, misfit, squares)
    for (std::size_t j = 0; j < n; ++j) {
        const double a = p0 - x0[j], b = p1 - x1[j];
        const double square = a * a + b * b, length = std::sqrt(square), difference = length - target[j];
        const double divisor = length > 0.0 ? length : 1.0, ratio = target[j] / divisor;  // a = b = 0 where length is 0
        s0 += ratio * a;
        s1 += ratio * b;
        misfit += difference * difference;
        squares += square;
    }
    return {{s0, s1, 0.0}, misfit, squares};
}

MORPHODESIC_ANALYSIS_CLONES
GuttmanRow guttman_row_3d(std::size_t n, const double* const axes[3], const double x[3], const double* target) {
    const double *x0 = axes[0], *x1 = axes[1], *x2 = axes[2];
    const double p0 = x[0], p1 = x[1], p2 = x[2];
    double s0 = 0.0, s1 = 0.0, s2 = 0.0, misfit = 0.0, squares = 0.0;
#pragma omp simd reduction(+ : s0, s1, s2, misfit, squares)
    for (std::size_t j = 0; j < n; ++j) {
        const double a = p0 - x0[j], b = p1 - x1[j], c = p2 - x2[j];
        const double square = a * a + b * b + c * c, length = std::sqrt(square), difference = length - target[j];
        const double divisor = length > 0.0 ? length : 1.0, ratio = target[j] / divisor;
        s0 += ratio * a;
        s1 += ratio * b;
        s2 += ratio * c;
        misfit += difference * difference;
        squares += square;
    }
    return {{s0, s1, s2}, misfit, squares};
}

}  // namespace morphodesic::analysis

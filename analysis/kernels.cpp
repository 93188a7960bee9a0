#include "analysis/kernels.h"

#include <cstdint>
#include <limits>

// Only sums, comparisons and minima: the bits are the same on every processor, whichever clone runs.
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

}  // namespace morphodesic::analysis

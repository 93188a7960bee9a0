#include "geodesic/kernels/vector_kernels.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <vector>

namespace morphodesic::kernels {

namespace {

constexpr std::size_t chunk = 8192;

// Compiled for several instruction sets, the best one is taken at run time; products and sums are not fused, so the
// bits are the same. Sanitizers cannot be loaded before the resolvers of clones run.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define MORPHODESIC_CLONES __attribute__((target_clones("default", "avx2", "avx512f")))
#else
#define MORPHODESIC_CLONES
#endif

MORPHODESIC_CLONES double dot_chunk(const double* a, const double* b, std::size_t n) {
    double sums[16] = {};
    std::size_t i = 0;
    for (; i + 16 <= n; i += 16) {
        for (std::size_t j = 0; j < 16; ++j) sums[j] += a[i + j] * b[i + j];
    }
    double sum = 0.0;
    for (; i < n; ++i) sum += a[i] * b[i];
    for (const double s : sums) sum += s;
    return sum;
}

MORPHODESIC_CLONES double dot_chunk(const double* a, const float* b, std::size_t n) {
    double sums[16] = {};
    std::size_t i = 0;
    for (; i + 16 <= n; i += 16) {
        for (std::size_t j = 0; j < 16; ++j) sums[j] += a[i + j] * static_cast<double>(b[i + j]);
    }
    double sum = 0.0;
    for (; i < n; ++i) sum += a[i] * static_cast<double>(b[i]);
    for (const double s : sums) sum += s;
    return sum;
}

MORPHODESIC_CLONES void add_scaled_chunk(double* y, double factor, const float* x, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) y[i] += factor * static_cast<double>(x[i]);
}

MORPHODESIC_CLONES void step_chunk(double* out, const double* x, double factor, const double* d, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) out[i] = x[i] + factor * d[i];
}

MORPHODESIC_CLONES void difference_chunk(float* out, const double* a, const double* b, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) out[i] = static_cast<float>(a[i] - b[i]);
}

template <class Body>
void for_chunks(std::size_t size, const Body& body) {
    const std::size_t count = (size + chunk - 1) / chunk;
    const auto run = [&](std::size_t c) { body(c, c * chunk, std::min(size, (c + 1) * chunk)); };
    if (count <= 4) {
        for (std::size_t c = 0; c < count; ++c) run(c);
        return;
    }
    oneapi::tbb::this_task_arena::isolate([&] { oneapi::tbb::parallel_for(std::size_t{0}, count, run); });
}

template <class A, class B>
double dot_of(std::span<const A> a, std::span<const B> b) {
    assert(a.size() == b.size());
    std::vector<double> partial((a.size() + chunk - 1) / chunk, 0.0);
    for_chunks(a.size(), [&](std::size_t c, std::size_t begin, std::size_t end) {
        partial[c] = dot_chunk(a.data() + begin, b.data() + begin, end - begin);
    });
    double total = 0.0;
    for (const double p : partial) total += p;
    return total;
}

}  // namespace

double dot(std::span<const double> a, std::span<const double> b) {
    return dot_of(a, b);
}
double dot(std::span<const double> a, std::span<const float> b) {
    return dot_of(a, b);
}

void add_scaled(std::span<double> y, double factor, std::span<const float> x) {
    for_chunks(y.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
        add_scaled_chunk(y.data() + begin, factor, x.data() + begin, end - begin);
    });
}

void step(std::span<double> out, std::span<const double> x, double factor, std::span<const double> d) {
    for_chunks(out.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
        step_chunk(out.data() + begin, x.data() + begin, factor, d.data() + begin, end - begin);
    });
}

void difference(std::span<float> out, std::span<const double> a, std::span<const double> b) {
    for_chunks(out.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
        difference_chunk(out.data() + begin, a.data() + begin, b.data() + begin, end - begin);
    });
}

void scale(std::span<double> y, double factor) {
    for_chunks(y.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) y[i] *= factor;
    });
}

}  // namespace morphodesic::kernels

#include "geodesic/kernels/vector_kernels.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <vector>

namespace morphodesic::kernels {

namespace {

constexpr std::size_t chunk = 4096;  // 16 kB: half of a first-level cache

// Compiled for several instruction sets, the best one is taken at run time; products and sums are not fused, so the
// bits are the same. Sanitizers cannot be loaded before the resolvers of clones run.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define MORPHODESIC_CLONES __attribute__((target_clones("default", "avx2", "avx512f")))
#else
#define MORPHODESIC_CLONES
#endif

MORPHODESIC_CLONES void add_scaled_chunk(float* y, float factor, const HalfFloat* x, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) y[i] += factor * x[i].value();
}

MORPHODESIC_CLONES void scale_chunk(float* out, const float* x, float factor, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) out[i] = factor * x[i];
}

MORPHODESIC_CLONES void step_chunk(double* out, const double* x, double factor, const float* d, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) out[i] = x[i] + factor * static_cast<double>(d[i]);
}

MORPHODESIC_CLONES void difference_chunk(HalfFloat* out, const double* a, const double* b, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) out[i] = HalfFloat(static_cast<float>(a[i] - b[i]));
}

inline float value_of(float v) {
    return v;
}
inline float value_of(HalfFloat v) {
    return v.value();
}

template <class T>
inline __attribute__((always_inline)) double short_dot(const T* a, const HalfFloat* b, std::size_t n) {
    constexpr std::size_t lanes = 32;
    float sums[lanes] = {};
    std::size_t i = 0;
    for (; i + lanes <= n; i += lanes) {
        for (std::size_t j = 0; j < lanes; ++j) sums[j] += value_of(a[i + j]) * b[i + j].value();
    }
    double sum = 0.0;
    for (; i < n; ++i) sum += static_cast<double>(value_of(a[i]) * b[i].value());
    for (const float s : sums) sum += static_cast<double>(s);
    return sum;
}

// Clones cannot be templates.
MORPHODESIC_CLONES double dot_chunk(const float* a, const HalfFloat* b, std::size_t n) {
    return short_dot(a, b, n);
}
MORPHODESIC_CLONES double dot_chunk(const HalfFloat* a, const HalfFloat* b, std::size_t n) {
    return short_dot(a, b, n);
}

MORPHODESIC_CLONES double dot_chunk(const float* a, const float* b, std::size_t n) {
    double sums[16] = {};
    std::size_t i = 0;
    for (; i + 16 <= n; i += 16) {
        for (std::size_t j = 0; j < 16; ++j) sums[j] += static_cast<double>(a[i + j]) * static_cast<double>(b[i + j]);
    }
    double sum = 0.0;
    for (; i < n; ++i) sum += static_cast<double>(a[i]) * static_cast<double>(b[i]);
    for (const double s : sums) sum += s;
    return sum;
}

MORPHODESIC_CLONES void difference_chunk(HalfFloat* out, const float* a, const float* b, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) out[i] = HalfFloat(a[i] - b[i]);
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

/// Least det of I + (edge differences) / h at the corners of the cell at node i, of a field given by its components.
template <int Dim>
inline __attribute__((always_inline)) double least_corner_det(const double* const (&w)[Dim],
                                                              const float* const (*d)[Dim], const Strides<Dim>& stride,
                                                              std::ptrdiff_t i, double inverse_h) {
    double v[Dim][1 << Dim];
#pragma GCC unroll 8
    for (int c = 0; c < (1 << Dim); ++c) {
        std::ptrdiff_t at = i;
#pragma GCC unroll 3
        for (int a = 0; a < Dim; ++a) at += ((c >> a) & 1) * stride[static_cast<std::size_t>(a)];
#pragma GCC unroll 3
        for (int a = 0; a < Dim; ++a) v[a][c] = w[a][at] + (d ? static_cast<double>((*d)[a][at]) : 0.0);
    }
    double least = 1e300;
#pragma GCC unroll 8
    for (int c = 0; c < (1 << Dim); ++c) {
        double m[Dim][Dim];
#pragma GCC unroll 3
        for (int r = 0; r < Dim; ++r) {
#pragma GCC unroll 3
            for (int j = 0; j < Dim; ++j) {
                m[r][j] = (r == j ? 1.0 : 0.0) + (v[r][c | (1 << j)] - v[r][c & ~(1 << j)]) * inverse_h;
            }
        }
        double det;
        if constexpr (Dim == 2) {
            det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
        } else {
            det = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                  m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
        }
        least = least < det ? least : det;  // a NaN in det wins
    }
    return least;
}

template <int Dim>
MORPHODESIC_CLONES int flag_squeezed(std::ptrdiff_t cells, const double* const (&w)[Dim], const float* const (&d)[Dim],
                                     const Strides<Dim>& stride, double inverse_h, double keep,
                                     unsigned char* __restrict flag) {
    int any = 0;
    for (std::ptrdiff_t i = 0; i < cells; ++i) {
        flag[i] = least_corner_det<Dim>(w, &d, stride, i, inverse_h) >= keep ? 0 : 1;
        any |= flag[i];
    }
    if (!any) return 0;
    any = 0;
    for (std::ptrdiff_t i = 0; i < cells; ++i) {
        if (!flag[i]) continue;
        const double before = least_corner_det<Dim>(w, nullptr, stride, i, inverse_h);
        const double after = least_corner_det<Dim>(w, &d, stride, i, inverse_h);
        flag[i] = after >= keep * (before < 1.0 ? before : 1.0) ? 0 : 1;
        any |= flag[i];
    }
    return any;
}

template <int Dim>
MORPHODESIC_CLONES int flag_steep(std::ptrdiff_t cells, const double* __restrict u, const Strides<Dim>& stride,
                                  double limit, unsigned char* __restrict flag) {
    int any = 0;
    for (std::ptrdiff_t i = 0; i < cells; ++i) {
        double least = u[i], most = u[i];
#pragma GCC unroll 8
        for (int c = 1; c < (1 << Dim); ++c) {
            std::ptrdiff_t at = i;
#pragma GCC unroll 3
            for (int a = 0; a < Dim; ++a) at += ((c >> a) & 1) * stride[static_cast<std::size_t>(a)];
            least = u[at] < least ? u[at] : least;
            most = u[at] > most ? u[at] : most;
        }
        const int steep =
            static_cast<int>(least < 0.0) & static_cast<int>(most > 0.0) & static_cast<int>(most - least > limit);
        flag[i] = static_cast<unsigned char>(steep);
        any |= steep;
    }
    return any;
}

template <int Dim, class T>
MORPHODESIC_CLONES int flag_stretched(std::ptrdiff_t cells, const T* const (&w)[Dim], const Strides<Dim>& stride,
                                      T inverse_h, T limit, unsigned char* __restrict flag) {
    int any = 0;
    for (std::ptrdiff_t i = 0; i < cells; ++i) {
        T longest = 0;  // squares, in units of h
#pragma GCC unroll 8
        for (int c = 0; c < (1 << Dim); ++c) {
            std::ptrdiff_t at = i;
#pragma GCC unroll 3
            for (int a = 0; a < Dim; ++a) at += ((c >> a) & 1) * stride[static_cast<std::size_t>(a)];
#pragma GCC unroll 3
            for (int j = 0; j < Dim; ++j) {
                if ((c >> j) & 1) continue;
                T square = 0;
#pragma GCC unroll 3
                for (int a = 0; a < Dim; ++a) {
                    const T e = (a == j ? T(1) : T(0)) +
                                (w[a][at + stride[static_cast<std::size_t>(j)]] - w[a][at]) * inverse_h;
                    square += e * e;
                }
                longest = square > longest ? square : longest;
            }
        }
        const int stretched = static_cast<int>(longest > limit * limit);
        flag[i] = static_cast<unsigned char>(stretched);
        any |= stretched;
    }
    return any;
}

}  // namespace

double dot(std::span<const float> a, std::span<const float> b) {
    assert(a.size() == b.size());
    std::vector<double> partial((a.size() + chunk - 1) / chunk, 0.0);
    for_chunks(a.size(), [&](std::size_t c, std::size_t begin, std::size_t end) {
        partial[c] = dot_chunk(a.data() + begin, b.data() + begin, end - begin);
    });
    double total = 0.0;
    for (const double p : partial) total += p;
    return total;
}

void step(std::span<double> out, std::span<const double> x, double factor, std::span<const float> d) {
    for_chunks(out.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
        step_chunk(out.data() + begin, x.data() + begin, factor, d.data() + begin, end - begin);
    });
}

void dots(std::span<const float> a, std::span<const std::span<const HalfFloat>> b, std::span<double> result) {
    assert(b.size() == result.size());
    const std::size_t count = b.size();
    std::vector<double> partial((a.size() + chunk - 1) / chunk * count, 0.0);
    for_chunks(a.size(), [&](std::size_t c, std::size_t begin, std::size_t end) {
        for (std::size_t j = 0; j < count; ++j) {
            partial[c * count + j] = dot_chunk(a.data() + begin, b[j].data() + begin, end - begin);
        }
    });
    std::fill(result.begin(), result.end(), 0.0);
    for (std::size_t i = 0; i < partial.size(); ++i) result[i % count] += partial[i];
}

void combine(std::span<float> out, float factor, std::span<const float> a, std::span<const double> factors,
             std::span<const std::span<const HalfFloat>> b) {
    assert(b.size() == factors.size());
    for_chunks(out.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
        scale_chunk(out.data() + begin, a.data() + begin, factor, end - begin);
        for (std::size_t j = 0; j < b.size(); ++j) {
            add_scaled_chunk(out.data() + begin, static_cast<float>(factors[j]), b[j].data() + begin, end - begin);
        }
    });
}

double differences(std::span<HalfFloat> s, std::span<const double> x, std::span<const double> x0,
                   std::span<HalfFloat> y, std::span<const float> g, std::span<const float> g0) {
    std::vector<double> partial((s.size() + chunk - 1) / chunk, 0.0);
    for_chunks(s.size(), [&](std::size_t c, std::size_t begin, std::size_t end) {
        const std::size_t n = end - begin;
        difference_chunk(s.data() + begin, x.data() + begin, x0.data() + begin, n);
        difference_chunk(y.data() + begin, g.data() + begin, g0.data() + begin, n);
        partial[c] = dot_chunk(s.data() + begin, y.data() + begin, n);
    });
    double total = 0.0;
    for (const double p : partial) total += p;
    return total;
}

template <int Dim>
bool squeezed_cells(std::size_t cells, const double* const (&w)[Dim], const float* const (&d)[Dim],
                    const Strides<Dim>& stride, double inverse_h, double keep, unsigned char* flag) {
    return flag_squeezed<Dim>(static_cast<std::ptrdiff_t>(cells), w, d, stride, inverse_h, keep, flag) != 0;
}

template <int Dim>
bool steep_cells(std::size_t cells, const double* u, const Strides<Dim>& stride, double limit, unsigned char* flag) {
    return flag_steep<Dim>(static_cast<std::ptrdiff_t>(cells), u, stride, limit, flag) != 0;
}

template <int Dim, class T>
bool stretched_cells(std::size_t cells, const T* const (&w)[Dim], const Strides<Dim>& stride, double inverse_h,
                     double limit, unsigned char* flag) {
    return flag_stretched<Dim, T>(static_cast<std::ptrdiff_t>(cells), w, stride, static_cast<T>(inverse_h),
                                  static_cast<T>(limit), flag) != 0;
}

#define MORPHODESIC_INSTANTIATE(Dim)                                                                                  \
    template bool squeezed_cells<Dim>(std::size_t, const double* const(&)[Dim], const float* const(&)[Dim],           \
                                      const Strides<Dim>&, double, double, unsigned char*);                           \
    template bool steep_cells<Dim>(std::size_t, const double*, const Strides<Dim>&, double, unsigned char*);          \
    template bool stretched_cells<Dim, double>(std::size_t, const double* const(&)[Dim], const Strides<Dim>&, double, \
                                               double, unsigned char*);                                               \
    template bool stretched_cells<Dim, float>(std::size_t, const float* const(&)[Dim], const Strides<Dim>&, double,   \
                                              double, unsigned char*);
MORPHODESIC_INSTANTIATE(2)
MORPHODESIC_INSTANTIATE(3)
#undef MORPHODESIC_INSTANTIATE

}  // namespace morphodesic::kernels

// Included once for every instruction set by the kernels, see foreach_target.h of Highway.
#if defined(MORPHODESIC_ELASTIC_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MORPHODESIC_ELASTIC_INL_H
#undef MORPHODESIC_ELASTIC_INL_H
#else
#define MORPHODESIC_ELASTIC_INL_H
#endif

#include "geodesic/kernels/step_kernel.h"
#include "geodesic/kernels/vectors-inl.h"
#include "hwy/contrib/math/math-inl.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace morphodesic::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// For x = det - 1 > -1: x - log(1 + x) without cancellation, and 1 / (1 + x); one division for both.
/// With s = x / (2 + x): log(1 + x) = 2 artanh(s), hence x - log(1 + x) = x s - 2 (s^3/3 + s^5/5 + ...).
template <class D>
HWY_INLINE V<D> minus_log1p(D d, V<D> x, V<D>& inverse) {
    const V<D> one = all(d, 1.0), two = all(d, 2.0);
    const V<D> det = hn::Add(one, x), sum = hn::Add(two, x);
    const V<D> both = hn::Div(one, hn::Mul(det, sum));
    inverse = hn::Mul(both, sum);
    const V<D> s = hn::Mul(x, hn::Mul(both, det));
    const V<D> y = hn::Mul(s, s), y2 = hn::Mul(y, y), y4 = hn::Mul(y2, y2);
    const auto term = [&](double n) HWY_ATTR { return all(d, 2.0 / n); };
    const V<D> p0 = hn::MulAdd(y, term(5), term(3)), p1 = hn::MulAdd(y, term(9), term(7));
    const V<D> p2 = hn::MulAdd(y, term(13), term(11));
    const V<D> q0 = hn::MulAdd(y2, p1, p0);
    V<D> series;
    if constexpr (sizeof(T<D>) == sizeof(float)) {
        series = hn::MulAdd(y4, p2, q0);
    } else {
        const V<D> q1 = hn::MulAdd(y2, hn::MulAdd(y, term(17), term(15)), p2);
        const V<D> q2 = hn::MulAdd(y2, term(23), hn::MulAdd(y, term(21), term(19)));
        series = hn::MulAdd(hn::MulAdd(y4, q2, q1), y4, q0);
    }
    V<D> result = hn::NegMulAdd(hn::Mul(y, s), series, hn::Mul(x, s));
    // The series is good to 1e-14 (float: 1e-7) for |s| < 0.22, that is det between 0.64 and 1.56.
    const auto far = hn::Gt(y, all(d, 0.0484));
    if (HWY_UNLIKELY(!hn::AllFalse(d, far))) result = hn::IfThenElse(far, hn::Sub(x, hn::Log(d, det)), result);
    return result;
}

/// det(I + B) - 1, and its part of order two and higher in B.
template <int Dim, class D>
HWY_INLINE void determinant_minus_one(D, const V<D> (&b)[Dim][Dim], V<D>& det_minus_one, V<D>& higher) {
    if constexpr (Dim == 2) {
        higher = hn::MulSub(b[0][0], b[1][1], hn::Mul(b[0][1], b[1][0]));
        det_minus_one = hn::Add(hn::Add(b[0][0], b[1][1]), higher);
    } else {
        const V<D> m01 = hn::MulSub(b[0][0], b[1][1], hn::Mul(b[0][1], b[1][0]));
        const V<D> m02 = hn::MulSub(b[0][0], b[2][2], hn::Mul(b[0][2], b[2][0]));
        const V<D> m12 = hn::MulSub(b[1][1], b[2][2], hn::Mul(b[1][2], b[2][1]));
        const V<D> c1 = hn::MulSub(b[1][0], b[2][2], hn::Mul(b[1][2], b[2][0]));
        const V<D> c2 = hn::MulSub(b[1][0], b[2][1], hn::Mul(b[1][1], b[2][0]));
        V<D> det = hn::Mul(b[0][0], m12);
        det = hn::NegMulAdd(b[0][1], c1, det);
        det = hn::MulAdd(b[0][2], c2, det);
        higher = hn::Add(hn::Add(hn::Add(m01, m02), m12), det);
        det_minus_one = hn::Add(hn::Add(hn::Add(b[0][0], b[1][1]), b[2][2]), higher);
    }
}

/// p = W_{,A}(I + B) = mu (A - cof A) + c cof A.
template <int Dim, class D>
HWY_INLINE void first_piola(D d, const V<D> (&b)[Dim][Dim], V<D> mu, V<D> c, V<D> (&p)[Dim][Dim]) {
    const V<D> one = all(d, 1.0);
    if constexpr (Dim == 2) {
        const V<D> difference = hn::Sub(b[0][0], b[1][1]);
        const V<D> sum = hn::Add(b[0][1], b[1][0]);
        p[0][0] = hn::MulAdd(mu, difference, hn::Mul(c, hn::Add(one, b[1][1])));
        p[1][1] = hn::NegMulAdd(mu, difference, hn::Mul(c, hn::Add(one, b[0][0])));
        p[0][1] = hn::NegMulAdd(c, b[1][0], hn::Mul(mu, sum));
        p[1][0] = hn::NegMulAdd(c, b[0][1], hn::Mul(mu, sum));
    } else {
        V<D> a[3][3];
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) a[i][j] = i == j ? hn::Add(one, b[i][j]) : b[i][j];
        }
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
                const V<D> cofactor = hn::MulSub(a[i1][j1], a[i2][j2], hn::Mul(a[i1][j2], a[i2][j1]));
                const V<D> minor = hn::MulSub(b[i1][j1], b[i2][j2], hn::Mul(b[i1][j2], b[i2][j1]));
                // A - cof A = B + B^T - tr B I - cof B, without cancellation at the identity.
                const V<D> linear =
                    i == j ? hn::Sub(b[i][i], hn::Add(b[i1][i1], b[i2][i2])) : hn::Add(b[i][j], b[j][i]);
                p[i][j] = hn::MulAdd(mu, hn::Sub(linear, minor), hn::Mul(c, cofactor));
            }
        }
    }
}

/// B = D phi - I at corner c of a cell; w is phi - id at its corners, in units of h here and below.
template <int Dim, class D>
HWY_INLINE void corner_gradient(D, const V<D> (&w)[Dim][1 << Dim], int c, V<D> (&b)[Dim][Dim]) {
    for (int i = 0; i < Dim; ++i) {
        for (int j = 0; j < Dim; ++j) b[i][j] = hn::Sub(w[i][c | (1 << j)], w[i][c & ~(1 << j)]);
    }
}

/// The least det D phi at the corners of a cell. In 2D this bounds det on the whole cell from below.
template <int Dim, class D>
HWY_INLINE V<D> least_corner_determinant(D d, const V<D> (&w)[Dim][1 << Dim]) {
    V<D> least = all(d, 1e30);
    for (int c = 0; c < (1 << Dim); ++c) {
        V<D> b[Dim][Dim], det, higher;
        corner_gradient<Dim>(d, w, c, b);
        determinant_minus_one<Dim>(d, b, det, higher);
        least = hn::Min(least, det);
    }
    return hn::Add(least, all(d, 1.0));
}

/// Barrier of the corners of a cell, summed; its gradient times `factor` is added to grad_w.
template <int Dim, class D>
HWY_NOINLINE V<D> barrier(D d, const V<D> (&w)[Dim][1 << Dim], V<D> factor, V<D> (&grad_w)[Dim][1 << Dim]) {
    const V<D> one = all(d, 1.0), zero = hn::Zero(d);
    V<D> sum = zero;
    for (int c = 0; c < (1 << Dim); ++c) {
        V<D> b[Dim][Dim], det_minus_one, higher, cofactor[Dim][Dim];
        corner_gradient<Dim>(d, w, c, b);
        determinant_minus_one<Dim>(d, b, det_minus_one, higher);
        const V<D> s = hn::Mul(hn::Add(one, det_minus_one), all(d, 1.0 / barrier_onset));
        const auto squeezed = hn::Lt(s, one);
        // Folded cells are rejected by min_det; here they must only not disturb the arithmetic.
        const V<D> safe = hn::Max(s, all(d, 1e-3));
        const V<D> value = hn::Sub(hn::Sub(safe, one), hn::Log(d, safe));
        sum = hn::Add(sum, hn::IfThenElseZero(squeezed, value));
        const V<D> slope = hn::IfThenElseZero(squeezed, hn::Sub(one, hn::Div(one, safe)));
        const V<D> scaled = hn::Mul(hn::Mul(slope, factor), all(d, 1.0 / barrier_onset));
        first_piola<Dim>(d, b, zero, one, cofactor);  // mu = 0, c = 1: the cofactor matrix
        for (int i = 0; i < Dim; ++i) {
            for (int j = 0; j < Dim; ++j) {
                const V<D> p = hn::Mul(scaled, cofactor[i][j]);
                grad_w[i][c | (1 << j)] = hn::Add(grad_w[i][c | (1 << j)], p);
                grad_w[i][c & ~(1 << j)] = hn::Sub(grad_w[i][c & ~(1 << j)], p);
            }
        }
    }
    return hn::Mul(sum, factor);
}

}  // namespace morphodesic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

#include "geodesic/kernels/step_kernel.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geodesic/kernels/step_kernel.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
// clang-format off
#include "hwy/highway.h"
#include "hwy/contrib/math/math-inl.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace morphodesic::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// At most 8 lanes: level 3, the coarsest one, has 8 cells per row.
using D = hn::CappedTag<double, 8>;
using DI = hn::RebindToSigned<D>;
using V = hn::Vec<D>;

constexpr double gauss_low = 0.21132486540518711775;  // (1 - 1/sqrt 3) / 2
constexpr double gauss_high = 1.0 - gauss_low;
constexpr double inverse_pi = 0.31830988618379067154;

constexpr double gauss_coordinate(int point, int axis) {
    return ((point >> axis) & 1) ? gauss_high : gauss_low;
}

/// Values at the Gauss points of the unit cell of the multilinear shape functions and of their derivatives (in units of
/// 1 / h), as tables: [point][corner] and [point][axis][corner].
template <int Dim>
struct ShapeTables {
    double value[1 << Dim][1 << Dim];
    double slope[1 << Dim][Dim][1 << Dim];

    constexpr ShapeTables() : value(), slope() {
        for (int q = 0; q < (1 << Dim); ++q) {
            for (int c = 0; c < (1 << Dim); ++c) {
                value[q][c] = 1.0;
                for (int a = 0; a < Dim; ++a) value[q][c] *= factor(q, c, a);
                for (int axis = 0; axis < Dim; ++axis) {
                    slope[q][axis][c] = ((c >> axis) & 1) ? 1.0 : -1.0;
                    for (int a = 0; a < Dim; ++a) {
                        if (a != axis) slope[q][axis][c] *= factor(q, c, a);
                    }
                }
            }
        }
    }
    static constexpr double factor(int point, int corner, int axis) {
        const double g = gauss_coordinate(point, axis);
        return ((corner >> axis) & 1) ? g : 1.0 - g;
    }
};
template <int Dim>
constexpr ShapeTables<Dim> shapes{};

/// For x = det - 1 > -1: x - log(1 + x) without cancellation, and 1 / (1 + x); one division for both.
/// With s = x / (2 + x): log(1 + x) = 2 artanh(s), hence x - log(1 + x) = x s - 2 (s^3/3 + s^5/5 + ...).
HWY_INLINE V minus_log1p(D d, V x, V& inverse) {
    const V one = hn::Set(d, 1.0), two = hn::Set(d, 2.0);
    const V det = hn::Add(one, x), sum = hn::Add(two, x);
    const V both = hn::Div(one, hn::Mul(det, sum));
    inverse = hn::Mul(both, sum);
    const V s = hn::Mul(x, hn::Mul(both, det));
    const V y = hn::Mul(s, s), y2 = hn::Mul(y, y), y4 = hn::Mul(y2, y2);
    const auto term = [&](double n) HWY_ATTR { return hn::Set(d, 2.0 / n); };
    const V p0 = hn::MulAdd(y, term(5), term(3)), p1 = hn::MulAdd(y, term(9), term(7));
    const V p2 = hn::MulAdd(y, term(13), term(11)), p3 = hn::MulAdd(y, term(17), term(15));
    const V q0 = hn::MulAdd(y2, p1, p0), q1 = hn::MulAdd(y2, p3, p2);
    const V q2 = hn::MulAdd(y2, term(23), hn::MulAdd(y, term(21), term(19)));
    const V series = hn::MulAdd(hn::MulAdd(y4, q2, q1), y4, q0);
    V result = hn::NegMulAdd(hn::Mul(y, s), series, hn::Mul(x, s));
    // The series is good to 1e-14 for |s| < 0.22, that is det between 0.64 and 1.56.
    const auto far = hn::Gt(y, hn::Set(d, 0.0484));
    if (HWY_UNLIKELY(!hn::AllFalse(d, far))) result = hn::IfThenElse(far, hn::Sub(x, hn::Log(d, det)), result);
    return result;
}

/// H_eps(u) = 1/2 + arctan(t) / pi and pi eps delta_eps(u) = 1 / (1 + t^2), t = u / eps; one division for both.
HWY_INLINE V smooth_heaviside(D d, V u, V inverse_eps, V& unit_delta) {
    const V one = hn::Set(d, 1.0);
    const V t = hn::Mul(u, inverse_eps), size = hn::Abs(t);
    const auto far = hn::Gt(size, one);
    const V square = hn::MulAdd(t, t, one);
    const V inverse = hn::Div(one, hn::Mul(square, hn::IfThenElse(far, size, one)));
    unit_delta = hn::IfThenElse(far, hn::Mul(inverse, size), inverse);
    hn::impl::AtanImpl<double> impl;
    const V angle = impl.AtanPoly(d, hn::IfThenElse(far, hn::Mul(inverse, square), size));
    const V positive = hn::IfThenElse(far, hn::Sub(hn::Set(d, 0.5 / inverse_pi), angle), angle);
    return hn::MulAdd(hn::CopySign(positive, t), hn::Set(d, inverse_pi), hn::Set(d, 0.5));
}

/// det(I + B) - 1, and its part of order two and higher in B.
template <int Dim>
HWY_INLINE void determinant_minus_one(const V (&b)[Dim][Dim], V& det_minus_one, V& higher) {
    if constexpr (Dim == 2) {
        higher = hn::MulSub(b[0][0], b[1][1], hn::Mul(b[0][1], b[1][0]));
        det_minus_one = hn::Add(hn::Add(b[0][0], b[1][1]), higher);
    } else {
        const V m01 = hn::MulSub(b[0][0], b[1][1], hn::Mul(b[0][1], b[1][0]));
        const V m02 = hn::MulSub(b[0][0], b[2][2], hn::Mul(b[0][2], b[2][0]));
        const V m12 = hn::MulSub(b[1][1], b[2][2], hn::Mul(b[1][2], b[2][1]));
        const V c1 = hn::MulSub(b[1][0], b[2][2], hn::Mul(b[1][2], b[2][0]));
        const V c2 = hn::MulSub(b[1][0], b[2][1], hn::Mul(b[1][1], b[2][0]));
        V det = hn::Mul(b[0][0], m12);
        det = hn::NegMulAdd(b[0][1], c1, det);
        det = hn::MulAdd(b[0][2], c2, det);
        higher = hn::Add(hn::Add(hn::Add(m01, m02), m12), det);
        det_minus_one = hn::Add(hn::Add(hn::Add(b[0][0], b[1][1]), b[2][2]), higher);
    }
}

/// p = W_{,A}(I + B) = mu (A - cof A) + c cof A.
template <int Dim>
HWY_INLINE void first_piola(const V (&b)[Dim][Dim], V mu, V c, V (&p)[Dim][Dim]) {
    const D d;
    const V one = hn::Set(d, 1.0);
    if constexpr (Dim == 2) {
        const V difference = hn::Sub(b[0][0], b[1][1]);
        const V sum = hn::Add(b[0][1], b[1][0]);
        p[0][0] = hn::MulAdd(mu, difference, hn::Mul(c, hn::Add(one, b[1][1])));
        p[1][1] = hn::NegMulAdd(mu, difference, hn::Mul(c, hn::Add(one, b[0][0])));
        p[0][1] = hn::NegMulAdd(c, b[1][0], hn::Mul(mu, sum));
        p[1][0] = hn::NegMulAdd(c, b[0][1], hn::Mul(mu, sum));
    } else {
        V a[3][3];
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) a[i][j] = i == j ? hn::Add(one, b[i][j]) : b[i][j];
        }
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
                const V cofactor = hn::MulSub(a[i1][j1], a[i2][j2], hn::Mul(a[i1][j2], a[i2][j1]));
                const V minor = hn::MulSub(b[i1][j1], b[i2][j2], hn::Mul(b[i1][j2], b[i2][j1]));
                // A - cof A = B + B^T - tr B I - cof B, without cancellation at the identity.
                const V linear = i == j ? hn::Sub(b[i][i], hn::Add(b[i1][i1], b[i2][i2])) : hn::Add(b[i][j], b[j][i]);
                p[i][j] = hn::MulAdd(mu, hn::Sub(linear, minor), hn::Mul(c, cofactor));
            }
        }
    }
}

/// B = D phi - I at corner c of a cell.
template <int Dim>
HWY_INLINE void corner_gradient(const V (&w)[Dim][1 << Dim], int c, V inverse_h, V (&b)[Dim][Dim]) {
    for (int i = 0; i < Dim; ++i) {
        for (int j = 0; j < Dim; ++j) {
            b[i][j] = hn::Mul(hn::Sub(w[i][c | (1 << j)], w[i][c & ~(1 << j)]), inverse_h);
        }
    }
}

/// The least det D phi at the corners of a cell. In 2D this bounds det on the whole cell from below.
template <int Dim>
HWY_INLINE V least_corner_determinant(const V (&w)[Dim][1 << Dim], V inverse_h) {
    const D d;
    V least = hn::Set(d, 1e300);
    for (int c = 0; c < (1 << Dim); ++c) {
        V b[Dim][Dim], det, higher;
        corner_gradient<Dim>(w, c, inverse_h, b);
        determinant_minus_one<Dim>(b, det, higher);
        least = hn::Min(least, det);
    }
    return hn::Add(least, hn::Set(d, 1.0));
}

/// Barrier of the corners of a cell, summed; its gradient times `factor` is added to grad_w.
template <int Dim>
HWY_NOINLINE V barrier(const V (&w)[Dim][1 << Dim], V inverse_h, V factor, V (&grad_w)[Dim][1 << Dim]) {
    const D d;
    const V one = hn::Set(d, 1.0), zero = hn::Zero(d);
    V sum = zero;
    for (int c = 0; c < (1 << Dim); ++c) {
        V b[Dim][Dim], det_minus_one, higher, cofactor[Dim][Dim];
        corner_gradient<Dim>(w, c, inverse_h, b);
        determinant_minus_one<Dim>(b, det_minus_one, higher);
        const V s = hn::Mul(hn::Add(one, det_minus_one), hn::Set(d, 1.0 / barrier_onset));
        const auto squeezed = hn::Lt(s, one);
        // Folded cells are rejected by min_det; here they must only not disturb the arithmetic.
        const V safe = hn::Max(s, hn::Set(d, 1e-3));
        const V value = hn::Sub(hn::Sub(safe, one), hn::Log(d, safe));
        sum = hn::Add(sum, hn::IfThenElseZero(squeezed, value));
        const V slope = hn::IfThenElseZero(squeezed, hn::Sub(one, hn::Div(one, safe)));
        const V scaled = hn::Mul(hn::Mul(slope, factor), hn::Mul(inverse_h, hn::Set(d, 1.0 / barrier_onset)));
        first_piola<Dim>(b, zero, one, cofactor);  // mu = 0, c = 1: the cofactor matrix
        for (int i = 0; i < Dim; ++i) {
            for (int j = 0; j < Dim; ++j) {
                const V p = hn::Mul(scaled, cofactor[i][j]);
                grad_w[i][c | (1 << j)] = hn::Add(grad_w[i][c | (1 << j)], p);
                grad_w[i][c & ~(1 << j)] = hn::Sub(grad_w[i][c & ~(1 << j)], p);
            }
        }
    }
    return hn::Mul(sum, factor);
}

/// Value and gradient (in units of 1 / h) of the multilinear function with corner values v at a point of the cell.
template <int Dim>
HWY_INLINE V multilinear(const V (&v)[1 << Dim], const V (&fraction)[Dim], V (&gradient)[Dim]) {
    if constexpr (Dim == 2) {
        const V low = hn::Sub(v[1], v[0]), high = hn::Sub(v[3], v[2]);
        const V bottom = hn::MulAdd(fraction[0], low, v[0]);
        const V top = hn::MulAdd(fraction[0], high, v[2]);
        gradient[0] = hn::MulAdd(fraction[1], hn::Sub(high, low), low);
        gradient[1] = hn::Sub(top, bottom);
        return hn::MulAdd(fraction[1], gradient[1], bottom);
    } else {
        V slope_x[4], value_x[4];
        for (int c = 0; c < 4; ++c) {
            slope_x[c] = hn::Sub(v[2 * c + 1], v[2 * c]);
            value_x[c] = hn::MulAdd(fraction[0], slope_x[c], v[2 * c]);
        }
        V slope_xy[2], slope_y[2], value_xy[2];
        for (int c = 0; c < 2; ++c) {
            slope_xy[c] = hn::MulAdd(fraction[1], hn::Sub(slope_x[2 * c + 1], slope_x[2 * c]), slope_x[2 * c]);
            slope_y[c] = hn::Sub(value_x[2 * c + 1], value_x[2 * c]);
            value_xy[c] = hn::MulAdd(fraction[1], slope_y[c], value_x[2 * c]);
        }
        gradient[0] = hn::MulAdd(fraction[2], hn::Sub(slope_xy[1], slope_xy[0]), slope_xy[0]);
        gradient[1] = hn::MulAdd(fraction[2], hn::Sub(slope_y[1], slope_y[0]), slope_y[0]);
        gradient[2] = hn::Sub(value_xy[1], value_xy[0]);
        return hn::MulAdd(fraction[2], gradient[2], value_xy[0]);
    }
}

template <int Dim>
StepSums StepEnergyRows(int row_begin, int row_end, const StepFields<Dim>& f, const StepWeights& s,
                        const StepGradients<Dim>& g) {
    const D d;
    const DI di;
    const int lanes = static_cast<int>(hn::Lanes(d));
    constexpr int corners = 1 << Dim, points = 1 << Dim;
    const int cells = 1 << s.level;
    const std::ptrdiff_t n = cells + 1;
    double quadrature_weight = 1.0 / points;
    for (int a = 0; a < Dim; ++a) quadrature_weight /= cells;

    std::ptrdiff_t stride[Dim];
    stride[0] = 1;
    for (int a = 1; a < Dim; ++a) stride[a] = stride[a - 1] * n;
    std::ptrdiff_t corner_offset[corners];
    for (int c = 0; c < corners; ++c) {
        corner_offset[c] = 0;
        for (int a = 0; a < Dim; ++a) corner_offset[c] += ((c >> a) & 1) * stride[a];
    }

    const bool with_gradient = g.displacement[0] != nullptr;
    const bool with_previous = with_gradient && g.u_previous != nullptr;
    const bool with_next = with_gradient && g.u_next != nullptr;

    const V one = hn::Set(d, 1.0), zero = hn::Zero(d);
    const V inverse_h = hn::Set(d, static_cast<double>(cells));
    const V inverse_eps = hn::Set(d, 1.0 / s.eps);
    const V delta_factor = hn::Set(d, inverse_pi / s.eps);
    const V mu = hn::Set(d, s.mu), half_mu = hn::Set(d, 0.5 * s.mu);
    const V quarter_lambda = hn::Set(d, 0.25 * s.lambda), half_lambda = hn::Set(d, 0.5 * s.lambda);
    const V log_factor = hn::Set(d, s.mu + 0.5 * s.lambda);
    const V last_cell = hn::Set(d, static_cast<double>(cells - 1));
    const V barrier_factor = hn::Set(d, quadrature_weight * s.barrier);
    const V deformation_factor = hn::Set(d, quadrature_weight * s.deformation);

    // Gradients at the nodes of a row: left and right nodes of the cells apart, so that stores never overlap loads.
    constexpr int outputs = Dim + 1;
    const auto padded = static_cast<std::size_t>(cells);
    static thread_local std::vector<double> rows;
    rows.resize(static_cast<std::size_t>(outputs * corners) * padded);

    V sum_deformation = zero, sum_mismatch = zero, sum_barrier = zero, min_det = hn::Set(d, 1e300);
    HWY_ALIGN std::int64_t scatter_base[8];
    HWY_ALIGN double scatter_value[corners][8];

    const int middle_rows = Dim == 3 ? cells : 1;
    for (int row = row_begin; row < row_end; ++row) {
        for (int middle = 0; middle < middle_rows; ++middle) {
            const std::ptrdiff_t row_base = row * stride[Dim - 1] + (Dim == 3 ? middle * stride[1] : 0);
            for (int i = 0; i < cells; i += lanes) {
                V w[Dim][corners], u[corners], chi[corners], grad_w[Dim][corners], grad_u[corners];
                for (int c = 0; c < corners; ++c) {
                    const std::ptrdiff_t at = row_base + i + corner_offset[c];
                    for (int a = 0; a < Dim; ++a) {
                        w[a][c] = hn::LoadU(d, f.displacement[a] + at);
                        grad_w[a][c] = zero;
                    }
                    u[c] = hn::LoadU(d, f.u_previous + at);
                    grad_u[c] = zero;
                    chi[c] = f.mask ? hn::LoadU(d, f.mask + at) : one;
                }
                const V least_corner = least_corner_determinant<Dim>(w, inverse_h);
                min_det = hn::Min(min_det, least_corner);
                if (!hn::AllFalse(d, hn::Lt(least_corner, hn::Set(d, barrier_onset)))) {
                    sum_barrier = hn::Add(sum_barrier, barrier<Dim>(w, inverse_h, barrier_factor, grad_w));
                }

                for (int q = 0; q < points; ++q) {
                    V b[Dim][Dim], displacement[Dim], norm = zero;
                    for (int a = 0; a < Dim; ++a) {
                        displacement[a] = zero;
                        for (int j = 0; j < Dim; ++j) b[a][j] = zero;
                        for (int c = 0; c < corners; ++c) {
                            displacement[a] = hn::MulAdd(hn::Set(d, shapes<Dim>.value[q][c]), w[a][c], displacement[a]);
                            for (int j = 0; j < Dim; ++j) {
                                b[a][j] = hn::MulAdd(hn::Set(d, shapes<Dim>.slope[q][j][c]), w[a][c], b[a][j]);
                            }
                        }
                        for (int j = 0; j < Dim; ++j) {
                            b[a][j] = hn::Mul(b[a][j], inverse_h);
                            norm = hn::MulAdd(b[a][j], b[a][j], norm);
                        }
                    }
                    V u_here = zero;
                    for (int c = 0; c < corners; ++c) {
                        u_here = hn::MulAdd(hn::Set(d, shapes<Dim>.value[q][c]), u[c], u_here);
                    }

                    // W = mu (|B|^2 / 2 - higher) + lambda/4 D^2 + (mu + lambda/2) (D - log(1 + D)), D = det - 1.
                    V det_minus_one, higher;
                    determinant_minus_one<Dim>(b, det_minus_one, higher);
                    const V det = hn::Add(one, det_minus_one);
                    min_det = hn::Min(min_det, det);
                    V density = hn::NegMulAdd(mu, higher, hn::Mul(half_mu, norm));
                    density = hn::MulAdd(quarter_lambda, hn::Mul(det_minus_one, det_minus_one), density);
                    V inverse_det, delta_here, delta_there;
                    density = hn::MulAdd(log_factor, minus_log1p(d, det_minus_one, inverse_det), density);
                    const V inside = smooth_heaviside(d, u_here, inverse_eps, delta_here);
                    const V weight = hn::MulAdd(hn::Set(d, 1.0 - s.delta), inside, hn::Set(d, s.delta));
                    sum_deformation = hn::MulAdd(weight, density, sum_deformation);

                    // u_k at the deformed point: cell and fraction on each axis, then the corners of that cell.
                    V fraction[Dim], gather_base = zero;
                    for (int a = 0; a < Dim; ++a) {
                        const double g_a = gauss_coordinate(q, a);
                        V position;
                        if (a == 0) {
                            position = hn::Add(hn::Iota(d, static_cast<double>(i)), hn::Set(d, g_a));
                        } else {
                            position = hn::Set(d, g_a + (a == Dim - 1 ? row : middle));
                        }
                        position = hn::MulAdd(displacement[a], inverse_h, position);
                        const V cell = hn::Min(hn::Max(hn::Floor(position), zero), last_cell);
                        fraction[a] = hn::Min(hn::Max(hn::Sub(position, cell), zero), one);
                        gather_base = hn::MulAdd(cell, hn::Set(d, static_cast<double>(stride[a])), gather_base);
                    }
                    const auto gather_index = hn::ConvertTo(di, gather_base);
                    V v[corners], gradient[Dim];
                    for (int c = 0; c < corners; ++c)
                        v[c] = hn::GatherIndex(d, f.u_next + corner_offset[c], gather_index);
                    const V u_there = multilinear<Dim>(v, fraction, gradient);

                    V known = one;
                    if (f.mask) {
                        known = zero;
                        for (int c = 0; c < corners; ++c) {
                            known = hn::MulAdd(hn::Set(d, shapes<Dim>.value[q][c]), chi[c], known);
                        }
                    }
                    const V residual = hn::Sub(smooth_heaviside(d, u_there, inverse_eps, delta_there), inside);
                    const V masked_residual = hn::Mul(known, residual);
                    sum_mismatch = hn::MulAdd(masked_residual, residual, sum_mismatch);
                    if (!with_gradient) continue;

                    const V match = hn::Mul(hn::Set(d, 2.0 * quadrature_weight * s.mismatch), masked_residual);
                    // c = lambda/2 det - (mu + lambda/2) / det + mu.
                    const V c = hn::MulAdd(half_lambda, det_minus_one,
                                           hn::Mul(hn::Mul(log_factor, det_minus_one), inverse_det));
                    V p[Dim][Dim];
                    first_piola<Dim>(b, mu, c, p);
                    const V stress_factor = hn::Mul(hn::Mul(deformation_factor, weight), inverse_h);
                    const V force = hn::Mul(match, hn::Mul(delta_there, delta_factor));
                    const V scaled_force = hn::Mul(force, inverse_h);
                    for (int a = 0; a < Dim; ++a) {
                        const V body = hn::Mul(scaled_force, gradient[a]);
                        for (int j = 0; j < Dim; ++j) p[a][j] = hn::Mul(p[a][j], stress_factor);
                        for (int k = 0; k < corners; ++k) {
                            V sum = hn::MulAdd(hn::Set(d, shapes<Dim>.value[q][k]), body, grad_w[a][k]);
                            for (int j = 0; j < Dim; ++j) {
                                sum = hn::MulAdd(hn::Set(d, shapes<Dim>.slope[q][j][k]), p[a][j], sum);
                            }
                            grad_w[a][k] = sum;
                        }
                    }
                    if (with_previous) {
                        const V softness = hn::Mul(hn::Mul(hn::Set(d, 1.0 - s.delta), deformation_factor), density);
                        const V coefficient = hn::Mul(hn::Mul(delta_here, delta_factor), hn::Sub(softness, match));
                        for (int k = 0; k < corners; ++k) {
                            grad_u[k] = hn::MulAdd(hn::Set(d, shapes<Dim>.value[q][k]), coefficient, grad_u[k]);
                        }
                    }
                    if (with_next) {
                        hn::Store(gather_index, di, scatter_base);
                        for (int k = 0; k < corners; ++k) {
                            V value = force;
                            for (int a = 0; a < Dim; ++a) {
                                value = hn::Mul(value, ((k >> a) & 1) ? fraction[a] : hn::Sub(one, fraction[a]));
                            }
                            hn::Store(value, d, scatter_value[k]);
                        }
                        double* out = g.u_next - g.u_next_first_row * stride[Dim - 1];
                        for (int lane = 0; lane < lanes; ++lane) {
                            double* cell = out + scatter_base[lane];
                            for (int k = 0; k < corners; ++k) cell[corner_offset[k]] += scatter_value[k][lane];
                        }
                    }
                }

                if (!with_gradient) continue;
                double* target = rows.data() + i;
                for (int a = 0; a < Dim; ++a) {
                    for (int k = 0; k < corners; ++k, target += padded) hn::StoreU(grad_w[a][k], d, target);
                }
                for (int k = 0; k < corners; ++k, target += padded) hn::StoreU(grad_u[k], d, target);
            }

            for (int output = 0; with_gradient && output < (with_previous ? outputs : Dim); ++output) {
                double* field = output < Dim ? g.displacement[output] : g.u_previous;
                for (int k = 0; k < corners; ++k) {
                    const double* source = rows.data() + static_cast<std::size_t>(output * corners + k) * padded;
                    double* out = field + row_base + corner_offset[k];
                    for (int i = 0; i < cells; i += lanes) {
                        hn::StoreU(hn::Add(hn::LoadU(d, out + i), hn::LoadU(d, source + i)), d, out + i);
                    }
                }
            }
        }
    }

    HWY_ALIGN double lane_values[8];
    StepSums sums;
    hn::Store(sum_deformation, d, lane_values);
    for (int lane = 0; lane < lanes; ++lane) sums.deformation += lane_values[lane];
    hn::Store(sum_mismatch, d, lane_values);
    for (int lane = 0; lane < lanes; ++lane) sums.mismatch += lane_values[lane];
    hn::Store(sum_barrier, d, lane_values);
    for (int lane = 0; lane < lanes; ++lane) sums.barrier += lane_values[lane];
    hn::Store(min_det, d, lane_values);
    for (int lane = 0; lane < lanes; ++lane) sums.min_det = std::min(sums.min_det, lane_values[lane]);
    sums.deformation *= quadrature_weight;
    sums.mismatch *= quadrature_weight;
    return sums;
}

StepSums StepEnergyRows2(int row_begin, int row_end, const StepFields<2>& f, const StepWeights& s,
                         const StepGradients<2>& g) {
    return StepEnergyRows<2>(row_begin, row_end, f, s, g);
}
StepSums StepEnergyRows3(int row_begin, int row_end, const StepFields<3>& f, const StepWeights& s,
                         const StepGradients<3>& g) {
    return StepEnergyRows<3>(row_begin, row_end, f, s, g);
}
const char* InstructionSet() {
    return hwy::TargetName(HWY_TARGET);
}

}  // namespace morphodesic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace morphodesic::kernels {

HWY_EXPORT(StepEnergyRows2);
HWY_EXPORT(StepEnergyRows3);
HWY_EXPORT(InstructionSet);

template <>
StepSums step_energy_rows<2>(int row_begin, int row_end, const StepFields<2>& fields, const StepWeights& weights,
                             const StepGradients<2>& gradients) {
    return HWY_DYNAMIC_DISPATCH(StepEnergyRows2)(row_begin, row_end, fields, weights, gradients);
}
template <>
StepSums step_energy_rows<3>(int row_begin, int row_end, const StepFields<3>& fields, const StepWeights& weights,
                             const StepGradients<3>& gradients) {
    return HWY_DYNAMIC_DISPATCH(StepEnergyRows3)(row_begin, row_end, fields, weights, gradients);
}
const char* instruction_set() {
    return HWY_DYNAMIC_DISPATCH(InstructionSet)();
}

}  // namespace morphodesic::kernels
#endif

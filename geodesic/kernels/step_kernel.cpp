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
#include "geodesic/kernels/multilinear-inl.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace morphodesic::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// At most 8 lanes in double precision: level 3, the coarsest one, has 8 cells per row. In single precision level 4.
using Double = hn::CappedTag<double, 8>;
using Single = hn::CappedTag<float, 16>;
template <class D>
using V = hn::Vec<D>;
template <class D>
using T = hn::TFromD<D>;

/// A constant in every lane.
template <class D>
HWY_INLINE V<D> all(D d, double value) {
    return hn::Set(d, static_cast<T<D>>(value));
}

constexpr double inverse_pi = 0.31830988618379067154;

/// Values at the quadrature points of the unit cell of the multilinear shape functions and of their derivatives (in
/// units of 1 / h), as tables: [point][corner] and [point][axis][corner].
template <int Dim, Quadrature Rule>
struct ShapeTables {
    static constexpr auto& at = quadrature::points<Dim, Rule>;
    static constexpr int points = static_cast<int>(at.size());
    double value[points][1 << Dim];
    double slope[points][Dim][1 << Dim];

    constexpr ShapeTables() : value(), slope() {
        for (int q = 0; q < points; ++q) {
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
    static constexpr double coordinate(int point, int axis) {
        return at[static_cast<std::size_t>(point)][static_cast<std::size_t>(axis)];
    }
    static constexpr double factor(int point, int corner, int axis) {
        return ((corner >> axis) & 1) ? coordinate(point, axis) : 1.0 - coordinate(point, axis);
    }
};
template <int Dim, Quadrature Rule>
constexpr ShapeTables<Dim, Rule> shape_tables{};

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

/// H_eps(u) = 1/2 + arctan(t) / pi and pi eps delta_eps(u) = 1 / (1 + t^2), t = u / eps; one division for both.
template <class D>
HWY_INLINE V<D> smooth_heaviside(D d, V<D> u, V<D> inverse_eps, V<D>& unit_delta) {
    const V<D> one = all(d, 1.0);
    const V<D> t = hn::Mul(u, inverse_eps), size = hn::Abs(t);
    const auto far = hn::Gt(size, one);
    const V<D> square = hn::MulAdd(t, t, one);
    const V<D> inverse = hn::Div(one, hn::Mul(square, hn::IfThenElse(far, size, one)));
    unit_delta = hn::IfThenElse(far, hn::Mul(inverse, size), inverse);
    hn::impl::AtanImpl<T<D>> impl;
    const V<D> angle = impl.AtanPoly(d, hn::IfThenElse(far, hn::Mul(inverse, square), size));
    const V<D> positive = hn::IfThenElse(far, hn::Sub(all(d, 0.5 / inverse_pi), angle), angle);
    return hn::MulAdd(hn::CopySign(positive, t), all(d, inverse_pi), all(d, 0.5));
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

/// B = D phi - I at corner c of a cell.
template <int Dim, class D>
HWY_INLINE void corner_gradient(D, const V<D> (&w)[Dim][1 << Dim], int c, V<D> inverse_h, V<D> (&b)[Dim][Dim]) {
    for (int i = 0; i < Dim; ++i) {
        for (int j = 0; j < Dim; ++j) {
            b[i][j] = hn::Mul(hn::Sub(w[i][c | (1 << j)], w[i][c & ~(1 << j)]), inverse_h);
        }
    }
}

/// The least det D phi at the corners of a cell. In 2D this bounds det on the whole cell from below.
template <int Dim, class D>
HWY_INLINE V<D> least_corner_determinant(D d, const V<D> (&w)[Dim][1 << Dim], V<D> inverse_h) {
    V<D> least = all(d, 1e30);
    for (int c = 0; c < (1 << Dim); ++c) {
        V<D> b[Dim][Dim], det, higher;
        corner_gradient<Dim>(d, w, c, inverse_h, b);
        determinant_minus_one<Dim>(d, b, det, higher);
        least = hn::Min(least, det);
    }
    return hn::Add(least, all(d, 1.0));
}

/// Barrier of the corners of a cell, summed; its gradient times `factor` is added to grad_w.
template <int Dim, class D>
HWY_NOINLINE V<D> barrier(D d, const V<D> (&w)[Dim][1 << Dim], V<D> inverse_h, V<D> factor,
                          V<D> (&grad_w)[Dim][1 << Dim]) {
    const V<D> one = all(d, 1.0), zero = hn::Zero(d);
    V<D> sum = zero;
    for (int c = 0; c < (1 << Dim); ++c) {
        V<D> b[Dim][Dim], det_minus_one, higher, cofactor[Dim][Dim];
        corner_gradient<Dim>(d, w, c, inverse_h, b);
        determinant_minus_one<Dim>(d, b, det_minus_one, higher);
        const V<D> s = hn::Mul(hn::Add(one, det_minus_one), all(d, 1.0 / barrier_onset));
        const auto squeezed = hn::Lt(s, one);
        // Folded cells are rejected by min_det; here they must only not disturb the arithmetic.
        const V<D> safe = hn::Max(s, all(d, 1e-3));
        const V<D> value = hn::Sub(hn::Sub(safe, one), hn::Log(d, safe));
        sum = hn::Add(sum, hn::IfThenElseZero(squeezed, value));
        const V<D> slope = hn::IfThenElseZero(squeezed, hn::Sub(one, hn::Div(one, safe)));
        const V<D> scaled = hn::Mul(hn::Mul(slope, factor), hn::Mul(inverse_h, all(d, 1.0 / barrier_onset)));
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

template <int Dim, Quadrature Rule, class D>
StepSums StepEnergyRows(D d, int row_begin, int row_end, const StepFields<Dim, T<D>>& f, const StepWeights& s,
                        const StepGradients<Dim, T<D>>& g) {
    const hn::RebindToSigned<D> di;
    using Index = hn::TFromD<decltype(di)>;
    const int lanes = static_cast<int>(hn::Lanes(d));
    constexpr auto& shapes = shape_tables<Dim, Rule>;
    constexpr int corners = 1 << Dim, points = shapes.points;
    const int cells = f.cells[0], cells_per_unit = 1 << s.level;
    double cell_volume = 1.0;
    for (int a = 0; a < Dim; ++a) cell_volume /= cells_per_unit;
    const double quadrature_weight = cell_volume / points;

    std::ptrdiff_t stride[Dim];
    stride[0] = 1;
    for (int a = 1; a < Dim; ++a) stride[a] = stride[a - 1] * (f.cells[a - 1] + 1);
    std::ptrdiff_t corner_offset[corners];
    for (int c = 0; c < corners; ++c) {
        corner_offset[c] = 0;
        for (int a = 0; a < Dim; ++a) corner_offset[c] += ((c >> a) & 1) * stride[a];
    }

    const bool with_gradient = g.displacement[0] != nullptr;
    const bool with_previous = with_gradient && g.u_previous != nullptr;
    const bool with_next = with_gradient && g.u_next != nullptr;

    const V<D> one = all(d, 1.0), zero = hn::Zero(d);
    const V<D> inverse_h = all(d, static_cast<double>(cells_per_unit));
    const V<D> inverse_eps = all(d, 1.0 / s.eps);
    const V<D> delta_factor = all(d, inverse_pi / s.eps);
    const V<D> mu = all(d, s.mu), half_mu = all(d, 0.5 * s.mu);
    const V<D> quarter_lambda = all(d, 0.25 * s.lambda), half_lambda = all(d, 0.5 * s.lambda);
    const V<D> log_factor = all(d, s.mu + 0.5 * s.lambda);
    V<D> last_cell[Dim];
    for (int a = 0; a < Dim; ++a) last_cell[a] = all(d, static_cast<double>(f.cells[a] - 1));
    const V<D> barrier_factor = all(d, cell_volume / corners * s.barrier);
    const V<D> deformation_factor = all(d, quadrature_weight * s.deformation);

    // Gradients at the nodes of a row: left and right nodes of the cells apart, so that stores never overlap loads.
    constexpr int outputs = Dim + 1;
    const auto padded = static_cast<std::size_t>(cells);
    static thread_local std::vector<T<D>> rows;
    rows.resize(static_cast<std::size_t>(outputs * corners) * padded);

    V<D> min_det = all(d, 1e30);
    StepSums sums;
    constexpr std::size_t most_lanes = hn::MaxLanes(d);
    HWY_ALIGN Index scatter_base[most_lanes];
    HWY_ALIGN T<D> scatter_value[corners][most_lanes];

    const int middle_rows = Dim == 3 ? f.cells[1] : 1;
    for (int row = row_begin; row < row_end; ++row) {
        for (int middle = 0; middle < middle_rows; ++middle) {
            V<D> sum_deformation = zero, sum_mismatch = zero, sum_barrier = zero;
            const std::ptrdiff_t row_base = row * stride[Dim - 1] + (Dim == 3 ? middle * stride[1] : 0);
            for (int i = 0; i < cells; i += lanes) {
                V<D> w[Dim][corners], u[corners], chi[corners], grad_w[Dim][corners], grad_u[corners];
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
                const V<D> least_corner = least_corner_determinant<Dim>(d, w, inverse_h);
                min_det = hn::Min(min_det, least_corner);
                if (!hn::AllFalse(d, hn::Lt(least_corner, all(d, barrier_onset)))) {
                    sum_barrier = hn::Add(sum_barrier, barrier<Dim>(d, w, inverse_h, barrier_factor, grad_w));
                }

                for (int q = 0; q < points; ++q) {
                    V<D> b[Dim][Dim], displacement[Dim], norm = zero;
                    for (int a = 0; a < Dim; ++a) {
                        displacement[a] = zero;
                        for (int j = 0; j < Dim; ++j) b[a][j] = zero;
                        for (int c = 0; c < corners; ++c) {
                            displacement[a] = hn::MulAdd(all(d, shapes.value[q][c]), w[a][c], displacement[a]);
                            for (int j = 0; j < Dim; ++j) {
                                b[a][j] = hn::MulAdd(all(d, shapes.slope[q][j][c]), w[a][c], b[a][j]);
                            }
                        }
                        for (int j = 0; j < Dim; ++j) {
                            b[a][j] = hn::Mul(b[a][j], inverse_h);
                            norm = hn::MulAdd(b[a][j], b[a][j], norm);
                        }
                    }
                    V<D> u_here = zero;
                    for (int c = 0; c < corners; ++c) {
                        u_here = hn::MulAdd(all(d, shapes.value[q][c]), u[c], u_here);
                    }

                    // W = mu (|B|^2 / 2 - higher) + lambda/4 D^2 + (mu + lambda/2) (D - log(1 + D)), D = det - 1.
                    V<D> det_minus_one, higher;
                    determinant_minus_one<Dim>(d, b, det_minus_one, higher);
                    const V<D> det = hn::Add(one, det_minus_one);
                    min_det = hn::Min(min_det, det);
                    V<D> density = hn::NegMulAdd(mu, higher, hn::Mul(half_mu, norm));
                    density = hn::MulAdd(quarter_lambda, hn::Mul(det_minus_one, det_minus_one), density);
                    V<D> inverse_det, delta_here, delta_there;
                    density = hn::MulAdd(log_factor, minus_log1p(d, det_minus_one, inverse_det), density);
                    const V<D> inside = smooth_heaviside(d, u_here, inverse_eps, delta_here);
                    const V<D> weight = hn::MulAdd(all(d, 1.0 - s.delta), inside, all(d, s.delta));
                    sum_deformation = hn::MulAdd(weight, density, sum_deformation);

                    // u_k at the deformed point: cell and fraction on each axis, then the corners of that cell.
                    // Positions count from the point's own cell: exact to the last bit of the displacement.
                    V<D> fraction[Dim];
                    auto gather_index = hn::Zero(di);
                    for (int a = 0; a < Dim; ++a) {
                        V<D> own;
                        if (a == 0) {
                            own = hn::Iota(d, static_cast<T<D>>(i));
                        } else {
                            own = all(d, a == Dim - 1 ? row : middle);
                        }
                        const V<D> position = hn::MulAdd(displacement[a], inverse_h, all(d, shapes.coordinate(q, a)));
                        const V<D> cell = hn::Min(hn::Max(hn::Add(hn::Floor(position), own), zero), last_cell[a]);
                        fraction[a] = hn::Min(hn::Max(hn::Sub(position, hn::Sub(cell, own)), zero), one);
                        gather_index = hn::Add(
                            gather_index, hn::Mul(hn::ConvertTo(di, cell), hn::Set(di, static_cast<Index>(stride[a]))));
                    }
                    V<D> v[corners], gradient[Dim];
                    for (int c = 0; c < corners; ++c)
                        v[c] = hn::GatherIndex(d, f.u_next + corner_offset[c], gather_index);
                    const V<D> u_there = multilinear<Dim>(d, v, fraction, gradient);

                    V<D> known = one;
                    if (f.mask) {
                        known = zero;
                        for (int c = 0; c < corners; ++c) {
                            known = hn::MulAdd(all(d, shapes.value[q][c]), chi[c], known);
                        }
                    }
                    const V<D> residual = hn::Sub(smooth_heaviside(d, u_there, inverse_eps, delta_there), inside);
                    const V<D> masked_residual = hn::Mul(known, residual);
                    sum_mismatch = hn::MulAdd(masked_residual, residual, sum_mismatch);
                    if (!with_gradient) continue;

                    const V<D> match = hn::Mul(all(d, 2.0 * quadrature_weight * s.mismatch), masked_residual);
                    // c = lambda/2 det - (mu + lambda/2) / det + mu.
                    const V<D> c = hn::MulAdd(half_lambda, det_minus_one,
                                              hn::Mul(hn::Mul(log_factor, det_minus_one), inverse_det));
                    V<D> p[Dim][Dim];
                    first_piola<Dim>(d, b, mu, c, p);
                    const V<D> stress_factor = hn::Mul(hn::Mul(deformation_factor, weight), inverse_h);
                    const V<D> force = hn::Mul(match, hn::Mul(delta_there, delta_factor));
                    const V<D> scaled_force = hn::Mul(force, inverse_h);
                    for (int a = 0; a < Dim; ++a) {
                        const V<D> body = hn::Mul(scaled_force, gradient[a]);
                        for (int j = 0; j < Dim; ++j) p[a][j] = hn::Mul(p[a][j], stress_factor);
                        for (int k = 0; k < corners; ++k) {
                            V<D> sum = hn::MulAdd(all(d, shapes.value[q][k]), body, grad_w[a][k]);
                            for (int j = 0; j < Dim; ++j) {
                                sum = hn::MulAdd(all(d, shapes.slope[q][j][k]), p[a][j], sum);
                            }
                            grad_w[a][k] = sum;
                        }
                    }
                    if (with_previous) {
                        const V<D> softness = hn::Mul(hn::Mul(all(d, 1.0 - s.delta), deformation_factor), density);
                        const V<D> coefficient = hn::Mul(hn::Mul(delta_here, delta_factor), hn::Sub(softness, match));
                        for (int k = 0; k < corners; ++k) {
                            grad_u[k] = hn::MulAdd(all(d, shapes.value[q][k]), coefficient, grad_u[k]);
                        }
                    }
                    if (with_next) {
                        hn::Store(gather_index, di, scatter_base);
                        for (int k = 0; k < corners; ++k) {
                            V<D> value = force;
                            for (int a = 0; a < Dim; ++a) {
                                value = hn::Mul(value, ((k >> a) & 1) ? fraction[a] : hn::Sub(one, fraction[a]));
                            }
                            hn::Store(value, d, scatter_value[k]);
                        }
                        T<D>* out = g.u_next - g.u_next_first_row * stride[Dim - 1];
                        for (int lane = 0; lane < lanes; ++lane) {
                            T<D>* cell = out + scatter_base[lane];
                            for (int k = 0; k < corners; ++k) cell[corner_offset[k]] += scatter_value[k][lane];
                        }
                    }
                }

                if (!with_gradient) continue;
                T<D>* target = rows.data() + i;
                for (int a = 0; a < Dim; ++a) {
                    for (int k = 0; k < corners; ++k, target += padded) hn::StoreU(grad_w[a][k], d, target);
                }
                for (int k = 0; k < corners; ++k, target += padded) hn::StoreU(grad_u[k], d, target);
            }

            for (int output = 0; with_gradient && output < (with_previous ? outputs : Dim); ++output) {
                T<D>* field = output < Dim ? g.displacement[output] : g.u_previous;
                for (int k = 0; k < corners; ++k) {
                    const T<D>* source = rows.data() + static_cast<std::size_t>(output * corners + k) * padded;
                    T<D>* out = field + row_base + corner_offset[k];
                    for (int i = 0; i < cells; i += lanes) {
                        hn::StoreU(hn::Add(hn::LoadU(d, out + i), hn::LoadU(d, source + i)), d, out + i);
                    }
                }
            }
            // Rows are short; their sums are added up in double precision.
            HWY_ALIGN T<D> lane_values[most_lanes];
            hn::Store(sum_deformation, d, lane_values);
            for (int lane = 0; lane < lanes; ++lane) sums.deformation += static_cast<double>(lane_values[lane]);
            hn::Store(sum_mismatch, d, lane_values);
            for (int lane = 0; lane < lanes; ++lane) sums.mismatch += static_cast<double>(lane_values[lane]);
            hn::Store(sum_barrier, d, lane_values);
            for (int lane = 0; lane < lanes; ++lane) sums.barrier += static_cast<double>(lane_values[lane]);
        }
    }

    HWY_ALIGN T<D> lane_values[most_lanes];
    hn::Store(min_det, d, lane_values);
    for (int lane = 0; lane < lanes; ++lane) {
        sums.min_det = std::min(sums.min_det, static_cast<double>(lane_values[lane]));
    }
    sums.deformation *= quadrature_weight;
    sums.mismatch *= quadrature_weight;
    return sums;
}

template <int Dim, class D>
StepSums StepEnergyRows(D d, int begin, int end, const StepFields<Dim, T<D>>& f, const StepWeights& s,
                        const StepGradients<Dim, T<D>>& g) {
    if (s.quadrature == Quadrature::few) return StepEnergyRows<Dim, Quadrature::few>(d, begin, end, f, s, g);
    return StepEnergyRows<Dim, Quadrature::many>(d, begin, end, f, s, g);
}

StepSums StepEnergyRows2(int begin, int end, const StepFields<2, double>& f, const StepWeights& s,
                         const StepGradients<2, double>& g) {
    return StepEnergyRows<2>(Double(), begin, end, f, s, g);
}
StepSums StepEnergyRows3(int begin, int end, const StepFields<3, double>& f, const StepWeights& s,
                         const StepGradients<3, double>& g) {
    return StepEnergyRows<3>(Double(), begin, end, f, s, g);
}
StepSums StepEnergyRows2Single(int begin, int end, const StepFields<2, float>& f, const StepWeights& s,
                               const StepGradients<2, float>& g) {
    return StepEnergyRows<2>(Single(), begin, end, f, s, g);
}
StepSums StepEnergyRows3Single(int begin, int end, const StepFields<3, float>& f, const StepWeights& s,
                               const StepGradients<3, float>& g) {
    return StepEnergyRows<3>(Single(), begin, end, f, s, g);
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
HWY_EXPORT(StepEnergyRows2Single);
HWY_EXPORT(StepEnergyRows3Single);
HWY_EXPORT(InstructionSet);

template <>
StepSums step_energy_rows<2, double>(int begin, int end, const StepFields<2, double>& fields,
                                     const StepWeights& weights, const StepGradients<2, double>& gradients) {
    return HWY_DYNAMIC_DISPATCH(StepEnergyRows2)(begin, end, fields, weights, gradients);
}
template <>
StepSums step_energy_rows<3, double>(int begin, int end, const StepFields<3, double>& fields,
                                     const StepWeights& weights, const StepGradients<3, double>& gradients) {
    return HWY_DYNAMIC_DISPATCH(StepEnergyRows3)(begin, end, fields, weights, gradients);
}
template <>
StepSums step_energy_rows<2, float>(int begin, int end, const StepFields<2, float>& fields, const StepWeights& weights,
                                    const StepGradients<2, float>& gradients) {
    return HWY_DYNAMIC_DISPATCH(StepEnergyRows2Single)(begin, end, fields, weights, gradients);
}
template <>
StepSums step_energy_rows<3, float>(int begin, int end, const StepFields<3, float>& fields, const StepWeights& weights,
                                    const StepGradients<3, float>& gradients) {
    return HWY_DYNAMIC_DISPATCH(StepEnergyRows3Single)(begin, end, fields, weights, gradients);
}
const char* instruction_set() {
    return HWY_DYNAMIC_DISPATCH(InstructionSet)();
}

}  // namespace morphodesic::kernels
#endif

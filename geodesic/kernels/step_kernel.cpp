#include "geodesic/kernels/step_kernel.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geodesic/kernels/step_kernel.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
// clang-format off
#include "hwy/highway.h"
#include "hwy/contrib/math/math-inl.h"
#include "geodesic/kernels/deformed_points-inl.h"
#include "geodesic/kernels/elastic-inl.h"
#include "geodesic/kernels/multilinear-inl.h"
#include "geodesic/kernels/vectors-inl.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace morphodesic::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// At most 8 lanes in double precision: level 3, the coarsest one, has 8 cells per row. In single precision level 4.
using Double = hn::CappedTag<double, 8>;
using Single = hn::CappedTag<float, 16>;
constexpr double inverse_pi = 0.31830988618379067154;

/// The monomials prod_{a in m} t_a, m a set of axes as bits, at the quadrature points; t counts from the cell's middle
/// in units of h. Multilinear functions have one coefficient for each, as for each corner, but take fewer operations.
template <int Dim, Quadrature Rule, class T>
struct MonomialTable {
    static constexpr auto& at = quadrature::points<Dim, Rule>;
    static constexpr int points = static_cast<int>(at.size());
    T coordinate[points][Dim];  // from the cell's lower corner
    T value[points][1 << Dim];

    constexpr MonomialTable() : coordinate(), value() {
        for (int q = 0; q < points; ++q) {
            for (int a = 0; a < Dim; ++a) coordinate[q][a] = static_cast<T>(exact(q, a));
            for (int m = 0; m < (1 << Dim); ++m) {
                double product = 1.0;
                for (int a = 0; a < Dim; ++a) product *= ((m >> a) & 1) ? exact(q, a) - 0.5 : 1.0;
                value[q][m] = static_cast<T>(product);
            }
        }
    }
    static constexpr double exact(int point, int axis) {
        return at[static_cast<std::size_t>(point)][static_cast<std::size_t>(axis)];
    }
};
template <int Dim, Quadrature Rule, class T>
constexpr MonomialTable<Dim, Rule, T> monomial_table{};

/// Corner values of a multilinear function -> its coefficients of the monomials, in place.
template <int Dim, class D>
HWY_INLINE void to_monomials(D d, V<D> (&v)[1 << Dim]) {
    for (int a = 0; a < Dim; ++a) {
        for (int c = 0; c < (1 << Dim); ++c) {
            if ((c >> a) & 1) continue;
            const V<D> low = v[c], high = v[c | (1 << a)];
            v[c] = hn::Mul(hn::Add(low, high), all(d, 0.5));
            v[c | (1 << a)] = hn::Sub(high, low);
        }
    }
}

/// Derivatives by the coefficients of the monomials -> by the corner values (the transposed map), in place.
template <int Dim, class D>
HWY_INLINE void to_corners(D d, V<D> (&g)[1 << Dim]) {
    for (int a = 0; a < Dim; ++a) {
        for (int c = 0; c < (1 << Dim); ++c) {
            if ((c >> a) & 1) continue;
            const V<D> mean = hn::Mul(g[c], all(d, 0.5)), difference = g[c | (1 << a)];
            g[c] = hn::Sub(mean, difference);
            g[c | (1 << a)] = hn::Add(mean, difference);
        }
    }
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

template <int Dim, Quadrature Rule, class D>
StepSums StepEnergyRows(D d, int row_begin, int row_end, const StepFields<Dim, T<D>>& f, const StepWeights& s,
                        const StepGradients<Dim, T<D>>& g) {
    const int lanes = static_cast<int>(hn::Lanes(d));
    constexpr auto& table = monomial_table<Dim, Rule, T<D>>;
    constexpr int corners = 1 << Dim, points = table.points;
    const int cells = f.cells[0], cells_per_unit = 1 << s.level;
    double cell_volume = 1.0;
    for (int a = 0; a < Dim; ++a) cell_volume /= cells_per_unit;
    const double quadrature_weight = cell_volume / points;

    NodeRange<Dim> range{NodeDistances<Dim>(f.cells), {}, {}};
    const auto& nodes = range.distance;
    for (int a = 0; a < Dim; ++a) range.last[a] = f.cells[a];
    range.first[Dim - 1] = f.u_next_first_row;
    range.last[Dim - 1] = f.u_next_last_row;

    const bool with_gradient = g.displacement[0] != nullptr;
    const bool with_previous = with_gradient && g.u_previous != nullptr;
    const bool with_next = with_gradient && g.u_next != nullptr;
    T<D>* const u_next_gradient = with_next ? g.u_next - f.u_next_first_row * nodes.axis[Dim - 1] : nullptr;

    const V<D> one = all(d, 1.0), zero = hn::Zero(d);
    const V<D> inverse_h = all(d, static_cast<double>(cells_per_unit));
    const V<D> inverse_eps = all(d, 1.0 / s.eps);
    const V<D> delta_factor = all(d, inverse_pi / s.eps);
    const V<D> mu = all(d, s.mu), half_mu = all(d, 0.5 * s.mu);
    const V<D> quarter_lambda = all(d, 0.25 * s.lambda), half_lambda = all(d, 0.5 * s.lambda);
    const V<D> log_factor = all(d, s.mu + 0.5 * s.lambda);
    const V<D> stiffness_range = all(d, 1.0 - s.delta), least_stiffness = all(d, s.delta);
    const V<D> barrier_factor = all(d, cell_volume / corners * s.barrier);
    const V<D> deformation_factor = all(d, quadrature_weight * s.deformation);
    const V<D> match_factor = all(d, 2.0 * quadrature_weight * s.mismatch);

    // Gradients at the nodes of a row: left and right nodes of the cells apart, so that stores never overlap loads.
    constexpr int outputs = Dim + 1;
    const auto padded = static_cast<std::size_t>(cells);
    static thread_local std::vector<T<D>> rows;
    rows.resize(static_cast<std::size_t>(outputs * corners) * padded);

    // At quadrature point q: a multilinear function by its constant and its other coefficients, and B = D phi - I by
    // those of w.
    const auto value_at = [&](int q, const V<D>& constant, const V<D>(&v)[corners]) HWY_ATTR {
        V<D> sum = constant;
        for (int m = 1; m < corners; ++m) sum = hn::MulAdd(hn::Set(d, table.value[q][m]), v[m], sum);
        return sum;
    };
    const auto gradient_at = [&](int q, const V<D>(&w)[Dim][corners], V<D>(&b)[Dim][Dim]) HWY_ATTR {
        for (int a = 0; a < Dim; ++a) {
            for (int j = 0; j < Dim; ++j) {
                b[a][j] = w[a][1 << j];
                for (int m = 1; m < corners; ++m) {
                    if (((m >> j) & 1) && m != (1 << j)) {
                        b[a][j] = hn::MulAdd(hn::Set(d, table.value[q][m ^ (1 << j)]), w[a][m], b[a][j]);
                    }
                }
            }
        }
    };

    V<D> min_det = all(d, 1e30);
    StepSums sums;
    constexpr std::size_t most_lanes = hn::MaxLanes(d);

    const int middle_rows = Dim == 3 ? f.cells[1] : 1;
    for (int row = row_begin; row < row_end; ++row) {
        for (int middle = 0; middle < middle_rows; ++middle) {
            V<D> sum_deformation = zero, sum_mismatch = zero, sum_barrier = zero;
            const std::ptrdiff_t row_base = row * nodes.axis[Dim - 1] + (Dim == 3 ? middle * nodes.axis[1] : 0);
            for (int i = 0; i < cells; i += lanes) {
                // Displacements w in units of h; gradients in them by their corners, or by monomials.
                V<D> w[Dim][corners], u[corners], chi[corners], grad_corner[Dim][corners], grad_w[Dim][corners],
                    grad_u[corners];
                for (int c = 0; c < corners; ++c) {
                    const std::ptrdiff_t at = row_base + i + nodes.corner[c];
                    for (int a = 0; a < Dim; ++a) {
                        w[a][c] = hn::Mul(hn::LoadU(d, f.displacement[a] + at), inverse_h);
                        grad_corner[a][c] = grad_w[a][c] = zero;
                    }
                    u[c] = hn::LoadU(d, f.u_previous + at);
                    grad_u[c] = zero;
                    chi[c] = f.mask ? hn::LoadU(d, f.mask + at) : one;
                }
                const V<D> least_corner = least_corner_determinant<Dim>(d, w);
                min_det = hn::Min(min_det, least_corner);
                if (!hn::AllFalse(d, hn::Lt(least_corner, all(d, barrier_onset)))) {
                    sum_barrier = hn::Add(sum_barrier, barrier<Dim>(d, w, barrier_factor, grad_corner));
                }
                for (int a = 0; a < Dim; ++a) to_monomials<Dim>(d, w[a]);
                to_monomials<Dim>(d, u);
                if (f.mask) to_monomials<Dim>(d, chi);

                V<D> own[Dim];
                for (int a = 0; a < Dim; ++a) {
                    own[a] = a == 0 ? hn::Iota(d, static_cast<T<D>>(i)) : a == Dim - 1 ? all(d, row) : all(d, middle);
                }
                DeformedPoints<Dim, points, D> there(d, range, own);
                for (int q = 0; q < points; ++q) {
                    for (int a = 0; a < Dim; ++a) {
                        there.set(d, q, a, value_at(q, hn::Add(w[a][0], hn::Set(d, table.coordinate[q][a])), w[a]));
                    }
                }
                there.read(d, f.u_next);

                // The points go through these loops side by side: each waits for arc tangents or divisions, and while
                // loops are short a processor looks far enough ahead to work on the next points meanwhile.
                V<D> stiffness[points], delta_here[points], match[points], force[points];
                for (int q = 0; q < points; ++q) {
                    V<D> delta_there;
                    const V<D> inside = smooth_heaviside(d, value_at(q, u[0], u), inverse_eps, delta_here[q]);
                    const V<D> residual = hn::Sub(smooth_heaviside(d, there.u[q], inverse_eps, delta_there), inside);
                    stiffness[q] = hn::MulAdd(stiffness_range, inside, least_stiffness);
                    const V<D> masked_residual = f.mask ? hn::Mul(value_at(q, chi[0], chi), residual) : residual;
                    sum_mismatch = hn::MulAdd(masked_residual, residual, sum_mismatch);
                    match[q] = hn::Mul(match_factor, masked_residual);
                    force[q] = hn::Mul(match[q], hn::Mul(delta_there, delta_factor));
                }

                // W = mu (|B|^2 / 2 - higher) + lambda/4 D^2 + (mu + lambda/2) (D - log(1 + D)), D = det - 1.
                V<D> density[points], pressure[points];
                for (int q = 0; q < points; ++q) {
                    V<D> b[Dim][Dim], norm = zero;
                    gradient_at(q, w, b);
                    for (int a = 0; a < Dim; ++a) {
                        for (int j = 0; j < Dim; ++j) norm = hn::MulAdd(b[a][j], b[a][j], norm);
                    }
                    V<D> det_minus_one, higher, inverse_det;
                    determinant_minus_one<Dim>(d, b, det_minus_one, higher);
                    min_det = hn::Min(min_det, hn::Add(one, det_minus_one));
                    density[q] = hn::NegMulAdd(mu, higher, hn::Mul(half_mu, norm));
                    density[q] = hn::MulAdd(quarter_lambda, hn::Mul(det_minus_one, det_minus_one), density[q]);
                    density[q] = hn::MulAdd(log_factor, minus_log1p(d, det_minus_one, inverse_det), density[q]);
                    sum_deformation = hn::MulAdd(stiffness[q], density[q], sum_deformation);
                    // c of first_piola is lambda/2 det - (mu + lambda/2) / det + mu.
                    pressure[q] = hn::MulAdd(half_lambda, det_minus_one,
                                             hn::Mul(hn::Mul(log_factor, det_minus_one), inverse_det));
                }
                if (!with_gradient) continue;

                for (int q = 0; q < points; ++q) {
                    V<D> b[Dim][Dim], p[Dim][Dim];
                    gradient_at(q, w, b);
                    first_piola<Dim>(d, b, mu, pressure[q], p);
                    const V<D> stress_factor = hn::Mul(deformation_factor, stiffness[q]);
                    for (int a = 0; a < Dim; ++a) {
                        const V<D> body = hn::Mul(force[q], there.slope[q][a]);
                        for (int j = 0; j < Dim; ++j) p[a][j] = hn::Mul(p[a][j], stress_factor);
                        grad_w[a][0] = hn::Add(grad_w[a][0], body);
                        for (int m = 1; m < corners; ++m) {
                            V<D> sum = hn::MulAdd(hn::Set(d, table.value[q][m]), body, grad_w[a][m]);
                            for (int j = 0; j < Dim; ++j) {
                                if (m == (1 << j)) {
                                    sum = hn::Add(sum, p[a][j]);
                                } else if ((m >> j) & 1) {
                                    sum = hn::MulAdd(hn::Set(d, table.value[q][m ^ (1 << j)]), p[a][j], sum);
                                }
                            }
                            grad_w[a][m] = sum;
                        }
                    }
                }
                for (int q = 0; with_previous && q < points; ++q) {
                    const V<D> softness = hn::Mul(hn::Mul(stiffness_range, deformation_factor), density[q]);
                    const V<D> coefficient = hn::Mul(hn::Mul(delta_here[q], delta_factor), hn::Sub(softness, match[q]));
                    grad_u[0] = hn::Add(grad_u[0], coefficient);
                    for (int m = 1; m < corners; ++m) {
                        grad_u[m] = hn::MulAdd(hn::Set(d, table.value[q][m]), coefficient, grad_u[m]);
                    }
                }
                if (with_next) there.write(d, force, u_next_gradient);

                T<D>* target = rows.data() + i;
                for (int a = 0; a < Dim; ++a) {
                    to_corners<Dim>(d, grad_w[a]);
                    for (int k = 0; k < corners; ++k, target += padded) {
                        hn::StoreU(hn::Mul(hn::Add(grad_w[a][k], grad_corner[a][k]), inverse_h), d, target);
                    }
                }
                to_corners<Dim>(d, grad_u);
                for (int k = 0; k < corners; ++k, target += padded) hn::StoreU(grad_u[k], d, target);
            }

            for (int output = 0; with_gradient && output < (with_previous ? outputs : Dim); ++output) {
                T<D>* field = output < Dim ? g.displacement[output] : g.u_previous;
                for (int k = 0; k < corners; ++k) {
                    const T<D>* source = rows.data() + static_cast<std::size_t>(output * corners + k) * padded;
                    T<D>* out = field + row_base + nodes.corner[k];
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

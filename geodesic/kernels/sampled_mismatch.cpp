#include "geodesic/kernels/sampled_mismatch.h"

#include <cassert>
#include <cstdint>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geodesic/kernels/sampled_mismatch.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
// clang-format off
#include "hwy/highway.h"
#include "hwy/contrib/math/math-inl.h"
#include "geodesic/kernels/multilinear-inl.h"
#include "geodesic/kernels/vectors-inl.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace morphodesic::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Values of the shape functions of the corners at places in the cell.
template <int Dim, class D>
HWY_INLINE void corner_shares(D d, const V<D> (&fraction)[Dim], V<D> (&shares)[1 << Dim]) {
    shares[0] = all(d, 1.0);
    for (int a = 0; a < Dim; ++a) {
        for (int c = 0; c < (1 << a); ++c) {
            shares[c | (1 << a)] = hn::Mul(shares[c], fraction[a]);
            shares[c] = hn::Sub(shares[c], shares[c | (1 << a)]);
        }
    }
}

template <int Dim, class FieldT>
SampledSums<Dim> SampledMismatch(const SampledCell<Dim, FieldT>& cell, const SamplePoints<Dim>& points, bool gradient,
                                 double scale, FieldT* u_next) {
    constexpr int corners = 1 << Dim;
    const hn::CappedTag<double, sample_lanes> d;
    using D = decltype(d);
    const hn::RebindToSigned<D> di;
    using Values = V<D>;
    const std::size_t lanes = hn::Lanes(d);
    const NodeDistances<Dim> nodes(cell.cells);
    const Values one = all(d, 1.0), inverse_eps = all(d, 1.0 / cell.eps), inverse_pi = all(d, std::numbers::inv_pi);
    const Values peak = all(d, 2.0 * std::numbers::inv_pi / cell.eps);  // of delta_eps, times 2
    Values u[corners], chi[corners], w[Dim][corners];
    Values sum = hn::Zero(d), sum_w[Dim][corners], sum_u[corners];
    for (int c = 0; c < corners; ++c) {
        u[c] = all(d, cell.u[c]);
        chi[c] = all(d, cell.chi[c]);
        sum_u[c] = hn::Zero(d);
        for (int a = 0; a < Dim; ++a) {
            w[a][c] = all(d, cell.w[a][c]);
            sum_w[a][c] = hn::Zero(d);
        }
    }
    for (std::size_t i = 0; i < points.count; i += lanes) {
        Values here[Dim], there[Dim], inside[Dim], slope[Dim], unused[Dim], v[corners];
        for (int a = 0; a < Dim; ++a) here[a] = hn::LoadU(d, points.x[a] + i);
        for (int a = 0; a < Dim; ++a) {
            const Values moved =
                hn::Add(hn::Add(all(d, cell.low[a]), here[a]), multilinear<Dim>(d, w[a], here, unused));
            inside[a] = hn::Min(hn::Max(moved, all(d, cell.first[a])), all(d, cell.last[a]));
        }
        const auto node = cells_at<Dim>(d, nodes, cell.last, inside, there);
        for (int c = 0; c < corners; ++c) v[c] = gather(d, cell.u_next + nodes.corner[c], node);
        const Values before = hn::Mul(multilinear<Dim>(d, u, here, unused), inverse_eps);
        const Values after = hn::Mul(multilinear<Dim>(d, v, there, slope), inverse_eps);
        const Values factor = hn::Mul(hn::LoadU(d, points.factor + i), multilinear<Dim>(d, chi, here, unused));
        const Values difference = hn::Mul(hn::Sub(hn::Atan(d, after), hn::Atan(d, before)), inverse_pi);
        const Values weighted = hn::Mul(factor, difference);
        sum = hn::MulAdd(weighted, difference, sum);
        if (!gradient) continue;

        const Values pull = hn::Mul(weighted, peak);
        const Values force = hn::Div(pull, hn::MulAdd(after, after, one));
        const Values back = hn::Div(pull, hn::MulAdd(before, before, one));
        Values shares[corners];
        corner_shares<Dim>(d, here, shares);
        for (int a = 0; a < Dim; ++a) {
            const Values along = hn::Mul(force, slope[a]);
            for (int c = 0; c < corners; ++c) sum_w[a][c] = hn::MulAdd(along, shares[c], sum_w[a][c]);
        }
        for (int c = 0; c < corners; ++c) sum_u[c] = hn::NegMulAdd(back, shares[c], sum_u[c]);
        if (!u_next) continue;
        const Values scaled = hn::Mul(force, all(d, scale));
        corner_shares<Dim>(d, there, shares);
        HWY_ALIGN std::int64_t to[sample_lanes];
        HWY_ALIGN double change[corners][sample_lanes];
        hn::Store(hn::ConvertTo(di, hn::Sub(node, all(d, static_cast<double>(cell.begin)))), di, to);
        for (int c = 0; c < corners; ++c) hn::Store(hn::Mul(scaled, shares[c]), d, change[c]);
        for (std::size_t l = 0; l < lanes; ++l) {
            for (int c = 0; c < corners; ++c) u_next[to[l] + nodes.corner[c]] += static_cast<FieldT>(change[c][l]);
        }
    }
    SampledSums<Dim> sums;
    sums.mismatch = hn::GetLane(hn::SumOfLanes(d, sum));
    for (int c = 0; c < corners; ++c) {
        sums.u[c] = hn::GetLane(hn::SumOfLanes(d, sum_u[c]));
        for (int a = 0; a < Dim; ++a) sums.w[a][c] = hn::GetLane(hn::SumOfLanes(d, sum_w[a][c]));
    }
    return sums;
}

#define MORPHODESIC_SAMPLED(Name, Dim, FieldT)                                                                  \
    SampledSums<Dim> Name(const SampledCell<Dim, FieldT>& cell, const SamplePoints<Dim>& points, bool gradient, \
                          double scale, FieldT* u_next) {                                                       \
        return SampledMismatch<Dim, FieldT>(cell, points, gradient, scale, u_next);                             \
    }
MORPHODESIC_SAMPLED(SampledMismatch2, 2, double)
MORPHODESIC_SAMPLED(SampledMismatch3, 3, double)
MORPHODESIC_SAMPLED(SampledMismatch2Single, 2, float)
MORPHODESIC_SAMPLED(SampledMismatch3Single, 3, float)
#undef MORPHODESIC_SAMPLED

}  // namespace morphodesic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace morphodesic::kernels {

#define MORPHODESIC_SAMPLED(Name, Dim, FieldT)                                                                   \
    HWY_EXPORT(Name);                                                                                            \
    template <>                                                                                                  \
    SampledSums<Dim> sampled_mismatch<Dim, FieldT>(const SampledCell<Dim, FieldT>& cell,                         \
                                                   const SamplePoints<Dim>& points, bool gradient, double scale, \
                                                   FieldT* u_next) {                                             \
        assert(points.count % sample_lanes == 0);                                                                \
        return HWY_DYNAMIC_DISPATCH(Name)(cell, points, gradient, scale, u_next);                                \
    }
MORPHODESIC_SAMPLED(SampledMismatch2, 2, double)
MORPHODESIC_SAMPLED(SampledMismatch3, 3, double)
MORPHODESIC_SAMPLED(SampledMismatch2Single, 2, float)
MORPHODESIC_SAMPLED(SampledMismatch3Single, 3, float)
#undef MORPHODESIC_SAMPLED

}  // namespace morphodesic::kernels
#endif

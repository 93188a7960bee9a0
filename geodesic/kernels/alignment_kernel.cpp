#include "geodesic/kernels/alignment_kernel.h"

#include <algorithm>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geodesic/kernels/alignment_kernel.cpp"
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

template <int Dim>
void AddRow(const AlignmentRow<Dim>& row, bool derivatives, AlignmentSums<Dim>& sums) {
    constexpr int unknowns = motion_unknowns<Dim>, angles = unknowns - Dim, corners = 1 << Dim;
    const hn::CappedTag<double, 8> d;
    using Values = V<decltype(d)>;
    const NodeDistances<Dim> nodes(row.cells);
    const Values zero = hn::Zero(d), one = all(d, 1.0), inverse_eps = all(d, 1.0 / row.eps);
    const Values peak =
        all(d, std::numbers::inv_pi / (row.eps * row.spacing));  // of delta_eps, times 1 / h of the slopes
    Values square = zero, force_sum[unknowns], product_sum[unknowns][unknowns];
    for (int i = 0; i < unknowns; ++i) {
        force_sum[i] = zero;
        for (int j = 0; j <= i; ++j) product_sum[i][j] = zero;
    }
    const std::size_t lanes = hn::Lanes(d);
    HWY_ALIGN double rest[8] = {};
    const auto targets_from = [&](std::size_t i) {  // nothing is read beyond the row
        if (i + lanes <= row.count) return row.target + i;
        std::copy(row.target + i, row.target + row.count, rest);
        return static_cast<const double*>(rest);
    };
    for (std::size_t i = 0; i < row.count; i += lanes) {
        const Values index = hn::Iota(d, static_cast<double>(i));
        const auto exists = hn::Lt(index, all(d, static_cast<double>(row.count)));
        Values inside[Dim], fraction[Dim], beyond = zero;
        for (int a = 0; a < Dim; ++a) {
            const Values place = hn::MulAdd(index, all(d, row.step[a]), all(d, row.first[a]));
            inside[a] = hn::Min(hn::Max(place, zero), all(d, row.cells[a]));
            const Values over = hn::Sub(place, inside[a]);
            beyond = hn::MulAdd(over, over, beyond);
        }
        const auto node =
            hn::ConvertTo(hn::RebindToSigned<decltype(d)>(), cells_at<Dim>(d, nodes, row.cells, inside, fraction));
        Values v[corners], slope[Dim];
        for (int c = 0; c < corners; ++c) v[c] = hn::GatherIndex(d, row.field + nodes.corner[c], node);
        const Values u = hn::NegMulAdd(hn::Sqrt(beyond), all(d, row.spacing), multilinear<Dim>(d, v, fraction, slope));
        const Values t = hn::Mul(u, inverse_eps);
        const Values heaviside = hn::MulAdd(hn::Atan(d, t), all(d, std::numbers::inv_pi), all(d, 0.5));
        const Values residual = hn::IfThenElseZero(exists, hn::Sub(heaviside, hn::LoadU(d, targets_from(i))));
        square = hn::MulAdd(residual, residual, square);
        if (!derivatives) continue;

        const Values delta = hn::IfThenElseZero(exists, hn::Div(peak, hn::MulAdd(t, t, one)));
        Values force[Dim], z[Dim], derivative[unknowns];
        for (int a = 0; a < Dim; ++a) {
            Values turned = zero;
            for (int b = 0; b < Dim; ++b) turned = hn::MulAdd(all(d, row.rotation[a][b]), slope[b], turned);
            force[a] = hn::Mul(turned, delta);
            z[a] = all(d, row.from_centre[a]);
            derivative[angles + a] = hn::Neg(force[a]);
        }
        z[0] = hn::MulAdd(index, all(d, row.spacing), z[0]);
        // - z x force, in 2D its third component.
        for (int a = 0; a < angles; ++a) {
            const int j = Dim == 2 ? 0 : (a + 1) % 3, k = Dim == 2 ? 1 : (a + 2) % 3;
            derivative[a] = row.rotate ? hn::MulSub(z[k], force[j], hn::Mul(z[j], force[k])) : zero;
        }
        for (int a = 0; a < unknowns; ++a) {
            force_sum[a] = hn::MulAdd(residual, derivative[a], force_sum[a]);
            for (int b = 0; b <= a; ++b)
                product_sum[a][b] = hn::MulAdd(derivative[a], derivative[b], product_sum[a][b]);
        }
    }
    sums.square += hn::GetLane(hn::SumOfLanes(d, square));
    for (int a = 0; derivatives && a < unknowns; ++a) {
        sums.force[a] += hn::GetLane(hn::SumOfLanes(d, force_sum[a]));
        for (int b = 0; b <= a; ++b) sums.product[a][b] += hn::GetLane(hn::SumOfLanes(d, product_sum[a][b]));
    }
}

void AddRow2(const AlignmentRow<2>& row, bool derivatives, AlignmentSums<2>& sums) {
    AddRow<2>(row, derivatives, sums);
}
void AddRow3(const AlignmentRow<3>& row, bool derivatives, AlignmentSums<3>& sums) {
    AddRow<3>(row, derivatives, sums);
}

}  // namespace morphodesic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace morphodesic::kernels {

HWY_EXPORT(AddRow2);
HWY_EXPORT(AddRow3);

template <>
void add_row<2>(const AlignmentRow<2>& row, bool derivatives, AlignmentSums<2>& sums) {
    HWY_DYNAMIC_DISPATCH(AddRow2)(row, derivatives, sums);
}
template <>
void add_row<3>(const AlignmentRow<3>& row, bool derivatives, AlignmentSums<3>& sums) {
    HWY_DYNAMIC_DISPATCH(AddRow3)(row, derivatives, sums);
}

}  // namespace morphodesic::kernels
#endif

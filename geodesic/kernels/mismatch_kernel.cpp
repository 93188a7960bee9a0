#include "geodesic/kernels/mismatch_kernel.h"

#include <algorithm>
#include <cassert>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geodesic/kernels/mismatch_kernel.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
// clang-format off
#include "hwy/highway.h"
#include "geodesic/kernels/multilinear-inl.h"
#include "geodesic/kernels/vectors-inl.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace morphodesic::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr double far_away = 6.0;  // from a contour, in units of eps

template <int Dim, class D>
HWY_INLINE void least_and_most(const V<D> (&v)[1 << Dim], V<D>& least, V<D>& most) {
    least = most = v[0];
    for (int c = 1; c < (1 << Dim); ++c) {
        least = hn::Min(least, v[c]);
        most = hn::Max(most, v[c]);
    }
}

template <int Dim>
bool MismatchPointsOf(const MismatchRow<Dim>& row, const std::array<double, Dim>* points, std::size_t count,
                      MismatchRowPoints<Dim>& found) {
    constexpr int corners = 1 << Dim;
    const hn::CappedTag<double, 8> d;
    using Values = V<decltype(d)>;
    const hn::RebindToSigned<decltype(d)> di;
    const std::size_t lanes = hn::Lanes(d), cells = static_cast<std::size_t>(row.cells[0]);
    const NodeDistances<Dim> nodes(row.cells);
    const Values zero = hn::Zero(d), one = all(d, 1.0), per_cell = all(d, row.cells_per_unit);
    const Values far = all(d, far_away * row.eps), square_eps = all(d, row.eps * row.eps);
    const Values peak = all(d, row.eps * std::numbers::inv_pi);
    // Displacements stretch a cell two times at most where it matters.
    const Values far_and_cells = all(d, far_away * row.eps + 2.0 / row.cells_per_unit);
    std::ptrdiff_t first = 0;
    for (int a = 0; a < Dim; ++a) first += row.low[a] * nodes.axis[a];
    bool any = false;
    for (std::size_t i = 0; i < cells; i += lanes) {
        const std::ptrdiff_t node = first + static_cast<std::ptrdiff_t>(i);
        Values from[corners], w[Dim][corners], own[Dim];  // w in units of h
        for (int c = 0; c < corners; ++c) {
            from[c] = hn::LoadU(d, row.from + node + nodes.corner[c]);
            for (int a = 0; a < Dim; ++a) w[a][c] = hn::Mul(hn::LoadU(d, row.w[a] + node + nodes.corner[c]), per_cell);
        }
        for (int a = 0; a < Dim; ++a) own[a] = all(d, row.low[a]);
        own[0] = hn::Add(own[0], hn::Iota(d, static_cast<double>(i)));
        const auto read_at = [&](const Values(&x)[Dim], Values(&to)[corners], Values(&fraction)[Dim]) HWY_ATTR {
            const auto at = hn::ConvertTo(di, cells_around<Dim>(d, nodes, row.cells, x, fraction));
            for (int c = 0; c < corners; ++c) to[c] = hn::GatherIndex(d, row.to + nodes.corner[c], at);
            return at;
        };
        // A cell that is far from both contours has no part in it. Shapes between need not be distances: where two
        // cracks meet they are steep, and far is what is far for the values around.
        Values least, most, to[corners], fraction[Dim];
        least_and_most<Dim, decltype(d)>(from, least, most);
        const Values far_from = hn::Mul(far, hn::Max(one, hn::Mul(hn::Sub(most, least), per_cell)));
        auto in_reach = hn::And(hn::Lt(least, far_from), hn::Gt(most, hn::Neg(far_from)));
        if (!hn::AllTrue(d, in_reach)) {
            Values middle[Dim];
            for (int a = 0; a < Dim; ++a) {
                middle[a] = zero;
                for (int c = 0; c < corners; ++c) middle[a] = hn::Add(middle[a], w[a][c]);
                middle[a] = hn::MulAdd(middle[a], all(d, 1.0 / corners), hn::Add(own[a], all(d, 0.5)));
            }
            read_at(middle, to, fraction);
            least_and_most<Dim, decltype(d)>(to, least, most);
            const Values reach = hn::Mul(far_and_cells, hn::Max(one, hn::Mul(hn::Sub(most, least), per_cell)));
            in_reach = hn::Or(in_reach, hn::And(hn::Le(least, reach), hn::Ge(most, hn::Neg(reach))));
        }
        if (hn::AllFalse(d, in_reach)) {
            for (std::size_t q = 0; q < count; ++q) std::fill_n(found.near.begin() + q * cells + i, lanes, 0);
            continue;
        }
        for (std::size_t q = 0; q < count; ++q) {
            Values x[Dim], place[Dim], slope[Dim], unused[Dim];
            for (int a = 0; a < Dim; ++a) place[a] = all(d, points[q][static_cast<std::size_t>(a)]);
            for (int a = 0; a < Dim; ++a)
                x[a] = hn::Add(hn::Add(own[a], place[a]), multilinear<Dim>(d, w[a], place, unused));
            const Values before = multilinear<Dim>(d, from, place, unused);
            const auto at = read_at(x, to, fraction);
            const Values after = multilinear<Dim>(d, to, fraction, slope);
            Values steep = one;
            for (int a = 0; a < Dim; ++a) {
                slope[a] = hn::Mul(slope[a], per_cell);
                steep = hn::Max(steep, hn::Abs(slope[a]));
            }
            const auto near = hn::And(
                in_reach, hn::Or(hn::Le(hn::Abs(after), hn::Mul(far, steep)), hn::Le(hn::Abs(before), far_from)));
            const std::size_t out = q * cells + i;
            HWY_ALIGN std::int64_t marks[8];
            hn::Store(hn::BitCast(di, hn::IfThenElseZero(near, hn::BitCast(d, hn::Set(di, 1)))), di, marks);
            for (std::size_t l = 0; l < lanes; ++l) {
                found.near[out + l] = static_cast<unsigned char>(marks[l]);
            }
            if (hn::AllFalse(d, near)) continue;
            any = true;
            hn::StoreU(at, di, found.node.data() + out);
            hn::StoreU(hn::Div(peak, hn::MulAdd(before, before, square_eps)), d, found.here.data() + out);
            hn::StoreU(hn::Div(peak, hn::MulAdd(after, after, square_eps)), d, found.there.data() + out);
            for (int a = 0; a < Dim; ++a) {
                hn::StoreU(fraction[a], d, found.fraction[a].data() + out);
                hn::StoreU(slope[a], d, found.slope[a].data() + out);
            }
        }
    }
    return any;
}

bool MismatchPointsOf2(const MismatchRow<2>& row, const std::array<double, 2>* points, std::size_t count,
                       MismatchRowPoints<2>& found) {
    return MismatchPointsOf<2>(row, points, count, found);
}
bool MismatchPointsOf3(const MismatchRow<3>& row, const std::array<double, 3>* points, std::size_t count,
                       MismatchRowPoints<3>& found) {
    return MismatchPointsOf<3>(row, points, count, found);
}

}  // namespace morphodesic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace morphodesic::kernels {

HWY_EXPORT(MismatchPointsOf2);
HWY_EXPORT(MismatchPointsOf3);

template <int Dim>
void MismatchRowPoints<Dim>::resize(std::size_t points) {
    near.resize(points);
    node.resize(points);
    for (auto* values : {&here, &there}) values->resize(points);
    for (auto* fields : {&fraction, &slope}) {
        for (auto& values : *fields) values.resize(points);
    }
}
template struct MismatchRowPoints<2>;
template struct MismatchRowPoints<3>;

template <int Dim>
bool mismatch_points_of(const MismatchRow<Dim>& row, std::span<const std::array<double, Dim>> points,
                        MismatchRowPoints<Dim>& found) {
    assert(row.cells[0] % 8 == 0);
    found.resize(points.size() * static_cast<std::size_t>(row.cells[0]));
    if constexpr (Dim == 2) {
        return HWY_DYNAMIC_DISPATCH(MismatchPointsOf2)(row, points.data(), points.size(), found);
    } else {
        return HWY_DYNAMIC_DISPATCH(MismatchPointsOf3)(row, points.data(), points.size(), found);
    }
}
template bool mismatch_points_of<2>(const MismatchRow<2>&, std::span<const std::array<double, 2>>,
                                    MismatchRowPoints<2>&);
template bool mismatch_points_of<3>(const MismatchRow<3>&, std::span<const std::array<double, 3>>,
                                    MismatchRowPoints<3>&);

}  // namespace morphodesic::kernels
#endif

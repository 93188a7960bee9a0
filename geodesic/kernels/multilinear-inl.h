// Included once for every instruction set by the kernels, see foreach_target.h of Highway.
#if defined(MORPHODESIC_MULTILINEAR_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MORPHODESIC_MULTILINEAR_INL_H
#undef MORPHODESIC_MULTILINEAR_INL_H
#else
#define MORPHODESIC_MULTILINEAR_INL_H
#endif

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "geodesic/kernels/vectors-inl.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace morphodesic::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// How far apart nodes are in memory: along the axes, and the corners of a cell from its first node.
template <int Dim>
struct NodeDistances {
    std::ptrdiff_t axis[Dim], corner[1 << Dim];

    explicit NodeDistances(const int (&cells)[Dim]) {
        axis[0] = 1;
        for (int a = 1; a < Dim; ++a) axis[a] = axis[a - 1] * (cells[a - 1] + 1);
        for (int c = 0; c < (1 << Dim); ++c) {
            corner[c] = 0;
            for (int a = 0; a < Dim; ++a) corner[c] += ((c >> a) & 1) * axis[a];
        }
    }
};

/// The first nodes (whole numbers) of the cells that hold the places `inside`, in units of h and in the grid, and the
/// places in them. In double precision.
template <int Dim, class D>
HWY_INLINE V<D> cells_at(D d, const NodeDistances<Dim>& nodes, const int (&cells)[Dim], const V<D> (&inside)[Dim],
                         V<D> (&fraction)[Dim]) {
    V<D> node = hn::Zero(d);
    for (int a = 0; a < Dim; ++a) {
        const V<D> cell = hn::Min(hn::Floor(inside[a]), all(d, cells[a] - 1));
        fraction[a] = hn::Sub(inside[a], cell);
        node = hn::MulAdd(cell, all(d, static_cast<double>(nodes.axis[a])), node);
    }
    return node;
}

/// The same of places anywhere; those outside count as the nearest ones in the grid.
template <int Dim, class D>
HWY_INLINE V<D> cells_around(D d, const NodeDistances<Dim>& nodes, const int (&cells)[Dim], const V<D> (&x)[Dim],
                             V<D> (&fraction)[Dim]) {
    V<D> inside[Dim];
    for (int a = 0; a < Dim; ++a) inside[a] = hn::Min(hn::Max(x[a], hn::Zero(d)), all(d, cells[a]));
    return cells_at<Dim>(d, nodes, cells, inside, fraction);
}

/// Values of a field, in single or double precision, at nodes, which are given as cells_at() does.
template <class D, class FieldT>
HWY_INLINE V<D> gather(D d, const FieldT* field, V<D> node) {
    if constexpr (std::is_same_v<FieldT, double>) {
        return hn::GatherIndex(d, field, hn::ConvertTo(hn::RebindToSigned<D>(), node));
    } else {
        const hn::Rebind<float, D> single;
        return hn::PromoteTo(d, hn::GatherIndex(single, field, hn::DemoteTo(hn::Rebind<std::int32_t, D>(), node)));
    }
}

/// Value and gradient (in units of 1 / h) of the multilinear function with corner values v at a point of the cell.
template <int Dim, class D>
HWY_INLINE V<D> multilinear(D, const V<D> (&v)[1 << Dim], const V<D> (&fraction)[Dim], V<D> (&gradient)[Dim]) {
    if constexpr (Dim == 2) {
        const V<D> low = hn::Sub(v[1], v[0]), high = hn::Sub(v[3], v[2]);
        const V<D> bottom = hn::MulAdd(fraction[0], low, v[0]);
        const V<D> top = hn::MulAdd(fraction[0], high, v[2]);
        gradient[0] = hn::MulAdd(fraction[1], hn::Sub(high, low), low);
        gradient[1] = hn::Sub(top, bottom);
        return hn::MulAdd(fraction[1], gradient[1], bottom);
    } else {
        V<D> slope_x[4], value_x[4];
        for (int c = 0; c < 4; ++c) {
            slope_x[c] = hn::Sub(v[2 * c + 1], v[2 * c]);
            value_x[c] = hn::MulAdd(fraction[0], slope_x[c], v[2 * c]);
        }
        V<D> slope_xy[2], slope_y[2], value_xy[2];
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

}  // namespace morphodesic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

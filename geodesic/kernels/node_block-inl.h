// Included once for every instruction set by the kernels, see foreach_target.h of Highway.
#if defined(MORPHODESIC_NODE_BLOCK_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MORPHODESIC_NODE_BLOCK_INL_H
#undef MORPHODESIC_NODE_BLOCK_INL_H
#else
#define MORPHODESIC_NODE_BLOCK_INL_H
#endif

#include <cstddef>

#include "geodesic/kernels/vectors-inl.h"
#include "hwy/highway.h"

// Loops over the nodes of a block: their indices have to be known when compiling, or the arrays stay in memory.
#undef MORPHODESIC_UNROLL
#ifdef __clang__
#define MORPHODESIC_UNROLL _Pragma("unroll")
#else
#define MORPHODESIC_UNROLL _Pragma("GCC unroll 64")
#endif

HWY_BEFORE_NAMESPACE();
namespace morphodesic::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr int power(int base, int exponent) {
    return exponent == 0 ? 1 : base * power(base, exponent - 1);
}

/// Index of node n of a block of Width nodes per axis, counted from its first node.
template <int Dim, int Width>
HWY_INLINE std::ptrdiff_t node_offset(int n, const std::ptrdiff_t (&stride)[Dim]) {
    std::ptrdiff_t offset = 0;
    for (int a = 0; a < Dim; ++a) offset += (n / power(Width, a) % Width) * stride[a];
    return offset;
}

/// u_k at a block of Width nodes per axis, another one in every lane, and what is to be added to the gradient there.
/// Width is 3 or 4 for all points of a cell, which are deformed into 2 x 2 cells in most lanes: then a node is read and
/// written once for all of them. Width is 2 for the cell around a single point.
template <int Dim, int Width, class D>
struct NodeBlock {
    static constexpr int nodes = power(Width, Dim);
    V<D> u[nodes], gradient[nodes];

    /// Reads u_k; first is the index of each lane's first node.
    template <class Index>
    HWY_INLINE NodeBlock(D d, const T<D>* u_next, Index first, const std::ptrdiff_t (&stride)[Dim]) {
        MORPHODESIC_UNROLL
        for (int n = 0; n < nodes; ++n) {
            u[n] = hn::GatherIndex(d, u_next + node_offset<Dim, Width>(n, stride), first);
            gradient[n] = hn::Zero(d);
        }
    }

    /// Values at the corners of the cell of the block that the point x lies in (in units of h from the block's first
    /// node, in [0, Width - 1]), and the fractions of x in this cell.
    HWY_INLINE void corners(D d, const V<D> (&x)[Dim], V<D> (&v)[1 << Dim], V<D> (&fraction)[Dim]) const {
        V<D> left[nodes];  // axis after axis, the first or last of the nodes is dropped until 2 are left
        MORPHODESIC_UNROLL
        for (int n = 0; n < nodes; ++n) left[n] = u[n];
        MORPHODESIC_UNROLL
        for (int a = 0; a < Dim; ++a) {
            fraction[a] = x[a];
            const int inner = 1 << a, outer = power(Width, Dim - 1 - a);
            MORPHODESIC_UNROLL
            for (int width = Width; width > 2; --width) {
                const auto upper = hn::Ge(fraction[a], all(d, width - 2));
                fraction[a] = hn::Sub(fraction[a], hn::IfThenElseZero(upper, all(d, 1.0)));
                MORPHODESIC_UNROLL
                for (int o = 0; o < outer; ++o) {
                    MORPHODESIC_UNROLL
                    for (int n = 0; n < (width - 1) * inner; ++n) {
                        const int from = o * width * inner + n;
                        left[o * (width - 1) * inner + n] = hn::IfThenElse(upper, left[from + inner], left[from]);
                    }
                }
            }
        }
        MORPHODESIC_UNROLL
        for (int c = 0; c < (1 << Dim); ++c) v[c] = left[c];
    }

    /// Adds value times the shape functions of the nodes at x.
    HWY_INLINE void add(D d, const V<D> (&x)[Dim], V<D> value) {
        const V<D> one = all(d, 1.0), zero = hn::Zero(d);
        V<D> hat[Dim][Width];
        MORPHODESIC_UNROLL
        for (int a = 0; a < Dim; ++a) {
            hat[a][0] = hn::Max(hn::Sub(one, x[a]), zero);
            MORPHODESIC_UNROLL
            for (int n = 1; n < Width - 1; ++n) {
                hat[a][n] = hn::Max(hn::Sub(one, hn::Abs(hn::Sub(x[a], all(d, n)))), zero);
            }
            hat[a][Width - 1] = hn::Max(hn::Sub(x[a], all(d, Width - 2)), zero);
        }
        MORPHODESIC_UNROLL
        for (int k = 0; k < (Dim == 3 ? Width : 1); ++k) {
            V<D> plane = value;
            if constexpr (Dim == 3) plane = hn::Mul(value, hat[2][k]);
            MORPHODESIC_UNROLL
            for (int j = 0; j < Width; ++j) {
                const V<D> row = hn::Mul(plane, hat[1][j]);
                MORPHODESIC_UNROLL
                for (int i = 0; i < Width; ++i) {
                    V<D>& sum = gradient[(k * Width + j) * Width + i];
                    sum = hn::MulAdd(row, hat[0][i], sum);
                }
            }
        }
    }

    /// Adds to the gradient in memory, one lane after the other: blocks of neighbouring lanes overlap.
    template <class Index>
    HWY_INLINE void scatter(D d, T<D>* out, Index first, const std::ptrdiff_t (&stride)[Dim]) const {
        const hn::RebindToSigned<D> di;
        constexpr std::size_t most_lanes = hn::MaxLanes(d);
        HWY_ALIGN hn::TFromD<decltype(di)> base[most_lanes];
        HWY_ALIGN T<D> value[nodes][most_lanes];
        hn::Store(first, di, base);
        MORPHODESIC_UNROLL
        for (int n = 0; n < nodes; ++n) hn::Store(gradient[n], d, value[n]);
        for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
            T<D>* at = out + base[lane];
            MORPHODESIC_UNROLL
            for (int n = 0; n < nodes; ++n) at[node_offset<Dim, Width>(n, stride)] += value[n][lane];
        }
    }
};

}  // namespace morphodesic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

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

/// Where the nodes of a block lie in memory, another block in every lane. Neighbouring cells are mostly deformed into
/// neighbouring ones: lanes whose first nodes follow each other are a run, and a run is read and written as it lies.
template <int Dim, class D>
struct BlockPlaces {
    using Index = hn::Vec<hn::RebindToSigned<D>>;
    static constexpr int most_runs = 4;               // with more of them lanes one by one are as fast
    Index first = hn::Zero(hn::RebindToSigned<D>());  // the first node of each lane's block
    int runs = 0;                                     // 0: too many, or one would reach beyond the field
    std::ptrdiff_t start[most_runs];                  // the first node of a run, if lane 0 were of it
    hn::Mask<D> lanes[most_runs];

    BlockPlaces() = default;
    /// Blocks of so many nodes per axis. Nodes from field_begin to field_end, without the latter, may be touched.
    HWY_INLINE BlockPlaces(D d, Index first_nodes, int width, const std::ptrdiff_t (&stride)[Dim],
                           std::ptrdiff_t field_begin, std::ptrdiff_t field_end)
        : first(first_nodes) {
        if (hn::Lanes(d) < static_cast<std::size_t>(width)) return;  // rows of a run would reach over two vectors
        const hn::RebindToSigned<D> di;
        HWY_ALIGN hn::TFromD<decltype(di)> start_of_lane[hn::MaxLanes(di)];
        const auto starts = hn::Sub(first, hn::Iota(di, 0));
        hn::Store(starts, di, start_of_lane);
        auto reach = static_cast<std::ptrdiff_t>(hn::Lanes(d));
        for (int a = 0; a < Dim; ++a) reach += (width - 1) * stride[a];
        auto rest = hn::FirstN(di, hn::Lanes(di));
        int found = 0;
        while (!hn::AllFalse(di, rest)) {
            const auto begin = start_of_lane[hn::FindKnownFirstTrue(di, rest)];
            if (found == most_runs || begin < field_begin || begin + reach > field_end) return;
            const auto same = hn::Eq(starts, hn::Set(di, begin));
            start[found] = begin;
            lanes[found] = hn::RebindMask(d, same);
            rest = hn::AndNot(same, rest);
            ++found;
        }
        runs = found;
    }
};

/// u_k at a block of Width nodes per axis. Width is 3 or 4 for all points of a cell, which are deformed into 2 x 2
/// cells in most lanes: then a node is read and written once for all of them. Width is 2 for the cell around a single
/// point.
template <int Dim, int Width, class D>
struct NodeValues {
    static constexpr int nodes = power(Width, Dim);
    V<D> u[nodes];

    HWY_INLINE NodeValues(D d, const T<D>* u_next, const BlockPlaces<Dim, D>& places,
                          const std::ptrdiff_t (&stride)[Dim]) {
        MORPHODESIC_UNROLL
        for (int n = 0; n < nodes; ++n) {
            const T<D>* at = u_next + node_offset<Dim, Width>(n, stride);
            u[n] = places.runs == 0 ? hn::GatherIndex(d, at, places.first) : hn::LoadU(d, at + places.start[0]);
        }
        for (int r = 1; r < places.runs; ++r) {
            MORPHODESIC_UNROLL
            for (int n = 0; n < nodes; ++n) {
                const T<D>* at = u_next + node_offset<Dim, Width>(n, stride);
                u[n] = hn::IfThenElse(places.lanes[r], hn::LoadU(d, at + places.start[r]), u[n]);
            }
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
};

/// What is to be added to the gradient at such a block.
template <int Dim, int Width, class D>
struct NodeSums {
    static constexpr int nodes = power(Width, Dim);
    V<D> gradient[nodes];

    HWY_INLINE explicit NodeSums(D d) {
        MORPHODESIC_UNROLL
        for (int n = 0; n < nodes; ++n) gradient[n] = hn::Zero(d);
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

    /// Adds to the gradient in memory. Blocks of neighbouring lanes overlap: the nodes of a run are summed row by row
    /// before, and other lanes come one after the other.
    HWY_INLINE void scatter(D d, T<D>* out, const BlockPlaces<Dim, D>& places,
                            const std::ptrdiff_t (&stride)[Dim]) const {
        if constexpr (hn::MaxLanes(d) >= Width) {
            for (int r = 0; r < places.runs; ++r) {
                MORPHODESIC_UNROLL
                for (int row = 0; row < nodes; row += Width) {
                    add_row(d, row, places.lanes[r], out + places.start[r] + node_offset<Dim, Width>(row, stride));
                }
            }
        }
        if (places.runs == 0) scatter_lanes(d, out, places, stride);
    }

private:
    HWY_INLINE void add_row(D d, int row, hn::Mask<D> lanes_of_run, T<D>* out) const {
        const hn::RebindToSigned<D> di;
        using Lane = hn::TFromD<decltype(di)>;
        const std::size_t lanes = hn::Lanes(d);
        V<D> sum = hn::IfThenElseZero(lanes_of_run, gradient[row]), beyond = hn::Zero(d);
        MORPHODESIC_UNROLL
        for (int i = 1; i < Width; ++i) {  // node i of a lane is node 0 of the lane i further on, or lies beyond all
            const auto from = hn::And(hn::Sub(hn::Iota(di, 0), hn::Set(di, static_cast<Lane>(i))),
                                      hn::Set(di, static_cast<Lane>(lanes - 1)));
            const V<D> turned =
                hn::TableLookupLanes(hn::IfThenElseZero(lanes_of_run, gradient[row + i]), hn::IndicesFromVec(d, from));
            const auto wrapped = hn::FirstN(d, static_cast<std::size_t>(i));
            sum = hn::Add(sum, hn::IfThenZeroElse(wrapped, turned));
            beyond = hn::Add(beyond, hn::IfThenElseZero(wrapped, turned));
        }
        hn::StoreU(hn::Add(hn::LoadU(d, out), sum), d, out);
        HWY_ALIGN T<D> rest[hn::MaxLanes(d)];
        hn::Store(beyond, d, rest);
        for (std::size_t i = 0; i + 1 < Width; ++i) out[lanes + i] += rest[i];
    }

    HWY_INLINE void scatter_lanes(D d, T<D>* out, const BlockPlaces<Dim, D>& places,
                                  const std::ptrdiff_t (&stride)[Dim]) const {
        const hn::RebindToSigned<D> di;
        constexpr std::size_t most_lanes = hn::MaxLanes(d);
        HWY_ALIGN hn::TFromD<decltype(di)> base[most_lanes];
        HWY_ALIGN T<D> value[nodes][most_lanes];
        hn::Store(places.first, di, base);
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

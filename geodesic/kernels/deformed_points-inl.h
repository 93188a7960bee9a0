// Included once for every instruction set by the kernels, see foreach_target.h of Highway.
#if defined(MORPHODESIC_DEFORMED_POINTS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MORPHODESIC_DEFORMED_POINTS_INL_H
#undef MORPHODESIC_DEFORMED_POINTS_INL_H
#else
#define MORPHODESIC_DEFORMED_POINTS_INL_H
#endif

#include <cstddef>

#include "geodesic/kernels/multilinear-inl.h"
#include "geodesic/kernels/node_block-inl.h"
#include "geodesic/kernels/vectors-inl.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace morphodesic::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// The nodes of u_k that may be touched: from first to last on every axis, both included.
template <int Dim>
struct NodeRange {
    NodeDistances<Dim> distance;
    int first[Dim], last[Dim];

    std::ptrdiff_t begin() const { return first[Dim - 1] * distance.axis[Dim - 1]; }
    std::ptrdiff_t end() const { return (last[Dim - 1] + 1) * distance.axis[Dim - 1]; }
};

/// The deformed points of a cell, another cell in every lane, and u_k there. Points that lie outside of the range count
/// as on its border.
template <int Dim, int Points, class D>
class DeformedPoints {
public:
    V<D> u[Points], slope[Points][Dim];  ///< u_k and its gradient (in units of 1 / h), after read()

    /// own: the lower corner of each lane's cell, in units of h.
    HWY_INLINE DeformedPoints(D d, const NodeRange<Dim>& range, const V<D> (&own)[Dim]) : range_(range) {
        for (int a = 0; a < Dim; ++a) {
            own_[a] = own[a];
            low_[a] = all(d, 1e30);
            high_[a] = all(d, -1e30);
        }
    }

    /// x is counted from the lower corner of the cell, so that it is exact to the last bit of the displacement.
    HWY_INLINE void set(D, int point, int axis, V<D> x) {
        position_[point][axis] = x;
        low_[axis] = hn::Min(low_[axis], x);
        high_[axis] = hn::Max(high_[axis], x);
    }

    HWY_INLINE void read(D d, const T<D>* u_next) {
        if (fit<3>(d)) {
            width_ = 3;
            read_block<3>(d, u_next);
        } else if (Dim == 2 && fit<4>(d)) {
            width_ = 4;
            read_block<4>(d, u_next);
        } else {
            width_ = 2;
            for (int q = 0; q < Points; ++q) {
                V<D> shift[Dim];
                read_point<2>(
                    d, q, shift,
                    NodeValues<Dim, 2, D>(d, u_next, places<2>(d, position_[q], shift), range_.distance.axis));
            }
        }
    }

    /// Adds the derivative by u_k, given the one by u_k at the points, to the gradient at the nodes.
    HWY_INLINE void write(D d, const V<D> (&derivative)[Points], T<D>* gradient) const {
        if (width_ == 3) {
            write_block<3>(d, derivative, gradient);
        } else if (Dim == 2 && width_ == 4) {
            write_block<4>(d, derivative, gradient);
        } else {
            for (int q = 0; q < Points; ++q) {
                V<D> shift[Dim];
                const auto block_places = places<2>(d, position_[q], shift);
                NodeSums<Dim, 2, D> block(d);
                block.add(d, place_[q], derivative[q]);
                block.scatter(d, gradient, block_places, range_.distance.axis);
            }
        }
    }

private:
    /// First node on an axis of a block of Width nodes that begins at the cell of x and lies in the range.
    template <int Width>
    HWY_INLINE V<D> first_node(D d, int axis, V<D> x) const {
        return hn::Min(hn::Max(hn::Add(hn::Floor(x), own_[axis]), all(d, range_.first[axis])),
                       all(d, range_.last[axis] - (Width - 1)));
    }

    /// The blocks that begin at the cell of x; shift: their first nodes as counted from the lanes' own cells.
    template <int Width>
    HWY_INLINE BlockPlaces<Dim, D> places(D d, const V<D> (&x)[Dim], V<D> (&shift)[Dim]) const {
        const hn::RebindToSigned<D> di;
        const auto& stride = range_.distance.axis;
        auto first = hn::Zero(di);
        for (int a = 0; a < Dim; ++a) {
            const V<D> node = first_node<Width>(d, a, x[a]);
            shift[a] = hn::Sub(node, own_[a]);
            first = hn::Add(
                first, hn::Mul(hn::ConvertTo(di, node), hn::Set(di, static_cast<hn::TFromD<decltype(di)>>(stride[a]))));
        }
        return BlockPlaces<Dim, D>(d, first, Width, stride, range_.begin(), range_.end());
    }

    /// Do all points of the cell lie in one block, in every lane?
    template <int Width>
    HWY_INLINE bool fit(D d) const {
        auto fits = hn::FirstN(d, hn::Lanes(d));
        for (int a = 0; a < Dim; ++a) {
            const V<D> end = hn::Add(hn::Sub(first_node<Width>(d, a, low_[a]), own_[a]), all(d, Width - 1));
            const V<D> border = hn::Sub(all(d, range_.last[a]), own_[a]);
            fits = hn::And(fits, hn::Le(hn::Min(high_[a], border), end));
        }
        return hn::AllTrue(d, fits);
    }

    template <int Width>
    HWY_INLINE void read_point(D d, int q, const V<D> (&shift)[Dim], const NodeValues<Dim, Width, D>& block) {
        V<D> v[1 << Dim], fraction[Dim];
        for (int a = 0; a < Dim; ++a) {
            place_[q][a] = hn::Min(hn::Max(hn::Sub(position_[q][a], shift[a]), hn::Zero(d)), all(d, Width - 1));
        }
        block.corners(d, place_[q], v, fraction);
        u[q] = multilinear<Dim>(d, v, fraction, slope[q]);
    }

    template <int Width>
    HWY_INLINE void read_block(D d, const T<D>* u_next) {
        V<D> shift[Dim];
        block_ = places<Width>(d, low_, shift);
        const NodeValues<Dim, Width, D> block(d, u_next, block_, range_.distance.axis);
        for (int q = 0; q < Points; ++q) read_point<Width>(d, q, shift, block);
    }

    template <int Width>
    HWY_INLINE void write_block(D d, const V<D> (&derivative)[Points], T<D>* gradient) const {
        NodeSums<Dim, Width, D> block(d);
        for (int q = 0; q < Points; ++q) block.add(d, place_[q], derivative[q]);
        block.scatter(d, gradient, block_, range_.distance.axis);
    }

    const NodeRange<Dim>& range_;
    V<D> own_[Dim], position_[Points][Dim], low_[Dim], high_[Dim];
    V<D> place_[Points][Dim];  // from the first node of the block, in [0, width - 1]
    int width_ = 0;            // nodes per axis of the block; 2: a block for each point
    BlockPlaces<Dim, D> block_;
};

}  // namespace morphodesic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

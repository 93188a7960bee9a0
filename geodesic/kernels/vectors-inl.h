// Included once for every instruction set by the kernels, see foreach_target.h of Highway.
#if defined(MORPHODESIC_VECTORS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MORPHODESIC_VECTORS_INL_H
#undef MORPHODESIC_VECTORS_INL_H
#else
#define MORPHODESIC_VECTORS_INL_H
#endif

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace morphodesic::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class D>
using V = hn::Vec<D>;
template <class D>
using T = hn::TFromD<D>;

/// A constant in every lane.
template <class D>
HWY_INLINE V<D> all(D d, double value) {
    return hn::Set(d, static_cast<T<D>>(value));
}

}  // namespace morphodesic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

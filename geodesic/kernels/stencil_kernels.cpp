#include "geodesic/kernels/stencil_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geodesic/kernels/stencil_kernels.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
// clang-format off
#include "hwy/highway.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace morphodesic::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <int Dim, class D>
HWY_INLINE hn::Vec<D> neighbour_sum(D d, const Stencil<Dim>& a, const float* b, const float* x, std::ptrdiff_t i) {
    auto sum = hn::LoadU(d, b + i);
    for (int axis = 0; axis < Dim; ++axis) {
        const std::ptrdiff_t s = a.stride[axis];
        sum = hn::MulAdd(hn::LoadU(d, a.edge[axis] + i), hn::LoadU(d, x + i + s), sum);
        sum = hn::MulAdd(hn::LoadU(d, a.edge[axis] + i - s), hn::LoadU(d, x + i - s), sum);
    }
    return sum;
}

/// Runs body(tag, i) over the range, full vectors first, then single entries.
template <class Body>
HWY_INLINE void for_range(std::size_t count, const Body& body) {
    const hn::CappedTag<float, 16> d;
    const hn::CappedTag<float, 1> d1;
    const auto n = static_cast<std::ptrdiff_t>(count);
    const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
    std::ptrdiff_t i = 0;
    for (; i + lanes <= n; i += lanes) body(d, i);
    for (; i < n; ++i) body(d1, i);
}

template <int Dim>
void JacobiSweep(std::size_t count, const Stencil<Dim>& a, float omega, const float* b, const float* x, float* out) {
    for_range(count, [&](auto d, std::ptrdiff_t i) HWY_ATTR {
        const auto sum = neighbour_sum<Dim>(d, a, b, x, i);
        const auto here = hn::LoadU(d, x + i);
        const auto target = hn::Mul(hn::LoadU(d, a.inverse_diagonal + i), sum);
        hn::StoreU(hn::MulAdd(hn::Set(d, omega), hn::Sub(target, here), here), d, out + i);
    });
}

template <int Dim>
void Residual(std::size_t count, const Stencil<Dim>& a, const float* b, const float* x, float* out) {
    for_range(count, [&](auto d, std::ptrdiff_t i) HWY_ATTR {
        const auto sum = neighbour_sum<Dim>(d, a, b, x, i);
        hn::StoreU(hn::NegMulAdd(hn::LoadU(d, a.diagonal + i), hn::LoadU(d, x + i), sum), d, out + i);
    });
}

void JacobiSweep2(std::size_t n, const Stencil<2>& a, float w, const float* b, const float* x, float* out) {
    JacobiSweep<2>(n, a, w, b, x, out);
}
void JacobiSweep3(std::size_t n, const Stencil<3>& a, float w, const float* b, const float* x, float* out) {
    JacobiSweep<3>(n, a, w, b, x, out);
}
void Residual2(std::size_t n, const Stencil<2>& a, const float* b, const float* x, float* out) {
    Residual<2>(n, a, b, x, out);
}
void Residual3(std::size_t n, const Stencil<3>& a, const float* b, const float* x, float* out) {
    Residual<3>(n, a, b, x, out);
}

}  // namespace morphodesic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace morphodesic::kernels {

HWY_EXPORT(JacobiSweep2);
HWY_EXPORT(JacobiSweep3);
HWY_EXPORT(Residual2);
HWY_EXPORT(Residual3);

template <>
void jacobi_sweep<2>(std::size_t n, const Stencil<2>& a, float omega, const float* b, const float* x, float* out) {
    HWY_DYNAMIC_DISPATCH(JacobiSweep2)(n, a, omega, b, x, out);
}
template <>
void jacobi_sweep<3>(std::size_t n, const Stencil<3>& a, float omega, const float* b, const float* x, float* out) {
    HWY_DYNAMIC_DISPATCH(JacobiSweep3)(n, a, omega, b, x, out);
}
template <>
void residual<2>(std::size_t n, const Stencil<2>& a, const float* b, const float* x, float* out) {
    HWY_DYNAMIC_DISPATCH(Residual2)(n, a, b, x, out);
}
template <>
void residual<3>(std::size_t n, const Stencil<3>& a, const float* b, const float* x, float* out) {
    HWY_DYNAMIC_DISPATCH(Residual3)(n, a, b, x, out);
}

}  // namespace morphodesic::kernels
#endif

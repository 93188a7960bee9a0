#include "geodesic/kernels/heaviside_kernel.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geodesic/kernels/heaviside_kernel.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
// clang-format off
#include "hwy/highway.h"
#include "hwy/contrib/math/math-inl.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace morphodesic::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void SmoothHeaviside(const double* u, double eps, double* out, std::size_t n) {
    const hn::CappedTag<double, 8> d;
    const std::size_t lanes = hn::Lanes(d);
    const auto inverse_eps = hn::Set(d, 1.0 / eps), inverse_pi = hn::Set(d, std::numbers::inv_pi);
    const auto half = hn::Set(d, 0.5);
    const auto value = [&](auto v)
                           HWY_ATTR { return hn::MulAdd(hn::Atan(d, hn::Mul(v, inverse_eps)), inverse_pi, half); };
    std::size_t i = 0;
    for (; i + lanes <= n; i += lanes) hn::StoreU(value(hn::LoadU(d, u + i)), d, out + i);
    if (i == n) return;
    HWY_ALIGN double rest[8] = {};
    std::copy(u + i, u + n, rest);
    hn::Store(value(hn::Load(d, rest)), d, rest);
    std::copy(rest, rest + (n - i), out + i);
}

}  // namespace morphodesic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace morphodesic::kernels {

HWY_EXPORT(SmoothHeaviside);

void smooth_heaviside(std::span<const double> u, double eps, std::span<double> out) {
    assert(u.size() == out.size());
    HWY_DYNAMIC_DISPATCH(SmoothHeaviside)(u.data(), eps, out.data(), u.size());
}

}  // namespace morphodesic::kernels
#endif

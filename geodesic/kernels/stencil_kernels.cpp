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

/// (b - A x) at nodes i, i + 1, ..., one vector per component.
template <int Dim, class D>
HWY_INLINE void residual_at(D d, const Stencil<Dim>& a, const VectorIn<Dim>& b, const VectorIn<Dim>& x,
                            std::ptrdiff_t i, hn::Vec<D> (&out)[Dim]) {
    hn::Vec<D> here[Dim];
    const auto diagonal = hn::LoadU(d, a.diagonal + i);
    for (int c = 0; c < Dim; ++c) {
        here[c] = hn::LoadU(d, x[c] + i);
        out[c] = hn::NegMulAdd(diagonal, here[c], hn::LoadU(d, b[c] + i));
    }
    for (int axis = 0; axis < Dim; ++axis) {
        const std::ptrdiff_t s = a.stride[axis];
        const auto up = hn::LoadU(d, a.edge[axis] + i), down = hn::LoadU(d, a.edge[axis] + i - s);
        for (int c = 0; c < Dim; ++c) {
            out[c] = hn::MulAdd(up, hn::LoadU(d, x[c] + i + s), out[c]);
            out[c] = hn::MulAdd(down, hn::LoadU(d, x[c] + i - s), out[c]);
        }
    }
    for (int r = 0; r < Dim; ++r) {
        for (int c = r; c < Dim; ++c) {
            const auto m = hn::LoadU(d, a.mass[symmetric_entry<Dim>(r, c)] + i);
            out[r] = hn::NegMulAdd(m, here[c], out[r]);
            if (c != r) out[c] = hn::NegMulAdd(m, here[r], out[c]);
        }
    }
}

/// Component c of block_inverse r.
template <int Dim, class D>
HWY_INLINE hn::Vec<D> block_inverse_times(D d, const Stencil<Dim>& a, std::ptrdiff_t i, const hn::Vec<D> (&r)[Dim],
                                          int c) {
    auto sum = hn::Mul(hn::LoadU(d, a.block_inverse[symmetric_entry<Dim>(c, 0)] + i), r[0]);
    for (int k = 1; k < Dim; ++k) {
        sum = hn::MulAdd(hn::LoadU(d, a.block_inverse[symmetric_entry<Dim>(c, k)] + i), r[k], sum);
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
void JacobiSweep(std::size_t count, const Stencil<Dim>& a, float omega, const VectorIn<Dim>& b, const VectorIn<Dim>& x,
                 const VectorOut<Dim>& out) {
    for_range(count, [&](auto d, std::ptrdiff_t i) HWY_ATTR {
        hn::Vec<decltype(d)> r[Dim];
        residual_at<Dim>(d, a, b, x, i, r);
        for (int c = 0; c < Dim; ++c) {
            const auto sum = block_inverse_times<Dim>(d, a, i, r, c);
            hn::StoreU(hn::MulAdd(hn::Set(d, omega), sum, hn::LoadU(d, x[c] + i)), d, out[c] + i);
        }
    });
}

template <int Dim>
void FirstSweep(std::size_t count, const Stencil<Dim>& a, float omega, const VectorIn<Dim>& b,
                const VectorOut<Dim>& out) {
    for_range(count, [&](auto d, std::ptrdiff_t i) HWY_ATTR {
        hn::Vec<decltype(d)> r[Dim];
        for (int c = 0; c < Dim; ++c) r[c] = hn::LoadU(d, b[c] + i);
        for (int c = 0; c < Dim; ++c) {
            const auto sum = block_inverse_times<Dim>(d, a, i, r, c);
            hn::StoreU(hn::Mul(hn::Set(d, omega), sum), d, out[c] + i);
        }
    });
}

template <int Dim>
void Residual(std::size_t count, const Stencil<Dim>& a, const VectorIn<Dim>& b, const VectorIn<Dim>& x,
              const VectorOut<Dim>& out) {
    for_range(count, [&](auto d, std::ptrdiff_t i) HWY_ATTR {
        hn::Vec<decltype(d)> r[Dim];
        residual_at<Dim>(d, a, b, x, i, r);
        for (int c = 0; c < Dim; ++c) hn::StoreU(r[c], d, out[c] + i);
    });
}

void JacobiSweep2(std::size_t n, const Stencil<2>& a, float w, const VectorIn<2>& b, const VectorIn<2>& x,
                  const VectorOut<2>& out) {
    JacobiSweep<2>(n, a, w, b, x, out);
}
void JacobiSweep3(std::size_t n, const Stencil<3>& a, float w, const VectorIn<3>& b, const VectorIn<3>& x,
                  const VectorOut<3>& out) {
    JacobiSweep<3>(n, a, w, b, x, out);
}
void FirstSweep2(std::size_t n, const Stencil<2>& a, float w, const VectorIn<2>& b, const VectorOut<2>& out) {
    FirstSweep<2>(n, a, w, b, out);
}
void FirstSweep3(std::size_t n, const Stencil<3>& a, float w, const VectorIn<3>& b, const VectorOut<3>& out) {
    FirstSweep<3>(n, a, w, b, out);
}
void Residual2(std::size_t n, const Stencil<2>& a, const VectorIn<2>& b, const VectorIn<2>& x,
               const VectorOut<2>& out) {
    Residual<2>(n, a, b, x, out);
}
void Residual3(std::size_t n, const Stencil<3>& a, const VectorIn<3>& b, const VectorIn<3>& x,
               const VectorOut<3>& out) {
    Residual<3>(n, a, b, x, out);
}

}  // namespace morphodesic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace morphodesic::kernels {

HWY_EXPORT(JacobiSweep2);
HWY_EXPORT(JacobiSweep3);
HWY_EXPORT(FirstSweep2);
HWY_EXPORT(FirstSweep3);
HWY_EXPORT(Residual2);
HWY_EXPORT(Residual3);

template <>
void jacobi_sweep<2>(std::size_t n, const Stencil<2>& a, float omega, const VectorIn<2>& b, const VectorIn<2>& x,
                     const VectorOut<2>& out) {
    HWY_DYNAMIC_DISPATCH(JacobiSweep2)(n, a, omega, b, x, out);
}
template <>
void jacobi_sweep<3>(std::size_t n, const Stencil<3>& a, float omega, const VectorIn<3>& b, const VectorIn<3>& x,
                     const VectorOut<3>& out) {
    HWY_DYNAMIC_DISPATCH(JacobiSweep3)(n, a, omega, b, x, out);
}
template <>
void first_sweep<2>(std::size_t n, const Stencil<2>& a, float omega, const VectorIn<2>& b, const VectorOut<2>& out) {
    HWY_DYNAMIC_DISPATCH(FirstSweep2)(n, a, omega, b, out);
}
template <>
void first_sweep<3>(std::size_t n, const Stencil<3>& a, float omega, const VectorIn<3>& b, const VectorOut<3>& out) {
    HWY_DYNAMIC_DISPATCH(FirstSweep3)(n, a, omega, b, out);
}
template <>
void residual<2>(std::size_t n, const Stencil<2>& a, const VectorIn<2>& b, const VectorIn<2>& x,
                 const VectorOut<2>& out) {
    HWY_DYNAMIC_DISPATCH(Residual2)(n, a, b, x, out);
}
template <>
void residual<3>(std::size_t n, const Stencil<3>& a, const VectorIn<3>& b, const VectorIn<3>& x,
                 const VectorOut<3>& out) {
    HWY_DYNAMIC_DISPATCH(Residual3)(n, a, b, x, out);
}

}  // namespace morphodesic::kernels
#endif

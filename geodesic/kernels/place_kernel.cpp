#include "geodesic/kernels/place_kernel.h"

#include <cassert>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geodesic/kernels/place_kernel.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
// clang-format off
#include "hwy/highway.h"
#include "geodesic/kernels/multilinear-inl.h"
#include "geodesic/kernels/vectors-inl.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace morphodesic::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<double, place_lanes>;

template <int Dim, class FieldT, class D>
HWY_INLINE V<D> value_at(D d, const NodeDistances<Dim>& nodes, const FieldT* field, V<D> node,
                         const V<D> (&fraction)[Dim]) {
    V<D> v[1 << Dim], unused[Dim];
    for (int c = 0; c < (1 << Dim); ++c) v[c] = gather(d, field + nodes.corner[c], node);
    return multilinear<Dim>(d, v, fraction, unused);
}

template <int Dim, class FieldT>
void Sample(const int (&cells)[Dim], const FieldT* field, const Places<Dim>& places, double* values) {
    const Lanes d;
    const NodeDistances<Dim> nodes(cells);
    for (std::size_t i = 0; i < places.count; i += hn::Lanes(d)) {
        V<Lanes> x[Dim], fraction[Dim];
        for (int a = 0; a < Dim; ++a) x[a] = hn::LoadU(d, places.x[a] + i);
        const auto node = cells_around<Dim>(d, nodes, cells, x, fraction);
        hn::StoreU(value_at<Dim>(d, nodes, field, node, fraction), d, values + i);
    }
}

template <int Dim>
void Invert(const Inversion<Dim>& problem, const Places<Dim>& y, const Places<Dim>& start) {
    const Lanes d;
    using Values = V<Lanes>;
    const NodeDistances<Dim> nodes(problem.cells);
    const Values share = all(d, problem.share * problem.cells_per_unit), near_enough = all(d, problem.near_enough);
    const Values half = all(d, 0.5), least_damping = all(d, 0.25);
    for (std::size_t i = 0; i < y.count; i += hn::Lanes(d)) {
        Values target[Dim], x[Dim], last = all(d, 1e300), damping = all(d, 1.0);
        for (int a = 0; a < Dim; ++a) {
            target[a] = hn::LoadU(d, y.x[a] + i);
            x[a] = hn::LoadU(d, start.x[a] + i);
        }
        auto open = hn::FirstN(d, hn::Lanes(d));
        for (int iteration = 0; iteration < problem.iterations && !hn::AllFalse(d, open); ++iteration) {
            Values fraction[Dim], step[Dim], change = hn::Zero(d);
            const auto node = cells_around<Dim>(d, nodes, problem.cells, x, fraction);
            for (int a = 0; a < Dim; ++a) {
                const Values w = value_at<Dim>(d, nodes, problem.w[a], node, fraction);
                step[a] = hn::Sub(hn::NegMulAdd(share, w, target[a]), x[a]);
                change = hn::Max(change, hn::Abs(step[a]));
            }
            damping = hn::IfThenElse(hn::Gt(change, last), hn::Max(least_damping, hn::Mul(half, damping)), damping);
            last = change;
            for (int a = 0; a < Dim; ++a) x[a] = hn::IfThenElse(open, hn::MulAdd(damping, step[a], x[a]), x[a]);
            open = hn::And(open, hn::Ge(change, near_enough));
        }
        for (int a = 0; a < Dim; ++a) hn::StoreU(x[a], d, start.x[a] + i);
    }
}

template <int Dim>
void Locate(const int (&cells)[Dim], const Places<Dim>& places, std::uint32_t* node, float* const (&fraction)[Dim]) {
    const Lanes d;
    const hn::Rebind<float, Lanes> single;
    const hn::Rebind<std::int32_t, Lanes> narrow;
    const NodeDistances<Dim> nodes(cells);
    for (std::size_t i = 0; i < places.count; i += hn::Lanes(d)) {
        V<Lanes> x[Dim], in_cell[Dim];
        for (int a = 0; a < Dim; ++a) x[a] = hn::LoadU(d, places.x[a] + i);
        const auto first = cells_around<Dim>(d, nodes, cells, x, in_cell);
        hn::StoreU(hn::BitCast(hn::RebindToUnsigned<decltype(narrow)>(), hn::DemoteTo(narrow, first)),
                   hn::RebindToUnsigned<decltype(narrow)>(), node + i);
        for (int a = 0; a < Dim; ++a) hn::StoreU(hn::DemoteTo(single, in_cell[a]), single, fraction[a] + i);
    }
}

#define MORPHODESIC_PLACES(Dim)                                                                                     \
    void Sample##Dim(const int(&cells)[Dim], const double* field, const Places<Dim>& places, double* values) {      \
        Sample<Dim>(cells, field, places, values);                                                                  \
    }                                                                                                               \
    void SampleSingle##Dim(const int(&cells)[Dim], const float* field, const Places<Dim>& places, double* values) { \
        Sample<Dim>(cells, field, places, values);                                                                  \
    }                                                                                                               \
    void Invert##Dim(const Inversion<Dim>& problem, const Places<Dim>& y, const Places<Dim>& x) {                   \
        Invert<Dim>(problem, y, x);                                                                                 \
    }                                                                                                               \
    void Locate##Dim(const int(&cells)[Dim], const Places<Dim>& places, std::uint32_t* node,                        \
                     float* const(&fraction)[Dim]) {                                                                \
        Locate<Dim>(cells, places, node, fraction);                                                                 \
    }
MORPHODESIC_PLACES(2)
MORPHODESIC_PLACES(3)
#undef MORPHODESIC_PLACES

}  // namespace morphodesic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace morphodesic::kernels {

#define MORPHODESIC_PLACES(Dim)                                                                                        \
    HWY_EXPORT(Sample##Dim);                                                                                           \
    HWY_EXPORT(SampleSingle##Dim);                                                                                     \
    HWY_EXPORT(Invert##Dim);                                                                                           \
    HWY_EXPORT(Locate##Dim);                                                                                           \
    template <>                                                                                                        \
    void sample<Dim, double>(const int(&cells)[Dim], const double* field, const Places<Dim>& places, double* values) { \
        assert(places.count % place_lanes == 0);                                                                       \
        HWY_DYNAMIC_DISPATCH(Sample##Dim)(cells, field, places, values);                                               \
    }                                                                                                                  \
    template <>                                                                                                        \
    void sample<Dim, float>(const int(&cells)[Dim], const float* field, const Places<Dim>& places, double* values) {   \
        assert(places.count % place_lanes == 0);                                                                       \
        HWY_DYNAMIC_DISPATCH(SampleSingle##Dim)(cells, field, places, values);                                         \
    }                                                                                                                  \
    template <>                                                                                                        \
    void invert<Dim>(const Inversion<Dim>& problem, const Places<Dim>& y, const Places<Dim>& x) {                      \
        assert(y.count % place_lanes == 0 && x.count == y.count);                                                      \
        HWY_DYNAMIC_DISPATCH(Invert##Dim)(problem, y, x);                                                              \
    }                                                                                                                  \
    template <>                                                                                                        \
    void locate<Dim>(const int(&cells)[Dim], const Places<Dim>& places, std::uint32_t* node,                           \
                     float* const(&fraction)[Dim]) {                                                                   \
        assert(places.count % place_lanes == 0);                                                                       \
        HWY_DYNAMIC_DISPATCH(Locate##Dim)(cells, places, node, fraction);                                              \
    }
MORPHODESIC_PLACES(2)
MORPHODESIC_PLACES(3)
#undef MORPHODESIC_PLACES

}  // namespace morphodesic::kernels
#endif

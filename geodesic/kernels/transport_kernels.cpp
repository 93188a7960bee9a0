#include "geodesic/kernels/transport_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geodesic/kernels/transport_kernels.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
// clang-format off
#include "hwy/highway.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace morphodesic::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// The fields of one coarse node: as many vectors as it takes.
using Part = hn::CappedTag<float, transport_width>;
constexpr std::size_t part = hn::MaxLanes(Part()), parts = transport_width / part;
constexpr std::size_t most_lanes = 16;

/// Values of the shape functions of the coarse corners at the places of the nodes i, i + 1, ...: [node][corner].
template <int Dim, class D>
HWY_INLINE void corner_shares(D d, const TransportMaps<Dim>& maps, std::size_t i, float* out) {
    constexpr int corners = 1 << Dim;
    const std::size_t lanes = hn::Lanes(d);
    hn::Vec<D> at[Dim], rest[Dim];
    for (int a = 0; a < Dim; ++a) {
        at[a] = hn::LoadU(d, maps.fraction[a] + i);
        rest[a] = hn::Sub(hn::Set(d, 1.0F), at[a]);
    }
    HWY_ALIGN float rows[corners][most_lanes];
    for (int c = 0; c < corners; ++c) {
        auto s = (c & 1) ? at[0] : rest[0];
        for (int a = 1; a < Dim; ++a) s = hn::Mul(s, ((c >> a) & 1) ? at[a] : rest[a]);
        hn::Store(s, d, rows[c]);
    }
    for (std::size_t n = 0; n < lanes; ++n) {
        for (int c = 0; c < corners; ++c) out[n * corners + static_cast<std::size_t>(c)] = rows[c][n];
    }
}

/// Runs body(tag of float, i) over the range, full vectors first, then single entries.
template <class Body>
HWY_INLINE void for_range(std::size_t count, const Body& body) {
    const hn::CappedTag<float, most_lanes> d;
    const hn::CappedTag<float, 1> d1;
    const std::size_t lanes = hn::Lanes(d);
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes) body(d, i);
    for (; i < count; ++i) body(d1, i);
}

template <int Dim>
HWY_INLINE void Push(std::size_t count, const TransportMaps<Dim>& maps, const float* const (&displacement)[Dim],
                     const float* level_set, float* buffer) {
    constexpr int corners = 1 << Dim;
    const Part p;
    hn::Vec<Part> sum[corners][parts];
    for (auto& s : sum) {
        for (auto& v : s) v = hn::Zero(p);
    }
    std::uint32_t cell = count ? maps.cell[0] : 0;
    // Neighbouring nodes are in the same coarse cell most of the time: its sums stay in registers.
    const auto flush = [&]() HWY_ATTR {
        for (int c = 0; c < corners; ++c) {
            float* out = buffer + (cell + maps.corner[c]) * transport_width;
            for (std::size_t k = 0; k < parts; ++k) {
                hn::StoreU(hn::Add(hn::LoadU(p, out + k * part), sum[c][k]), p, out + k * part);
                sum[c][k] = hn::Zero(p);
            }
        }
    };
    for_range(count, [&](auto d, std::size_t i) HWY_ATTR {
        using D = decltype(d);
        const std::size_t lanes = hn::Lanes(d);
        hn::Vec<D> value[transport_width], from[Dim];
        for (int r = 0; r < Dim; ++r) from[r] = hn::LoadU(d, displacement[r] + i);
        for (int c = 0; c < Dim; ++c) {
            value[c] = hn::Mul(hn::LoadU(d, maps.a[c] + i), from[0]);
            for (int r = 1; r < Dim; ++r) {
                value[c] = hn::MulAdd(hn::LoadU(d, maps.a[r * Dim + c] + i), from[r], value[c]);
            }
        }
        for (std::size_t f = Dim; f < transport_width; ++f) value[f] = hn::Zero(d);
        if (level_set) {
            const auto u = hn::LoadU(d, level_set + i);
            for (int c = 0; c < Dim; ++c) {
                value[Dim + c] = hn::Neg(hn::Mul(hn::LoadU(d, maps.q[c] + i), u));
            }
            value[2 * Dim] = hn::Mul(hn::LoadU(d, maps.d + i), u);
        }
        HWY_ALIGN float rows[transport_width][most_lanes], shares[most_lanes * corners];
        HWY_ALIGN float fields[most_lanes][transport_width];
        for (std::size_t f = 0; f < transport_width; ++f) hn::Store(value[f], d, rows[f]);
        for (std::size_t n = 0; n < lanes; ++n) {
            for (std::size_t f = 0; f < transport_width; ++f) fields[n][f] = rows[f][n];
        }
        corner_shares<Dim>(d, maps, i, shares);
        for (std::size_t n = 0; n < lanes; ++n) {
            if (maps.cell[i + n] != cell) {
                flush();
                cell = maps.cell[i + n];
            }
            for (int c = 0; c < corners; ++c) {
                const auto s = hn::Set(p, shares[n * corners + static_cast<std::size_t>(c)]);
                for (std::size_t k = 0; k < parts; ++k) {
                    sum[c][k] = hn::MulAdd(s, hn::Load(p, fields[n] + k * part), sum[c][k]);
                }
            }
        }
    });
    if (count) flush();
}

template <int Dim>
HWY_INLINE void Pull(std::size_t count, const TransportMaps<Dim>& maps, const float* buffer,
                     float* const (&displacement)[Dim], float* level_set) {
    constexpr int corners = 1 << Dim;
    const Part p;
    hn::Vec<Part> at[corners][parts];
    std::uint32_t cell = count ? maps.cell[0] : 0;
    const auto fetch = [&]() HWY_ATTR {
        for (int c = 0; c < corners; ++c) {
            const float* in = buffer + (cell + maps.corner[c]) * transport_width;
            for (std::size_t k = 0; k < parts; ++k) at[c][k] = hn::LoadU(p, in + k * part);
        }
    };
    if (count) fetch();
    for_range(count, [&](auto d, std::size_t i) HWY_ATTR {
        const std::size_t lanes = hn::Lanes(d);
        HWY_ALIGN float shares[most_lanes * corners], fields[most_lanes][transport_width];
        HWY_ALIGN float rows[transport_width][most_lanes];
        corner_shares<Dim>(d, maps, i, shares);
        for (std::size_t n = 0; n < lanes; ++n) {
            if (maps.cell[i + n] != cell) {
                cell = maps.cell[i + n];
                fetch();
            }
            for (std::size_t k = 0; k < parts; ++k) {
                auto value = hn::Zero(p);
                for (int c = 0; c < corners; ++c) {
                    const auto s = hn::Set(p, shares[n * corners + static_cast<std::size_t>(c)]);
                    value = hn::MulAdd(s, at[c][k], value);
                }
                hn::Store(value, p, fields[n] + k * part);
            }
        }
        for (std::size_t n = 0; n < lanes; ++n) {
            for (std::size_t f = 0; f < transport_width; ++f) rows[f][n] = fields[n][f];
        }
        for (int r = 0; r < Dim; ++r) {
            auto sum = hn::Mul(hn::LoadU(d, maps.a[r * Dim] + i), hn::Load(d, rows[0]));
            for (int c = 1; c < Dim; ++c) {
                sum = hn::MulAdd(hn::LoadU(d, maps.a[r * Dim + c] + i), hn::Load(d, rows[c]), sum);
            }
            float* out = displacement[r] + i;
            hn::StoreU(hn::Add(hn::LoadU(d, out), sum), d, out);
        }
        if (level_set) {
            auto change = hn::Mul(hn::LoadU(d, maps.d + i), hn::Load(d, rows[2 * Dim]));
            for (int c = 0; c < Dim; ++c) {
                change = hn::NegMulAdd(hn::LoadU(d, maps.q[c] + i), hn::Load(d, rows[Dim + c]), change);
            }
            float* out = level_set + i;
            hn::StoreU(hn::Add(hn::LoadU(d, out), change), d, out);
        }
    });
}

void Push2(std::size_t n, const TransportMaps<2>& maps, const float* const (&displacement)[2], const float* level_set,
           float* buffer) {
    Push<2>(n, maps, displacement, level_set, buffer);
}
void Push3(std::size_t n, const TransportMaps<3>& maps, const float* const (&displacement)[3], const float* level_set,
           float* buffer) {
    Push<3>(n, maps, displacement, level_set, buffer);
}
void Pull2(std::size_t n, const TransportMaps<2>& maps, const float* buffer, float* const (&displacement)[2],
           float* level_set) {
    Pull<2>(n, maps, buffer, displacement, level_set);
}
void Pull3(std::size_t n, const TransportMaps<3>& maps, const float* buffer, float* const (&displacement)[3],
           float* level_set) {
    Pull<3>(n, maps, buffer, displacement, level_set);
}

}  // namespace morphodesic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace morphodesic::kernels {

HWY_EXPORT(Push2);
HWY_EXPORT(Push3);
HWY_EXPORT(Pull2);
HWY_EXPORT(Pull3);

template <>
void push<2>(std::size_t n, const TransportMaps<2>& maps, const float* const (&displacement)[2], const float* level_set,
             float* buffer) {
    HWY_DYNAMIC_DISPATCH(Push2)(n, maps, displacement, level_set, buffer);
}
template <>
void push<3>(std::size_t n, const TransportMaps<3>& maps, const float* const (&displacement)[3], const float* level_set,
             float* buffer) {
    HWY_DYNAMIC_DISPATCH(Push3)(n, maps, displacement, level_set, buffer);
}
template <>
void pull<2>(std::size_t n, const TransportMaps<2>& maps, const float* buffer, float* const (&displacement)[2],
             float* level_set) {
    HWY_DYNAMIC_DISPATCH(Pull2)(n, maps, buffer, displacement, level_set);
}
template <>
void pull<3>(std::size_t n, const TransportMaps<3>& maps, const float* buffer, float* const (&displacement)[3],
             float* level_set) {
    HWY_DYNAMIC_DISPATCH(Pull3)(n, maps, buffer, displacement, level_set);
}

}  // namespace morphodesic::kernels
#endif

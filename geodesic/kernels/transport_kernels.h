#pragma once

#include <cstddef>
#include <cstdint>

namespace morphodesic::kernels {

/// Floats per coarse node in the buffers of the transport: v (Dim), z (Dim), y, and padding.
inline constexpr std::size_t transport_width = 8;

/// The maps of one frame between fields on a coarse grid and the unknowns at its n nodes, see TransportCorrection:
///   displacement += a v(p),   level set += d y(p) - q . z(p),   p the place of the node in the coarse grid.
template <int Dim>
struct TransportMaps {
    const std::uint32_t* cell;     ///< first node of the coarse cell of p [n]
    const float* fraction[Dim];    ///< place in it, in [0,1] [n]
    const float* a[Dim * Dim];     ///< row by row [n]
    const float* q[Dim];           ///< [n]
    const float* d;                ///< [n]; null: the frame has no level set of its own
    std::size_t corner[1 << Dim];  ///< offsets of the corners of a coarse cell
};

/// Transposed maps: buffer [coarse nodes][transport_width] += those of the gradient in the displacement and, where
/// there is one, in the level set.
template <int Dim>
void push(std::size_t n, const TransportMaps<Dim>& maps, const float* const (&displacement)[Dim],
          const float* level_set, float* buffer);

/// displacement and level set += the maps of the buffer.
template <int Dim>
void pull(std::size_t n, const TransportMaps<Dim>& maps, const float* buffer, float* const (&displacement)[Dim],
          float* level_set);

}  // namespace morphodesic::kernels

#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "geodesic/energy/path_energy.h"

namespace morphodesic {

/// Cell of a grid that contains a point, and the place in it; single precision.
template <int Dim>
struct CellPlace {
    std::size_t node;  ///< first node of the cell
    std::array<float, Dim> fraction;
};

/// Points outside the cube go to the nearest cell.
template <int Dim>
CellPlace<Dim> place_of(const DyadicGrid<Dim>& grid, const std::array<float, Dim>& position) {
    CellPlace<Dim> p{};
    const auto per_unit = static_cast<float>(grid.cells_per_unit());
    typename DyadicGrid<Dim>::Index cell{};
    for (std::size_t a = 0; a < Dim; ++a) {
        const int cells = grid.cells(static_cast<int>(a));
        const float y = std::clamp(position[a] * per_unit, 0.0F, static_cast<float>(cells));
        cell[a] = std::min(static_cast<int>(y), cells - 1);
        p.fraction[a] = y - static_cast<float>(cell[a]);
    }
    p.node = grid.index(cell);
    return p;
}

/// Values of the shape functions of the corners at a place in the cell.
template <int Dim>
std::array<float, 1 << Dim> corner_shares(const std::array<float, Dim>& fraction) {
    std::array<float, 1 << Dim> s;
    for (std::size_t c = 0; c < (1 << Dim); ++c) {
        s[c] = 1.0F;
        for (std::size_t a = 0; a < Dim; ++a) s[c] *= ((c >> a) & 1) ? fraction[a] : 1.0F - fraction[a];
    }
    return s;
}

/// 1 where |u| < 20 eps, falling to 0 at 40 eps: far enough for long moves to carry the level set along, and near
/// enough to leave the background alone.
inline float near_contour(double u, double eps) {
    return static_cast<float>(std::clamp(2.0 - std::abs(u) / (20.0 * eps), 0.0, 1.0));
}

/// The material points of a path, followed from frame 0 through its deformations: P_k(x) is the point of frame 0 that
/// is at x in frame k, P_k = P_{k-1} o phi_k^-1; Phi_k its inverse, and A_k = D Phi_k.
template <int Dim>
class Trajectories {
public:
    using Vector = std::array<std::vector<float>, Dim>;
    /// Frame k = 0..K-1, fields at its nodes.
    struct Frame {
        Vector origin;                                ///< P_k - id; until finish()
        std::vector<std::uint32_t> cell;              ///< first node of the coarse cell that contains P_k(x)
        Vector fraction;                              ///< place in it
        std::array<std::vector<float>, Dim * Dim> a;  ///< A_{k+1} at P_k(x), row by row
        Vector gradient;                              ///< grad u_k, empty for k = 0; until finish()
        Vector q;                                     ///< grad u_k A_k at P_k(x), times near_contour of u_k

        /// Values at the place of P_k(x) of the shape functions of its coarse cell.
        [[nodiscard]] std::array<float, 1 << Dim> shares(std::size_t i) const {
            std::array<float, Dim> at;
            for (std::size_t c = 0; c < Dim; ++c) at[c] = fraction[c][i];
            return corner_shares<Dim>(at);
        }
    };

    /// @param coarse  grid on which fields in frame 0 live
    Trajectories(const PathLayout<Dim>& layout, const DyadicGrid<Dim>& coarse);

    /// Follows the points of the path x.
    void update(const PathEnergy<Dim>& energy, std::span<const double> x);
    /// Frees what only building operators needs.
    void finish();

    [[nodiscard]] const Frame& frame(int k) const { return frames_[static_cast<std::size_t>(k)]; }
    /// A_k at a place of frame k, from D P_k in that cell; until finish().
    [[nodiscard]] Eigen::Matrix<float, Dim, Dim> jacobian_at(int k, std::size_t node, const Point<Dim>& fraction) const;
    /// P_k at a place of frame k; until finish().
    [[nodiscard]] std::array<float, Dim> origin_at(int k, std::size_t node, const Point<Dim>& fraction) const;

private:
    void follow(std::span<const double> x);
    void differentiate(const PathEnergy<Dim>& energy, std::span<const double> x);

    PathLayout<Dim> layout_;
    DyadicGrid<Dim> coarse_;
    std::vector<Frame> frames_;
};

}  // namespace morphodesic

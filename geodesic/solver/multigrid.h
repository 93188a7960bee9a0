#pragma once

#include <array>
#include <span>
#include <vector>

#include "geodesic/grid/dyadic_grid.h"
#include "geodesic/kernels/stencil_kernels.h"

namespace morphodesic {

/// Symmetric positive definite approximation of (-div(weight grad) + mass)^-1 with zero boundary values: one multigrid
/// V-cycle on the (2 Dim + 1)-point stencil, damped Jacobi as smoother, in single precision. Coarse operators are built
/// from averaged weights and summed masses. It is a preconditioner: accuracy comes from the outer iteration.
template <int Dim>
class VCycle {
public:
    explicit VCycle(DyadicGrid<Dim> grid);

    /// @param weight  [N] > 0 at the nodes
    /// @param mass    [N] >= 0 at the nodes, already multiplied by the node's volume
    void set_operator(std::span<const float> weight, std::span<const float> mass);

    /// solution = V-cycle applied to `right_side`, both [N]; boundary entries of the solution are 0.
    void apply(std::span<const double> right_side, std::span<double> solution);

private:
    struct Level {
        DyadicGrid<Dim> grid;
        std::size_t padding;  // entries before and after each padded field
        std::vector<float> weight, mass;
        std::array<std::vector<float>, Dim> edge;  // padded
        std::vector<float> diagonal, inverse_diagonal;
        std::vector<float> x, y, b;  // padded
        [[nodiscard]] kernels::Stencil<Dim> stencil() const;
    };
    void build(Level& level);
    void cycle(std::size_t depth);

    std::vector<Level> levels_;  // fine to coarse
};

}  // namespace morphodesic

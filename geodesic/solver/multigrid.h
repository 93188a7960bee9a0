#pragma once

#include <array>
#include <span>
#include <vector>

#include "geodesic/grid/dyadic_grid.h"
#include "geodesic/kernels/stencil_kernels.h"

namespace morphodesic {

/// Symmetric positive definite approximation of (-div(weight grad) + mass)^-1 on vector fields with zero boundary
/// values, mass a symmetric matrix at each node: one multigrid V-cycle on the (2 Dim + 1)-point stencil, damped block
/// Jacobi as smoother, in single precision. Coarse operators are built from averaged weights and summed masses. It is a
/// preconditioner: accuracy comes from the outer iteration.
template <int Dim>
class VCycle {
public:
    /// Mass matrices at the nodes: symmetric_entries<Dim> arrays [N], already multiplied by the node's volume.
    using Mass = std::array<std::vector<float>, kernels::symmetric_entries<Dim>>;

    explicit VCycle(DyadicGrid<Dim> grid);

    /// @param weight  [N] > 0 at the nodes
    /// @param mass    positive semidefinite at each node
    void set_operator(std::span<const float> weight, const Mass& mass);

    /// Applies the V-cycle to a right side, one array [N] per component, in place; boundary entries become 0.
    void apply(const std::array<float*, Dim>& field);

private:
    using Vector = std::array<std::vector<float>, Dim>;
    struct Level {
        DyadicGrid<Dim> grid;
        std::size_t padding;  // entries before and after each padded field
        std::vector<float> weight;  // while the operator is built
        Mass mass, block_inverse;
        std::array<std::vector<float>, Dim> edge;  // padded
        std::vector<float> diagonal;
        Vector x, y, b;  // padded
        [[nodiscard]] kernels::Stencil<Dim> stencil() const;
        [[nodiscard]] kernels::VectorOut<Dim> inner(Vector& v) const;
    };
    void build(Level& level);
    void cycle(std::size_t depth);

    std::vector<Level> levels_;  // fine to coarse
};

}  // namespace morphodesic

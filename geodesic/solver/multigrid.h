#pragma once

#include <oneapi/tbb/concurrent_queue.h>

#include <array>
#include <span>
#include <vector>

#include "geodesic/grid/dyadic_grid.h"
#include "geodesic/kernels/stencil_kernels.h"

namespace morphodesic {

/// Vectors that V-cycles on one grid work in, lent to each application: as many are held as ever ran at once.
template <int Dim>
class VCycleVectors {
public:
    /// Zero outside of the nodes.
    using Vector = std::array<std::vector<float>, Dim>;
    struct Level {
        Vector x, y, b;
    };
    using Levels = std::vector<Level>;  // fine to coarse

    explicit VCycleVectors(DyadicGrid<Dim> grid) : grid_(grid) {}

    [[nodiscard]] Levels take();
    void give_back(Levels&& levels) { free_.push(std::move(levels)); }
    /// Frees their memory.
    void clear() { free_.clear(); }

private:
    DyadicGrid<Dim> grid_;
    oneapi::tbb::concurrent_queue<Levels> free_;
};

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

    /// To be filled before set_operator: positive semidefinite at each node.
    [[nodiscard]] Mass& mass() { return levels_[0].mass; }
    /// Builds the operators from the mass and
    /// @param weight  [N] > 0 at the nodes
    void set_operator(std::span<const float> weight);

    /// Applies the V-cycle to a right side, one array [N] per component, in place; boundary entries become 0.
    void apply(const std::array<float*, Dim>& field, VCycleVectors<Dim>& vectors) const;

private:
    using Vector = typename VCycleVectors<Dim>::Vector;
    struct Level {
        DyadicGrid<Dim> grid;
        std::size_t padding;        // entries before and after each padded field
        std::vector<float> weight;  // while the operator is built
        Mass mass, block_inverse;
        std::array<std::vector<float>, Dim> edge;  // padded
        std::vector<float> diagonal;
        [[nodiscard]] kernels::Stencil<Dim> stencil() const;
        [[nodiscard]] kernels::VectorOut<Dim> inner(Vector& v) const;
    };
    void build(Level& level);
    void cycle(std::size_t depth, typename VCycleVectors<Dim>::Levels& vectors) const;

    std::vector<Level> levels_;  // fine to coarse
};

}  // namespace morphodesic

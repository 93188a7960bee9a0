#include "geodesic/solver/multigrid.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "geodesic/grid/transfer.h"

namespace morphodesic {

namespace {

constexpr int sweeps = 2;  // before and after the coarse correction
constexpr float omega = 0.8F;
constexpr int coarsest_level = 2, coarsest_sweeps = 12;

/// Mean of the fine values around each coarse node, with the weights of multilinear prolongation.
template <int Dim>
void average_to(const DyadicGrid<Dim>& coarse_grid, const float* fine, float* coarse) {
    const DyadicGrid<Dim> fine_grid(coarse_grid.level() + 1);
    // P^T f at inner nodes sums 2^Dim shares; the boundary, where it is not defined, keeps the fine value.
    restrict_residual<Dim, float>(coarse_grid, fine, coarse);
    const float share = 1.0F / (1 << Dim);
    for (std::size_t i = 0; i < coarse_grid.node_count(); ++i) {
        auto at = coarse_grid.node(i);
        bool inside = true;
        for (int& c : at) {
            inside = inside && c > 0 && c < coarse_grid.cells_per_axis();
            c *= 2;
        }
        coarse[i] = inside ? share * coarse[i] : fine[fine_grid.index(at)];
    }
}

}  // namespace

template <int Dim>
kernels::Stencil<Dim> VCycle<Dim>::Level::stencil() const {
    kernels::Stencil<Dim> s{};
    std::ptrdiff_t stride = 1;
    for (int a = 0; a < Dim; ++a, stride *= grid.nodes_per_axis()) {
        s.edge[a] = edge[static_cast<std::size_t>(a)].data() + padding;
        s.stride[a] = stride;
    }
    s.diagonal = diagonal.data();
    s.inverse_diagonal = inverse_diagonal.data();
    return s;
}

template <int Dim>
VCycle<Dim>::VCycle(DyadicGrid<Dim> grid) {
    for (int l = grid.level(); l >= std::min(coarsest_level, grid.level()); --l) {
        Level level;
        level.grid = DyadicGrid<Dim>(l);
        const std::size_t nodes = level.grid.node_count();
        level.padding = nodes / static_cast<std::size_t>(level.grid.nodes_per_axis());
        level.weight.resize(nodes);
        level.mass.resize(nodes);
        level.diagonal.resize(nodes);
        level.inverse_diagonal.resize(nodes);
        for (auto& e : level.edge) e.assign(nodes + 2 * level.padding, 0.0F);
        for (auto* f : {&level.x, &level.y, &level.b}) f->assign(nodes + 2 * level.padding, 0.0F);
        levels_.push_back(std::move(level));
    }
}

template <int Dim>
void VCycle<Dim>::build(Level& level) {
    const auto& grid = level.grid;
    const int n = grid.nodes_per_axis();
    const auto scale = static_cast<float>(std::pow(grid.spacing(), Dim - 2));
    std::size_t stride[3] = {1, 1, 1};
    for (int a = 1; a < Dim; ++a) stride[a] = stride[a - 1] * static_cast<std::size_t>(n);
    const int planes = Dim == 3 ? n : 1;
    std::size_t i = 0;
    for (int z = 0; z < planes; ++z) {
        for (int y = 0; y < n; ++y) {
            for (int x = 0; x < n; ++x, ++i) {
                const int at[3] = {x, y, z};
                for (int a = 0; a < Dim; ++a) {
                    level.edge[static_cast<std::size_t>(a)][level.padding + i] =
                        at[a] + 1 < n ? 0.5F * scale * (level.weight[i] + level.weight[i + stride[a]]) : 0.0F;
                }
            }
        }
    }
    i = 0;
    for (int z = 0; z < planes; ++z) {
        for (int y = 0; y < n; ++y) {
            for (int x = 0; x < n; ++x, ++i) {
                const bool inside = x > 0 && y > 0 && x < n - 1 && y < n - 1 && (Dim == 2 || (z > 0 && z < n - 1));
                float sum = level.mass[i];
                for (int a = 0; a < Dim; ++a) {
                    const float* e = level.edge[static_cast<std::size_t>(a)].data() + level.padding + i;
                    sum += e[0] + *(e - stride[a]);
                }
                level.diagonal[i] = sum;
                level.inverse_diagonal[i] = inside ? 1.0F / sum : 0.0F;
            }
        }
    }
}

template <int Dim>
void VCycle<Dim>::set_operator(std::span<const float> weight, std::span<const float> mass) {
    assert(weight.size() == levels_[0].grid.node_count() && mass.size() == weight.size());
    std::copy(weight.begin(), weight.end(), levels_[0].weight.begin());
    std::copy(mass.begin(), mass.end(), levels_[0].mass.begin());
    build(levels_[0]);
    for (std::size_t l = 1; l < levels_.size(); ++l) {
        average_to(levels_[l].grid, levels_[l - 1].weight.data(), levels_[l].weight.data());
        restrict_residual<Dim, float>(levels_[l].grid, levels_[l - 1].mass.data(), levels_[l].mass.data());
        build(levels_[l]);
    }
}

template <int Dim>
void VCycle<Dim>::cycle(std::size_t depth) {
    Level& level = levels_[depth];
    const std::size_t nodes = level.grid.node_count(), pad = level.padding;
    const auto stencil = level.stencil();
    const float* b = level.b.data() + pad;
    // The first sweep starts from zero.
    for (std::size_t i = 0; i < nodes; ++i) level.x[pad + i] = omega * level.inverse_diagonal[i] * b[i];
    const bool coarsest = depth + 1 == levels_.size();
    const auto smooth = [&](int count) {
        for (int s = 0; s < count; ++s) {
            kernels::jacobi_sweep<Dim>(nodes, stencil, omega, b, level.x.data() + pad, level.y.data() + pad);
            std::swap(level.x, level.y);
        }
    };
    smooth(coarsest ? coarsest_sweeps - 1 : sweeps - 1);
    if (coarsest) return;
    Level& next = levels_[depth + 1];
    kernels::residual<Dim>(nodes, stencil, b, level.x.data() + pad, level.y.data() + pad);
    restrict_residual<Dim, float>(next.grid, level.y.data() + pad, next.b.data() + next.padding);
    cycle(depth + 1);
    add_prolonged<Dim, float>(next.grid, next.x.data() + next.padding, level.x.data() + pad);
    smooth(sweeps);
}

template <int Dim>
void VCycle<Dim>::apply(std::span<const double> right_side, std::span<double> solution) {
    Level& fine = levels_[0];
    assert(right_side.size() == fine.grid.node_count() && solution.size() == right_side.size());
    for (std::size_t i = 0; i < right_side.size(); ++i) {
        fine.b[fine.padding + i] = static_cast<float>(right_side[i]);
    }
    cycle(0);
    for (std::size_t i = 0; i < solution.size(); ++i) solution[i] = fine.x[fine.padding + i];
}

template class VCycle<2>;
template class VCycle<3>;

}  // namespace morphodesic

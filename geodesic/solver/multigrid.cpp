#include "geodesic/solver/multigrid.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "geodesic/grid/transfer.h"

namespace morphodesic {

namespace {

constexpr int sweeps = 2;  // before and after the coarse correction
constexpr float omega = 0.8F;
constexpr int coarsest_cells = 4, coarsest_sweeps = 12;

/// Grids of a V-cycle, fine to coarse.
template <int Dim>
std::vector<DyadicGrid<Dim>> grids_of_cycle(const DyadicGrid<Dim>& fine) {
    std::vector<DyadicGrid<Dim>> grids{fine};
    const auto is_large = [](const DyadicGrid<Dim>& grid) {
        return std::any_of(grid.cells().begin(), grid.cells().end(), [](int n) { return n > coarsest_cells; });
    };
    while (grids.back().can_be_coarser() && is_large(grids.back())) grids.push_back(grids.back().coarser());
    return grids;
}

/// Entries before and after the nodes of a field, so that neighbours of boundary nodes can be read: one row or plane.
template <int Dim>
std::size_t padding_of(const DyadicGrid<Dim>& grid) {
    return grid.stride(Dim - 1);
}

/// Mean of the fine values around each coarse node, with the weights of multilinear prolongation.
template <int Dim>
void average_to(const DyadicGrid<Dim>& coarse_grid, const float* fine, float* coarse) {
    const DyadicGrid<Dim> fine_grid = coarse_grid.finer();
    // P^T f at inner nodes sums 2^Dim shares; the boundary, where it is not defined, keeps the fine value.
    restrict_residual<Dim, float>(coarse_grid, fine, coarse);
    const float share = 1.0F / (1 << Dim);
    for (std::size_t i = 0; i < coarse_grid.node_count(); ++i) {
        auto at = coarse_grid.node(i);
        const bool inside = !coarse_grid.on_boundary(at);
        for (int& c : at) c *= 2;
        coarse[i] = inside ? share * coarse[i] : fine[fine_grid.index(at)];
    }
}

}  // namespace

template <int Dim>
typename VCycleVectors<Dim>::Levels VCycleVectors<Dim>::take() {
    Levels levels;
    if (free_.try_pop(levels)) return levels;
    for (const auto& grid : grids_of_cycle(grid_)) {
        Level& level = levels.emplace_back();
        for (auto* v : {&level.x, &level.y, &level.b}) {
            for (auto& f : *v) f.assign(grid.node_count() + 2 * padding_of(grid), 0.0F);
        }
    }
    return levels;
}

template <int Dim>
kernels::Stencil<Dim> VCycle<Dim>::Level::stencil() const {
    kernels::Stencil<Dim> s{};
    for (int a = 0; a < Dim; ++a) {
        s.edge[a] = edge[static_cast<std::size_t>(a)].data() + padding;
        s.stride[a] = static_cast<std::ptrdiff_t>(grid.stride(a));
    }
    s.diagonal = diagonal.data();
    for (std::size_t e = 0; e < mass.size(); ++e) {
        s.mass[e] = mass[e].data();
        s.block_inverse[e] = block_inverse[e].data();
    }
    return s;
}

template <int Dim>
kernels::VectorOut<Dim> VCycle<Dim>::Level::inner(Vector& v) const {
    kernels::VectorOut<Dim> p;
    for (std::size_t a = 0; a < Dim; ++a) p[a] = v[a].data() + padding;
    return p;
}

template <int Dim>
VCycle<Dim>::VCycle(DyadicGrid<Dim> grid) {
    for (const auto& level_grid : grids_of_cycle(grid)) {
        Level level;
        level.grid = level_grid;
        const std::size_t nodes = level.grid.node_count();
        level.padding = padding_of(level.grid);
        level.diagonal.resize(nodes);
        for (auto& m : level.mass) m.resize(nodes);
        for (auto& m : level.block_inverse) m.resize(nodes);
        for (auto& e : level.edge) e.assign(nodes + 2 * level.padding, 0.0F);
        levels_.push_back(std::move(level));
    }
}

template <int Dim>
void VCycle<Dim>::build(Level& level) {
    const auto& grid = level.grid;
    const auto scale = static_cast<float>(std::pow(grid.spacing(), Dim - 2));
    std::size_t stride[Dim];
    for (int a = 0; a < Dim; ++a) stride[a] = grid.stride(a);
    const int columns = grid.nodes(0), rows = grid.nodes(1), planes = Dim == 3 ? grid.nodes(Dim - 1) : 1;
    std::size_t i = 0;
    for (int z = 0; z < planes; ++z) {
        for (int y = 0; y < rows; ++y) {
            for (int x = 0; x < columns; ++x, ++i) {
                const int at[3] = {x, y, z};
                for (int a = 0; a < Dim; ++a) {
                    level.edge[static_cast<std::size_t>(a)][level.padding + i] =
                        at[a] < grid.cells(a) ? 0.5F * scale * (level.weight[i] + level.weight[i + stride[a]]) : 0.0F;
                }
            }
        }
    }
    i = 0;
    for (int z = 0; z < planes; ++z) {
        for (int y = 0; y < rows; ++y) {
            for (int x = 0; x < columns; ++x, ++i) {
                const bool inside =
                    x > 0 && y > 0 && x < columns - 1 && y < rows - 1 && (Dim == 2 || (z > 0 && z < planes - 1));
                float sum = 0.0F;
                for (int a = 0; a < Dim; ++a) {
                    const float* e = level.edge[static_cast<std::size_t>(a)].data() + level.padding + i;
                    sum += e[0] + *(e - stride[a]);
                }
                level.diagonal[i] = sum;
                Eigen::Matrix<float, Dim, Dim> block, inverse;
                for (int r = 0; r < Dim; ++r) {
                    for (int c = 0; c < Dim; ++c) {
                        block(r, c) = level.mass[static_cast<std::size_t>(kernels::symmetric_entry<Dim>(r, c))][i] +
                                      (r == c ? sum : 0.0F);
                    }
                }
                if (inside) {
                    inverse = block.inverse();
                } else {
                    inverse.setZero();
                }
                for (int r = 0; r < Dim; ++r) {
                    for (int c = r; c < Dim; ++c) {
                        level.block_inverse[static_cast<std::size_t>(kernels::symmetric_entry<Dim>(r, c))][i] =
                            inverse(r, c);
                    }
                }
            }
        }
    }
}

template <int Dim>
void VCycle<Dim>::set_operator(std::span<const float> weight) {
    assert(weight.size() == levels_[0].grid.node_count());
    levels_[0].weight.assign(weight.begin(), weight.end());
    build(levels_[0]);
    for (std::size_t l = 1; l < levels_.size(); ++l) {
        levels_[l].weight.resize(levels_[l].grid.node_count());
        average_to(levels_[l].grid, levels_[l - 1].weight.data(), levels_[l].weight.data());
        levels_[l - 1].weight = {};
        for (std::size_t e = 0; e < levels_[l].mass.size(); ++e) {
            restrict_residual<Dim, float>(levels_[l].grid, levels_[l - 1].mass[e].data(), levels_[l].mass[e].data());
        }
        build(levels_[l]);
    }
}

template <int Dim>
void VCycle<Dim>::cycle(std::size_t depth, typename VCycleVectors<Dim>::Levels& vectors) const {
    const Level& level = levels_[depth];
    Vector& x = vectors[depth].x;
    Vector& y = vectors[depth].y;
    Vector& b = vectors[depth].b;
    const std::size_t nodes = level.grid.node_count(), pad = level.padding;
    const auto stencil = level.stencil();
    const auto reading = [&](Vector& v) {
        kernels::VectorIn<Dim> p;
        for (std::size_t a = 0; a < Dim; ++a) p[a] = v[a].data() + pad;
        return p;
    };
    const auto smooth = [&](int count) {
        for (int s = 0; s < count; ++s) {
            kernels::jacobi_sweep<Dim>(nodes, stencil, omega, reading(b), reading(x), level.inner(y));
            std::swap(x, y);
        }
    };
    const bool coarsest = depth + 1 == levels_.size();
    kernels::first_sweep<Dim>(nodes, stencil, omega, reading(b), level.inner(x));
    smooth((coarsest ? coarsest_sweeps : sweeps) - 1);
    if (coarsest) return;
    const Level& next = levels_[depth + 1];
    auto& coarse = vectors[depth + 1];
    kernels::residual<Dim>(nodes, stencil, reading(b), reading(x), level.inner(y));
    for (std::size_t a = 0; a < Dim; ++a) {
        restrict_residual<Dim, float>(next.grid, y[a].data() + pad, coarse.b[a].data() + next.padding);
    }
    cycle(depth + 1, vectors);
    for (std::size_t a = 0; a < Dim; ++a) {
        add_prolonged<Dim, float>(next.grid, coarse.x[a].data() + next.padding, x[a].data() + pad);
    }
    smooth(sweeps);
}

template <int Dim>
void VCycle<Dim>::apply(const std::array<float*, Dim>& field, VCycleVectors<Dim>& vectors) const {
    const std::size_t nodes = levels_[0].grid.node_count(), padding = levels_[0].padding;
    auto lent = vectors.take();
    for (std::size_t a = 0; a < Dim; ++a) std::copy(field[a], field[a] + nodes, lent[0].b[a].data() + padding);
    cycle(0, lent);
    for (std::size_t a = 0; a < Dim; ++a) {
        const float* x = lent[0].x[a].data() + padding;
        std::copy(x, x + nodes, field[a]);
    }
    vectors.give_back(std::move(lent));
}

template class VCycleVectors<2>;
template class VCycleVectors<3>;
template class VCycle<2>;
template class VCycle<3>;

}  // namespace morphodesic

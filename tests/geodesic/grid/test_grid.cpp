#include <gtest/gtest.h>

#include <random>

#include "geodesic/grid/injectivity.h"
#include "geodesic/grid/q1_element.h"
#include "geodesic/grid/transfer.h"
#include "geodesic/solver/multigrid.h"
#include "tests/support/path_problems.h"

namespace morphodesic {
namespace {

template <class T>
class Grid : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(Grid, Dimensions);

template <int Dim>
std::vector<double> sampled(const DyadicGrid<Dim>& grid, const std::function<double(const Point<Dim>&)>& f) {
    std::vector<double> values(grid.node_count());
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = f(grid.position(grid.node(i)));
    return values;
}

template <int Dim>
double linear(const Point<Dim>& x) {
    double value = 0.3;
    for (std::size_t a = 0; a < Dim; ++a) value += (1.0 + static_cast<double>(a)) * x[a];
    return value;
}

std::vector<double> noise(std::size_t size, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::vector<double> values(size);
    for (double& v : values) v = normal(random);
    return values;
}

/// The cube, and boxes of it.
template <int Dim>
std::vector<DyadicGrid<Dim>> cube_and_boxes(int level) {
    const int cells = 1 << level;
    typename DyadicGrid<Dim>::Index flat, tall;
    flat.fill(cells / 4);
    flat[0] = cells;
    tall.fill(cells);
    tall[0] = cells / 2;
    tall[1] = 3 * cells / 4;
    return {DyadicGrid<Dim>(level), DyadicGrid<Dim>(level, flat), DyadicGrid<Dim>(level, tall)};
}

TYPED_TEST(Grid, ProlongationIsExactOnLinearFunctions) {
    constexpr int dim = TypeParam::value;
    for (const auto& coarse : cube_and_boxes<dim>(3)) {
        const auto fine = coarse.finer();
        ASSERT_EQ(fine.coarser(), coarse);
        const auto from = sampled<dim>(coarse, linear<dim>), to = sampled<dim>(fine, linear<dim>);
        std::vector<double> result(fine.node_count(), 0.0);
        add_prolonged<dim, double>(coarse, from.data(), result.data());
        for (std::size_t i = 0; i < to.size(); ++i) ASSERT_NEAR(result[i], to[i], 1e-14);
    }
}

TYPED_TEST(Grid, RestrictionIsTheTransposeOfProlongation) {
    constexpr int dim = TypeParam::value;
    for (const auto& coarse : cube_and_boxes<dim>(3)) {
        const auto fine = coarse.finer();
        auto c = noise(coarse.node_count(), 1);
        const auto f = noise(fine.node_count(), 2);
        for (std::size_t i = 0; i < c.size(); ++i) {  // zero boundary values, as in the V-cycle
            if (coarse.on_boundary(coarse.node(i))) c[i] = 0.0;
        }
        std::vector<double> pc(f.size(), 0.0), tf(c.size());
        add_prolonged<dim, double>(coarse, c.data(), pc.data());
        restrict_residual<dim, double>(coarse, f.data(), tf.data());
        double left = 0.0, right = 0.0;
        for (std::size_t i = 0; i < f.size(); ++i) left += pc[i] * f[i];
        for (std::size_t i = 0; i < c.size(); ++i) right += c[i] * tf[i];
        EXPECT_NEAR(left, right, 1e-11 * std::abs(left));
    }
}

TYPED_TEST(Grid, RestrictionUndoesProlongation) {
    constexpr int dim = TypeParam::value;
    ScalarField<dim> fine{DyadicGrid<dim>(4)};
    const auto c = noise(DyadicGrid<dim>(3).node_count(), 3);
    add_prolonged<dim, double>(DyadicGrid<dim>(3), c.data(), fine.values.data());
    const auto back = restricted(fine, 3);
    for (std::size_t i = 0; i < c.size(); ++i) ASSERT_NEAR(back.values[i], c[i], 1e-15);
    EXPECT_THROW(restricted(fine, 5), std::invalid_argument);
}

TYPED_TEST(Grid, ValueOfQ1FunctionIsExactOnLinearFunctions) {
    constexpr int dim = TypeParam::value;
    for (const auto& grid : cube_and_boxes<dim>(3)) {
        const auto field = sampled<dim>(grid, linear<dim>);
        Point<dim> x, beyond, corner;
        for (int a = 0; a < dim; ++a) {
            const auto at = static_cast<std::size_t>(a);
            corner[at] = grid.cells(a) * grid.spacing();
            beyond[at] = corner[at] + 0.1;
            x[at] = 0.613 * corner[at];
        }
        x[0] = 0.117;
        EXPECT_NEAR(q1::value(grid, field.data(), x), linear<dim>(x), 1e-14);
        EXPECT_NEAR(q1::value(grid, field.data(), corner), linear<dim>(corner), 1e-14);
        EXPECT_NEAR(q1::value(grid, field.data(), beyond), linear<dim>(corner), 1e-14);
    }
}

TYPED_TEST(Grid, NodeAndIndexAreInverse) {
    constexpr int dim = TypeParam::value;
    for (const auto& grid : cube_and_boxes<dim>(3)) {
        std::size_t boundary = 0, cells = 0;
        for (std::size_t i = 0; i < grid.node_count(); ++i) {
            ASSERT_EQ(grid.index(grid.node(i)), i);
            boundary += grid.on_boundary(grid.node(i)) ? 1 : 0;
        }
        std::size_t inner = 1;
        for (int a = 0; a < dim; ++a) inner *= static_cast<std::size_t>(grid.cells(a) - 1);
        EXPECT_EQ(boundary, grid.node_count() - inner);
        q1::for_each_cell(grid, [&](std::size_t) { ++cells; });
        EXPECT_EQ(cells, grid.cell_count());
    }
    EXPECT_TRUE(DyadicGrid<dim>(3).is_cube());
    EXPECT_FALSE(cube_and_boxes<dim>(3)[1].is_cube());
}

template <int Dim>
struct Displacement {
    DyadicGrid<Dim> grid;
    std::array<std::vector<double>, Dim> w;
    Displacement(int level, double amplitude, unsigned seed) : grid(level) {
        for (std::size_t a = 0; a < Dim; ++a) {
            w[a] = noise(grid.node_count(), seed + static_cast<unsigned>(a));
            for (std::size_t i = 0; i < w[a].size(); ++i) {
                w[a][i] *= grid.on_boundary(grid.node(i)) ? 0.0 : amplitude * grid.spacing();
            }
        }
    }
    [[nodiscard]] DisplacementView<Dim> view() const {
        DisplacementView<Dim> v;
        for (std::size_t a = 0; a < Dim; ++a) v[a] = w[a].data();
        return v;
    }
    [[nodiscard]] std::array<double*, Dim> data() {
        std::array<double*, Dim> v;
        for (std::size_t a = 0; a < Dim; ++a) v[a] = w[a].data();
        return v;
    }
};

/// det D phi on a dense lattice of points.
template <int Dim>
double sampled_min_det(const Displacement<Dim>& d, int samples) {
    double least = 1e300;
    const auto offsets = q1::corner_offsets(d.grid);
    q1::for_each_cell(d.grid, [&](std::size_t node) {
        int total = 1;
        for (int a = 0; a < Dim; ++a) total *= samples;
        for (int s = 0; s < total; ++s) {
            Point<Dim> x{};
            for (int a = 0, rest = s; a < Dim; ++a, rest /= samples) {
                x[static_cast<std::size_t>(a)] = static_cast<double>(rest % samples) / (samples - 1);
            }
            double m[Dim][Dim];
            for (int i = 0; i < Dim; ++i) {
                for (int j = 0; j < Dim; ++j) {
                    m[i][j] = i == j ? 1.0 : 0.0;
                    for (int c = 0; c < (1 << Dim); ++c) {
                        m[i][j] += q1::shape_slope<Dim>(c, x, j) * d.grid.cells_per_axis() *
                                   d.w[static_cast<std::size_t>(i)][node + offsets[static_cast<std::size_t>(c)]];
                    }
                }
            }
            double det;
            if constexpr (Dim == 2) {
                det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
            } else {
                det = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                      m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                      m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
            }
            least = std::min(least, det);
        }
    });
    return least;
}

TYPED_TEST(Grid, DetBoundIsBelowEverySample) {
    constexpr int dim = TypeParam::value;
    for (unsigned seed = 0; seed < 6; ++seed) {
        const Displacement<dim> d(3, 0.15, 10 * seed);
        const double bound = det_lower_bound<dim>(d.grid, d.view()), sample = sampled_min_det(d, 5);
        EXPECT_LE(bound, sample + 1e-12);
        if (bound > 0) {
            EXPECT_NEAR(bound, sample, dim == 2 ? 1e-12 : 0.2);
        }
    }
}

TYPED_TEST(Grid, IdentityHasDetOne) {
    const Displacement<TypeParam::value> d(3, 0.0, 1);
    EXPECT_DOUBLE_EQ(det_lower_bound<TypeParam::value>(d.grid, d.view()), 1.0);
}

TYPED_TEST(Grid, FoldsAreRepairedAndNothingElseIsTouched) {
    constexpr int dim = TypeParam::value;
    Displacement<dim> d(4, 0.05, 5);
    const auto before = d.w;
    ASSERT_EQ(repair_folds<dim>(d.grid, d.data()), 0);
    EXPECT_EQ(d.w, before);
    // One node is pushed through its neighbours.
    typename DyadicGrid<dim>::Index middle;
    middle.fill(8);
    d.w[0][d.grid.index(middle)] += 1.7 * d.grid.spacing();
    ASSERT_LT(det_lower_bound<dim>(d.grid, d.view()), 0.0);
    const auto pushed = d.w;
    EXPECT_GT(repair_folds<dim>(d.grid, d.data(), 0.05, 0), 0);  // more than one wants to repair
    EXPECT_EQ(d.w, pushed);
    EXPECT_GT(repair_folds<dim>(d.grid, d.data(), 0.05), 0);
    EXPECT_GE(det_lower_bound<dim>(d.grid, d.view()), 0.05);
    EXPECT_EQ(d.w[0][d.grid.index(typename DyadicGrid<dim>::Index{})], before[0][0]);
    typename DyadicGrid<dim>::Index far;
    far.fill(2);
    EXPECT_EQ(d.w[0][d.grid.index(far)], before[0][d.grid.index(far)]);
}

TYPED_TEST(Grid, WildDeformationIsRepairedToo) {
    constexpr int dim = TypeParam::value;
    Displacement<dim> d(3, 5.0, 7);
    d.w[0][d.grid.node_count() / 2] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_GT(repair_folds<dim>(d.grid, d.data(), 0.05), 0);
    EXPECT_GE(det_lower_bound<dim>(d.grid, d.view()), 0.05);
}

template <int Dim>
using Components = std::array<std::vector<double>, Dim>;

template <int Dim>
Components<Dim> applied(const VCycle<Dim>& cycle, VCycleVectors<Dim>& vectors, const Components<Dim>& right_side) {
    std::array<std::vector<float>, Dim> field;
    std::array<float*, Dim> in_place;
    for (std::size_t a = 0; a < Dim; ++a) {
        field[a].assign(right_side[a].begin(), right_side[a].end());
        in_place[a] = field[a].data();
    }
    cycle.apply(in_place, vectors);
    Components<Dim> solution;
    for (std::size_t a = 0; a < Dim; ++a) solution[a].assign(field[a].begin(), field[a].end());
    return solution;
}

/// mass = size n n^T in the band |u| < width, n = grad u of a ball around the middle.
template <int Dim>
typename VCycle<Dim>::Mass stiff_across(const LevelSet<Dim>& u, double width, float size) {
    typename VCycle<Dim>::Mass mass;
    for (auto& m : mass) m.assign(u.values.size(), 0.0F);
    for (std::size_t i = 0; i < u.values.size(); ++i) {
        if (std::abs(u.values[i]) >= width) continue;
        auto n = u.grid.position(u.grid.node(i));
        double norm = 0.0;
        for (double& x : n) norm += (x - 0.5) * (x - 0.5);
        for (double& x : n) x = (x - 0.5) / std::sqrt(norm);
        for (int r = 0; r < Dim; ++r) {
            for (int c = r; c < Dim; ++c) {
                mass[static_cast<std::size_t>(kernels::symmetric_entry<Dim>(r, c))][i] =
                    size * static_cast<float>(n[static_cast<std::size_t>(r)] * n[static_cast<std::size_t>(c)]);
            }
        }
    }
    return mass;
}

TYPED_TEST(Grid, VCycleIsSymmetricPositiveDefinite) {
    constexpr int dim = TypeParam::value;
    const DyadicGrid<dim> grid(dim == 2 ? 5 : 4);
    std::vector<float> weight(grid.node_count());
    const auto u = tests::ball<dim>(grid.level(), 0.25);
    for (std::size_t i = 0; i < weight.size(); ++i) weight[i] = u.values[i] > 0 ? 1.0F : 1e-4F;
    VCycle<dim> cycle(grid);
    cycle.mass() = stiff_across<dim>(u, 0.05, 1e-3F);
    cycle.set_operator(weight);
    Components<dim> a, b;
    for (std::size_t c = 0; c < dim; ++c) {
        a[c] = noise(grid.node_count(), static_cast<unsigned>(1 + 2 * c));
        b[c] = noise(grid.node_count(), static_cast<unsigned>(2 + 2 * c));
        for (std::size_t i = 0; i < a[c].size(); ++i) {
            if (grid.on_boundary(grid.node(i))) a[c][i] = b[c][i] = 0.0;
        }
    }
    VCycleVectors<dim> vectors(grid);
    const auto ma = applied<dim>(cycle, vectors, a), mb = applied<dim>(cycle, vectors, b);
    EXPECT_EQ(ma, applied<dim>(cycle, vectors, a));  // whatever the vectors were used for before
    double ab = 0.0, ba = 0.0, aa = 0.0;
    for (std::size_t c = 0; c < dim; ++c) {
        for (std::size_t i = 0; i < a[c].size(); ++i) {
            ab += a[c][i] * mb[c][i];
            ba += b[c][i] * ma[c][i];
            aa += a[c][i] * ma[c][i];
        }
    }
    EXPECT_GT(aa, 0.0);
    EXPECT_NEAR(ab, ba, 1e-4 * aa);
}

TYPED_TEST(Grid, VCycleIsStiffAcrossTheContourOnly) {
    // One normal everywhere, along axis 0: a load along axis 1 is answered as if there were no mass, one along axis 0
    // by next to nothing.
    constexpr int dim = TypeParam::value;
    const DyadicGrid<dim> grid(4);
    const std::vector<float> weight(grid.node_count(), 1.0F);
    typename VCycle<dim>::Mass none, across;
    for (auto* mass : {&none, &across}) {
        for (auto& m : *mass) m.assign(grid.node_count(), 0.0F);
    }
    across[0].assign(grid.node_count(), 1e3F);
    Components<dim> load;
    for (auto& l : load) l = noise(grid.node_count(), 1);
    VCycle<dim> free(grid), stiff(grid);
    free.mass() = none;
    free.set_operator(weight);
    stiff.mass() = across;
    stiff.set_operator(weight);
    VCycleVectors<dim> vectors(grid);
    const auto moved_free = applied<dim>(free, vectors, load), moved_stiff = applied<dim>(stiff, vectors, load);
    double first_free = 0.0, first_stiff = 0.0;
    for (std::size_t i = 0; i < grid.node_count(); ++i) {
        ASSERT_NEAR(moved_free[1][i], moved_stiff[1][i], 1e-4 * (1.0 + std::abs(moved_free[1][i])));
        first_free += std::abs(moved_free[0][i]);
        first_stiff += std::abs(moved_stiff[0][i]);
    }
    EXPECT_LT(first_stiff, 0.05 * first_free);
    EXPECT_GT(first_stiff, 0.0);
}

TYPED_TEST(Grid, VCycleContractsTheErrorOnEveryLevelAlike) {
    // Richardson iteration with the V-cycle on the Laplacian: the residual falls by a factor that does not grow with L.
    constexpr int dim = TypeParam::value;
    std::vector<DyadicGrid<dim>> grids;
    for (const int level : dim == 2 ? std::vector<int>{4, 5, 6, 7} : std::vector<int>{3, 4, 5}) {
        for (const auto& grid : cube_and_boxes<dim>(level)) grids.push_back(grid);
    }
    for (const auto& grid : grids) {
        const std::vector<float> weight(grid.node_count(), 1.0F);
        typename VCycle<dim>::Mass mass;
        for (auto& m : mass) m.assign(grid.node_count(), 0.0F);
        VCycle<dim> cycle(grid);
        cycle.mass() = mass;
        cycle.set_operator(weight);
        VCycleVectors<dim> vectors(grid);
        const double scale = std::pow(grid.spacing(), dim - 2);
        const auto apply = [&](const std::vector<double>& x) {
            std::vector<double> y(x.size(), 0.0);
            for (std::size_t i = 0; i < x.size(); ++i) {
                if (grid.on_boundary(grid.node(i))) continue;
                for (int a = 0; a < dim; ++a) {
                    y[i] += scale * (2 * x[i] - x[i + grid.stride(a)] - x[i - grid.stride(a)]);
                }
            }
            return y;
        };
        Components<dim> b, x, r;
        for (std::size_t c = 0; c < dim; ++c) {
            b[c] = apply(sampled<dim>(
                grid, [&](const Point<dim>& at) { return tests::smooth_wave<dim>(at, static_cast<int>(c), 2); }));
            x[c].assign(b[c].size(), 0.0);
        }
        double before = 0.0, after = 0.0;
        for (int k = 0; k < 4; ++k) {
            double norm = 0.0;
            for (std::size_t c = 0; c < dim; ++c) {
                const auto ax = apply(x[c]);
                r[c].resize(ax.size());
                for (std::size_t i = 0; i < ax.size(); ++i) norm += (r[c][i] = b[c][i] - ax[i]) * r[c][i];
            }
            (k == 1 ? before : after) = std::sqrt(norm);
            const auto correction = applied<dim>(cycle, vectors, r);
            for (std::size_t c = 0; c < dim; ++c) {
                for (std::size_t i = 0; i < x[c].size(); ++i) x[c][i] += correction[c][i];
            }
        }
        EXPECT_LT(after, 0.15 * before) << "level " << grid.level() << ", " << grid.cells(0) << " x " << grid.cells(1)
                                        << " cells";  // over two cycles
    }
}

}  // namespace
}  // namespace morphodesic

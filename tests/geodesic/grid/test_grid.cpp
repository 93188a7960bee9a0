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

TYPED_TEST(Grid, ProlongationIsExactOnLinearFunctions) {
    constexpr int dim = TypeParam::value;
    const DyadicGrid<dim> coarse(3), fine(4);
    const auto from = sampled<dim>(coarse, linear<dim>), to = sampled<dim>(fine, linear<dim>);
    std::vector<double> result(fine.node_count(), 0.0);
    add_prolonged<dim, double>(coarse, from.data(), result.data());
    for (std::size_t i = 0; i < to.size(); ++i) ASSERT_NEAR(result[i], to[i], 1e-14);
}

TYPED_TEST(Grid, RestrictionIsTheTransposeOfProlongation) {
    constexpr int dim = TypeParam::value;
    const DyadicGrid<dim> coarse(3), fine(4);
    auto c = noise(coarse.node_count(), 1);
    const auto f = noise(fine.node_count(), 2);
    for (std::size_t i = 0; i < c.size(); ++i) {  // zero boundary values, as in the V-cycle
        for (const int at : coarse.node(i)) {
            if (at == 0 || at == coarse.cells_per_axis()) c[i] = 0.0;
        }
    }
    std::vector<double> pc(f.size(), 0.0), tf(c.size());
    add_prolonged<dim, double>(coarse, c.data(), pc.data());
    restrict_residual<dim, double>(coarse, f.data(), tf.data());
    double left = 0.0, right = 0.0;
    for (std::size_t i = 0; i < f.size(); ++i) left += pc[i] * f[i];
    for (std::size_t i = 0; i < c.size(); ++i) right += c[i] * tf[i];
    EXPECT_NEAR(left, right, 1e-11 * std::abs(left));
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
    const DyadicGrid<dim> grid(3);
    const auto field = sampled<dim>(grid, linear<dim>);
    Point<dim> x;
    x.fill(0.613);
    x[0] = 0.117;
    EXPECT_NEAR(q1::value(grid, field.data(), x), linear<dim>(x), 1e-14);
    x.fill(1.0);
    EXPECT_NEAR(q1::value(grid, field.data(), x), linear<dim>(x), 1e-14);
}

TYPED_TEST(Grid, NodeAndIndexAreInverse) {
    const DyadicGrid<TypeParam::value> grid(3);
    for (std::size_t i = 0; i < grid.node_count(); ++i) ASSERT_EQ(grid.index(grid.node(i)), i);
}

template <int Dim>
struct Displacement {
    DyadicGrid<Dim> grid;
    std::array<std::vector<double>, Dim> w;
    Displacement(int level, double amplitude, unsigned seed) : grid(level) {
        for (std::size_t a = 0; a < Dim; ++a) {
            w[a] = noise(grid.node_count(), seed + static_cast<unsigned>(a));
            for (std::size_t i = 0; i < w[a].size(); ++i) {
                bool inside = true;
                for (const int c : grid.node(i)) inside = inside && c > 0 && c < grid.cells_per_axis();
                w[a][i] *= inside ? amplitude * grid.spacing() : 0.0;
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

TYPED_TEST(Grid, VCycleIsSymmetricPositiveDefinite) {
    constexpr int dim = TypeParam::value;
    const DyadicGrid<dim> grid(dim == 2 ? 5 : 4);
    std::vector<float> weight(grid.node_count()), mass(grid.node_count());
    const auto u = tests::ball<dim>(grid.level(), 0.25);
    for (std::size_t i = 0; i < weight.size(); ++i) {
        weight[i] = u.values[i] > 0 ? 1.0F : 1e-4F;
        mass[i] = std::abs(u.values[i]) < 0.05 ? 1e-3F : 0.0F;
    }
    VCycle<dim> cycle(grid);
    cycle.set_operator(weight, mass);
    auto a = noise(grid.node_count(), 1), b = noise(grid.node_count(), 2);
    for (std::size_t i = 0; i < a.size(); ++i) {
        for (const int c : grid.node(i)) {
            if (c == 0 || c == grid.cells_per_axis()) a[i] = b[i] = 0.0;
        }
    }
    std::vector<double> ma(a.size()), mb(a.size());
    cycle.apply(a, ma);
    cycle.apply(b, mb);
    double ab = 0.0, ba = 0.0, aa = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        ab += a[i] * mb[i];
        ba += b[i] * ma[i];
        aa += a[i] * ma[i];
    }
    EXPECT_GT(aa, 0.0);
    EXPECT_NEAR(ab, ba, 1e-4 * aa);
}

TYPED_TEST(Grid, VCycleContractsTheErrorOnEveryLevelAlike) {
    // Richardson iteration with the V-cycle on the Laplacian: the residual falls by a factor that does not grow with L.
    constexpr int dim = TypeParam::value;
    for (const int level : dim == 2 ? std::vector<int>{4, 5, 6, 7} : std::vector<int>{3, 4, 5}) {
        const DyadicGrid<dim> grid(level);
        std::vector<float> weight(grid.node_count(), 1.0F), mass(grid.node_count(), 0.0F);
        VCycle<dim> cycle(grid);
        cycle.set_operator(weight, mass);
        const double scale = std::pow(grid.spacing(), dim - 2);
        const auto apply = [&](const std::vector<double>& x) {
            std::vector<double> y(x.size(), 0.0);
            std::size_t stride[3] = {1, 1, 1};
            for (int a = 1; a < dim; ++a) stride[a] = stride[a - 1] * static_cast<std::size_t>(grid.nodes_per_axis());
            for (std::size_t i = 0; i < x.size(); ++i) {
                bool inside = true;
                for (const int c : grid.node(i)) inside = inside && c > 0 && c < grid.cells_per_axis();
                if (!inside) continue;
                for (int a = 0; a < dim; ++a) y[i] += scale * (2 * x[i] - x[i + stride[a]] - x[i - stride[a]]);
            }
            return y;
        };
        const auto b = apply(sampled<dim>(grid, [](const Point<dim>& x) { return tests::smooth_wave<dim>(x, 0, 2); }));
        std::vector<double> x(b.size(), 0.0), correction(b.size());
        double before = 0.0, after = 0.0;
        for (int k = 0; k < 4; ++k) {
            const auto ax = apply(x);
            std::vector<double> r(b.size());
            double norm = 0.0;
            for (std::size_t i = 0; i < r.size(); ++i) norm += (r[i] = b[i] - ax[i]) * r[i];
            (k == 1 ? before : after) = std::sqrt(norm);
            cycle.apply(r, correction);
            for (std::size_t i = 0; i < x.size(); ++i) x[i] += correction[i];
        }
        EXPECT_LT(after, 0.15 * before) << "level " << level;  // over two cycles
    }
}

}  // namespace
}  // namespace morphodesic

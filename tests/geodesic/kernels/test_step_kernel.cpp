#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "geodesic/kernels/step_kernel.h"
#include "tests/support/instruction_sets.h"

namespace morphodesic::kernels {
namespace {

/// One step on a grid of 32 x 32 cells, a disk before and after, displacements of up to `waves` cells around `shift`
/// cells.
struct Step {
    static constexpr int cells = 32, width = cells + 1;
    std::vector<double> w[2], u;

    Step(double shift, double waves) : u(width * width) {
        for (auto& component : w) component.resize(u.size());
        for (int y = 0; y < width; ++y) {
            for (int x = 0; x < width; ++x) {
                const auto i = static_cast<std::size_t>(y * width + x);
                u[i] = 0.25 - std::hypot(x - 16.0, y - 16.0) / cells;
                w[0][i] = waves * std::sin(0.4 * y) / cells;
                w[1][i] = (shift + waves * std::sin(0.4 * x) * std::cos(0.3 * y)) / cells;
            }
        }
    }
};

TEST(StepKernel, ReadsAndWritesNothingBeyondTheRowsItIsGiven) {
    // Blocks of nodes around deformed points are larger than what the points need; they have to stay inside.
    constexpr int begin = 12, end = 16, guard = 3;
    const StepWeights weights{5, 1.0, 1.0, 1e-4, 0.5 / Step::cells, 1.0, 25.0, 1.0, Quadrature::many};
    const auto check = [&](double shift, double waves) {
        Step step(shift, waves);
        const auto [low, high] =
            std::minmax_element(step.w[1].begin() + begin * Step::width, step.w[1].begin() + (end + 1) * Step::width);
        const int last = std::clamp(static_cast<int>(std::floor(end + *high * Step::cells)) + 1, 3, Step::cells);
        const int first = std::min(std::max(static_cast<int>(std::floor(begin + *low * Step::cells)), 0), last - 3);
        const auto nan = std::numeric_limits<double>::quiet_NaN();
        std::vector<double> to = step.u;
        for (std::size_t i = 0; i < to.size(); ++i) {
            const int row = static_cast<int>(i) / Step::width;
            if (row < first || row > last) to[i] = nan;
        }
        const auto rows = static_cast<std::size_t>(last - first + 1);
        std::vector<double> gradient[2], gradient_previous(step.u.size());
        for (auto& g : gradient) g.resize(step.u.size());
        // Where a zero is added to -0, there is no sign any more.
        std::vector<double> gradient_next((rows + 2 * guard) * Step::width, -0.0);
        double* const begin_next = gradient_next.data() + guard * Step::width;
        std::fill(begin_next, begin_next + rows * Step::width, 0.0);
        const StepFields<2, double> fields{{Step::cells, Step::cells},
                                           {step.w[0].data(), step.w[1].data()},
                                           step.u.data(),
                                           to.data(),
                                           nullptr,
                                           first,
                                           last};
        const StepGradients<2, double> out{
            {gradient[0].data(), gradient[1].data()}, gradient_previous.data(), begin_next};
        const StepSums part = step_energy_rows<2, double>(begin, end, fields, weights, out);
        double sum = 0.0;
        for (std::size_t i = 0; i < gradient_next.size(); ++i) {
            const bool inside = i >= guard * Step::width && i < (guard + rows) * Step::width;
            if (inside) {
                sum += std::abs(gradient_next[i]);
            } else {
                EXPECT_TRUE(gradient_next[i] == 0.0 && std::signbit(gradient_next[i])) << i;
            }
        }
        EXPECT_GT(sum, 0.0) << shift;

        // The same with everything at hand.
        StepFields<2, double> all = fields;
        all.u_next = step.u.data();
        all.u_next_first_row = 0;
        all.u_next_last_row = Step::cells;
        std::vector<double> whole(step.u.size());
        const StepSums same = step_energy_rows<2, double>(
            begin, end, all, weights,
            {{gradient[0].data(), gradient[1].data()}, gradient_previous.data(), whole.data()});
        EXPECT_NEAR(part.mismatch, same.mismatch, 1e-12 * same.mismatch);
        EXPECT_EQ(part.deformation, same.deformation);
        for (std::size_t i = 0; i < rows * Step::width; ++i) {
            EXPECT_NEAR(begin_next[i], whole[static_cast<std::size_t>(first * Step::width) + i], 1e-12);
        }
    };
    for (const double shift : {-15.0, -7.5, 0.0, 0.5, 4.0, 19.0}) {
        tests::for_each_instruction_set([&](const std::string& name) {
            SCOPED_TRACE(name);
            check(shift, 1.0);
            check(shift, 0.0);  // all cells of a row move alike, up to the ends of the last one
        });
    }
}

/// A ball of radius `radius` cells on a grid of 16 or 32 cells per axis, moved by `displacement` (in cells).
template <int Dim, class T>
struct MovedBall {
    static constexpr int cells = Dim == 2 ? 32 : 16, width = cells + 1;
    std::vector<T> w[Dim], u;
    std::vector<T> gradient[Dim], gradient_next;
    StepFields<Dim, T> fields{};
    StepWeights weights{Dim == 2 ? 5 : 4, 1.0, 1.0, 1e-4, 1.0 / cells, 1.0, 25.0, 0.0, Quadrature::many};

    explicit MovedBall(const auto& displacement) {
        const auto nodes = static_cast<std::size_t>(std::pow(width, Dim));
        u.resize(nodes);
        gradient_next.resize(nodes);
        for (int a = 0; a < Dim; ++a) {
            w[a].resize(nodes);
            gradient[a].resize(nodes);
        }
        for (std::size_t i = 0; i < nodes; ++i) {
            int x[3] = {static_cast<int>(i) % width, static_cast<int>(i) / width % width, 0};
            if (Dim == 3) x[2] = static_cast<int>(i) / (width * width);
            double square = 0.0;
            for (int a = 0; a < Dim; ++a) {
                square += std::pow(x[a] - 0.5 * cells, 2);
                w[a][i] = static_cast<T>(displacement(a, x) / cells);
            }
            u[i] = static_cast<T>(0.3 - std::sqrt(square) / cells);
        }
        std::fill_n(fields.cells, Dim, cells);
        for (int a = 0; a < Dim; ++a) fields.displacement[a] = w[a].data();
        fields.u_previous = fields.u_next = u.data();
        fields.u_next_last_row = cells;
    }
    [[nodiscard]] double mismatch(const std::vector<T>& next) const {
        StepFields<Dim, T> f = fields;
        f.u_next = next.data();
        return weights.mismatch * step_energy_rows<Dim, T>(0, cells, f, weights, {}).mismatch;
    }
    const std::vector<T>& derivative() {
        StepGradients<Dim, T> out{};
        for (int a = 0; a < Dim; ++a) out.displacement[a] = gradient[a].data();
        out.u_next = gradient_next.data();
        (void)step_energy_rows<Dim, T>(0, cells, fields, weights, out);
        return gradient_next;
    }
};

template <int Dim>
void check_derivative_by_the_next_shape(const std::string& what, const auto& displacement) {
    MovedBall<Dim, double> step(displacement);
    const std::vector<double>& derivative = step.derivative();
    double largest = 0.0;
    for (const double g : derivative) largest = std::max(largest, std::abs(g));
    ASSERT_GT(largest, 1e-3) << what;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> between(-1.0, 1.0);
    for (int direction = 0; direction < 3; ++direction) {
        constexpr double change = 1e-5;
        std::vector<double> more = step.u, less = step.u;
        double slope = 0.0, size = 0.0;
        for (std::size_t i = 0; i < more.size(); ++i) {
            const double d = between(random);
            more[i] += change * d;
            less[i] -= change * d;
            slope += derivative[i] * d;
            size += std::abs(derivative[i] * d);
        }
        EXPECT_NEAR(slope, (step.mismatch(more) - step.mismatch(less)) / (2 * change), 1e-6 * size) << what;
    }
    MovedBall<Dim, float> single(displacement);
    const std::vector<float>& in_single = single.derivative();
    for (std::size_t i = 0; i < derivative.size(); ++i) {
        EXPECT_NEAR(in_single[i], derivative[i], 1e-4 * largest) << what << " at " << i;
    }
}

TEST(StepKernel, DerivativeByTheNextShapeIsRightHoweverNeighbouringCellsMove) {
    // Lanes whose deformed cells follow each other in memory are read and written together, others one by one.
    const auto check = [](const std::string& what, const auto& displacement) {
        tests::for_each_instruction_set([&](const std::string& name) {
            check_derivative_by_the_next_shape<2>(what + ", " + name + ", 2D", displacement);
            check_derivative_by_the_next_shape<3>(what + ", " + name + ", 3D", displacement);
        });
    };
    check("all alike", [](int axis, const int(&)[3]) { return axis == 0 ? 1.3 : -2.6; });
    check("stretched", [](int axis, const int(&x)[3]) { return axis == 0 ? 0.09 * (x[0] - 12.0) : 0.2; });
    check("sheared", [](int axis, const int(&x)[3]) { return axis == 1 ? 0.13 * (x[0] - 5.0) : 0.4; });
    check("wild", [](int axis, const int(&x)[3]) { return std::sin(1.1 * x[0] + 0.9 * x[1] + axis); });
    check("beyond the border", [](int axis, const int(&x)[3]) { return (axis == 0 ? 0.6 : -0.6) * (x[0] - 4.0); });
}

}  // namespace
}  // namespace morphodesic::kernels

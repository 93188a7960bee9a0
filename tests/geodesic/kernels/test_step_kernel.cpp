#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "geodesic/kernels/step_kernel.h"

namespace morphodesic::kernels {
namespace {

/// One step on a grid of 32 x 32 cells, a disk before and after, displacements of up to a cell around `shift` cells.
struct Step {
    static constexpr int cells = 32, width = cells + 1;
    std::vector<double> w[2], u;

    explicit Step(double shift) : u(width * width) {
        for (auto& component : w) component.resize(u.size());
        for (int y = 0; y < width; ++y) {
            for (int x = 0; x < width; ++x) {
                const auto i = static_cast<std::size_t>(y * width + x);
                u[i] = 0.25 - std::hypot(x - 16.0, y - 16.0) / cells;
                w[0][i] = std::sin(0.4 * y) / cells;
                w[1][i] = (shift + std::sin(0.4 * x) * std::cos(0.3 * y)) / cells;
            }
        }
    }
};

TEST(StepKernel, ReadsAndWritesNothingBeyondTheRowsItIsGiven) {
    // Blocks of nodes around deformed points are larger than what the points need; they have to stay inside.
    constexpr int begin = 12, end = 16, guard = 3;
    const StepWeights weights{5, 1.0, 1.0, 1e-4, 0.5 / Step::cells, 1.0, 25.0, 1.0, Quadrature::many};
    for (const double shift : {-15.0, -7.5, 0.0, 0.5, 4.0, 19.0}) {
        Step step(shift);
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
    }
}

}  // namespace
}  // namespace morphodesic::kernels

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "geodesic/solver/cascade.h"
#include "geodesic/solver/path_minimizer.h"
#include "tests/support/path_problems.h"

namespace morphodesic {
namespace {

// Infinite gradients became displacements that are no numbers, and cells looked up at those.
TEST(PathMinimizer, AnEnergyBeyondSinglePrecisionIsNotMinimised) {
    const auto first = tests::ball<2>(5, 0.2, {0.4, 0.5}), last = tests::ball<2>(5, 0.25, {0.6, 0.5});
    for (const double weight : {1e14, 1e20, 1e30, 1e37, 1e45}) {
        GeodesicOptions options;
        options.mismatch_weight = weight;  // beyond what GeodesicOptions::problems() lets through
        PathEnergy<2> energy(first, last, 2, options);
        auto path = blended_path(first, last, 2);
        try {
            const auto summary = minimize_path<2>(energy, path.x, {});
            EXPECT_TRUE(std::isfinite(summary.terms.total)) << weight;
        } catch (const std::invalid_argument&) {  // the first guess is infinite already
        }
        for (const double x : path.x) ASSERT_TRUE(std::isfinite(x)) << weight;
    }
}

// With a weight this large full steps fail and lessons do not help: the solve has to end, not to try the same again.
TEST(PathMinimizer, StepsThatFailAgainAndAgainEndTheSolve) {
    const auto first = tests::ball<2>(5, 0.2, {0.4, 0.5}), last = tests::ball<2>(5, 0.25, {0.55, 0.5});
    for (const double weight : {200.0, 3e5, 1e6}) {
        for (const int steps : {1, 2, 4}) {
            GeodesicOptions options;
            options.mismatch_weight = weight;
            options.rim_width = 1.0;
            PathEnergy<2> energy(first, last, steps, options);
            auto path = blended_path(first, last, steps);
            const double before = energy.evaluate(path.x, {}).total;
            const auto summary = minimize_path<2>(energy, path.x, {});
            EXPECT_NE(summary.termination, Termination::max_steps) << weight << " K " << steps;
            EXPECT_LT(summary.evaluations, 12 * summary.iterations + 80) << weight << " K " << steps;
            EXPECT_LT(summary.terms.total, before);
        }
    }
}

TEST(PathMinimizer, FoldsOfTheStartAreRepaired) {
    const auto u = tests::ball<2>(5, 0.2);
    PathEnergy<2> energy(u, u, 1, GeodesicOptions{});
    auto path = blended_path(u, u, 1);
    const auto& layout = energy.layout();
    path.x[layout.displacement(1, 0) + layout.grid.index({16, 16})] = 1.5 * layout.grid.spacing();
    ASSERT_FALSE(std::isfinite(energy.evaluate(path.x, {}).total));
    const auto summary = minimize_path<2>(energy, path.x, {});
    EXPECT_EQ(summary.termination, Termination::converged);
    EXPECT_TRUE(std::isfinite(summary.terms.total));
}

TEST(PathMinimizer, WeightsThatLeaveNothingOfTheOthersAreRefused) {
    for (double GeodesicOptions::*weight :
         {&GeodesicOptions::mismatch_weight, &GeodesicOptions::mismatch_weight_per_step, &GeodesicOptions::lambda,
          &GeodesicOptions::mu, &GeodesicOptions::area_weight}) {
        for (const double value : {1e12, HUGE_VAL, std::nan("")}) {
            GeodesicOptions options;
            options.*weight = value;
            EXPECT_EQ(options.problems().size(), 1u) << value;
        }
    }
}

}  // namespace
}  // namespace morphodesic

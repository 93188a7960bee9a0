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

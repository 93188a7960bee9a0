#include <gtest/gtest.h>

#include "geodesic/solver/cascade.h"
#include "geodesic/solver/volume_constraint.h"
#include "tests/support/path_problems.h"

namespace morphodesic {
namespace {

TEST(VolumeConstraint, VolumesAreReachedHoweverSteepTheLevelSet) {
    const auto first = tests::ball<2>(5, 0.2), last = tests::ball<2>(5, 0.25);
    const PathEnergy<2> energy(first, last, 4, GeodesicOptions{});
    const VolumeConstraint<2> constraint(energy);
    const double from = enclosed_volume(first.grid, first.values.data());
    const double to = enclosed_volume(last.grid, last.values.data());
    for (const double steepness : {0.3, 1.0, 40.0, 1e4}) {
        for (const double offset : {-0.1, 0.0, 0.15}) {
            auto path = blended_path(first, last, 4);
            for (int k = 1; k < 4; ++k) {
                double* u = path.x.data() + path.layout.level_set(k);
                for (std::size_t i = 0; i < path.layout.nodes(); ++i) u[i] = steepness * (u[i] + offset);
            }
            ASSERT_TRUE(constraint.correct(path.x)) << steepness << " " << offset;
            for (int k = 1; k < 4; ++k) {
                const double expected = from + (to - from) * k / 4;
                EXPECT_NEAR(enclosed_volume(first.grid, path.x.data() + path.layout.level_set(k)), expected,
                            1e-9 * expected);
            }
        }
    }
}

TEST(VolumeConstraint, AShapeThatHasVanishedIsToldApart) {
    const auto u = tests::ball<2>(5, 0.2);
    const PathEnergy<2> energy(u, u, 2, GeodesicOptions{});
    auto path = blended_path(u, u, 2);
    std::fill_n(path.x.begin() + static_cast<std::ptrdiff_t>(path.layout.level_set(1)), path.layout.nodes(), -0.3);
    EXPECT_FALSE(VolumeConstraint<2>(energy).correct(path.x));
}

}  // namespace
}  // namespace morphodesic

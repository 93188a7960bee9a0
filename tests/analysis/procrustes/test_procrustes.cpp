#include <gtest/gtest.h>

#include <cmath>

#include "analysis/procrustes.h"
#include "analysis/random.h"
#include "tests/analysis/support.h"

namespace morphodesic::analysis {
namespace {

TEST(Procrustes, UndoesATurnAMirrorAndAMove) {
    Random random(1);
    Embedding a{2, {}}, b{2, {}};
    for (int i = 0; i < 20; ++i) {
        const double x = random.normal(), y = random.normal();
        a.coordinates.insert(a.coordinates.end(), {x, y});
        const double c = std::cos(0.7), s = std::sin(0.7);
        b.coordinates.insert(b.coordinates.end(), {3.0 + 2.0 * (c * x + s * y), -1.0 + 2.0 * (s * x - c * y)});
    }
    const Procrustes scaled = procrustes(a, b, true);
    EXPECT_NEAR(scaled.rms_distance, 0.0, 1e-12);
    EXPECT_NEAR(scaled.scale, 0.5, 1e-12);
    for (std::size_t k = 0; k < 40; ++k) EXPECT_NEAR(scaled.aligned.coordinates[k], a.coordinates[k], 1e-12);
    const Procrustes rigid = procrustes(a, b);
    EXPECT_EQ(rigid.scale, 1.0);
    EXPECT_GT(rigid.rms_distance, 0.1);
    EXPECT_THROW((void)procrustes(a, {3, {0, 0, 0}}), std::invalid_argument);
}

TEST(PlaceQuery, FindsAPointFromItsDistances) {
    const Embedding e{2, {0, 0, 4, 0, 0, 3, 5, 5, -2, 1}};
    for (const auto& [x, y] : {std::pair(1.0, 1.0), std::pair(7.0, -3.0), std::pair(4.0, 0.0)}) {
        std::vector<double> d;
        for (std::size_t j = 0; j < 5; ++j) d.push_back(std::hypot(x - e(j, 0), y - e(j, 1)));
        d[3] = missing;
        const Placement place = place_query(e, d);
        EXPECT_NEAR(place.position[0], x, 1e-6);
        EXPECT_NEAR(place.position[1], y, 1e-6);
        EXPECT_NEAR(place.stress, 0.0, 1e-6);
    }
}

TEST(PlaceQuery, NoPointNearbyIsBetter) {
    const Embedding e{2, {0, 0, 4, 0, 0, 3, 5, 5}};
    const std::vector<double> d{2.0, 2.5, 2.0, 6.0};
    const Placement place = place_query(e, d);
    const auto stress = [&](double x, double y) {
        double misfit = 0.0, squares = 0.0;
        for (std::size_t j = 0; j < 4; ++j) {
            misfit += std::pow(std::hypot(x - e(j, 0), y - e(j, 1)) - d[j], 2);
            squares += d[j] * d[j];
        }
        return std::sqrt(misfit / squares);
    };
    EXPECT_NEAR(stress(place.position[0], place.position[1]), place.stress, 1e-9);
    for (double x = -8.0; x <= 8.0; x += 0.1) {
        for (double y = -8.0; y <= 8.0; y += 0.1) EXPECT_GE(stress(x, y), place.stress - 1e-9);
    }
    EXPECT_THROW((void)place_query(e, std::vector<double>(4, missing)), std::invalid_argument);
    EXPECT_THROW((void)place_query(e, std::vector<double>(3, 1.0)), std::invalid_argument);
}

}  // namespace
}  // namespace morphodesic::analysis

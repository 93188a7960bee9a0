#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "datasets/mesh_smoothing.h"
#include "datasets/random_source.h"
#include "datasets/solidify.h"
#include "tests/datasets/solids/solid_files.h"

namespace morphodesic::datasets {
namespace {

using namespace tests;

constexpr double noise = 0.004;

TriangleMesh noisy_ball() {
    TriangleMesh ball = ball_mesh(ball_middle, ball_radius, 5);
    RandomSource random(3);
    for (auto& p : ball.points) {
        const double a = random.uniform(-1, 1) + random.uniform(-1, 1) + random.uniform(-1, 1);  // of variance 1
        p = p + (noise * a / ball_radius) * (p - ball_middle);
    }
    return ball;
}

double deviation(const TriangleMesh& mesh) {
    double sum = 0.0;
    for (const auto& p : mesh.points) sum += std::pow(norm(p - ball_middle) - ball_radius, 2);
    return std::sqrt(sum / static_cast<double>(mesh.points.size()));
}

TEST(MeshSmoothing, RoughnessIsTheNoise) {
    EXPECT_NEAR(roughness(noisy_ball()), noise, 0.1 * noise);
    EXPECT_LT(roughness(ball_mesh(ball_middle, ball_radius, 5)), 0.01 * noise);
    EXPECT_LT(roughness(box_mesh({0, 0, 0}, {1, 1, 1})), 1e-12);
}

/// A ball with waves of the same height as the noise, long enough for the mesh to resolve them.
TriangleMesh wavy_ball() {
    TriangleMesh ball = ball_mesh(ball_middle, ball_radius, 5);
    for (auto& p : ball.points) {
        const Vector3 r = (1.0 / ball_radius) * (p - ball_middle);
        const double wave = std::sin(12 * r[0]) * std::cos(11 * r[1]) * std::sin(13 * r[2] + 1);
        p = p + (4 * noise * wave) * r;
    }
    return ball;
}

TEST(MeshSmoothing, NoiseIsToldFromDetail) {
    EXPECT_LT(bump_correlation(noisy_ball()), -0.15);
    EXPECT_GT(bump_correlation(wavy_ball()), 0.5);
    EXPECT_GT(bump_correlation(ball_mesh(ball_middle, ball_radius, 5)), 0.5);
    EXPECT_GT(bump_correlation(box_mesh({0, 0, 0}, {1, 1, 1})), 0.4);
    EXPECT_EQ(bump_correlation({}), 1.0);
}

TEST(MeshSmoothing, OnlyNoiseIsSmoothedAndOnlyIfWanted) {
    TriangleMesh wavy = wavy_ball(), noisy = noisy_ball();
    EXPECT_GT(roughness(wavy), 0.001);  // as rough as a noisy scan
    EXPECT_THAT(solid_from_triangles(wavy, "wavy").notes, testing::IsEmpty());
    EXPECT_THAT(solid_from_triangles(noisy, "noisy").notes, testing::Contains(testing::HasSubstr("was smoothed")));
    SolidifyOptions keep;
    keep.smooth_noise = false;
    EXPECT_THAT(solid_from_triangles(noisy, "noisy", keep).notes,
                testing::Not(testing::Contains(testing::HasSubstr("smoothed"))));
}

/// More than half of the points lie on flat faces: their bumps are the rounding of the coordinates, of any size.
TEST(MeshSmoothing, FlatFacesAreNotNoisyHoweverTheyAreRounded) {
    const Vector3 high{10, 20, 30};
    RandomSource random(5);
    for (const int divisions : {6, 8}) {
        for (const double rounding : {0.0, 1e-15, 1e-7, 1e-4}) {
            TriangleMesh box = divided_box_mesh({0, 0, 0}, high, divisions);
            clean(box);
            EXPECT_GT(roughness(box), 0.003 * norm(high));  // its edges
            for (auto& p : box.points) {
                for (double& x : p) x += rounding * norm(high) * random.uniform(-1, 1);
            }
            const Solid solid = solid_from_triangles(box, "box");
            EXPECT_THAT(solid.notes, testing::IsEmpty()) << divisions << " " << rounding;
            EXPECT_NEAR(solid.volume, 6000.0, 1e-3 * 6000.0);
        }
    }
}

TEST(MeshSmoothing, NoiseGoesAndTheBallStays) {
    TriangleMesh ball = noisy_ball();
    smooth_noise(ball, roughness(ball));
    EXPECT_LT(deviation(ball), 0.3 * noise);
    EXPECT_NEAR(signed_volume(ball), 4.0 / 3.0 * std::numbers::pi * std::pow(ball_radius, 3),
                0.004 * signed_volume(ball));
}

TEST(MeshSmoothing, FlatTrianglesDoNotCostVolume) {
    TriangleMesh ball = ball_mesh(ball_middle, ball_radius, 4);  // its points on the sphere, its faces below it
    const double exact = 4.0 / 3.0 * std::numbers::pi * std::pow(ball_radius, 3), before = signed_volume(ball);
    smooth_noise(ball, 0.001);
    EXPECT_LT(std::abs(signed_volume(ball) - exact), 0.3 * std::abs(before - exact));
}

TEST(MeshSmoothing, AFilledHoleGoesOnRound) {
    const TriangleMesh ball = ball_mesh(ball_middle, ball_radius, 5);
    TriangleMesh dented = ball;
    std::vector<char> is_free(ball.points.size(), 0);
    for (std::size_t i = 0; i < ball.points.size(); ++i) {
        double& z = dented.points[i][2];
        if (z > ball_middle[2] + 0.85 * ball_radius)
            z = ball_middle[2] + 0.85 * ball_radius, is_free[i] = 1;  // a flat lid
    }
    const double flat = deviation(dented);
    fair(dented, is_free);
    EXPECT_LT(deviation(dented), 0.07 * flat);
    for (std::size_t i = 0; i < ball.points.size(); ++i) {
        if (!is_free[i]) {
            EXPECT_EQ(dented.points[i], ball.points[i]);
        }
    }
}

TEST(MeshSmoothing, WithoutAnyHeldPointNothingMoves) {
    TriangleMesh ball = ball_mesh(ball_middle, ball_radius, 2);
    const auto before = ball.points;
    fair(ball, std::vector<char>(ball.points.size(), 1));
    EXPECT_EQ(ball.points, before);
}

}  // namespace
}  // namespace morphodesic::datasets

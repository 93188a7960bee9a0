#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "datasets/import.h"
#include "datasets/point_surface.h"
#include "datasets/read_error.h"
#include "datasets/solidify.h"
#include "tests/datasets/solids/solid_files.h"
#include "tests/support/thread_counts.h"

namespace morphodesic::datasets {
namespace {

using namespace tests;
using testing::Contains;
using testing::HasSubstr;

constexpr double cloud_radius = 50.0;
const double cloud_volume = 4.0 / 3.0 * std::numbers::pi * std::pow(cloud_radius, 3);

/// Random points of a sphere below a plane, moved by noise in all directions.
std::vector<Vector3> sphere_points(int count, double below = 1e9, double noise = 0.0) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    std::vector<Vector3> points;
    while (static_cast<int>(points.size()) < count) {
        Vector3 p{normal(random), normal(random), normal(random)};
        p = (cloud_radius / norm(p)) * p;
        if (p[2] > below) continue;
        for (double& x : p) x += noise * normal(random);
        points.push_back(p);
    }
    return points;
}

TEST(PointSurface, ClosesBetweenPointsAllAround) {
    const PointSurface surface = surface_through(ball_mesh({0, 0, 0}, cloud_radius, 5).points);
    EXPECT_TRUE(topology(surface.mesh).closed());
    EXPECT_EQ(patches(surface.mesh).count, 1);
    EXPECT_NEAR(signed_volume(surface.mesh), cloud_volume, 0.005 * cloud_volume);
    EXPECT_LT(surface.unevenness, 0.02);
}

TEST(PointSurface, FacesOneSideAndStaysOpenWherePointsAreMissing) {
    const TriangleMesh mesh = surface_through(sphere_points(6000, 0.4 * cloud_radius)).mesh;
    const MeshTopology state = topology(mesh);
    EXPECT_EQ(state.inconsistent_edges + state.crowded_edges, 0U);
    const double area = 2.0 * std::numbers::pi * cloud_radius * 1.4 * cloud_radius;
    EXPECT_NEAR(surface_area(mesh), area, 0.06 * area);  // less some pinholes, where stars disagree
    std::size_t outward = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto c = mesh.corners(t);
        outward += dot(area_vector(c), c[0]) > 0;
    }
    EXPECT_EQ(outward, mesh.triangles.size());
}

TEST(PointSurface, KnowsNoiseThatIsWiderThanThePointsAreApart) {
    EXPECT_LT(surface_through(sphere_points(6000)).unevenness, 0.05);
    EXPECT_GT(surface_through(sphere_points(6000, 1e9, 5.0)).unevenness, 0.25);
}

TEST(PointSurface, SameBitsOnEightThreads) {
    const std::vector<Vector3> points = sphere_points(4000, 0.0, 0.3);
    const auto [one, eight] = tests::on_one_and_eight_threads([&] { return surface_through(points).mesh.triangles; });
    EXPECT_EQ(one, eight);
}

TEST(PointSurface, FewPointsHaveNone) {
    EXPECT_TRUE(surface_through(sphere_points(20)).mesh.triangles.empty());
}

// Truth: the ball that the points were drawn from. A ball that rolls around them has -3 to +13 % here.
TEST(CloudSolid, IsAsLargeAsWhatThePointsWereDrawnFrom) {
    struct Case {
        int points;
        double noise, tolerance;
    };
    for (const Case& c :
         {Case{6000, 0.0, 0.005}, {2000, 0.0, 0.01}, {6000, 0.5, 0.005}, {20000, 1.0, 0.01}, {20000, 2.0, 0.02}}) {
        const Solid solid = solid_from_points(sphere_points(c.points, 1e9, c.noise), "cloud", coarse());
        EXPECT_NEAR(solid.volume, cloud_volume, c.tolerance * cloud_volume) << c.points << " points, noise " << c.noise;
        EXPECT_TRUE(topology(solid.mesh).closed());
        EXPECT_THAT(solid.notes, Contains(HasSubstr("joined to triangles")));
    }
}

TEST(CloudSolid, FlatCutsAreClosed) {
    for (const double noise : {0.0, 0.3}) {  // four fifths of the width are open
        const Solid solid = solid_from_points(sphere_points(8000, 0.6 * cloud_radius, noise), "cut", coarse());
        EXPECT_TRUE(topology(solid.mesh).closed());
        EXPECT_THAT(solid.notes, Contains(HasSubstr("Holes were closed")));
        // Between a flat lid and the ball.
        const double cap = std::numbers::pi * std::pow(0.4 * cloud_radius, 2) * (3.0 - 0.4) * cloud_radius / 3.0;
        EXPECT_GT(solid.volume, cloud_volume - cap);
        EXPECT_LT(solid.volume, 1.02 * cloud_volume);
    }
}

/// For classify: an opening is unknown, a pinhole between points is not.
TEST(CloudSolid, OnlyOpeningsAreUnknown) {
    const FileFolder folder;
    ImportOptions options;
    options.border = "hides";
    const auto unknown = [&](double below) {
        std::string text;
        for (const auto& p : sphere_points(3000, below)) {
            text += std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]) + "\n";
        }
        const RawShape<3> cloud = read_shape<3>(single_source(folder.write("cloud.xyz", text)), options);
        const DyadicGrid<3> grid(4);
        const ScalarField<3> chi = cloud.geometry->occlusion_mask(grid, {0.3 / cloud_radius, {0.5, 0.5, 0.5}});
        return std::any_of(chi.values.begin(), chi.values.end(), [](double x) { return x == 0.0; });
    };
    EXPECT_FALSE(unknown(1e9));
    EXPECT_TRUE(unknown(0.5 * cloud_radius));
}

TEST(CloudSolid, OneSideIsRefusedUnlessAskedFor) {
    const std::vector<Vector3> side = sphere_points(4000, -0.5 * cloud_radius);
    EXPECT_THAT(
        [&] {
            try {
                solid_from_points(side, "side", coarse());
            } catch (const ReadError& error) {
                return error.problem();
            }
            return std::string("accepted");
        }(),
        HasSubstr("one side only"));
    SolidifyOptions all = coarse();
    all.close_gaps = 1.0;
    EXPECT_GT(solid_from_points(side, "side", all).volume, 0.0);
}

TEST(CloudSolid, PointsThatFillAVolumeAreRolledAround) {
    std::vector<Vector3> points;
    for (const auto& p : sphere_points(12000)) {
        const double share = std::cbrt(static_cast<double>(points.size() + 1) / 12000.0);
        points.push_back(share * p);
    }
    const Solid solid = solid_from_points(points, "full", coarse());
    EXPECT_THAT(solid.notes, Contains(HasSubstr("what a ball of radius")));
    EXPECT_NEAR(solid.volume, cloud_volume, 0.2 * cloud_volume);  // it dips in between the outermost
}

}  // namespace
}  // namespace morphodesic::datasets

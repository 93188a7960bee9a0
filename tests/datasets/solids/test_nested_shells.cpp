#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "datasets/solidify.h"
#include "tests/datasets/solids/solid_files.h"

namespace morphodesic::datasets {
namespace {

using namespace tests;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

using std::numbers::pi;
constexpr double outer = 50.0, inner = 30.0;

double volume_of_ball(double radius) {
    return 4.0 / 3.0 * pi * std::pow(radius, 3);
}

/// Without the part above a height.
TriangleMesh cut(TriangleMesh mesh, double height) {
    std::erase_if(mesh.triangles, [&](const auto& t) { return mesh.points[t[0]][2] > height; });
    return mesh;
}

TriangleMesh without_last(TriangleMesh mesh, std::size_t triangles) {
    mesh.triangles.resize(mesh.triangles.size() - triangles);
    return mesh;
}

/// Every triangle on its own, a little apart from the others.
TriangleMesh torn(const TriangleMesh& mesh) {
    TriangleMesh soup;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto c = mesh.corners(t);
        const Vector3 centre = (1.0 / 3.0) * (c[0] + c[1] + c[2]);
        const int first = static_cast<int>(soup.points.size());
        for (const auto& p : c) soup.points.push_back(p + 1e-4 * (centre - p));
        soup.triangles.push_back({first, first + 1, first + 2});
    }
    return soup;
}

TEST(NestedShells, CavitiesStayWhicheverWallHasHoles) {
    const TriangleMesh shell = ball_mesh({}, outer, 4), wall = inside_out(ball_mesh({}, inner, 4));
    const double hollow = volume_of_ball(outer) - volume_of_ball(inner);
    const std::map<std::string, TriangleMesh> meshes{
        {"a triangle missing outside", joined(without_last(shell, 1), wall)},
        {"100 missing outside", joined(without_last(shell, 100), wall)},
        {"100 missing inside", joined(shell, without_last(wall, 100))},
        {"holes in both", joined(without_last(shell, 50), without_last(wall, 50))},
        {"a torn wall", joined(shell, torn(wall))},
    };
    for (const auto& [what, mesh] : meshes) {
        const Solid solid = solid_from_triangles(mesh, what, coarse());
        EXPECT_NEAR(solid.volume, hollow, 0.025 * hollow) << what;
        EXPECT_THAT(solid.notes, Contains(HasSubstr("hollow"))) << what;
        EXPECT_THAT(solid.notes, Not(Contains(HasSubstr("Turned")))) << what;
        const Solid turned = solid_from_triangles(inside_out(mesh), what, coarse());
        EXPECT_NEAR(turned.volume, hollow, 0.025 * hollow) << what << ", inside out";
    }
}

TEST(NestedShells, ABallInACavityStays) {
    const TriangleMesh hollow = joined(without_last(ball_mesh({}, outer, 4), 20), inside_out(ball_mesh({}, 40, 4)));
    const double volume = volume_of_ball(outer) - volume_of_ball(40) + volume_of_ball(20);
    for (const TriangleMesh& ball : {ball_mesh({}, 20, 4), without_last(ball_mesh({}, 20, 4), 30)}) {
        const Solid solid = solid_from_triangles(joined(hollow, ball), "nested", coarse());
        EXPECT_NEAR(solid.volume, volume, 0.03 * volume);
    }
}

TEST(NestedShells, OthersAreTurnedAsBefore) {
    const TriangleMesh shell = without_last(ball_mesh({}, outer, 4), 20), ball = ball_mesh({}, inner, 4);
    const double both = volume_of_ball(outer) + volume_of_ball(inner);
    // The same side shown by both: no cavity.
    EXPECT_NEAR(solid_from_triangles(joined(shell, ball), "same", coarse()).volume, volume_of_ball(outer), 0.02 * both);
    // Beside each other, one of them inside out.
    const TriangleMesh beside = inside_out(ball_mesh({100, 0, 0}, inner, 4));
    EXPECT_NEAR(solid_from_triangles(joined(shell, beside), "beside", coarse()).volume, both, 0.02 * both);
    // A hollow one of closed shells beside one that is inside out.
    const TriangleMesh hollow = joined(ball_mesh({}, outer, 4), inside_out(ball));
    const Solid solid = solid_from_triangles(joined(hollow, beside), "closed", coarse());
    EXPECT_NEAR(solid.volume, volume_of_ball(outer), 0.02 * both);
    EXPECT_THAT(solid.notes, Contains(HasSubstr("hollow")));
}

TEST(NestedShells, ApartAfterTurningIsNotCalledUnited) {
    const TriangleMesh ball = ball_mesh({}, outer, 4), beside = inside_out(ball_mesh({100, 0, 0}, inner, 4));
    const Solid solid = solid_from_triangles(joined(ball, beside), "two", coarse());
    const TriangleMesh upright = joined(ball, inside_out(beside));
    EXPECT_NEAR(solid.volume, signed_volume(upright), 1e-9 * solid.volume);
    EXPECT_EQ(solid.mesh.triangles.size(), upright.triangles.size());
    EXPECT_THAT(solid.notes, Contains(HasSubstr("inside out")));
    EXPECT_THAT(solid.notes, Not(Contains(HasSubstr("united"))));
}

TEST(NestedShells, FilledCavitiesAreSaid) {
    const TriangleMesh wall = cut(inside_out(ball_mesh({}, inner, 4)), 0.1 * inner);
    const Solid solid = solid_from_triangles(joined(ball_mesh({}, outer, 4), wall), "half", coarse());
    EXPECT_NEAR(solid.volume, volume_of_ball(outer), 0.02 * volume_of_ball(outer));
    EXPECT_THAT(solid.notes, Contains(HasSubstr("cavity was filled")));
}

}  // namespace
}  // namespace morphodesic::datasets

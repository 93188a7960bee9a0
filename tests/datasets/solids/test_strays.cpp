#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "datasets/solidify.h"
#include "datasets/strays.h"
#include "tests/datasets/solids/solid_files.h"

namespace morphodesic::datasets {
namespace {

using namespace tests;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

/// A triangle of a tenth of the radius.
TriangleMesh triangle_at(const Vector3& corner) {
    const double side = 0.1 * ball_radius;
    return {{corner, corner + Vector3{side, 0, 0}, corner + Vector3{0, side, 0}}, {{0, 1, 2}}};
}

TEST(Strays, TriangleFarFromAClosedSurfaceChangesNothing) {
    const TriangleMesh ball = ball_mesh(ball_middle, ball_radius, 4);
    const Solid alone = solid_from_triangles(ball, "ball");
    for (const double far : {3.0, 30.0, 300.0, 3e6}) {
        const Solid solid = solid_from_triangles(joined(ball, triangle_at({0.1, far, 0.2})), "ball and triangle");
        EXPECT_EQ(solid.volume, alone.volume) << far;
        EXPECT_EQ(solid.mesh.points, alone.mesh.points) << far;
        EXPECT_EQ(solid.mesh.triangles, alone.mesh.triangles) << far;
        EXPECT_THAT(solid.notes, ElementsAre("Left out 1 stray triangle far from the object (0.04 % of the area)."))
            << far;
    }
}

TEST(Strays, SeveralOnAllSidesOfAnOpenSurface) {
    TriangleMesh open = ball_mesh(ball_middle, ball_radius, 4);
    std::erase_if(open.triangles,
                  [&](const auto& t) { return open.points[t[0]][2] > ball_middle[2] + 0.95 * ball_radius; });
    const Solid alone = solid_from_triangles(open, "open");
    TriangleMesh scan = open;
    for (const double far : {-80.0, -20.0, 4.0, 60.0}) scan = joined(scan, triangle_at({far, 2.0 * far, -far}));
    const Solid solid = solid_from_triangles(scan, "open and triangles");
    EXPECT_EQ(solid.volume, alone.volume);
    EXPECT_THAT(solid.notes, Contains(HasSubstr("Left out 4 stray triangles")));
}

TEST(Strays, WhatMayBelongToTheObjectStays) {
    const auto left_out = [](TriangleMesh mesh) { return leave_out_strays(mesh, 0.002).count; };
    const TriangleMesh ball = ball_mesh(ball_middle, ball_radius, 4);
    EXPECT_EQ(left_out(ball), 0U);
    EXPECT_EQ(left_out(joined(ball, triangle_at({1.0, 0.5, 0.5}))), 0U);  // near
    // Closed: a part of 0.5 % of the volume, though of little area beside an object of many sheets.
    TriangleMesh sheets = ball;
    for (int i = 1; i < 8; ++i) sheets = joined(sheets, ball_mesh(ball_middle, ball_radius - 0.001 * i, 4));
    EXPECT_EQ(left_out(joined(sheets, ball_mesh({5, 5, 5}, 0.13 * ball_radius, 2))), 128U);  // a speck
    EXPECT_EQ(left_out(joined(ball, ball_mesh({5, 5, 5}, 0.17 * ball_radius, 2))), 0U);
    // Every triangle on its own, far from most others but not from all.
    TriangleMesh soup;
    for (int i = 0; i < 400; ++i) soup = joined(soup, triangle_at({0.1 * i, 0.0, 0.01 * (i % 7)}));
    EXPECT_EQ(left_out(soup), 0U);
    // A large sheet is no mistake.
    TriangleMesh sheet = triangle_at({9, 9, 9});
    sheet.points[1] = {15, 9, 9};
    EXPECT_EQ(left_out(joined(ball, sheet)), 0U);
}

TEST(Strays, FarSpeckDoesNotMakeTheGridCoarse) {
    TriangleMesh open = ball_mesh(ball_middle, ball_radius, 4);
    std::erase_if(open.triangles,
                  [&](const auto& t) { return open.points[t[0]][2] > ball_middle[2] + 0.95 * ball_radius; });
    const Solid alone = solid_from_triangles(open, "open");
    const Solid solid = solid_from_triangles(joined(open, ball_mesh({50, 0, 0}, 0.01, 2)), "open and speck");
    EXPECT_EQ(solid.volume, alone.volume);
    EXPECT_THAT(solid.notes, Contains(HasSubstr("Left out 128 stray triangles")));
}

/// Points of a sphere, evenly spread.
std::vector<Vector3> sphere_points() {
    return ball_mesh(ball_middle, ball_radius, 4).points;
}

TEST(Strays, PointsFarFromACloudChangeNothing) {
    const std::vector<Vector3> points = sphere_points();
    SolidifyOptions coarse;
    coarse.cells = 32;
    const Solid alone = solid_from_points(points, "cloud", coarse);
    for (const double far : {10.0, 1e9}) {
        std::vector<Vector3> scan = points;
        scan.push_back({0.4, -far, 0.5});
        scan.insert(scan.begin(), {{far, far, -far}, {far + 0.001, far, -far}, {far, 0.5, 0.5}});
        const Solid solid = solid_from_points(scan, "cloud and strays", coarse);
        EXPECT_EQ(solid.volume, alone.volume) << far;
        EXPECT_THAT(solid.notes, Contains("Left out 4 stray points far from the object (0.39 % of the points)."));
    }
}

TEST(Strays, PointsThatHangTogetherWithTheCloudStay) {
    std::vector<Vector3> points = sphere_points();
    EXPECT_EQ(leave_out_strays(points).count, 0U);
    const std::size_t all = points.size() + 10;
    for (int i = 0; i < 10; ++i) points.push_back({0.5 + ball_radius + 0.06 * i, 0.5, 0.5});  // a wire
    EXPECT_EQ(leave_out_strays(points).count, 0U);
    EXPECT_EQ(points.size(), all);
    std::vector<Vector3> two = sphere_points();  // 2 % of the points are no mistake
    for (int i = 0; i < 22; ++i) two.push_back({5.0 + 0.01 * i, 5.0, 5.0});
    EXPECT_EQ(leave_out_strays(two).count, 0U);
}

}  // namespace
}  // namespace morphodesic::datasets

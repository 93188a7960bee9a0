#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/solidify.h"
#include "datasets/touching_parts.h"
#include "tests/datasets/solids/solid_files.h"

namespace morphodesic::datasets {
namespace {

using namespace tests;
using testing::Contains;
using testing::Not;

constexpr char joined_note[] = "Touching parts were joined.";

/// How far the middle of the face between two cubes of side 20 is from the surface of both.
double depth_of_middle(const Solid& solid) {
    return TriangleTree(solid.mesh).nearest({20, 10, 10}, 100).distance;
}

TEST(TouchingParts, NoWallIsLeftBetweenThem) {
    const TriangleMesh left = box_mesh({0, 0, 0}, {20, 20, 20});
    const std::map<std::string, TriangleMesh> right{
        {"other triangles", divided_box_mesh({20, 0, 0}, {40, 20, 20}, 3)},
        {"slit of less than a hundredth of a cell", box_mesh({20.001, 0, 0}, {40.001, 20, 20})},
        {"a part of the face", box_mesh({20, 4, 4}, {40, 16, 16})},
        {"one across the edges of the face", box_mesh({20, -7, -7}, {40, 13, 13})},
    };
    for (const auto& [what, mesh] : right) {
        TriangleMesh both = joined(left, mesh);
        const Solid solid = solid_from_triangles(both, what);
        EXPECT_THAT(solid.notes, Contains(joined_note)) << what;
        EXPECT_GT(depth_of_middle(solid), 2.9) << what;
        clean(both);
        EXPECT_NEAR(solid.volume, signed_volume(both), 0.003 * signed_volume(both)) << what;
        EXPECT_EQ(patches(solid.mesh).count, 1) << what;
        EXPECT_NEAR(solid_from_triangles(inside_out(both), what).volume, solid.volume, 1e-4 * solid.volume) << what;
    }
}

TEST(TouchingParts, SlitOnNodesOfTheGrid) {
    // 144 cells of 1/4 over 36: nodes lie at multiples of it, so in the slit too.
    const TriangleMesh both =
        joined(box_mesh({0, 0, 0}, {17.9995, 12, 12}), divided_box_mesh({18.0005, 0, 0}, {36, 12, 12}, 3));
    const Solid solid = solid_from_triangles(both, "slit");
    EXPECT_THAT(solid.notes, Contains(joined_note));
    EXPECT_GT(TriangleTree(solid.mesh).nearest({18, 6, 6}, 100).distance, 5.9);
    EXPECT_EQ(patches(solid.mesh).count, 1);
}

TEST(TouchingParts, OthersStayAsTheyAre) {
    const auto stay = [](const TriangleMesh& mesh, const char* what) {
        const Solid solid = solid_from_triangles(mesh, what);
        EXPECT_EQ(solid.mesh.triangles.size(), mesh.triangles.size()) << what;
        EXPECT_THAT(solid.notes, Not(Contains(joined_note))) << what;
    };
    const TriangleMesh cube = box_mesh({0, 0, 0}, {20, 20, 20});
    stay(joined(cube, box_mesh({20.1, 0, 0}, {40, 20, 20})), "a third of a cell apart");
    stay(joined(cube, box_mesh({20, 20, 0}, {40, 40, 20})), "at an edge");
    stay(joined(cube, box_mesh({20, 20, 20}, {40, 40, 40})), "at a corner");
    stay(joined(ball_mesh({0, 0, 0}, 10, 5), ball_mesh({20, 0, 0}, 10, 5)), "balls");
    const TriangleMesh hollow = inside_out(box_mesh({5, 5, 5}, {15, 15, 15}));
    stay(joined(cube, hollow), "a cavity");
    stay(joined(box_mesh({0, 0, 0}, {20, 20, 0.03}), divided_box_mesh({0, 0, 0.03}, {20, 20, 0.06}, 1)), "thin sheets");
}

}  // namespace
}  // namespace morphodesic::datasets

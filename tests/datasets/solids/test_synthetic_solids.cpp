#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "datasets/import.h"
#include "datasets/solid_reader.h"
#include "datasets/solidify.h"
#include "datasets/synthetic_solids.h"
#include "datasets/voxelize.h"
#include "tests/datasets/solids/solid_files.h"

namespace morphodesic::datasets {
namespace {

using namespace tests;

TEST(SyntheticSolids, FeetAreClosedDistinctAndRepeatable) {
    const auto first = feet({}), second = feet({});
    ASSERT_EQ(first.size(), 8U);
    std::set<std::string> labels;
    for (std::size_t i = 0; i < first.size(); ++i) {
        EXPECT_EQ(first[i].mesh.points, second[i].mesh.points);
        EXPECT_TRUE(topology(first[i].mesh).closed());
        EXPECT_EQ(patches(first[i].mesh).count, 1);
        EXPECT_GT(signed_volume(first[i].mesh), 4e5);
        labels.insert(first[i].label);
    }
    EXPECT_EQ(first.back().label, "outlier");
    EXPECT_GE(labels.size(), 3U);
    FeetOptions equal;
    equal.equal_volume = true;
    equal.seed = 2;
    const auto even = feet(equal);
    EXPECT_NE(even[0].mesh.points, first[0].mesh.points);
    for (const auto& foot : even) {
        EXPECT_NEAR(signed_volume(foot.mesh), signed_volume(even[0].mesh), 1e-6 * signed_volume(even[0].mesh));
    }
}

TEST(SyntheticSolids, QuadrupedsStandOnFourLegs) {
    CollectionOptions options;
    options.count = 4;
    for (const auto& animal : quadrupeds(options)) {
        EXPECT_TRUE(topology(animal.mesh).closed());
        EXPECT_EQ(patches(animal.mesh).count, 1) << animal.name;
        const Box3 box = bounding_box(animal.mesh.points);
        // Four separate paws in a slice a little above the ground.
        const double height = box.low[2] + 0.12 * box.side()[2];
        TriangleMesh low;
        low.points = animal.mesh.points;
        for (const auto& t : animal.mesh.triangles) {
            if (animal.mesh.points[t[0]][2] < height && animal.mesh.points[t[1]][2] < height &&
                animal.mesh.points[t[2]][2] < height) {
                low.triangles.push_back(t);
            }
        }
        EXPECT_EQ(patches(low).count, 4) << animal.name;
    }
}

TEST(SyntheticSolids, CollectionIsWrittenAndRead) {
    const FileFolder folder;
    FeetOptions options;
    options.count = 3;
    write_collection(folder.path() / "feet", feet(options));
    const ScanResult scan = scan_folder(folder.path() / "feet");
    ASSERT_EQ(scan.sources.size(), 3U);
    EXPECT_EQ(scan.sources[2].label, "outlier");
    EXPECT_EQ(scan.sources[0].dimension, 3);
    EXPECT_TRUE(read_shape<3>(scan.sources[0]).notes.empty());
}

/// A bad scan of a foot stays close to its clean twin: volume of the symmetric difference over the volume.
TEST(SyntheticSolids, DamagedFootIsCloseToItsTwin) {
    FeetOptions one;
    one.count = 1;
    const TriangleMesh clean_mesh = feet(one)[0].mesh;
    TriangleMesh bad = damaged(clean_mesh, {});
    const double missing = 1.0 - surface_area(bad) / surface_area(damaged(clean_mesh, {.holes = 0.0}));
    EXPECT_NEAR(missing, 0.05, 0.02);
    EXPECT_LT(bad.points.size(), 0.6 * static_cast<double>(clean_mesh.points.size()));
    const Solid twin = solid_from_triangles(clean_mesh, "clean");
    const Solid solid = solid_from_triangles(bad, "damaged");
    const DyadicGrid<3> grid(6);
    const auto placed = [&](TriangleMesh mesh) {
        for (auto& p : mesh.points) p = Vector3{0.5, 0.5, 0.5} + (0.36 / 160.0) * (p - twin.centroid);
        return signed_distance(mesh, grid);
    };
    const LevelSet<3> a = placed(twin.mesh), b = placed(solid.mesh);
    int both = 0, either = 0;
    for (std::size_t i = 0; i < a.values.size(); ++i) {
        both += a.values[i] > 0 && b.values[i] > 0;
        either += a.values[i] > 0 || b.values[i] > 0;
    }
    EXPECT_LT(static_cast<double>(either - both) / either, 0.08);
    EXPECT_GT(both, 1000);
}

}  // namespace
}  // namespace morphodesic::datasets

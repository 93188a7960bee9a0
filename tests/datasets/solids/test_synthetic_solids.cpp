#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>

#include "datasets/import.h"
#include "datasets/mesh_smoothing.h"
#include "datasets/solid_reader.h"
#include "datasets/solidify.h"
#include "datasets/synthetic_solids.h"
#include "geodesic/discrete_geodesic.h"
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

TEST(SyntheticSolids, DamageIsAsAsked) {
    FeetOptions one;
    one.count = 1;
    const TriangleMesh clean_mesh = feet(one)[0].mesh;
    const DamageOptions all;
    const TriangleMesh bad = damaged(clean_mesh, all), same = damaged(clean_mesh, all);
    EXPECT_EQ(bad.points, same.points);
    EXPECT_EQ(bad.triangles, same.triangles);
    const TriangleMesh whole = damaged(clean_mesh, {.holes = 0.0});
    EXPECT_NEAR(1.0 - surface_area(bad) / surface_area(whole), all.holes, 0.01);
    const TriangleMesh dense = damaged(clean_mesh, {.holes = 0.0, .noise = 0.0, .turned = 0.0, .kept = 1.0});
    EXPECT_NEAR(signed_volume(dense), signed_volume(clean_mesh), 1e-9 * signed_volume(clean_mesh));
    EXPECT_LT(whole.points.size(), 0.52 * static_cast<double>(dense.points.size()));
    EXPECT_GT(topology(whole).inconsistent_edges, 100U);
    TriangleMesh noisy = damaged(clean_mesh, {.holes = 0.0, .turned = 0.0, .kept = 1.0});
    EXPECT_NEAR(roughness(noisy), all.noise * bounding_box(clean_mesh.points).diagonal(), 0.2);
    EXPECT_LT(roughness(clean_mesh), 0.0003 * bounding_box(clean_mesh.points).diagonal());
}

/// Noise, holes, turned patches and decimation together move a foot by little of what lies between two feet of the
/// collection; half the noise is noise as well.
TEST(SyntheticSolids, BadScanStaysNearItsTwin) {
    FeetOptions options;
    options.count = 3;
    const auto clean_feet = feet(options);
    std::vector<RawShape<3>> raw;
    const auto add = [&](TriangleMesh mesh) {
        Solid solid = solid_from_triangles(std::move(mesh), "foot");
        RawShape<3> shape;
        shape.centroid = solid.centroid;
        shape.volume = solid.volume;
        shape.notes = solid.notes;
        for (const auto& p : solid.mesh.points) {
            shape.extent_radius = std::max(shape.extent_radius, norm(p - solid.centroid));
        }
        shape.geometry = std::make_shared<SolidGeometry>(std::move(solid.mesh));
        raw.push_back(std::move(shape));
    };
    std::vector<double> radii;
    for (const auto& foot : clean_feet) {
        add(foot.mesh);
        EXPECT_THAT(raw.back().notes, testing::IsEmpty());
        radii.push_back(raw.back().extent_radius);
    }
    const std::array<double, 2> noise{0.005, 0.0025};
    for (int i = 0; i < 2; ++i) {
        add(damaged(clean_feet[i].mesh, {.noise = noise[i], .seed = options.seed + i}));
        EXPECT_THAT(raw.back().notes, testing::Contains(testing::HasSubstr("was smoothed")));
    }
    NormalizeOptions placed;
    placed.level = 5;
    placed.scale = common_scale(radii);
    std::vector<LevelSet<3>> shapes;
    for (const auto& shape : raw) shapes.push_back(normalize(shape, placed).level_set);
    GeodesicOptions solver;
    solver.level = 5;
    solver.time_steps = 2;
    solver.tolerance = 1e-2;
    solver.starts = 1;
    const auto distance = [&](int a, int b) {
        return compute_discrete_geodesic<3>(shapes[a], shapes[b], solver).path_length;
    };
    std::vector<double> between;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < i; ++j) between.push_back(distance(i, j));
    }
    std::sort(between.begin(), between.end());
    const double median = between[1];
    for (int i = 0; i < 2; ++i) {
        EXPECT_LT(distance(i, 3 + i), 0.05 * median) << i;
        EXPECT_NEAR(raw[3 + i].volume, raw[i].volume, 0.004 * raw[i].volume);
    }
}

}  // namespace
}  // namespace morphodesic::datasets

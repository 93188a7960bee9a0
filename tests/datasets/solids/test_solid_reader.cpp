#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>

#include "datasets/import.h"
#include "datasets/interruption.h"
#include "datasets/random_source.h"
#include "datasets/solid_reader.h"
#include "datasets/triangle_tree.h"
#include "tests/datasets/solids/solid_files.h"

namespace morphodesic::datasets {
namespace {

using namespace tests;
using testing::Contains;
using testing::HasSubstr;

ShapeSource source_of(const std::filesystem::path& file) {
    return single_source(file);
}

TEST(SolidReader, BallFileBecomesItsDistance) {
    const FileFolder folder;
    const auto source = source_of(folder.write("ball.ply", ply_file(ball_mesh({0.5, 0.5, 0.5}, 0.2, 6), "ascii")));
    NormalizeOptions none;
    none.mode = "none";  // the file is made in the coordinates of the cube
    none.level = 5;
    const Shape<3> shape = import_shape<3>(source, {}, none);
    EXPECT_EQ(shape.scale, 1.0);
    EXPECT_NEAR(shape.volume, 4.0 / 3.0 * 3.14159265 * 0.008, 2e-5);
    const auto& grid = shape.level_set.grid;
    for (std::size_t i = 0; i < grid.node_count(); ++i) {
        const double exact = 0.2 - norm(grid.position(grid.node(i)) - Vector3{0.5, 0.5, 0.5});
        EXPECT_NEAR(shape.level_set.values[i], exact, (std::abs(exact) < 4.0 * grid.spacing() ? 0.005 : 0.2) / 32);
    }
}

/// Most nodes are told apart by distances to samples: that must give what exact ones give.
TEST(SolidReader, MasksAreThoseOfExactDistances) {
    TriangleMesh egg = ball_mesh({}, 1.0, 4), seen, invented;
    for (Vector3& p : egg.points) p = {p[0], 0.6 * p[1], 0.8 * p[2]};
    std::vector<std::size_t> numbers;
    for (std::size_t t = 0; t < egg.triangles.size(); ++t) {
        const auto c = egg.corners(t);
        if ((1.0 / 3.0 * (c[0] + c[1] + c[2]))[0] > 0.3) numbers.push_back(t);
    }
    const SolidGeometry geometry(egg, numbers);
    const DyadicGrid<3> grid(5);
    for (const double scale : {0.4, 0.1, 0.03}) {
        const Placement<3> placement{scale, {0.5001, 0.4997, 0.5003}};
        seen.points = invented.points = egg.points;
        for (auto* mesh : {&seen, &invented}) {
            mesh->triangles.clear();
            for (Vector3& p : mesh->points) p = placement(p);
        }
        for (std::size_t t = 0; t < egg.triangles.size(); ++t) {
            const bool is_new = std::binary_search(numbers.begin(), numbers.end(), t);
            (is_new ? invented : seen).triangles.push_back(egg.triangles[t]);
        }
        const TriangleTree to_seen(seen), to_new(invented);
        const ScalarField<3> chi = geometry.occlusion_mask(grid, placement);
        const LevelSet<3> u = geometry.signed_distance(grid, placement);
        const double h = grid.spacing();
        std::size_t between = 0;
        for (std::size_t i = 0; i < chi.values.size(); ++i) {
            const Point<3> x = grid.position(grid.node(i));
            const double seen_at = to_seen.nearest(x, 9).distance, new_at = to_new.nearest(x, 9).distance;
            const double exact = u.values[i] > h ? 1.0 : std::clamp((new_at - seen_at) / h - 0.5, 0.0, 1.0);
            if (std::min(seen_at, new_at) < 7.5 * h) {
                EXPECT_EQ(chi.values[i], exact) << scale;
            } else {
                EXPECT_NEAR(chi.values[i], exact, 0.15) << scale;
            }
            between += chi.values[i] > 0.0 && chi.values[i] < 1.0 ? 1 : 0;
        }
        EXPECT_GT(between, 100U);
    }
}

TEST(SolidReader, WithoutNormalisationSizesAreThoseOfTheFile) {
    const FileFolder folder;
    NormalizeOptions none;
    none.mode = "none";
    none.level = 5;
    double volume = 0.0;
    for (const Vector3& centre : {Vector3{0, 0, 0}, Vector3{0.5, 0.5, 0.5}, Vector3{300, -200, 100}}) {
        const auto file = source_of(folder.write("ball.obj", obj_text(ball_mesh(centre, 0.2, 5))));
        const Shape<3> shape = import_shape<3>(file, {}, none);
        EXPECT_EQ(shape.scale, 1.0);
        EXPECT_NEAR(shape.volume, volume > 0.0 ? volume : shape.volume, 1e-6 * shape.volume);
        volume = shape.volume;
        EXPECT_NEAR(shape.level_set.values[shape.level_set.grid.index({16, 16, 16})], 0.2, 0.01);
    }
    const auto large = source_of(folder.write("large.obj", obj_text(ball_mesh({}, 0.51, 3))));
    try {
        import_shape<3>(large, {}, none);
        FAIL() << "accepted";
    } catch (const ReadError& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("does not fit"));
        EXPECT_THAT(error.what(), testing::HasSubstr("--normalize common"));
    }
}

TEST(SolidReader, ReadingIsGivenUpOnRequest) {
    static std::atomic<long> left{0};
    const FileFolder folder;
    TriangleMesh open = ball_mesh({}, 1.0, 4);
    const std::string closed_file = obj_text(open);
    open.triangles.resize(open.triangles.size() - 20);
    const std::vector<ShapeSource> files{source_of(folder.write("closed.obj", closed_file)),
                                         source_of(folder.write("open.ply", ply_file(open, "ascii"))),
                                         source_of(folder.write("cloud.ply", ply_file({open.points, {}}, "ascii")))};
    const auto is_given_up = [](const ShapeSource& file) {
        try {
            import_shape<3>(file, {}, NormalizeOptions{});
            return false;
        } catch (const Interrupted&) {
            return true;
        }
    };
    set_interruption([] { return --left < 0; });
    for (const ShapeSource& file : files) {
        left = 1L << 40;
        ASSERT_FALSE(is_given_up(file));
        const long asked = (1L << 40) - left;
        EXPECT_GT(asked, 100) << file.name;  // all along the way
        for (const long after : {0L, asked / 8, asked / 2}) {
            left = after;
            EXPECT_TRUE(is_given_up(file)) << file.name << " after " << after << " of " << asked;
        }
    }
    set_interruption(nullptr);
    EXPECT_FALSE(is_given_up(files[1]));
}

TEST(SolidReader, UnitsAndPlaceDoNotMatterWhenEachIsScaled) {
    const FileFolder folder;
    const TriangleMesh box = box_mesh({0.0, 0.0, 0.0}, {0.2, 0.1, 0.05});
    TriangleMesh in_millimetres = box;
    for (auto& p : in_millimetres.points) p = Vector3{5000, -300, 80} + 1000.0 * p;
    NormalizeOptions each;
    each.mode = "each";
    each.level = 4;
    const Shape<3> a = import_shape<3>(source_of(folder.write("m.obj", obj_text(box))), {}, each);
    const Shape<3> b = import_shape<3>(source_of(folder.write("mm.obj", obj_text(in_millimetres))), {}, each);
    EXPECT_NEAR(a.scale / b.scale, 1000.0, 1e-2);
    for (std::size_t i = 0; i < a.level_set.values.size(); ++i) {
        EXPECT_NEAR(a.level_set.values[i], b.level_set.values[i], 1e-5);
    }
}

TEST(SolidReader, PatternsOfMirrorThatFitNothingAreSaid) {
    const std::vector<ShapeSource> solids{{"f/left.ply", "left.ply", "", 3, {}},
                                          {"f/b/right.ply", "b/right.ply", "", 3, {}}},
        images{{"f/left.png", "left.png", "", 2, {}}};
    EXPECT_EQ(mirror_remark("", solids), "");
    EXPECT_EQ(mirror_remark("right.ply, l*", solids), "");
    EXPECT_EQ(mirror_remark("b/*", solids), "");
    EXPECT_EQ(mirror_remark("nosuch, left*, none", solids),
              "--mirror has no effect for nosuch, none: no solid has such a name.");
    EXPECT_EQ(mirror_remark("left*", images),
              "--mirror has no effect for left*: it mirrors solids, and these are images.");
}

TEST(SolidReader, MirrorTakesNamesAndPatterns) {
    const FileFolder folder;
    // A corner piece: no rotation turns it into its mirror image.
    const TriangleMesh chiral =
        joined(joined(box_mesh({0, 0, 0}, {0.6, 0.2, 0.2}), box_mesh({0, 0.1, 0}, {0.2, 0.5, 0.2})),
               box_mesh({0.05, 0.05, 0.1}, {0.15, 0.15, 0.4}));
    const auto source = source_of(folder.write("left-foot.off", off_text(chiral)));
    NormalizeOptions placed;
    placed.level = 5;
    const Shape<3> plain = import_shape<3>(source, {}, placed);
    for (const char* list : {"left-foot.off", "other.ply, left-*", "*"}) {
        ImportOptions options;
        options.mirror = list;
        const Shape<3> mirrored = import_shape<3>(source, options, placed);
        EXPECT_NE(mirrored.digest, plain.digest);
        EXPECT_THAT(mirrored.notes, Contains(HasSubstr("Mirrored")));
        for (int k = 0; k <= 32; k += 4) {
            for (int j = 0; j <= 32; j += 4) {
                for (int i = 0; i <= 32; ++i) {
                    EXPECT_NEAR(mirrored.level_set.values[mirrored.level_set.grid.index({i, j, k})],
                                plain.level_set.values[plain.level_set.grid.index({32 - i, j, k})], 0.2 / 32);
                }
            }
        }
    }
    ImportOptions others;
    others.mirror = "right-*,foot";
    EXPECT_EQ(import_shape<3>(source, others, placed).digest, plain.digest);
}

TEST(SolidReader, NoiseIsSmoothedUnlessItIsToBeKept) {
    const FileFolder folder;
    TriangleMesh ball = ball_mesh({0.5, 0.5, 0.5}, 0.3, 4);
    RandomSource random(1);
    for (auto& p : ball.points) {
        for (double& x : p) x += random.uniform(-0.005, 0.005);
    }
    const auto source = source_of(folder.write("ball.ply", ply_file(ball, "ascii")));
    ImportOptions options;
    EXPECT_THAT(read_shape<3>(source, options).notes, Contains(HasSubstr("was smoothed")));
    options.noise = "keep";
    EXPECT_THAT(read_shape<3>(source, options).notes, testing::Not(Contains(HasSubstr("was smoothed"))));
    options.noise = "some";
    EXPECT_THROW(read_shape<3>(source, options), std::invalid_argument);
}

TEST(SolidReader, SameFileSameBits) {
    const FileFolder folder;
    TriangleMesh open = ball_mesh({3.0, 1.0, 2.0}, 0.7, 3);
    open.triangles.erase(open.triangles.begin(), open.triangles.begin() + 9);
    const auto source = source_of(folder.write("open.stl", binary_stl(open)));
    NormalizeOptions placed;
    placed.level = 4;
    EXPECT_EQ(import_shape<3>(source, {}, placed).digest, import_shape<3>(source, {}, placed).digest);
}

}  // namespace
}  // namespace morphodesic::datasets

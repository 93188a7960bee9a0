#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "datasets/drawing.h"
#include "datasets/outline_geometry.h"
#include "datasets/read_error.h"
#include "tests/datasets/test_pictures.h"
#include "tests/support/temporary_folder.h"

namespace morphodesic::datasets {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

RawShape<2> raw_disk(double x, double y, double radius) {
    return raw_shape_of({}, Outline{{disk_polygon({x, y}, radius, 512)}});
}
RawShape<2> raw_bar(double length, double width) {
    return raw_shape_of({}, Outline{{capsule_polygon({0, 0}, {length, 0}, width / 2)}});
}

TEST(Normalize, CommonScaleFitsTheLargestAndKeepsRatios) {
    const RawShape<2> small = raw_disk(100, 7, 10), large = raw_disk(-3, 50, 25);
    const double radii[] = {small.extent_radius, large.extent_radius};
    NormalizeOptions options;
    options.scale = common_scale(radii);
    options.level = 7;
    const Shape<2> a = normalize(small, options), b = normalize(large, options);
    EXPECT_NEAR(b.volume / a.volume, 6.25, 1e-9);
    const auto middle = b.level_set.grid.index({64, 64});
    EXPECT_NEAR(b.level_set.values[middle], largest_extent_radius, 1e-4);
    EXPECT_NEAR(a.level_set.values[middle], largest_extent_radius * 0.4, 1e-4);
    EXPECT_THROW(common_scale({}), std::invalid_argument);
}

TEST(Normalize, EachGivesOneAreaUnlessThatDoesNotFit) {
    const Shape<2> disk = normalize(raw_disk(5, 5, 3), {"each", 0.0, 6});
    EXPECT_NEAR(disk.volume, unit_volume<2>, 1e-9);
    EXPECT_THAT(disk.notes, IsEmpty());
    const Shape<2> bar = normalize(raw_bar(100, 4), {"each", 0.0, 6});
    EXPECT_LT(bar.volume, unit_volume<2>);
    EXPECT_NEAR(bar.scale * 52.0, largest_extent_radius, 1e-3);
    // (400 + 4 pi) (0.36 / 52)^2 = 0.0198 of 0.1
    EXPECT_THAT(bar.notes, Contains("Too long to have the area of the others in the cube: scaled to 19.8 % of it."));
    std::vector<std::string> notes;
    static_cast<void>(placement_of(raw_bar(100, 0.004), {"each", 0.0, 6}, &notes));  // 0.4 (0.36 / 50)^2 of 0.1
    EXPECT_THAT(notes, Contains(HasSubstr("scaled to 0.021 % of it.")));
}

TEST(Normalize, NoneMapsTheFrameToTheCube) {
    RawShape<2> raw = raw_disk(10, 30, 5);
    raw.frame_low = {0, 0};
    raw.frame_high = {80, 40};  // letterboxed: 20 rows above and below
    const Shape<2> shape = normalize(raw, {"none", 0.0, 6});
    EXPECT_NEAR(shape.level_set.values[shape.level_set.grid.index({8, 40})], 5.0 / 80, 1e-4);
    EXPECT_DOUBLE_EQ(shape.scale, 1.0 / 80);
}

TEST(Normalize, AShapeTooLargeForTheScaleIsShrunkAndThatIsSaid) {
    NormalizeOptions options;
    options.scale = 0.02;
    const Shape<2> shape = normalize(raw_disk(0, 0, 40), options);
    EXPECT_NEAR(shape.scale * 40, largest_extent_radius, 1e-6);
    EXPECT_THAT(shape.notes, Contains(HasSubstr("Too large")));
}

TEST(Normalize, AShapeTooThinForTheGridIsNoted) {
    NormalizeOptions options;
    EXPECT_THAT(normalize(raw_bar(30, 1), options).notes,
                Contains(testing::AllOf(HasSubstr("Thinner than two cells"), HasSubstr("--normalize each"))));
    options.mode = "each";  // who did that already is not told to do it
    EXPECT_THAT(
        normalize(raw_bar(30, 1), options).notes,
        Contains(testing::AllOf(HasSubstr("Thinner than two cells"), testing::Not(HasSubstr("--normalize each")))));
    options.mode = "common";
    options.level = 8;
    EXPECT_THAT(normalize(raw_bar(30, 1), options).notes, IsEmpty());
}

TEST(Normalize, WhatTheGridOfTheSolverMakesOfThePartsIsNoted) {
    NormalizeOptions options;
    options.level = 7;
    Loop hole = disk_polygon({0, 0}, 18.5, 256);
    std::reverse(hole.begin(), hole.end());
    const RawShape<2> ring = raw_shape_of({}, Outline{{disk_polygon({0, 0}, 20, 256), hole}});
    EXPECT_THAT(normalize(ring, options).notes, IsEmpty());
    options.solved_level = 5;  // where the ring is thinner than a cell
    EXPECT_THAT(normalize(ring, options).notes,
                Contains(testing::MatchesRegex("On the grid of level 5 it has [0-9]+ parts and 0 holes instead of 1 "
                                               "part and 1 hole, as .*: use a finer --level.*")));
    // The gap between two disks is a quarter of a cell wide and lies between the nodes.
    const RawShape<2> pair =
        raw_shape_of({}, Outline{{disk_polygon({-10.2, 0}, 10, 128), disk_polygon({7.2, 0}, 7, 128)}});
    EXPECT_THAT(normalize(pair, options).notes,
                Contains(HasSubstr("1 part and 0 holes instead of 2 parts and 0 holes")));
    options.solved_level = 9;  // no finer than what is kept
    EXPECT_THAT(normalize(pair, options).notes, IsEmpty());
    options.solved_level = -1;
    EXPECT_THROW(normalize(pair, options), std::invalid_argument);
}

TEST(Normalize, AShapeThatFallsThroughTheGridIsRefused) {
    NormalizeOptions options;
    options.scale = 0.001;
    options.level = 3;
    RawShape<2> raw = raw_shape_of({}, Outline{{disk_polygon({0, 0}, 5, 64), disk_polygon({50, 0}, 5, 64)}});
    EXPECT_THROW(normalize(raw, options), ReadError);  // two dots on both sides of the node in the middle
    options.level = 0;
    EXPECT_THROW(normalize(raw, options), std::invalid_argument);
    // A node lies in the middle of this one, but no cell.
    options.level = 6;
    options.scale = 0.5 / 64 / 5;  // its radius is half a cell
    const RawShape<2> dot = raw_disk(0, 0, 5);
    try {
        (void)normalize(dot, options);
        FAIL() << "the grid does not hold it";
    } catch (const ReadError& error) {
        EXPECT_THAT(error.what(), HasSubstr("the whole shape is smaller than a cell of the grid"));
    }
    options.scale *= 1.2;
    EXPECT_THAT(normalize(dot, options).notes, Contains(HasSubstr("Thinner than two cells")));
}

TEST(Normalize, DigestTellsContentNotNames) {
    const tests::TemporaryFolder folder;
    const cv::Mat disk = tests::toned(tests::disk_picture(64, 30, 30, 20), 255, 0);
    const cv::Mat other = tests::toned(tests::disk_picture(64, 30, 30, 20.2), 255, 0);
    const auto digest = [](const std::filesystem::path& file, int level = 6) {
        NormalizeOptions options;
        options.level = level;
        return normalize(tests::read(file), options).digest;
    };
    const std::string a = digest(tests::save(folder / "a.png", disk));
    EXPECT_EQ(a.size(), 32U);
    EXPECT_EQ(digest(tests::save(folder / "b/other name.bmp", disk)), a);
    EXPECT_EQ(digest(tests::save(folder / "inverted.png", 255 - disk)), a);
    EXPECT_NE(digest(tests::save(folder / "c.png", other)), digest(folder / "a.png"));
    EXPECT_NE(digest(folder / "a.png", 5), a);
    EXPECT_EQ(file_digest(folder / "a.png"), file_digest(tests::save(folder / "copy.png", disk)));
    EXPECT_NE(file_digest(folder / "a.png"), file_digest(folder / "b/other name.bmp"));
    EXPECT_THROW(file_digest(folder / "gone"), ReadError);
}

TEST(Normalize, DigestIgnoresWhatAFloatCannotTell) {
    LevelSet<2> u(DyadicGrid<2>(3), 0.25), v = u, w = u;
    v.values[5] += 1e-12;
    w.values[5] += 1e-6;
    EXPECT_EQ(content_digest(u), content_digest(v));
    EXPECT_NE(content_digest(u), content_digest(w));
    u.values[7] = 0.0, v = u, v.values[7] = -0.0;
    EXPECT_EQ(content_digest(u), content_digest(v));
    EXPECT_NE(content_digest(u), content_digest(u, ScalarField<2>(u.grid, 1.0)));
}

}  // namespace
}  // namespace morphodesic::datasets

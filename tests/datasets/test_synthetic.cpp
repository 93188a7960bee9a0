#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "datasets/csv_rows.h"
#include "datasets/import.h"
#include "datasets/outline_geometry.h"
#include "datasets/synthetic.h"
#include "tests/support/temporary_folder.h"

namespace morphodesic::datasets {
namespace {

using std::numbers::pi;

TEST(Synthetic, CollectionsImportWithTheirLabelsAndAreas) {
    const tests::TemporaryFolder folder;
    CollectionOptions options;
    options.count = 7;
    const std::vector<Drawing> drawings = disks(options);
    write_collection(folder.path(), drawings, 128);
    const ScanResult scan = scan_folder(folder.path());
    ASSERT_EQ(scan.sources.size(), 7U);
    for (std::size_t i = 0; i < 7; ++i) {
        EXPECT_EQ(scan.sources[i].label, drawings[i].label);
        const double radius = std::stod(drawings[i].parameters[0].second) * 128;
        EXPECT_NEAR(read_shape<2>(scan.sources[i]).volume, pi * radius * radius, 0.005 * pi * radius * radius);
    }
    EXPECT_EQ(read_csv(folder / "parameters.csv").at(1).fields.size(), 3U);
}

TEST(Synthetic, SameSeedSameBytesOtherSeedOtherBytes) {
    CollectionOptions options;
    options.count = 5;
    for (const auto make : {bars, dumbbells, disks, matchstick}) {
        const tests::TemporaryFolder a, b, c;
        write_collection(a.path(), make(options), 64);
        write_collection(b.path(), make(options), 64);
        CollectionOptions other = options;
        other.seed = 2;
        write_collection(c.path(), make(other), 64);
        int different = 0;
        for (const Drawing& drawing : make(options)) {
            const std::string name = drawing.name + ".png";
            EXPECT_EQ(tests::file_content(a / name), tests::file_content(b / name));
            different += tests::file_content(a / name) != tests::file_content(c / name) ? 1 : 0;
        }
        EXPECT_GE(different, 4);
        EXPECT_NO_THROW(write_collection(a.path(), make(options), 64));  // again over itself
    }
}

TEST(Synthetic, BarsKeepAreaAndRollUp) {
    CollectionOptions options;
    options.count = 4;
    double reach = 1.0;
    for (const Drawing& drawing : bars(options)) {
        const OutlineMoments m = moments(Outline{drawing.polygons});
        EXPECT_NEAR(m.area, 0.7 * 0.08 + pi * 0.04 * 0.04, 1e-4);
        EXPECT_LT(m.extent_radius, reach);
        reach = m.extent_radius;
        // The rolled bar does not touch itself: its picture is one loop, without a hole.
        EXPECT_EQ(outline_of(rasterize(drawing, 256)).loops.size(), 1U);
    }
    EXPECT_THROW(bent_bar({0.5, 0.5}, 0.7, 0.1, 7.0), std::invalid_argument);
}

TEST(Synthetic, MatchstickMenAreOnePartAndNamedByPersonAndPose) {
    CollectionOptions options;
    options.count = 30;
    std::set<std::string> labels;
    for (const Drawing& drawing : matchstick(options)) {
        labels.insert(drawing.label);
        EXPECT_TRUE(drawing.name.starts_with(drawing.label + "-"));
        Outline outline = outline_of(rasterize(drawing, 256));
        remove_specks(outline, 0.002);
        int parts = 0;
        for (const Loop& loop : outline.loops) parts += signed_area(loop) > 0 ? 1 : 0;
        EXPECT_EQ(parts, 1) << drawing.name;
    }
    EXPECT_EQ(labels.size(), 15U);
}

TEST(Synthetic, NoVariationMeansNoVariation) {
    CollectionOptions options;
    options.count = 3;
    options.variation = 0.0;
    for (const auto make : {bars, dumbbells}) {
        const std::vector<Drawing> drawings = make(options);
        EXPECT_EQ(drawings[0].parameters, drawings[2].parameters);
        EXPECT_NEAR(moments(outline_of(rasterize(drawings[0], 64))).extent_radius,
                    moments(outline_of(rasterize(drawings[2], 64))).extent_radius, 0.1);
    }
    options.variation = 1.5;
    EXPECT_THROW(bars(options), std::invalid_argument);
    options = {};
    options.count = 0;
    EXPECT_THROW(disks(options), std::invalid_argument);
}

TEST(Synthetic, AFolderWithOtherShapesIsNotWrittenInto) {
    const tests::TemporaryFolder folder;
    folder.write("mine.png", "precious");
    EXPECT_THROW(write_collection(folder.path(), disks({}), 64), ReadError);
    EXPECT_EQ(tests::file_content(folder / "mine.png"), "precious");
    EXPECT_THROW(write_collection(folder / "mine.png", disks({}), 64), WriteError);
}

TEST(Synthetic, OverlappingPolygonsAreTheirUnion) {
    Drawing drawing;
    drawing.polygons = {{{0.25, 0.25}, {0.75, 0.25}, {0.75, 0.75}, {0.25, 0.75}},
                        {{0.5, 0.5}, {1.0, 0.5}, {1.0, 1.0}, {0.5, 1.0}}};
    const Coverage coverage = rasterize(drawing, 64);
    double sum = 0.0;
    for (const float v : coverage.values) sum += v;
    EXPECT_NEAR(sum / (64 * 64), 0.25 + 0.25 - 0.0625, 1e-6);
    EXPECT_EQ(coverage.at(20, 40), 1.0F);  // lower left square
    EXPECT_EQ(coverage.at(60, 40), 0.0F);
}

TEST(Synthetic, AnalyticLevelSetsAreDistances) {
    const DyadicGrid<3> grid(3);
    const LevelSet<3> u = ball<3>(grid, {0.5, 0.5, 0.5}, 0.3);
    EXPECT_DOUBLE_EQ(u.values[grid.index({4, 4, 4})], 0.3);
    EXPECT_DOUBLE_EQ(u.values[grid.index({8, 4, 4})], -0.2);
    const LevelSet<3> v = box<3>(grid, {0.5, 0.5, 0.5}, {0.25, 0.125, 0.25});
    EXPECT_DOUBLE_EQ(v.values[grid.index({4, 4, 4})], 0.125);
    EXPECT_DOUBLE_EQ(v.values[grid.index({8, 8, 4})], -std::hypot(0.25, 0.375));
    // A drawing, an outline and the formula agree.
    Drawing drawing;
    drawing.polygons = {disk_polygon({0.4, 0.45}, 0.2, 1024)};
    const LevelSet<2> exact = ball<2>(DyadicGrid<2>(6), {0.4, 0.45}, 0.2),
                      drawn = shape_of(drawing, 6, false).level_set;
    const LevelSet<2> outlined = signed_distance(Outline{drawing.polygons}, DyadicGrid<2>(6));
    for (std::size_t i = 0; i < exact.values.size(); ++i) {
        EXPECT_NEAR(exact.values[i], drawn.values[i], 0.1 / 256);
        EXPECT_NEAR(exact.values[i], outlined.values[i], 1e-5);
    }
}

TEST(Letters, EveryCharacterIsAClassAndFitsThePicture) {
    LettersOptions options;
    options.characters = "AWi";
    options.count = 12;
    if (installed_fonts(options.characters).empty()) GTEST_SKIP() << "no fonts are installed (fonts-dejavu-core)";
    const std::vector<Drawing> drawings = letters(options);
    ASSERT_EQ(drawings.size(), 12U);
    EXPECT_EQ(drawings[1].label, "W");
    for (const Drawing& drawing : drawings) {
        for (const Loop& loop : drawing.polygons) {
            for (const Point<2>& p : loop)
                EXPECT_TRUE(p[0] > 0.02 && p[0] < 0.98 && p[1] > 0.02 && p[1] < 0.98) << drawing.name;
        }
        const Outline outline = outline_of(rasterize(drawing, 256));
        EXPECT_EQ(outline.loops.size(), drawing.label == "W" ? 1U : 2U) << drawing.name;  // hole of A, dot of i
    }
    const std::vector<Drawing> again = letters(options);
    EXPECT_EQ(again[5].polygons, drawings[5].polygons);
    options.seed = 9;
    EXPECT_NE(letters(options)[5].polygons, drawings[5].polygons);
}

TEST(Letters, FontsThatCannotServeAreNamed) {
    const tests::TemporaryFolder folder;
    LettersOptions options;
    options.fonts = {folder.write("font.ttf", "no font")};
    EXPECT_THROW(letters(options), ReadError);
    options.fonts = {};
    options.characters = "\xf3\xb0\x80\x80";  // a private code point that no text font has
    try {
        letters(options);
        FAIL() << "no error";
    } catch (const ReadError& error) {
        EXPECT_THAT(error.what(), ::testing::HasSubstr("fonts-dejavu-core"));
    }
    options.characters = "\xff";
    EXPECT_THROW(letters(options), std::invalid_argument);
}

}  // namespace
}  // namespace morphodesic::datasets

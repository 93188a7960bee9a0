#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "datasets/import.h"
#include "datasets/occlude.h"
#include "datasets/synthetic.h"
#include "tests/support/temporary_folder.h"

namespace morphodesic::datasets {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

Coverage man() {
    CollectionOptions options;
    options.count = 1;
    return rasterize(matchstick(options)[0], 128);
}

double area(const Coverage& coverage) {
    double sum = 0.0;
    for (const float v : coverage.values) sum += v;
    return sum;
}

TEST(Occlude, EveryKindHidesTheWantedShare) {
    const Coverage object = man();
    for (const char* kind : {"half-plane", "disk", "stripe", "limb"}) {
        for (const double fraction : {0.1, 0.4}) {
            for (const std::uint64_t seed : {1U, 2U, 3U}) {
                OcclusionOptions options;
                options.kind = kind;
                options.fraction = fraction;
                const OccludedPicture picture = occlude(object, options, seed);
                EXPECT_NEAR(picture.hidden_share, fraction, 0.03) << kind;
                EXPECT_NEAR(area(picture.visible), (1.0 - picture.hidden_share) * area(object), 1e-3);
                // Outside the mask the picture is the object's, inside it shows nothing.
                for (std::size_t p = 0; p < object.values.size(); ++p) {
                    EXPECT_EQ(picture.visible.values[p], picture.hidden.values[p] > 0 ? 0.0F : object.values[p]);
                }
                EXPECT_GT(area(picture.hidden),
                          1.2 * picture.hidden_share * area(object));  // background is hidden as well
            }
        }
    }
}

TEST(Occlude, ADirectionSaysWhichSideIsHidden) {
    OcclusionOptions options;
    options.direction = {0.0, 1.0};  // the head
    const OccludedPicture picture = occlude(man(), options, 5);
    EXPECT_EQ(picture.hidden.at(64, 0), 1.0F);  // rows run downwards
    EXPECT_EQ(picture.hidden.at(64, 127), 0.0F);
    EXPECT_NEAR(picture.hidden_share, 0.3, 0.03);
    options.kind = "disk";
    EXPECT_THAT(options.problems(), SizeIs(1));
}

TEST(Occlude, AnArmAndALegAreHiddenAndNothingElse) {
    CollectionOptions options;
    options.count = 1;
    const Drawing drawing = matchstick(options)[0];
    const OccludedPicture picture = hide_polygons(drawing, {2, 3, 6, 7}, 0.03, 128);
    Drawing rest = drawing, limbs = drawing;
    rest.polygons = {drawing.polygons[0], drawing.polygons[1], drawing.polygons[4],
                     drawing.polygons[5], drawing.polygons[8], drawing.polygons[9]};
    const Coverage kept = rasterize(rest, 128), whole = rasterize(drawing, 128);
    for (std::size_t p = 0; p < whole.values.size(); ++p) {
        if (kept.values[p] == 1.0F) EXPECT_EQ(picture.hidden.values[p], 0.0F);
        if (kept.values[p] == 0.0F && whole.values[p] > 0.0F) EXPECT_EQ(picture.hidden.values[p], 1.0F);
        if (picture.hidden.values[p] > 0.0F) EXPECT_EQ(picture.visible.values[p], 0.0F);
    }
    EXPECT_GT(picture.hidden_share, 0.15);
    EXPECT_LT(picture.hidden_share, 0.45);
}

TEST(Occlude, AHalfPlaneIsAHalfPlane) {
    const OccludedPicture picture = occlude(man(), {}, 5);
    const double hidden = area(picture.hidden);
    EXPECT_GT(hidden, 0.05 * 128 * 128);
    EXPECT_LT(hidden, 0.95 * 128 * 128);
    int changes = 0;  // along every row the mask changes at most once
    for (int y = 0; y < 128; ++y) {
        int in_row = 0;
        for (int x = 1; x < 128; ++x) in_row += picture.hidden.at(x, y) != picture.hidden.at(x - 1, y) ? 1 : 0;
        changes = std::max(changes, in_row);
    }
    EXPECT_LE(changes, 1);
}

TEST(Occlude, OnlyTheLargestPartIsLeftIfAskedFor) {
    Drawing two;
    two.polygons = {disk_polygon({0.3, 0.5}, 0.15), disk_polygon({0.7, 0.5}, 0.1)};
    OcclusionOptions options;
    options.fraction = 0.05;
    options.largest_part = true;
    const OccludedPicture picture = occlude(rasterize(two, 128), options, 1);
    for (int y = 0; y < 128; ++y) {
        for (int x = 70; x < 128; ++x) EXPECT_EQ(picture.visible.at(x, y), 0.0F);
    }
    EXPECT_EQ(picture.hidden.at(90, 64), 1.0F);
    EXPECT_GT(area(picture.visible), 0.5 * 3.14 * 19 * 19);
}

TEST(Occlude, QueriesComeWithMasksAndTheTruth) {
    const tests::TemporaryFolder folder;
    CollectionOptions collection;
    collection.count = 4;
    write_collection(folder / "in", dumbbells(collection), 96);
    folder.write("in/broken.png", "no image");
    const ScanResult scan = scan_folder(folder / "in");
    OcclusionOptions options;
    options.per_shape = 2;
    const OcclusionSummary summary = write_occluded(scan.sources, folder / "out", options);
    EXPECT_EQ(summary.queries, 8);
    ASSERT_THAT(summary.problems, SizeIs(1));
    EXPECT_THAT(summary.problems[0].message(), HasSubstr("broken.png"));

    const ScanResult queries = scan_folder(folder / "out");
    ASSERT_EQ(queries.sources.size(), 8U);
    const auto truth = read_labels(folder / "out/truth.csv");
    EXPECT_EQ(truth.size(), 8U);
    for (const ShapeSource& query : queries.sources) {
        EXPECT_FALSE(query.mask_path.empty());
        EXPECT_TRUE(truth.contains(query.name));
        const Shape<2> shape = import_shape<2>(query, {}, {});
        EXPECT_FALSE(shape.occlusion_mask.values.empty());
    }
    EXPECT_EQ(truth.at("dumbbell-01.1.png"), "even");
    // The same file and seed give the same cut, whatever else is in the folder.
    const tests::TemporaryFolder again;
    write_occluded({scan.sources[1]}, again.path(), options);
    const std::string name = scan.sources[1].name.substr(0, 11) + ".2.mask.png";
    EXPECT_EQ(tests::file_content(again / name), tests::file_content(folder / "out" / name));
    options.kind = "corner";
    EXPECT_THROW(write_occluded(scan.sources, folder / "out", options), std::invalid_argument);
}

TEST(Occlude, QueriesNeverLieAmongTheShapesTheyAreMadeFrom) {
    const tests::TemporaryFolder folder;
    CollectionOptions collection;
    collection.count = 2;
    write_collection(folder / "in/even", dumbbells(collection), 64);
    const ScanResult scan = scan_folder(folder / "in");
    const std::string name = "in/" + scan.sources[0].name, bytes = tests::file_content(folder / name);
    std::filesystem::create_directory_symlink(folder / "in", folder / "link");
    // The folder itself, folders inside it (there already or not), the folder it lies in, and the same by a link.
    for (const char* out : {"in", "in/even", "in/queries", "in/../in", "link", "link/queries", "."}) {
        EXPECT_THROW(write_occluded(scan.sources, folder / out, {}), ReadError) << out;
    }
    EXPECT_EQ(tests::file_content(folder / name), bytes);
    EXPECT_FALSE(std::filesystem::exists(folder / "in/queries"));
    EXPECT_FALSE(std::filesystem::exists(folder / "in/truth.csv"));
    EXPECT_EQ(write_occluded(scan.sources, folder / "in.occluded", {}).queries, 2);
    EXPECT_EQ(write_occluded(scan.sources, folder / "in.occluded", {}).queries, 2);  // again: its own files
}

TEST(Occlude, NoQueryOfAShapeIsThereTwice) {
    const tests::TemporaryFolder folder;
    CollectionOptions collection;
    collection.count = 1;
    write_collection(folder / "in", matchstick(collection), 64);
    OcclusionOptions options;
    options.kind = "limb";
    options.fraction = 0.1;
    options.per_shape = 12;  // it has no more than six limbs
    OcclusionOptions before = options;
    before.kind = "disk";  // queries of an earlier run must not stand among those of this one
    EXPECT_EQ(write_occluded(scan_folder(folder / "in").sources, folder / "out", before).queries, 12);
    const OcclusionSummary summary = write_occluded(scan_folder(folder / "in").sources, folder / "out", options);
    EXPECT_GE(summary.queries, 3);
    EXPECT_LE(summary.queries, 6);
    EXPECT_EQ(summary.queries + summary.repeated, 12);
    std::set<std::string> masks;
    for (const ShapeSource& query : scan_folder(folder / "out").sources) {
        masks.insert(tests::file_content(query.mask_path));
    }
    EXPECT_EQ(masks.size(), static_cast<std::size_t>(summary.queries));
    EXPECT_EQ(scan_folder(folder / "out").sources.size(), masks.size());
    options.kind = "half-plane";
    options.direction = {1.0, 0.0};
    EXPECT_THAT(options.problems(), ElementsAre(HasSubstr("all queries of a shape are the same")));
}

TEST(Occlude, APlaneCutsOffAShareOfASolid) {
    // A box, 1 x 2 x 4: a fifth of it lies beyond z = 3.2.
    TriangleMesh box;
    for (int i = 0; i < 8; ++i) {
        box.points.push_back({i % 2 ? 1.0 : 0.0, i / 2 % 2 ? 2.0 : 0.0, i / 4 ? 4.0 : 0.0});
    }
    box.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                     {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    ASSERT_NEAR(signed_volume(box), 8.0, 1e-12);
    const TriangleMesh cut = cut_by_plane(box, 0.2, {0.0, 0.0, 3.0});
    EXPECT_NEAR(bounding_box(cut.points).high[2], 3.2, 1e-9);
    EXPECT_FALSE(topology(cut).closed());
    EXPECT_THROW(cut_by_plane(box, 0.2, {0.0, 0.0, 0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace morphodesic::datasets

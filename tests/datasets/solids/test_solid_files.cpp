#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lzf.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <openvdb/tools/LevelSetUtil.h>

#include "datasets/import.h"
#include "datasets/point_cloud_reader.h"
#include "datasets/read_error.h"
#include "datasets/solid_pictures.h"
#include "datasets/solid_reader.h"
#include "datasets/synthetic.h"
#include "datasets/vdb_files.h"
#include "tests/datasets/solids/solid_files.h"

namespace morphodesic::datasets {
namespace {

using namespace tests;
using testing::HasSubstr;

const std::vector<Vector3> three{{0.5, 1.0, 1.5}, {-2.0, 0.25, 8.0}, {3.0, 4.0, 5.0}};

std::string pcd(const std::string& data, const std::string& points = "3") {
    std::string text =
        "# .PCD v0.7\nVERSION 0.7\nFIELDS rgb x y z\nSIZE 4 4 4 4\nTYPE U F F F\nCOUNT 1 1 1 1\nWIDTH 3\n"
        "HEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " +
        points + "\nDATA " + data + "\n";
    for (const auto& p : three) {
        if (data == "ascii") {
            text += "255 " + std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]) + "\n";
        } else {
            put(text, std::uint32_t{255});
            for (const double x : p) put(text, static_cast<float>(x));
        }
    }
    return text;
}

TEST(PointCloudReader, PcdAndXyz) {
    const FileFolder folder;
    std::vector<std::string> notes;
    EXPECT_EQ(read_point_cloud(folder.write("a.pcd", pcd("ascii")), 10, notes), three);
    EXPECT_EQ(read_point_cloud(folder.write("b.pcd", pcd("binary")), 10, notes), three);
    EXPECT_EQ(read_point_cloud(folder.write("c.xyz", "3\n0.5 1 1.5 9 9\n-2,0.25,8\n3;4;5\n"), 10, notes), three);
    EXPECT_TRUE(notes.empty());
    for (const auto& [name, content] : std::map<std::string, std::string>{{"lying.pcd", pcd("binary", "4")},
                                                                          {"lying2.pcd", pcd("ascii", "4000000000")},
                                                                          {"zip.pcd", pcd("binary_compressed")},
                                                                          {"none.pcd", "hello"},
                                                                          {"short.pcd", pcd("binary").substr(0, 190)},
                                                                          {"word.xyz", "0 0 0\n1 1 1\n1 1 x\n"},
                                                                          {"nan.xyz", "0 0 0\n1 1 1\nnan 1 1\n"},
                                                                          {"empty.xyz", "#\n"}}) {
        EXPECT_THROW(read_point_cloud(folder.write(name, content), 10, notes), ReadError) << name;
    }
    for (std::size_t size = 0; size < pcd("binary").size(); size += 3) {
        EXPECT_THROW(read_point_cloud(folder.write("cut.pcd", pcd("binary").substr(0, size)), 10, notes), ReadError);
    }
}

TEST(VdbFiles, LevelSetSurvivesTheRoundTrip) {
    const FileFolder folder;
    const LevelSet<3> u = ball<3>(DyadicGrid<3>(5), {0.5, 0.45, 0.55}, 0.3);
    ScalarField<3> height(u.grid);
    for (std::size_t i = 0; i < height.values.size(); ++i) height.values[i] = u.grid.position(u.grid.node(i))[2];
    const auto file = folder.path() / "ball.vdb";
    write_vdb(file, u, {{"dissipation", &height}});
    NormalizeOptions none;
    none.mode = "none";
    none.level = 5;
    const Shape<3> back = import_shape<3>(single_source(file), {}, none);
    for (std::size_t i = 0; i < u.values.size(); ++i) {
        if (std::abs(u.values[i]) > 0.1) continue;
        EXPECT_NEAR(back.level_set.values[i], u.values[i], 0.1 / 32);
    }
    write_ply(folder.path() / "ball.ply", u, {{"dissipation", &height}});
    const Shape<3> mesh = import_shape<3>(single_source(folder.path() / "ball.ply"), {}, none);
    EXPECT_NEAR(mesh.volume, 4.0 / 3.0 * 3.14159265 * 0.027, 0.002);
}

TEST(PointCloudReader, AHeadingSaysWhichColumnsArePositions) {
    const FileFolder folder;
    std::vector<std::string> notes;
    const auto read = [&](const std::string& text) { return read_point_cloud(folder.write("a.xyz", text), 10, notes); };
    EXPECT_EQ(read("x y z r\n0.5 1 1.5 9\n-2 0.25 8 9\n3 4 5 9\n"), three);
    EXPECT_EQ(read("r g b x y z\n9 9 9 0.5 1 1.5\n9 9 9 -2 0.25 8\n9 9 9 3 4 5\n"), three);
    EXPECT_EQ(read("# made by a scanner\n# in mm\n//Y,X,Z\n1,0.5,1.5\n0.25,-2,8\n4,3,5\n"), three);
    EXPECT_EQ(read("\"id\";\"z\";\"y\";\"x\"\n1;1,5;1,0;0,5\n2;8,0;0,25;-2,0\n3;5,0;4,0;3,0\n"), three);
    EXPECT_EQ(read("# columns x y z in metres\n0.5 1 1.5\n-2 0.25 8\n3 4 5\n"), three);  // a sentence
    EXPECT_THROW(read("z y x\n0.5 1 1.5 9\n-2 0.25 8 9\n"), ReadError);
    EXPECT_THROW(read("r x y z\n9 0.5 1 1.5\n9 -2 0.25\n"), ReadError);
}

TEST(PointCloudReader, DecimalCommasAreToldFromSeparators) {
    const FileFolder folder;
    const auto read = [&](const std::string& text, bool has_commas) {
        std::vector<std::string> notes;
        const auto points = read_point_cloud(folder.write("a.xyz", text), 10, notes);
        EXPECT_EQ(notes.size(), has_commas ? 1U : 0U) << text;
        return points;
    };
    EXPECT_EQ(read("0,5;1,0;1,5\n-2;0,25;8\n3;4;5\n", true), three);
    EXPECT_EQ(read("0,5\t1,0\t1,5\r\n-2,0\t0,25\t8,0\r\n3\t4\t5\r\n", true), three);
    EXPECT_EQ(read("0,5 1,0 1,5 255\n-2,0 0,25 8,0 0\n3 4 5 0\n", true), three);
    EXPECT_EQ(read("5,0e-1 1,0 1,5\n-2,0 2,5E-01 8,0e+0\n3 4 5\n", true), three);
    EXPECT_EQ(read("0.5,1,1.5\n-2,0.25,8,7,7\n3,4,5\n", false), three);
    EXPECT_EQ(read("0.5, 1, 1.5\n-2 ,0.25 ,8\n3, 4 5\n", false), three);
    EXPECT_EQ(read("0.5,1,1.5;7\n-2;0.25;8\n3,4,5\t9\t9\n", false), three);
    EXPECT_EQ(read("\xEF\xBB\xBF"
                   "0.5 1 1.5\n-2 0.25 8\n3 4 5\n",
                   false),
              three);
}

/// As the Point Cloud Library packs: the fields one after the other.
std::string packed_pcd() {
    std::string text = pcd("binary_compressed"), fields;
    text.resize(text.find("binary_compressed\n") + 18);
    for (std::size_t i = 0; i < three.size(); ++i) put(fields, std::uint32_t{255});
    for (int a = 0; a < 3; ++a) {
        for (const auto& p : three) put(fields, static_cast<float>(p[a]));
    }
    std::string out(2 * fields.size(), '\0');
    out.resize(lzf_compress(fields.data(), static_cast<unsigned>(fields.size()), out.data(),
                            static_cast<unsigned>(out.size())));
    put(text, static_cast<std::uint32_t>(out.size()));
    put(text, static_cast<std::uint32_t>(fields.size()));
    return text + out;
}

TEST(PointCloudReader, PackedPcd) {
    const FileFolder folder;
    std::vector<std::string> notes;
    const std::string content = packed_pcd();
    EXPECT_EQ(read_point_cloud(folder.write("a.pcd", content), 10, notes), three);
    for (std::size_t size = 0; size < content.size(); ++size) {
        EXPECT_THROW(read_point_cloud(folder.write("cut.pcd", content.substr(0, size)), 10, notes), ReadError) << size;
    }
    const std::size_t lengths = content.find("compressed\n") + 11;
    for (std::size_t i = 0; i < 8; ++i) {
        std::string lie = content;
        lie[lengths + i] = '\x7f';
        EXPECT_THROW(read_point_cloud(folder.write("lie.pcd", lie), 10, notes), ReadError) << i;
    }
}

TEST(PointCloudReader, PromisesOfTheHeaderAreQuotedAsTheyAre) {
    const FileFolder folder;
    std::string lie = pcd("ascii");
    lie.replace(lie.find("WIDTH 3\nHEIGHT 1"), 16, "WIDTH 4294967296\nHEIGHT 4294967296");
    lie.erase(lie.find("POINTS"), 9);
    std::vector<std::string> notes;
    try {
        read_point_cloud(folder.write("lie.pcd", lie), 10, notes);
        ADD_FAILURE();
    } catch (const ReadError& error) {
        EXPECT_THAT(error.problem(), HasSubstr("promises 4294967296 x 4294967296 points"));
    }
}

/// A ball and a second grid, as the program itself writes them.
std::string vdb_content(const FileFolder& folder) {
    const LevelSet<3> u = ball<3>(DyadicGrid<3>(4), {0.5, 0.5, 0.5}, 0.3);
    const ScalarField<3> height(u.grid);
    write_vdb(folder.path() / "whole.vdb", u, {{"dissipation", &height}});
    std::ifstream in(folder.path() / "whole.vdb", std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

std::string vdb_refusal(const std::filesystem::path& file) {
    std::vector<std::string> notes;
    try {
        read_vdb_surface(file, "auto", 100, notes);
    } catch (const ReadError& error) {
        EXPECT_FALSE(error.remedy().empty());
        return error.problem();
    }
    return "";
}

/// The library's own reader takes lengths from beyond the end of a file that breaks off, and all memory.
TEST(VdbFiles, BrokenOffAnywhereIsSaid) {
    const FileFolder folder;
    const std::string content = vdb_content(folder);
    EXPECT_EQ(vdb_refusal(folder.path() / "whole.vdb"), "");
    for (std::size_t size = 1; size < content.size(); size += size < 500 ? 1 : content.size() / 23) {
        EXPECT_THAT(vdb_refusal(folder.write("cut.vdb", content.substr(0, size))), HasSubstr("breaks off")) << size;
    }
    EXPECT_THAT(vdb_refusal(folder.write("cut.vdb", content.substr(0, content.size() - 1))), HasSubstr("breaks off"));
    EXPECT_THAT(vdb_refusal(folder.write("cut.vdb", "")), HasSubstr("empty"));
    EXPECT_THAT(vdb_refusal(folder.write("other.vdb", std::string(500, 'a'))), HasSubstr("like a VDB file"));
}

TEST(VdbFiles, DamagedDescriptionsGiveShortMessages) {
    const FileFolder folder;
    const std::string content = vdb_content(folder);
    std::uint32_t random = 4321;
    for (int round = 0; round < 300; ++round) {
        std::string damaged = content;
        for (int i = 0; i < 4; ++i) {
            random = random * 1664525U + 1013904223U;
            damaged[(random >> 8) % 300] = static_cast<char>(random >> 24);
        }
        EXPECT_LT(vdb_refusal(folder.write("damaged.vdb", damaged)).size(), 200U);
    }
}

/// The library copies blocks of the lengths that the file says over its own memory: that must not end the program.
TEST(VdbFiles, DamagedValuesEndNothingButTheirReading) {
    const FileFolder folder;
    const std::string content = vdb_content(folder);
    std::uint32_t random = 99;
    int refused = 0;
    for (int round = 0; round < 100; ++round) {
        std::string damaged = content;
        for (int i = 0; i < 3; ++i) {
            random = random * 1664525U + 1013904223U;
            damaged[(random >> 8) % content.size()] = static_cast<char>(random >> 24);
        }
        const std::string refusal = vdb_refusal(folder.write("damaged.vdb", damaged));
        EXPECT_LT(refusal.size(), 200U);
        if (!refusal.empty()) ++refused;
    }
    EXPECT_GT(refused, 10);
}

TEST(VdbFiles, WhatAGridHoldsIsToldByItsKindAndValues) {
    openvdb::initialize();
    const FileFolder folder;
    const auto file = folder.path() / "grid.vdb";
    const double exact = 4.0 / 3.0 * 3.14159265 * 8000;
    const auto volume_of = [&](const openvdb::GridBase::Ptr& grid, std::vector<std::string>& notes) {
        grid->setName("shape");
        openvdb::io::File out(file.string());
        out.write({grid});
        out.close();
        notes.clear();
        return signed_volume(read_vdb_surface(file, "auto", 100, notes));
    };
    std::vector<std::string> notes;
    const auto floats = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(20, {0, 0, 0}, 1, 3);
    EXPECT_NEAR(volume_of(floats->deepCopy(), notes), exact, 0.01 * exact);
    EXPECT_TRUE(notes.empty());
    // Doubles, too, are negative inside of the band.
    const auto doubles = openvdb::tools::createLevelSetSphere<openvdb::DoubleGrid>(20, {0, 0, 0}, 1, 3);
    EXPECT_NEAR(volume_of(doubles, notes), exact, 0.01 * exact);
    EXPECT_TRUE(notes.empty());
    const auto untold = floats->deepCopy();
    untold->setGridClass(openvdb::GRID_UNKNOWN);
    EXPECT_NEAR(volume_of(untold, notes), exact, 0.01 * exact);
    EXPECT_THAT(notes, testing::ElementsAre(HasSubstr("taken for a signed distance")));
    const auto fog = floats->deepCopy();
    openvdb::tools::sdfToFogVolume(*fog);
    EXPECT_GT(volume_of(fog, notes), 0.5 * exact);
    EXPECT_THAT(notes, testing::ElementsAre(HasSubstr("passes 0.5")));
}

TEST(VdbFiles, MasksAndTheGridThatIsMostLikelyTheShape) {
    openvdb::initialize();
    const FileFolder folder;
    const auto file = folder.path() / "grids.vdb";
    const auto write = [&](const openvdb::GridPtrVec& grids) {
        for (std::size_t i = 0; i < grids.size(); ++i) grids[i]->setName("grid " + std::to_string(i));
        openvdb::io::File out(file.string());
        out.write(grids);
        out.close();
    };
    std::vector<std::string> notes;
    const auto volume = [&] {
        notes.clear();
        return signed_volume(read_vdb_surface(file, "auto", 100, notes));
    };
    const auto ball = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(20, {0, 0, 0}, 1, 3);
    const auto small = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(10, {0, 0, 0}, 1, 3);
    const double exact = 4.0 / 3.0 * 3.14159265 * 8000;
    const openvdb::BoolGrid::Ptr inside = openvdb::tools::sdfInteriorMask(*ball);
    const auto labels = openvdb::Int32Grid::create(0);
    labels->tree().topologyUnion(inside->tree());
    for (auto it = labels->beginValueOn(); it; ++it) it.setValue(it.getCoord()[0] < 0 ? 1 : 2);
    const auto mask = openvdb::MaskGrid::create();
    mask->tree().topologyUnion(inside->tree());
    for (const openvdb::GridBase::Ptr& grid : openvdb::GridPtrVec{inside, labels, mask}) {
        write({grid});
        EXPECT_NEAR(volume(), exact, 0.02 * exact) << grid->type();
    }
    // A level set before a density, numbers before a mask, whatever comes first; what is empty only as the last.
    const auto fog = ball->deepCopy();
    openvdb::tools::sdfToFogVolume(*fog);
    write({mask, fog, small->deepCopy()});
    EXPECT_NEAR(volume(), exact / 8, 0.02 * exact / 8);
    EXPECT_THAT(notes, testing::ElementsAre(HasSubstr("Of 3 grids, \"grid 2\" was used")));
    write({mask, fog});
    EXPECT_LT(volume(), 0.95 * exact);
    EXPECT_THAT(notes, testing::Contains(HasSubstr("\"grid 1\" was used")));
    const auto empty = openvdb::FloatGrid::create(3.0F);
    empty->setGridClass(openvdb::GRID_LEVEL_SET);
    write({empty, openvdb::Vec3SGrid::create(), mask});
    EXPECT_NEAR(volume(), exact, 0.02 * exact);
    write({empty});
    EXPECT_THAT(vdb_refusal(file), HasSubstr("empty"));
    write({openvdb::Vec3SGrid::create()});
    EXPECT_THAT(vdb_refusal(file), HasSubstr("no grid of numbers"));
}

TEST(VdbFiles, ValuesThatAreNoNumbersAreRefused) {
    openvdb::initialize();
    const FileFolder folder;
    const auto file = folder.path() / "grid.vdb";
    const auto ball = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(20, {0, 0, 0}, 1, 3);
    ball->tree().setValueOn({20, 0, 0}, std::numeric_limits<float>::quiet_NaN());
    openvdb::io::File out(file.string());
    out.write({ball});
    out.close();
    EXPECT_THAT(vdb_refusal(file), HasSubstr("NaN or infinite"));
}

TEST(VdbFiles, NamesMayBeWrittenInAnyLetters) {
    EXPECT_TRUE(is_vdb("a.vdb") && is_vdb("a.VDB") && is_vdb("a.Vdb"));
    EXPECT_FALSE(is_vdb("vdb"));
}

TEST(SolidPictures, BallIsRoundAndColoured) {
    const LevelSet<3> u = ball<3>(DyadicGrid<3>(5), {0.5, 0.5, 0.5}, 0.3);
    ScalarField<3> height(u.grid);
    for (std::size_t i = 0; i < height.values.size(); ++i) height.values[i] = u.grid.position(u.grid.node(i))[2];
    View view;
    view.width = view.height = 128;
    view.elevation = 0.0;
    const PixelImage image = shaded_view(u, view, &height, {0.2, 0.8});
    double covered = 0.0;
    for (std::size_t p = 0; p < image.pixel_count(); ++p) covered += image.at(p)[3] / 255.0;
    const double radius = 128 * 0.3 / (2 * 1.06 * 0.36);
    EXPECT_NEAR(covered, 3.14159265 * radius * radius, 0.02 * covered);
    EXPECT_EQ(image.at(0)[3], 0);
    // yellow on top, violet below
    const auto* top = image.at(64 + 128 * 20);
    const auto* bottom = image.at(64 + 128 * 108);
    EXPECT_GT(top[1], top[2]);
    EXPECT_GT(bottom[2], bottom[1]);
    const PixelImage cut = slice_picture(u, 2, 0.5, 100);
    EXPECT_EQ(cut.at(50 + 100 * 50)[3], 255);
    EXPECT_NE(cut.at(50 + 100 * 50)[0], cut.at(3)[0]);
    const PixelImage nothing = shaded_view(LevelSet<3>(u.grid, -1.0), view);
    EXPECT_EQ(*std::max_element(nothing.values.begin(), nothing.values.end()), 0);
}

TEST(SolidPictures, SlicesCutWhereTheSolidsAreLarge) {
    const DyadicGrid<3> grid(5);
    const auto middle = ball<3>(grid, {0.5, 0.5, 0.5}, 0.2), aside = ball<3>(grid, {0.64, 0.5, 0.5}, 0.2);
    EXPECT_EQ(slice_position(std::vector{middle}, 0), 0.5);
    EXPECT_GT(slice_position(std::vector{aside}, 0), 0.54);  // there it has 90 % of its largest cut
    EXPECT_LT(slice_position(std::vector{aside}, 0), 0.64);
    EXPECT_EQ(slice_position(std::vector{aside}, 2), 0.5);
    EXPECT_GT(slice_position(std::vector{aside}, 1, {0, -1, 0, 1, 0, 0, 0, 0, 1}), 0.54);  // x turned into y
    // Two legs: the plane between them shows nothing.
    LevelSet<3> legs(grid);
    for (std::size_t i = 0; i < legs.values.size(); ++i) {
        const auto x = grid.position(grid.node(i));
        legs.values[i] = 0.08 - std::max(std::abs(std::abs(x[1] - 0.5) - 0.15), std::abs(x[0] - 0.5));
    }
    EXPECT_NEAR(std::abs(slice_position(std::vector{legs}, 1) - 0.5), 0.12, 0.05);
}

TEST(SolidPictures, SmallSolidsHaveCloserLevelLines) {
    const LevelSet<3> u = ball<3>(DyadicGrid<3>(6), {0.5, 0.5, 0.5}, 0.1);
    const auto tones_along_the_middle = [&](double radius) {
        const PixelImage cut = slice_picture(u, 2, 0.5, 200, nullptr, {}, 1, radius);
        int changes = 0;
        for (std::size_t x = 101; x < 200; ++x) {
            changes += std::abs(static_cast<int>(cut.at(x + 200 * 100)[1]) -
                                static_cast<int>(cut.at(x - 1 + 200 * 100)[1])) > 4;
        }
        return changes;
    };
    EXPECT_GE(tones_along_the_middle(0.12), 8);  // at one distance for all it would be four
}

}  // namespace
}  // namespace morphodesic::datasets

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <functional>
#include <numbers>

#include "datasets/import.h"
#include "datasets/read_error.h"
#include "datasets/volume.h"
#include "tests/datasets/solids/solid_files.h"

namespace morphodesic::datasets {
namespace {

using namespace tests;
using testing::Contains;
using testing::HasSubstr;

constexpr std::array<int, 3> nodes{30, 24, 20};
constexpr std::array<double, 3> spacing{0.5, 0.625, 0.75};
const Vector3 origin{10.0, -20.0, 30.0}, centre{17.0, -12.5, 37.0};
constexpr double voxel_ball_radius = 5.0;
constexpr double flat = 0.025;  // flat faces between nodes h apart cost about (h / radius)^2 of a ball

/// A grey ball: values from 1000 in the middle downwards, 500 at the surface.
template <class T>
std::string ball_values(bool swapped = false, bool mask = false) {
    std::string bytes;
    for (int k = 0; k < nodes[2]; ++k) {
        for (int j = 0; j < nodes[1]; ++j) {
            for (int i = 0; i < nodes[0]; ++i) {
                const Vector3 x = origin + Vector3{i * spacing[0], j * spacing[1], k * spacing[2]};
                const double depth = voxel_ball_radius - norm(x - centre);
                put(bytes, static_cast<T>(mask ? (depth > 0 ? 1 : 0) : std::max(0.0, 500.0 + 100.0 * depth)), swapped);
            }
        }
    }
    return bytes;
}

/// NIfTI-1: a header of 348 bytes, four more, the numbers.
std::string nifti(const std::string& values, std::int16_t type, std::int16_t bits, bool swapped = false,
                  bool mirrored = false) {
    std::string h(352, '\0');
    const auto set = [&](std::size_t at, auto value) {
        std::string bytes;
        put(bytes, value, swapped);
        h.replace(at, bytes.size(), bytes);
    };
    set(0, std::int32_t{348});
    const std::array<int, 8> dim{3, nodes[0], nodes[1], nodes[2], 1, 1, 1, 1};
    for (std::size_t a = 0; a < 8; ++a) set(40 + 2 * a, static_cast<std::int16_t>(dim[a]));
    set(70, type);
    set(72, bits);
    set(76, 1.0F);
    for (std::size_t a = 0; a < 3; ++a) set(80 + 4 * a, static_cast<float>(spacing[a]));
    set(108, 352.0F);
    h[123] = 2;  // millimetres
    set(254, std::int16_t{1});
    for (std::size_t a = 0; a < 3; ++a) {
        const double sign = mirrored && a == 0 ? -1.0 : 1.0;
        set(280 + 20 * a, static_cast<float>(sign * spacing[a]));  // the diagonal of the sform
        set(292 + 16 * a, static_cast<float>(sign * origin[a]));
    }
    h.replace(344, 4, std::string("n+1\0", 4));
    return h + values;
}

std::string nrrd(const std::string& more, const std::string& values, const std::string& type = "short") {
    return "NRRD0004\n# a comment\ntype: " + type +
           "\ndimension: 3\nspace: right-anterior-superior\nsizes: 30 24 20\n"
           "space directions: (0.5,0,0) (0,0.625,0) (0,0,0.75)\nspace origin: (10,-20,30)\n" +
           more + "\n\n" + values;
}

std::string metaimage(const std::string& more, const std::string& data, const std::string& values) {
    return "ObjectType = Image\nNDims = 3\nDimSize = 30 24 20\nElementType = MET_FLOAT\nElementSpacing = 0.5 0.625 "
           "0.75\nOffset = 10 -20 30\n" +
           more + "\nElementDataFile = " + data + "\n" + values;
}

std::string packed(const std::string& bytes, int window) {
    std::string out(bytes.size() + 1000, '\0');
    z_stream zip{};
    deflateInit2(&zip, 6, Z_DEFLATED, window, 8, Z_DEFAULT_STRATEGY);
    zip.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    zip.avail_in = static_cast<unsigned>(bytes.size());
    zip.next_out = reinterpret_cast<Bytef*>(out.data());
    zip.avail_out = static_cast<unsigned>(out.size());
    deflate(&zip, Z_FINISH);
    out.resize(zip.total_out);
    deflateEnd(&zip);
    return out;
}
constexpr int as_zlib = 15, as_gzip = 31;

ImportOptions at(const std::string& isovalue) {
    ImportOptions options;
    options.isovalue = isovalue;
    return options;
}

void expect_ball(const RawShape<3>& ball, const Vector3& middle, double share) {
    const double volume = 4.0 / 3.0 * std::numbers::pi * std::pow(voxel_ball_radius, 3);
    EXPECT_NEAR(ball.volume, volume, share * volume) << ball.source.name;
    EXPECT_LT(norm(ball.centroid - middle), 0.1 * voxel_ball_radius * share + 0.01) << ball.source.name;
}

std::string refusal(const std::filesystem::path& file, const ImportOptions& options = at("500")) {
    try {
        read_shape<3>(single_source(file), options);
    } catch (const ReadError& error) {
        EXPECT_THAT(error.what(), HasSubstr(file.stem().string()));
        EXPECT_FALSE(error.remedy().empty());
        return std::string(error.problem()) + "; " + error.remedy();
    }
    ADD_FAILURE() << file << " was read";
    return "";
}

TEST(Volume, EveryFormatGivesTheSameBallInMillimetres) {
    const FileFolder folder;
    const std::string shorts = ball_values<std::int16_t>(), swapped = ball_values<std::int16_t>(true);
    const std::string floats = ball_values<float>();
    std::string text;
    for (std::size_t i = 0; i < shorts.size(); i += 2) {
        std::int16_t value;
        std::memcpy(&value, shorts.data() + i, 2);
        text += std::to_string(value) + (i % 60 == 58 ? "\n" : " ");
    }
    folder.write("numbers.raw", floats);
    folder.write("numbers.zraw", packed(floats, as_zlib));
    const std::map<std::string, std::string> files{
        {"short.nii", nifti(shorts, 4, 16)},
        {"big.nii", nifti(swapped, 4, 16, true)},
        {"double.nii", nifti(ball_values<double>(), 64, 64)},
        {"packed.nii.gz", packed(nifti(floats, 16, 32), as_gzip)},
        {"raw.nrrd", nrrd("encoding: raw\nendian: little", shorts)},
        {"big.nrrd", nrrd("encoding: raw\nendian: big", swapped)},
        {"gzip.nrrd", nrrd("encoding: gzip\nendian: little", packed(shorts, as_gzip))},
        {"text.nrrd", nrrd("encoding: text", text)},
        {"detached.nhdr", nrrd("encoding: raw\nendian: little\ndata file: numbers.raw", "", "float")},
        {"beside.nhdr", nrrd("encoding: raw\nendian: little\nDICOM_0008:0020:=1\nDICOM_0008:0021:=a: 2\n"
                             "data file: ./numbers.raw",
                             "", "float")},
        {"beside.mhd", metaimage("BinaryData = True", "./numbers.raw", "")},
        {"unsaid.mhd", metaimage("Comment = binary, as MetaIO takes it", "numbers.raw", "")},
        {"local.mha", metaimage("BinaryData = True\nBinaryDataByteOrderMSB = False", "LOCAL", floats)},
        {"raw.mhd", metaimage("BinaryData = True", "numbers.raw", "")},
        {"packed.mhd", metaimage("BinaryData = True\nCompressedData = True", "numbers.zraw", "")}};
    for (const auto& [name, content] : files) {
        const RawShape<3> ball = read_shape<3>(single_source(folder.write(name, content)), at("500"));
        expect_ball(ball, centre, flat);
        EXPECT_TRUE(ball.notes.empty()) << name << ": " << ball.notes.front();
    }
}

TEST(Volume, MasksNeedNoIsovalueAndUnitsAreTurnedIntoMillimetres) {
    const FileFolder folder;
    const std::string mask = ball_values<std::uint8_t>(false, true);
    expect_ball(read_shape<3>(single_source(folder.write("mask.nii", nifti(mask, 2, 8)))), centre, 0.04);
    std::string metres = nifti(mask, 2, 8);
    metres[123] = 1;
    const RawShape<3> large = read_shape<3>(single_source(folder.write("metres.nii", metres)));
    EXPECT_NEAR(large.volume, 1e9 * 4.0 / 3.0 * std::numbers::pi * std::pow(voxel_ball_radius, 3), 0.04 * large.volume);
    EXPECT_THAT(refusal(folder.write("grey.nii", nifti(ball_values<std::int16_t>(), 4, 16)), {}),
                HasSubstr("nothing says which of them is the surface; name it with --isovalue"));
    EXPECT_THAT(refusal(folder.path() / "grey.nii", at("5000")), HasSubstr("no surface at 5000"));
}

/// A dark object before a bright background would be its box with a cavity.
TEST(Volume, TheBackgroundIsNotTheObject) {
    const FileFolder folder;
    std::string mask = ball_values<std::uint8_t>(false, true);
    for (char& v : mask) v = static_cast<char>(1 - v);
    const auto file = folder.write("dark.nii", nifti(mask, 2, 8));
    EXPECT_THAT(refusal(file, {}), testing::AllOf(HasSubstr("background"), HasSubstr("--inside below")));
    ImportOptions options;
    options.inside = "below";
    expect_ball(read_shape<3>(single_source(file), options), centre, 0.04);
    options.inside = "above";
    EXPECT_THAT(read_shape<3>(single_source(file), options).notes, Contains(HasSubstr("hollow")));
    options.inside = "left";
    EXPECT_THAT(options.problems(), Contains(HasSubstr("inside must be")));
}

/// The plane of the cut is not where the object ends.
TEST(Volume, WhatTheBorderHidesIsUnknown) {
    const FileFolder folder;
    std::string cut = nifti(ball_values<std::int16_t>(), 4, 16);
    const std::int16_t few = 14;  // of the 20 slices, so that the ball is cut in its middle
    std::memcpy(cut.data() + 46, &few, 2);
    cut.resize(352 + 2UL * nodes[0] * nodes[1] * few);
    const auto file = folder.write("cut.nii", cut);
    const DyadicGrid<3> grid(4);
    const auto hidden = [&](const std::string& border) {
        ImportOptions options = at("500");
        options.border = border;
        const RawShape<3> shape = read_shape<3>(single_source(file), options);
        Placement<3> placement;
        placement.scale = 0.04;
        for (int a = 0; a < 3; ++a) placement.offset[a] = 0.5 - placement.scale * centre[a];
        return shape.geometry->occlusion_mask(grid, placement);
    };
    EXPECT_TRUE(hidden("free").values.empty());
    const ScalarField<3> chi = hidden("hides");
    ASSERT_FALSE(chi.values.empty());
    const int half = grid.cells_per_axis() / 2;
    EXPECT_EQ(chi.values[grid.index({half, half, half + 4})], 0.0);  // beyond the cut
    EXPECT_EQ(chi.values[grid.index({half, half, half - 4})], 1.0);  // below the ball
}

/// An axis that runs backwards does not mirror the object: its place says where it is.
TEST(Volume, AxesOfTheFileAreHonoured) {
    const FileFolder folder;
    const RawShape<3> back = read_shape<3>(
        single_source(folder.write("back.nii", nifti(ball_values<std::int16_t>(), 4, 16, false, true))), at("500"));
    expect_ball(back, {-centre[0], centre[1], centre[2]}, flat);
    std::string left = nrrd("encoding: raw\nendian: little", ball_values<std::int16_t>());
    left.replace(left.find("right-ant"), 5, "left");
    const RawShape<3> turned = read_shape<3>(single_source(folder.write("left.nrrd", left)), at("500"));
    expect_ball(turned, {-centre[0], centre[1], centre[2]}, flat);
    // Without a place the file does not tell left from right, and that is said.
    std::string placeless = nifti(ball_values<std::int16_t>(), 4, 16);
    placeless[254] = 0;
    EXPECT_THAT(read_shape<3>(single_source(folder.write("placeless.nii", placeless)), at("500")).notes,
                Contains(HasSubstr("mirror image")));
}

TEST(Volume, WhatReachesTheBorderIsCutOffAndNanIsOutside) {
    const FileFolder folder;
    std::string values = ball_values<float>();
    const float nan = NAN;
    for (std::size_t i = 0; i < 500; ++i) std::memcpy(values.data() + 4 * i, &nan, 4);
    const RawShape<3> ball = read_shape<3>(single_source(folder.write("nan.nii", nifti(values, 16, 32))), at("500"));
    expect_ball(ball, centre, flat);
    EXPECT_THAT(ball.notes, Contains(HasSubstr("500 voxels without a finite number")));
    const RawShape<3> cut = read_shape<3>(single_source(folder.path() / "nan.nii"), at("100"));
    EXPECT_THAT(cut.notes, Contains(HasSubstr("cut off flat")));
    EXPECT_THAT(refusal(folder.write("none.nii", nifti(std::string(values.size(), '\xff'), 16, 32))),
                HasSubstr("none of its values"));
}

/// Stored as integers with a slope and a shift, 0 and 1 come back with the rounding of single precision.
TEST(Volume, SharesMayBeRounded) {
    const FileFolder folder;
    const auto shares = [&](double low, double high) {
        std::string bytes;
        for (int k = 0; k < nodes[2]; ++k) {
            for (int j = 0; j < nodes[1]; ++j) {
                for (int i = 0; i < nodes[0]; ++i) {
                    const Vector3 x = origin + Vector3{i * spacing[0], j * spacing[1], k * spacing[2]};
                    put(bytes,
                        static_cast<float>(std::clamp(0.5 + 0.5 * (voxel_ball_radius - norm(x - centre)), low, high)));
                }
            }
        }
        return folder.write("shares.nii", nifti(bytes, 16, 32));
    };
    expect_ball(read_shape<3>(single_source(shares(0.0, 1.0))), centre, flat);
    expect_ball(read_shape<3>(single_source(shares(-2.37e-8, 1.0000001))), centre, flat);
    EXPECT_THAT(refusal(shares(-0.1, 1.0), {}), HasSubstr("nothing says which"));
    EXPECT_THAT(refusal(shares(0.0, 0.4), {}), HasSubstr("nothing says which"));
}

TEST(Volume, LiesAreNamed) {
    const FileFolder folder;
    const std::string shorts = ball_values<std::int16_t>(), good = nifti(shorts, 4, 16);
    const auto nifti_with = [&](std::size_t offset, std::int16_t value) {
        std::string text = good;
        std::memcpy(text.data() + offset, &value, 2);
        return folder.write("lie.nii", text);
    };
    EXPECT_THAT(refusal(nifti_with(42, 32000)), HasSubstr("bytes of numbers, but there are only"));
    EXPECT_THAT(refusal(nifti_with(42, -3)), HasSubstr("-3 nodes"));
    EXPECT_THAT(refusal(nifti_with(40, 2)), HasSubstr("2 axes"));
    EXPECT_THAT(refusal(nifti_with(70, 128)), HasSubstr("kind 128"));
    EXPECT_THAT(refusal(nifti_with(72, 32)), HasSubstr("contradicts itself"));
    EXPECT_THAT(refusal(folder.write("short.nii", good.substr(0, 5000))), HasSubstr("but there are only"));
    EXPECT_THAT(refusal(folder.write("noise.nii", "hello, this is no volume")), HasSubstr("does not begin"));
    for (const std::size_t size : {1, 3, 4, 100, 347}) {
        EXPECT_THAT(refusal(folder.write("cut.nii", good.substr(0, size))), HasSubstr("breaks off within its header"));
    }
    EXPECT_THAT(refusal(folder.write("empty.nii.gz", "")), HasSubstr("the file is empty"));
    std::string huge = good;
    for (std::size_t a = 0; a < 3; ++a) huge[43 + 2 * a] = 0x7f;
    EXPECT_THAT(refusal(folder.write("huge.nii", huge)), HasSubstr("512 x 512 x 512"));
    std::string bad_axes = good;
    std::memset(bad_axes.data() + 280, 0, 16);
    EXPECT_THAT(refusal(folder.write("axes.nii", bad_axes)), HasSubstr("do not span space"));

    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = nrrd("encoding: raw\nendian: little", shorts);
        return folder.write("lie.nrrd", text.replace(text.find(from), from.size(), to));
    };
    EXPECT_THAT(refusal(with("30 24 20", "30 24 21")), HasSubstr("but there are only"));
    EXPECT_THAT(refusal(with("30 24 20", "30 24")), HasSubstr("2 numbers for sizes"));
    EXPECT_THAT(refusal(with("dimension: 3", "sizes: 30 24 20\ndimension: 3")), HasSubstr("sizes twice"));
    EXPECT_THAT(refusal(with("encoding: raw", "data file: LIST\nencoding: raw")), HasSubstr("several files"));
    EXPECT_THAT(refusal(with("encoding: raw", "data file: s%03d.raw 0 19 1\nencoding: raw")),
                HasSubstr("several files"));
    EXPECT_THAT(refusal(with("dimension: 3", "dimension: 4")), HasSubstr("4 axes"));
    EXPECT_THAT(refusal(with("type: short", "type: block")), HasSubstr("block"));
    EXPECT_THAT(refusal(with("raw", "zip")), HasSubstr("zip"));
    EXPECT_THAT(refusal(with("endian: little", "a: b")), HasSubstr("endian"));
    EXPECT_THAT(refusal(with("0.625", "nan")), HasSubstr("not finite"));
    EXPECT_THAT(refusal(with("0.625", "much")), HasSubstr("\"much\""));

    folder.write("secret.raw", "");
    EXPECT_THAT(refusal(folder.write("a.mhd", metaimage("BinaryData = True", "../secret.raw", ""))),
                HasSubstr("not a file beside it"));
    EXPECT_THAT(refusal(folder.write("b.mhd", metaimage("BinaryData = True", "absent.raw", ""))),
                HasSubstr("no such file beside it"));
    EXPECT_THAT(refusal(folder.write("c.mha", metaimage("BinaryData = True", "LOCAL", "abc"))),
                HasSubstr("but there are only 3"));
    EXPECT_THAT(refusal(folder.write("d.mha", metaimage("BinaryData = True\nCompressedData = True", "LOCAL", "abc"))),
                HasSubstr("far more than its 3 packed bytes"));
    EXPECT_THAT(refusal(folder.write("e.mha", "ObjectType = Image\n")), HasSubstr("no ElementDataFile"));
}

/// Half a volume is another solid; a few bytes behind the numbers are not.
TEST(Volume, MoreNumbersThanPromisedAreRefused) {
    const FileFolder folder;
    const std::string shorts = ball_values<std::int16_t>();
    const std::string padded = shorts + std::string(500, '\0'), twice = shorts + shorts;
    std::string text, texts;
    for (std::size_t i = 0; i < shorts.size(); i += 2) text += "1 ";
    texts = text + text;
    const auto refusal = [&](const std::string& name, const std::string& content) -> std::string {
        try {
            read_volume(folder.write(name, content), 100);
        } catch (const ReadError& error) {
            return error.problem();
        }
        return "";
    };
    const std::string little = "\nendian: little";
    for (const bool more : {false, true}) {
        const std::string& bytes = more ? twice : padded;
        const auto expected = more ? HasSubstr("but there are more") : HasSubstr("");
        const auto check = [&](const std::string& name, const std::string& content) {
            const std::string problem = refusal(name, content);
            EXPECT_EQ(problem.empty(), !more) << name << ": " << problem;
            EXPECT_THAT(problem, expected) << name;
        };
        check("a.nii", nifti(bytes, 4, 16));
        check("a.nii.gz", packed(nifti(bytes, 4, 16), as_gzip));
        check("a.nrrd", nrrd("encoding: raw" + little, bytes));
        check("b.nrrd", nrrd("encoding: gzip" + little, packed(bytes, as_gzip)));
        check("c.nrrd", nrrd("encoding: text", more ? texts : text + "1 1"));
        check("a.mha", metaimage("BinaryData = True\nCompressedData = True", "LOCAL",
                                 packed(ball_values<float>() + (more ? ball_values<float>() : ""), as_zlib)));
    }
}

TEST(Volume, DamagedBytesNeverCrash) {
    const FileFolder folder;
    const std::string shorts = ball_values<std::int16_t>();
    std::uint32_t random = 4711;
    for (const auto& [name, content] :
         std::map<std::string, std::string>{{"a.nii", nifti(shorts, 4, 16)},
                                            {"a.nrrd", nrrd("encoding: gzip\nendian: little", packed(shorts, as_gzip))},
                                            {"a.mha", metaimage("BinaryData = True", "LOCAL", ball_values<float>())}}) {
        for (int round = 0; round < 60; ++round) {
            std::string damaged = content;
            for (int i = 0; i < 4; ++i) {
                random = random * 1664525U + 1013904223U;
                damaged[random % std::min<std::size_t>(damaged.size(), 400)] = static_cast<char>(random >> 24);
            }
            try {
                Volume volume = read_volume(folder.write(name, damaged), 100);
                EXPECT_EQ(volume.values.size(),
                          static_cast<std::size_t>(volume.nodes[0]) * volume.nodes[1] * volume.nodes[2]);
            } catch (const ReadError&) {
            }
        }
    }
}

}  // namespace
}  // namespace morphodesic::datasets

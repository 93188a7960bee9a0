#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <iostream>

#include "datasets/image_header.h"
#include "datasets/read_error.h"
#include "tests/datasets/test_pictures.h"
#include "tests/support/temporary_folder.h"

namespace morphodesic::datasets {
namespace {

using namespace std::string_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;
using tests::disk_picture;
using tests::read;
using tests::save;
using tests::toned;

/// What reading a file complains about; "" if it does not.
std::string complaint(const std::filesystem::path& file, const ImportOptions& options = {}) {
    try {
        read(file, options);
    } catch (const ReadError& error) {
        EXPECT_THAT(error.what(), HasSubstr(file.filename().string()));
        EXPECT_FALSE(error.remedy().empty());
        return error.what();
    }
    return "";
}

std::string be32(std::uint32_t v) {
    return {char(v >> 24), char(v >> 16), char(v >> 8), char(v)};
}
std::string le32(std::uint32_t v) {
    return {char(v), char(v >> 8), char(v >> 16), char(v >> 24)};
}

TEST(ImageDamage, CutOffFilesAreRefusedWhereverTheyAreCut) {
    const tests::TemporaryFolder folder;
    const cv::Mat disk = toned(disk_picture(64, 32, 32, 20), 255, 0);
    for (const char* ending : {"png", "jpg", "bmp", "tif", "pgm", "webp"}) {
        const std::string whole = tests::file_content(save(folder / ("whole."s + ending), disk));
        for (const double share : {0.0, 0.02, 0.1, 0.5, 0.9}) {
            const auto cut =
                folder.write("cut."s + ending, whole.substr(0, static_cast<std::size_t>(share * double(whole.size()))));
            EXPECT_NE(complaint(cut), "") << ending << " " << share;
        }
    }
}

TEST(ImageDamage, TextPnmNeedsNoLastLineEndAndDamageInItIsNotPrinted) {
    const tests::TemporaryFolder folder;
    const std::string rows = "255 255 255 255 255\n255 0 0 0 255\n255 0 0 0 255\n255 0 0 0 255\n255 255 255 255 ";
    const std::string grey = "P2\n# a comment\n5 5\n255\n" + rows + "255";
    const std::string bits = "P1 5 5 00000 01110 01110 01110 0000";
    ImportOptions options;
    options.speck_fraction = 0.0;
    const std::string digest = normalize(read(folder.write("line end.pgm", grey + "\n"), options), {}).digest;
    const std::vector<std::pair<std::string, std::string>> files{
        {"a.pgm", grey}, {"b.pgm", grey + " # end"}, {"c.pbm", bits + "0"}};
    for (const auto& [name, text] : files) {
        EXPECT_EQ(normalize(read(folder.write(name, text), options), {}).digest, digest) << name;
    }
    testing::internal::CaptureStderr();
    EXPECT_THAT(complaint(folder.write("cut.pgm", "P2\n5 5\n255\n" + rows)), HasSubstr("cut off"));
    EXPECT_THAT(complaint(folder.write("cut.pbm", bits)), HasSubstr("cut off"));
    EXPECT_THAT(complaint(folder.write("word.pgm", grey + "x")), "");  // behind the last number
    EXPECT_THAT(complaint(folder.write("word 2.pgm", "P2\n5 5\n255\nx" + rows + "255\n")), HasSubstr("damaged"));
    EXPECT_THAT(complaint(folder.write("large.pgm", "P2\n5 5\n255\n99999999999 " + rows)), HasSubstr("damaged"));
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

/// A TIFF of 16 x 16 pixels in one strip, with further tags.
std::string tiff_file(const std::string& strip, const std::vector<std::array<std::uint32_t, 2>>& more) {
    std::vector<std::array<std::uint32_t, 2>> tags{
        {256, 16}, {257, 16}, {273, 8}, {278, 16}, {279, std::uint32_t(strip.size())}};
    tags.insert(tags.end(), more.begin(), more.end());
    std::stable_sort(tags.begin(), tags.end(), [](const auto& a, const auto& b) { return a[0] < b[0]; });
    const auto le16 = [](std::uint32_t v) { return le32(v).substr(0, 2); };
    std::string tiff = "II*\0"s + le32(8 + std::uint32_t(strip.size())) + strip + le16(std::uint32_t(tags.size()));
    for (const auto& tag : tags) tiff += le16(tag[0]) + le16(4) + le32(1) + le32(tag[1]);
    return tiff + le32(0);
}

TEST(ImageDamage, ATiffIsReadWholeOrNotAtAll) {
    const tests::TemporaryFolder folder;
    std::string pixels(16 * 16, '\xff'), packed(1000, '\0');
    for (std::size_t k = 0; k < 64; ++k) pixels[16 * (4 + k / 8) + 4 + k % 8] = '\0';
    const auto deflated = [&](std::size_t count) {
        uLongf size = packed.size();
        compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(pixels.data()), count);
        return packed.substr(0, size);
    };
    const std::vector<std::array<std::uint32_t, 2>> grey{{258, 8}, {259, 8}, {262, 1}, {277, 1}};
    EXPECT_EQ(complaint(folder.write("whole.tif", tiff_file(deflated(256), grey))), "");
    testing::internal::CaptureStderr();
    EXPECT_THAT(complaint(folder.write("half.tif", tiff_file(deflated(128), grey))), HasSubstr("cannot be unpacked"));
    std::string flipped = deflated(256);
    flipped[flipped.size() / 2] = static_cast<char>(flipped[flipped.size() / 2] ^ 0x55);
    EXPECT_THAT(complaint(folder.write("flipped.tif", tiff_file(flipped, grey))), HasSubstr("cannot be unpacked"));
    EXPECT_THAT(complaint(folder.write("planes.tif", tiff_file(std::string(6 * 256, '\0'),
                                                               {{258, 16}, {259, 1}, {262, 2}, {277, 3}, {284, 2}}))),
                HasSubstr("separate planes"));
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    ImportOptions small;  // of a tag that comes twice the first counts, as for the decoder
    small.max_megapixels = 0.0001;
    EXPECT_THAT(
        complaint(folder.write("twice.tif",
                               tiff_file(deflated(256), {{256, 4}, {257, 4}, {258, 8}, {259, 8}, {262, 1}, {277, 1}})),
                  small),
        HasSubstr("16 x 16"));
}

TEST(ImageDamage, WhatTheDecoderDoesNotKnowIsSaidOnceAndWithTheName) {
    // A TIFF of 16 x 16 floats of 16 bits: OpenCV prints what it throws of it, without a name.
    const std::string tiff = tiff_file(std::string(512, '\0'), {{258, 16}, {259, 1}, {262, 1}, {277, 1}, {339, 3}});
    const tests::TemporaryFolder folder;
    testing::internal::CaptureStderr();
    EXPECT_THAT(complaint(folder.write("half.tiff", tiff)), HasSubstr("of an unusual kind"));
    std::cerr << "heard";  // only what the decoder says is dropped
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "heard");
}

TEST(ImageDamage, AChangedBitInAPngIsNoticed) {
    const tests::TemporaryFolder folder;
    std::string bytes = tests::file_content(save(folder / "a.png", toned(disk_picture(64, 32, 32, 20), 255, 0)));
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x10);
    EXPECT_THAT(complaint(folder.write("b.png", bytes)), HasSubstr("check sum"));
}

TEST(ImageDamage, EmptyAndForeignFilesAreRefused) {
    const tests::TemporaryFolder folder;
    EXPECT_THAT(complaint(folder.write("zero.png", "")), HasSubstr("empty"));
    EXPECT_THAT(complaint(folder.write("text.png", "not an image at all, really")), HasSubstr("not an image"));
    EXPECT_THAT(complaint(folder.write("odd \"name\"\n \xc3\xa4.png", "x")), HasSubstr("not an image"));
    EXPECT_THAT(complaint(folder.write("only magic.gif", "GIF89a")), HasSubstr("header"));
    const std::string moving = "RIFF"s + le32(22) + "WEBPVP8X" + le32(10) + "\x02\0\0\0\x3f\0\0\x3f\0\0"s;
    EXPECT_THAT(complaint(folder.write("moving.webp", moving)), HasSubstr("animation"));
}

TEST(ImageDamage, BombsAndLyingHeadersAreRefusedBeforeMemoryIsAskedFor) {
    const tests::TemporaryFolder folder;
    const std::string png = "\x89PNG\r\n\x1a\n\0\0\0\rIHDR"s + be32(100000) + be32(100000) + "\x08\0\0\0\0"s + be32(0);
    EXPECT_THAT(complaint(folder.write("bomb.png", png)),
                AllOf(HasSubstr("100000 x 100000"), HasSubstr("--max-megapixels")));
    const std::string bmp =
        "BM"s + le32(1000) + le32(0) + le32(54) + le32(40) + le32(0x7fffffff) + le32(0x80000000U) + "\x01\0\x18\0"s;
    EXPECT_THAT(complaint(folder.write("bomb.bmp", bmp)), HasSubstr("pixels, more than"));
    EXPECT_THAT(complaint(folder.write("bomb.pgm", "P5\n# c\n99999999999 99999999999 255\n")), HasSubstr("more than"));
    EXPECT_THAT(complaint(folder.write("bomb.gif", "GIF89a\xff\xff\xff\xff\0\0\0;"s)), HasSubstr("65535 x 65535"));
    const std::string tiff = "II*\0"s + le32(8) + "\x02\0"s + "\0\x01\x04\0"s + le32(1) + le32(200000) +
                             "\x01\x01\x04\0"s + le32(1) + le32(200000);
    EXPECT_THAT(complaint(folder.write("bomb.tif", tiff)), HasSubstr("200000 x 200000"));
    const std::string jpeg = "\xff\xd8\xff\xc0\0\x11\x08\xff\xff\xff\xff\x03"s;
    EXPECT_THAT(complaint(folder.write("bomb.jpg", jpeg)), HasSubstr("65535 x 65535"));
    const std::string webp = "RIFF\0\0\0\0WEBPVP8X\x0a\0\0\0\0\0\0\0\xff\xff\xff\xff\xff\xff"s;
    EXPECT_THAT(complaint(folder.write("bomb.webp", webp)), HasSubstr("16777216 x 16777216"));
    EXPECT_THAT(complaint(folder.write("none.pgm", "P5\n0 5 255\n")), HasSubstr("no pixels"));
    // Within the limit by its header, but nothing behind it.
    EXPECT_NE(complaint(folder.write("lie.pgm", "P5\n5000 5000 255\nx")), "");
    const auto small = save(folder / "small.png", toned(disk_picture(64, 32, 32, 20), 255, 0));
    ImportOptions tight;
    tight.max_megapixels = 0.004;
    EXPECT_THAT(complaint(small, tight), HasSubstr("64 x 64"));
    tight.max_megapixels = 0.0041;
    EXPECT_EQ(complaint(small, tight), "");
}

TEST(ImageDamage, ImagesWithoutAShapeAreRefusedWithAReason) {
    const tests::TemporaryFolder folder;
    EXPECT_THAT(complaint(save(folder / "plain.png", cv::Mat(20, 20, CV_8U, cv::Scalar(255)))),
                HasSubstr("only one colour"));
    EXPECT_THAT(complaint(save(folder / "pixel.png", cv::Mat(1, 1, CV_8U, cv::Scalar(0)))),
                HasSubstr("only one colour"));
    cv::Mat faint(64, 64, CV_8U);
    for (int i = 0; i < 64 * 64; ++i) faint.data[i] = static_cast<uchar>(200 + (i * i / 7) % 5);
    EXPECT_THAT(complaint(save(folder / "faint.png", faint)), HasSubstr("contrast"));
    cv::Mat noise(128, 128, CV_8U);
    cv::theRNG().state = 7;
    cv::randu(noise, 0, 256);
    EXPECT_THAT(complaint(save(folder / "noise.png", noise)), HasSubstr("specks"));
}

TEST(ImageDamage, AMissingFileSaysSo) {
    const tests::TemporaryFolder folder;
    ShapeSource source;
    source.path = folder / "gone.png";
    EXPECT_THROW(read_shape<2>(source), ReadError);
}

}  // namespace
}  // namespace morphodesic::datasets

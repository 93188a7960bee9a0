#include <gif_lib.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "datasets/image_pixels.h"
#include "datasets/read_error.h"
#include "tests/datasets/test_pictures.h"
#include "tests/support/temporary_folder.h"

namespace morphodesic::datasets {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using tests::disk_error;
using tests::disk_picture;
using tests::read;
using tests::save;
using tests::toned;

using std::numbers::pi;

void write_gif(const std::filesystem::path& file, const cv::Mat& grey, int transparent) {
    int error = 0;
    GifFileType* gif = EGifOpenFileName(file.c_str(), false, &error);
    ASSERT_NE(gif, nullptr);
    std::vector<GifColorType> colours(256);
    for (int i = 0; i < 256; ++i)
        colours[static_cast<std::size_t>(i)] = {GifByteType(i), GifByteType(i), GifByteType(i)};
    ColorMapObject* map = GifMakeMapObject(256, colours.data());
    EGifPutScreenDesc(gif, grey.cols, grey.rows, 8, 0, map);
    if (transparent >= 0) {
        const GifByteType control[] = {1, 0, 0, GifByteType(transparent)};
        EGifPutExtension(gif, GRAPHICS_EXT_FUNC_CODE, sizeof control, control);
    }
    EGifPutImageDesc(gif, 0, 0, grey.cols, grey.rows, false, nullptr);
    for (int row = 0; row < grey.rows; ++row)
        EGifPutLine(gif, const_cast<GifByteType*>(grey.ptr<GifByteType>(row)), grey.cols);
    EGifCloseFile(gif, &error);
    GifFreeMapObject(map);
}

TEST(ImageReader, EveryFormatGivesTheSameDisk) {
    const tests::TemporaryFolder folder;
    const cv::Mat dark = toned(disk_picture(96, 47.3, 50.6, 25.4), 255, 0);
    std::vector<std::filesystem::path> exact;
    for (const char* name : {"a.png", "a.bmp", "a.tif", "a.tiff", "a.pgm"}) exact.push_back(save(folder / name, dark));
    exact.push_back(save(folder / "lossless.webp", dark, {cv::IMWRITE_WEBP_QUALITY, 101}));
    write_gif(folder / "a.gif", dark, -1);
    exact.push_back(folder / "a.gif");
    std::string digest;
    for (const auto& file : exact) {
        const RawShape<2> raw = read(file);
        EXPECT_LT(disk_error(raw, 47.3, 50.6, 25.4), 0.1) << file;
        EXPECT_THAT(raw.notes, IsEmpty()) << file;
        const std::string own = normalize(raw, {}).digest;
        if (digest.empty()) digest = own;
        EXPECT_EQ(own, digest) << file;
    }
    EXPECT_LT(disk_error(read(save(folder / "a.jpg", dark, {cv::IMWRITE_JPEG_QUALITY, 90})), 47.3, 50.6, 25.4), 0.25);
    EXPECT_LT(disk_error(read(save(folder / "lossy.webp", dark, {cv::IMWRITE_WEBP_QUALITY, 80})), 47.3, 50.6, 25.4),
              0.5);
    EXPECT_LT(disk_error(read(save(folder / "a.pbm", toned(disk_picture(96, 47.3, 50.6, 25.4, 1), 255, 0))), 47.3, 50.6,
                         25.4),
              0.5);
}

TEST(ImageReader, PolarityComesFromTheBorder) {
    const tests::TemporaryFolder folder;
    const cv::Mat disk = disk_picture(64, 30, 33, 20);
    const std::vector<std::pair<double, double>> tones = {{0, 255}, {255, 0}, {100, 140}, {140, 100}, {0, 1}, {1, 0}};
    for (const auto& [background, object] : tones) {
        const cv::Mat image =
            toned(std::abs(object - background) < 2 ? disk_picture(64, 30, 33, 20, 1) : disk, background, object);
        const RawShape<2> raw = read(save(folder / "a.png", image));
        EXPECT_LT(disk_error(raw, 30, 33, 20), 0.5) << background << " " << object;
        EXPECT_NEAR(raw.volume, pi * 400, 10) << background << " " << object;
    }
    // More than half of the picture is object, the border still tells.
    const cv::Mat large = toned(disk_picture(64, 32, 32, 30), 255, 0);
    EXPECT_NEAR(read(save(folder / "large.png", large)).volume, pi * 900, 10);
}

TEST(ImageReader, ForegroundCanBeOverruled) {
    const tests::TemporaryFolder folder;
    const auto file = save(folder / "a.png", toned(disk_picture(64, 32, 32, 20), 255, 0));
    ImportOptions options;
    options.foreground = "dark";
    EXPECT_NEAR(read(file, options).volume, pi * 400, 5);
    options.foreground = "light";
    EXPECT_NEAR(read(file, options).volume, 64 * 64 - pi * 400, 5);
    options.foreground = "alpha";
    EXPECT_THROW(read(file, options), ReadError);
    options.foreground = "green";
    EXPECT_THROW(read(file, options), std::invalid_argument);
}

TEST(ImageReader, SixteenBitsColourAndPaletteAreUnderstood) {
    const tests::TemporaryFolder folder;
    const cv::Mat disk = disk_picture(96, 47.3, 50.6, 25.4);
    EXPECT_LT(disk_error(read(save(folder / "full.png", toned(disk, 65535, 0, CV_16U))), 47.3, 50.6, 25.4), 0.1);
    EXPECT_LT(disk_error(read(save(folder / "12bit.tif", toned(disk, 200, 4000, CV_16U))), 47.3, 50.6, 25.4), 0.1);
    ImportOptions dark;
    dark.foreground = "dark";
    for (const double white : {300.0, 1000.0, 1023.0, 4095.0, 16383.0}) {  // cameras of 10, 12 and 14 bits
        const auto file = save(folder / ("camera-" + std::to_string(white) + ".pgm"), toned(disk, white, 0, CV_16U));
        EXPECT_LT(disk_error(read(file), 47.3, 50.6, 25.4), 0.1) << white;
        EXPECT_LT(disk_error(read(file, dark), 47.3, 50.6, 25.4), 0.1) << white;
    }
    EXPECT_LT(disk_error(read(save(folder / "float.tif", toned(disk, -3.0, 7.5, CV_32F))), 47.3, 50.6, 25.4), 0.1);
    cv::Mat with_gap = toned(disk, -3.0, 7.5, CV_64F);
    with_gap.at<double>(1, 1) = std::numeric_limits<double>::quiet_NaN();  // as GIS programs mark pixels without data
    EXPECT_LT(disk_error(read(save(folder / "double.tif", with_gap)), 47.3, 50.6, 25.4), 0.1);
    // Equal brightness, different colours: only a distance of colours sees the object.
    std::vector<cv::Mat> channels = {toned(disk, 20, 20), toned(disk, 70, 150), toned(disk, 230, 73)};
    cv::Mat colour;
    cv::merge(channels, colour);
    EXPECT_LT(disk_error(read(save(folder / "colour.png", colour)), 47.3, 50.6, 25.4), 0.1);
    // One bit per pixel, which PNG stores as palette indices or bits.
    const cv::Mat bits = toned(disk_picture(96, 47.3, 50.6, 25.4, 1), 255, 0);
    EXPECT_LT(disk_error(read(save(folder / "bits.png", bits, {cv::IMWRITE_PNG_BILEVEL, 1})), 47.3, 50.6, 25.4), 0.5);
}

TEST(ImageReader, APngIsTurnedAsItsExifDataSay) {
    const tests::TemporaryFolder folder;
    const std::vector<std::vector<std::uint8_t>> looked_at = {{1, 2, 3}, {4, 5, 6}};
    // How the six pixels are stored for each orientation: row 0 is the top (1 to 4) or a side (5 to 8) of what is seen.
    const std::vector<std::vector<std::vector<std::uint8_t>>> stored = {
        {{1, 2, 3}, {4, 5, 6}},   {{3, 2, 1}, {6, 5, 4}},   {{6, 5, 4}, {3, 2, 1}},   {{4, 5, 6}, {1, 2, 3}},
        {{1, 4}, {2, 5}, {3, 6}}, {{3, 6}, {2, 5}, {1, 4}}, {{6, 3}, {5, 2}, {4, 1}}, {{4, 1}, {5, 2}, {6, 3}}};
    for (std::size_t k = 0; k < stored.size(); ++k) {
        cv::Mat image(static_cast<int>(stored[k].size()), static_cast<int>(stored[k][0].size()), CV_8U);
        for (int row = 0; row < image.rows; ++row) {
            for (int column = 0; column < image.cols; ++column) {
                image.at<std::uint8_t>(row, column) =
                    stored[k][static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
            }
        }
        std::string bytes = tests::file_content(save(folder / "plain.png", image));
        const auto value = static_cast<char>(k + 1);
        const std::string big =
            std::string("MM\0*\0\0\0\x08\0\1\x01\x12\0\3\0\0\0\1\0", 19) + value + std::string(6, '\0');
        const std::string little =
            std::string("II*\0\x08\0\0\0\1\0\x12\1\3\0\1\0\0\0", 18) + value + std::string(7, '\0');
        for (const std::string& exif : {big, little}) {
            std::string chunk = std::string("\0\0\0", 3) + static_cast<char>(exif.size()) + "eXIf" + exif + "....";
            std::vector<std::string> notes;
            const PixelImage seen =
                read_pixels(folder.write("turned.png", bytes.substr(0, 33) + chunk + bytes.substr(33)), 1.0, notes);
            ASSERT_EQ(seen.width, 3) << k + 1;
            ASSERT_EQ(seen.height, 2) << k + 1;
            for (std::size_t p = 0; p < 6; ++p) EXPECT_EQ(seen.values[p], looked_at[p / 3][p % 3]) << k + 1;
            // Data that are cut off say nothing.
            chunk = std::string("\0\0\0\x0b", 4) + "eXIf" + exif.substr(0, 11) + "....";
            const PixelImage plain =
                read_pixels(folder.write("cut.png", bytes.substr(0, 33) + chunk + bytes.substr(33)), 1.0, notes);
            EXPECT_EQ(plain.values[0], stored[k][0][0]);
        }
    }
}

TEST(ImageReader, OfSeveralPagesTheFirstIsReadAndThatIsSaid) {
    const tests::TemporaryFolder folder;
    const cv::Mat first = toned(disk_picture(96, 47.3, 50.6, 25.4), 255, 0);
    const cv::Mat second = toned(disk_picture(96, 47.3, 50.6, 12.0), 255, 0);
    ASSERT_TRUE(cv::imwrite((folder / "pages.tif").string(), std::vector<cv::Mat>{first, second}));
    const RawShape<2> raw = read(folder / "pages.tif");
    EXPECT_LT(disk_error(raw, 47.3, 50.6, 25.4), 0.1);
    EXPECT_THAT(raw.notes, ElementsAre(HasSubstr("only the first")));
}

TEST(ImageReader, AnObjectOfSeveralColoursIsOneShape) {
    const tests::TemporaryFolder folder;
    cv::Mat colour(100, 100, CV_8UC3, cv::Scalar(250, 250, 250));
    colour(cv::Rect(20, 20, 30, 60)) = cv::Scalar(200, 30, 20);
    colour(cv::Rect(50, 20, 30, 60)) = cv::Scalar(30, 180, 120);
    EXPECT_NEAR(read(save(folder / "a.png", colour)).volume, 3600, 30);
}

TEST(ImageReader, TransparencyTellsTheObjectWhereTheBorderIsTransparent) {
    const tests::TemporaryFolder folder;
    const cv::Mat alpha = toned(disk_picture(96, 47.3, 50.6, 25.4), 0, 255);
    const cv::Mat black = cv::Mat::zeros(96, 96, CV_8U), white(96, 96, CV_8U, cv::Scalar(255));
    std::vector<cv::Mat> channels = {black, black, black, alpha};
    cv::Mat image;
    cv::merge(channels, image);
    EXPECT_LT(disk_error(read(save(folder / "transparent.png", image)), 47.3, 50.6, 25.4), 0.1);
    // Opaque everywhere: the colours count.
    channels = {alpha, alpha, alpha, white};
    cv::merge(channels, image);
    EXPECT_LT(disk_error(read(save(folder / "opaque.png", image)), 47.3, 50.6, 25.4), 0.1);
    channels = {white, white, white, black};
    cv::merge(channels, image);
    EXPECT_THROW(read(save(folder / "nothing.png", image)), ReadError);
    channels = {alpha, alpha, alpha, black};  // as of programs that leave the fourth byte empty
    cv::merge(channels, image);
    const RawShape<2> empty = read(save(folder / "empty.png", image));
    EXPECT_LT(disk_error(empty, 47.3, 50.6, 25.4), 0.1);
    EXPECT_THAT(empty.notes, ElementsAre(HasSubstr("alpha channel")));
    write_gif(folder / "transparent.gif", toned(disk_picture(96, 47.3, 50.6, 25.4, 1), 7, 200), 7);
    EXPECT_LT(disk_error(read(folder / "transparent.gif"), 47.3, 50.6, 25.4), 0.5);
}

TEST(ImageReader, AShapeAtTheBorderKeepsItsOutline) {
    const tests::TemporaryFolder folder;
    const auto inside = [](double x, double y) {
        return x < 30 && y > 24 && y < 40;
    };  // leaves the picture on the left
    const RawShape<2> raw = read(save(folder / "a.png", toned(tests::picture(64, 64, 1, inside), 255, 0)));
    EXPECT_NEAR(raw.volume, 30 * 16, 1.0);
    EXPECT_NEAR(raw.centroid[0], 15.0, 0.05);
    EXPECT_NEAR(raw.centroid[1], 32.0, 0.05);
    EXPECT_NEAR(raw.extent_radius, std::hypot(15.0, 8.0), 0.5);
    // The same with free space around it is the same shape.
    const auto moved = [&](double x, double y) { return x > 20 && inside(x - 20, y - 11); };
    const RawShape<2> free = read(save(folder / "b.png", toned(tests::picture(90, 90, 1, moved), 255, 0)));
    const auto u = normalize(raw, {}).level_set, v = normalize(free, {}).level_set;
    for (std::size_t i = 0; i < u.values.size(); ++i) EXPECT_NEAR(u.values[i], v.values[i], 1e-6);
    // If most of the border is object, that is doubtful and said so.
    const auto most = [](double x, double y) { return y < 40 && x < 64; };
    EXPECT_THAT(read(save(folder / "c.png", toned(tests::picture(64, 64, 1, most), 255, 0))).notes,
                Contains(HasSubstr("border")));
}

TEST(ImageReader, PartsAndHolesStaySpecksGo) {
    const tests::TemporaryFolder folder;
    cv::Mat image(200, 200, CV_8U, cv::Scalar(255));
    image(cv::Rect(20, 20, 100, 100)) = 0;
    image(cv::Rect(40, 40, 20, 20)) = 255;  // a hole
    image(cv::Rect(140, 140, 20, 20)) = 0;  // a part
    image(cv::Rect(100, 100, 1, 1)) = 255;  // a pinhole
    image(cv::Rect(10, 190, 2, 2)) = 0;     // a speck
    const auto file = save(folder / "a.png", image);
    const RawShape<2> raw = read(file);
    EXPECT_NEAR(raw.volume, 10000 - 400 + 400, 3.0);
    EXPECT_THAT(raw.notes, Contains(HasSubstr("1 specks and 1 pinholes")));
    const auto u = normalize(raw, {"none", 0.0, 6}).level_set;
    EXPECT_LT(u.values[u.grid.index({16, 48})], 0.0);  // in the hole
    EXPECT_GT(u.values[u.grid.index({48, 16})], 0.0);  // in the part
    EXPECT_LT(u.values[u.grid.index({3, 3})], 0.0);    // on the speck
    ImportOptions all;
    all.speck_fraction = 0.0;
    EXPECT_NEAR(read(file, all).volume, 10000 - 1 + 4, 3.0);
    EXPECT_THAT(read(file, all).notes, IsEmpty());
}

TEST(ImageReader, TheMaskBesideAnImageTellsWhereItIsHidden) {
    const tests::TemporaryFolder folder;
    const auto file = save(folder / "q.png", toned(disk_picture(64, 32, 32, 15), 255, 0));
    EXPECT_TRUE(normalize(read(file), {}).occlusion_mask.values.empty());
    const std::string open = normalize(read(file), {"none", 0.0, 6}).digest;
    cv::Mat mask = cv::Mat::zeros(64, 64, CV_8U);
    mask(cv::Rect(40, 0, 24, 64)) = 255;  // right of x = 40, and beyond the image as well
    save(folder / "q.mask.png", mask);
    const Shape<2> shape = normalize(read(file), {"none", 0.0, 6});
    const auto& chi = shape.occlusion_mask;
    ASSERT_EQ(chi.values.size(), shape.level_set.values.size());
    EXPECT_EQ(chi.values[chi.grid.index({30, 32})], 1.0);
    EXPECT_EQ(chi.values[chi.grid.index({50, 32})], 0.0);
    EXPECT_EQ(chi.values[chi.grid.index({64, 0})], 0.0);
    EXPECT_NEAR(chi.values[chi.grid.index({40, 32})], 0.5, 0.2);
    EXPECT_NE(shape.digest, open);
    save(folder / "q.mask.png", mask / 255);  // 0 and 1, as programs write truth values
    EXPECT_EQ(normalize(read(file), {"none", 0.0, 6}).digest, shape.digest);
    EXPECT_THAT(read(file).notes, Contains(HasSubstr("two tones")));
    save(folder / "q.mask.png", mask(cv::Rect(0, 0, 32, 64)));
    EXPECT_THROW(read(file), ReadError);
}

TEST(ImageReader, AMaskThatLeavesNothingToSeeIsNamedAsTheCause) {
    const tests::TemporaryFolder folder;
    const auto file = save(folder / "a.png", toned(disk_picture(64, 30, 33, 20), 255, 0));
    const auto problem_with_mask = [&](const cv::Mat& mask) {
        save(folder / "a.mask.png", toned(mask, 0, 255));
        try {
            (void)read(file);
        } catch (const ReadError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    for (const double radius : {100.0, 24.0}) {  // all of the picture; the shape
        const std::string problem = problem_with_mask(disk_picture(64, 30, 33, radius));
        EXPECT_THAT(problem, HasSubstr("the mask")) << radius;
        EXPECT_THAT(problem, HasSubstr("white = hidden")) << radius;
    }
    const cv::Mat object_only = 1.0 - disk_picture(64, 30, 33, 15);
    EXPECT_THAT(problem_with_mask(object_only), HasSubstr("has only one colour; let the mask"));
    EXPECT_EQ(problem_with_mask(disk_picture(64, 30, 33, 10)), "");
}

TEST(ImageReader, AShapeOfLessThanAPixelIsNotOneOfNone) {
    const tests::TemporaryFolder folder;
    cv::Mat dot(9, 9, CV_8U, cv::Scalar(255));
    dot.at<std::uint8_t>(4, 4) = 0;
    EXPECT_THAT(read(save(folder / "dot.png", dot)).notes, Contains(HasSubstr("an area of only 0.5 pixels")));
}

TEST(ImageReader, NoiseAndUnevenLightDoNotHideTheObject) {
    const tests::TemporaryFolder folder;
    const cv::Mat disk = disk_picture(200, 90, 105, 40);
    cv::Mat noise(200, 200, CV_32F), light(200, 200, CV_32F);
    cv::theRNG().state = 3;
    cv::randn(noise, 0, 15);
    const RawShape<2> noisy = read(save(folder / "noise.png", toned(disk, 200, 60, CV_32F) + noise));
    EXPECT_NEAR(noisy.volume, pi * 1600, 0.01 * pi * 1600);
    // The far side of the background is darker than the object would be on the near side.
    for (int y = 0; y < 200; ++y) {
        for (int x = 0; x < 200; ++x)
            light.at<float>(y, x) = 140.0F + 0.4F * static_cast<float>(x) + 0.1F * static_cast<float>(y);
    }
    cv::Mat lit = light.mul(1.0 - 0.5 * disk);
    lit.convertTo(lit, CV_8U);
    const RawShape<2> raw = read(save(folder / "light.png", lit));
    EXPECT_NEAR(raw.volume, pi * 1600, 0.02 * pi * 1600);
    EXPECT_THAT(raw.notes, Contains(HasSubstr("unevenly")));
}

TEST(ImageReader, AFrameAroundThePictureIsLeftOut) {
    const tests::TemporaryFolder folder;
    const cv::Mat disk = toned(disk_picture(200, 90, 105, 40), 255, 0);
    for (const auto& [inset, width] : {std::make_pair(0, 1), std::make_pair(0, 4), std::make_pair(5, 2)}) {
        cv::Mat framed = disk.clone();
        for (int k = inset; k < inset + width; ++k)
            cv::rectangle(framed, cv::Point(k, k), cv::Point(199 - k, 199 - k), 0);
        const RawShape<2> raw = read(save(folder / "a.png", framed));
        EXPECT_NEAR(raw.volume, pi * 1600, 0.01 * pi * 1600) << inset << " " << width;
        EXPECT_THAT(raw.notes, Contains(HasSubstr("frame")));
    }
    // A filled rectangle with a thin margin is not a frame.
    cv::Mat filled(200, 200, CV_8U, cv::Scalar(255));
    filled(cv::Rect(3, 3, 194, 194)) = 0;
    EXPECT_NEAR(read(save(folder / "b.png", filled)).volume, 194 * 194, 5);
}

TEST(ImageReader, AnOccluderIsFoundByItsColour) {
    const tests::TemporaryFolder folder;
    cv::Mat grey = toned(disk_picture(64, 32, 32, 15), 255, 0), image;
    grey(cv::Rect(40, 0, 24, 64)) = 128;  // a wall to the right; edges of the disk are grey as well
    const auto file = save(folder / "a.png", grey);
    ImportOptions options;
    options.occluder = "#808080";
    const Shape<2> shape = normalize(read(file, options), {"none", 0.0, 6});
    const auto& chi = shape.occlusion_mask;
    ASSERT_FALSE(chi.values.empty());
    EXPECT_EQ(chi.values[chi.grid.index({30, 32})], 1.0);
    EXPECT_EQ(chi.values[chi.grid.index({25, 45})], 1.0);
    EXPECT_EQ(chi.values[chi.grid.index({45, 32})], 0.0);
    EXPECT_GT(shape.level_set.values[chi.grid.index({30, 32})], 0.0);
    EXPECT_LT(shape.level_set.values[chi.grid.index({45, 32})], 0.0);
    EXPECT_LT(shape.level_set.values[chi.grid.index({60, 60})], 0.0);
    // The same with transparency in place of the colour.
    cv::Mat alpha(64, 64, CV_8U, cv::Scalar(255));
    alpha(cv::Rect(40, 0, 24, 64)) = 0;
    std::vector<cv::Mat> channels = {grey, grey, grey, alpha};
    cv::merge(channels, image);
    options.occluder = "alpha";
    EXPECT_EQ(normalize(read(save(folder / "b.png", image), options), {"none", 0.0, 6}).digest, shape.digest);
    options.occluder = "grey";
    EXPECT_THROW(read(file, options), std::invalid_argument);
    options.occluder = "#ff0000";
    const RawShape<2> whole = read(save(folder / "c.png", toned(disk_picture(64, 32, 32, 15), 255, 0)), options);
    EXPECT_THAT(whole.notes, Contains(HasSubstr("Nothing is hidden")));
    EXPECT_TRUE(normalize(whole, {"none", 0.0, 6}).occlusion_mask.values.empty());  // or it would count as occluded
}

TEST(ImageReader, ABorderThatCutsTheShapeOffCanHideWhatIsBeyond) {
    const tests::TemporaryFolder folder;
    const auto file = save(folder / "a.png", toned(disk_picture(64, 60, 32, 20), 255, 0));
    EXPECT_TRUE(normalize(read(file), {}).occlusion_mask.values.empty());
    ImportOptions options;
    options.border = "hides";
    NormalizeOptions centred;
    centred.scale = 0.01;  // the cube reaches beyond the image on all sides
    const RawShape<2> raw = read(file, options);
    EXPECT_THAT(raw.notes, Contains(HasSubstr("Cut off")));
    const auto chi = normalize(raw, centred).occlusion_mask;
    ASSERT_FALSE(chi.values.empty());
    EXPECT_EQ(chi.values[chi.grid.index({63, 32})], 0.0);  // beyond the right side
    EXPECT_EQ(chi.values[chi.grid.index({1, 32})], 1.0);   // beyond the left side nothing is cut off
    EXPECT_EQ(chi.values[chi.grid.index({32, 32})], 1.0);
    EXPECT_TRUE(normalize(read(save(folder / "b.png", toned(disk_picture(64, 32, 32, 20), 255, 0)), options), {})
                    .occlusion_mask.values.empty());
}

TEST(ImageReader, PngIsWrittenAsItIsRead) {
    const tests::TemporaryFolder folder;
    for (const int channels : {1, 3, 4}) {
        PixelImage image{3, 2, channels, 255.0, {}};
        for (int i = 0; i < 6 * channels; ++i) image.values.push_back(static_cast<std::uint16_t>(10 * i));
        write_png(folder / "a.png", image);
        std::vector<std::string> notes;
        EXPECT_EQ(read_pixels(folder / "a.png", 1.0, notes).values, image.values) << channels;
    }
    EXPECT_THROW(write_png(folder / "gone/a.png", PixelImage{1, 1, 1, 255.0, {0}}), WriteError);
}

}  // namespace
}  // namespace morphodesic::datasets

// The program computes figures 2 and 3 on coarse grids; the numbers that prove them are recomputed from the CSV files.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>

#include "pipeline/cli.h"
#include "pipeline/figures/sphere_geodesic.h"
#include "tests/support/temporary_folder.h"

namespace morphodesic::pipeline {
namespace {

using Row = std::map<std::string, std::string>;

std::vector<std::string> cells(const std::string& line) {
    std::vector<std::string> result;
    std::stringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');) result.push_back(cell);
    return result;
}

std::vector<Row> read_csv(const std::filesystem::path& file) {
    std::ifstream stream(file);
    std::string line;
    std::getline(stream, line);
    const auto names = cells(line);
    std::vector<Row> rows;
    while (std::getline(stream, line)) {
        const auto values = cells(line);
        Row& row = rows.emplace_back();
        for (std::size_t i = 0; i < names.size() && i < values.size(); ++i) row[names[i]] = values[i];
    }
    return rows;
}

std::string start_of(const std::filesystem::path& file, std::size_t bytes) {
    std::ifstream stream(file, std::ios::binary);
    std::string text(bytes, '\0');
    stream.read(text.data(), static_cast<std::streamsize>(bytes));
    text.resize(static_cast<std::size_t>(stream.gcount()));
    return text;
}

class Figures : public testing::Test {
protected:
    static void SetUpTestSuite() {
        folder_ = std::make_unique<tests::TemporaryFolder>();
        code_ = run_program({"figures", "2", "3", "--quick", "--quiet", "--out", folder_->path().string()});
    }
    static void TearDownTestSuite() { folder_.reset(); }
    static std::filesystem::path file(const std::string& name) { return folder_->path() / name; }

    static inline std::unique_ptr<tests::TemporaryFolder> folder_;
    static inline int code_ = -1;
};

TEST_F(Figures, EveryFigureHasPictureTableAndPage) {
    ASSERT_EQ(code_, 0);
    for (const std::string name : {"figure-2", "figure-3"}) {
        EXPECT_EQ(start_of(file(name + ".png"), 4), "\x89PNG") << name;
        EXPECT_EQ(start_of(file(name + ".svg"), 5), "<?xml") << name;
    }
    std::ifstream page(file("gallery.html"));
    std::stringstream text;
    text << page.rdbuf();
    EXPECT_NE(text.str().find("figure-2.png"), std::string::npos);
    EXPECT_NE(text.str().find("figure-3.csv"), std::string::npos);
}

TEST_F(Figures, TheBarRollsUpAndKeepsItsLengthAndWidth) {
    ASSERT_EQ(code_, 0);
    const auto rows = read_csv(file("figure-2.csv"));
    std::map<int, double> length_of_path;
    double least = 1e300, most = 0;
    for (const Row& row : rows) {
        length_of_path[std::stoi(row.at("steps_K"))] = std::stod(row.at("path_length"));
        const double area = std::stod(row.at("area")), perimeter = std::stod(row.at("perimeter"));
        const double pi = std::numbers::pi;
        const double width = (perimeter - std::sqrt(perimeter * perimeter - 4 * pi * area)) / pi;
        const double length = 0.5 * (perimeter - pi * width);
        EXPECT_NEAR(width, std::stod(row.at("bar_width")), 1e-9);
        EXPECT_NEAR(length, std::stod(row.at("bar_length")), 1e-9);
        if (row.at("steps_K") != "4") continue;
        least = std::min(least, length);
        most = std::max(most, length);
    }
    ASSERT_EQ(length_of_path.size(), 3U);  // K = 1, 2, 4
    EXPECT_NEAR(length_of_path[4], length_of_path[2], 0.1 * length_of_path[4]) << "the length settles with K";
    EXPECT_LT(most / least, 1.25) << "a rolling bar is bent, not stretched";
}

TEST_F(Figures, TheCascadeOnTheSphereSavesMostSteps) {
    ASSERT_EQ(code_, 0);
    long single = 0, cascade = 0;
    double deviation = 1e300;
    int rows_of_cascade = 0;
    for (const Row& row : read_csv(file("figure-3.csv"))) {
        if (row.at("tolerance_radians") != "3e-05") continue;
        if (row.at("method") == "single_level") {
            single = std::stol(row.at("relaxation_steps"));
        } else {
            ++rows_of_cascade;
            cascade += std::stol(row.at("relaxation_steps"));
            deviation = std::stod(row.at("largest_deviation_radians"));
        }
    }
    EXPECT_EQ(rows_of_cascade, 7);  // K = 1, 2, ..., 64
    EXPECT_GT(cascade, 63);
    EXPECT_GT(single, 20 * cascade);
    EXPECT_LT(deviation, 0.01);
}

TEST(SphereGeodesic, ConvergesToTheGreatCircle) {
    const StereographicMap map(GeographicPosition{90, 0});
    const auto a = StereographicMap::sphere({-26.2, 28.05}), b = StereographicMap::sphere({35.01, 135.77});
    const auto levels = cascadic_geodesics(map, map.to_plane(a), map.to_plane(b), 16, 1e-10);
    const SpherePath& path = levels.back();
    const double angle = great_circle_distance(a, b);
    EXPECT_NEAR(path.length, angle, 1e-12);
    EXPECT_LT(path.largest_deviation, 1e-6);
    // Equal chords: 16 of them.
    EXPECT_NEAR(path.energy, 16 * 16 * std::pow(2 * std::sin(angle / 32), 2), 1e-12);
}

TEST(SphereGeodesic, MapIsInvertible) {
    const StereographicMap map(GeographicPosition{12, 84});
    for (const GeographicPosition at :
         {GeographicPosition{-26, 28}, GeographicPosition{35, 136}, GeographicPosition{80, -20}}) {
        const auto x = StereographicMap::sphere(at);
        EXPECT_LT(great_circle_distance(map.to_sphere(map.to_plane(x)), x), 1e-14);
    }
}

TEST(FiguresCommand, UnknownFigureIsRefused) {
    EXPECT_EQ(run_program({"figures", "99", "--quick", "--quiet", "--out", "no-such-folder"}), 2);
    EXPECT_FALSE(std::filesystem::exists("no-such-folder"));
}

}  // namespace
}  // namespace morphodesic::pipeline

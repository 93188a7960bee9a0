// The program computes every figure on coarse grids; the numbers that prove them are recomputed from the CSV files.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>

#include "datasets/csv_rows.h"
#include "pipeline/cli.h"
#include "pipeline/figures/coastlines.h"
#include "pipeline/figures/sphere_geodesic.h"
#include "tests/support/temporary_folder.h"

namespace morphodesic::pipeline {
namespace {

using Row = std::map<std::string, std::string>;

/// Each record of a table by the names of its columns.
std::vector<Row> read_csv(const std::filesystem::path& file) {
    const auto records = datasets::read_csv(file);
    std::vector<Row> rows(records.empty() ? 0 : records.size() - 1);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto &names = records.front().fields, &values = records[i + 1].fields;
        EXPECT_EQ(values.size(), names.size()) << file << ", line " << records[i + 1].line;
        for (std::size_t c = 0; c < std::min(names.size(), values.size()); ++c) rows[i][names[c]] = values[c];
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
        code_ = run_program({"figures", "--quick", "--quiet", "--out", folder_->path().string(), "--markdown",
                             (folder_->path() / "docs" / "report.md").string()});
    }
    static void TearDownTestSuite() { folder_.reset(); }
    static std::filesystem::path file(const std::string& name) { return folder_->path() / name; }

    static inline std::unique_ptr<tests::TemporaryFolder> folder_;
    static inline int code_ = -1;
};

TEST_F(Figures, EveryFigureHasPictureTableAndPage) {
    ASSERT_EQ(code_, 0);
    for (const std::string name :
         {"figure-1", "figure-2", "figure-3", "figure-4", "figure-5", "figure-6", "figure-7", "figure-8", "figure-9",
          "convergence", "accuracy", "two-geodesics", "disk", "animation"}) {
        EXPECT_EQ(start_of(file(name + ".png"), 4), "\x89PNG") << name;
        EXPECT_EQ(start_of(file(name + ".svg"), 5), "<?xml") << name;
    }
    std::ifstream page(file("gallery.html"));
    std::stringstream text;
    text << page.rdbuf();
    EXPECT_NE(text.str().find("figure-2.png"), std::string::npos);
    EXPECT_NE(text.str().find("figure-3.csv"), std::string::npos);
    EXPECT_EQ(text.str().find("not met"), std::string::npos);
    for (const std::string name : {"figure-6", "animation"}) {
        const std::string moving = start_of(file(name + ".webp"), 1 << 12);
        EXPECT_EQ(moving.substr(0, 4) + moving.substr(8, 4), "RIFFWEBP") << name;
        EXPECT_NE(moving.find("ANMF"), std::string::npos) << name << " has no frames";
    }
}

/// The rows of a table of paths, by the name of the path, in the order of the steps.
std::map<std::string, std::vector<Row>> paths_of(const std::filesystem::path& csv) {
    std::map<std::string, std::vector<Row>> paths;
    for (const Row& row : read_csv(csv)) paths[row.at("path")].push_back(row);
    return paths;
}

double path_length(const std::vector<Row>& path) {
    return std::stod(path.front().at("path_length"));
}

TEST_F(Figures, LengthsAreTheSumsOfTheirSteps) {
    ASSERT_EQ(code_, 0);
    for (const std::string name : {"figure-1", "figure-4", "figure-6", "figure-7", "figure-8", "two-geodesics"}) {
        int checked = 0;
        for (const auto& [path, rows] : paths_of(file(name + ".csv"))) {
            if (rows.size() < 2) continue;  // shares of an area
            ++checked;
            double sum = 0, energy = 0;
            for (const Row& row : rows) {
                if (row.at("step_length").empty()) continue;  // of the first shape
                const double length = std::stod(row.at("step_length"));
                sum += length;
                energy += static_cast<double>(rows.size() - 1) * length * length;
                EXPECT_NEAR(length * length, std::stod(row.at("deformation_energy")), 1e-9) << name << ": " << path;
            }
            EXPECT_NEAR(sum, path_length(rows), 1e-9) << name << ": " << path;
            EXPECT_NEAR(energy, std::stod(rows.front().at("path_energy")), 1e-9) << name << ": " << path;
            EXPECT_LE(sum * sum, energy * (1 + 1e-9)) << name << ": " << path;
        }
        EXPECT_GT(checked, 0) << name;
    }
}

TEST_F(Figures, TheFeetOfTheAAreClosedAndAnimalsStayInOnePiece) {
    ASSERT_EQ(code_, 0);
    const auto paths = paths_of(file("figure-1.csv"));
    const auto &letters = paths.at("A to B"), &animals = paths.at("cat to lion");
    EXPECT_EQ(letters.front().at("euler_number"), "0");
    EXPECT_EQ(letters.back().at("euler_number"), "-1");
    for (const Row& row : letters) EXPECT_EQ(row.at("parts"), "1");
    // Figure 6 cuts the same solids open.
    const auto cut = paths_of(file("figure-6.csv")).at("cat to lion");
    ASSERT_EQ(cut.size(), animals.size());
    for (std::size_t k = 0; k < cut.size(); ++k) {
        EXPECT_EQ(cut[k].at("step_length"), animals[k].at("step_length"));
        EXPECT_GT(std::stod(cut[k].at("volume")), k == 0 ? 0.0 : std::stod(cut[k - 1].at("volume")));
    }
}

TEST_F(Figures, WhatIsStretchedGrowsAndWhatIsBentDoesNot) {
    ASSERT_EQ(code_, 0);
    auto paths = paths_of(file("figure-4.csv"));
    const auto &stretched = paths.at("stretching"), &bent = paths.at("bending");
    for (std::size_t k = 1; k < stretched.size(); ++k) {
        EXPECT_GT(std::stod(stretched[k].at("area")), 1.05 * std::stod(stretched[k - 1].at("area")));
    }
    const double area = std::stod(bent.front().at("area"));
    for (const Row& row : bent) EXPECT_NEAR(std::stod(row.at("area")), area, 0.02 * area);
    EXPECT_LT(2 * path_length(bent), path_length(stretched));
}

TEST_F(Figures, AMaskBringsHiddenLimbsBack) {
    ASSERT_EQ(code_, 0);
    const auto paths = paths_of(file("figure-8.csv"));
    const auto &full = paths.at("nothing hidden"), &masked = paths.at("hidden, with mask"),
               &blind = paths.at("hidden, without mask");
    const auto area = [](const Row& row) { return std::stod(row.at("area")); };
    EXPECT_LT(area(masked[0]), 0.8 * area(full[0])) << "limbs are hidden";
    EXPECT_NEAR(area(masked[1]), area(full[1]), 0.05 * area(full[1])) << "they are there after one step";
    EXPECT_LT(area(blind[1]), 0.85 * area(full[1])) << "and are not without a mask";
    EXPECT_LT(path_length(masked), path_length(full)) << "a pose that is free costs nothing";
    EXPECT_GT(path_length(blind), 1.2 * path_length(full));
}

TEST_F(Figures, TwoGeodesicsAreRankedByEnergyAndCloseTheFeetAtOtherTimes) {
    ASSERT_EQ(code_, 0);
    double last = 0;
    std::map<std::string, int> shown;
    for (const Row& row : read_csv(file("two-geodesics-starts.csv"))) {
        const double energy = std::stod(row.at("total_energy"));
        EXPECT_GE(energy, last);
        last = energy;
        if (row.at("shown") == "shown") ++shown[row.at("euler_numbers")];
    }
    EXPECT_EQ(shown.size(), 2U) << "two that differ in topology";
    const auto paths = paths_of(file("two-geodesics.csv"));
    EXPECT_LT(path_length(paths.at("lower")), path_length(paths.at("higher")));
}

TEST_F(Figures, TheAnimationGoesOnBetweenItsTimeSteps) {
    ASSERT_EQ(code_, 0);
    const auto frames = read_csv(file("animation.csv"));
    ASSERT_GT(frames.size(), 8U);
    const auto number = [&](std::size_t i, const char* column) { return std::stod(frames[i].at(column)); };
    EXPECT_EQ(number(0, "t"), 0.0);
    EXPECT_EQ(number(frames.size() - 1, "t"), 1.0);
    for (std::size_t i = 1; i < frames.size(); ++i) {
        EXPECT_GT(number(i, "t"), number(i - 1, "t"));
        EXPECT_NEAR(number(i, "area"), number(i - 1, "area"), 0.05 * number(0, "area")) << "frame " << i << " jumps";
    }
}

TEST_F(Figures, TheAccuracyReportComparesWithClosedForms) {
    ASSERT_EQ(code_, 0);
    std::map<std::string, int> studies;
    double last = 1e300;
    for (const Row& row : read_csv(file("accuracy.csv"))) {
        ++studies[row.at("study")];
        if (row.at("study") != "closed form 2D") continue;
        const double exact = std::sqrt(std::numbers::pi * 8.0) * 0.05;
        EXPECT_NEAR(std::stod(row.at("reference")), exact, 1e-9);
        const double error = std::abs(std::stod(row.at("path_length")) - exact);
        EXPECT_NEAR(std::abs(std::stod(row.at("deviation"))), error / exact, 1e-9);
        EXPECT_LE(error, std::stod(row.at("error_bar")));
        EXPECT_LT(error, last);
        last = error;
    }
    for (const std::string study : {"closed form 2D", "closed form 3D", "time steps", "reversed", "moved"}) {
        EXPECT_GE(studies[study], 1) << study;
    }
    const std::string report = start_of(folder_->path() / "docs" / "report.md", 1 << 20);
    EXPECT_NE(report.find("![What path lengths are off by](accuracy.svg)"), std::string::npos);
    EXPECT_NE(report.find("| closed form 2D | balls 0.20 and 0.25 | 5 |"), std::string::npos);
    EXPECT_EQ(report.find("**not met**"), std::string::npos);
    EXPECT_EQ(start_of(folder_->path() / "docs" / "accuracy.svg", 5), "<?xml");
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
        if (row.at("stop") != "distance") continue;
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
    EXPECT_LE(deviation, 1e-3);
}

TEST_F(Figures, DumbbellsThatKeepTheirVolumeSendItThroughTheNeck) {
    ASSERT_EQ(code_, 0);
    std::map<std::string, std::vector<double>> left, whole, divergence;
    for (const Row& row : read_csv(file("figure-5.csv"))) {
        const std::string& ratio = row.at("lambda_over_mu");
        left[ratio].push_back(std::stod(row.at("left_end_area")));
        whole[ratio].push_back(std::stod(row.at("area")));
        EXPECT_NEAR(left[ratio].back() + std::stod(row.at("right_end_area")), whole[ratio].back(), 1e-9);
        if (!row.at("rms_div_v").empty()) {  // the last shape has no step
            divergence[ratio].push_back(std::stod(row.at("rms_div_v")) / std::stod(row.at("rms_strain_rate")));
        }
    }
    for (const std::string ratio : {"0.01", "100"}) {
        ASSERT_EQ(left[ratio].size(), 5U) << ratio;
        EXPECT_GT(left[ratio].front(), 1.3 * left[ratio].back()) << "the left end is the larger one first";
    }
    for (std::size_t k = 0; k < 4; ++k) {
        EXPECT_GT(divergence["0.01"][k], 0.5);
        EXPECT_LT(divergence["100"][k], 0.25);
    }
    for (const double area : whole["100"]) EXPECT_NEAR(area, whole["100"][0], 0.03 * whole["100"][0]);
}

TEST_F(Figures, TheContourTermRoundsAndKeepsCracksAway) {
    ASSERT_EQ(code_, 0);
    const auto paths = paths_of(file("figure-7.csv"));
    ASSERT_EQ(paths.size(), 4U);
    const auto excess = [](const std::vector<Row>& path) {
        const double first = std::stod(path.front().at("perimeter")), last = std::stod(path.back().at("perimeter"));
        double most = -1;
        for (std::size_t k = 1; k + 1 < path.size(); ++k) {
            const double t = static_cast<double>(k) / static_cast<double>(path.size() - 1);
            most = std::max(most, std::stod(path[k].at("perimeter")) / (first + t * (last - first)) - 1);
        }
        return most;
    };
    const auto& smooth = paths.at("nu = 0.005; mu = 0.03; area kept");
    EXPECT_LT(excess(smooth), 0.0);
    EXPECT_LT(excess(smooth), excess(paths.at("nu = 0; mu = 1")));
    const double area = std::stod(smooth.front().at("area"));
    for (const Row& row : smooth) {
        EXPECT_NEAR(std::stod(row.at("area")), area, 0.005 * area);
    }
}

TEST_F(Figures, LettersAndFeetClusterAsInThePaper) {
    ASSERT_EQ(code_, 0);
    std::map<std::string, double> volume;
    double within = 0, between = 1e300, feet = 0, fourth = 1e300;
    for (const Row& row : read_csv(file("figure-9.csv"))) {
        const std::string &a = row.at("a"), &b = row.at("b");
        if (!row.at("volume").empty()) volume[a] = std::stod(row.at("volume"));  // empty for pairs
        if (b.empty() || a == b) continue;
        const double distance = std::stod(row.at("distance"));
        if (row.at("collection") == "feet") {
            const bool to_fourth = a == "foot 4" || b == "foot 4";
            (to_fourth ? fourth : feet) = to_fourth ? std::min(fourth, distance) : std::max(feet, distance);
        } else if (a[0] == b[0]) {
            within = std::max(within, distance);
        } else if (a[0] != 'M' && b[0] != 'M') {
            between = std::min(between, distance);
        }
    }
    EXPECT_LT(within, between);
    EXPECT_LT(1.5 * feet, fourth);
    EXPECT_NEAR(volume.at("foot 2"), 0.87 * volume.at("foot 1"), 1e-3 * volume.at("foot 1"));
    EXPECT_NEAR(volume.at("foot 3"), volume.at("foot 2"), 1e-3 * volume.at("foot 1"));
    EXPECT_NEAR(volume.at("foot 4"), volume.at("foot 1"), 1e-3 * volume.at("foot 1"));
}

double signed_area(const Coast& coast) {
    double sum = 0;
    for (std::size_t i = 0; i < coast.size(); ++i) {
        const auto &p = coast[i], &q = coast[(i + 1) % coast.size()];
        sum += 0.5 * (p.longitude * q.latitude - q.longitude * p.latitude);
    }
    return sum;
}

bool on_land(const GeographicPosition& at) {
    bool inside = false;
    for (const auto* coasts : {&coastlines(), &inland_seas()}) {
        for (const Coast& coast : *coasts) {
            for (std::size_t i = 0; i < coast.size(); ++i) {
                const auto &p = coast[i], &q = coast[(i + 1) % coast.size()];
                if ((p.latitude > at.latitude) == (q.latitude > at.latitude)) continue;
                const double t = (at.latitude - p.latitude) / (q.latitude - p.latitude);
                if (p.longitude + t * (q.longitude - p.longitude) > at.longitude) inside = !inside;
            }
        }
    }
    return inside;
}

TEST(Coastlines, PutCitiesOnLandAndShipsOnWater) {
    for (const GeographicPosition city :
         {GeographicPosition{-26.2, 28.05}, GeographicPosition{35.01, 135.77}, GeographicPosition{48.9, 2.3},
          GeographicPosition{55.8, 37.6}, GeographicPosition{28.6, 77.2}, GeographicPosition{39, -95},
          GeographicPosition{-15.8, -47.9}, GeographicPosition{-25, 134}, GeographicPosition{24.7, 46.7}}) {
        EXPECT_TRUE(on_land(city)) << city.latitude << " " << city.longitude;
    }
    for (const GeographicPosition ship :
         {GeographicPosition{0, 70}, GeographicPosition{35, 18}, GeographicPosition{43, 34},
          GeographicPosition{30, -40}, GeographicPosition{15, 65}, GeographicPosition{42, 51},
          GeographicPosition{0, -130}, GeographicPosition{38.5, 134}}) {
        EXPECT_FALSE(on_land(ship)) << ship.latitude << " " << ship.longitude;
    }
    for (const Coast& coast : coastlines()) EXPECT_GT(std::abs(signed_area(coast)), 0.4);
}

TEST(SphereGeodesic, ConvergesToTheGreatCircle) {
    const StereographicMap map(GeographicPosition{90, 0});
    const auto a = StereographicMap::sphere({-26.2, 28.05}), b = StereographicMap::sphere({35.01, 135.77});
    const auto levels =
        cascadic_geodesics(map, map.to_plane(a), map.to_plane(b), 16, {RelaxationStop::Measure::move, 1e-10});
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

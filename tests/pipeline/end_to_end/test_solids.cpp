// Whole runs of the program on solids.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "analysis/csv.h"
#include "analysis/matrix_csv.h"
#include "program.h"

namespace morphodesic::tests {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

void make_feet(const fs::path& folder, int n) {
    const Outcome made =
        morphodesic({"datasets", "feet", "--out", folder.string(), "--count", std::to_string(n), "--quiet"});
    ASSERT_EQ(made.code, 0) << made.err;
}

/// A ball as an OBJ file: an octahedron, its triangles divided five times, all points on the sphere.
std::string ball_obj(double radius, double centre) {
    using P = std::array<double, 3>;
    std::vector<P> points{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    std::vector<std::array<std::size_t, 3>> faces{{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                                  {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> middles;
    const auto middle = [&](std::size_t a, std::size_t b) {
        const auto [it, fresh] = middles.try_emplace(std::minmax(a, b), points.size());
        if (fresh) {
            P m{};
            double length = 0.0;
            for (std::size_t c = 0; c < 3; ++c) m[c] = points[a][c] + points[b][c], length += m[c] * m[c];
            for (double& x : m) x /= std::sqrt(length);
            points.push_back(m);
        }
        return it->second;
    };
    for (int halving = 0; halving < 5; ++halving) {
        std::vector<std::array<std::size_t, 3>> finer;
        for (const auto& [a, b, c] : faces) {
            const std::size_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
        }
        faces = std::move(finer);
    }
    std::ostringstream text;
    text.precision(12);
    for (const P& p : points) {
        text << "v " << centre + radius * p[0] << ' ' << centre + radius * p[1] << ' ' << centre + radius * p[2]
             << '\n';
    }
    for (const auto& f : faces) text << "f " << f[0] + 1 << ' ' << f[1] + 1 << ' ' << f[2] + 1 << '\n';
    return text.str();
}

TEST(SolidStudy, ARunLeavesReportPicturesAndSolids) {
    const TemporaryFolder folder;
    make_feet(folder / "feet", 3);
    const auto command = quick({"run", (folder / "feet").string(), "--json", "--paths", "12"});
    const Outcome done = morphodesic(command);
    ASSERT_EQ(done.code, 0) << done.err;
    EXPECT_EQ(json::parse(done.out)["pairs_computed"], 3);
    const fs::path study = folder / "feet.study";
    const auto distances = analysis::read_distance_csv(study / "distances.csv");
    ASSERT_EQ(distances.size(), 3u);
    EXPECT_EQ(distances.missing_count(), 0u);
    const json report = json::parse(read_file(study / "report.json"));
    EXPECT_EQ(report["dimension"], 3);
    ASSERT_FALSE(report["volumes"].is_null());
    EXPECT_EQ(report["volumes"]["assignment"].size(), 3u);
    EXPECT_EQ(report["volumes"]["tree"]["merges"].size(), 2u);

    std::istringstream table(read_file(study / "shapes.csv"));
    analysis::CsvReader rows(table, "shapes.csv");
    std::vector<std::string> cells;
    ASSERT_TRUE(rows.next(cells));
    ASSERT_THAT(cells, testing::ElementsAre("name", "class", "volume", "scale", "volume_in_file_units", "notes"));
    ASSERT_TRUE(rows.next(cells));
    EXPECT_EQ(cells[0], "foot-001.ply");
    EXPECT_GT(std::stod(cells[4]), 4e5);  // cubic millimetres: a foot holds about a litre
    EXPECT_LT(std::stod(cells[4]), 4e6);

    const auto paths = [&] {
        std::vector<fs::path> folders;
        for (const auto& entry : fs::directory_iterator(study / "paths")) folders.push_back(entry.path());
        std::sort(folders.begin(), folders.end());
        return folders;
    };
    const auto drawn = paths();
    ASSERT_EQ(drawn.size(), 3u);
    for (const fs::path& path : drawn) {
        for (const char* name : {"step-00.png", "step-02.png", "step-00.vdb", "step-02.vdb", "step-01.ply"}) {
            EXPECT_TRUE(fs::exists(path / name)) << path / name;
        }
    }
    const std::string ply = read_file(drawn[0] / "step-01.ply");
    EXPECT_THAT(ply.substr(0, 300), HasSubstr("property float dissipation"));

    // A second report takes solids and pictures from the first one, or makes what was lost again.
    const auto written = fs::last_write_time(drawn[0] / "step-01.ply");
    fs::remove_all(drawn[1]);
    ASSERT_EQ(morphodesic({"report", study.string(), "--quiet"}).code, 0);
    EXPECT_EQ(paths(), drawn);
    EXPECT_EQ(fs::last_write_time(drawn[0] / "step-01.ply"), written);
    EXPECT_TRUE(fs::exists(drawn[1] / "step-01.ply"));
    EXPECT_FALSE(fs::exists(study / "paths.old"));

    // A written step is a solid again.
    const std::string step = (drawn[0] / "step-00.vdb").string();
    const Outcome same = morphodesic(quick({"geodesic", step, (drawn[0] / "step-00.ply").string(), "--json"}));
    ASSERT_EQ(same.code, 0) << same.err;
    EXPECT_LT(json::parse(same.out)["path_length"], 0.1 * distances(0, 1));
}

TEST(SolidStudy, ImagesAmongMeshesAreSaidAndMayBeChosen) {
    const TemporaryFolder folder;
    make_feet(folder / "mixed", 2);
    make_disks(folder / "disks", 2);
    fs::remove(folder / "mixed/labels.csv");
    fs::copy_file(folder / "disks/disk-01.png", folder / "mixed/disk-01.png");
    fs::copy_file(folder / "disks/disk-02.png", folder / "mixed/disk-02.png");
    const auto with = [&](const std::vector<std::string>& more) {
        auto words = quick({"ingest", (folder / "mixed").string(), "--json"});
        words.insert(words.end(), more.begin(), more.end());
        return morphodesic(words);
    };
    const Outcome unsaid = with({});
    EXPECT_EQ(unsaid.code, 1);
    EXPECT_THAT(unsaid.err, HasSubstr("2 images and 2 solids; taken are the solids"));
    EXPECT_THAT(unsaid.err, HasSubstr("--dimension 2"));
    const Outcome images = with({"--dimension", "2", "--out", (folder / "images").string()});
    EXPECT_EQ(images.code, 0) << images.err;
    EXPECT_EQ(json::parse(images.out)["shapes"], 2);
    EXPECT_EQ(with({"--dimension", "4"}).code, 2);
    const Outcome turned = with({"--dimension", "3", "--out", (folder / "images").string()});
    EXPECT_THAT(turned.err, HasSubstr("So far this study was one of images; its results stay in the store"));
    EXPECT_THAT(turned.err, Not(HasSubstr("no longer in the folder")));
    EXPECT_THAT(turned.err, Not(HasSubstr("The scale of this study")));
    const Outcome none = morphodesic(quick({"ingest", (folder / "disks").string(), "--dimension", "3"}));
    EXPECT_EQ(none.code, 2);
    EXPECT_THAT(none.err, HasSubstr("no solids found"));
    // The same rule for templates.
    write_file(folder / "mixed/labels.csv", "file,label\ndisk-01.png,a\ndisk-02.png,b\n");
    const Outcome classified =
        morphodesic(quick({"classify", (folder / "disks/disk-01.png").string(), "--templates",
                           (folder / "mixed").string(), "--dimension", "2", "--no-calibrate", "--json", "--quiet"}));
    EXPECT_EQ(classified.code, 0) << classified.err;
    EXPECT_EQ(json::parse(classified.out)["template_count"], 2);
}

TEST(SolidStudy, SizesInDifferentUnitsAreSaid) {
    const TemporaryFolder folder;
    write_file(folder / "balls/mm.obj", ball_obj(200, 0));
    write_file(folder / "balls/m.obj", ball_obj(0.2, 0));
    const std::string balls = (folder / "balls").string();
    const Outcome common = morphodesic({"ingest", balls, "--level", "4", "--json"});
    EXPECT_THAT(common.err, HasSubstr("differ by a factor of 1e+03"));
    EXPECT_THAT(common.err, HasSubstr("--normalize each"));
    EXPECT_THAT(json::parse(common.out)["remarks"].dump(), HasSubstr("differ by a factor of 1e+03"));
    EXPECT_EQ(common.code, 1);
    EXPECT_THAT(json::parse(common.out)["failures"].dump(), HasSubstr("the whole shape is smaller than a cell"));
    const Outcome each = morphodesic({"ingest", balls, "--level", "4", "--normalize", "each", "--json"});
    EXPECT_EQ(each.code, 0);
    EXPECT_THAT(each.err, Not(HasSubstr("differ by a factor")));
    const Outcome pair = morphodesic(quick({"geodesic", (folder / "balls/mm.obj").string(),
                                            (folder / "balls/m.obj").string(), "--normalize", "each", "--json"}));
    ASSERT_EQ(pair.code, 0) << pair.err;
    EXPECT_LT(json::parse(pair.out)["path_length"], 0.005);
}

/// The ball with its triangles turned inside out, which the reader turns back with a note.
std::string inverted(const std::string& obj) {
    std::istringstream lines(obj);
    std::string text, key, a, b, c;
    while (lines >> key >> a >> b >> c) text += key + ' ' + (key == "f" ? b + ' ' + a : a + ' ' + b) + ' ' + c + '\n';
    return text;
}

TEST(SolidStudy, WhatWasDoneToTheFilesIsInTheAnswers) {
    const TemporaryFolder folder;
    write_file(folder / "balls/a.obj", inverted(ball_obj(1.0, 0)));
    write_file(folder / "balls/b.obj", inverted(ball_obj(1.1, 0)));
    write_file(folder / "balls/sound.obj", ball_obj(1.2, 0));
    const std::string balls = (folder / "balls").string(), a = balls + "/a.obj", sound = balls + "/sound.obj";
    const Outcome pair = morphodesic({"geodesic", a, sound, "--json", "--quiet", "--level", "4", "--steps", "1",
                                      "--starts", "1", "--out", (folder / "path").string()});
    ASSERT_EQ(pair.code, 0) << pair.err;
    for (const json& said : {json::parse(pair.out), json::parse(read_file(folder / "path/geodesic.json"))}) {
        ASSERT_EQ(said["notes_a"].size(), 1u);
        EXPECT_THAT(said["notes_a"][0], HasSubstr("was turned"));
        EXPECT_EQ(said["notes_b"], json::array());
    }
    for (const char* name : {"step-00.png", "step-01.vdb", "step-01.ply"}) {
        EXPECT_TRUE(fs::exists(folder / "path" / name)) << name;
    }
    const Outcome words = morphodesic({"ingest", balls, "--level", "4"});
    EXPECT_EQ(words.code, 0) << words.err;
    EXPECT_THAT(words.out, HasSubstr("a.obj, b.obj: The surface was inside out"));
    EXPECT_THAT(words.out, Not(HasSubstr("sound.obj")));
    const json data = json::parse(morphodesic({"ingest", balls, "--level", "4", "--json"}).out);
    ASSERT_EQ(data["notes"].size(), 2u);
    EXPECT_EQ(data["notes"][1]["file"], "b.obj");
    EXPECT_THAT(data["notes"][1]["notes"][0], HasSubstr("was turned"));
}

TEST(SolidStudy, EqualVolumesAreSaid) {
    const TemporaryFolder folder;
    const std::string feet = (folder / "feet").string();
    ASSERT_EQ(morphodesic({"datasets", "feet", "--equal-volume", "--count", "3", "--out", feet, "--quiet"}).code, 0);
    ASSERT_EQ(morphodesic(quick({"run", feet, "--paths", "none", "--quiet"})).code, 0);
    const json report = json::parse(read_file(folder / "feet.study/report.json"));
    EXPECT_TRUE(report["volumes"].is_null());
    EXPECT_LT(report["volume_spread"], 0.001);
}

TEST(SolidStudy, QueriesWithoutMasksAreNotSaidToHaveSome) {
    const TemporaryFolder folder;
    make_feet(folder / "feet", 2);
    const Outcome hidden = morphodesic({"datasets", "occlude", (folder / "feet").string()});
    ASSERT_EQ(hidden.code, 0) << hidden.err;
    EXPECT_THAT(hidden.out, HasSubstr("2 queries, open where a part is hidden, and truth.csv in"));
}

TEST(SolidGeodesic, BallsFromFilesMeetTheClosedForm) {
    const TemporaryFolder folder;
    write_file(folder / "small.obj", ball_obj(0.20, 0.5));
    write_file(folder / "large.obj", ball_obj(0.25, 0.5));
    const Outcome done =
        morphodesic({"geodesic", (folder / "small.obj").string(), (folder / "large.obj").string(), "--normalize",
                     "none", "--level", "5", "--steps", "4", "--starts", "1", "--json"});
    ASSERT_EQ(done.code, 0) << done.err;
    const json result = json::parse(done.out);
    const double lambda = 3, mu = 1;
    const double exact =
        std::sqrt(std::numbers::pi * (6 * lambda + 4 * mu)) * 2 / 3 * (std::pow(0.25, 1.5) - std::pow(0.20, 1.5));
    EXPECT_NEAR(result["path_length"], exact, result["error"]);
    EXPECT_LT(result["error"], 0.25 * exact);
}

}  // namespace
}  // namespace morphodesic::tests

// geodesic A B: one pair.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "analysis/matrix_csv.h"
#include "program.h"
#include "tests/support/json_schema.h"

namespace morphodesic::tests {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

TEST(Geodesic, OnePairAsJsonAndPictures) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 3);
    const Outcome done =
        morphodesic(quick({"geodesic", (folder / "disks/disk-01.png").string(), (folder / "disks/disk-03.png").string(),
                           "--json", "--out", (folder / "path").string()}));
    ASSERT_EQ(done.code, 0) << done.err;
    const json result = json::parse(done.out);
    for (const char* key : {"path_length", "path_energy", "error", "min_det", "termination"}) {
        EXPECT_TRUE(result.contains(key)) << key;
    }
    EXPECT_EQ(schema_errors(json::parse(read_file(folder / "path/geodesic.json")), schema("geodesic.schema.json")), "");
    EXPECT_GT(result["path_length"], 0.05);
    EXPECT_LE(std::pow(result["path_length"].get<double>(), 2), result["path_energy"].get<double>() * (1 + 1e-12));
    EXPECT_EQ(result["termination"], "converged");
    for (const char* name : {"step-00.png", "step-01.png", "step-02.png", "colours.json", "geodesic.json"}) {
        EXPECT_TRUE(fs::exists(folder / "path" / name)) << name;
    }
    // A shorter path leaves no pictures of the longer one, and nothing else is touched.
    std::ofstream(folder / "path/step-99.png") << "not ours";
    ASSERT_EQ(morphodesic({"geodesic", (folder / "disks/disk-01.png").string(), (folder / "disks/disk-02.png").string(),
                           "--quiet", "--level", "4", "--steps", "1", "--out", (folder / "path").string()})
                  .code,
              0);
    EXPECT_TRUE(fs::exists(folder / "path/step-01.png"));
    EXPECT_FALSE(fs::exists(folder / "path/step-02.png"));
    EXPECT_TRUE(fs::exists(folder / "path/step-99.png"));
    // Equal shapes have no path to draw; the result is that of this pair all the same.
    fs::copy_file(folder / "disks/disk-01.png", folder / "copy.png");
    const Outcome equal = morphodesic(quick({"geodesic", (folder / "disks/disk-01.png").string(),
                                             (folder / "copy.png").string(), "--out", (folder / "path").string()}));
    EXPECT_EQ(equal.code, 0) << equal.err;
    EXPECT_THAT(equal.out, HasSubstr("no pictures"));
    EXPECT_FALSE(fs::exists(folder / "path/step-00.png"));
    const json written = json::parse(read_file(folder / "path/geodesic.json"));
    EXPECT_EQ(schema_errors(written, schema("geodesic.schema.json")), "");
    EXPECT_EQ(written["path_length"], 0.0);
    EXPECT_THAT(written["b"].get<std::string>(), HasSubstr("copy.png"));
}

/// Studies and pairs alike are computed from the shape with fewer gaps, and the path leads from the first to the
/// second.
TEST(Geodesic, ADistanceDoesNotDependOnWhichShapeIsNamedFirst) {
    const TemporaryFolder folder;
    const std::string men = (folder / "men").string();
    ASSERT_EQ(morphodesic({"datasets", "matchstick", "--out", men, "--count", "2", "--size", "64", "--quiet"}).code, 0);
    ASSERT_EQ(morphodesic(quick({"run", men, "--paths", "none", "--quiet"})).code, 0);
    const auto distances = analysis::read_distance_csv(folder / "men.study/distances.csv");
    const std::string a = men + "/" + distances.labels()[0], b = men + "/" + distances.labels()[1];
    const auto solved = [&](const std::string& first, const std::string& second, std::vector<std::string> more = {}) {
        std::vector<std::string> words{"geodesic", first, second, "--json"};
        words.insert(words.end(), more.begin(), more.end());
        return json::parse(morphodesic(quick(words)).out);
    };
    const json there = solved(a, b, {"--out", (folder / "there").string()}),
               back = solved(b, a, {"--out", (folder / "back").string()});
    EXPECT_EQ(there["path_length"], distances(0, 1));
    EXPECT_EQ(back["path_length"], distances(0, 1));
    EXPECT_EQ(there["path_from"], back["path_from"]);
    EXPECT_EQ(there["a"], a);
    EXPECT_EQ(there["digest_a"], back["digest_b"]);
    json energies = back["deformation_energy"];
    std::reverse(energies.begin(), energies.end());
    EXPECT_EQ(there["deformation_energy"], energies);
    // The motion of a onto b is the inverse of that of b onto a.
    for (std::size_t i = 0; i < 2; ++i) {
        double translation = 0.0;
        for (std::size_t j = 0; j < 2; ++j) {
            EXPECT_EQ(there["rotation"][2 * i + j], back["rotation"][2 * j + i]);
            translation -= there["rotation"][2 * i + j].get<double>() * back["translation"][j].get<double>();
        }
        EXPECT_NEAR(there["translation"][i], translation, 1e-12);
    }

    const bool from_a = there["path_from"] == a;
    const json as_named = from_a ? solved(a, b, {"--direction", "given"}) : solved(b, a, {"--direction", "given"}),
               other = from_a ? solved(b, a, {"--direction", "given"}) : solved(a, b, {"--direction", "given"});
    EXPECT_EQ(as_named["path_length"], there["path_length"]);
    EXPECT_NE(other["path_length"], there["path_length"]);
    EXPECT_NE(other["path_from"], there["path_from"]);

    // In the pictures the first shape comes first: the areas of the one path are those of the other from its end.
    const auto areas = [&](const char* path) {
        std::vector<double> column;
        std::istringstream lines(read_file(folder / path / "path.csv"));
        std::string line;
        for (std::getline(lines, line); std::getline(lines, line);) {
            std::istringstream cells(line);
            std::string cell;
            for (int i = 0; i < 3; ++i) std::getline(cells, cell, ',');
            column.push_back(std::stod(cell));
        }
        return column;
    };
    const auto onwards = areas("there"), homewards = areas("back");
    ASSERT_EQ(onwards.size(), 3u);
    ASSERT_EQ(homewards.size(), 3u);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(onwards[k], homewards[2 - k], 0.05 * onwards[k]) << k;
    EXPECT_GT(std::abs(onwards[2] - onwards[0]), 0.15 * onwards[0]) << "no case of what is tested";
}

TEST(Geodesic, TheOptionsInTheReportGiveTheDistanceOfTheStudy) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 4);
    ASSERT_EQ(morphodesic(quick({"run", (folder / "disks").string(), "--quiet", "--paths", "1"})).code, 0);
    const json report = json::parse(read_file(folder / "disks.study/report.json"));
    const json path = report["paths"][0];
    std::vector<std::string> words{"geodesic", "--json"};
    for (const char* end : {"a", "b"}) {
        words.push_back(
            (folder / "disks" / report["shapes"][path[end].get<std::size_t>()]["name"].get<std::string>()).string());
    }
    for (const auto& word : report["geodesic_options"]) words.push_back(word.get<std::string>());
    const Outcome again = morphodesic(words);
    ASSERT_EQ(again.code, 0) << again.err;
    EXPECT_EQ(json::parse(again.out)["path_length"], path["path_length"]);
}

/// From A to B there are two ways; the alignment that overlaps most leads to the longer one.
TEST(Geodesic, MoreStartsFindTheLowerOfTwoPaths) {
    const TemporaryFolder folder;
    const std::string letters = (folder / "letters").string(), name = "-DejaVuSansBold001.png";
    const Outcome made =
        morphodesic({"datasets", "letters", "--characters", "AB", "--count", "2", "--font",
                     "/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf", "--out", letters, "--quiet"});
    ASSERT_EQ(made.code, 0) << made.err;
    const auto energy = [&](const char* starts) {
        const Outcome done = morphodesic({"geodesic", letters + "/A" + name, letters + "/B" + name, "--preset", "fast",
                                          "--level", "5", "--starts", starts, "--json"});
        return json::parse(done.out)["total_energy"].get<double>();
    };
    EXPECT_LT(energy("8"), 0.95 * energy("1"));
}

TEST(Geodesic, AMaskOfTheSecondShapeIsNotLeftOutInSilence) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 2);
    const std::string disks = (folder / "disks").string();
    ASSERT_EQ(morphodesic({"datasets", "occlude", disks, "--out", disks + ".occluded", "--quiet"}).code, 0);
    const std::string hidden = disks + ".occluded/disk-01.png", whole = disks + "/disk-02.png";
    const auto remarks_of = [&](std::vector<std::string> words) {
        return json::parse(morphodesic(quick(std::move(words))).out).value("remarks", json::array());
    };
    EXPECT_TRUE(remarks_of({"geodesic", whole, hidden, "--json"}).empty()) << "it is computed from the hidden one";
    const json second =
        json::parse(morphodesic(quick({"geodesic", whole, hidden, "--direction", "given", "--json"})).out);
    ASSERT_EQ(second["remarks"].size(), 1u);
    EXPECT_THAT(second["remarks"][0], HasSubstr("give this one first"));
    EXPECT_FALSE(json::parse(morphodesic(quick({"geodesic", hidden, whole, "--json"})).out).contains("remarks"));
    EXPECT_THAT(
        json::parse(
            morphodesic(quick({"geodesic", hidden, disks + ".occluded/disk-02.png", "--json"})).out)["remarks"][0],
        Not(HasSubstr("give this one first")));
}

TEST(Geodesic, AShapeHasDistanceZeroToItself) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 1);
    const std::string file = (folder / "disks/disk-01.png").string();
    const Outcome done = morphodesic(quick({"geodesic", file, file, "--json"}));
    ASSERT_EQ(done.code, 0) << done.err;
    EXPECT_EQ(json::parse(done.out)["path_length"], 0.0);
}

}  // namespace
}  // namespace morphodesic::tests

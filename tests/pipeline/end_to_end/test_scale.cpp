// Both directions, memory, shards on one and several machines, screening.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "analysis/matrix_csv.h"
#include "program.h"

namespace morphodesic::tests {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

std::vector<std::vector<std::string>> rows_of(const fs::path& csv) {
    std::vector<std::vector<std::string>> rows;
    std::istringstream lines(read_file(csv));
    for (std::string line; std::getline(lines, line);) {
        rows.emplace_back();
        std::istringstream cells(line + ",");
        for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
    }
    return rows;
}

void make_men(const fs::path& folder, int n) {
    const Outcome made = morphodesic(
        {"datasets", "matchstick", "--out", folder.string(), "--count", std::to_string(n), "--size", "64", "--quiet"});
    ASSERT_EQ(made.code, 0) << made.err;
}

TEST(BothDirections, TheDistanceIsTheMeanAndBothRowsAreKept) {
    const TemporaryFolder folder;
    make_men(folder / "men", 4);
    const auto one = quick({"run", (folder / "men").string(), "--paths", "none", "--json", "--quiet"});
    ASSERT_EQ(json::parse(morphodesic(one).out)["pairs_computed"], 6);
    const std::string bytes = read_file(folder / "men.study/distances.csv");
    auto both = one;
    both.emplace_back("--both-directions");
    const json done = json::parse(morphodesic(both).out);
    EXPECT_EQ(done["pairs_computed"], 6);
    EXPECT_EQ(done["pairs_from_store"], 6);  // the first direction is that of a study of one direction

    const auto rows = rows_of(folder / "men.study/pairs.csv");
    const auto column = [&](const std::string& name) {
        return static_cast<std::size_t>(std::find(rows[0].begin(), rows[0].end(), name) - rows[0].begin());
    };
    ASSERT_EQ(rows.size(), 13u);
    bool differ = false;
    for (std::size_t r = 1; r < rows.size(); r += 2) {
        const auto &first = rows[r], &second = rows[r + 1];
        EXPECT_EQ(first[0], second[0]);
        EXPECT_EQ(first[1], second[1]);
        EXPECT_NE(first[column("path_from")], second[column("path_from")]);
        const double x = std::stod(first[column("path_length")]), y = std::stod(second[column("path_length")]);
        EXPECT_DOUBLE_EQ(std::stod(first[column("distance")]), (x + y) / 2);
        EXPECT_GE(std::stod(first[column("error")]), std::abs(x - y) / 2);
        differ = differ || x != y;
    }
    EXPECT_TRUE(differ);
    const json report = json::parse(read_file(folder / "men.study/report.json"));
    EXPECT_GT(report["trust"]["max_asymmetry"].get<double>(), 0.0);
    EXPECT_FALSE(report["trust"]["asymmetries"].empty());

    // Back to one direction: the rows of the other one are in the store and change nothing.
    EXPECT_EQ(json::parse(morphodesic(one).out)["pairs_computed"], 0);
    EXPECT_EQ(read_file(folder / "men.study/distances.csv"), bytes);
}

TEST(Memory, IsSaidBeforeAndLimitsThePairsAtOnce) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 3);
    const Outcome roomy =
        morphodesic(quick({"run", (folder / "disks").string(), "--memory", "1G", "--threads", "2", "--paths", "none"}));
    EXPECT_EQ(roomy.code, 0) << roomy.err;
    EXPECT_THAT(roomy.err, HasSubstr("2 pairs at once"));
    const Outcome tight = morphodesic(quick({"run", (folder / "disks").string(), "--memory", "48.9M", "--threads", "8",
                                             "--paths", "none", "--out", (folder / "tight").string()}));
    EXPECT_EQ(tight.code, 0) << tight.err;
    EXPECT_THAT(tight.err, HasSubstr("at once"));
    EXPECT_THAT(tight.err, Not(HasSubstr("8 pairs at once")));
    EXPECT_EQ(read_file(folder / "tight/distances.csv"), read_file(folder / "disks.study/distances.csv"));
    const Outcome impossible = morphodesic({"run", (folder / "disks").string(), "--level", "9", "--steps", "16",
                                            "--memory", "200M", "--out", (folder / "none").string()});
    EXPECT_EQ(impossible.code, 2);
    EXPECT_THAT(impossible.err, HasSubstr("--memory"));
    EXPECT_THAT(impossible.err, HasSubstr("--level"));
    EXPECT_EQ(morphodesic(quick({"run", (folder / "disks").string(), "--memory", "lots"})).code, 2);
}

}  // namespace
}  // namespace morphodesic::tests

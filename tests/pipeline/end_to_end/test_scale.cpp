// Both directions, memory, shards on one and several machines, screening.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <thread>

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

/// Two groups of shapes that are far from each other.
class Neighbours : public testing::Test {
protected:
    void SetUp() override {
        make_men(folder / "shapes", 7);
        make_disks(folder / "shapes/disks", 6);
        for (const auto& entry : fs::recursive_directory_iterator(folder / "shapes")) {
            if (entry.path().extension() == ".csv") csv_.push_back(entry.path());
        }
        for (const fs::path& file : csv_) fs::remove(file);
    }
    [[nodiscard]] std::vector<std::string> command(const std::string& out, int neighbors) const {
        return {"run",         (folder / "shapes").string(),
                "--out",       (folder / out).string(),
                "--level",     "5",
                "--steps",     "1",
                "--paths",     "2",
                "--labels",    "none",
                "--neighbors", std::to_string(neighbors),
                "--json",      "--quiet"};
    }
    /// Numbers of the k nearest in a row of distances.csv.
    static std::set<std::size_t> nearest(const std::vector<std::string>& row, std::size_t self, std::size_t k) {
        std::vector<std::size_t> order;
        for (std::size_t c = 1; c < row.size(); ++c) {
            if (c != self) order.push_back(c);
        }
        std::sort(order.begin(), order.end(),
                  [&](std::size_t x, std::size_t y) { return std::stod(row[x]) < std::stod(row[y]); });
        return {order.begin(), order.begin() + static_cast<std::ptrdiff_t>(k)};
    }
    TemporaryFolder folder;

private:
    std::vector<fs::path> csv_;
};

TEST_F(Neighbours, AreFoundAndTheOtherPairsAreMarkedAsEstimates) {
    const json full = json::parse(morphodesic(command("full", 0)).out);
    EXPECT_FALSE(fs::exists(folder / "full/distances_refined.csv"));
    const Outcome done = morphodesic(command("screened", 2));
    ASSERT_EQ(done.code, 0) << done.err;
    const json summary = json::parse(done.out);
    const long pairs = 13 * 12 / 2;
    EXPECT_EQ(summary["pairs"], pairs);
    const long coarse = summary["pairs_coarse"], refined = summary["pairs_refined"];
    EXPECT_EQ(coarse + refined, pairs);
    EXPECT_GT(coarse, pairs / 4);
    EXPECT_EQ(summary["pairs_computed"], pairs + refined);
    const json again = json::parse(morphodesic(command("screened", 2)).out);
    EXPECT_EQ(again["pairs_computed"], 0);
    EXPECT_EQ(again["geodesics"], summary["geodesics"]);
    EXPECT_EQ(again["pairs_from_store"], pairs + refined);
    // Pairs that the full study had count only where the screening asks for them.
    fs::copy(folder / "full", folder / "both", fs::copy_options::recursive);
    const json both = json::parse(morphodesic(command("both", 2)).out);
    EXPECT_EQ(both["geodesics"], summary["geodesics"]);

    // Every neighbour of the full study is found, with the same number; estimates are further away.
    const auto all = rows_of(folder / "full/distances.csv"), some = rows_of(folder / "screened/distances.csv"),
               sure = rows_of(folder / "screened/distances_refined.csv");
    ASSERT_EQ(all.size(), 14u);
    long empty = 0;
    for (std::size_t r = 1; r < all.size(); ++r) {
        EXPECT_EQ(nearest(all[r], r, 2), nearest(some[r], r, 2)) << all[r][0];
        for (std::size_t c = 1; c < all.size(); ++c) {
            if (sure[r].size() <= c || sure[r][c].empty()) {
                ++empty;
                EXPECT_NE(some[r][c], "");
            } else {
                EXPECT_EQ(sure[r][c], some[r][c]);
                EXPECT_EQ(sure[r][c], all[r][c]);
            }
        }
    }
    EXPECT_EQ(empty, 2 * coarse);

    const auto rows = rows_of(folder / "screened/pairs.csv");
    const auto column = [&](const std::string& name) {
        return static_cast<std::size_t>(std::find(rows[0].begin(), rows[0].end(), name) - rows[0].begin());
    };
    long marked = 0;
    for (std::size_t r = 1; r < rows.size(); ++r) {
        const bool fine = rows[r][column("refined")] == "1";
        EXPECT_EQ(rows[r][column("level")], fine ? "5" : "4");
        EXPECT_EQ(rows[r][column("distance")] == rows[r][column("path_length")], fine);
        marked += fine ? 0 : 1;
    }
    EXPECT_EQ(marked, coarse);
    const json report = json::parse(read_file(folder / "screened/report.json"));
    EXPECT_EQ(std::count(report["refined"].begin(), report["refined"].end(), 0), coarse);
    EXPECT_THAT(report["trust"]["remarks"].dump(), HasSubstr("estimates from coarse grids"));
    EXPECT_EQ(morphodesic({"verify", (folder / "screened").string(), "--sample", "15"}).code, 0);

    // Back to all pairs: the refined ones are there already.
    const json back = json::parse(morphodesic(command("screened", 0)).out);
    EXPECT_EQ(back["pairs_from_store"], refined);
    EXPECT_EQ(read_file(folder / "screened/distances.csv"), read_file(folder / "full/distances.csv"));
    EXPECT_FALSE(fs::exists(folder / "screened/distances_refined.csv"));
}

TEST_F(Neighbours, AStoppedStudyAndShardsGiveTheSameBytes) {
    ASSERT_EQ(morphodesic(command("undisturbed", 2)).code, 0);
    const std::string bytes = read_file(folder / "undisturbed/distances.csv");
    for (const long rows : {5, 40, 80, 90}) {  // in one round after the other
        BackgroundRun run(command("stopped", 2));
        for (int i = 0; i < 6000 && stored_rows(folder / "stopped") < rows; ++i) {
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
        run.signal(SIGKILL);
        run.wait();
    }
    ASSERT_EQ(morphodesic(command("stopped", 2)).code, 0);
    EXPECT_EQ(read_file(folder / "stopped/distances.csv"), bytes);

    const std::string study = (folder / "shards").string();
    std::vector<std::string> ingest = command("shards", 2);
    ingest[0] = "ingest";
    const auto paths = std::find(ingest.begin(), ingest.end(), "--paths");
    ingest.erase(paths, paths + 2);
    ASSERT_EQ(morphodesic(ingest).code, 0);
    int rounds = 0;
    for (json merged = json::object(); rounds < 10 && merged.value("pairs_missing", 1) > 0; ++rounds) {
        const json planned = json::parse(morphodesic({"plan", study, "--shards", "2", "--json", "--quiet"}).out);
        EXPECT_GT(planned["pairs"], 0);
        for (const std::string shard : {"1/2", "2/2"}) {
            EXPECT_EQ(morphodesic({"shard", study, shard, "--quiet"}).code, 0);
        }
        const Outcome done = morphodesic({"merge", study, "--accept-failures", "--json", "--quiet"});
        EXPECT_EQ(done.code, 0) << done.err;  // a workflow ends well, also if another round follows
        merged = json::parse(done.out);
    }
    EXPECT_GE(rounds, 2);
    EXPECT_LE(rounds, 3);
    ASSERT_EQ(morphodesic({"analyze", study, "--quiet"}).code, 0);
    EXPECT_EQ(read_file(folder / "shards/distances.csv"), bytes);
}

TEST_F(Neighbours, RoundAfterRoundRunsUnderMakeflowInOneFolder) {
    std::vector<std::string> ingest = command("rounds", 2);
    ingest[0] = "ingest";
    const auto paths = std::find(ingest.begin(), ingest.end(), "--paths");
    ingest.erase(paths, paths + 2);
    ASSERT_EQ(morphodesic(ingest).code, 0);
    const std::string study = (folder / "rounds").string();
    int rounds = 0;
    for (json merged = json::object(); rounds < 4 && merged.value("pairs_missing", 1) > 0; ++rounds) {
        const json planned = json::parse(
            morphodesic_file({"plan", study, "--shards", "2", "--format", "makeflow", "--json", "--quiet"}).out);
        const std::string script = planned["script"];
        const Outcome done = shell(std::string("timeout 150 '") + MORPHODESIC_SOURCE_DIR +
                                   "/tests/pipeline/end_to_end/with_work_queue' '" +
                                   (folder / ("queue" + std::to_string(rounds))).string() + "' '" + script + "'");
        if (done.code == 77) GTEST_SKIP() << done.out;
        ASSERT_EQ(done.code, 0) << done.out << done.err;
        merged = json::parse(read_file(folder / "rounds/shards" / ("merged-" + planned.value("id", "") + ".json")));
    }
    EXPECT_GE(rounds, 2);
    EXPECT_LE(rounds, 3);
    const json merged = json::parse(morphodesic({"merge", study, "--json", "--quiet"}).out);
    EXPECT_EQ(merged["pairs_added"], 0);
    EXPECT_EQ(merged["pairs_missing"], 0);
}

TEST(Memory, IsSaidBeforeAndLimitsThePairsAtOnce) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 3);
    const Outcome roomy =
        morphodesic(quick({"run", (folder / "disks").string(), "--memory", "1G", "--threads", "2", "--paths", "none"}));
    EXPECT_EQ(roomy.code, 0) << roomy.err;
    EXPECT_THAT(roomy.err, HasSubstr("2 pairs at once"));
    const Outcome tight = morphodesic(quick({"run", (folder / "disks").string(), "--memory", "160.9M", "--threads", "8",
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

/// A study of one process, and another one that has its shapes but no pairs yet.
class Shards : public testing::Test {
protected:
    void SetUp() override {
        make_men(folder / "men", 6);
        ASSERT_EQ(morphodesic(quick({"run", men(), "--paths", "none", "--quiet"})).code, 0);
        ASSERT_EQ(morphodesic(quick({"ingest", men(), "--out", study(), "--quiet"})).code, 0);
    }
    [[nodiscard]] std::string men() const { return (folder / "men").string(); }
    [[nodiscard]] std::string study() const { return (folder / "a study").string(); }
    [[nodiscard]] json plan(int shards, const std::string& format) const {
        const Outcome done = morphodesic_file(
            {"plan", study(), "--shards", std::to_string(shards), "--format", format, "--json", "--quiet"});
        EXPECT_EQ(done.code, 0) << done.err;
        return json::parse(done.out);
    }
    void expect_the_bytes_of_one_process() const {
        ASSERT_EQ(morphodesic({"analyze", study(), "--quiet"}).code, 0);
        EXPECT_EQ(read_file(folder / "a study/distances.csv"), read_file(folder / "men.study/distances.csv"));
    }
    TemporaryFolder folder;
};

TEST_F(Shards, OnSeveralMachinesGiveTheBytesOfOneProcess) {
    EXPECT_EQ(plan(3, "list")["pairs"], 15);
    std::vector<std::string> files;
    for (const std::string i : {"3", "1", "2"}) {  // each with nothing but a copy of the plan
        const fs::path machine = folder / ("machine" + i);
        fs::create_directory(machine);
        fs::copy_file(folder / "a study/shards/plan.sqlite", machine / "plan.sqlite");
        fs::permissions(machine / "plan.sqlite", fs::perms::owner_read);
        files.push_back((machine / "result.jsonl").string());
        const std::vector<std::string> command{
            "shard", (machine / "plan.sqlite").string(), i + "/3", "--out", files.back(), "--json", "--quiet"};
        EXPECT_EQ(morphodesic(command).code, 0);
        const std::string bytes = read_file(files.back());
        const json again = json::parse(morphodesic(command).out);
        EXPECT_EQ(again["pairs_computed"], 0);
        EXPECT_EQ(read_file(files.back()), bytes);
    }
    std::vector<std::string> command{"merge", study(), "--json", "--quiet", files[0]};
    const json first = json::parse(morphodesic(command).out);
    EXPECT_EQ(first["exit_code"], 1);
    EXPECT_EQ(first["pairs_added"].get<int>() + first["pairs_missing"].get<int>(), 15);
    command.insert(command.end(), {files[2], files[1]});
    EXPECT_EQ(json::parse(morphodesic(command).out)["pairs_missing"], 0);
    const json twice = json::parse(morphodesic(command).out);
    EXPECT_EQ(twice["pairs_added"], 0);
    EXPECT_EQ(twice["exit_code"], 0);
    expect_the_bytes_of_one_process();
}

TEST_F(Shards, GoOnAfterAStopAndLeaveDamageOut) {
    EXPECT_EQ(plan(1, "list")["pairs"], 15);
    const std::string file = (folder / "result.jsonl").string();
    const std::vector<std::string> command{"shard", study(), "1/1", "--out", file, "--json", "--quiet"};
    ASSERT_EQ(morphodesic(command).code, 0);
    std::string bytes = read_file(file);
    bytes.resize(bytes.size() - 40);         // killed in the middle of a line
    bytes[bytes.find("numbers") + 14] ^= 1;  // and a digit that flipped
    write_file(file, bytes);
    EXPECT_EQ(morphodesic({"merge", study(), file}).code, 1);
    EXPECT_EQ(json::parse(morphodesic(command).out)["pairs_computed"], 2);
    const json merged = json::parse(morphodesic({"merge", study(), file, "--json", "--quiet"}).out);
    EXPECT_EQ(merged["pairs_missing"], 0);
    EXPECT_THAT(merged["remarks"].dump(), HasSubstr("1 damaged line was"));  // still there, and said
    EXPECT_EQ(merged["exit_code"], 0);                                       // but nothing is missing any more
    expect_the_bytes_of_one_process();
}

TEST_F(Shards, ADamagedFirstLineIsSaidAsSuch) {
    EXPECT_EQ(plan(1, "list")["pairs"], 15);
    const std::string file = (folder / "result.jsonl").string();
    const std::vector<std::string> command{"shard", study(), "1/1", "--out", file, "--quiet"};
    ASSERT_EQ(morphodesic(command).code, 0);
    std::string bytes = read_file(file);
    bytes[bytes.find("\"settings\":\"") + 14] ^= 1;
    write_file(file, bytes);
    EXPECT_THAT(morphodesic({"merge", study(), file}).out, HasSubstr("first line is damaged"));
    EXPECT_THAT(morphodesic(command).err, HasSubstr("first line is damaged"));
}

TEST_F(Shards, ALineWithAByteOfZeroInItIsDamageAsAWhole) {
    EXPECT_EQ(plan(1, "list")["pairs"], 15);
    const fs::path file = folder / "result.jsonl";
    ASSERT_EQ(morphodesic({"shard", study(), "1/1", "--out", file.string(), "--quiet"}).code, 0);
    const std::string sound = read_file(file);
    write_file(file, sound.substr(0, sound.size() - 1) + std::string(1, '\0') + "\n");
    const Outcome merged = morphodesic({"merge", study(), file.string(), "--json", "--quiet"});
    EXPECT_EQ(json::parse(merged.out)["pairs_added"], 14);
    EXPECT_EQ(merged.code, 1);
}

TEST_F(Shards, AFileOfAnySizeWithoutLineEndsIsDamageAndDoesNotFillTheMemory) {
    EXPECT_EQ(plan(1, "list")["pairs"], 15);
    const fs::path file = folder / "result.jsonl";
    const std::vector<std::string> command{"shard", study(), "1/1", "--out", file.string(), "--quiet"};
    ASSERT_EQ(morphodesic(command).code, 0);
    fs::resize_file(file, std::uintmax_t{1} << 40);  // holes, as after a crash of some file systems; 1 TB
    const Outcome merged = morphodesic({"merge", study(), file.string(), "--json", "--quiet"});
    EXPECT_EQ(json::parse(merged.out)["pairs_added"], 15);  // what is sound is kept
    EXPECT_EQ(merged.code, 0);
    EXPECT_THAT(merged.out, HasSubstr("damaged"));
    const Outcome again = morphodesic(command);
    EXPECT_EQ(again.code, 3);
    EXPECT_THAT(again.err, HasSubstr("move it away"));
    fs::remove(file);
    fs::create_directory(file);
    EXPECT_THAT(morphodesic({"merge", study(), file.string()}).out, HasSubstr("is a folder"));
}

TEST_F(Shards, RefuseWhatDoesNotBelongToTheStudy) {
    ASSERT_EQ(plan(2, "list")["shards"], 2);
    const std::string file = (folder / "result.jsonl").string();
    ASSERT_EQ(morphodesic({"shard", study(), "1/2", "--out", file, "--quiet"}).code, 0);
    EXPECT_EQ(morphodesic({"shard", study(), "1/3"}).code, 2);
    EXPECT_EQ(morphodesic({"shard", study(), "3/2"}).code, 2);
    const std::string other = (folder / "other.study").string();
    ASSERT_EQ(morphodesic({"ingest", men(), "--out", other, "--level", "4", "--steps", "1", "--quiet"}).code, 0);
    const Outcome foreign = morphodesic({"merge", other, file});
    EXPECT_EQ(foreign.code, 2);  // nothing of it could be used
    EXPECT_THAT(foreign.out, HasSubstr("settings"));
    EXPECT_EQ(morphodesic({"merge", study(), (folder / "resutl.jsonl").string()}).code, 2);
    EXPECT_EQ(stored_rows(other), 0);
    std::string bytes = read_file(file);
    const std::string revision = "\"solver_revision\":";
    bytes.insert(bytes.find(revision) + revision.size(), "9");
    write_file(file, bytes);
    const Outcome newer = morphodesic({"merge", study(), file});
    EXPECT_EQ(newer.code, 2);
    EXPECT_THAT(newer.out, HasSubstr("another version"));
    EXPECT_EQ(stored_rows(study()), 0);
}

TEST_F(Shards, RunUnderSlurm) {
    const json planned = plan(4, "slurm");
    const std::string script = planned["script"];
    const Outcome done =
        shell(std::string("timeout 150 '") + MORPHODESIC_SOURCE_DIR + "/tests/pipeline/end_to_end/with_slurm' '" +
              (folder / "slurm").string() + "' '" + script + "'");
    if (done.code == 77) GTEST_SKIP() << done.out;
    ASSERT_EQ(done.code, 0) << done.out << done.err;
    EXPECT_EQ(json::parse(morphodesic({"merge", study(), "--json", "--quiet"}).out)["pairs_added"], 15);
    expect_the_bytes_of_one_process();
}

TEST_F(Shards, RunUnderMakeflowWhereOneOfTwoWorkersIsKilled) {
    const json planned = plan(5, "makeflow");
    const std::string script = planned["script"];
    const Outcome done =
        shell(std::string("timeout 150 '") + MORPHODESIC_SOURCE_DIR + "/tests/pipeline/end_to_end/with_work_queue' '" +
              (folder / "queue").string() + "' '" + script + "'");
    if (done.code == 77) GTEST_SKIP() << done.out;
    ASSERT_EQ(done.code, 0) << done.out << done.err;
    const json merged = json::parse(morphodesic({"merge", study(), "--json", "--quiet"}).out);
    EXPECT_EQ(merged["pairs_added"], 0);  // the last rule of the workflow has merged
    EXPECT_EQ(merged["pairs_missing"], 0);
    expect_the_bytes_of_one_process();
}

}  // namespace
}  // namespace morphodesic::tests

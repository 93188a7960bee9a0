// What surrounds the program: its streams, what stands where its files go, folders that are mistaken for others.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <nlohmann/json.hpp>

#include "program.h"

namespace morphodesic::tests {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

class Surroundings : public testing::Test {
protected:
    void SetUp() override { make_disks(folder / "disks", 3); }
    [[nodiscard]] std::string disks() const { return (folder / "disks").string(); }
    [[nodiscard]] Outcome run(std::vector<std::string> more = {}) const {
        std::vector<std::string> words{"run", disks(), "--quiet"};
        words.insert(words.end(), more.begin(), more.end());
        return morphodesic(quick(std::move(words)));
    }
    [[nodiscard]] Outcome run_in_shell(const std::string& behind) const {
        std::string line = "\"$MORPHODESIC\"";
        for (const std::string& word : quick({"run", disks(), "--json"})) line += " '" + word + "'";
        return shell(line + " " + behind);
    }
    TemporaryFolder folder;
};

TEST_F(Surroundings, AClosedStreamIsNoFileOfTheStudy) {
    ASSERT_EQ(run().code, 0);
    const std::string distances = read_file(folder / "disks.study/distances.csv");
    fs::remove_all(folder / "disks.study");
    // The files of the study would be opened as 0, 1 and 2, and the messages would go into them.
    EXPECT_EQ(run_in_shell("<&- >&- 2>&-").code, 0);
    EXPECT_EQ(read_file(folder / "disks.study/distances.csv"), distances);
    const std::string lock = read_file(folder / "disks.study/study.lock");
    EXPECT_EQ(lock.rfind("process ", 0), 0U) << lock;
    EXPECT_EQ(lock.find('\n'), std::string::npos) << lock;
}

TEST_F(Surroundings, ASummaryThatDoesNotArriveIsSaidWithTheExitCode) {
    const Outcome full = run_in_shell(">/dev/full");
    EXPECT_EQ(full.code, 3);
    EXPECT_THAT(full.err, HasSubstr("standard output cannot be written"));
    EXPECT_EQ(shell("\"$MORPHODESIC\" --help >/dev/full").code, 3);
    // A reader that has seen enough is no fault.
    EXPECT_EQ(shell("set -o pipefail; \"$MORPHODESIC\" --help | head -n 1").code, 0);
    const Outcome again = run();
    EXPECT_EQ(again.code, 0) << again.err;
}

TEST_F(Surroundings, ResultsAreNotReadAsShapes) {
    const Outcome inside = run({"--out", disks()});
    EXPECT_EQ(inside.code, 2);
    EXPECT_THAT(inside.err, HasSubstr("--out"));
    EXPECT_FALSE(fs::exists(folder / "disks/study.sqlite"));
    ASSERT_EQ(run({"--out", disks() + "/results"}).code, 0);
    const std::string distances = read_file(folder / "disks/results/distances.csv");
    ASSERT_EQ(run({"--out", disks() + "/results"}).code, 0);
    EXPECT_EQ(read_file(folder / "disks/results/distances.csv"), distances);
    const Outcome study = morphodesic({"run", disks() + "/results"});
    EXPECT_EQ(study.code, 2);
    EXPECT_THAT(study.err, HasSubstr("morphodesic report"));
}

TEST_F(Surroundings, ResultsOfEveryCommandInsideTheCollectionAreSkipped) {
    ASSERT_EQ(run().code, 0);
    fs::copy_file(folder / "disks.study/distances.csv", folder / "disks/distances.csv");
    ASSERT_EQ(morphodesic({"report", disks() + "/distances.csv", "--quiet"}).code, 0);
    ASSERT_TRUE(fs::exists(folder / "disks/distances.analysis/figures/heat_map.png"));
    ASSERT_EQ(morphodesic(quick({"geodesic", disks() + "/disk-01.png", disks() + "/disk-02.png", "--out",
                                 disks() + "/path", "--quiet"}))
                  .code,
              0);
    fs::create_directories(folder / "disks/pictures");
    fs::copy(folder / "disks/distances.analysis/figures", folder / "disks/pictures");
    const Outcome again = morphodesic(quick({"run", disks(), "--json"}));
    EXPECT_EQ(again.code, 0) << again.err;
    EXPECT_EQ(json::parse(again.out)["shapes"], 3);
    for (const char* name : {"distances.analysis", "path", "pictures"}) {
        EXPECT_THAT(again.err, HasSubstr("Skipped the folder " + disks() + "/" + name + ":"));
    }
}

TEST_F(Surroundings, WhatStandsWhereAFileGoesIsSaid) {
    fs::create_directories(folder / "disks.study/distances.csv/x");
    const Outcome done = run();
    EXPECT_EQ(done.code, 3);
    EXPECT_THAT(done.err, testing::AllOf(HasSubstr("distances.csv"), HasSubstr("move it away")));
    fs::remove_all(folder / "disks.study/distances.csv");
    ASSERT_EQ(run().code, 0);
    EXPECT_TRUE(fs::is_regular_file(folder / "disks.study/distances.csv"));
}

TEST_F(Surroundings, AFolderWithoutPermissionIsNamedWithWhatToDo) {
    ASSERT_EQ(run().code, 0);
    fs::permissions(folder / "disks.study", fs::perms::none);
    fs::permissions(folder.path(), fs::perms::others_exec | fs::perms::others_read, fs::perm_options::add);
    const std::string command = "report '" + (folder / "disks.study").string() + "'";
    const std::string other = shell("id -u").out == "0\n" ? "setpriv --reuid=65534 --regid=65534 --clear-groups " : "";
    const Outcome done = shell(other + "\"$MORPHODESIC\" " + command);
    fs::permissions(folder / "disks.study", fs::perms::owner_all);
    if (done.code == 126 || done.code == 127) GTEST_SKIP() << "another user may not run the program: " << done.err;
    EXPECT_EQ(done.code, 3);
    EXPECT_THAT(done.err, testing::AllOf(HasSubstr("study.sqlite"), HasSubstr("permissions")));
}

TEST_F(Surroundings, ATerminalThatGoesAwayStopsTheRunInGoodOrder) {
    ASSERT_EQ(
        morphodesic({"datasets", "matchstick", "--out", (folder / "men").string(), "--count", "9", "--quiet"}).code, 0);
    BackgroundRun study({"run", (folder / "men").string(), "--level", "5", "--steps", "2", "--threads", "1"});
    for (int i = 0; i < 6000 && stored_rows(folder / "men.study") < 2; ++i) shell("sleep 0.005");
    study.signal(SIGHUP);
    const Outcome done = study.wait();
    EXPECT_EQ(done.code, 128 + SIGHUP);
    EXPECT_THAT(done.err, HasSubstr("To go on, give the same command again"));
}

}  // namespace
}  // namespace morphodesic::tests

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
    ASSERT_EQ(run().code, 0);
    fs::remove(folder / "disks.study/distances.csv");
    fs::create_directories(folder / "disks.study/distances.csv/x");
    const Outcome done = run();
    EXPECT_EQ(done.code, 3);
    EXPECT_THAT(done.err, testing::AllOf(HasSubstr("distances.csv"), HasSubstr("move it away")));
    fs::remove_all(folder / "disks.study/distances.csv");
    ASSERT_EQ(run().code, 0);
    EXPECT_TRUE(fs::is_regular_file(folder / "disks.study/distances.csv"));
}

TEST_F(Surroundings, AFolderOfOthersIsRefusedAndLeftAsItIs) {
    ASSERT_EQ(run().code, 0);
    const std::string table = (folder / "disks.study/distances.csv").string(), first = disks() + "/disk-01.png",
                      home = (folder / "home").string();
    write_file(folder / "home/paths/thesis.txt", "thesis");
    write_file(folder / "home/placed.csv", "mine");
    write_file(folder / "home/report.html", "mine too");
    write_file(folder / "home/figures/path_to_work.png", "a map");
    const std::string before = shell("cd '" + home + "' && find . -type f | sort | xargs md5sum; find .").out;
    for (const std::vector<std::string>& command : {quick({"run", disks(), "--paths", "none"}),
                                                    quick({"ingest", disks()}),
                                                    {"report", table},
                                                    {"analyze", table},
                                                    {"figures", "2", "--quick"},
                                                    quick({"geodesic", first, disks() + "/disk-02.png"}),
                                                    quick({"classify", first, "--templates", disks()})}) {
        std::vector<std::string> words = command;
        words.insert(words.end(), {"--out", home});
        const Outcome done = morphodesic(words);
        EXPECT_EQ(done.code, 2) << command.front();
        EXPECT_THAT(done.err, testing::AllOf(HasSubstr(home + ": the folder is not empty"), HasSubstr("--out")));
    }
    EXPECT_EQ(shell("cd '" + home + "' && find . -type f | sort | xargs md5sum; find .").out, before);
    fs::create_directories(folder / "empty");
    EXPECT_EQ(run({"--out", (folder / "empty").string()}).code, 0);
}

TEST_F(Surroundings, FoldersOfThisProgramAreKnownAgain) {
    // A process that died before it wrote anything else.
    write_file(folder / "begun/study.lock", "");
    ASSERT_EQ(run({"--out", (folder / "begun").string()}).code, 0);
    // A study whose store was moved away, also one that is a copy without the lock.
    fs::remove(folder / "begun/study.sqlite");
    EXPECT_EQ(run({"--out", (folder / "begun").string()}).code, 0);
    fs::remove(folder / "begun/study.sqlite");
    fs::remove(folder / "begun/study.lock");
    EXPECT_EQ(run({"--out", (folder / "begun").string()}).code, 0);
    const std::string first = disks() + "/disk-01.png";
    for (const std::vector<std::string>& command : {{"report", (folder / "begun/distances.csv").string()},
                                                    quick({"geodesic", first, disks() + "/disk-02.png"}),
                                                    quick({"classify", first, "--templates", disks()})}) {
        for (int time = 1; time <= 3; ++time) {
            std::vector<std::string> words = command;
            words.insert(words.end(), {"--quiet", "--out", (folder / command.front()).string()});
            const Outcome done = morphodesic(words);
            EXPECT_EQ(done.code, 0) << command.front() << " for the time " << time << ": " << done.err;
            if (time == 2) fs::remove(folder / command.front() / "study.lock");
        }
    }
}

TEST_F(Surroundings, OfTheFoldersOfPathsOnlyWhatTheProgramWroteGoes) {
    ASSERT_EQ(run({"--paths", "all"}).code, 0);
    const fs::path paths = folder / "disks.study/paths";
    std::vector<fs::path> drawn(fs::directory_iterator(paths), fs::directory_iterator{});
    ASSERT_EQ(drawn.size(), 3U);
    const fs::path noted = drawn.front();
    write_file(noted / "note.txt", "look here");
    write_file(noted / "step-00.png.part", "of a run that was killed");
    write_file(paths / "thesis.txt", "thesis");
    write_file(paths / "holidays/step-00.png", "stairs");
    write_file(folder / "elsewhere/step-00.png", "mine");
    fs::create_directory_symlink(folder / "elsewhere", paths / "007_a_b");
    write_file(folder / "disks.study/paths.old/mine.txt", "old");
    ASSERT_EQ(run({"--paths", "none"}).code, 0);
    EXPECT_EQ(std::vector<fs::path>(fs::directory_iterator(noted), fs::directory_iterator{}),
              std::vector<fs::path>{noted / "note.txt"});
    EXPECT_FALSE(fs::exists(drawn.back()));
    for (const fs::path& file : {paths / "thesis.txt", paths / "holidays/step-00.png", folder / "elsewhere/step-00.png",
                                 folder / "disks.study/paths.old/mine.txt"}) {
        EXPECT_TRUE(fs::exists(file)) << file;
    }
    ASSERT_EQ(run({"--paths", "all"}).code, 0);
    EXPECT_TRUE(fs::exists(noted / "colours.json"));
}

TEST_F(Surroundings, ALockThatIsALinkIsNotFollowed) {
    ASSERT_EQ(run().code, 0);
    write_file(folder / "letter.txt", "Dear all");
    fs::remove(folder / "disks.study/study.lock");
    fs::create_symlink(folder / "letter.txt", folder / "disks.study/study.lock");
    const Outcome done = run();
    EXPECT_EQ(done.code, 3);
    EXPECT_THAT(done.err, HasSubstr("study.lock: is a link"));
    EXPECT_EQ(read_file(folder / "letter.txt"), "Dear all");
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

TEST_F(Surroundings, TooFewFilesThatMayBeOpenAreTheEnvironmentAndNotTheFolder) {
    const auto limited = [&](const std::string& limit) {
        return shell("ulimit " + limit + "; \"$MORPHODESIC\" run '" + disks() +
                     "' --level 4 --steps 2 --starts 1 --quiet");
    };
    const Outcome few = limited("-n 8");
    EXPECT_EQ(few.code, 3);
    EXPECT_THAT(few.err, testing::AllOf(HasSubstr("raise the limit, e.g. with ulimit -n"),
                                        testing::Not(HasSubstr("permissions"))));
    EXPECT_FALSE(fs::exists(folder / "disks.study"));
    const Outcome soft = limited("-S -n 8");  // a limit that the program may raise itself
    EXPECT_EQ(soft.code, 0) << soft.err;
}

TEST_F(Surroundings, TooFewThreadsAreSaidBeforeAnythingBegins) {
    if (sanitized) GTEST_SKIP() << "sanitizers start threads of their own";
    // Limits of processes do not bind the administrator: as a user that nobody is, who may still write here.
    const std::string nobody =
        "setpriv --reuid 64321 --clear-groups --inh-caps +dac_override,+dac_read_search --ambient-caps "
        "+dac_override,+dac_read_search ";
    if (shell(nobody + "true").code != 0) GTEST_SKIP() << "only the administrator may try";
    for (const char* limit : {"6", "8", "10"}) {
        const Outcome done = shell("ulimit -u " + std::string(limit) + "; exec " + nobody + "\"$MORPHODESIC\" run '" +
                                   disks() + "' --threads 4 --level 4 --steps 2 --starts 1 --quiet");
        EXPECT_EQ(done.code, 3) << limit << done.err;
        EXPECT_THAT(done.err, HasSubstr("raise the limit (ulimit -u"));
        EXPECT_FALSE(fs::exists(folder / "disks.study"));
    }
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

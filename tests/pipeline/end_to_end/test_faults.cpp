// What happens to a study when the process, the disk, the store or the user does something wrong.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "pipeline/study_folder.h"
#include "program.h"

namespace morphodesic::tests {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

/// Waits until the running program has come so far; false after half a minute.
template <class Condition>
bool wait_until(const Condition& reached) {
    for (int i = 0; i < 6000; ++i) {
        if (reached()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
}

/// Waits until that many pairs are stored.
bool wait_for_rows(const fs::path& study, long rows) {
    return wait_until([&] { return stored_rows(study) >= rows; });
}

/// Waits until that many paths of a study are drawn.
bool wait_for_paths(const fs::path& study, long paths) {
    return wait_until([&] {
        std::error_code error;  // for a moment the folder may not be there
        return std::distance(fs::directory_iterator(study / "paths", error), fs::directory_iterator()) >= paths;
    });
}

void execute(const fs::path& store, const std::string& sql) {
    sqlite3* connection = nullptr;
    ASSERT_EQ(sqlite3_open(store.c_str(), &connection), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(connection, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sql;
    sqlite3_close(connection);
}

/// A collection whose study takes a second or two, so that there is a middle to stop it in.
class StoppedStudy : public testing::Test {
protected:
    void SetUp() override {
        ASSERT_EQ(morphodesic({"datasets", "matchstick", "--out", men_.string(), "--count", "9", "--quiet"}).code, 0);
    }
    std::vector<std::string> command(const std::string& out) {
        return {"run",       men_.string(),
                "--out",     (folder_ / out).string(),
                "--level",   "5",
                "--steps",   "2",
                "--json",    "--quiet",
                "--paths",   "none",
                "--threads", "2"};
    }
    /// The study goes on where it was stopped and ends with the bytes of one that was never stopped.
    void expect_resumed(long at_least) {
        const json resumed = json::parse(morphodesic(command("stopped")).out);
        EXPECT_EQ(resumed["pairs"], 36);
        EXPECT_GE(resumed["pairs_from_store"], at_least);
        EXPECT_GT(resumed["pairs_computed"], 0);
        ASSERT_EQ(morphodesic(command("undisturbed")).code, 0);
        const std::string bytes = read_file(folder_ / "undisturbed/distances.csv");
        ASSERT_FALSE(bytes.empty());
        EXPECT_EQ(read_file(folder_ / "stopped/distances.csv"), bytes);
    }
    TemporaryFolder folder_;
    fs::path men_ = folder_ / "men";
};

TEST_F(StoppedStudy, KillLosesAtMostThePairsInFlight) {
    BackgroundRun run(command("stopped"));
    ASSERT_TRUE(wait_for_rows(folder_ / "stopped", 4));
    run.signal(SIGKILL);
    EXPECT_EQ(run.wait().code, 128 + SIGKILL);
    EXPECT_FALSE(fs::exists(folder_ / "stopped/distances.csv"));
    expect_resumed(4);
}

TEST_F(StoppedStudy, InterruptStopsInGoodOrderAndSaysHowToGoOn) {
    BackgroundRun run(command("stopped"));
    ASSERT_TRUE(wait_for_rows(folder_ / "stopped", 4));
    run.signal(SIGINT);
    const Outcome stopped = run.wait();
    EXPECT_EQ(stopped.code, 128 + SIGINT);
    EXPECT_THAT(stopped.err, HasSubstr("give the same command again"));
    expect_resumed(4);
}

TEST_F(StoppedStudy, AReportThatIsStoppedLeavesTheOneBefore) {
    ASSERT_EQ(morphodesic(command("study")).code, 0);
    const fs::path study = folder_ / "study";
    const std::string before = read_file(study / "report.html"), table = read_file(study / "clusters.csv");
    ASSERT_EQ(morphodesic({"report", study.string(), "--paths", "1", "--quiet"}).code, 0);
    const std::string good = read_file(study / "report.html");
    ASSERT_NE(good, before);
    // Enough paths to draw that the stop comes in their middle.
    BackgroundRun run({"report", study.string(), "--paths", "all", "--threads", "1"});
    ASSERT_TRUE(wait_for_paths(study, 2));
    run.signal(SIGINT);
    const Outcome stopped = run.wait();
    EXPECT_EQ(stopped.code, 128 + SIGINT);
    EXPECT_THAT(stopped.err, HasSubstr("report are as they were"));
    EXPECT_EQ(read_file(study / "report.html"), good);
    EXPECT_EQ(read_file(study / "clusters.csv"), table);
    EXPECT_FALSE(fs::exists(study / "paths.old"));
    // The same at the end of a run: all pairs are there, the report is not.
    auto all = command("fresh");
    *std::find(all.begin(), all.end(), "none") = "all";
    {
        BackgroundRun fresh(all);
        ASSERT_TRUE(wait_for_paths(folder_ / "fresh", 2));
        fresh.signal(SIGINT);
        const Outcome ended = fresh.wait();
        EXPECT_EQ(ended.code, 128 + SIGINT);
        EXPECT_THAT(ended.err, HasSubstr("36 of 36 pairs are in the store"));
        EXPECT_FALSE(fs::exists(folder_ / "fresh/report.html"));
    }
    EXPECT_EQ(morphodesic(all).code, 0);
    EXPECT_EQ(json::parse(read_file(folder_ / "fresh/report.json"))["paths"].size(), 36u);
}

TEST_F(StoppedStudy, TerminateIsTheSameAsInterrupt) {
    BackgroundRun run(command("stopped"));
    ASSERT_TRUE(wait_for_rows(folder_ / "stopped", 1));
    run.signal(SIGTERM);
    const Outcome stopped = run.wait();
    EXPECT_EQ(stopped.code, 128 + SIGTERM);
    EXPECT_THAT(stopped.err, HasSubstr("give the same command again"));
    expect_resumed(1);
}

TEST_F(StoppedStudy, ASecondProcessIsTurnedAwayAndTheFirstOneEndsWell) {
    BackgroundRun first(command("stopped"));
    ASSERT_TRUE(wait_for_rows(folder_ / "stopped", 1));
    const Outcome second = morphodesic(command("stopped"));
    EXPECT_EQ(second.code, 3);
    EXPECT_THAT(second.err, HasSubstr("another process works on this study"));
    const Outcome done = first.wait();
    EXPECT_EQ(done.code, 0) << done.err;
    EXPECT_EQ(json::parse(done.out)["pairs_computed"], 36);
}

TEST_F(StoppedStudy, AFullDiskEndsWithAdviceAndNothingIsLost) {
    // A limit on the size of files stands for the full disk: the store may not grow beyond it.
    std::string line = "ulimit -f 400; exec \"$MORPHODESIC\"";
    for (const std::string& word : command("stopped")) line += " '" + word + "'";
    const Outcome full = shell(line);
    EXPECT_EQ(full.code, 3) << full.err;
    EXPECT_THAT(full.err, HasSubstr("give the same command again"));
    const Outcome again = morphodesic(command("stopped"));
    EXPECT_EQ(again.code, 0) << again.err;
    ASSERT_EQ(morphodesic(command("undisturbed")).code, 0);
    EXPECT_EQ(read_file(folder_ / "stopped/distances.csv"), read_file(folder_ / "undisturbed/distances.csv"));
}

TEST_F(StoppedStudy, AReportThatDoesNotFitLeavesThatOfTheEarlierRun) {
    ASSERT_EQ(morphodesic(command("study")).code, 0);
    const auto results = [&] {
        std::map<std::string, std::string> bytes;
        for (const auto& entry : fs::directory_iterator(folder_ / "study")) {
            const std::string ending = entry.path().extension().string();
            if (ending != ".sqlite" && ending != ".lock" && entry.is_regular_file()) {
                bytes[entry.path().filename().string()] = read_file(entry.path());
            }
        }
        return bytes;
    };
    const auto before = results();
    ASSERT_GT(before.at("report.html").size(), 60u * 1024u);
    ASSERT_LT(before.at("clusters.csv").size(), 60u * 1024u);
    const std::string other = " report '" + (folder_ / "study").string() + "' --clusters 5 --paths 0";
    const Outcome full = shell("ulimit -f 60; exec \"$MORPHODESIC\"" + other);
    EXPECT_EQ(full.code, 3) << full.err;
    EXPECT_EQ(results(), before);
    // Nor one of whose files a folder has the place.
    for (const std::string name : {"placed.csv", "figures/page.svg"}) {
        const fs::path file = folder_ / "study" / name;
        fs::remove(file);
        fs::create_directories(file / "of the user");
        const Outcome blocked = shell("exec \"$MORPHODESIC\"" + other);
        EXPECT_EQ(blocked.code, 3);
        EXPECT_THAT(blocked.err, HasSubstr(name + ": cannot be written: "));
        EXPECT_THAT(blocked.err, HasSubstr("a folder stands where a file must be"));
        fs::remove_all(file);
    }
    EXPECT_EQ(shell("exec \"$MORPHODESIC\"" + other).code, 0);
    EXPECT_NE(results().at("clusters.csv"), before.at("clusters.csv"));
    // Two commands do not leave results of two states side by side without a word.
    const Outcome analyzed = morphodesic({"analyze", (folder_ / "study").string()});
    EXPECT_EQ(analyzed.code, 0) << analyzed.err;
    EXPECT_THAT(analyzed.out, HasSubstr("are those of an earlier run"));
    EXPECT_TRUE(results().contains("analysis.json"));
    EXPECT_EQ(shell("exec \"$MORPHODESIC\"" + other).code, 0);
    EXPECT_FALSE(results().contains("analysis.json"));
}

TEST_F(StoppedStudy, TooLittleAddressSpaceIsSaidBeforeAnythingBegins) {
    if (sanitized) GTEST_SKIP() << "sanitizers reserve more address space than is allowed here";
    std::string line = "ulimit -v 500000; exec \"$MORPHODESIC\"";
    for (const std::string& word : command("stopped")) line += " '" + word + "'";
    const Outcome cramped = shell(line);
    EXPECT_EQ(cramped.code, 3) << cramped.err;
    EXPECT_THAT(cramped.err, HasSubstr("ulimit -v unlimited"));
    EXPECT_FALSE(fs::exists(folder_ / "stopped"));
}

class DisturbedStore : public testing::Test {
protected:
    void SetUp() override {
        make_disks(folder_ / "disks", 4);
        ASSERT_EQ(morphodesic(command_).code, 0);
        bytes_ = read_file(folder_ / "disks.study/distances.csv");
    }
    TemporaryFolder folder_;
    fs::path store_ = folder_ / "disks.study/study.sqlite";
    std::vector<std::string> command_ = quick({"run", (folder_ / "disks").string(), "--json"});
    std::string bytes_;
};

TEST_F(DisturbedStore, AnotherVersionIsRefused) {
    execute(store_, "PRAGMA user_version = 99");
    const Outcome done = morphodesic(command_);
    EXPECT_EQ(done.code, 3);
    EXPECT_THAT(done.err, HasSubstr("newer morphodesic"));
    EXPECT_THAT(done.err, HasSubstr("--out"));
}

TEST_F(DisturbedStore, AForeignDatabaseIsRefused) {
    fs::remove(store_);
    execute(store_, "CREATE TABLE mine(x)");
    const Outcome done = morphodesic(command_);
    EXPECT_EQ(done.code, 3);
    EXPECT_THAT(done.err, HasSubstr("not the store"));
}

TEST_F(DisturbedStore, GarbageIsRefusedWithAdvice) {
    write_file(store_, std::string(5000, 'x'));
    const Outcome done = morphodesic(command_);
    EXPECT_EQ(done.code, 3);
    EXPECT_THAT(done.err, HasSubstr("damaged"));
}

/// Each command that opens the store of a study.
std::vector<std::vector<std::string>> commands_on(const fs::path& disks, const std::string& study) {
    return {
        quick({"run", disks.string(), "--out", study}),
        quick({"ingest", disks.string(), "--out", study}),
        {"geodesics", study},
        {"analyze", study},
        {"report", study},
        {"verify", study},
        {"plan", study, "--shards", "2"},
        {"merge", study, "results.jsonl"},
        quick({"classify", (disks / "disk-01.png").string(), "--templates", study, "--out", study + ".classified"})};
}

TEST_F(DisturbedStore, AFolderInItsPlaceIsSaid) {
    const std::string study = (folder_ / "disks.study").string();
    fs::remove(store_);
    fs::create_directory(store_);
    for (const auto& command : commands_on(folder_ / "disks", study)) {
        const Outcome done = morphodesic(command);
        EXPECT_EQ(done.code, 3) << command[0];
        EXPECT_THAT(done.err, HasSubstr("study.sqlite: a folder stands where the store must be; move it away"))
            << command[0];
    }
    EXPECT_TRUE(fs::is_empty(store_));
}

TEST_F(DisturbedStore, EmptyBesideResultsItIsLostAndNotNew) {
    const std::string study = (folder_ / "disks.study").string();
    fs::resize_file(store_, 0);
    for (const auto& command : commands_on(folder_ / "disks", study)) {
        const Outcome done = morphodesic(command);
        EXPECT_EQ(done.code, 3) << command[0];
        EXPECT_THAT(done.err, HasSubstr("study.sqlite: is empty, though results of the study lie beside it"))
            << command[0];
        EXPECT_EQ(fs::file_size(store_), 0U) << command[0];
    }
    fs::remove(store_);  // as the message says
    EXPECT_EQ(morphodesic(command_).code, 0);
    EXPECT_EQ(read_file(folder_ / "disks.study/distances.csv"), bytes_);
    // As a stop at its very beginning leaves a study.
    write_file(folder_ / "new/study.lock", "");
    write_file(folder_ / "new/study.sqlite", "");
    EXPECT_EQ(morphodesic(quick({"run", (folder_ / "disks").string(), "--out", (folder_ / "new").string()})).code, 0);
    EXPECT_EQ(read_file(folder_ / "new/distances.csv"), bytes_);
}

TEST_F(DisturbedStore, AChangedNumberIsFoundAndComputedAgain) {
    execute(store_, "UPDATE geodesics SET path_length = path_length * 1.001 WHERE a = (SELECT min(a) FROM geodesics)");
    const Outcome checked = morphodesic({"verify", (folder_ / "disks.study").string()});
    EXPECT_EQ(checked.code, 1);
    EXPECT_THAT(checked.out, HasSubstr("Without a trustworthy distance: 3 pairs"));
    EXPECT_THAT(checked.out, HasSubstr("disk-01.png - disk-0"));
    const Outcome analysed = morphodesic({"analyze", (folder_ / "disks.study").string(), "--quiet"});
    EXPECT_EQ(analysed.code, 1);
    EXPECT_THAT(analysed.err, HasSubstr("its stored result is damaged"));
    EXPECT_THAT(analysed.err, Not(HasSubstr("not computed yet")));
    EXPECT_THAT(read_file(folder_ / "disks.study/pairs.csv"), HasSubstr(",damaged,"));
    const Outcome done = morphodesic(command_);
    EXPECT_EQ(done.code, 0);
    EXPECT_THAT(done.err, HasSubstr("results of 3 pairs are damaged"));
    EXPECT_GT(json::parse(done.out)["pairs_computed"], 0);
    EXPECT_EQ(read_file(folder_ / "disks.study/distances.csv"), bytes_);
}

TEST_F(DisturbedStore, WhatIsLackingIsSaidOnTheErrorStreamOfQuietCommands) {
    execute(store_, "DELETE FROM geodesics WHERE a = (SELECT min(a) FROM geodesics)");
    const std::string study = (folder_ / "disks.study").string();
    const Outcome quiet = morphodesic({"analyze", study, "--quiet"});
    EXPECT_EQ(quiet.code, 1);
    EXPECT_THAT(quiet.err, HasSubstr("3 pairs are not computed yet; do it with: morphodesic geodesics"));
    const Outcome told = morphodesic({"analyze", study, "--json"});
    EXPECT_EQ(told.code, 1);
    EXPECT_THAT(json::parse(told.out)["remarks"].dump(), HasSubstr("3 pairs are not computed yet"));
}

TEST_F(DisturbedStore, ARefusedCommandLeavesTheStudyAsItWas) {
    const std::string study = (folder_ / "disks.study").string();
    for (const char* memory : {"lots", "1M"}) {
        EXPECT_EQ(morphodesic({"run", (folder_ / "disks").string(), "--memory", memory}).code, 2);
    }
    EXPECT_EQ(morphodesic({"analyze", study, "--quiet"}).code, 0);
    EXPECT_EQ(read_file(folder_ / "disks.study/distances.csv"), bytes_);
}

TEST_F(DisturbedStore, ARunThatFindsNoUsableFileLeavesTheStudyAsItWas) {
    const std::string study = (folder_ / "disks.study").string(), disks = (folder_ / "disks").string();
    const auto expect_refused = [&](const std::vector<std::string>& options, const char* words) {
        std::vector<std::string> command{"run", disks};
        command.insert(command.end(), options.begin(), options.end());
        const Outcome refused = morphodesic(quick(command));
        EXPECT_EQ(refused.code, 2);
        EXPECT_THAT(refused.out + refused.err, HasSubstr(words));
        const Outcome analysed = morphodesic({"analyze", study, "--quiet"});
        EXPECT_EQ(analysed.code, 0) << analysed.err;
        EXPECT_EQ(read_file(folder_ / "disks.study/distances.csv"), bytes_);
    };
    fs::rename(disks, folder_ / "aside");  // such as a disk that is not mounted
    fs::create_directories(disks);
    expect_refused({}, "no shapes found");
    write_file(folder_ / "disks/new.png", "no picture");
    expect_refused({}, "No file could be used");
    // Where sizes do not matter files are read only when they are taken in.
    expect_refused({"--normalize", "each", "--lambda", "1", "--json"}, "\"shapes_failed\": 1");
    fs::remove_all(disks);
    fs::rename(folder_ / "aside", disks);
    EXPECT_EQ(json::parse(morphodesic(command_).out)["pairs_computed"], 0);
}

TEST_F(DisturbedStore, AStudyWithoutUsableShapesIsRefusedAndKeepsItsTables) {
    const std::string study = (folder_ / "disks.study").string();
    execute(store_, "DELETE FROM shapes");
    for (const char* command : {"report", "analyze"}) {
        const Outcome done = morphodesic({command, study});
        EXPECT_EQ(done.code, 2) << command;
        EXPECT_THAT(done.err, HasSubstr("no shape that can be used")) << command;
        EXPECT_EQ(read_file(folder_ / "disks.study/distances.csv"), bytes_);
    }
}

TEST_F(DisturbedStore, ShapesOfAnotherLevelAreNotComparedUnderItsName) {
    const std::string study = (folder_ / "disks.study").string();
    const Outcome refused = morphodesic({"geodesics", study, "--level", "8"});
    EXPECT_EQ(refused.code, 2);
    EXPECT_THAT(refused.err, HasSubstr("read the files again with: morphodesic run"));
    EXPECT_EQ(morphodesic({"analyze", study, "--quiet"}).code, 0);
    EXPECT_EQ(read_file(folder_ / "disks.study/distances.csv"), bytes_);
}

TEST_F(DisturbedStore, AnUnfinishedReadingIsNotTakenForTheWholeCollection) {
    const std::string study = (folder_ / "disks.study").string();
    execute(store_, "DELETE FROM study WHERE key LIKE '%files_to_read'");
    execute(store_, "INSERT INTO study VALUES('files_to_read', '48')");
    for (const auto& command :
         std::vector<std::vector<std::string>>{{"geodesics", study}, {"plan", study, "--shards", "2"}}) {
        const Outcome refused = morphodesic(command);
        EXPECT_EQ(refused.code, 2) << command.front();
        EXPECT_THAT(refused.err, HasSubstr("reading its 48 files was stopped"));
    }
    const Outcome report = morphodesic({"report", study});
    EXPECT_EQ(report.code, 1);
    // With the options of the study, not those of a preset.
    EXPECT_THAT(report.out, HasSubstr("finish it with: morphodesic run " + (folder_ / "disks").string() +
                                      " --json --paths none --level 4 --steps 2 --starts 1"));
    EXPECT_THAT(read_file(folder_ / "disks.study/report.json"), HasSubstr("reading its 48 files was stopped"));
    EXPECT_EQ(morphodesic(command_).code, 0);
    EXPECT_EQ(morphodesic({"report", study}).code, 0);
}

TEST_F(DisturbedStore, ARowOfAShapeThatIsLostIsMissed) {
    const std::string study = (folder_ / "disks.study").string();
    execute(store_, "DELETE FROM shapes WHERE name = 'disk-02.png'");
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"verify", study}, {"report", study}, {"analyze", study}}) {
        const Outcome done = morphodesic(command);
        EXPECT_EQ(done.code, 1) << command.front() << done.err;
        EXPECT_THAT(done.out, HasSubstr("has lost 1 shape of the study; read the files again with: morphodesic run"));
    }
    EXPECT_EQ(morphodesic({"geodesics", study}).code, 2);
    EXPECT_EQ(morphodesic(command_).code, 0);
    EXPECT_EQ(read_file(folder_ / "disks.study/distances.csv"), bytes_);
    fs::remove(folder_ / "disks/disk-02.png");  // that one is not lost
    EXPECT_EQ(morphodesic(command_).code, 0);
    EXPECT_EQ(morphodesic({"analyze", study}).code, 0);
}

TEST_F(DisturbedStore, ATableThatIsMissingIsSaidWithARemedy) {
    execute(store_, "DROP TABLE geodesics");
    const Outcome done = morphodesic(command_);
    EXPECT_EQ(done.code, 3);
    EXPECT_THAT(done.err, testing::AllOf(HasSubstr("its table geodesics is missing"), HasSubstr("move it away")));
}

TEST_F(DisturbedStore, ComingBackToTheOptionsOfBeforeGivesTheDistancesOfBefore) {
    std::vector<std::string> detour = command_;
    detour.insert(detour.end(), {"--max-megapixels", "32"});
    ASSERT_EQ(morphodesic(detour).code, 0);
    EXPECT_EQ(read_file(folder_ / "disks.study/distances.csv"), bytes_);
    detour.back() = "64";
    detour.insert(detour.end(), {"--foreground", "dark"});
    static_cast<void>(morphodesic(detour));
    ASSERT_EQ(morphodesic(command_).code, 0);
    EXPECT_EQ(read_file(folder_ / "disks.study/distances.csv"), bytes_);
}

TEST_F(DisturbedStore, TwoThatWriteTheSameTablesDoNotMixThem) {
    const pipeline::StudyLock lock{pipeline::StudyFolder(folder_ / "disks.study")};
    const Outcome done = morphodesic({"analyze", (folder_ / "disks.study").string()});
    EXPECT_EQ(done.code, 3);
    EXPECT_THAT(done.err, HasSubstr("another process works on this study"));
}

TEST_F(DisturbedStore, WhatDoesNotReadTheFilesLeavesADamagedShapeOutAndSaysSo) {
    const std::string study = (folder_ / "disks.study").string();
    for (const char* change :
         {"content_digest = (SELECT content_digest FROM shapes WHERE name = 'disk-03.png')", "volume = volume * 2",
          "label = 'square'", "notes = '[\"changed\"]'", "dimension = 3", "scale = scale * 2"}) {
        execute(store_, std::string("UPDATE shapes SET ") + change + " WHERE name = 'disk-01.png'");
        for (const std::vector<std::string>& command : {std::vector<std::string>{"verify", study},
                                                        {"report", study},
                                                        {"analyze", study},
                                                        {"geodesics", study},
                                                        {"plan", study, "--shards", "2"}}) {
            const Outcome done = morphodesic(command);
            EXPECT_EQ(done.code, 1) << command.front() << change << done.err;
            EXPECT_THAT(done.out, testing::AllOf(HasSubstr("disk-01.png is damaged"), HasSubstr("morphodesic ingest")));
        }
        EXPECT_THAT(read_file(folder_ / "disks.study/distances.csv"), testing::Not(HasSubstr("disk-01.png")));
        const Outcome done = morphodesic(command_);  // it reads the file again
        EXPECT_EQ(done.code, 0) << change << done.err;
        EXPECT_EQ(read_file(folder_ / "disks.study/distances.csv"), bytes_) << change;
        EXPECT_EQ(morphodesic({"verify", study}).code, 0) << change;
    }
}

TEST_F(DisturbedStore, ALockedStoreEndsWithAdvice) {
    sqlite3* connection = nullptr;
    ASSERT_EQ(sqlite3_open(store_.c_str(), &connection), SQLITE_OK);
    ASSERT_EQ(sqlite3_exec(connection, "BEGIN IMMEDIATE", nullptr, nullptr, nullptr), SQLITE_OK);
    const Outcome done = morphodesic(command_);
    EXPECT_EQ(done.code, 3);
    EXPECT_THAT(done.err, HasSubstr("locked"));
    sqlite3_close(connection);
}

TEST_F(DisturbedStore, NobodyIsSentToAnOptionThatTheCommandDoesNotHave) {
    const std::string study = (folder_ / "disks.study").string();
    const auto expect_no_option = [&](const char* words) {
        for (const char* command : {"report", "geodesics", "merge", "plan"}) {
            std::vector<std::string> line{command, study};
            if (std::string(command) == "plan") line.insert(line.end(), {"--shards", "2"});
            const Outcome done = morphodesic(line);
            EXPECT_EQ(done.code, 3) << command;
            EXPECT_THAT(done.err, testing::AllOf(HasSubstr(words), testing::Not(HasSubstr("with --out")))) << command;
        }
    };
    const int lock = ::open((study + "/study.lock").c_str(), O_RDWR | O_CLOEXEC);
    ASSERT_EQ(::flock(lock, LOCK_EX), 0);
    expect_no_option("another process works on this study");
    ::close(lock);
    execute(store_, "PRAGMA application_id = 7");
    expect_no_option("not the store");
}

}  // namespace
}  // namespace morphodesic::tests

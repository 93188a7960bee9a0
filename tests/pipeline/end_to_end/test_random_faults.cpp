// Faults at random places and moments. A few here; tests/faults N does it N times.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <regex>
#include <set>
#include <sstream>
#include <thread>

#include "program.h"

namespace morphodesic::tests {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

int repeats() {
    const char* asked = std::getenv("MORPHODESIC_FAULTS");
    return asked ? std::atoi(asked) : 3;
}

/// Makes a folder with a file system of its own, of so many bytes as mount has it; false if this user may not.
bool mounted(const fs::path& folder, const std::string& size) {
    fs::create_directories(folder);
    return shell("mount -t tmpfs -o size=" + size + " tmpfs '" + folder.string() + "'").code == 0;
}

class RandomFaults : public testing::Test {
protected:
    void SetUp() override {
        ASSERT_EQ(
            morphodesic({"datasets", "matchstick", "--out", men_.string(), "--count", "5", "--size", "64", "--quiet"})
                .code,
            0);
        const auto begin = std::chrono::steady_clock::now();
        const Outcome done = morphodesic(command_);
        ASSERT_EQ(done.code, 0) << done.err;
        duration_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        bytes_ = read_file(study_ / "distances.csv");
        ASSERT_FALSE(bytes_.empty());
    }
    void sql(const std::string& text) const {
        sqlite3* connection = nullptr;
        ASSERT_EQ(sqlite3_open((study_ / "study.sqlite").c_str(), &connection), SQLITE_OK);
        EXPECT_EQ(sqlite3_exec(connection, text.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << text;
        sqlite3_close(connection);
    }
    /// The same command again ends well and with the bytes of the undisturbed run.
    void expect_healed(const std::string& what) const {
        const Outcome again = morphodesic(command_);
        EXPECT_EQ(again.code, 0) << what << "\n" << again.err;
        EXPECT_EQ(read_file(study_ / "distances.csv"), bytes_) << what;
    }
    /// The store is called damaged; what the message says to do makes the same command end well.
    void expect_refused_with_advice_that_helps() const {
        EXPECT_EQ(morphodesic({"analyze", study_.string()}).code, 3);
        const Outcome refused = morphodesic(command_);
        EXPECT_EQ(refused.code, 3) << refused.err;
        std::smatch advice;
        ASSERT_TRUE(
            std::regex_search(refused.err, advice, std::regex("sqlite3 study.sqlite .*mv saved.sqlite study.sqlite")))
            << refused.err;
        const Outcome kept = shell("cd '" + study_.string() + "' && " + advice.str());
        EXPECT_EQ(kept.code, 0) << kept.err;
        EXPECT_EQ(stored_rows(study_), 10);  // nothing was computed yet
        expect_healed("what could be read of a broken store");
    }
    TemporaryFolder folder_;
    fs::path men_ = folder_ / "men", study_ = folder_ / "men.study";
    std::vector<std::string> command_ =
        quick({"run", men_.string(), "--json", "--quiet", "--paths", "none", "--threads", "2"});
    double duration_ = 0.0;
    std::string bytes_;
    std::mt19937_64 random_{std::random_device{}()};
};

TEST_F(RandomFaults, KilledAtAnyMoment) {
    std::uniform_real_distribution<double> moment(0.0, duration_);
    int killed = 0, tries = 0;  // some runs are over before the signal comes: they do not count
    for (; killed < repeats() && tries < 10 * repeats(); ++tries) {
        if (tries % 3 == 0) fs::remove_all(study_);  // else the next kill hits a study that is there already
        fs::remove(study_ / "distances.csv");
        const double wait = moment(random_);
        BackgroundRun run(command_);
        std::this_thread::sleep_for(std::chrono::duration<double>(wait));
        run.signal(SIGKILL);
        killed += run.wait().code == 128 + SIGKILL ? 1 : 0;
        if (tries % 2 == 0) expect_healed("killed after " + std::to_string(wait) + " s");
    }
    EXPECT_EQ(killed, repeats()) << "of " << tries << " runs";
    RecordProperty("killed", killed);
    RecordProperty("tries", tries);
    expect_healed("killed for the last time");
}

TEST_F(RandomFaults, AFlippedBitAnywhereInTheStoreNeverChangesADistance) {
    fs::copy(study_, folder_ / "sound", fs::copy_options::recursive);
    for (int i = 0; i < 2 * repeats(); ++i) {
        fs::remove_all(study_);
        fs::copy(folder_ / "sound", study_, fs::copy_options::recursive);
        fs::remove(study_ / "distances.csv");
        std::string store = read_file(study_ / "study.sqlite");
        const std::size_t offset = random_() % store.size();
        store[offset] = static_cast<char>(store[offset] ^ (1 << random_() % 8));
        write_file(study_ / "study.sqlite", store);
        const std::string what = "flipped a bit of byte " + std::to_string(offset);
        // Who does not read the files again either has the right distances or says what is missing.
        if (morphodesic({"analyze", study_.string(), "--quiet"}).code == 0) {
            EXPECT_EQ(read_file(study_ / "distances.csv"), bytes_) << what;
        }
        fs::remove(study_ / "distances.csv");
        const Outcome done = morphodesic(command_);
        if (done.code == 0) {
            EXPECT_EQ(read_file(study_ / "distances.csv"), bytes_) << what;
            continue;
        }
        EXPECT_EQ(done.code, 3) << what << "\n" << done.err;
        EXPECT_FALSE(fs::exists(study_ / "distances.csv")) << what;
        EXPECT_THAT(done.err, HasSubstr("study.sqlite")) << what;
        fs::remove_all(study_);  // the advice that always helps
        expect_healed(what);
    }
}

TEST_F(RandomFaults, ADamagedFactOrShapeIsReadAnew) {
    for (const char* damage :
         {"UPDATE study SET value = value * 0.9 WHERE key = 'common_scale'",
          "UPDATE study SET value = 'xyz' WHERE key = 'settings'",
          "UPDATE study SET value = '7' WHERE key = 'dimension'",
          "UPDATE shapes SET extent_radius = extent_radius * 1.5", "UPDATE shapes SET content_digest = 'nothing'",
          "UPDATE shapes SET notes = '[oops'", "UPDATE level_sets SET u = zeroblob(100)",
          "UPDATE pictures SET bytes = zeroblob(100)", "DELETE FROM level_sets"}) {
        sql(damage);
        expect_healed(damage);
    }
}

TEST_F(RandomFaults, ADamagedFactIsNotUsedByThoseWhoOnlyRead) {
    sql("UPDATE study SET value = replace(value, '4', '5') WHERE key = 'settings'");
    const Outcome done = morphodesic({"verify", study_.string()});
    EXPECT_EQ(done.code, 3);
    EXPECT_THAT(done.err, HasSubstr("morphodesic run"));
}

TEST_F(RandomFaults, WhatIsSoundInABrokenStoreCanBeKeptAsTheMessageSays) {
    if (shell("command -v sqlite3").code != 0) GTEST_SKIP() << "sqlite3 is not installed";
    std::string store = read_file(study_ / "study.sqlite");
    // The page of the index of one table: the tree is broken, the rows of all tables are there.
    const std::size_t page = 4096;
    std::size_t broken = 0;
    for (std::size_t at = page; at + page <= store.size() && broken == 0; at += page) {
        if (store[at] == 0x0a && store.compare(at + page - 200, 200, std::string(200, '\0')) != 0) broken = at;
    }
    ASSERT_GT(broken, 0u);
    store[broken + 3] = 0x7f;  // cells that are not there
    write_file(study_ / "study.sqlite", store);
    expect_refused_with_advice_that_helps();
}

TEST_F(RandomFaults, KeysOutOfOrderAreFoundThoughEveryRowCanBeRead) {
    // A search in such a tree misses rows that are there: their pairs would be left empty, and nothing would fail.
    if (shell("command -v sqlite3").code != 0) GTEST_SKIP() << "sqlite3 is not installed";
    std::string store = read_file(study_ / "study.sqlite"), key;
    sqlite3* connection = nullptr;
    ASSERT_EQ(sqlite3_open((study_ / "study.sqlite").c_str(), &connection), SQLITE_OK);
    const auto read_key = [](void* to, int, char** columns, char**) {
        *static_cast<std::string*>(to) = columns[0];
        return 0;
    };
    ASSERT_EQ(sqlite3_exec(connection, "SELECT settings || a || b FROM geodesics ORDER BY a, b LIMIT 1 OFFSET 4",
                           read_key, &key, nullptr),
              SQLITE_OK);
    sqlite3_close(connection);
    const std::size_t place = store.find(key);
    ASSERT_NE(place, std::string::npos);
    store[place] = 'z';  // the middle one of ten keys is now the greatest
    write_file(study_ / "study.sqlite", store);
    expect_refused_with_advice_that_helps();
}

TEST_F(RandomFaults, AReadOnlyStudyEndsWithAdvice) {
    // As a user whom permissions bind: root writes everywhere.
    std::string line = "chmod 755 '" + folder_.path().string() + "'; chmod -R a+rX,a-w '" + study_.string() + "'; ";
    if (::geteuid() == 0) line += "exec setpriv --reuid 65534 --regid 65534 --clear-groups ";
    line += "\"$MORPHODESIC\"";
    for (const std::string& word : command_) line += " '" + word + "'";
    const Outcome done = shell(line);
    EXPECT_EQ(done.code, 3) << done.err;
    EXPECT_THAT(done.err, HasSubstr("permissions"));
    EXPECT_EQ(read_file(study_ / "distances.csv"), bytes_);
    ASSERT_EQ(shell("chmod -R u+w '" + study_.string() + "'").code, 0);
    expect_healed("read-only");
}

TEST_F(RandomFaults, AFullFileSystemEndsWithAdviceAndNothingIsLost) {
    const fs::path disk = folder_ / "disk";
    if (!mounted(disk, "300k")) GTEST_SKIP() << "only root can make a small file system";
    const auto command = [&] {
        auto words = command_;
        words.insert(words.end(), {"--out", (disk / "study").string()});
        return words;
    }();
    const Outcome full = morphodesic(command);
    EXPECT_EQ(full.code, 3) << full.err;
    EXPECT_THAT(full.err, HasSubstr("give the same command again"));
    EXPECT_FALSE(fs::exists(disk / "study/distances.csv"));
    EXPECT_EQ(shell("mount -o remount,size=50m '" + disk.string() + "'").code, 0);
    const Outcome again = morphodesic(command);
    EXPECT_EQ(again.code, 0) << again.err;
    EXPECT_EQ(read_file(disk / "study/distances.csv"), bytes_);
    EXPECT_EQ(shell("umount '" + disk.string() + "'").code, 0);
}

TEST_F(RandomFaults, AShardOnAFullFileSystemEndsWithAMessageAndGoesOnLater) {
    const fs::path disk = folder_ / "disk";
    ASSERT_EQ(morphodesic(quick({"ingest", men_.string(), "--out", (folder_ / "p.study").string()})).code, 0);
    ASSERT_EQ(morphodesic({"plan", (folder_ / "p.study").string(), "--shards", "1"}).code, 0);
    for (const char* size : {"4k", "8k", "8k", "12k", "12k"}) {
        if (!mounted(disk, size)) GTEST_SKIP() << "only root can make a small file system";
        const std::vector<std::string> shard{
            "shard", (folder_ / "p.study").string(), "1/1", "--out", disk / "r.jsonl", "--threads", "4"};
        const Outcome done = morphodesic(shard);
        EXPECT_EQ(done.code, 3) << size << done.err;
        EXPECT_THAT(done.err, HasSubstr("r.jsonl")) << size;
        EXPECT_EQ(shell("mount -o remount,size=10m '" + disk.string() + "'").code, 0);
        const Outcome later = morphodesic(shard);
        EXPECT_EQ(later.code, 0) << size << later.err;
        EXPECT_EQ(morphodesic({"merge", (folder_ / "p.study").string(), disk / "r.jsonl"}).code, 0) << size;
        EXPECT_EQ(shell("umount '" + disk.string() + "'").code, 0);
    }
    ASSERT_EQ(morphodesic({"analyze", (folder_ / "p.study").string()}).code, 0);
    EXPECT_EQ(read_file(folder_ / "p.study/distances.csv"), bytes_);
}

TEST_F(RandomFaults, AFullFileSystemLeavesTheResultsOfTheLastClassification) {
    const fs::path disk = folder_ / "disk", results = disk / "results";
    if (!mounted(disk, "50m")) GTEST_SKIP() << "only root can make a small file system";
    make_disks(folder_ / "queries", 2);
    std::vector<std::string> command =
        quick({"classify", "one of them", "--templates", men_.string(), "--out", results.string(), "--quiet"});
    for (const auto& entry : fs::directory_iterator(folder_ / "queries")) {
        if (entry.path().extension() == ".png") command[1] = entry.path().string();
    }
    const Outcome first = morphodesic(command);
    EXPECT_EQ(first.code, 0) << first.err;
    const auto everything = [&] {
        std::map<std::string, std::string> files;
        for (const auto& entry : fs::directory_iterator(results)) {
            if (entry.path().extension() != ".lock") files[entry.path().filename()] = read_file(entry.path());
        }
        return files;
    };
    const auto before = everything();
    EXPECT_EQ(before.size(), 4u);
    // Room for the tables of a second run, but not for its page.
    const auto size = [&](const std::string& more) {
        return shell("used=$(df --output=used -B1024 '" + disk.string() +
                     "' | tail -n 1) && mount -o remount,size=$((used" + more + "))k '" + disk.string() + "'");
    };
    EXPECT_EQ(size("+12").code, 0);
    command[1] = (folder_ / "queries").string();
    const Outcome full = morphodesic(command);
    EXPECT_EQ(full.code, 3) << full.err;
    EXPECT_THAT(full.err, HasSubstr("is not kept: free some space, then give the same command again"));
    EXPECT_THAT(full.err, Not(HasSubstr("is lost")));
    EXPECT_TRUE(everything() == before);
    EXPECT_EQ(size("+9000").code, 0);
    const Outcome again = morphodesic(command);
    EXPECT_EQ(again.code, 0) << again.err;
    const auto after = everything();
    EXPECT_EQ(after.size(), 4u);
    for (const auto& [name, bytes] : before) EXPECT_NE(after.at(name), bytes) << name;
    EXPECT_EQ(shell("umount '" + disk.string() + "'").code, 0);
}

TEST_F(RandomFaults, FilesThatChangeOrGoDuringTheRunDoNotReachItsResults) {
    const fs::path copy = folder_ / "copy";
    fs::copy(men_, copy, fs::copy_options::recursive);
    const auto command = quick({"run", copy.string(), "--json", "--quiet", "--paths", "none", "--threads", "1"});
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(copy)) {
        if (entry.path().extension() == ".png") files.push_back(entry.path());
    }
    ASSERT_EQ(files.size(), 5u);
    const fs::path study = folder_ / "copy.study";
    BackgroundRun run(command);
    for (int i = 0; i < 6000 && stored_rows(study) == 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    fs::remove(files[0]);
    write_file(files[1], "not an image any more");
    const Outcome done = run.wait();
    // All files had been read before the first pair was computed.
    EXPECT_EQ(done.code, 0) << done.err;
    EXPECT_EQ(read_file(study / "distances.csv"), bytes_);
    const Outcome next = morphodesic(command);
    EXPECT_EQ(next.code, 1) << next.err;
    EXPECT_EQ(json::parse(next.out)["shapes"], 3);
    fs::copy(men_, copy, fs::copy_options::recursive | fs::copy_options::overwrite_existing);
    const Outcome back = morphodesic(command);
    EXPECT_EQ(back.code, 0) << back.err;
    EXPECT_EQ(json::parse(back.out)["pairs_computed"], 0);
    EXPECT_EQ(read_file(study / "distances.csv"), bytes_);
}

TEST_F(RandomFaults, APairThatDidNotConvergeIsNeverANumber) {
    auto command = command_;
    command.insert(command.end(), {"--max-iterations", "1"});
    const Outcome done = morphodesic(command);
    EXPECT_EQ(done.code, 1) << done.err;
    const json summary = json::parse(done.out);
    EXPECT_EQ(summary["pairs_failed"], 10);
    EXPECT_EQ(summary["failures"].size(), 14u);  // the pairs, and four shapes that nothing joins to the first
    EXPECT_EQ(summary["shapes_left_out"], 4);
    std::istringstream lines(read_file(study_ / "distances.csv"));
    std::string line;
    std::getline(lines, line);
    for (int row = 0; row < 5; ++row) {
        ASSERT_TRUE(std::getline(lines, line));
        std::string expected;
        for (int column = 0; column < 5; ++column) expected += column == row ? ",0" : ",";
        EXPECT_THAT(line, testing::EndsWith("png" + expected));
    }
    expect_healed("no iterations");  // the results of other settings are still there
}

/// Bytes of memory that a process holds right now; 0 if it is gone.
double resident_megabytes(pid_t process) {
    std::istringstream status(read_file("/proc/" + std::to_string(process) + "/status"));
    for (std::string line; std::getline(status, line);) {
        if (line.rfind("VmRSS:", 0) == 0) return std::stod(line.substr(6)) / 1024;
    }
    return 0;
}

TEST(Soak, ManyPairsTakeNoMoreMemoryThanFew) {
    const char* asked = std::getenv("MORPHODESIC_SOAK");  // shapes
    const int shapes = asked ? std::atoi(asked) : 60;
    const long pairs = static_cast<long>(shapes) * (shapes - 1) / 2;
    const TemporaryFolder folder;
    const std::string men = (folder / "men").string();
    ASSERT_EQ(morphodesic({"datasets", "matchstick", "--out", men, "--count", std::to_string(shapes), "--size", "64",
                           "--quiet"})
                  .code,
              0);
    ASSERT_EQ(morphodesic({"ingest", men, "--quiet"}).code, 0);
    if (sanitized) {  // the address sanitizer keeps what was given back, to catch who uses it late
        const char* options = std::getenv("ASAN_OPTIONS");
        ::setenv(
            "ASAN_OPTIONS",
            (std::string(options ? options : "") + ":quarantine_size_mb=0:thread_local_quarantine_size_kb=0").c_str(),
            1);
    }
    BackgroundRun study(
        {"geodesics", men + ".study", "--level", "4", "--steps", "1", "--starts", "1", "--threads", "2", "--quiet"});
    std::vector<std::pair<long, double>> samples;  // pairs done, megabytes
    for (long rows = 0; rows < pairs;) {
        const double megabytes = resident_megabytes(study.process());
        rows = stored_rows(men + ".study");
        if (megabytes == 0) break;
        samples.emplace_back(rows, megabytes);
        std::this_thread::sleep_for(std::chrono::milliseconds(asked ? 200 : 20));
    }
    const Outcome done = study.wait();
    ASSERT_EQ(done.code, 0) << done.err;
    double early = 0, late = 0;
    for (const auto& [rows, megabytes] : samples) {
        if (asked) std::cout << rows << " pairs, " << megabytes << " MB\n";
        if (rows >= pairs / 4 && rows <= pairs / 2) early = std::max(early, megabytes);
        if (rows > pairs / 2) late = std::max(late, megabytes);
    }
    ASSERT_GT(early, 0);
    ASSERT_GT(late, 0);
    // Both ranges begin when the allocator has what it keeps (after some 150 pairs; before, 5 MB are still to come).
    // What may grow is the list of what is done; a leak of 8 kB a pair would be 7 MB here.
    EXPECT_LT(late, early + 3 + static_cast<double>(pairs) * 5e-4);
}

TEST_F(RandomFaults, ClockThatJumpsChangesNothing) {
    const Outcome library = shell("ls /usr/lib/*/faketime/libfaketimeMT.so.1");
    if (library.code != 0) GTEST_SKIP() << "libfaketime is not installed (Debian: libfaketime)";
    const std::string preload = library.out.substr(0, library.out.find('\n'));
    const fs::path clock = folder_ / "clock";
    fs::remove_all(study_);
    // All clocks of the process: the time of day, and the one that only grows (which then does not).
    // A sanitizer's allocator asks for the time while it holds its lock; the clock must not read a file then. There it
    // runs fast instead, from another year.
    std::string line = "export LD_PRELOAD=" + preload + " FAKETIME_NO_CACHE=1 " +
                       (sanitized ? "FAKETIME='-400d x3000'" : "FAKETIME_TIMESTAMP_FILE='" + clock.string() + "'") +
                       "; for offset in +0 -400d +4000d -1h +0; do echo $offset > '" + clock.string() +
                       "'; sleep 0.1; done & exec \"$MORPHODESIC\"";
    write_file(clock, "+0\n");
    for (const std::string& word : command_) line += " '" + word + "'";
    const Outcome done = shell("(" + line + ")");
    EXPECT_EQ(done.code, 0) << done.err;
    EXPECT_EQ(read_file(study_ / "distances.csv"), bytes_);
    const double seconds = json::parse(done.out)["seconds_of_all_runs"];
    EXPECT_GE(seconds, 0);
    expect_healed("a clock that jumped");
}

TEST(Clock, NothingDependsOnTheTimeOfDay) {
    const std::regex clocks(
        R"(system_clock|high_resolution_clock|gettimeofday|CLOCK_REALTIME|timespec_get|\btime\((nullptr|NULL|0|&))");
    std::set<std::string> found;
    for (const char* folder : {"pipeline", "geodesic", "analysis", "datasets", "reports"}) {
        for (const auto& entry : fs::recursive_directory_iterator(fs::path(MORPHODESIC_SOURCE_DIR) / folder)) {
            if (entry.path().extension() != ".cpp" && entry.path().extension() != ".h") continue;
            std::istringstream lines(read_file(entry.path()));
            for (std::string line; std::getline(lines, line);) {
                if (std::regex_search(line, clocks)) found.insert(entry.path().filename().string());
            }
        }
    }
    EXPECT_THAT(found, testing::ElementsAre("report_provenance.cpp"));  // the date on the page
}

}  // namespace
}  // namespace morphodesic::tests

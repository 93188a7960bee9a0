// Whose files plan, shard and merge write, cut off and read.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "program.h"

namespace morphodesic::tests {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

/// A study of four disks, planned in two shards.
class ShardFiles : public testing::Test {
protected:
    void SetUp() override {
        make_disks(folder / "disks", 4);
        ASSERT_EQ(morphodesic(quick({"ingest", (folder / "disks").string(), "--out", study(), "--quiet"})).code, 0);
        ASSERT_EQ(morphodesic({"plan", study(), "--shards", "2", "--quiet"}).code, 0);
    }
    [[nodiscard]] std::string study() const { return (folder / "study").string(); }
    [[nodiscard]] Outcome shard(const fs::path& out, const std::string& which = "1/2") const {
        return morphodesic({"shard", study(), which, "--out", out.string(), "--quiet"});
    }
    TemporaryFolder folder;
};

TEST_F(ShardFiles, FilesOfOthersAreRefusedAndStayAsTheyWere) {
    const fs::path mine = folder / "mine.jsonl";
    ASSERT_EQ(shard(mine).code, 0);
    const std::string sound = read_file(mine), head = sound.substr(0, sound.find('\n') + 1);
    std::string damaged = sound, other = sound;
    damaged[damaged.find("\"settings\":\"") + 14] ^= 1;
    other.replace(other.find("\"checksum\":\"") + 12, 4, "abcd");
    const std::vector<std::string> foreign = {
        "line 1\nprecious last line",
        "my notes without newline",
        "\n",
        "{\"format\":7}\nx",
        "{\"format\":\"morphodesic shard\",\"version\":\"one\"}\nx",
        damaged + "{\"a",
        "{\"checksum\":\"of other settings",
        other.substr(0, head.size() - 1),
        head.substr(0, head.size() - 1) + "?",
        std::string(100, '\0'),
    };
    for (const std::string& bytes : foreign) {
        const fs::path file = folder / "file";
        write_file(file, bytes);
        const auto time = fs::last_write_time(file);
        const Outcome refused = shard(file);
        EXPECT_EQ(refused.code, 3) << bytes;
        EXPECT_THAT(refused.err, HasSubstr("--out")) << bytes;
        EXPECT_EQ(read_file(file), bytes);
        EXPECT_EQ(fs::last_write_time(file), time);
    }
    for (const std::string name : {"study.sqlite", "shards/plan.sqlite"}) {
        const std::string before = read_file(folder / "study" / name);
        EXPECT_EQ(shard(folder / "study" / name).code, 3);
        EXPECT_EQ(read_file(folder / "study" / name), before);
    }
    // Of the same shapes, but with other settings: also with a line that was not finished.
    const std::string disks = (folder / "disks").string();
    ASSERT_EQ(morphodesic({"ingest", disks, "--out", study(), "--level", "4", "--steps", "1", "--quiet"}).code, 0);
    ASSERT_EQ(morphodesic({"plan", study(), "--shards", "2", "--quiet"}).code, 0);
    write_file(mine, sound + "{\"a");
    const Outcome refused = shard(mine);
    EXPECT_EQ(refused.code, 3);
    EXPECT_THAT(refused.err, HasSubstr("other settings"));
    EXPECT_EQ(read_file(mine), sound + "{\"a");
}

TEST_F(ShardFiles, WhatAStopLeftIsTakenUp) {
    const fs::path file = folder / "mine.jsonl";
    ASSERT_EQ(shard(file).code, 0);
    const std::string sound = read_file(file), head = sound.substr(0, sound.find('\n') + 1);
    // Nothing, a part of the header, the header without its end and with it, a part of the first and the last line.
    for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{30}, head.size() - 1, head.size(),
                                   head.size() + 9, sound.size() - 1}) {
        write_file(file, sound.substr(0, size));
        EXPECT_EQ(shard(file).code, 0) << size;
        const std::string bytes = read_file(file);
        EXPECT_EQ(bytes.substr(0, head.size()), head) << size;
        EXPECT_EQ(std::count(bytes.begin(), bytes.end(), '\n'), std::count(sound.begin(), sound.end(), '\n')) << size;
    }
}

TEST_F(ShardFiles, BlankLinesAndAMissingLastLineEndAreNoDamage) {
    const fs::path mine = folder / "mine.jsonl";
    ASSERT_EQ(shard(mine).code, 0);
    const std::string whole = read_file(mine), head = whole.substr(0, whole.find('\n') + 1);
    const auto merged = [&](const std::string& bytes) {
        write_file(folder / "edited.jsonl", bytes);
        fs::remove_all(folder / "copy");
        fs::copy(folder / "study", folder / "copy", fs::copy_options::recursive);
        const Outcome done =
            morphodesic({"merge", (folder / "copy").string(), (folder / "edited.jsonl").string(), "--json"});
        EXPECT_THAT(done.out + done.err, testing::Not(HasSubstr("damaged")));
        return json::parse(done.out)["pairs_added"].get<long>();
    };
    const long all = merged(whole);
    EXPECT_GT(all, 1);
    EXPECT_EQ(merged(head + "\n \r\n" + whole.substr(head.size()) + "\n"), all);
    const std::string without_end = whole.substr(0, whole.size() - 1);
    EXPECT_EQ(merged(without_end), all);
    // Its row is taken up as it is, and only the line end is written.
    write_file(mine, without_end);
    ASSERT_EQ(shard(mine).code, 0);
    EXPECT_EQ(read_file(mine), whole);
}

TEST_F(ShardFiles, OnlyAFileOrALinkToOneTakesResults) {
    fs::create_directory(folder / "dir");
    EXPECT_THAT(shard(folder / "dir").err, HasSubstr("is a folder"));
    fs::create_symlink(folder / "dir", folder / "to_dir");
    EXPECT_THAT(shard(folder / "to_dir").err, HasSubstr("is a folder"));
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    const Outcome pipe = shard(folder / "pipe");  // and does not wait for a reader
    EXPECT_EQ(pipe.code, 3);
    EXPECT_THAT(pipe.err, HasSubstr("another one with --out"));
    EXPECT_EQ(shard("/dev/null").code, 3);
    EXPECT_EQ(shard(folder / "nowhere/file").code, 3);

    write_file(folder / "notes", "mine");
    fs::create_symlink(folder / "notes", folder / "to_notes");
    EXPECT_EQ(shard(folder / "to_notes").code, 3);
    EXPECT_EQ(read_file(folder / "notes"), "mine");
    // Results may lie on another disk; the link stays one.
    fs::create_symlink(folder / "dir/results", folder / "to_results");
    EXPECT_EQ(shard(folder / "to_results").code, 0);
    const std::string bytes = read_file(folder / "dir/results");
    EXPECT_THAT(bytes, HasSubstr("morphodesic shard"));
    EXPECT_EQ(shard(folder / "to_results").code, 0);
    EXPECT_EQ(read_file(folder / "dir/results"), bytes);
    EXPECT_TRUE(fs::is_symlink(folder / "to_results"));
}

TEST_F(ShardFiles, PutTogetherInOneAreNoDamage) {
    const fs::path first = folder / "1.jsonl", second = folder / "2.jsonl", all = folder / "all.jsonl";
    ASSERT_EQ(shard(first).code, 0);
    ASSERT_EQ(shard(second, "2/2").code, 0);
    write_file(all, read_file(first) + read_file(second));
    const Outcome merged = morphodesic({"merge", study(), all.string()});
    EXPECT_EQ(merged.code, 0) << merged.out;
    EXPECT_THAT(merged.out, HasSubstr("1 file: 6 geodesics were added, 0 were in the store"));
    EXPECT_THAT(merged.out, Not(HasSubstr("left out")));
    // A header that is damaged is.
    std::string bytes = read_file(second);
    bytes[bytes.find("\"settings\":\"") + 14] ^= 1;
    write_file(all, read_file(first) + bytes);
    EXPECT_THAT(morphodesic({"merge", study(), all.string()}).out, HasSubstr("1 damaged line was left out"));
}

TEST_F(ShardFiles, OfTwoStudiesInOneFileEachTakesItsOwnInAnyOrder) {
    const std::string other = (folder / "other").string(), all = (folder / "all.jsonl").string();
    ASSERT_EQ(
        morphodesic({"ingest", (folder / "disks").string(), "--out", other, "--level", "4", "--steps", "1", "--quiet"})
            .code,
        0);
    ASSERT_EQ(morphodesic({"plan", other, "--shards", "1", "--quiet"}).code, 0);
    ASSERT_EQ(morphodesic({"plan", study(), "--shards", "1", "--quiet"}).code, 0);
    ASSERT_EQ(shard(folder / "mine.jsonl", "1/1").code, 0);
    ASSERT_EQ(morphodesic({"shard", other, "1/1", "--out", (folder / "theirs.jsonl").string(), "--quiet"}).code, 0);
    const std::string mine = read_file(folder / "mine.jsonl"), theirs = read_file(folder / "theirs.jsonl"),
                      head = theirs.substr(0, theirs.find('\n') + 1);
    std::string damaged = theirs, newer = theirs;
    damaged[damaged.find("numbers") + 14] ^= 1;
    const std::string revision = "\"solver_revision\":";
    newer.insert(newer.find(revision) + revision.size(), "9");
    const std::string sentence = "6 results of other settings were left out; all pairs are there all the same";
    for (const auto& [bytes, said] : std::vector<std::pair<std::string, std::string>>{
             {mine + theirs, sentence},
             {theirs + mine, sentence},
             {head + mine, "6 geodesics were"},
             {damaged + mine, "1 damaged line was left out"},
             {damaged + mine, "5 results of other settings were left out"},
             {newer + mine, "6 results of another version of the program were left out"},
             {mine + newer, "6 results of another version of the program were left out"}}) {
        fs::remove_all(folder / "copy");
        fs::copy(folder / "study", folder / "copy", fs::copy_options::recursive);
        write_file(all, bytes);
        const Outcome merged = morphodesic({"merge", (folder / "copy").string(), all});
        EXPECT_EQ(merged.code, 0) << merged.out;
        EXPECT_THAT(merged.out, HasSubstr(said));
        EXPECT_EQ(stored_rows(folder / "copy"), 6) << said;
        if (said == sentence) {
            EXPECT_THAT(merged.out, Not(HasSubstr("damaged")));
        }
    }
    // Nothing of the study in it but a header.
    write_file(all, head + mine);
    const Outcome none = morphodesic({"merge", other, all});
    EXPECT_EQ(none.code, 1);
    EXPECT_EQ(stored_rows(other), 0);
    EXPECT_THAT(none.out, HasSubstr("6 results of other settings were left out; merge them into the study"));
    EXPECT_THAT(none.out, Not(HasSubstr("damaged")));
    // A shard that goes on behind the header of another version puts its own before what it computes.
    write_file(folder / "mine.jsonl", mine.substr(0, mine.find('\n') + 1) + newer);
    EXPECT_EQ(shard(folder / "mine.jsonl", "1/1").code, 0);
    EXPECT_EQ(morphodesic({"merge", study(), (folder / "mine.jsonl").string()}).code, 0);
    EXPECT_EQ(stored_rows(study()), 6);
}

TEST_F(ShardFiles, MakeflowsLogGoesWithThePlanThatItIsOf) {
    const auto plan = [&](const std::string& shards) {
        const Outcome done =
            morphodesic_file({"plan", study(), "--shards", shards, "--format", "makeflow", "--json", "--quiet"});
        EXPECT_EQ(done.code, 0) << done.err;
        return json::parse(done.out)["id"].get<std::string>();
    };
    const fs::path shards = folder / "study/shards", log = shards / "shards.makeflow.makeflowlog";
    const auto write_logs = [&](const std::string& id) {
        write_file(log, "# STARTED 1795861628040322\n# FILE 1795861628052452 " + id +
                            "-0001-of-0002.jsonl 1 1073741824\n1795861628064296 1 1 7818 2 1 0 0 0 3\n");
        write_file(shards / "shards.makeflow.wqlog", "# time workers\n");
        write_file(shards / "shards.makeflow.mine", "notes\n");
    };
    const std::string two = plan("2");
    write_logs(two);
    const std::string bytes = read_file(log);
    EXPECT_EQ(plan("2"), two);  // the same: Makeflow goes on
    EXPECT_EQ(read_file(log), bytes);
    EXPECT_TRUE(fs::exists(shards / "shards.makeflow.wqlog"));
    EXPECT_NE(plan("3"), two);
    EXPECT_FALSE(fs::exists(log));
    EXPECT_FALSE(fs::exists(shards / "shards.makeflow.wqlog"));
    EXPECT_TRUE(fs::exists(shards / "shards.makeflow.mine"));
    // Done and merged, but the pairs are missing again, as in a store from a backup.
    write_logs(two);
    write_file(shards / ("merged-" + two + ".json"), "{}\n");
    EXPECT_EQ(plan("2"), two);
    EXPECT_FALSE(fs::exists(log));
    EXPECT_FALSE(fs::exists(shards / ("merged-" + two + ".json")));
}

}  // namespace
}  // namespace morphodesic::tests

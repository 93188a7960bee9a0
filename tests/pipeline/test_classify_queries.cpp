#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/classify_queries.h"
#include "pipeline/cli.h"
#include "tests/support/temporary_folder.h"

namespace morphodesic::pipeline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> names(const QueryList& list) {
    std::vector<std::string> result;
    for (const Query& query : list.queries) result.push_back(query.name);
    return result;
}

/// Two folders that hold a picture of the same name each, beside another one.
class ClassifyQueries : public testing::Test {
protected:
    ClassifyQueries() {
        for (const char* name : {"n1/1.png", "n2/1.png", "n2/2.png"}) folder_.write(name, "\x89PNG\r\n\x1a\n");
    }
    QueryList list(const std::vector<std::string>& queries, const std::string& truth = "") {
        ClassifyCommandOptions options;
        for (const std::string& query : queries) options.queries.push_back(folder_ / query);
        if (!truth.empty()) options.truth = folder_.write("table.csv", truth);
        return list_queries(options);
    }
    std::string path(const std::string& name) { return (folder_ / name).string(); }
    tests::TemporaryFolder folder_;
};

TEST_F(ClassifyQueries, OfOneFolderAreNamedByTheirFiles) {
    EXPECT_THAT(names(list({"n2"})), ElementsAre("1.png", "2.png"));
    EXPECT_THAT(names(list({"n1", "n2/2.png"})), ElementsAre("1.png", "2.png"));
}

TEST_F(ClassifyQueries, OfEqualNamesAreNamedByTheirPaths) {
    EXPECT_THAT(names(list({"n1", "n2"})), ElementsAre(path("n1/1.png"), path("n2/1.png"), path("n2/2.png")));
    EXPECT_THAT(names(list({"n1/1.png", "n1/../n2/1.png"})), ElementsAre(path("n1/1.png"), path("n2/1.png")));
}

TEST_F(ClassifyQueries, NamedTwiceAreOne) {
    const QueryList twice = list({"n2", "n2/1.png", "n2/."});
    EXPECT_THAT(names(twice), ElementsAre("1.png", "2.png"));
    EXPECT_THAT(twice.remarks, ElementsAre(HasSubstr("3 files were named more than once")));
}

TEST_F(ClassifyQueries, HaveTheClassOfTheirPathOrElseOfTheirName) {
    const QueryList all = list({"n1", "n2"}, "1.png,by name\n" + path("n2/1.png") + ",by path\n2.png,two\n");
    ASSERT_EQ(all.queries.size(), 3U);
    EXPECT_EQ(all.queries[0].source.label, "by name");
    EXPECT_EQ(all.queries[1].source.label, "by path");
    EXPECT_EQ(all.queries[2].source.label, "two");
}

TEST_F(ClassifyQueries, HaveTheClassOfTheTableBesideThem) {
    folder_.write("n2/truth.csv", "file,label\n1.png,one\n");
    const QueryList named = list({"n2/1.png", "n2/2.png", "n1/1.png"});
    ASSERT_EQ(named.queries.size(), 3U);
    EXPECT_EQ(named.queries[0].source.label, "one");
    EXPECT_EQ(named.queries[1].source.label, "");
    EXPECT_EQ(named.queries[2].source.label, "");
    EXPECT_THAT(named.remarks, testing::IsEmpty());
    const QueryList folder = list({"n2"});
    EXPECT_EQ(folder.queries[0].source.label, "one");
    EXPECT_THAT(folder.remarks, ElementsAre(HasSubstr("1 query is not in the table")));
    // Nobody named that table: a bad one takes no query away.
    folder_.write("n2/truth.csv", "file;label\n1.png;one\n");
    const QueryList without = list({"n2/1.png", "n2/2.png"});
    ASSERT_EQ(without.queries.size(), 2U);
    EXPECT_EQ(without.queries[0].source.label, "");
    EXPECT_THAT(without.remarks, ElementsAre(HasSubstr("has no comma between its columns")));
}

TEST_F(ClassifyQueries, OfEqualNamesStayApartInTheResults) {
    for (const char* kind : {"bars", "disks"}) {
        ASSERT_EQ(run_program({"datasets", kind, "--out", path(std::string("t/") + kind), "--count", "2", "--size",
                               "64", "--quiet"}),
                  0);
    }
    std::filesystem::copy_file(folder_ / "t/bars/bar-01.png", folder_.write("a/q.png", ""),
                               std::filesystem::copy_options::overwrite_existing);
    std::filesystem::copy_file(folder_ / "t/disks/disk-01.png", folder_.write("b/q.png", ""),
                               std::filesystem::copy_options::overwrite_existing);
    ASSERT_EQ(run_program({"classify", path("a"), path("b"), "--templates", path("t"), "--labels", "folder", "--level",
                           "4", "--steps", "1", "--out", path("out"), "--quiet", "--pictures", "0"}),
              0);
    const std::string table = tests::file_content(folder_ / "out/classification.csv"),
                      ranking = tests::file_content(folder_ / "out/ranking.csv");
    for (const std::string& name : {path("a/q.png"), path("b/q.png")}) {
        EXPECT_THAT(table, HasSubstr("\n" + name + ",")) << name;
        EXPECT_THAT(ranking, HasSubstr("\n" + name + ",1,")) << name;
    }
}

}  // namespace
}  // namespace morphodesic::pipeline

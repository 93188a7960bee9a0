#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/csv_rows.h"
#include "datasets/read_error.h"
#include "tests/support/temporary_folder.h"

namespace morphodesic::datasets {
namespace {

using ::testing::ElementsAre;

TEST(CsvRows, FieldsMayHoldCommasQuotesAndLineBreaks) {
    const tests::TemporaryFolder folder;
    const auto rows = read_csv(folder.write("a.csv",
                                            "\xef\xbb\xbf"
                                            "file,label\r\n\"a,b\",\"say \"\"x\"\"\"\n\"two\nlines\",y\n,\nlast,z"));
    ASSERT_EQ(rows.size(), 5U);
    EXPECT_THAT(rows[0].fields, ElementsAre("file", "label"));
    EXPECT_THAT(rows[1].fields, ElementsAre("a,b", "say \"x\""));
    EXPECT_THAT(rows[2].fields, ElementsAre("two\nlines", "y"));
    EXPECT_THAT(rows[3].fields, ElementsAre("", ""));
    EXPECT_THAT(rows[4].fields, ElementsAre("last", "z"));
    EXPECT_EQ(rows[4].line, 6);
}

TEST(CsvRows, WrittenFieldsAreReadBack) {
    const tests::TemporaryFolder folder;
    const std::string wild = "a \"b\",\r\nc";
    const auto rows = read_csv(folder.write("a.csv", csv_field(wild) + "," + csv_field("plain") + "\r\n"));
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_THAT(rows[0].fields, ElementsAre(wild, "plain"));
    EXPECT_EQ(csv_field("plain"), "plain");
}

TEST(CsvRows, AnOpenQuoteIsAnErrorWithItsLine) {
    const tests::TemporaryFolder folder;
    const auto file = folder.write("a.csv", "a,b\n\"c,d\n");
    try {
        read_csv(file);
        FAIL() << "no error";
    } catch (const ReadError& error) {
        EXPECT_THAT(error.what(), ::testing::HasSubstr("line 2"));
        EXPECT_EQ(error.file(), file);
    }
}

}  // namespace
}  // namespace morphodesic::datasets

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <sstream>

#include "analysis/matrix_csv.h"
#include "analysis/random.h"
#include "tests/analysis/support.h"

namespace morphodesic::analysis {
namespace {

using ::testing::HasSubstr;

DistanceMatrix read(const std::string& text, const CsvReadOptions& options = {}) {
    std::istringstream in(text);
    return read_distance_csv(in, "d.csv", options);
}

std::string written(const DistanceMatrix& matrix) {
    std::ostringstream out;
    write_distance_csv(out, matrix);
    return out.str();
}

TEST(MatrixCsv, WhatRAndPandasWriteForMissingIsMissing) {
    const DistanceMatrix d = read("\"\",\"a\",\"b\",\"c\"\n\"a\",0,NA,2\n\"b\",NA,0,NaN\n\"c\",2,nan,0\n");
    EXPECT_EQ(d(0, 2), 2.0);
    EXPECT_EQ(d.missing_count(), 2u);
}

TEST(MatrixCsv, BothDirectionsOfAnAsymmetricTableAreKept) {
    const std::string text = ",a,b,c\na,0,1,4\nb,3,0,\nc,4,5,0\n";
    EXPECT_THROW((void)read(text), ParseError);
    std::vector<DirectedPair> both;
    const DistanceMatrix d = read(text, {.asymmetry_tolerance = 1.0, .both_ways = &both});
    EXPECT_EQ(d(0, 1), 2.0);
    EXPECT_EQ(d(1, 2), 5.0);     // the known direction
    ASSERT_EQ(both.size(), 2u);  // also where both directions agree
    EXPECT_EQ(both[0].forward, 1.0);
    EXPECT_EQ(both[0].backward, 3.0);
    EXPECT_EQ(both[1].second, 2u);
    EXPECT_EQ(both[1].relative_difference(), 0.0);
}

struct BadCsv {
    const char* name;
    std::string text;
    std::size_t line, column;
    const char* problem;
};

class BadMatrixCsv : public testing::TestWithParam<BadCsv> {};

TEST_P(BadMatrixCsv, IsRefusedWithPlaceAndRemedy) {
    try {
        (void)read(GetParam().text);
        FAIL() << "accepted";
    } catch (const ParseError& error) {
        EXPECT_EQ(error.line(), GetParam().line) << error.what();
        EXPECT_EQ(error.column(), GetParam().column) << error.what();
        EXPECT_THAT(error.what(), HasSubstr("d.csv"));
        EXPECT_THAT(error.what(), HasSubstr(GetParam().problem));
        EXPECT_THAT(error.what(), HasSubstr("; "));  // the remedy
    }
}

INSTANTIATE_TEST_SUITE_P(
    Cases, BadMatrixCsv,
    testing::Values(BadCsv{"Empty", "", 0, 0, "empty"}, BadCsv{"Blank", "\n\r\n", 0, 0, "empty"},
                    BadCsv{"Semicolons", ";a;b\na;0;1\nb;1;0\n", 1, 1, "not separated by commas"},
                    BadCsv{"MissingRow", ",a,b\na,0,1\n", 2, 0, "ends after 1 of 2"},
                    BadCsv{"ExtraRow", ",a\na,0\nb,1\n", 3, 0, "more rows"},
                    BadCsv{"ShortRow", ",a,b\na,0,1\nb,1\n", 3, 2, "2 cells instead of 3"},
                    BadCsv{"LongRow", ",a,b\na,0,1\nb,1,0,4\n", 3, 4, "4 cells instead of 3"},
                    BadCsv{"OtherLabel", ",a,b\na,0,1\nc,1,0\n", 3, 1, "'c'"},
                    BadCsv{"OtherOrder", ",a,b\nb,0,1\na,1,0\n", 2, 1, "'b'"},
                    BadCsv{"SameLabel", ",a,a\na,0,1\na,1,0\n", 1, 3, "also that of column 2"},
                    BadCsv{"NoLabels", "0,1.2,3\n1.2,0,2\n3,2,0\n", 1, 1, "no labels"},
                    BadCsv{"NoLabelsNA", "NA, 1.2,3\n1.2,NA,2\n3,2,NA\n", 1, 1, "no labels"},
                    BadCsv{"NoLabel", ",a,\na,0,1\n,1,0\n", 1, 3, "no label"},
                    BadCsv{"Asymmetric", ",a,b\na,0,1\nb,1.5,0\n", 3, 2, "not symmetric: 1.5 here, 1 in line 2"},
                    BadCsv{"HalfMissing", ",a,b\na,0,\nb,1.5,0\n", 3, 2, "not symmetric"},
                    BadCsv{"Negative", ",a,b\na,0,-1\nb,-1,0\n", 2, 3, "negative"},
                    BadCsv{"Diagonal", ",a,b\na,1,2\nb,2,1\n", 2, 2, "itself"},
                    BadCsv{"Words", ",a,b\na,0,far\nb,far,0\n", 2, 3, "'far' is not a number"},
                    BadCsv{"DecimalComma", ",a,b\na,0,\"1,5\"\nb,\"1,5\",0\n", 2, 3, "decimal point"},
                    BadCsv{"Text", ",a,b\na,0,N/A\nb,N/A,0\n", 2, 3, "leave the cell empty"},
                    BadCsv{"Infinite", ",a,b\na,0,inf\nb,inf,0\n", 2, 3, "not a distance"},
                    BadCsv{"TooLarge", ",a,b\na,0,1e999\nb,1e999,0\n", 2, 3, "too large"},
                    BadCsv{"AboveLimit", ",a,b\na,0,1e200\nb,1e200,0\n", 2, 3, "too large"},
                    BadCsv{"OpenQuote", ",a,\"b\na,0,1\nb,1,0\n", 1, 3, "never closed"},
                    BadCsv{"AfterQuote", ",a,\"b\"x\na,0,1\n", 1, 3, "follows a closing"},
                    BadCsv{"Hex", ",a,b\na,0,0x1\nb,0x1,0\n", 2, 3, "not a number"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(MatrixCsv, HugeTablesAreRefusedBeforeTheyFillTheMemory) {
    std::string header;
    for (int j = 0; j < 30'000; ++j) header += ",s" + std::to_string(j);
    EXPECT_THROW((void)read(header + "\n"), ParseError);
}

TEST(MatrixCsv, UnreadableFileIsNamed) {
    try {
        (void)read_distance_csv(std::filesystem::path("no/such/file.csv"));
        FAIL();
    } catch (const ParseError& error) {
        EXPECT_THAT(error.what(), HasSubstr("no/such/file.csv"));
    }
}

TEST(MatrixCsv, NamesAreDataWhateverTheyHold) {
    DistanceMatrix matrix({"plain", "with,comma", "with \"quotes\"", "two\nlines", "cr\r\nlf", "\"", ",", " space ",
                           "<img src=x onerror=alert(1)>.png", "=1+1", "\xC3\xA4\xE6\xBC\xA2", "NaN", "trailing\r"});
    for (std::size_t i = 0; i < matrix.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) matrix.set(i, j, static_cast<double>(i * 100 + j) / 7.0);
    }
    const DistanceMatrix back = read(written(matrix));
    EXPECT_EQ(back.labels(), matrix.labels());
    EXPECT_EQ(written(back), written(matrix));
}

TEST(MatrixCsv, DoublesComeBackBitByBitAndGapsStayGaps) {
    const std::size_t n = 60;
    DistanceMatrix matrix(tests::numbered_labels(n));
    Random random(7);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            if (random.below(10) == 0) continue;
            matrix.set(i, j, std::ldexp(random.uniform(), static_cast<int>(random.below(600)) - 300));
        }
    }
    matrix.set(1, 0, std::numeric_limits<double>::denorm_min());
    matrix.set(2, 0, 0.1 + 0.2);
    matrix.set(3, 0, largest_distance);
    const DistanceMatrix back = read(written(matrix));
    ASSERT_EQ(back.size(), n);
    for (std::size_t k = 0; k < matrix.pair_count(); ++k) {
        if (std::isnan(matrix.condensed()[k])) {
            EXPECT_TRUE(std::isnan(back.condensed()[k]));
        } else {
            EXPECT_EQ(std::bit_cast<std::uint64_t>(back.condensed()[k]),
                      std::bit_cast<std::uint64_t>(matrix.condensed()[k]));
        }
    }
}

TEST(MatrixCsv, TheFormatIsTheContract) {
    DistanceMatrix matrix({"a,1", "b", "c"});
    matrix.set(0, 1, 0.5);
    matrix.set(1, 2, 1e-20);
    EXPECT_EQ(written(matrix), ",\"a,1\",b,c\n\"a,1\",0,0.5,\nb,0.5,0,1e-20\nc,,1e-20,0\n");
}

TEST(MatrixCsv, ReadsTheTablesOfOtherPrograms) {
    // R: quoted labels; Windows: byte order mark, CRLF, no newline at the end; pandas: empty diagonal, rounding.
    const DistanceMatrix matrix = read("\xEF\xBB\xBF\"\",\"a\",\"b\"\r\n\"a\",,+1.0\r\n\"b\", 1.0000000000000002 ,0");
    EXPECT_NEAR(matrix(0, 1), 1.0, 1e-15);
    EXPECT_EQ(read("x,a\na,0\n").size(), 1u);
    EXPECT_EQ(read(",a,b\na,0,1e-999\nb,1e-999,0\n")(0, 1), 0.0);
}

TEST(MatrixCsv, AsymmetryIsAcceptedWhereAskedFor) {
    CsvReadOptions options;
    options.asymmetry_tolerance = 1.0;
    EXPECT_DOUBLE_EQ(read(",a,b\na,0,1\nb,1.5,0\n", options)(0, 1), 1.25);
}

TEST(MatrixCsv, FilesAreReplacedAsAWhole) {
    const auto folder = std::filesystem::temp_directory_path() / "morphodesic_matrix_csv";
    std::filesystem::create_directories(folder);
    DistanceMatrix matrix({"a", "b"});
    matrix.set(0, 1, 2.0);
    write_distance_csv(folder / "distances.csv", matrix);
    EXPECT_EQ(read_distance_csv(folder / "distances.csv")(0, 1), 2.0);
    EXPECT_FALSE(std::filesystem::exists(folder / "distances.csv.part"));
    EXPECT_THROW(write_distance_csv(folder / "none" / "distances.csv", matrix), std::runtime_error);
    std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace morphodesic::analysis

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "analysis/csv.h"
#include "analysis/npy.h"

namespace morphodesic::analysis {
namespace {

TEST(Npy, RoundTrip) {
    std::stringstream file;
    write_npy(file, {2, 3, {1.0, 0.1, -3.0, 1e300, missing, 6.0}});
    EXPECT_EQ((file.str().size() - 6 * sizeof(double)) % 64, 0u);
    const NpyArray back = read_npy(file, "x.npy");
    EXPECT_EQ(back.rows, 2u);
    EXPECT_EQ(back.columns, 3u);
    EXPECT_EQ(back.values[3], 1e300);
    EXPECT_TRUE(std::isnan(back.values[4]));
    EXPECT_EQ(back.values[5], 6.0);
}

TEST(Npy, ReadsFortranOrder) {
    std::stringstream file;
    write_npy(file, {2, 3, {1, 2, 3, 4, 5, 6}});
    std::string text = file.str();
    text.replace(text.find("False"), 5, "True ");
    std::istringstream in(text);
    EXPECT_EQ(read_npy(in, "x.npy").values, (std::vector<double>{1, 3, 5, 2, 4, 6}));
}

TEST(Npy, BadFilesAreRefused) {
    std::stringstream file;
    write_npy(file, {2, 2, {1, 2, 3, 4}});
    const std::string good = file.str();
    const auto refuse = [](std::string text) {
        std::istringstream in(text);
        EXPECT_THROW((void)read_npy(in, "x.npy"), ParseError) << text.substr(0, 80);
    };
    refuse("");
    refuse("a,b\n");
    for (const std::size_t cut : {7u, 9u, 40u, static_cast<unsigned>(good.size() - 1)}) refuse(good.substr(0, cut));
    std::string other = good;
    other.replace(other.find("<f8"), 3, "<i8");
    refuse(other);
    other = good;
    other.replace(other.find("(2, 2), }"), 9, "(999999999, 9)");
    refuse(other);
}

}  // namespace
}  // namespace morphodesic::analysis

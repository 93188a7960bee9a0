#include <gtest/gtest.h>
#include <sys/resource.h>

#include <fstream>
#include <stdexcept>

#include "end_to_end/program.h"
#include "pipeline/memory_limits.h"

namespace morphodesic::pipeline {
namespace {

namespace fs = std::filesystem;

TEST(MemoryLimits, SizesAreReadAsPeopleWriteThem) {
    EXPECT_EQ(size_from_text("4G"), std::size_t{4} << 30);
    EXPECT_EQ(size_from_text("1.5GiB"), std::size_t{3} << 29);
    EXPECT_EQ(size_from_text("800mb"), std::size_t{800} << 20);
    EXPECT_EQ(size_from_text("4096"), 4096u);
    for (const char* bad : {"", "G", "4X", "-1G", "4GG", "nan", "1e40", "0"}) {
        EXPECT_THROW((void)size_from_text(bad), std::invalid_argument) << bad;
    }
}

class ControlGroups : public testing::Test {
protected:
    void write(const std::string& file, const std::string& text) {
        fs::create_directories((root_ / file).parent_path());
        std::ofstream(root_ / file) << text << "\n";
    }
    tests::TemporaryFolder folder_;
    fs::path root_ = folder_.path();
};

TEST_F(ControlGroups, TheTightestOfAGroupAndThoseAboveItCounts) {
    write("job/memory.max", "1000000");
    write("job/memory.current", "400000");
    write("job/step/memory.max", "max");
    write("job/step/memory.current", "400000");
    write("memory.max", "900000000");
    write("memory.current", "5");
    EXPECT_EQ(left_by_control_groups("0::/job/step\n", root_), 600000U);
    EXPECT_EQ(left_by_control_groups("0::/\n", root_), 899999995U);
    write("job/step/memory.max", "300000");
    EXPECT_EQ(left_by_control_groups("0::/job/step\n", root_), 0U);
}

TEST_F(ControlGroups, VersionOneHasOneTreeForMemory) {
    write("memory/batch/memory.limit_in_bytes", "5000");
    write("memory/batch/memory.usage_in_bytes", "1000");
    write("memory/memory.limit_in_bytes", "9223372036854771712");
    write("memory/memory.usage_in_bytes", "1000");
    EXPECT_EQ(left_by_control_groups("9:name=systemd:/\n4:cpu,memory:/batch\n0::/\n", root_), 4000U);
    EXPECT_EQ(left_by_control_groups("4:memory:/other\n", root_), std::nullopt);
    EXPECT_EQ(left_by_control_groups("no colons\n", root_), std::nullopt);
}

TEST(MemoryLimits, WhatTheShellLimitsIsNotTaken) {
    if (tests::sanitized) GTEST_SKIP() << "sanitizers reserve more address space than is allowed here";
    EXPECT_GT(available_memory(), std::size_t{1} << 20);
    rlimit before{};
    ASSERT_EQ(::getrlimit(RLIMIT_AS, &before), 0);
    rlimit small = before;
    small.rlim_cur = rlim_t{1} << 30;
    EXPECT_EQ(address_space_problem(), "");
    ASSERT_EQ(::setrlimit(RLIMIT_AS, &small), 0);
    const std::size_t left = available_memory();
    const std::string enough = address_space_problem();
    small.rlim_cur = rlim_t{600} << 20;
    (void)::setrlimit(RLIMIT_AS, &small);
    const std::string problem = address_space_problem();
    (void)::setrlimit(RLIMIT_AS, &before);
    EXPECT_LT(left, std::size_t{1} << 30);
    EXPECT_EQ(enough, "");
    EXPECT_NE(problem.find("600 MB (ulimit -v)"), std::string::npos) << problem;
}

}  // namespace
}  // namespace morphodesic::pipeline

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "end_to_end/program.h"
#include "pipeline/cli.h"

namespace morphodesic::pipeline {
namespace {

std::vector<std::string> tokens(const std::string& toml) {
    const tests::TemporaryFolder folder;
    tests::write_file(folder / "study.toml", toml);
    return tokens_of_config((folder / "study.toml").string());
}

TEST(ConfigFile, OptionsBecomeTokens) {
    EXPECT_THAT(tokens("level = 5\nlambda = 0.25\nalign = \"none\"\npreserve-volume = true\n"),
                testing::UnorderedElementsAre("--level=5", "--lambda=0.25", "--align=none", "--preserve-volume=true"));
    EXPECT_THAT(tokens(""), testing::IsEmpty());
    EXPECT_THAT(tokens("out = \"a b = c\"\n"), testing::ElementsAre("--out=a b = c"));
}

TEST(ConfigFile, WhatIsNotAnOptionIsRefused) {
    EXPECT_THROW((void)tokens("[run]\nlevel = 5\n"), std::invalid_argument);
    EXPECT_THROW((void)tokens("level = [5]\n"), std::invalid_argument);
    EXPECT_THROW((void)tokens("config = \"other.toml\"\n"), std::invalid_argument);
    EXPECT_THROW((void)tokens("level 5"), std::invalid_argument);
    EXPECT_THROW((void)tokens_of_config("/no/such/file.toml"), std::invalid_argument);
}

}  // namespace
}  // namespace morphodesic::pipeline

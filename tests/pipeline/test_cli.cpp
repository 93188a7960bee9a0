#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "end_to_end/program.h"
#include "pipeline/cli.h"

namespace morphodesic::pipeline {
namespace {

std::vector<std::string> tokens(const std::string& toml) {
    const tests::TemporaryFolder folder;
    tests::write_file(folder / "study.toml", toml);
    std::vector<std::string> result;
    for (const ConfigOption& option : options_of_config((folder / "study.toml").string())) {
        result.push_back(option.token());
    }
    return result;
}

std::vector<std::string> with_config(std::vector<std::string> arguments) {
    std::vector<ConfigOption> options;
    return with_config(std::move(arguments), options);
}

TEST(ConfigFile, OptionsBecomeTokens) {
    EXPECT_THAT(tokens("level = 5\nlambda = 0.25\nalign = \"none\"\npreserve-volume = true\n"),
                testing::ElementsAre("--level=5", "--lambda=0.25", "--align=none", "--preserve-volume=true"));
    EXPECT_THAT(tokens(""), testing::IsEmpty());
    EXPECT_THAT(tokens("out = \"a b = c\"\n"), testing::ElementsAre("--out=a b = c"));
}

TEST(ConfigFile, WhatIsNotAnOptionIsRefused) {
    EXPECT_THROW((void)tokens("[run]\nlevel = 5\n"), std::invalid_argument);
    EXPECT_THROW((void)tokens("level = [5]\n"), std::invalid_argument);
    EXPECT_THROW((void)tokens("config = \"other.toml\"\n"), std::invalid_argument);
    EXPECT_THROW((void)tokens("level 5"), std::invalid_argument);
    EXPECT_THROW((void)options_of_config("/no/such/file.toml"), std::invalid_argument);
}

TEST(ConfigFile, ItsOptionsComeBeforeThoseOfTheCommandLineAndBehindTheCommand) {
    const tests::TemporaryFolder folder;
    tests::write_file(folder / "c.toml", "size = 64\n");
    const std::string file = (folder / "c.toml").string();
    using Words = std::vector<std::string>;
    EXPECT_EQ(with_config({"run", "letters", "--config", file}),
              (Words{"run", "--size=64", "letters", "--config", file}));
    EXPECT_EQ(with_config({"datasets", "--quiet", "--config", file, "bars", "--size", "32"}),
              (Words{"datasets", "--quiet", "--config", file, "bars", "--size=64", "--size", "32"}));
    EXPECT_EQ(with_config({"datasets", "--config=" + file, "bars", "--size", "32"}),
              (Words{"datasets", "--config=" + file, "bars", "--size=64", "--size", "32"}));
    EXPECT_EQ(with_config({"datasets", "--config", file}), (Words{"datasets", "--size=64", "--config", file}));
    EXPECT_EQ(with_config({"run", "--", "--config"}), (Words{"run", "--", "--config"}));
    EXPECT_EQ(with_config({"--config", file, "run", "letters"}),
              (Words{"run", "--size=64", "--config", file, "letters"}));
    // Of several files all count, in their order.
    tests::write_file(folder / "d.toml", "size = 96\nseed = 2\n");
    const std::string other = (folder / "d.toml").string();
    EXPECT_THAT(with_config({"run", "--config", file, "--config=" + other}),
                testing::AllOf(testing::Contains("--seed=2"), testing::Contains("--size=96")));
    const Words both = with_config({"run", "--config", file, "--config", other});
    EXPECT_LT(std::find(both.begin(), both.end(), "--size=64"), std::find(both.begin(), both.end(), "--size=96"));
}

}  // namespace
}  // namespace morphodesic::pipeline

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/progress.h"

namespace morphodesic::pipeline {
namespace {

using testing::HasSubstr;
using testing::Not;

/// 100 pairs of which each takes `seconds`, by a clock of our own.
std::string text_of(Progress::Style style, double seconds) {
    std::string text;
    double time = 1000.0;
    Progress progress(
        style, [&](const std::string& part) { text += part; }, [&] { return time; });
    progress.message("48 shapes");
    progress.begin_pairs(120, 20, 100, 10);
    for (int i = 0; i < 100; ++i) {
        time += seconds;
        progress.pair_done(i != 3);
    }
    progress.end_pairs();
    return text;
}

TEST(Progress, ALogHasPlainLinesWithPrediction) {
    const std::string text = text_of(Progress::Style::lines, 2.0);
    EXPECT_THAT(text, HasSubstr("120 pairs, 20 of them in the store, 100 to compute\n"));
    EXPECT_THAT(text, HasSubstr("about 3 min 0 s to go"));  // 90 pairs of 2 s
    EXPECT_THAT(text, HasSubstr("1 without a distance"));
    EXPECT_THAT(text, HasSubstr("100 pairs computed in 3 min 20 s"));
    EXPECT_THAT(text, Not(HasSubstr("\r")));
}

TEST(Progress, ATerminalHasOneLineThatIsRewritten) {
    const std::string text = text_of(Progress::Style::terminal, 2.0);
    EXPECT_THAT(text, HasSubstr("\r\033[K50 of 100 pairs (50 %), 0.5 a second, 1 min 40 s left"));
}

TEST(Progress, QuietIsSilent) {
    EXPECT_EQ(text_of(Progress::Style::silent, 2.0), "");
}

TEST(Progress, DurationsReadWell) {
    EXPECT_EQ(duration_text(2.34), "2.3 s");
    EXPECT_EQ(duration_text(59.7), "1 min 0 s");
    EXPECT_EQ(duration_text(75), "1 min 15 s");
    EXPECT_EQ(duration_text(4200), "1 h 10 min");
}

}  // namespace
}  // namespace morphodesic::pipeline

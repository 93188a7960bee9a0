#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <random>
#include <string>
#include <vector>

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
    progress.begin_pairs(120, 20, 100, 1);
    for (int i = 0; i < 100; ++i) {
        time += seconds;
        progress.pair_done(i != 3, seconds);
    }
    progress.end_pairs();
    return text;
}

TEST(Progress, ALogHasPlainLinesWithPrediction) {
    const std::string text = text_of(Progress::Style::lines, 2.0);
    EXPECT_THAT(text, HasSubstr("120 pairs, 20 of them in the store, 100 to compute\n"));
    EXPECT_THAT(text, HasSubstr("about 2 min 56 s to go, judged by the first 12 pairs"));  // 88 pairs of 2 s
    EXPECT_THAT(text, HasSubstr("1 without a distance"));
    EXPECT_THAT(text, HasSubstr("100 pairs computed in 3 min 20 s"));
    EXPECT_THAT(text, Not(HasSubstr("\r")));
}

TEST(Progress, ATerminalHasOneLineThatIsRewritten) {
    const std::string text = text_of(Progress::Style::terminal, 2.0);
    EXPECT_THAT(text, HasSubstr("\r\033[K50 of 100 pairs (50 %), 0.5 a second, 1 min 40 s left"));
}

/// Pairs of a collection of mixed difficulty, computed on so many cores in random order.
class Schedule {
public:
    Schedule(int shapes, double shape_spread, double pair_spread, int cores, unsigned seed) : cores_(cores) {
        std::mt19937_64 random(seed);
        std::normal_distribution<double> normal(0.0, 1.0);
        std::vector<double> difficulty;
        for (int i = 0; i < shapes; ++i) difficulty.push_back(std::exp(shape_spread * normal(random)));
        for (int i = 0; i < shapes; ++i) {
            for (int j = i + 1; j < shapes; ++j) {
                pairs_.push_back(difficulty[static_cast<std::size_t>(i)] * difficulty[static_cast<std::size_t>(j)] *
                                 std::exp(pair_spread * normal(random)));
            }
        }
        std::shuffle(pairs_.begin(), pairs_.end(), random);
    }
    /// done(time, seconds of the pair) after every pair; returns when the last one is done.
    double run(const std::function<void(double, double)>& done) const {
        using Running = std::pair<double, double>;  // end, seconds
        std::priority_queue<Running, std::vector<Running>, std::greater<>> running;
        double now = 0.0;
        std::size_t next = 0;
        while (next < pairs_.size() || !running.empty()) {
            if (next < pairs_.size() && running.size() < static_cast<std::size_t>(cores_)) {
                running.emplace(now + pairs_[next], pairs_[next]);
                ++next;
                continue;
            }
            const Running first = running.top();
            running.pop();
            now = first.first;
            done(now, first.second);
        }
        return now;
    }
    [[nodiscard]] long count() const { return static_cast<long>(pairs_.size()); }

private:
    int cores_;
    std::vector<double> pairs_;
};

TEST(TimeEstimate, IsWithinThirtyPercentOnMixedDifficulty) {
    struct Case {
        int shapes;
        double shape_spread, pair_spread;
        int cores;
    };
    for (const Case& c : {Case{48, 0.0, 0.3, 2}, Case{48, 0.5, 0.5, 1}, Case{48, 0.5, 0.5, 2}, Case{48, 0.5, 0.5, 8},
                          Case{20, 0.3, 0.3, 2}, Case{20, 0.3, 0.3, 8}, Case{100, 0.7, 0.5, 4}}) {
        int first_wrong = 0, runs = 0;
        long asked = 0, wrong = 0;
        for (unsigned seed = 0; seed < 100; ++seed) {
            const Schedule schedule(c.shapes, c.shape_spread, c.pair_spread, c.cores, seed);
            const double end = schedule.run([](double, double) {});
            TimeEstimate estimate;
            estimate.begin(0.0, schedule.count(), c.cores);
            bool first = true;
            long done = 0;
            schedule.run([&](double now, double seconds) {
                estimate.pair_done(now, seconds);
                if (!estimate.trustworthy() || ++done > schedule.count() * 3 / 4) return;
                const bool is_wrong = std::abs(estimate.seconds_left(now) / (end - now) - 1) > 0.3;
                ++asked;
                wrong += is_wrong ? 1 : 0;
                if (first) ++runs, first_wrong += is_wrong ? 1 : 0;
                first = false;
            });
        }
        const std::string which = std::to_string(c.shapes) + " shapes, spread " + std::to_string(c.shape_spread) +
                                  ", cores " + std::to_string(c.cores);
        EXPECT_GE(runs, 95) << which;
        EXPECT_LE(first_wrong, 15) << which;  // of 100 first predictions
        EXPECT_LE(wrong, asked / 20) << which;
    }
}

TEST(TimeEstimate, FollowsAMachineThatGetsBusier) {
    TimeEstimate estimate;
    estimate.begin(0.0, 1000, 1);
    double now = 0.0;
    for (int i = 0; i < 200; ++i) estimate.pair_done(now += 1.0, 1.0);
    EXPECT_NEAR(estimate.seconds_left(now), 800.0, 1.0);
    for (int i = 0; i < 400; ++i) estimate.pair_done(now += 3.0, 3.0);
    EXPECT_NEAR(estimate.seconds_left(now), 1200.0, 60.0);
}

TEST(TimeEstimate, SaysWhenItIsTooEarly) {
    TimeEstimate estimate;
    estimate.begin(0.0, 1000, 2);
    EXPECT_TRUE(std::isnan(estimate.seconds_left(1.0)));
    double now = 0.0;
    for (int i = 0; i < 40; ++i) estimate.pair_done(now += 1.0, i % 20 == 19 ? 40.0 : 1.0);
    EXPECT_FALSE(estimate.trustworthy());  // two pairs of forty took most of the time
    EXPECT_THAT(text_of(Progress::Style::lines, 40.0), HasSubstr("too early to say how long"));
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

// The screening of a study with --neighbors, on distances made up here.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "pipeline/neighbor_screening.h"

namespace morphodesic::pipeline {
namespace {

/// Points of a plane in groups; a coarse level sees their distances too short and by random factors.
class MadeUp {
public:
    MadeUp(std::size_t groups, std::size_t size, double noise, std::size_t levels = 2, unsigned seed = 1)
        : n_(groups * size), levels_(levels) {
        std::mt19937_64 random(seed);
        std::uniform_real_distribution<double> place(0.0, 10.0);
        std::normal_distribution<double> normal(0.0, 1.0);
        std::vector<std::pair<double, double>> points, centres;
        for (std::size_t g = 0; g < groups; ++g) centres.emplace_back(place(random), place(random));
        for (std::size_t i = 0; i < n_; ++i) {
            const auto [x, y] = centres[i % groups];
            points.emplace_back(x + normal(random) / 2, y + normal(random) / 2);
        }
        for (std::size_t i = 0; i < n_; ++i) {
            for (std::size_t j = i + 1; j < n_; ++j) {
                double d = std::hypot(points[i].first - points[j].first, points[i].second - points[j].second);
                for (std::size_t level = levels; level-- > 0;) {
                    value_[{level, i, j}] = d;
                    d *= 0.8 * std::exp(noise * normal(random));
                }
            }
        }
    }
    [[nodiscard]] double fine(std::size_t i, std::size_t j) const {
        return value_.at({levels_ - 1, std::min(i, j), std::max(i, j)});
    }
    void fail(std::size_t level, std::size_t i, std::size_t j) { value_[{level, i, j}] = std::nan(""); }

    /// Measures what is asked for until nothing is.
    Screening complete(int k, std::size_t at_a_time = 1000000) {
        for (;;) {
            Screening state = screen_pairs(n_, k, levels_, [&](std::size_t level, std::size_t i, std::size_t j) {
                const bool there = done_.contains({level, i, j});
                return there ? std::optional(PairMeasurement{value_.at({level, i, j}), 0.01}) : std::nullopt;
            });
            if (state.missing.empty()) return state;
            ++rounds;
            for (std::size_t m = 0; m < std::min(at_a_time, state.missing.size()); ++m) {
                done_.insert({state.level, state.missing[m].first, state.missing[m].second});
            }
        }
    }
    /// Share of the true k nearest that the distances of the screening find, and share of pairs measured finely.
    std::pair<double, double> recall_and_share(const Screening& state, std::size_t k) const {
        std::size_t found = 0;
        const auto distance = [&](std::size_t i, std::size_t j) {
            const auto [a, b] = std::minmax(i, j);
            return state.pairs[n_ * a - a * (a + 1) / 2 + b - a - 1].distance;
        };
        for (std::size_t i = 0; i < n_; ++i) {
            std::vector<std::size_t> truly, seen;
            for (std::size_t j = 0; j < n_; ++j) {
                if (j != i) truly.push_back(j);
            }
            seen = truly;
            std::sort(truly.begin(), truly.end(), [&](auto a, auto b) { return fine(i, a) < fine(i, b); });
            std::sort(seen.begin(), seen.end(), [&](auto a, auto b) { return distance(i, a) < distance(i, b); });
            for (std::size_t c = 0; c < k; ++c) {
                found +=
                    static_cast<std::size_t>(std::count(seen.begin(), seen.begin() + static_cast<long>(k), truly[c]));
            }
        }
        return {static_cast<double>(found) / static_cast<double>(n_ * k),
                static_cast<double>(state.measured.back()) / static_cast<double>(state.pairs.size())};
    }

    int rounds = 0;

private:
    std::size_t n_, levels_;
    std::map<std::array<std::size_t, 3>, double> value_;
    std::set<std::array<std::size_t, 3>> done_;
};

TEST(NeighborScreening, FindsTheNeighboursWithFewFinePairs) {
    for (const std::size_t levels : {2, 3}) {
        MadeUp points(20, 10, 0.1, levels);
        const auto [recall, share] = points.recall_and_share(points.complete(5), 5);
        EXPECT_GT(recall, 0.99) << levels;
        EXPECT_LT(share, 0.15) << levels;
        EXPECT_LE(points.rounds, 1 + 2 * (static_cast<int>(levels) - 1));
    }
}

TEST(NeighborScreening, WorseCoarseDistancesCostMorePairsNotNeighbours) {
    MadeUp good(12, 10, 0.05), bad(12, 10, 0.3);
    const auto [recall_good, share_good] = good.recall_and_share(good.complete(5), 5);
    const auto [recall_bad, share_bad] = bad.recall_and_share(bad.complete(5), 5);
    EXPECT_GT(recall_good, 0.99);
    EXPECT_GT(recall_bad, 0.98);
    EXPECT_GT(share_bad, 1.5 * share_good);
}

TEST(NeighborScreening, APairThatStaysCoarseIsNeverNearerThanTheNeighbours) {
    MadeUp points(10, 8, 0.15, 3);
    const std::size_t n = 80, k = 4;
    const Screening state = points.complete(static_cast<int>(k));
    std::vector<std::vector<double>> refined(n);
    std::vector<double> ratios;
    std::size_t p = 0, coarse = 0;
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = i + 1; j < n; ++j, ++p) {
            if (state.pairs[p].level < 2) continue;
            EXPECT_EQ(state.pairs[p].distance, points.fine(i, j));
            refined[i].push_back(state.pairs[p].distance);
            refined[j].push_back(state.pairs[p].distance);
        }
    }
    for (auto& mine : refined) std::sort(mine.begin(), mine.end());
    p = 0;
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = i + 1; j < n; ++j, ++p) {
            if (state.pairs[p].level == 2) continue;
            ++coarse;
            EXPECT_GE(state.pairs[p].distance, refined[i][k - 1]);
            EXPECT_GE(state.pairs[p].distance, refined[j][k - 1]);
            EXPECT_GT(state.pairs[p].error, 0.02 * state.pairs[p].distance);  // the factors spread
            ratios.push_back(state.pairs[p].distance / points.fine(i, j));
        }
    }
    ASSERT_GT(coarse, n * (n - 1) / 4);
    std::sort(ratios.begin(), ratios.end());
    EXPECT_NEAR(ratios[ratios.size() / 2], 1.0, 0.1);
}

TEST(NeighborScreening, TheResultDoesNotDependOnHowItWasStopped) {
    MadeUp one(6, 6, 0.2, 3), other(6, 6, 0.2, 3);
    const Screening at_once = one.complete(3), in_pieces = other.complete(3, 17);
    ASSERT_GT(other.rounds, one.rounds);
    ASSERT_EQ(at_once.pairs.size(), in_pieces.pairs.size());
    for (std::size_t p = 0; p < at_once.pairs.size(); ++p) {
        EXPECT_EQ(at_once.pairs[p].distance, in_pieces.pairs[p].distance);
        EXPECT_EQ(at_once.pairs[p].level, in_pieces.pairs[p].level);
    }
}

TEST(NeighborScreening, APairWithoutACoarseDistanceIsSolvedFinely) {
    MadeUp points(6, 6, 0.1);
    points.fail(0, 3, 20);
    points.fail(1, 4, 21);
    Screening state = points.complete(3);
    const auto at = [](std::size_t i, std::size_t j) { return 36 * i - i * (i + 1) / 2 + j - i - 1; };
    EXPECT_EQ(state.pairs[at(3, 20)].level, 1u);
    EXPECT_EQ(state.pairs[at(3, 20)].distance, points.fine(3, 20));
}

TEST(NeighborScreening, FewShapesAreAllRefined) {
    for (const std::size_t n : {2, 3, 4}) {
        MadeUp points(1, n, 0.1);
        EXPECT_EQ(points.complete(5).measured,
                  (std::vector<long>{static_cast<long>(n * (n - 1) / 2), static_cast<long>(n * (n - 1) / 2)}));
    }
    EXPECT_TRUE(screen_pairs(0, 5, 2, {}).missing.empty());
    EXPECT_TRUE(screen_pairs(1, 5, 2, {}).missing.empty());
}

TEST(NeighborScreening, LevelsGoFromCoarseToThoseOfTheStudy) {
    GeodesicOptions options;
    options.level = 7;
    options.time_steps = 8;
    options.lambda = 2.5;
    options.tolerance = 1e-3;
    const auto levels = screening_levels(options, 5);
    ASSERT_EQ(levels.size(), 3u);
    EXPECT_LT(levels[0].level, levels[1].level);
    EXPECT_EQ(levels[0].lambda, 2.5);
    EXPECT_EQ(levels[2], options);
    EXPECT_EQ(screening_levels(options, 0).size(), 1u);
    options.level = 4;
    EXPECT_EQ(screening_levels(options, 5).size(), 1u);
    for (const GeodesicOptions& level : levels) EXPECT_TRUE(level.problems().empty());
}

}  // namespace
}  // namespace morphodesic::pipeline

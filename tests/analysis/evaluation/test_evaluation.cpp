#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "analysis/evaluation.h"
#include "tests/analysis/support.h"

namespace morphodesic::analysis {
namespace {

using Names = std::vector<std::string>;

TEST(NeighbourAccuracy, ByHand) {
    // a a b b on a line at 0, 1, 1.9, 5: item 1 is nearer to the first b.
    const DistanceMatrix d = tests::distances_of({0, 1, 1.9, 5}, 1);
    const NeighbourAccuracy one = neighbour_accuracy(d, Names{"a", "a", "b", "b"}, 1);
    EXPECT_EQ(one.queries, 4u);
    EXPECT_EQ(one.right, 2u);  // items 0 and 3
    EXPECT_EQ(one.predictions[1].predicted, "b");
    EXPECT_EQ(one.predictions[2].predicted, "a");
    const ConfusionMatrix confusion = confusion_matrix(Names{"a", "a", "b", "b"}, one.predictions);
    EXPECT_EQ(confusion(0, 0), 1u);
    EXPECT_EQ(confusion(0, 1), 1u);
    EXPECT_EQ(confusion(1, 0), 1u);
    EXPECT_EQ(confusion(1, 1), 1u);
}

TEST(NeighbourAccuracy, UnlabelledItemsAndSingleMembers) {
    const DistanceMatrix d = tests::distances_of({0, 0.1, 2, 2.1}, 1);
    // Item 1 has no label and is no neighbour; item 0 is the only "a": no query, but the nearest of none.
    const NeighbourAccuracy result = neighbour_accuracy(d, Names{"a", "", "b", "b"}, 1);
    EXPECT_EQ(result.queries, 2u);
    EXPECT_EQ(result.right, 2u);
    EXPECT_TRUE(std::isnan(neighbour_accuracy(d, Names{"", "", "", ""}, 1).accuracy));
}

TEST(NeighbourAccuracy, MissingDistancesHaveNoVote) {
    DistanceMatrix d({"x", "y", "z"});
    d.set(0, 2, 5.0);
    const NeighbourAccuracy result = neighbour_accuracy(d, Names{"a", "a", "b"}, 1);
    EXPECT_EQ(result.predictions[0].predicted, "b");
    EXPECT_EQ(result.predictions[1].predicted, "");
    EXPECT_EQ(result.right, 0u);
    EXPECT_EQ(confusion_matrix(Names{"a", "a", "b"}, result.predictions)(0, 2), 1u);
}

TEST(NeighbourAccuracy, TiesDoNotDependOnTheOrderOfTheItems) {
    const DistanceMatrix d = tests::tied_matrix(40, 5, 3);
    Names classes;
    for (std::size_t i = 0; i < 40; ++i) classes.push_back(std::string(1, static_cast<char>('a' + i % 4)));
    const auto order = tests::random_order(40, 6);
    Names moved;
    for (const std::size_t i : order) moved.push_back(classes[i]);
    for (const std::size_t k : {1u, 3u, 7u}) {
        EXPECT_EQ(neighbour_accuracy(d, classes, k).right,
                  neighbour_accuracy(tests::reordered(d, order), moved, k).right);
    }
    const Retrieval a = retrieval(d, classes), b = retrieval(tests::reordered(d, order), moved);
    EXPECT_NEAR(a.bulls_eye, b.bulls_eye, 1e-12);
    EXPECT_NEAR(a.mean_average_precision, b.mean_average_precision, 1e-12);
}

TEST(Retrieval, PerfectAndByHand) {
    const DistanceMatrix apart = tests::distances_of({0, 1, 100, 101}, 1);
    const Retrieval perfect = retrieval(apart, Names{"a", "a", "b", "b"}, 3);
    EXPECT_DOUBLE_EQ(perfect.bulls_eye, 1.0);
    EXPECT_DOUBLE_EQ(perfect.mean_average_precision, 1.0);
    EXPECT_EQ(perfect.hits_at_rank, (std::vector<double>{4, 0, 0}));
    EXPECT_EQ(perfect.possible_at_rank, (std::vector<std::size_t>{4, 0, 0}));
    for (const double p : perfect.precision_at_recall) EXPECT_DOUBLE_EQ(p, 1.0);
    // 0 1 2 3 on a line, classes a b b b ... item 0 is a class of its own; b: 1, 2, 3.
    // query 1: order 0/2 tied, then 3; window 5 holds all. Average precision: block {0, 2} one hit of two: 1/2 * 1/2,
    // then 2 of 3 at the end: 1/2 * 2/3 -> 7/12. Query 2: block {1, 3}: 1. Query 3: 2, 1: 1.
    const Retrieval tied = retrieval(tests::distances_of({0, 1, 2, 3}, 1), Names{"a", "b", "b", "b"}, 3);
    EXPECT_EQ(tied.queries, 3u);
    EXPECT_NEAR(tied.mean_average_precision, (7.0 / 12.0 + 2.0) / 3.0, 1e-12);
    EXPECT_NEAR(tied.hits_at_rank[0], 2.5, 1e-12);
    EXPECT_NEAR(tied.hits_at_rank[1], 2.5, 1e-12);
    EXPECT_NEAR(tied.hits_at_rank[2], 1.0, 1e-12);
}

TEST(Retrieval, BullsEyeWindowIsTwiceTheClass) {
    // Query 0 of class a (2 members): window of 4 = itself and 3 others; the other a is the fourth: missed.
    const DistanceMatrix d = tests::distances_of({0, 1, 2, 3, 4, 100, 101, 102}, 1);
    const Retrieval result = retrieval(d, Names{"a", "b", "b", "b", "a", "c", "c", "c"});
    // a: both queries find only themselves, 2 of 4. b: window 6 of {0..4 and one c}: 3 of 3 each. c: the same.
    EXPECT_NEAR(result.bulls_eye, (2.0 + 9.0 + 9.0) / (4.0 + 9.0 + 9.0), 1e-12);
}

TEST(Medoids, TheMostCentralMember) {
    const std::vector<Medoid> medoids =
        class_medoids(tests::distances_of({0, 1, 5, 20, 30}, 1), Names{"a", "a", "a", "b", ""});
    ASSERT_EQ(medoids.size(), 2u);
    EXPECT_EQ(medoids[0].item, 1u);
    EXPECT_DOUBLE_EQ(medoids[0].mean_distance, 2.5);
    EXPECT_EQ(medoids[1].item, 3u);
    EXPECT_DOUBLE_EQ(medoids[1].mean_distance, 0.0);
}

TEST(Permanova, IsTheAnalysisOfVarianceInOneDimension) {
    // On a line pseudo-F is the F of the ordinary analysis of variance: groups {1, 2, 3} and {4, 5, 9}:
    // between 3 (2 - 4)^2 + 3 (6 - 4)^2 = 24, within 2 + 14 = 16, F = 24 / (16 / 4) = 6.
    const DistanceMatrix d = tests::distances_of({1, 2, 3, 4, 5, 9}, 1);
    const Permanova result = permanova(d, Names{"a", "a", "a", "b", "b", "b"}, 999, 1);
    EXPECT_NEAR(result.pseudo_f, 6.0, 1e-12);
    EXPECT_NEAR(result.r_squared, 24.0 / 40.0, 1e-12);
    // The split is the most extreme of the 20 (as 10 distinct pairs): the p-value is 1 in 10.
    EXPECT_NEAR(result.p_value, 0.1, 0.03);
    EXPECT_EQ(permanova(d, Names{"a", "a", "a", "b", "b", "b"}, 999, 1).p_value, result.p_value);
    EXPECT_TRUE(std::isnan(permanova(d, Names{"a", "a", "a", "", "", ""}, 99, 1).pseudo_f));
}

TEST(NearestNeighbours, SharedDistancesComeAlong) {
    const DistanceMatrix d = tests::distances_of({0, 1, -1, 5}, 1);
    const std::vector<Neighbour> near = nearest_neighbours(d, 0, 1);
    ASSERT_EQ(near.size(), 2u);
    EXPECT_EQ(near[0].item, 1u);
    EXPECT_EQ(near[1].item, 2u);
    EXPECT_EQ(nearest_neighbours(d, 0, 10).size(), 3u);
    EXPECT_TRUE(nearest_neighbours(d, 0, 0).empty());
}

}  // namespace
}  // namespace morphodesic::analysis

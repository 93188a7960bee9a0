#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "analysis/linkage.h"
#include "tests/analysis/support.h"

namespace morphodesic::analysis {
namespace {

constexpr LinkageMethod all_methods[] = {LinkageMethod::single, LinkageMethod::complete, LinkageMethod::average,
                                         LinkageMethod::ward};

/// Greedy O(n^3) clustering straight from the definitions (Ward from sums of squared distances).
std::vector<double> naive_heights(const DistanceMatrix& d, LinkageMethod method) {
    std::vector<std::vector<std::size_t>> clusters;
    for (std::size_t i = 0; i < d.size(); ++i) clusters.push_back({i});
    const auto scatter = [&](const std::vector<std::size_t>& a) {
        double sum = 0.0;
        for (const std::size_t i : a) {
            for (const std::size_t j : a) sum += d(i, j) * d(i, j);
        }
        return sum / 2.0 / static_cast<double>(a.size());
    };
    const auto between = [&](const std::vector<std::size_t>& a, const std::vector<std::size_t>& b) {
        double low = std::numeric_limits<double>::infinity(), high = 0.0, sum = 0.0;
        for (const std::size_t i : a) {
            for (const std::size_t j : b) {
                low = std::min(low, d(i, j));
                high = std::max(high, d(i, j));
                sum += d(i, j);
            }
        }
        if (method == LinkageMethod::single) return low;
        if (method == LinkageMethod::complete) return high;
        if (method == LinkageMethod::average) return sum / static_cast<double>(a.size() * b.size());
        std::vector<std::size_t> both = a;
        both.insert(both.end(), b.begin(), b.end());
        return std::sqrt(2.0 * (scatter(both) - scatter(a) - scatter(b)));
    };
    std::vector<double> heights;
    while (clusters.size() > 1) {
        std::size_t x = 0, y = 1;
        double best = std::numeric_limits<double>::infinity();
        for (std::size_t a = 0; a < clusters.size(); ++a) {
            for (std::size_t b = a + 1; b < clusters.size(); ++b) {
                if (const double h = between(clusters[a], clusters[b]); h < best) {
                    best = h;
                    x = a;
                    y = b;
                }
            }
        }
        heights.push_back(best);
        clusters[x].insert(clusters[x].end(), clusters[y].begin(), clusters[y].end());
        clusters.erase(clusters.begin() + static_cast<std::ptrdiff_t>(y));
    }
    return heights;
}

TEST(Linkage, FivePointsOnALineByHand) {
    // 0, 1, 3, 7, 15: single linkage joins at the gaps 1, 2, 4, 8.
    const DistanceMatrix d = tests::distances_of({0, 1, 3, 7, 15}, 1);
    const Dendrogram single = linkage(d, LinkageMethod::single);
    EXPECT_EQ(single.merges, (std::vector<Merge>{{0, 1, 1, 2}, {2, 5, 2, 3}, {3, 6, 4, 4}, {4, 7, 8, 5}}));
    const Dendrogram complete = linkage(d, LinkageMethod::complete);
    EXPECT_EQ(complete.merges, (std::vector<Merge>{{0, 1, 1, 2}, {2, 5, 3, 3}, {3, 6, 7, 4}, {4, 7, 15, 5}}));
    const Dendrogram average = linkage(d, LinkageMethod::average);
    EXPECT_DOUBLE_EQ(average.merges[1].height, 2.5);         // 3 against {0, 1}
    EXPECT_DOUBLE_EQ(average.merges[2].height, 17.0 / 3.0);  // 7 against {0, 1, 3}
    EXPECT_DOUBLE_EQ(average.merges[3].height, 12.25);       // 15 against the rest
    const Dendrogram ward = linkage(d, LinkageMethod::ward);
    EXPECT_DOUBLE_EQ(ward.merges[1].height,
                     std::sqrt(4.0 / 3.0) * 2.5);  // sqrt(2 nm / (n + m)) times the centroids' distance
}

TEST(Linkage, HeightsAreThoseOfTheGreedyAlgorithm) {
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
        const DistanceMatrix d = tests::grouped_matrix(40, 4, 3.0, seed);
        for (const LinkageMethod method : all_methods) {
            const std::vector<double> naive = naive_heights(d, method);
            const Dendrogram tree = linkage(d, method);
            ASSERT_EQ(tree.merges.size(), naive.size());
            for (std::size_t m = 0; m < naive.size(); ++m) {
                EXPECT_NEAR(tree.merges[m].height, naive[m], 1e-9 * naive[m]) << to_string(method) << " merge " << m;
            }
        }
    }
}

TEST(Linkage, TiesDoNotChangeTheHeightsOfSingleLinkage) {
    for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u}) {
        const DistanceMatrix d = tests::tied_matrix(30, 4, seed);
        const Dendrogram tree = linkage(d, LinkageMethod::single);
        std::vector<double> heights;
        for (const Merge& m : tree.merges) heights.push_back(m.height);
        EXPECT_EQ(heights, naive_heights(d, LinkageMethod::single));
    }
}

TEST(Linkage, EveryClusterIsUsedOnceEvenWithTies) {
    for (const LinkageMethod method : all_methods) {
        for (int largest = 1; largest <= 3; ++largest) {
            const Dendrogram tree = linkage(tests::tied_matrix(50, largest, 9), method);
            std::vector<int> used(99, 0);
            double before = 0.0;
            for (const Merge& m : tree.merges) {
                EXPECT_LT(m.first, m.second);
                ++used[m.first];
                ++used[m.second];
                EXPECT_GE(m.height, before);
                before = m.height;
            }
            EXPECT_EQ(std::count(used.begin(), used.end(), 1), 98);
            EXPECT_EQ(tree.merges.back().size, 50u);
        }
    }
}

TEST(Linkage, TheOrderOfTheItemsDoesNotMatter) {
    const DistanceMatrix d = tests::grouped_matrix(60, 5, 2.0, 4);
    const auto order = tests::random_order(60, 5);
    for (const LinkageMethod method : all_methods) {
        const std::vector<double> a = cophenetic_distances(linkage(d, method));
        const std::vector<double> b = cophenetic_distances(linkage(tests::reordered(d, order), method));
        for (std::size_t i = 0; i < 60; ++i) {
            for (std::size_t j = i + 1; j < 60; ++j) {
                const double there = a[DistanceMatrix::condensed_index(60, order[i], order[j])];
                EXPECT_NEAR(b[DistanceMatrix::condensed_index(60, i, j)], there, 1e-9 * there);
            }
        }
    }
}

TEST(Linkage, CopheneticDistancesAreTheHeightsOfJoining) {
    const DistanceMatrix d = tests::distances_of({0, 1, 3, 7}, 1);
    EXPECT_EQ(cophenetic_distances(linkage(d, LinkageMethod::single)), (std::vector<double>{1, 2, 4, 2, 4, 4}));
    // An ultrametric matrix is its own cophenetic matrix.
    DistanceMatrix ultra({"a", "b", "c"});
    ultra.set(0, 1, 1.0);
    ultra.set(0, 2, 3.0);
    ultra.set(1, 2, 3.0);
    for (const LinkageMethod method : {LinkageMethod::single, LinkageMethod::complete, LinkageMethod::average}) {
        EXPECT_NEAR(cophenetic_correlation(linkage(ultra, method), ultra), 1.0, 1e-12);
    }
}

TEST(Linkage, CutsByCountAndHeight) {
    const Dendrogram tree = linkage(tests::distances_of({0, 1, 10, 11, 30}, 1), LinkageMethod::single);
    EXPECT_EQ(cut_by_count(tree, 1), (Clustering{0, 0, 0, 0, 0}));
    EXPECT_EQ(cut_by_count(tree, 2), (Clustering{0, 0, 0, 0, 1}));
    EXPECT_EQ(cut_by_count(tree, 3), (Clustering{0, 0, 1, 1, 2}));
    EXPECT_EQ(cut_by_count(tree, 5), (Clustering{0, 1, 2, 3, 4}));
    EXPECT_EQ(cut_by_height(tree, 1.0), (Clustering{0, 0, 1, 1, 2}));
    EXPECT_EQ(cut_by_height(tree, 0.5), (Clustering{0, 1, 2, 3, 4}));
    EXPECT_EQ(cut_by_height(tree, 100.0), (Clustering{0, 0, 0, 0, 0}));
    EXPECT_THROW((void)cut_by_count(tree, 6), std::invalid_argument);
    EXPECT_THROW((void)cut_by_count(tree, 0), std::invalid_argument);
}

TEST(Linkage, BestSilhouetteFindsThePlantedGroups) {
    const DistanceMatrix d = tests::grouped_matrix(60, 4, 12.0, 3);
    const SilhouetteCut cut = cut_by_silhouette(linkage(d, LinkageMethod::average), d, 10);
    ASSERT_EQ(cut.mean_silhouette.size(), 9u);
    EXPECT_EQ(cluster_count(cut.clusters), 4u);
    for (std::size_t i = 0; i < 60; ++i) EXPECT_EQ(cut.clusters[i], i % 4);
}

TEST(Linkage, ASilhouetteMustBeAboveZeroToPartItems) {
    DistanceMatrix same(tests::numbered_labels(4)), equidistant(tests::numbered_labels(4)),
        twins(tests::numbered_labels(6));
    for (std::size_t i = 0; i < 6; ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            if (i < 4) same.set(i, j, 0.0), equidistant.set(i, j, 1.0);
            twins.set(i, j, i / 3 == j / 3 ? 0.0 : 2.0);
        }
    }
    for (const LinkageMethod method : all_methods) {
        EXPECT_EQ(cut_by_silhouette(linkage(same, method), same, 10).clusters, (Clustering{0, 0, 0, 0}));
        EXPECT_EQ(cut_by_silhouette(linkage(equidistant, method), equidistant, 10).clusters, (Clustering{0, 0, 0, 0}));
        const SilhouetteCut cut = cut_by_silhouette(linkage(twins, method), twins, 10);
        EXPECT_EQ(cut.clusters, (Clustering{0, 0, 0, 1, 1, 1}));
        EXPECT_EQ(cut.mean_silhouette.size(), 1u);  // three clusters would part items at distance 0
    }
}

TEST(Linkage, TinyInputs) {
    EXPECT_TRUE(linkage(DistanceMatrix(), LinkageMethod::average).merges.empty());
    EXPECT_TRUE(linkage(DistanceMatrix({"a"}), LinkageMethod::average).merges.empty());
    EXPECT_EQ(cut_by_count(linkage(DistanceMatrix({"a"}), LinkageMethod::ward), 1), (Clustering{0}));
    EXPECT_EQ(tree_order(linkage(DistanceMatrix({"a"}), LinkageMethod::ward)), (std::vector<std::size_t>{0}));
    EXPECT_THROW((void)linkage(DistanceMatrix({"a", "b"}), LinkageMethod::ward), std::invalid_argument);
    EXPECT_THROW((void)parse_linkage_method("median"), std::invalid_argument);
    EXPECT_EQ(parse_linkage_method("ward"), LinkageMethod::ward);
    DistanceMatrix same(tests::numbered_labels(8));
    for (std::size_t i = 0; i < 8; ++i) {
        for (std::size_t j = 0; j < i; ++j) same.set(i, j, 0.0);
    }
    for (const LinkageMethod method : all_methods) EXPECT_EQ(linkage(same, method).merges.back().height, 0.0);
}

}  // namespace
}  // namespace morphodesic::analysis

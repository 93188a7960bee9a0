#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "analysis/csv.h"
#include "analysis/procrustes.h"
#include "analysis/study.h"
#include "tests/analysis/support.h"
#include "tests/support/thread_counts.h"

namespace morphodesic::analysis {
namespace {

using Table = std::vector<std::vector<std::string>>;

template <class Writer>
Table table(const Writer& write) {
    std::stringstream file;
    write(file);
    CsvReader reader(file, "table");
    Table rows;
    for (std::vector<std::string> cells; reader.next(cells);) rows.push_back(cells);
    return rows;
}

struct Case {
    DistanceMatrix distances;
    AnalysisInput input;
};

Case four_groups() {
    Case c{tests::grouped_matrix(40, 4, 10.0, 3), {}};
    for (std::size_t i = 0; i < 40; ++i) {
        for (std::size_t j = 0; j < i; ++j) c.distances.set(i, j, c.distances(i, j), 0.2);
        c.input.classes.push_back("class" + std::to_string(i % 4));
    }
    return c;
}

TEST(Study, AnswersEveryQuestion) {
    Case c = four_groups();
    c.input.directed = {{0, 1, 1.0, 1.1}};
    AnalysisOptions options;
    options.diffuse = true;
    const AnalysisResult r = analyse(c.distances, options, c.input);
    EXPECT_EQ(r.kept.size(), 40u);
    ASSERT_EQ(r.trees.size(), 4u);
    EXPECT_EQ(r.trees[0].method, LinkageMethod::average);
    ASSERT_EQ(r.clusterings.size(), 2u);
    EXPECT_EQ(cluster_count(r.clusterings[0].clusters), 4u);
    EXPECT_EQ(r.clusterings[0].cut, "best silhouette");
    EXPECT_EQ(r.clusterings[0].medoids.size(), 4u);
    for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(r.clusterings[0].clusters[r.clusterings[0].medoids[k]], k);
    // Clusters count along the leaf order.
    std::size_t before = 0;
    for (const std::size_t i : r.trees[0].leaf_order.order) {
        EXPECT_GE(r.clusterings[0].clusters[i], before);
        before = r.clusterings[0].clusters[i];
    }
    ASSERT_EQ(r.embeddings.size(), 8u);
    EXPECT_EQ(r.embeddings[7].method, "Isomap");
    for (const EmbeddingResult& e : r.embeddings) {  // all lie as the first of their dimension
        const Embedding& first = r.embeddings[e.embedding.dimensions - 2].embedding;
        const Embedding turned = procrustes(first, e.embedding).aligned;
        for (std::size_t k = 0; k < turned.coordinates.size(); ++k) {
            EXPECT_NEAR(e.embedding.coordinates[k], turned.coordinates[k], 1e-9) << e.method;
        }
    }
    EXPECT_GT(r.isomap_correlation, 0.8);
    EXPECT_THAT(r.remarks, testing::Contains(testing::HasSubstr("nearest neighbours falls into 4 parts")));
    EXPECT_THAT(r.remarks, testing::Contains(testing::HasSubstr("in 2 dimensions is the best of 4 starts")));
    EXPECT_EQ(r.embeddings[0].method, "SMACOF");
    EXPECT_EQ(r.embeddings[0].embedding.dimensions, 2u);
    EXPECT_EQ(r.spanning_tree.size(), 39u);
    EXPECT_EQ(r.triangles.violated, 0u);
    EXPECT_EQ(r.directions.pairs, 1u);
    EXPECT_EQ(r.stability.runs, 100u);
    EXPECT_GT(r.stability.mean_rand, 0.99);
    ASSERT_EQ(r.class_results.size(), 2u);
    EXPECT_EQ(r.class_results[0].nearest[0].accuracy, 1.0);
    EXPECT_EQ(r.class_results[0].bulls_eye_window, 20);
    EXPECT_NEAR(r.agreement.adjusted_rand, 1.0, 1e-12);
    ASSERT_TRUE(r.permanova.has_value());
    EXPECT_DOUBLE_EQ(r.permanova->p_value, 0.001);
    EXPECT_FALSE(r.cancelled);
}

TEST(Study, ClaimsNoAccuracyWithOneClass) {
    Case c = four_groups();
    for (std::string& name : c.input.classes) name = "leaf";
    const AnalysisResult r = analyse(c.distances, {}, c.input);
    EXPECT_TRUE(r.class_results.empty());  // every neighbour would be right
    EXPECT_FALSE(r.permanova.has_value());
    EXPECT_THAT(r.remarks, testing::Contains(testing::HasSubstr("of the same one (leaf)")));
    EXPECT_EQ(r.classes.size(), 40u);  // still named in the tables

    c.input.classes.front() = "flower";  // two classes can be told apart, one member or not
    EXPECT_EQ(analyse(c.distances, {}, c.input).class_results.size(), 1u);
}

TEST(Study, GapsAreTreatedAndTold) {
    Case c = four_groups();
    DistanceMatrix d({"lonely"});
    std::vector<std::string> labels = c.distances.labels();
    labels.insert(labels.begin(), "lonely");
    d = DistanceMatrix(labels);
    for (std::size_t i = 0; i < 40; ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            if (i != 7 || j != 3) d.set(i + 1, j + 1, c.distances(i, j), 0.2);
        }
    }
    c.input.classes.insert(c.input.classes.begin(), "class0");
    const AnalysisResult r = analyse(d, {}, c.input);
    EXPECT_EQ(r.left_out, (std::vector<std::size_t>{0}));
    EXPECT_EQ(r.kept.front(), 1u);
    EXPECT_EQ(r.labels.size(), 40u);
    EXPECT_THAT(r.remarks, testing::Contains(testing::HasSubstr("left out")));
    EXPECT_EQ(cluster_count(r.clusterings[0].clusters), 4u);
    EXPECT_EQ(r.triangles.triangles, 40u * 39 * 38 / 6 - 38);
    const Table rows = table([&](std::ostream& out) { write_clusters_csv(out, r, d); });
    ASSERT_EQ(rows.size(), 42u);
    EXPECT_EQ(rows.back()[0], "lonely");
    EXPECT_EQ(rows.back()[2], "");
}

TEST(Study, TablesHaveTheDocumentedColumns) {
    Case c = four_groups();
    const AnalysisResult r = analyse(c.distances, {}, c.input);
    const Table clusters = table([&](std::ostream& out) { write_clusters_csv(out, r, c.distances); });
    EXPECT_EQ(clusters[0], (std::vector<std::string>{"name", "class", "cluster", "medoid", "silhouette", "stability",
                                                     "k_medoids", "position"}));
    ASSERT_EQ(clusters.size(), 41u);
    std::set<std::string> numbers, positions;
    int medoids = 0;
    for (std::size_t i = 1; i < clusters.size(); ++i) {
        numbers.insert(clusters[i][2]);
        positions.insert(clusters[i][7]);
        medoids += clusters[i][3] == "1" ? 1 : 0;
    }
    EXPECT_EQ(numbers, (std::set<std::string>{"1", "2", "3", "4"}));
    EXPECT_EQ(positions.size(), 40u);
    EXPECT_EQ(medoids, 4);
    const Table tree = table([&](std::ostream& out) { write_linkage_csv(out, r); });
    EXPECT_EQ(tree[0], (std::vector<std::string>{"cluster", "first", "second", "height", "size"}));
    ASSERT_EQ(tree.size(), 40u);
    EXPECT_EQ(tree[1][0], "40");
    EXPECT_EQ(tree.back()[4], "40");
    EXPECT_EQ(std::stod(tree.back()[3]), r.trees[0].tree.merges.back().height);
    const Table points = table([&](std::ostream& out) { write_embedding_csv(out, r); });
    EXPECT_EQ(points[0], (std::vector<std::string>{"name", "method", "dimensions", "x", "y", "z", "stress_share"}));
    EXPECT_EQ(points.size(), 1u + 8 * 40);
    EXPECT_EQ(points[1][5], "");
}

TEST(Study, EqualBitsOnOneAndEightThreads) {
    Case c = four_groups();
    AnalysisOptions options;
    options.diffuse = true;
    const auto tables = [&] {
        const AnalysisResult r = analyse(c.distances, options, c.input);
        std::ostringstream out;
        write_clusters_csv(out, r, c.distances);
        write_linkage_csv(out, r);
        write_embedding_csv(out, r);
        out << csv_cell(r.permanova->p_value) << csv_cell(r.isomap_correlation) << csv_cell(r.stability.mean_rand)
            << csv_cell(r.class_results[1].retrieved.mean_average_precision);
        return out.str();
    };
    const auto [one, eight] = tests::on_one_and_eight_threads(tables);
    EXPECT_EQ(one, eight);
}

TEST(Study, CutsAsAsked) {
    const Case c = four_groups();
    AnalysisOptions options;
    options.clusters = 7;
    EXPECT_EQ(cluster_count(analyse(c.distances, options).clusterings[0].clusters), 7u);
    options.clusters = 1000;
    const AnalysisResult many = analyse(c.distances, options);
    EXPECT_EQ(cluster_count(many.clusterings[0].clusters), 40u);
    EXPECT_THAT(many.remarks, testing::Contains(testing::HasSubstr("only 40 items")));
    options.clusters = 0;
    options.cut_height = 1e9;
    EXPECT_EQ(cluster_count(analyse(c.distances, options).clusterings[0].clusters), 1u);
    options.linkage = "ward";
    EXPECT_EQ(analyse(c.distances, options).clusterings[0].method, "ward linkage");
}

TEST(Study, BadOptionsAreNamed) {
    AnalysisOptions options;
    options.linkage = "median";
    options.neighbors = 0;
    options.cut_height = -1.0;
    EXPECT_EQ(options.problems().size(), 3u);
    EXPECT_THROW((void)analyse(DistanceMatrix({"a"}), options), std::invalid_argument);
    int fields = 0;
    AnalysisOptions::for_each_field(options, [&](const char*, auto&, const char*) { ++fields; });
    EXPECT_EQ(fields, 13);
}

TEST(Study, TinyAndDegenerateStudiesGoThrough) {
    for (std::size_t n = 0; n < 5; ++n) {
        DistanceMatrix same(tests::numbered_labels(n));
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = 0; j < i; ++j) same.set(i, j, 0.0, 0.1);
        }
        AnalysisOptions options;
        options.diffuse = true;
        AnalysisInput input;
        input.classes.assign(n, "a");
        const AnalysisResult r = analyse(same, options, input);
        EXPECT_EQ(r.labels.size(), n);
        for (const EmbeddingResult& e : r.embeddings) {
            for (const double x : e.embedding.coordinates) EXPECT_TRUE(std::isfinite(x));
        }
        std::ostringstream out;
        write_clusters_csv(out, r, same);
        write_linkage_csv(out, r);
        write_embedding_csv(out, r);
        EXPECT_THAT(out.str(), testing::Not(testing::HasSubstr("nan")));
    }
    const AnalysisResult none = analyse(DistanceMatrix({"a", "b", "c"}));  // nothing known
    EXPECT_EQ(none.labels.size(), 1u);
    EXPECT_EQ(none.left_out.size(), 2u);
}

TEST(Study, CanBeStopped) {
    Case c = four_groups();
    int parts = 0;
    c.input.proceed = [&](const char*) { return ++parts < 4; };
    const AnalysisResult r = analyse(c.distances, {}, c.input);
    EXPECT_TRUE(r.cancelled);
    EXPECT_EQ(parts, 4);
    EXPECT_TRUE(r.embeddings.empty());
}

}  // namespace
}  // namespace morphodesic::analysis

// The same numbers as independent implementations: SciPy and scikit-learn, where they are installed.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "analysis/agreement.h"
#include "analysis/comparison.h"
#include "analysis/evaluation.h"
#include "analysis/leaf_order.h"
#include "analysis/linkage.h"
#include "analysis/matrix_csv.h"
#include "analysis/mds.h"
#include "analysis/neighbor_graph.h"
#include "analysis/npy.h"
#include "analysis/procrustes.h"
#include "analysis/random.h"
#include "analysis/smacof.h"
#include "analysis/statistics.h"
#include "analysis/study.h"
#include "tests/analysis/support.h"

namespace morphodesic::analysis {
namespace {

constexpr const char* python = "/usr/bin/python3";

bool installed(const std::string& modules) {
    return std::filesystem::exists(python) &&
           std::system((std::string(python) + " -c 'import " + modules + "' 2>/dev/null").c_str()) == 0;
}

/// Runs a script in a folder of its own; each "name v1 v2 ..." line of its output becomes an entry.
class Independent : public testing::Test {
protected:
    void SetUp() override {
        if (!installed("numpy, scipy, sklearn")) {
            GTEST_SKIP() << "python3-scipy and python3-sklearn are not installed for " << python;
        }
        std::string pattern = (std::filesystem::temp_directory_path() / "morphodesic_scipy_XXXXXX").string();
        ASSERT_NE(mkdtemp(pattern.data()), nullptr);
        folder_ = pattern;
    }
    void TearDown() override {
        if (!folder_.empty()) std::filesystem::remove_all(folder_);
    }

    std::map<std::string, std::vector<double>> run(const std::string& body) {
        std::ofstream(folder_ / "script.py") << "import sys, numpy as np\n"
                                                "def put(name, values):\n"
                                                "    print(name, *[repr(float(v)) for v in np.ravel(values)])\n"
                                             << body;
        const std::string command = "cd '" + folder_.string() + "' && OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 " +
                                    std::string(python) + " script.py > out.txt 2> err.txt";
        if (std::system(command.c_str()) != 0) {
            std::ostringstream errors;
            errors << std::ifstream(folder_ / "err.txt").rdbuf();
            ADD_FAILURE() << errors.str();
            return {};
        }
        std::map<std::string, std::vector<double>> result;
        std::ifstream out(folder_ / "out.txt");
        for (std::string line; std::getline(out, line);) {
            std::istringstream words(line);
            std::string name, word;
            words >> name;
            while (words >> word) result[name].push_back(std::strtod(word.c_str(), nullptr));
        }
        return result;
    }

    std::filesystem::path folder_;
};

void expect_near(const std::vector<double>& ours, const std::vector<double>& theirs, double tolerance,
                 const char* what) {
    ASSERT_EQ(ours.size(), theirs.size()) << what;
    for (std::size_t k = 0; k < ours.size(); ++k) EXPECT_NEAR(ours[k], theirs[k], tolerance) << what << " entry " << k;
}

TEST_F(Independent, HierarchicalClustering) {
    const DistanceMatrix d = tests::grouped_matrix(120, 6, 2.0, 17);
    write_npy(folder_ / "d.npy", d);
    write_distance_csv(folder_ / "d.csv", d);
    const auto theirs = run(R"(
from scipy.cluster.hierarchy import linkage, cophenet, optimal_leaf_ordering, leaves_list, fcluster
from scipy.spatial.distance import squareform
d = np.load('d.npy')
rows = [line.rstrip('\n').split(',') for line in open('d.csv')]
put('csv', np.abs(np.array([[float(c) for c in r[1:]] for r in rows[1:]]) - d).max())
c = squareform(d)
for m in ['single', 'complete', 'average', 'ward']:
    z = linkage(c, m)
    put('linkage_' + m, z)
    correlation, distances = cophenet(z, c)
    put('correlation_' + m, correlation)
    put('cophenetic_' + m, distances)
    order = leaves_list(optimal_leaf_ordering(z, c))
    put('order_' + m, d[order[:-1], order[1:]].sum())
    put('cut_' + m, fcluster(z, 7, 'maxclust'))
)");
    ASSERT_TRUE(theirs.contains("csv"));
    EXPECT_EQ(theirs.at("csv")[0], 0.0);  // CSV and NPY hold the same bits
    for (const auto method :
         {LinkageMethod::single, LinkageMethod::complete, LinkageMethod::average, LinkageMethod::ward}) {
        const std::string m = to_string(method);
        const Dendrogram tree = linkage(d, method);
        std::vector<double> rows;
        for (const Merge& merge : tree.merges) {
            rows.insert(rows.end(), {static_cast<double>(merge.first), static_cast<double>(merge.second), merge.height,
                                     static_cast<double>(merge.size)});
        }
        expect_near(rows, theirs.at("linkage_" + m), 1e-9, m.c_str());
        expect_near(cophenetic_distances(tree), theirs.at("cophenetic_" + m), 1e-9, m.c_str());
        EXPECT_NEAR(cophenetic_correlation(tree, d), theirs.at("correlation_" + m)[0], 1e-9);
        // SciPy 1.10's orders are allowed ones but can be longer than the shortest (test_leaf_order.cpp tries them
        // all).
        EXPECT_LE(optimal_leaf_order(tree, d).length, theirs.at("order_" + m)[0] + 1e-9);
        const std::vector<double>& cut = theirs.at("cut_" + m);
        Clustering parts;
        for (const double c : cut) parts.push_back(static_cast<std::size_t>(c));
        EXPECT_NEAR(adjusted_rand(cut_by_count(tree, 7), parts), 1.0, 1e-12);
    }
}

TEST_F(Independent, GraphsAndPaths) {
    const DistanceMatrix d = tests::grouped_matrix(80, 4, 2.0, 5);
    write_npy(folder_ / "d.npy", d);
    const auto theirs = run(R"(
from scipy.sparse.csgraph import minimum_spanning_tree, shortest_path
from sklearn.neighbors import kneighbors_graph
d = np.load('d.npy')
put('tree', np.sort(minimum_spanning_tree(d).data))
k = kneighbors_graph(d, 8, metric='precomputed', mode='distance')
put('paths', shortest_path(k, method='D', directed=False))
)");
    std::vector<double> tree;
    for (const Edge& e : minimum_spanning_tree(d)) tree.push_back(e.length);
    expect_near(tree, theirs.at("tree"), 1e-12, "minimum spanning tree");
    std::vector<double> ours = path_distances(d.labels(), nearest_neighbour_graph(d, 8)).dense();
    for (double& x : ours) x = std::isnan(x) ? HUGE_VAL : x;
    const std::vector<double>& paths = theirs.at("paths");
    ASSERT_EQ(ours.size(), paths.size());
    for (std::size_t k = 0; k < ours.size(); ++k) {
        if (std::isinf(ours[k]) || std::isinf(paths[k])) {
            EXPECT_EQ(ours[k], paths[k]);
        } else {
            EXPECT_NEAR(ours[k], paths[k], 1e-9);
        }
    }
}

TEST_F(Independent, Embeddings) {
    const DistanceMatrix d = tests::grouped_matrix(50, 4, 3.0, 6);
    write_npy(folder_ / "d.npy", d);
    const ClassicalScaling ours = classical_mds(d, 2);
    {
        std::ofstream start(folder_ / "start.npy", std::ios::binary);
        write_npy(start, {50, 2, ours.embedding.coordinates});
    }
    const auto theirs = run(R"(
from sklearn.manifold import smacof
from sklearn.isotonic import isotonic_regression
from scipy.spatial import procrustes
d = np.load('d.npy')
n = len(d)
j = np.eye(n) - np.ones((n, n)) / n
values, vectors = np.linalg.eigh(-0.5 * j @ (d * d) @ j)
put('eigenvalues', values[::-1][:10])
x = vectors[:, ::-1][:, :2] * np.sqrt(values[::-1][:2])
put('classical', x)
points, stress, iterations = smacof(d, metric=True, n_components=2, init=x, n_init=1, max_iter=5000, eps=1e-12,
                                    return_n_iter=True)
put('smacof', points)
put('stress', np.sqrt(stress / (((points[:, None] - points[None]) ** 2).sum() / 2)))
start = np.load('start.npy')
put('disparity', procrustes(points, start)[2])
put('isotonic', isotonic_regression(d[0, 1:]))
)");
    for (std::size_t k = 0; k < 10; ++k) EXPECT_NEAR(ours.eigenvalues[k], theirs.at("eigenvalues")[k], 1e-8);
    EXPECT_LT(procrustes({2, theirs.at("classical")}, ours.embedding).rms_distance, 1e-9);
    SmacofOptions options;
    options.starts = 1;
    options.max_iterations = 20'000;
    options.tolerance = 1e-13;
    const Smacof scaled = smacof(d, options);
    EXPECT_NEAR(scaled.stress, theirs.at("stress")[0], 1e-5);
    const Embedding points{2, theirs.at("smacof")};
    EXPECT_LT(procrustes(points, scaled.embedding).rms_distance, 0.02);
    // SciPy scales both sides to unit norm: its disparity is 1 - (sum of singular values)^2 / (|X|^2 |Y|^2).
    const Procrustes fit = procrustes(points, ours.embedding, true);
    double norm = 0.0;
    std::array<double, 2> centre{};
    for (std::size_t i = 0; i < 50; ++i) {
        for (std::size_t a = 0; a < 2; ++a) centre[a] += points(i, a) / 50.0;
    }
    for (std::size_t i = 0; i < 50; ++i) {
        for (std::size_t a = 0; a < 2; ++a) norm += std::pow(points(i, a) - centre[a], 2);
    }
    EXPECT_NEAR(50.0 * fit.rms_distance * fit.rms_distance / norm, theirs.at("disparity")[0], 1e-9);
    std::vector<double> row;
    for (std::size_t j = 1; j < 50; ++j) row.push_back(d(0, j));
    expect_near(isotonic_regression(row), theirs.at("isotonic"), 1e-12, "isotonic regression");
}

TEST_F(Independent, IsomapAndPermanova) {
    // A curved band: the graph is one piece, and its path lengths differ from the distances.
    Random random(11);
    std::vector<double> points;
    for (std::size_t i = 0; i < 90; ++i) {
        const double t = 4.0 * random.uniform();
        points.insert(points.end(), {t * std::cos(t), t * std::sin(t), 0.5 * random.uniform()});
    }
    const DistanceMatrix d = tests::distances_of(points, 3);
    write_npy(folder_ / "d.npy", d);
    const auto theirs = run(R"(
from sklearn.manifold import Isomap
d = np.load('d.npy')
n = len(d)
model = Isomap(n_neighbors=8, n_components=2, metric='precomputed', eigen_solver='dense')
put('map', model.fit_transform(d))
put('paths', model.dist_matrix_)
classes = np.arange(n) % 3
# Anderson 2001: sums of squared distances within groups against those of all
total = (d ** 2).sum() / 2 / n
within = sum((d[np.ix_(classes == c, classes == c)] ** 2).sum() / 2 / (classes == c).sum() for c in range(3))
put('f', (total - within) / 2 / (within / (n - 3)))
put('r2', 1 - within / total)
)");
    AnalysisOptions options;
    options.neighbors = 8;
    AnalysisInput input;
    for (std::size_t i = 0; i < 90; ++i) input.classes.push_back(std::string(1, static_cast<char>('a' + i % 3)));
    const AnalysisResult r = analyse(d, options, input);
    expect_near(r.graph_distances.dense(), theirs.at("paths"), 1e-9, "path lengths");
    ASSERT_EQ(r.embeddings[6].method, "Isomap");
    EXPECT_LT(procrustes({2, theirs.at("map")}, r.embeddings[6].embedding).rms_distance, 1e-6);
    ASSERT_TRUE(r.permanova.has_value());
    EXPECT_NEAR(r.permanova->pseudo_f, theirs.at("f")[0], 1e-9);
    EXPECT_NEAR(r.permanova->r_squared, theirs.at("r2")[0], 1e-12);
}

TEST_F(Independent, AgreementSilhouetteAndCorrelation) {
    const DistanceMatrix d = tests::grouped_matrix(60, 4, 1.5, 7);
    write_npy(folder_ / "d.npy", d);
    Random random(3);
    std::vector<std::size_t> a, b;
    std::string list_a, list_b;
    std::vector<std::string> classes;
    for (std::size_t i = 0; i < 60; ++i) {
        a.push_back(i % 4);
        b.push_back(random.below(3) == 0 ? random.below(5) : i % 4);
        classes.push_back(std::string(1, static_cast<char>('a' + a.back())));
        list_a += std::to_string(a.back()) + ",";
        list_b += std::to_string(b.back()) + ",";
    }
    const auto theirs = run("a = [" + list_a + "]\nb = [" + list_b + R"(]
from sklearn import metrics
from sklearn.neighbors import KNeighborsClassifier
from sklearn.model_selection import LeaveOneOut, cross_val_predict
from scipy.stats import spearmanr, kendalltau, pearsonr
d = np.load('d.npy')
put('rand', metrics.adjusted_rand_score(a, b))
put('information', metrics.mutual_info_score(a, b))
put('normalized', metrics.normalized_mutual_info_score(a, b))
put('adjusted', metrics.adjusted_mutual_info_score(a, b))
put('silhouette', metrics.silhouette_samples(d, a, metric='precomputed'))
classifier = KNeighborsClassifier(1, metric='precomputed', algorithm='brute')
predicted = cross_val_predict(classifier, d, np.array(a), cv=LeaveOneOut())
put('nearest', (predicted == np.array(a)).sum())
put('confusion', metrics.confusion_matrix(a, predicted))
put('precision', np.mean([metrics.average_precision_score([a[j] == a[i] for j in range(60) if j != i],
                                                            [-d[i, j] for j in range(60) if j != i]) for i in range(60)]))
x = np.round(d[0, 1:], 0); y = np.round(d[1, np.r_[0, 2:60]], 0)
put('spearman', spearmanr(x, y)[0]); put('kendall', kendalltau(x, y)[0]); put('pearson', pearsonr(x, y)[0])
)");
    const Agreement ours = agreement(a, b);
    EXPECT_NEAR(ours.adjusted_rand, theirs.at("rand")[0], 1e-12);
    EXPECT_NEAR(ours.mutual_information, theirs.at("information")[0], 1e-12);
    EXPECT_NEAR(ours.normalized_mutual_information, theirs.at("normalized")[0], 1e-12);
    EXPECT_NEAR(ours.adjusted_mutual_information, theirs.at("adjusted")[0], 1e-10);
    expect_near(silhouette_widths(d, a), theirs.at("silhouette"), 1e-12, "silhouette");
    const NeighbourAccuracy nearest = neighbour_accuracy(d, classes, 1);
    EXPECT_EQ(static_cast<double>(nearest.right), theirs.at("nearest")[0]);
    const ConfusionMatrix confusion = confusion_matrix(classes, nearest.predictions);
    for (std::size_t r = 0; r < 4; ++r) {
        for (std::size_t c = 0; c < 4; ++c) {
            EXPECT_EQ(static_cast<double>(confusion(r, c)), theirs.at("confusion")[4 * r + c]);
        }
    }
    EXPECT_NEAR(retrieval(d, classes).mean_average_precision, theirs.at("precision")[0], 1e-12);
    std::vector<double> x, y;
    for (std::size_t j = 0; j < 60; ++j) {
        if (j != 0) x.push_back(std::nearbyint(d(0, j)));
        if (j != 1) y.push_back(std::nearbyint(d(1, j)));
    }
    EXPECT_NEAR(spearman_correlation(x, y), theirs.at("spearman")[0], 1e-12);
    EXPECT_NEAR(kendall_correlation(x, y), theirs.at("kendall")[0], 1e-12);
    EXPECT_NEAR(pearson_correlation(x, y), theirs.at("pearson")[0], 1e-12);
}

}  // namespace
}  // namespace morphodesic::analysis

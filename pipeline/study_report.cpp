#include "pipeline/study_report.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <stdexcept>

#include "analysis/evaluation.h"
#include "analysis/gaps.h"
#include "analysis/leaf_order.h"
#include "analysis/linkage.h"
#include "analysis/mds.h"
#include "analysis/neighbor_graph.h"
#include "analysis/statistics.h"

namespace morphodesic::pipeline {
namespace {

namespace an = analysis;

std::vector<int> ints(const std::vector<std::size_t>& values) {
    return {values.begin(), values.end()};
}

reports::LinkageTree linkage_tree(const an::DistanceMatrix& complete, an::LinkageMethod method,
                                  const an::Dendrogram& tree) {
    reports::LinkageTree result;
    result.method = an::to_string(method);
    for (const an::Merge& m : tree.merges) {
        result.merges.push_back(
            {static_cast<int>(m.first), static_cast<int>(m.second), m.height, static_cast<int>(m.size)});
    }
    result.leaf_order = ints(an::optimal_leaf_order(tree, complete).order);
    result.cophenetic_correlation = an::cophenetic_correlation(tree, complete);
    return result;
}

/// Members with the smallest mean distance to the other members of their cluster.
std::vector<int> cluster_medoids(const an::DistanceMatrix& distances, const an::Clustering& clusters) {
    const std::size_t n = clusters.size(), k = an::cluster_count(clusters);
    std::vector<int> medoids(k, -1);
    std::vector<double> best(k, HUGE_VAL);
    for (std::size_t i = 0; i < n; ++i) {
        double sum = 0.0;
        for (std::size_t j = 0; j < n; ++j) {
            if (clusters[j] == clusters[i]) sum += distances(i, j);
        }
        if (sum < best[clusters[i]]) {
            best[clusters[i]] = sum;
            medoids[clusters[i]] = static_cast<int>(i);
        }
    }
    return medoids;
}

reports::Clustering clustering(const an::DistanceMatrix& complete, const an::Dendrogram& tree) {
    const an::SilhouetteCut cut = an::cut_by_silhouette(tree, complete, 20);
    reports::Clustering result;
    result.method = "average linkage";
    result.cut = "best silhouette";
    result.assignment = ints(cut.clusters);
    result.medoids = cluster_medoids(complete, cut.clusters);
    result.silhouette = an::mean(an::silhouette_widths(complete, cut.clusters));
    return result;
}

/// Kruskal's stress-1 of an embedding, and the share of every shape in it.
void add_stress(const an::DistanceMatrix& complete, const an::Embedding& points, reports::Embedding& result) {
    const std::size_t n = complete.size();
    double error = 0.0, sum = 0.0;
    std::vector<double> per_shape(n, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = i + 1; j < n; ++j) {
            double squared = 0.0;
            for (std::size_t a = 0; a < points.dimensions; ++a) squared += std::pow(points(i, a) - points(j, a), 2);
            const double difference = std::pow(std::sqrt(squared) - complete(i, j), 2);
            error += difference;
            sum += squared;
            per_shape[i] += 0.5 * difference;
            per_shape[j] += 0.5 * difference;
        }
    }
    if (!(sum > 0)) return;
    result.stress = std::sqrt(error / sum);
    for (double& share : per_shape) share = error > 0 ? share / error : 0.0;
    result.stress_per_shape = std::move(per_shape);
}

reports::Embedding embedding(const an::DistanceMatrix& complete, std::size_t dimension) {
    const an::ClassicalScaling scaling = an::classical_mds(complete, dimension);
    reports::Embedding result;
    result.method = "classical MDS";
    result.dimension = static_cast<int>(dimension);
    result.coordinates = scaling.embedding.coordinates;
    add_stress(complete, scaling.embedding, result);
    return result;
}

std::vector<reports::Edge> edges(const std::vector<an::Edge>& from) {
    std::vector<reports::Edge> result;
    for (const an::Edge& e : from) result.push_back({static_cast<int>(e.first), static_cast<int>(e.second), e.length});
    return result;
}

reports::ClassTable class_table(const an::DistanceMatrix& distances, const std::vector<std::string>& labels) {
    reports::ClassTable table;
    const an::NeighbourAccuracy nearest = an::neighbour_accuracy(distances, labels, 1);
    table.nearest_neighbour = nearest.accuracy;
    for (const std::size_t k : {1, 3, 5}) {
        table.k_nearest.emplace_back(static_cast<int>(k), an::neighbour_accuracy(distances, labels, k).accuracy);
    }
    const an::Retrieval retrieval = an::retrieval(distances, labels);
    table.bulls_eye = retrieval.bulls_eye;
    table.mean_average_precision = retrieval.mean_average_precision;
    for (std::size_t r = 0; r < retrieval.precision_at_recall.size(); ++r) {
        table.precision_recall.push_back({static_cast<double>(r) / 10, retrieval.precision_at_recall[r]});
    }
    std::size_t largest = 0;
    for (const auto& c : an::class_counts(labels)) largest = std::max(largest, c.members);
    table.bulls_eye_window = static_cast<int>(2 * largest);
    const an::ConfusionMatrix confusion = an::confusion_matrix(labels, nearest.predictions);
    table.classes = confusion.classes;
    for (std::size_t r = 0; r < confusion.classes.size(); ++r) {
        std::vector<int> row;
        for (std::size_t c = 0; c < confusion.classes.size(); ++c) row.push_back(static_cast<int>(confusion(r, c)));
        table.confusion.push_back(std::move(row));
    }
    for (const an::Medoid& medoid : an::class_medoids(distances, labels)) {
        table.class_medoids.push_back(static_cast<int>(medoid.item));
    }
    return table;
}

void add_shapes(const StudyData& data, const std::vector<std::size_t>& kept, reports::ReportModel& model) {
    for (const std::size_t i : kept) {
        const StoredShape& shape = data.shapes[i];
        reports::ReportShape entry;
        entry.name = shape.name;
        entry.label = shape.label;
        entry.volume = shape.volume;
        entry.notes = shape.notes;
        model.shapes.push_back(std::move(entry));
    }
    for (std::size_t i = 0; i < kept.size(); ++i) {
        for (std::size_t j = i + 1; j < kept.size(); ++j) {
            model.distances.push_back(data.distances(kept[i], kept[j]));
            model.errors.push_back(data.distances.error(kept[i], kept[j]));
            const auto& pair = data.pairs[data.index(kept[i], kept[j])];
            if (pair && !pair->problem().empty()) {
                model.trust.not_converged.push_back({static_cast<int>(i), static_cast<int>(j), pair->problem()});
            }
        }
    }
}

}  // namespace

AnalysedStudy analyse_study(const StudyData& data) {
    AnalysedStudy result;
    reports::ReportModel& model = result.model;
    const an::GapTreatment gaps = an::fill_gaps(data.distances);
    result.kept = gaps.kept;
    add_shapes(data, gaps.kept, model);
    model.dimension = data.dimension;
    model.shapes_found = static_cast<int>(data.shapes.size() + data.unusable.size());
    model.pairs_total = static_cast<long>(data.distances.pair_count());
    model.pairs_done = model.pairs_total - data.pairs_missing;
    for (const StudyFailure& failure : data.failures) model.failures.push_back({failure.a, failure.b, failure.reason});
    for (const std::size_t i : gaps.left_out) {
        model.failures.push_back({data.shapes[i].name, "", "no chain of trustworthy distances joins it to the others"});
    }
    if (!gaps.description.empty()) model.trust.remarks.push_back(gaps.description);
    for (const std::string& remark : data.remarks) model.trust.remarks.push_back(remark);
    model.cpu_seconds = 0.0;
    for (const auto& pair : data.pairs) {
        if (pair && std::isfinite(pair->seconds)) model.cpu_seconds += pair->seconds;
    }

    const an::DistanceMatrix& complete = gaps.complete;
    const std::size_t n = complete.size();
    if (n == 0) return result;
    const an::Dendrogram average = an::linkage(complete, an::LinkageMethod::average);
    model.linkages.push_back(linkage_tree(complete, an::LinkageMethod::average, average));
    for (const auto method : {an::LinkageMethod::single, an::LinkageMethod::complete}) {
        model.linkages.push_back(linkage_tree(complete, method, an::linkage(complete, method)));
    }
    model.clusterings.push_back(clustering(complete, average));
    model.embeddings.push_back(embedding(complete, 2));
    if (n > 3) model.embeddings.push_back(embedding(complete, 3));
    const an::DistanceMatrix known = data.distances.subset(gaps.kept);
    model.spanning_tree = edges(an::minimum_spanning_tree(known));
    model.graph_neighbours = static_cast<int>(std::min<std::size_t>(3, n - 1));
    if (n > 1) {
        model.neighbour_graph =
            edges(an::nearest_neighbour_graph(known, static_cast<std::size_t>(model.graph_neighbours)));
    }
    std::vector<std::string> labels;
    for (const reports::ReportShape& shape : model.shapes) labels.push_back(shape.label);
    if (an::class_counts(labels).size() > 1) model.classes.push_back(class_table(known, labels));
    const std::vector<int>& clusters = model.clusterings.front().assignment;
    model.trust.silhouettes = an::silhouette_widths(complete, {clusters.begin(), clusters.end()});
    return result;
}

std::vector<std::pair<int, int>> choose_paths(const reports::ReportModel& model, const std::string& choice) {
    const int n = static_cast<int>(model.shapes.size());
    const auto distance = [&](int a, int b) {
        return model.distances[an::DistanceMatrix::condensed_index(
            static_cast<std::size_t>(n), static_cast<std::size_t>(a), static_cast<std::size_t>(b))];
    };
    std::vector<std::pair<int, int>> chosen;
    std::set<std::pair<int, int>> seen;
    const auto choose = [&](int a, int b) {
        const std::pair<int, int> pair = std::minmax(a, b);
        if (a != b && distance(a, b) > 0 && seen.insert(pair).second) chosen.push_back(pair);
    };
    std::size_t limit = 0;
    const auto [end, error] = std::from_chars(choice.data(), choice.data() + choice.size(), limit);
    const bool is_number = error == std::errc() && end == choice.data() + choice.size();
    if (!is_number && choice != "none" && choice != "nearest" && choice != "all") {
        throw std::invalid_argument("--paths is \"" + choice + "\"; it must be none, nearest, all or a number");
    }
    if (choice == "none") return chosen;
    if (is_number) {
        const std::vector<int> medoids = !model.classes.empty()       ? model.classes.front().class_medoids
                                         : !model.clusterings.empty() ? model.clusterings.front().medoids
                                                                      : std::vector<int>();
        for (std::size_t i = 0; i < medoids.size(); ++i) {
            for (std::size_t j = i + 1; j < medoids.size(); ++j) choose(medoids[i], medoids[j]);
        }
        std::pair<int, int> nearest{0, 0}, farthest{0, 0};
        double low = HUGE_VAL, high = 0.0;
        for (int a = 0; a < n; ++a) {
            for (int b = a + 1; b < n; ++b) {
                const double d = distance(a, b);
                if (d > 0 && d < low) low = d, nearest = {a, b};
                if (d > high) high = d, farthest = {a, b};
            }
        }
        choose(nearest.first, nearest.second);
        choose(farthest.first, farthest.second);
    } else {
        limit = static_cast<std::size_t>(-1);
    }
    for (int a = 0; a < n && chosen.size() < limit; ++a) {
        int nearest = a;
        double low = HUGE_VAL;
        for (int b = 0; b < n; ++b) {
            if (b != a && distance(a, b) > 0 && distance(a, b) < low) low = distance(a, b), nearest = b;
        }
        choose(a, nearest);
    }
    for (int a = 0; a < n && choice == "all"; ++a) {
        for (int b = a + 1; b < n; ++b) choose(a, b);
    }
    if (chosen.size() > limit) chosen.resize(limit);
    return chosen;
}

}  // namespace morphodesic::pipeline

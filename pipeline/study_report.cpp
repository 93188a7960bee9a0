#include "pipeline/study_report.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>
#include <stdexcept>

#include "pipeline/stop_signals.h"

namespace morphodesic::pipeline {
namespace {

namespace an = analysis;

std::vector<int> ints(const std::vector<std::size_t>& values) {
    return {values.begin(), values.end()};
}
int number(std::size_t value) {
    return static_cast<int>(value);
}

reports::LinkageTree tree_of(const an::TreeResult& from) {
    reports::LinkageTree tree;
    tree.method = an::to_string(from.method);
    for (const an::Merge& m : from.tree.merges) {
        tree.merges.push_back({number(m.first), number(m.second), m.height, number(m.size)});
    }
    tree.leaf_order = ints(from.leaf_order.order);
    tree.cophenetic_correlation = from.cophenetic_correlation;
    return tree;
}

std::vector<reports::Edge> edges_of(const std::vector<an::Edge>& from) {
    std::vector<reports::Edge> edges;
    for (const an::Edge& e : from) edges.push_back({number(e.first), number(e.second), e.length});
    return edges;
}

reports::ClassTable table_of(const an::ClassResult& from, const an::AnalysisResult& all) {
    reports::ClassTable table;
    table.name = from.ranking;
    for (const an::NeighbourAccuracy& nearest : from.nearest) {
        if (nearest.k == 1) table.nearest_neighbour = nearest.accuracy;
        table.k_nearest.emplace_back(number(nearest.k), nearest.accuracy);
    }
    table.bulls_eye = from.retrieved.bulls_eye;
    table.bulls_eye_window = from.bulls_eye_window;
    table.mean_average_precision = from.retrieved.mean_average_precision;
    for (std::size_t r = 0; r < from.retrieved.precision_at_recall.size(); ++r) {
        table.precision_recall.push_back({static_cast<double>(r) / 10, from.retrieved.precision_at_recall[r]});
    }
    table.classes = from.confusion.classes;
    for (std::size_t r = 0; r < table.classes.size(); ++r) {
        std::vector<int> row;
        for (std::size_t c = 0; c < table.classes.size(); ++c) row.push_back(number(from.confusion(r, c)));
        table.confusion.push_back(std::move(row));
    }
    for (const an::Medoid& medoid : all.class_medoids) table.class_medoids.push_back(number(medoid.item));
    table.adjusted_rand = all.agreement.adjusted_rand;
    table.adjusted_mutual_information = all.agreement.adjusted_mutual_information;
    if (all.permanova) {
        table.permanova_f = all.permanova->pseudo_f;
        table.permanova_p = all.permanova->p_value;
        table.permanova_r2 = all.permanova->r_squared;
        table.permutations = number(all.permanova->permutations);
    }
    return table;
}

reports::Trust trust_of(const an::AnalysisResult& all) {
    reports::Trust trust;
    trust.triangles_checked = static_cast<long>(all.triangles.triangles);
    trust.triangles_violated = static_cast<long>(all.triangles.violated);
    trust.triangles_beyond_error = static_cast<long>(all.triangles.beyond_error);
    for (const an::TriangleViolation& t : all.triangles.worst) {
        trust.worst_triangles.push_back({number(t.first), number(t.via), number(t.last), t.excess, t.error});
    }
    trust.median_asymmetry = all.directions.median;
    trust.max_asymmetry = all.directions.largest;
    for (const an::DirectedPair& pair : all.directions.worst) {
        trust.asymmetries.push_back({number(pair.first), number(pair.second), pair.forward, pair.backward});
    }
    if (!all.clusterings.empty()) trust.silhouettes = all.clusterings.front().silhouettes;
    for (const an::ClusterStability& c : all.stability.clusters)
        trust.stability.push_back({number(c.cluster), c.jaccard});
    if (all.stability.runs > 0) trust.stability_rand = all.stability.mean_rand;
    trust.perturbations = number(all.stability.runs);
    trust.seed = static_cast<unsigned long>(all.options.seed);
    for (const an::CloseClusters& c : all.close) {
        trust.close_clusters.push_back({number(c.first), number(c.second), c.separation, c.error});
    }
    trust.graph_correlation = all.isomap_correlation;
    trust.remarks = all.remarks;
    return trust;
}

/// Names, labels and distances of the kept shapes; the others become failures.
void add_shapes(const StudyData& data, const an::AnalysisResult& all, reports::ReportModel& model) {
    for (const std::size_t i : all.kept) {
        reports::ReportShape shape;
        shape.name = data.shapes[i].name;
        shape.label = data.shapes[i].label;
        shape.volume = data.shapes[i].volume;
        shape.notes = data.shapes[i].notes;
        model.shapes.push_back(std::move(shape));
    }
    for (const StudyFailure& failure : data.failures) {
        if (failure.a.empty()) continue;  // of the study as a whole: among the warnings
        model.failures.push_back({failure.a, failure.b, failure.reason});
    }
    for (const std::size_t i : all.left_out) {
        model.failures.push_back(
            {data.shapes[i].name, "", "no chain of trustworthy distances joins it to the others", true});
    }
    for (std::size_t i = 0; i < all.kept.size(); ++i) {
        for (std::size_t j = i + 1; j < all.kept.size(); ++j) {
            model.distances.push_back(data.distances(all.kept[i], all.kept[j]));
            if (data.distances.has_errors()) {
                model.errors.push_back(data.distances.error(all.kept[i], all.kept[j]));
            }
            if (data.pairs_coarse > 0) {
                model.refined.push_back(data.refined(data.index(all.kept[i], all.kept[j])) ? 1 : 0);
            }
            const StoredGeodesic* const pair = data.geodesic(data.index(all.kept[i], all.kept[j]));
            if (pair != nullptr && !pair->problem().empty()) {
                model.trust.not_converged.push_back({number(i), number(j), pair->problem()});
            }
        }
    }
}

/// A whole number >= 0, if the text is one.
std::optional<std::size_t> count_from(const std::string& text) {
    std::size_t count = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return count;
}

}  // namespace

AnalysedStudy analyse_study(const StudyData& data, const an::AnalysisOptions& options) {
    an::AnalysisInput input;
    for (const StoredShape& shape : data.shapes) input.classes.push_back(shape.label);
    for (std::size_t i = 0; i < data.shapes.size(); ++i) {
        for (std::size_t j = i + 1; j < data.shapes.size(); ++j) {
            const std::size_t p = data.index(i, j);
            const StoredGeodesic *there = data.geodesic(p), *back = data.backward_geodesic(p);
            if (there == nullptr || back == nullptr || !data.distances.known(i, j)) continue;
            if (!data.first_is_a[p]) std::swap(there, back);
            input.directed.push_back({i, j, there->path_length, back->path_length});
        }
    }
    input.directed.insert(input.directed.end(), data.given_directions.begin(), data.given_directions.end());
    input.proceed = [](const char*) { return StopSignals::caught() == 0; };
    AnalysedStudy result;
    result.analysis = an::analyse(data.distances, options, input);
    const an::AnalysisResult& all = result.analysis;
    reports::ReportModel& model = result.model;
    model.trust = trust_of(all);
    model.trust.remarks.insert(model.trust.remarks.end(), data.remarks.begin(), data.remarks.end());
    if (!data.coarse_note.empty()) model.trust.remarks.push_back(data.coarse_note);
    add_shapes(data, all, model);
    model.dimension = data.dimension;
    model.given_matrix = data.given;
    model.shapes_found = number(data.shapes.size() + data.unusable.size());
    model.pairs_total = static_cast<long>(data.distances.pair_count());
    for (std::size_t i = 0; i < data.shapes.size(); ++i) {
        for (std::size_t j = i + 1; j < data.shapes.size(); ++j) model.pairs_done += data.distances.known(i, j) ? 1 : 0;
    }
    model.cpu_seconds = 0.0;
    for (const auto* direction : {&data.pairs, &data.backward}) {
        for (const auto& pair : *direction) {
            if (pair && std::isfinite(pair->seconds)) model.cpu_seconds += pair->seconds;
        }
    }
    for (const an::TreeResult& tree : all.trees) model.linkages.push_back(tree_of(tree));
    for (const an::ClusterResult& c : all.clusterings) {
        model.clusterings.push_back({c.method, c.cut, ints(c.clusters), ints(c.medoids), c.mean_silhouette,
                                     an::adjusted_rand(c.clusters, all.clusterings.front().clusters)});
    }
    for (const an::EmbeddingResult& e : all.embeddings) {
        model.embeddings.push_back({e.method, number(e.embedding.dimensions), e.embedding.coordinates, e.stress,
                                    e.stress_per_item, e.disparities});
    }
    model.spanning_tree = edges_of(all.spanning_tree);
    model.neighbour_graph = edges_of(all.neighbour_graph);
    model.graph_neighbours = all.options.neighbors;
    for (const an::ClassResult& ranking : all.class_results) model.classes.push_back(table_of(ranking, all));
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
    if (const std::string problem = path_choice_problem(choice); !problem.empty()) throw std::invalid_argument(problem);
    if (choice == "none") return chosen;
    std::size_t limit = static_cast<std::size_t>(-1);
    if (const auto count = count_from(choice)) {
        limit = *count;
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

std::string path_choice_problem(const std::string& choice) {
    if (choice == "none" || choice == "nearest" || choice == "all" || count_from(choice)) return "";
    return "--paths is \"" + choice + "\"; it must be none, nearest, all or a number";
}

}  // namespace morphodesic::pipeline

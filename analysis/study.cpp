#include "analysis/study.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <set>
#include <stdexcept>

#include "analysis/csv.h"
#include "analysis/diffusion.h"
#include "analysis/gaps.h"
#include "analysis/parallel.h"
#include "analysis/procrustes.h"
#include "analysis/statistics.h"

namespace morphodesic::analysis {
namespace {

/// Time and permission to go on, part by part.
class Parts {
public:
    Parts(AnalysisResult& result, const AnalysisInput& input) : result_(result), input_(input) {}
    template <class Work>
    void operator()(const char* name, const Work& work) {
        if (result_.cancelled) return;
        if (input_.proceed && !input_.proceed(name)) {
            result_.cancelled = true;
            return;
        }
        const auto begin = std::chrono::steady_clock::now();
        work();
        result_.seconds.push_back(
            {name, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count()});
    }

private:
    AnalysisResult& result_;
    const AnalysisInput& input_;
};

void cluster_along_leaf_order(Clustering& clusters, const std::vector<std::size_t>& order) {
    std::vector<std::size_t> number(cluster_count(clusters), clusters.size());
    std::size_t next = 0;
    for (const std::size_t i : order) {
        if (number[clusters[i]] == clusters.size()) number[clusters[i]] = next++;
    }
    for (std::size_t& c : clusters) c = number[c];
}

ClusterResult describe(const DistanceMatrix& distances, std::string method, std::string cut, Clustering clusters) {
    ClusterResult result{std::move(method), std::move(cut), std::move(clusters), {}, {}, missing};
    const std::size_t n = distances.size();
    std::vector<double> sum(n, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = i + 1; j < n; ++j) {
            if (result.clusters[i] != result.clusters[j]) continue;
            sum[i] += distances(i, j);
            sum[j] += distances(i, j);
        }
    }
    result.medoids.assign(cluster_count(result.clusters), n);
    for (std::size_t i = 0; i < n; ++i) {
        std::size_t& medoid = result.medoids[result.clusters[i]];
        if (medoid == n || sum[i] < sum[medoid]) medoid = i;
    }
    result.silhouettes = silhouette_widths(distances, result.clusters);
    result.mean_silhouette = mean(result.silhouettes);
    return result;
}

ClassResult judge(const std::string& ranking, const DistanceMatrix& distances, const std::vector<std::string>& classes,
                  std::size_t neighbours) {
    ClassResult result;
    result.ranking = ranking;
    for (const std::size_t k : std::set<std::size_t>{1, 3, 5, neighbours}) {
        result.nearest.push_back(neighbour_accuracy(distances, classes, k));
    }
    result.confusion = confusion_matrix(classes, result.nearest.front().predictions);
    result.retrieved = retrieval(distances, classes);
    const std::vector<ClassCount> counts = class_counts(classes);
    const bool equal = !counts.empty() && std::all_of(counts.begin(), counts.end(), [&](const ClassCount& c) {
        return c.members == counts.front().members;
    });
    if (equal) result.bulls_eye_window = static_cast<int>(2 * counts.front().members);
    return result;
}

/// Whether the starts of a map agree.
std::string starts_in_words(const EmbeddingResult& map) {
    double highest = map.stress, largest = 0.0;
    for (const SmacofRun& run : map.runs) {
        highest = std::max(highest, run.stress);
        largest = std::max(largest, run.distance_to_best);
    }
    char text[200];
    std::snprintf(text, sizeof text,
                  "The map in %zu dimensions is the best of %zu starts: stress %.3g (when it was chosen they had up to "
                  "%.3g); aligned with the best, their points lie up to %.3g away (root mean square).",
                  map.embedding.dimensions, map.runs.size(), map.stress, highest, largest);
    return text;
}

EmbeddingResult from(const char* method, Smacof&& s, bool metric) {
    EmbeddingResult result{method, std::move(s.embedding), s.stress,    std::move(s.stress_per_item),
                           {},     s.iterations,           s.converged, std::move(s.runs)};
    if (!metric) result.disparities = std::move(s.disparities);
    return result;
}

/// The first axes of a classical scaling as a map, judged by the distances.
EmbeddingResult from(const char* method, const DistanceMatrix& distances, const ClassicalScaling& scaling,
                     std::size_t dimensions) {
    const Embedding& all = scaling.embedding;
    EmbeddingResult result{method, {dimensions, {}}, 0.0, {}, {}, 0, true, {}};
    for (std::size_t i = 0; i < all.size(); ++i) {
        for (std::size_t axis = 0; axis < dimensions; ++axis) {
            result.embedding.coordinates.push_back(all(i, axis));
        }
    }
    const std::vector<double> embedded = embedded_distances(result.embedding);
    const std::size_t n = distances.size();
    result.stress_per_item.assign(n, 0.0);
    double misfit = 0.0, squares = 0.0;
    for (std::size_t i = 0, k = 0; i < n; ++i) {
        for (std::size_t j = i + 1; j < n; ++j, ++k) {
            const double m = std::pow(embedded[k] - distances.condensed()[k], 2);
            misfit += m;
            squares += embedded[k] * embedded[k];
            result.stress_per_item[i] += m;
            result.stress_per_item[j] += m;
        }
    }
    result.stress = squares > 0.0 ? std::sqrt(misfit / squares) : misfit > 0.0 ? 1.0 : 0.0;
    for (double& s : result.stress_per_item) s = result.stress > 1e-12 ? s / (2.0 * misfit) : 0.0;
    return result;
}

}  // namespace

std::vector<std::string> AnalysisOptions::problems() const {
    std::vector<std::string> found;
    const auto require = [&](bool good, const char* text) {
        if (!good) found.emplace_back(text);
    };
    require(linkage == "single" || linkage == "complete" || linkage == "average" || linkage == "ward",
            "linkage must be single, complete, average or ward");
    require(clusters >= 0, "clusters must be >= 0");
    require(cut_height >= 0.0 && std::isfinite(cut_height), "cut-height must be >= 0");
    require(clusters == 0 || cut_height == 0.0, "give clusters or cut-height, not both");
    require(max_clusters >= 2, "max-clusters must be >= 2");
    require(neighbors >= 1, "neighbors must be >= 1");
    require(embedding_starts >= 1, "embedding-starts must be >= 1");
    require(embedding_iterations >= 0, "embedding-iterations must be >= 0");
    require(perturbations >= 0, "perturbations must be >= 0");
    require(assumed_error >= 0.0 && assumed_error <= 1.0, "assumed-error must lie between 0 and 1");
    require(permutations >= 0, "permutations must be >= 0");
    require(diffusion_neighbors >= 1, "diffusion-neighbors must be >= 1");
    require(seed >= 0, "seed must be >= 0");
    return found;
}

AnalysisResult analyse(const DistanceMatrix& given, const AnalysisOptions& options, const AnalysisInput& input) {
    if (const auto problems = options.problems(); !problems.empty()) throw std::invalid_argument(problems.front());
    if (!input.classes.empty() && input.classes.size() != given.size()) {
        throw std::invalid_argument("one class per item is needed, \"\" if unknown");
    }
    AnalysisResult r;
    r.options = options;
    Parts part(r, input);
    const auto seed = static_cast<std::uint64_t>(options.seed);
    DistanceMatrix known;  // of the kept items, gaps left open
    part("gaps", [&] {
        GapTreatment gaps = fill_gaps(given);
        r.kept = std::move(gaps.kept);
        r.left_out = std::move(gaps.left_out);
        r.distances = std::move(gaps.complete);
        if (!gaps.description.empty()) r.remarks.push_back(gaps.description);
        std::vector<std::size_t> number(given.size(), given.size());
        for (std::size_t i = 0; i < r.kept.size(); ++i) number[r.kept[i]] = i;
        known = given.subset(r.kept);
        r.labels = r.distances.labels();
        if (!input.classes.empty()) {
            for (const std::size_t i : r.kept) r.classes.push_back(input.classes[i]);
        }
        if (options.assumed_error > 0.0) {
            for (DistanceMatrix* const matrix : {&known, &r.distances}) {
                for (std::size_t i = 0; i < matrix->size(); ++i) {
                    for (std::size_t j = i + 1; j < matrix->size(); ++j) {
                        if (matrix->known(i, j) && std::isnan(matrix->error(i, j))) {
                            matrix->set(i, j, (*matrix)(i, j), options.assumed_error * (*matrix)(i, j));
                        }
                    }
                }
            }
        }
        std::vector<DirectedPair> directed;
        for (const DirectedPair& p : input.directed) {
            if (p.first >= given.size() || p.second >= given.size()) {
                throw std::invalid_argument("a directed pair names an item that is not there");
            }
            if (number[p.first] < given.size() && number[p.second] < given.size()) {
                directed.push_back({number[p.first], number[p.second], p.forward, p.backward});
            }
        }
        r.directions = asymmetry(directed);
    });
    const std::size_t n = r.labels.size();
    if (r.cancelled || n == 0) return r;

    part("linkage", [&] {
        std::vector<LinkageMethod> methods{parse_linkage_method(options.linkage)};
        for (const auto m :
             {LinkageMethod::average, LinkageMethod::complete, LinkageMethod::single, LinkageMethod::ward}) {
            if (m != methods.front()) methods.push_back(m);
        }
        r.trees.resize(methods.size());
        parallel_for_each_index(methods.size(), 1, [&](std::size_t k) {
            Dendrogram tree = linkage(r.distances, methods[k]);
            const double correlation = cophenetic_correlation(tree, r.distances);
            r.trees[k] = {methods[k], std::move(tree), {}, correlation};
        });
    });
    part("leaf order", [&] {
        for (TreeResult& t : r.trees) t.leaf_order = optimal_leaf_order(t.tree, r.distances);
        if (!r.trees.front().leaf_order.optimal) {
            r.remarks.push_back("The leaf order is not optimal: more than " + std::to_string(optimal_order_limit) +
                                " items, each merge was only turned the better way round.");
        }
    });
    part("clusters", [&] {
        const Dendrogram& tree = r.trees.front().tree;
        SilhouetteCut best = cut_by_silhouette(tree, r.distances, static_cast<std::size_t>(options.max_clusters));
        Clustering clusters = std::move(best.clusters);
        std::string cut = cluster_count(clusters) > 1 ? "best silhouette" : "no cut has a silhouette above 0";
        if (options.clusters > 0) {
            const std::size_t count = std::min(n, static_cast<std::size_t>(options.clusters));
            clusters = cut_by_count(tree, count);
            cut = std::to_string(count) + (count == 1 ? " cluster" : " clusters");
            if (count < static_cast<std::size_t>(options.clusters)) {
                r.remarks.push_back("There are only " + std::to_string(n) + " items to cut into " +
                                    std::to_string(options.clusters) + " clusters.");
            }
        } else if (options.cut_height > 0.0) {
            clusters = cut_by_height(tree, options.cut_height);
            cut = "height " + csv_cell(options.cut_height);
        }
        cluster_along_leaf_order(clusters, r.trees.front().leaf_order.order);
        r.clusterings.push_back(describe(r.distances, options.linkage + " linkage", cut, std::move(clusters)));
    });
    part("k-medoids", [&] {
        const std::size_t count = cluster_count(r.clusterings.front().clusters);
        Clustering clusters = k_medoids(r.distances, count).clusters;
        cluster_along_leaf_order(clusters, r.trees.front().leaf_order.order);
        r.clusterings.push_back(describe(r.distances, "k-medoids",
                                         std::to_string(count) + (count == 1 ? " cluster" : " clusters"),
                                         std::move(clusters)));
    });
    part("graphs", [&] {
        r.spanning_tree = minimum_spanning_tree(known);
        r.neighbour_graph = nearest_neighbour_graph(known, static_cast<std::size_t>(options.neighbors));
    });
    part("graph distances", [&] {
        GraphDistances paths = isomap_distances(known, static_cast<std::size_t>(options.neighbors));
        r.graph_distances = std::move(paths.distances);
        r.isomap_correlation = spearman_correlation(r.distances.condensed(), r.graph_distances.condensed());
        if (paths.joined_components > 1) {
            r.remarks.push_back("The graph of the " + std::to_string(options.neighbors) +
                                " nearest neighbours falls into " + std::to_string(paths.joined_components) +
                                " parts; paths between them take edges of the minimum spanning tree.");
        }
    });
    part("classical MDS", [&] {
        const ClassicalScaling axes = classical_mds(r.distances, 3);
        for (const std::size_t d : {2u, 3u}) r.embeddings.push_back(from("classical MDS", r.distances, axes, d));
    });
    part("Isomap", [&] {
        const ClassicalScaling axes = classical_mds(r.graph_distances, 3);
        for (const std::size_t d : {2u, 3u}) r.embeddings.push_back(from("Isomap", r.distances, axes, d));
    });
    // One iteration costs O(n^2): 500 of them up to about 900 items, 100 for 2000; the monotone regression costs
    // tenfold.
    const auto size = static_cast<double>(n);
    const auto by_size = [&](double budget, double most) {
        return static_cast<std::size_t>(std::clamp(budget / (size * size), 20.0, most));
    };
    std::vector<EmbeddingResult> scaled;
    for (const bool metric : {true, false}) {
        part(metric ? "SMACOF" : "non-metric SMACOF", [&] {
            for (const std::size_t dimensions : {2u, 3u}) {
                SmacofOptions s;
                s.dimensions = dimensions;
                s.metric = metric;
                s.starts = static_cast<std::size_t>(options.embedding_starts);
                s.seed = seed;
                if (!metric) {  // from the metric picture; other starts only where they are cheap
                    s.initial = &scaled[dimensions - 2].embedding;
                    if (n > 900) s.starts = 1;
                }
                s.max_iterations = options.embedding_iterations > 0
                                       ? static_cast<std::size_t>(options.embedding_iterations)
                                       : by_size(metric ? 4e8 : 1e8, 500.0);
                scaled.push_back(from(metric ? "SMACOF" : "non-metric SMACOF", smacof(r.distances, s), metric));
                const EmbeddingResult& e = scaled.back();
                if (metric && e.runs.size() > 1) r.remarks.push_back(starts_in_words(e));
                if (!e.converged) {
                    r.remarks.push_back(e.method + " in " + std::to_string(dimensions) + " dimensions stopped after " +
                                        std::to_string(e.iterations) +
                                        " iterations, its last digits may still change.");
                }
            }
        });
    }
    r.embeddings.insert(r.embeddings.begin(), std::make_move_iterator(scaled.begin()),
                        std::make_move_iterator(scaled.end()));
    // All maps of one dimension lie as the first one does, so that a reader can go from one to the other.
    for (std::size_t m = 2; m < r.embeddings.size(); ++m) {
        Embedding& map = r.embeddings[m].embedding;
        map = procrustes(r.embeddings[map.dimensions - 2].embedding, map).aligned;
    }
    part("triangles", [&] { r.triangles = triangle_violations(known); });
    part("stability", [&] {
        const Clustering& clusters = r.clusterings.front().clusters;
        r.close = close_clusters(r.distances, clusters);
        const std::size_t runs =
            options.perturbations > 0 ? static_cast<std::size_t>(options.perturbations) : by_size(1e8, 100.0);
        if (r.distances.has_errors()) {
            r.stability = cluster_stability(r.distances, clusters, r.trees.front().method, runs, seed);
        } else if (n > 1) {
            r.remarks.emplace_back("No error bars are known, so the stability of the clusters was not checked.");
        }
    });
    if (options.diffuse) {
        part("diffusion", [&] {
            DiffusionOptions d;
            d.neighbours = static_cast<std::size_t>(options.diffusion_neighbors);
            r.diffused = diffused_distances(known, d);
        });
    }
    const std::vector<ClassCount> counts = class_counts(r.classes);
    if (options.diffuse && counts.size() < 2) {
        r.remarks.emplace_back("--diffuse judges classes, of which there are none to tell apart.");
    }
    if (counts.size() == 1) {
        r.remarks.push_back("All shapes with a class are of the same one (" + counts.front().name +
                            "): no neighbour could be of another, so no accuracy is stated.");
    } else if (!counts.empty()) {
        part("classes", [&] {
            const auto k = static_cast<std::size_t>(options.neighbors);
            r.class_results.push_back(judge("distances", known, r.classes, k));
            if (r.diffused) r.class_results.push_back(judge("diffused distances", *r.diffused, r.classes, k));
            r.class_medoids = class_medoids(known, r.classes);
            r.agreement = agreement(r.clusterings.front().clusters, r.classes);
            r.permanova = permanova(r.distances, r.classes, static_cast<std::size_t>(options.permutations), seed);
        });
    }
    return r;
}

void write_clusters_csv(std::ostream& out, const AnalysisResult& result, const DistanceMatrix& given) {
    out << "name,class,cluster,medoid,silhouette,stability,k_medoids,position\n";
    if (!result.clusterings.empty()) {
        const ClusterResult& tree = result.clusterings.front();
        std::vector<std::size_t> position(result.labels.size());
        for (std::size_t p = 0; p < position.size(); ++p) position[result.trees.front().leaf_order.order[p]] = p;
        for (std::size_t i = 0; i < result.labels.size(); ++i) {
            out << csv_cell(result.labels[i]) << ',' << csv_cell(result.classes.empty() ? "" : result.classes[i]) << ','
                << tree.clusters[i] + 1 << ',' << (tree.medoids[tree.clusters[i]] == i ? 1 : 0) << ','
                << csv_cell(tree.silhouettes[i]) << ','
                << (result.stability.item_stability.empty() ? "" : csv_cell(result.stability.item_stability[i])) << ',';
            if (result.clusterings.size() > 1) out << result.clusterings[1].clusters[i] + 1;
            out << ',' << position[i] + 1 << '\n';
        }
    }
    for (const std::size_t i : result.left_out) out << csv_cell(given.labels().at(i)) << ",,,,,,,\n";
}

void write_linkage_csv(std::ostream& out, const AnalysisResult& result) {
    out << "cluster,first,second,height,size\n";
    if (result.trees.empty()) return;
    const Dendrogram& tree = result.trees.front().tree;
    for (std::size_t m = 0; m < tree.merges.size(); ++m) {
        const Merge& merge = tree.merges[m];
        out << tree.leaf_count + m << ',' << merge.first << ',' << merge.second << ',' << csv_cell(merge.height) << ','
            << merge.size << '\n';
    }
}

void write_embedding_csv(std::ostream& out, const AnalysisResult& result) {
    out << "name,method,dimensions,x,y,z,stress_share\n";
    for (const EmbeddingResult& e : result.embeddings) {
        for (std::size_t i = 0; i < e.embedding.size(); ++i) {
            out << csv_cell(result.labels[i]) << ',' << e.method << ',' << e.embedding.dimensions;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                out << ',' << (axis < e.embedding.dimensions ? csv_cell(e.embedding(i, axis)) : "");
            }
            out << ',' << csv_cell(e.stress_per_item[i]) << '\n';
        }
    }
}

}  // namespace morphodesic::analysis

#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/agreement.h"
#include "analysis/diagnostics.h"
#include "analysis/distance_matrix.h"
#include "analysis/evaluation.h"
#include "analysis/k_medoids.h"
#include "analysis/leaf_order.h"
#include "analysis/linkage.h"
#include "analysis/mds.h"
#include "analysis/neighbor_graph.h"
#include "analysis/smacof.h"

namespace morphodesic::analysis {

/// Everything that changes the result of an analysis. One list of fields feeds command line, hash, store and report.
struct AnalysisOptions {
    std::string linkage = "average";  ///< single | complete | average | ward: the tree that is cut and shown first
    int clusters = 0;                 ///< cut into so many clusters, >= 0; 0: by height if given, else best silhouette
    double cut_height = 0.0;          ///< cut at this height, >= 0; 0: no
    int max_clusters = 30;            ///< largest number tried for the best silhouette, >= 2
    int neighbors = 5;                ///< k of the neighbour graph and of k-NN, >= 1
    int embedding_starts = 4;         ///< starts of SMACOF, >= 1
    int embedding_iterations =
        0;                       ///< limit for SMACOF, >= 0; 0: 500, fewer for more than 900 items (said in the result)
    int perturbations = 0;       ///< runs of the stability check, >= 0; 0: 100, fewer for more than 1000 items
    double assumed_error = 0.0;  ///< error bar where the matrix has none, as share of the distance, >= 0
    int permutations = 999;      ///< of PERMANOVA, >= 0
    bool diffuse = false;        ///< also rank by diffusion on the neighbour graph
    int diffusion_neighbors = 5;  ///< k of its affinity graph, >= 1; good below the size of the classes
    int seed = 1;                 ///< of everything random, >= 0

    template <class Self, class Visitor>
    static void for_each_field(Self& self, Visitor&& visit) {
        visit("linkage", self.linkage, "linkage of the tree: single, complete, average or ward");
        visit("clusters", self.clusters, "number of clusters; 0: best silhouette, or --cut-height");
        visit("cut-height", self.cut_height, "cut the tree at this height; 0: not by height");
        visit("max-clusters", self.max_clusters, "largest number of clusters tried for the best silhouette");
        visit("neighbors", self.neighbors, "k of the neighbour graph and of k-nearest-neighbour accuracy");
        visit("embedding-starts", self.embedding_starts, "starts of the embedding, of which the best is refined");
        visit("embedding-iterations", self.embedding_iterations,
              "limit on the iterations of the embedding; 0: by size");
        visit("perturbations", self.perturbations, "runs of the cluster stability check; 0: by size");
        visit("assumed-error", self.assumed_error, "error bar as share of the distance where none is known");
        visit("permutations", self.permutations, "permutations of the test of classes (PERMANOVA)");
        visit("diffuse", self.diffuse, "judge classes by distances diffused on the neighbour graph, too");
        visit("diffusion-neighbors", self.diffusion_neighbors,
              "k of the affinity graph of the diffusion; choose it below the size of the classes");
        visit("seed", self.seed, "seed of everything random");
    }
    /// Every violated constraint, in words; empty if the options are usable.
    [[nodiscard]] std::vector<std::string> problems() const;
    friend bool operator==(const AnalysisOptions&, const AnalysisOptions&) = default;
};

/// What is known besides the distances; all of it optional. Item numbers are those of the given matrix.
struct AnalysisInput {
    std::vector<std::string> classes;    ///< class of each item, "" if unknown; empty: no classes
    std::vector<DirectedPair> directed;  ///< path lengths of pairs that were computed both ways
    /// Asked now and then with the part that begins; false stops the analysis (AnalysisResult::cancelled).
    std::function<bool(const char* part)> proceed;
};

struct TreeResult {
    LinkageMethod method;
    Dendrogram tree;
    LeafOrder leaf_order;
    double cophenetic_correlation;
};

struct ClusterResult {
    std::string method;                ///< "average linkage", "k-medoids"
    std::string cut;                   ///< how the number was chosen: "best silhouette", "4 clusters", "height 0.2"
    Clustering clusters;               ///< numbered 0, 1, ... along the leaf order
    std::vector<std::size_t> medoids;  ///< item with the smallest sum of distances in each cluster
    std::vector<double> silhouettes;   ///< [n]
    double mean_silhouette;
};

struct EmbeddingResult {
    std::string method;  ///< "SMACOF", "non-metric SMACOF", "classical MDS", "Isomap"
    Embedding embedding;
    double stress;                        ///< stress-1
    std::vector<double> stress_per_item;  ///< shares of the squared misfit
    std::vector<double> disparities;      ///< condensed; empty: the distances themselves
    std::size_t iterations = 0;
    bool converged = true;  ///< false: limit reached, the last digits may still change
    std::vector<SmacofRun> runs;
};

/// One ranking judged by the classes.
struct ClassResult {
    std::string ranking;                     ///< "distances", "diffused distances"
    std::vector<NeighbourAccuracy> nearest;  ///< k = 1, 3, 5, ... and k of the options
    ConfusionMatrix confusion;               ///< of 1-NN
    Retrieval retrieved;
    int bulls_eye_window = 0;  ///< 2 m if all classes have m members, else 0 (each class has its own)
};

struct PartTime {
    std::string part;
    double seconds;
};

/// Everything about one matrix. Items are those that were kept (see gaps.h): `labels`, `classes` and all item numbers
/// below refer to them, kept[i] is the number of item i in the given matrix.
struct AnalysisResult {
    AnalysisOptions options;
    bool cancelled = false;
    std::vector<std::string> labels, classes;  ///< classes empty if none are known
    std::vector<std::size_t> kept, left_out;
    DistanceMatrix distances;          ///< without gaps
    std::vector<std::string> remarks;  ///< sentences for the reader: gaps, limits by size, what could not be done

    std::vector<TreeResult> trees;           ///< the chosen linkage first, then the other three
    std::vector<ClusterResult> clusterings;  ///< the cut of the chosen tree, then k-medoids with as many clusters
    std::vector<Edge> spanning_tree, neighbour_graph;  ///< by known distances
    DistanceMatrix graph_distances;                    ///< path lengths in the neighbour graph (Isomap)
    double isomap_correlation = missing;               ///< Spearman, distances against graph_distances
    /// SMACOF in 2 and 3 dimensions, non-metric SMACOF, classical MDS, Isomap; turned to lie as the first of its
    /// dimension
    std::vector<EmbeddingResult> embeddings;

    TriangleReport triangles;          ///< of the given distances of the kept items, not of filled ones
    AsymmetryReport directions;        ///< of AnalysisInput::directed between kept items
    StabilityReport stability;         ///< of clusterings[0]
    std::vector<CloseClusters> close;  ///< of clusterings[0]

    std::vector<ClassResult> class_results;  ///< empty without classes; the second one if diffused
    std::vector<Medoid> class_medoids;
    Agreement agreement{missing, missing, missing, missing};  ///< of clusterings[0] with the classes
    std::optional<Permanova> permanova;
    std::optional<DistanceMatrix> diffused;  ///< if asked for

    std::vector<PartTime> seconds;  ///< wall clock by part
};

/// @throws std::invalid_argument with the first of options.problems(), or if an input has the wrong length
[[nodiscard]] AnalysisResult analyse(const DistanceMatrix& distances, const AnalysisOptions& options = {},
                                     const AnalysisInput& input = {});

/// clusters.csv: name,class,cluster,medoid,silhouette,stability,k_medoids,position
///   cluster and k_medoids count from 1; medoid: 1 for the item that stands for its cluster, else 0; stability empty if
///   not computed; position from 1 in the leaf order. One row per item, then the items left out with empty cells.
void write_clusters_csv(std::ostream& out, const AnalysisResult& result, const DistanceMatrix& given);
/// linkage.csv: cluster,first,second,height,size — SciPy's matrix of the chosen tree, cluster = its number n + row.
void write_linkage_csv(std::ostream& out, const AnalysisResult& result);
/// embedding.csv: name,method,dimensions,x,y,z,stress_share — one row per item and embedding, z empty in 2D.
void write_embedding_csv(std::ostream& out, const AnalysisResult& result);

}  // namespace morphodesic::analysis

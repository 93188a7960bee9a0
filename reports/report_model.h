#pragma once

#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace morphodesic::reports {

/// Plain data of a study: what report.json and report.html say. Knows no solver, no image library, no analysis types.
///
/// Conventions of all structs below:
///  - shapes are numbered 0 .. n-1 in the order of ReportModel::shapes; int fields called a, b, shape are such numbers;
///  - condensed arrays have n (n-1) / 2 entries, pair (i, j), i < j, at n i - i (i + 1) / 2 + j - i - 1 (SciPy's
///  order);
///  - NaN means "unknown" (null in JSON); an empty vector or string means "not part of this study";
///  - strings are data: any bytes are allowed, bytes that are not UTF-8 are shown as U+FFFD, nothing is read as markup.
inline constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// A picture as the bytes of a PNG file (JPEG and WebP are recognised as well).
struct Picture {
    std::string bytes;  ///< empty: no picture
    int width = 0;      ///< pixels
    int height = 0;     ///< pixels
    std::string alt;    ///< what is to be seen, in words, for readers who do not see it; empty: made from the names
};

struct ReportShape {
    std::string name;                ///< path relative to the collection's folder
    std::string label;               ///< class; empty if unknown
    double volume = unknown;         ///< area (volume) in units of the unit cube
    Picture thumbnail;               ///< up to about 96 x 96 pixels, transparent or white background
    std::vector<std::string> notes;  ///< what was done to the input, one sentence each
};

/// A shape or pair that could not be computed.
struct Failure {
    std::string a;       ///< file name of the (first) shape
    std::string b;       ///< second shape of a pair; empty: the shape itself failed
    std::string reason;  ///< what is wrong and what to do, one sentence
    /// Nothing is wrong with the shape, but no chain of trustworthy distances joins it to the others.
    bool cut_off = false;
};

/// One row of SciPy's linkage matrix: clusters first < second join at the height; the new cluster gets number n + row.
struct Merge {
    int first = 0;
    int second = 0;
    double height = 0.0;
    int size = 0;  ///< shapes in the new cluster
};

struct LinkageTree {
    std::string method;           ///< "average", "single", "complete", "ward"
    std::vector<Merge> merges;    ///< n - 1 rows
    std::vector<int> leaf_order;  ///< the n shapes from left to right (optimal leaf order)
    double cophenetic_correlation = unknown;
};

struct Clustering {
    std::string method;           ///< e.g. "average linkage", "k-medoids"
    std::string cut;              ///< how the number was chosen, e.g. "best silhouette", "4 clusters", "height 0.2"
    std::vector<int> assignment;  ///< [n] cluster 0 .. k-1 of every shape
    std::vector<int> medoids;     ///< [k] shape that stands for the cluster
    double silhouette = unknown;  ///< mean over all shapes
    double agreement = unknown;   ///< adjusted Rand index with ReportModel::clusterings[0]
};

struct Embedding {
    std::string method;                    ///< "SMACOF", "non-metric SMACOF", "classical MDS", "Isomap"
    int dimension = 2;                     ///< 2 or 3
    std::vector<double> coordinates;       ///< [n x dimension], shape by shape; NaN: shape without distances
    double stress = unknown;               ///< normalised stress-1 (Kruskal)
    std::vector<double> stress_per_shape;  ///< [n], shares of the stress
    std::vector<double> disparities;  ///< condensed, fitted distances of a non-metric embedding; empty: the distances
};

/// A further shape, placed in the maps by its distances; it is not part of the study.
struct PlacedQuery {
    std::string name;
    int nearest = -1;                            ///< nearest shape of the study; -1: none of its distances is known
    double distance = unknown;                   ///< to that shape
    std::vector<std::vector<double>> positions;  ///< [maps] of ReportModel::embeddings, empty where it has no place
    std::vector<double> stress;                  ///< [maps] misfit of its distances, as stress-1
};

struct Edge {
    int a = 0;
    int b = 0;
    double length = 0.0;
};

struct PrecisionRecall {
    double recall = 0.0;
    double precision = 0.0;
};

/// How well the distances know the classes.
struct ClassTable {
    std::string name = "distances";                 ///< which ranking: "distances", "diffused distances", ...
    double nearest_neighbour = unknown;             ///< 1-NN accuracy (leave one out), 0 .. 1
    std::vector<std::pair<int, double>> k_nearest;  ///< k, accuracy
    double bulls_eye = unknown;                     ///< 0 .. 1
    int bulls_eye_window = 0;                       ///< number of neighbours looked at (MPEG-7: twice the class size)
    double mean_average_precision = unknown;
    std::vector<PrecisionRecall> precision_recall;  ///< mean over all queries, by recall
    std::vector<std::string> classes;               ///< order of rows and columns of the confusion matrix
    std::vector<std::vector<int>> confusion;        ///< row: true class, column: class of the nearest neighbour
    std::vector<int> class_medoids;                 ///< shape that stands for each class
    double adjusted_rand = unknown;                 ///< of the clustering against the classes
    double adjusted_mutual_information = unknown;
    double permanova_f = unknown;
    double permanova_p = unknown;
    double permanova_r2 = unknown;
    int permutations = 0;
};

struct TriangleViolation {
    int a = 0, via = 0, b = 0;  ///< d(a, b) > d(a, via) + d(via, b)
    double excess = 0.0;        ///< by how much
    double error = unknown;     ///< sum of the three error bars
};

struct Asymmetry {
    int a = 0, b = 0;
    double forward = 0.0, backward = 0.0;  ///< path lengths of both directions
};

struct PairRemark {
    int a = 0, b = 0;
    std::string remark;  ///< e.g. "iteration limit reached"
};

struct ClusterStability {
    int cluster = 0;
    double jaccard = unknown;  ///< mean best Jaccard index over the perturbed runs, 0 .. 1
};

/// Two clusters that are nearer to each other than the error bars allow to say.
struct CloseClusters {
    int first = 0, second = 0;
    double gap = 0.0;        ///< separation of the two
    double error = unknown;  ///< its error bar
};

/// Reasons to believe the study, and not to.
struct Trust {
    long triangles_checked = 0;
    long triangles_violated = 0;                     ///< all
    long triangles_beyond_error = 0;                 ///< those that the error bars do not explain
    std::vector<TriangleViolation> worst_triangles;  ///< the worst, sorted, about 20
    double median_asymmetry = unknown;               ///< |forward - backward| / mean
    double max_asymmetry = unknown;
    std::vector<Asymmetry> asymmetries;       ///< pairs computed both ways, worst first
    std::vector<double> silhouettes;          ///< [n] of ReportModel::clusterings[0]
    std::vector<ClusterStability> stability;  ///< of ReportModel::clusterings[0]
    double stability_rand = unknown;          ///< mean adjusted Rand index of perturbed runs
    int perturbations = 0;
    unsigned long seed = 0;
    std::vector<PairRemark> not_converged;
    std::vector<CloseClusters> close_clusters;
    double graph_correlation = unknown;  ///< Spearman, distances against path lengths in the neighbour graph
    std::vector<std::string> remarks;    ///< further sentences for the reader
};

/// One shape of a path.
struct Frame {
    double time = 0.0;  ///< 0 .. 1
    Picture picture;    ///< the shape, coloured by the dissipation of the step that starts (last: ends) here
    double deformation_energy = unknown;  ///< E_deform,k of the step that ends here; unknown for the first frame
    double mismatch_energy = unknown;     ///< E_match,k without eta
};

/// Colours of the frames. Colours are "#rrggbb", low to high, equally spaced.
struct ColourBar {
    std::string quantity = "dissipation rate density";
    std::string unit;  ///< e.g. "1/time²"
    double low = 0.0;
    double high = 1.0;
    std::vector<std::string> colours;
};

struct PathReport {
    int a = 0, b = 0;           ///< shapes; time runs from a to b
    std::vector<Frame> frames;  ///< K + 1, or more with interpolated ones
    ColourBar colour_bar;
    double path_length = unknown;
    double error = unknown;
    double extrapolated_length = unknown;
    double path_energy = unknown;
    double total_energy = unknown;
    double min_det = unknown;  ///< certified lower bound of det D phi
    std::string termination;   ///< "converged", "max_steps", "no_descent", "cancelled"
    std::string message;
    int level = 0;
    int time_steps = 0;
    double seconds = unknown;
    std::string motion;  ///< alignment in words, e.g. "turned by 12.3 degrees, moved by (0.01, 0)"
};

struct Setting {
    std::string name, value, description;
};

/// A file beside the report.
struct Link {
    std::string href, title, description;  ///< href relative to the report
};

/// 3D (or 2D) studies: clustering by geodesic distance beside clustering by volume (area) alone.
struct VolumeComparison {
    LinkageTree tree;                   ///< linkage of |volume_i - volume_j|
    std::vector<int> assignment;        ///< [n] clusters by volume
    double rank_correlation = unknown;  ///< Spearman, distances against volume differences
    double adjusted_rand = unknown;     ///< clusters by distance against clusters by volume
};

struct MovedNeighbour {
    std::string shape;
    std::string here, there;   ///< nearest neighbour in this and in the other study
    double overlap = unknown;  ///< share of the k nearest neighbours that both have in common
};

/// This study beside another one.
struct Comparison {
    std::string other;  ///< name of the other study
    int common_shapes = 0;
    int common_pairs = 0;
    double spearman = unknown, kendall = unknown, pearson = unknown;
    int neighbours = 0;  ///< k of the overlaps
    double mean_overlap = unknown;
    std::vector<MovedNeighbour> moved;
    std::vector<std::pair<double, double>> distances;  ///< (here, there) of the common pairs, at most about 5000
    std::vector<Setting> different_settings;           ///< value: "here | there"
};

struct ReportModel {
    std::string study;    ///< name for the headline
    std::string created;  ///< ISO 8601, UTC
    int dimension = 2;
    bool given_matrix = false;  ///< only a table of distances is known: no shapes, no geodesics
    std::string collection;     ///< folder that was studied, as given
    std::string study_folder;   ///< where the study is kept, as given
    /// Options (words, not quoted) that give `morphodesic geodesic A B` the settings of this study, for paths that are
    /// not stored; the page adds the two files, collection + "/" + name, and --out.
    std::vector<std::string> geodesic_options;
    int shapes_found = 0;
    long pairs_total = 0;
    long pairs_done = 0;
    double seconds = unknown;      ///< wall clock of the whole study
    double cpu_seconds = unknown;  ///< sum over the pairs
    std::string preset;
    std::string distance_unit;  ///< of the path length, e.g. "length of the unit cube"
    std::vector<Failure> failures;
    std::vector<std::string> warnings;  ///< what makes the whole study doubtful; shown first

    bool pictures_at_one_scale = true;  ///< false: every thumbnail is filled by its shape
    std::vector<ReportShape> shapes;
    std::vector<double> distances;        ///< condensed; NaN: no trustworthy distance
    std::vector<double> errors;           ///< condensed error bars; may be empty
    std::vector<int> refined;             ///< condensed, 1 or 0: 0 marks an estimate from coarse grids; empty: all 1
    std::vector<LinkageTree> linkages;    ///< the first one is shown first
    std::vector<Clustering> clusterings;  ///< the first one gives the cluster colours
    std::vector<Embedding> embeddings;
    std::vector<PlacedQuery> placed;
    std::vector<Edge> spanning_tree;
    std::vector<Edge> neighbour_graph;
    int graph_neighbours = 0;                  ///< k of neighbour_graph
    std::vector<std::vector<int>> neighbours;  ///< [n] nearest first; empty: ranked by distance
    std::vector<ClassTable> classes;           ///< empty without labels
    Trust trust;
    std::vector<PathReport> paths;
    std::optional<VolumeComparison> volumes;
    double volume_spread = unknown;  ///< (largest - smallest) / largest volume (area) of the shapes
    std::optional<Comparison> compare;

    std::vector<Setting> settings;
    std::vector<Setting> versions;  ///< component, version, remark
    std::string command;            ///< the command that repeats the study
    std::vector<Link> links;
};

}  // namespace morphodesic::reports

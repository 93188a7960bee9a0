#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "analysis/distance_matrix.h"

namespace morphodesic::analysis {

/// How well distances agree with known classes. Rules that hold for every measure here:
/// - Class "" means unlabelled: such items are neither queries nor neighbours.
/// - The only member of a class is never a query (nothing right could be found), but stays among the neighbours.
/// - A missing distance counts as farther than every known one and has no vote.
/// - Equal distances: nothing depends on the order of the items. Retrieval counts the expected hits over all orders of
///   the equal ones; nearest-neighbour votes take in every item at the k-th distance.

struct ClassCount {
    std::string name;
    std::size_t members;
};
/// Classes in alphabetical order, without "".
[[nodiscard]] std::vector<ClassCount> class_counts(std::span<const std::string> classes);

/// The k nearest items of one row, nearest first; more than k if the k-th distance is shared, fewer if not known.
struct Neighbour {
    std::size_t item;
    double distance;
};
[[nodiscard]] std::vector<Neighbour> nearest_neighbours(const DistanceMatrix& distances, std::size_t item,
                                                        std::size_t k);

struct NeighbourPrediction {
    std::size_t item;
    std::string predicted;  ///< "" if no distance to a labelled item is known (counts as wrong)
};
struct NeighbourAccuracy {
    std::size_t k = 1;
    std::size_t queries = 0, right = 0;
    double accuracy = 0.0;  ///< right / queries, NaN without queries
    std::vector<NeighbourPrediction> predictions;
};
/// Leave-one-out classification by the majority of the k nearest labelled items; among classes with equally many votes
/// the one with the smaller mean distance, then the first in the alphabet.
/// @param classes class of each item, "" if unknown
[[nodiscard]] NeighbourAccuracy neighbour_accuracy(const DistanceMatrix& distances,
                                                   std::span<const std::string> classes, std::size_t k);

struct ConfusionMatrix {
    std::vector<std::string> classes;  ///< alphabetical; rows are true, columns predicted
    std::vector<std::size_t> counts;   ///< row-major [classes x (classes + 1)], last column: no prediction
    [[nodiscard]] std::size_t operator()(std::size_t truth, std::size_t predicted) const {
        return counts[truth * (classes.size() + 1) + predicted];
    }
};
[[nodiscard]] ConfusionMatrix confusion_matrix(std::span<const std::string> classes,
                                               std::span<const NeighbourPrediction> predictions);

struct Retrieval {
    std::size_t queries = 0;
    /// Share of a query's class (itself included) within its first 2 m items, m = size of the class; over all hits and
    /// all possible hits as in the MPEG-7 protocol. Unlabelled items take no place.
    double bulls_eye = 0.0;
    /// Entry r: queries whose (r + 1)-th nearest item is of their class (expected number if distances are equal), the
    /// table of Kimia's sets; `possible` counts the queries whose class has that many other members.
    std::vector<double> hits_at_rank;
    std::vector<std::size_t> possible_at_rank;
    /// Precision at recall 0, 0.1, ..., 1: interpolated (largest precision at this recall or more), mean over queries.
    std::array<double, 11> precision_at_recall{};
    double mean_average_precision = 0.0;
};
/// @param ranks_shown length of hits_at_rank
[[nodiscard]] Retrieval retrieval(const DistanceMatrix& distances, std::span<const std::string> classes,
                                  std::size_t ranks_shown = 10);

struct Medoid {
    std::string name;      ///< the class
    std::size_t item;      ///< member with the smallest mean known distance to the other members
    double mean_distance;  ///< that mean; 0 for a single member, NaN if no distance is known
};
/// Template of each class, classes in alphabetical order; of equally central members the first label.
[[nodiscard]] std::vector<Medoid> class_medoids(const DistanceMatrix& distances, std::span<const std::string> classes);

/// One-factor permutational analysis of variance (Anderson 2001): do classes differ more than chance allows?
struct Permanova {
    std::size_t items = 0, groups = 0, permutations = 0;
    double pseudo_f = 0.0;   ///< NaN if there are fewer than two groups or no degrees of freedom left
    double r_squared = 0.0;  ///< share of the sum of squared distances between groups
    double p_value = 1.0;    ///< (1 + permutations with F at least as large) / (1 + permutations)
};
/// Over labelled items. @throws std::invalid_argument if a distance among them is missing
[[nodiscard]] Permanova permanova(const DistanceMatrix& distances, std::span<const std::string> classes,
                                  std::size_t permutations, std::uint64_t seed);

}  // namespace morphodesic::analysis

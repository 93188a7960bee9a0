#include "pipeline/volume_comparison.h"

#include <algorithm>
#include <cmath>

#include "analysis/statistics.h"

namespace morphodesic::pipeline {
namespace {

std::vector<double> volumes_of(const StudyData& data, const analysis::AnalysisResult& analysed) {
    std::vector<double> volumes;
    for (const std::size_t i : analysed.kept) volumes.push_back(data.shapes[i].volume);
    return volumes;
}

}  // namespace

double volume_spread(const StudyData& data, const analysis::AnalysisResult& analysed) {
    const std::vector<double> volumes = volumes_of(data, analysed);
    if (volumes.empty()) return reports::unknown;
    const auto [low, high] = std::minmax_element(volumes.begin(), volumes.end());
    return std::isfinite(*high) && *low > 0.0 ? (*high - *low) / *high : reports::unknown;
}

std::optional<reports::VolumeComparison> compare_with_volumes(const StudyData& data,
                                                              const analysis::AnalysisResult& analysed) {
    const std::size_t n = analysed.kept.size();
    if (n < 3 || !(volume_spread(data, analysed) > equal_volumes)) return std::nullopt;
    const std::vector<double> volumes = volumes_of(data, analysed);
    analysis::DistanceMatrix differences(analysed.labels);
    std::vector<double> by_volume, by_distance;
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = i + 1; j < n; ++j) {
            const double difference = std::abs(volumes[i] - volumes[j]);
            differences.set(i, j, difference);
            by_volume.push_back(difference);
            by_distance.push_back(data.distances(analysed.kept[i], analysed.kept[j]));
        }
    }
    reports::VolumeComparison result;
    const analysis::Dendrogram tree = analysis::linkage(differences, analysis::LinkageMethod::average);
    result.tree.method = analysis::to_string(analysis::LinkageMethod::average);
    for (const analysis::Merge& m : tree.merges) {
        result.tree.merges.push_back(
            {static_cast<int>(m.first), static_cast<int>(m.second), m.height, static_cast<int>(m.size)});
    }
    // Of numbers on a line a few hundred are ordered optimally; beyond that the simple order of the tree will do.
    constexpr std::size_t ordered_well = 500;
    for (const std::size_t leaf : analysis::optimal_leaf_order(tree, differences, ordered_well).order) {
        result.tree.leaf_order.push_back(static_cast<int>(leaf));
    }
    result.tree.cophenetic_correlation = analysis::cophenetic_correlation(tree, differences);
    result.rank_correlation = analysis::spearman_correlation(by_distance, by_volume);
    if (!analysed.clusterings.empty()) {
        const analysis::Clustering& clusters = analysed.clusterings.front().clusters;
        const analysis::Clustering cut = analysis::cut_by_count(tree, analysis::cluster_count(clusters));
        result.assignment.assign(cut.begin(), cut.end());
        result.adjusted_rand = analysis::adjusted_rand(clusters, cut);
    } else {
        result.assignment.assign(n, 0);
    }
    return result;
}

}  // namespace morphodesic::pipeline

#include "analysis/gaps.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "analysis/kernels.h"
#include "analysis/parallel.h"
#include "analysis/special_numbers.h"

namespace morphodesic::analysis {
namespace {

std::vector<std::size_t> items_of_largest_group(const DistanceMatrix& distances) {
    const std::size_t n = distances.size();
    std::vector<std::size_t> group(n, n), open;
    std::vector<std::size_t> members;
    std::size_t best = 0;
    std::vector<std::string> first_label;
    for (std::size_t seed = 0; seed < n; ++seed) {
        if (group[seed] != n) continue;
        const std::size_t g = members.size();
        members.push_back(0);
        first_label.push_back(distances.labels()[seed]);
        group[seed] = g;
        open.push_back(seed);
        while (!open.empty()) {
            const std::size_t i = open.back();
            open.pop_back();
            ++members[g];
            first_label[g] = std::min(first_label[g], distances.labels()[i]);
            for (std::size_t j = 0; j < n; ++j) {
                if (group[j] == n && distances.known(i, j)) {
                    group[j] = g;
                    open.push_back(j);
                }
            }
        }
        if (members[g] > members[best] || (members[g] == members[best] && first_label[g] < first_label[best])) best = g;
    }
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < n; ++i) {
        if (group[i] == best) kept.push_back(i);
    }
    return kept;
}

}  // namespace

void shortest_paths(std::vector<double>& lengths, std::size_t n) {
    if (lengths.size() != n * n) throw std::invalid_argument("shortest paths: the table is not square");
    constexpr std::size_t block = 64;  // these rows stay in the second-level cache
    for (std::size_t begin = 0; begin < n; begin += block) {
        const std::size_t end = std::min(n, begin + block);
        const auto pass_through_block = [&](std::size_t i) {
            double* const row = &lengths[i * n];
            for (std::size_t k = begin; k < end; ++k) {
                if (k != i && row[k] < infinity) min_plus_update(n, row[k], &lengths[k * n], row);
            }
        };
        // First the rows of the block among themselves: afterwards they know every path inside the block.
        for (std::size_t k = begin; k < end; ++k) {
            for (std::size_t i = begin; i < end; ++i) {
                const double to_k = lengths[i * n + k];
                if (i != k && to_k < infinity) min_plus_update(n, to_k, &lengths[k * n], &lengths[i * n]);
            }
        }
        parallel_for_each_index(n, 8, [&](std::size_t i) {
            if (i < begin || i >= end) pass_through_block(i);
        });
    }
}

GapTreatment fill_gaps(const DistanceMatrix& distances) {
    GapTreatment result;
    if (distances.missing_count() == 0) {
        result.complete = distances;
        result.kept.resize(distances.size());
        std::iota(result.kept.begin(), result.kept.end(), std::size_t{0});
        return result;
    }
    result.kept = items_of_largest_group(distances);
    for (std::size_t i = 0, k = 0; i < distances.size(); ++i) {
        if (k < result.kept.size() && result.kept[k] == i) {
            ++k;
        } else {
            result.left_out.push_back(i);
        }
    }
    result.complete = distances.subset(result.kept);
    DistanceMatrix& d = result.complete;
    const std::size_t n = d.size();
    std::vector<std::pair<std::size_t, std::size_t>> gaps;
    if (d.missing_count() > 0) {
        std::vector<double> paths = d.dense();
        std::replace_if(
            paths.begin(), paths.end(), [](double x) { return std::isnan(x); }, infinity);
        const std::vector<double> edges = paths;
        shortest_paths(paths, n);
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = i + 1; j < n; ++j) {
                if (!d.known(i, j)) gaps.emplace_back(i, j);
            }
        }
        for (const auto& [i, j] : gaps) {
            // The two directions may differ in the last bit, by the order of summation.
            const double upper = std::min({paths[i * n + j], paths[j * n + i], largest_distance});
            double lower = 0.0;
            for (std::size_t k = 0; k < n; ++k) {
                const double a = edges[i * n + k], b = edges[j * n + k];
                if (a < infinity && b < infinity) lower = std::max(lower, std::abs(a - b));
            }
            d.set(i, j, upper, distances.has_errors() ? std::max(0.0, upper - lower) : missing);
            result.filled.emplace_back(result.kept[i], result.kept[j]);
        }
    }
    result.description = std::to_string(distances.missing_count()) + " of " + std::to_string(distances.pair_count()) +
                         " distances are missing: " + std::to_string(result.filled.size()) +
                         " were replaced by the shortest path through known distances (an upper bound)";
    if (!result.left_out.empty()) {
        result.description += ", " + std::to_string(result.left_out.size()) +
                              (result.left_out.size() == 1 ? " item is" : " items are") +
                              " left out because no known distances join them to the others";
    }
    return result;
}

}  // namespace morphodesic::analysis

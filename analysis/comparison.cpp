#include "analysis/comparison.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <unordered_map>
#include <utility>

#include "analysis/evaluation.h"
#include "analysis/statistics.h"

namespace morphodesic::analysis {
namespace {

/// Sorts and returns the number of inversions (exchanges of neighbours that a bubble sort would make).
double sort_counting(std::vector<double>& values) {
    std::vector<double> other(values.size());
    double inversions = 0.0;
    for (std::size_t width = 1; width < values.size(); width *= 2) {
        for (std::size_t begin = 0; begin < values.size(); begin += 2 * width) {
            const std::size_t middle = std::min(begin + width, values.size()),
                              end = std::min(begin + 2 * width, values.size());
            std::size_t a = begin, b = middle;
            for (std::size_t to = begin; to < end; ++to) {
                if (b == end || (a < middle && values[a] <= values[b])) {
                    other[to] = values[a++];
                } else {
                    other[to] = values[b++];
                    inversions += static_cast<double>(middle - a);
                }
            }
        }
        values.swap(other);
    }
    return inversions;
}

template <class Same>
double tied_pairs(std::size_t n, const Same& same) {
    double pairs = 0.0, run = 1.0;
    for (std::size_t i = 1; i <= n; ++i) {
        if (i < n && same(i - 1, i)) {
            run += 1.0;
        } else {
            pairs += 0.5 * run * (run - 1.0);
            run = 1.0;
        }
    }
    return pairs;
}

}  // namespace

double kendall_correlation(std::span<const double> x, std::span<const double> y) {
    if (x.size() != y.size()) throw std::invalid_argument("correlation of lists of different length");
    std::vector<std::pair<double, double>> both;
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (!std::isnan(x[i]) && !std::isnan(y[i])) both.emplace_back(x[i], y[i]);
    }
    std::sort(both.begin(), both.end());
    const std::size_t n = both.size();
    const double all = 0.5 * static_cast<double>(n) * (static_cast<double>(n) - 1.0);
    const double same_x = tied_pairs(n, [&](std::size_t a, std::size_t b) { return both[a].first == both[b].first; });
    const double same_both = tied_pairs(n, [&](std::size_t a, std::size_t b) { return both[a] == both[b]; });
    std::vector<double> second;
    for (const auto& p : both) second.push_back(p.second);
    const double discordant = sort_counting(second);
    const double same_y = tied_pairs(n, [&](std::size_t a, std::size_t b) { return second[a] == second[b]; });
    if (n < 2 || same_x == all || same_y == all) return missing;
    return (all - same_x - same_y + same_both - 2.0 * discordant) / std::sqrt(all - same_x) / std::sqrt(all - same_y);
}

MatrixComparison compare(const DistanceMatrix& here, const DistanceMatrix& there, std::size_t neighbours) {
    if (neighbours == 0) throw std::invalid_argument("comparison needs at least one neighbour");
    std::unordered_map<std::string, std::size_t> number;
    for (std::size_t i = 0; i < there.size(); ++i) number.emplace(there.labels()[i], i);
    MatrixComparison result;
    std::vector<std::size_t> from_here, from_there;
    for (std::size_t i = 0; i < here.size(); ++i) {
        const auto found = number.find(here.labels()[i]);
        if (found == number.end()) continue;
        result.labels.push_back(here.labels()[i]);
        from_here.push_back(i);
        from_there.push_back(found->second);
    }
    const DistanceMatrix a = here.subset(from_here), b = there.subset(from_there);
    const std::size_t n = a.size();
    std::vector<double> x(a.condensed().begin(), a.condensed().end()), y(b.condensed().begin(), b.condensed().end());
    for (std::size_t k = 0; k < x.size(); ++k) {
        if (std::isnan(x[k]) || std::isnan(y[k])) {
            x[k] = y[k] = missing;
            continue;
        }
        ++result.pairs;
    }
    result.pearson = pearson_correlation(x, y);
    result.kendall = kendall_correlation(x, y);
    result.spearman = spearman_correlation(x, y);
    result.neighbours = neighbours;
    double sum = 0.0, counted = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        const std::vector<Neighbour> near_a = nearest_neighbours(a, i, neighbours),
                                     near_b = nearest_neighbours(b, i, neighbours);
        if (near_a.empty() && near_b.empty()) continue;
        std::set<std::size_t> in_a;
        for (const Neighbour& m : near_a) in_a.insert(m.item);
        const auto shared = static_cast<double>(
            std::count_if(near_b.begin(), near_b.end(), [&](const Neighbour& m) { return in_a.contains(m.item); }));
        const double wanted = static_cast<double>(std::min({neighbours, std::max(near_a.size(), near_b.size())}));
        const double overlap = std::min(1.0, shared / wanted);
        sum += overlap;
        counted += 1.0;
        if (overlap == 1.0) continue;
        result.moved.push_back({i, overlap, near_a.empty() ? "" : result.labels[near_a.front().item],
                                near_b.empty() ? "" : result.labels[near_b.front().item]});
    }
    result.mean_overlap = counted > 0.0 ? sum / counted : missing;
    std::stable_sort(result.moved.begin(), result.moved.end(),
                     [](const MovedNeighbours& p, const MovedNeighbours& q) { return p.overlap < q.overlap; });
    return result;
}

}  // namespace morphodesic::analysis

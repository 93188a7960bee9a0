#include "analysis/comparison.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <unordered_map>
#include <utility>

#include "analysis/evaluation.h"
#include "analysis/parallel.h"
#include "analysis/random.h"
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

MatrixComparison compare(const DistanceMatrix& here, const DistanceMatrix& there, std::size_t neighbours,
                         std::size_t permutations, std::uint64_t seed) {
    if (neighbours == 0) throw std::invalid_argument("comparison needs at least one neighbour");
    std::unordered_map<std::string, std::size_t> number;
    for (std::size_t i = 0; i < there.size(); ++i) number.emplace(there.labels()[i], i);
    MatrixComparison result;
    std::vector<std::size_t> from_here, from_there;
    for (std::size_t i = 0; i < here.size(); ++i) {
        const auto found = number.find(here.labels()[i]);
        if (found == number.end()) {
            result.only_here.push_back(here.labels()[i]);
        } else {
            result.labels.push_back(here.labels()[i]);
            from_here.push_back(i);
            from_there.push_back(found->second);
            number.erase(found);
        }
    }
    for (const std::string& label : there.labels()) {
        if (number.contains(label)) result.only_there.push_back(label);
    }
    const DistanceMatrix a = here.subset(from_here), b = there.subset(from_there);
    const std::size_t n = a.size();
    std::vector<double> x(a.condensed().begin(), a.condensed().end()), y(b.condensed().begin(), b.condensed().end());
    double xx = 0.0, xy = 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) {
        if (std::isnan(x[k]) || std::isnan(y[k])) {
            x[k] = y[k] = missing;
            continue;
        }
        ++result.pairs;
        xx += x[k] * x[k];
        xy += x[k] * y[k];
    }
    result.scale = xx > 0.0 ? xy / xx : missing;
    result.pearson = pearson_correlation(x, y);
    result.kendall = kendall_correlation(x, y);
    const std::vector<double> rank_x = ranks(x), rank_y = ranks(y);
    result.spearman = pearson_correlation(rank_x, rank_y);
    result.permutations = permutations;
    if (std::isnan(result.spearman)) {
        result.mantel_p = missing;
    } else {
        // Ranks as centred square tables, 0 where one side is missing: a permutation moves rows and columns of one of
        // them.
        const auto table = [&](const std::vector<double>& rank) {
            const double centre = 0.5 * (static_cast<double>(result.pairs) + 1.0);
            std::vector<double> square(n * n, 0.0);
            for (std::size_t i = 0, k = 0; i < n; ++i) {
                for (std::size_t j = i + 1; j < n; ++j, ++k) {
                    square[i * n + j] = square[j * n + i] = std::isnan(rank[k]) ? 0.0 : rank[k] - centre;
                }
            }
            return square;
        };
        const std::vector<double> u = table(rank_x), v = table(rank_y);
        const auto product = [&](const std::vector<std::size_t>& order) {
            double sum = 0.0;
            for (std::size_t i = 0; i < n; ++i) {
                const double* const row = &v[order[i] * n];
                double part = 0.0;
                for (std::size_t j = i + 1; j < n; ++j) part += u[i * n + j] * row[order[j]];
                sum += part;
            }
            return sum;
        };
        std::vector<std::size_t> identity(n);
        for (std::size_t i = 0; i < n; ++i) identity[i] = i;
        const double own = product(identity), slack = 1e-12 * std::abs(own);
        std::vector<unsigned char> as_large(permutations, 0);
        parallel_for_each_index(permutations, 1, [&](std::size_t p) {
            std::vector<std::size_t> order = identity;
            Random random(seed, p);
            random.shuffle(order);
            as_large[p] = product(order) >= own - slack ? 1 : 0;
        });
        const auto count = std::count(as_large.begin(), as_large.end(), 1);
        result.mantel_p = static_cast<double>(1 + count) / static_cast<double>(1 + permutations);
    }
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

#include "analysis/evaluation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "analysis/parallel.h"
#include "analysis/random.h"
#include "analysis/statistics.h"

namespace morphodesic::analysis {
namespace {

void check_classes(const DistanceMatrix& distances, std::span<const std::string> classes) {
    if (classes.size() != distances.size())
        throw std::invalid_argument("one class per item is needed, \"\" if unknown");
}

/// Class numbers (alphabetical), -1 for unlabelled.
std::vector<int> class_numbers(std::span<const std::string> classes, const std::vector<ClassCount>& counts) {
    std::map<std::string_view, int> number;
    for (const ClassCount& c : counts) number.emplace(c.name, static_cast<int>(number.size()));
    std::vector<int> result;
    for (const std::string& name : classes) result.push_back(name.empty() ? -1 : number.at(name));
    return result;
}

using Ranking = std::vector<std::pair<double, int>>;

/// Labelled items other than `query` as (distance, class), missing ones as infinity, in no order.
Ranking candidates(const DistanceMatrix& distances, const std::vector<int>& number, std::size_t query) {
    Ranking others;
    others.reserve(number.size());
    for (std::size_t j = 0; j < number.size(); ++j) {
        if (j == query || number[j] < 0) continue;
        const double d = distances(query, j);
        others.emplace_back(std::isnan(d) ? std::numeric_limits<double>::infinity() : d, number[j]);
    }
    return others;
}

/// Rankings of many queries, nearest first, sorted on all threads.
std::vector<Ranking> rankings(const DistanceMatrix& distances, const std::vector<int>& number,
                              std::span<const std::size_t> queries) {
    std::vector<Ranking> result(queries.size());
    parallel_for_each_index(queries.size(), 4, [&](std::size_t q) {
        result[q] = candidates(distances, number, queries[q]);
        std::sort(result[q].begin(), result[q].end());
    });
    return result;
}

}  // namespace

std::vector<ClassCount> class_counts(std::span<const std::string> classes) {
    std::map<std::string, std::size_t> count;
    for (const std::string& name : classes) {
        if (!name.empty()) ++count[name];
    }
    std::vector<ClassCount> result;
    for (const auto& [name, members] : count) result.push_back({name, members});
    return result;
}

std::vector<Neighbour> nearest_neighbours(const DistanceMatrix& distances, std::size_t item, std::size_t k) {
    std::vector<Neighbour> all;
    for (std::size_t j = 0; j < distances.size(); ++j) {
        if (j != item && distances.known(item, j)) all.push_back({j, distances(item, j)});
    }
    const auto nearer = [](const Neighbour& a, const Neighbour& b) {
        return a.distance != b.distance ? a.distance < b.distance : a.item < b.item;
    };
    if (k == 0) return {};
    if (k < all.size()) {
        std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(k - 1), all.end(), nearer);
        const double last = all[k - 1].distance;
        std::erase_if(all, [&](const Neighbour& a) { return a.distance > last; });
    }
    std::sort(all.begin(), all.end(), nearer);
    return all;
}

NeighbourAccuracy neighbour_accuracy(const DistanceMatrix& distances, std::span<const std::string> classes,
                                     std::size_t k) {
    check_classes(distances, classes);
    if (k == 0) throw std::invalid_argument("k nearest neighbours: k must be at least 1");
    const std::vector<ClassCount> counts = class_counts(classes);
    const std::vector<int> number = class_numbers(classes, counts);
    NeighbourAccuracy result;
    result.k = k;
    std::vector<std::size_t> votes(counts.size());
    std::vector<double> sums(counts.size());
    for (std::size_t i = 0; i < classes.size(); ++i) {
        if (number[i] < 0 || counts[static_cast<std::size_t>(number[i])].members < 2) continue;
        std::fill(votes.begin(), votes.end(), 0);
        std::fill(sums.begin(), sums.end(), 0.0);
        Ranking others = candidates(distances, number, i);
        if (k < others.size()) {
            std::nth_element(others.begin(), others.begin() + static_cast<std::ptrdiff_t>(k - 1), others.end());
            const double last = others[k - 1].first;
            std::erase_if(others, [&](const std::pair<double, int>& o) { return o.first > last; });
        }
        std::sort(others.begin(), others.end());
        for (std::size_t r = 0; r < others.size() && std::isfinite(others[r].first); ++r) {
            ++votes[static_cast<std::size_t>(others[r].second)];
            sums[static_cast<std::size_t>(others[r].second)] += others[r].first;
        }
        std::size_t best = 0;
        for (std::size_t c = 1; c < votes.size(); ++c) {
            // equal votes: equal denominators, so sums compare the means
            if (votes[c] > votes[best] || (votes[c] == votes[best] && sums[c] < sums[best])) best = c;
        }
        const bool any = votes[best] > 0;
        result.predictions.push_back({i, any ? counts[best].name : std::string()});
        ++result.queries;
        if (any && static_cast<int>(best) == number[i]) ++result.right;
    }
    result.accuracy =
        result.queries == 0 ? missing : static_cast<double>(result.right) / static_cast<double>(result.queries);
    return result;
}

ConfusionMatrix confusion_matrix(std::span<const std::string> classes,
                                 std::span<const NeighbourPrediction> predictions) {
    ConfusionMatrix result;
    std::map<std::string, std::size_t> number;
    for (const ClassCount& c : class_counts(classes)) {
        number.emplace(c.name, result.classes.size());
        result.classes.push_back(c.name);
    }
    const std::size_t columns = result.classes.size() + 1;
    result.counts.assign(result.classes.size() * columns, 0);
    for (const NeighbourPrediction& p : predictions) {
        const std::size_t predicted = p.predicted.empty() ? columns - 1 : number.at(p.predicted);
        ++result.counts[number.at(classes[p.item]) * columns + predicted];
    }
    return result;
}

Retrieval retrieval(const DistanceMatrix& distances, std::span<const std::string> classes, std::size_t ranks_shown) {
    check_classes(distances, classes);
    const std::vector<ClassCount> counts = class_counts(classes);
    const std::vector<int> number = class_numbers(classes, counts);
    Retrieval result;
    result.hits_at_rank.assign(ranks_shown, 0.0);
    result.possible_at_rank.assign(ranks_shown, 0);
    double hits = 0.0, possible = 0.0;
    std::vector<std::size_t> queries;
    for (std::size_t i = 0; i < classes.size(); ++i) {
        if (number[i] >= 0 && counts[static_cast<std::size_t>(number[i])].members >= 2) queries.push_back(i);
    }
    result.queries = queries.size();
    constexpr std::size_t block = 256;  // rankings in memory at a time
    std::vector<Ranking> ranked;
    for (std::size_t q = 0; q < queries.size(); ++q) {
        if (q % block == 0) {
            ranked = rankings(distances, number, std::span(queries).subspan(q, std::min(block, queries.size() - q)));
        }
        const std::size_t i = queries[q], members = counts[static_cast<std::size_t>(number[i])].members;
        const Ranking& others = ranked[q % block];
        const auto relevant = static_cast<double>(members - 1);
        const std::size_t window = 2 * members - 1;  // the query itself is the first of the 2 m
        double found = 0.0, average_precision = 0.0;
        std::vector<std::pair<double, double>> curve;  // recall, precision after each group of equal distances
        for (std::size_t begin = 0; begin < others.size();) {
            std::size_t end = begin, same = 0;
            for (; end < others.size() && others[end].first == others[begin].first; ++end) {
                if (others[end].second == number[i]) ++same;
            }
            const double share = static_cast<double>(same) / static_cast<double>(end - begin);
            for (std::size_t r = begin; r < std::min(end, ranks_shown); ++r) {
                if (std::isfinite(others[begin].first)) result.hits_at_rank[r] += share;
            }
            if (std::isfinite(others[begin].first) && begin < window) {
                hits += share * static_cast<double>(std::min(end, window) - begin);
            }
            found += static_cast<double>(same);
            if (same > 0) {
                const double precision = found / static_cast<double>(end);
                average_precision += static_cast<double>(same) / relevant * precision;
                curve.emplace_back(found / relevant, precision);
            }
            begin = end;
        }
        hits += 1.0;
        possible += static_cast<double>(members);
        for (std::size_t r = 0; r < std::min(ranks_shown, members - 1); ++r) ++result.possible_at_rank[r];
        result.mean_average_precision += average_precision;
        for (std::size_t level = 0; level < 11; ++level) {
            double best = 0.0;
            for (const auto& [recall, precision] : curve) {
                if (recall >= 0.1 * static_cast<double>(level) - 1e-12) best = std::max(best, precision);
            }
            result.precision_at_recall[level] += best;
        }
    }
    const auto count = static_cast<double>(result.queries);
    result.bulls_eye = result.queries == 0 ? missing : hits / possible;
    result.mean_average_precision = result.queries == 0 ? missing : result.mean_average_precision / count;
    for (double& p : result.precision_at_recall) p = result.queries == 0 ? missing : p / count;
    return result;
}

std::vector<Medoid> class_medoids(const DistanceMatrix& distances, std::span<const std::string> classes) {
    check_classes(distances, classes);
    std::vector<Medoid> result;
    for (const ClassCount& c : class_counts(classes)) {
        Medoid best{c.name, distances.size(), missing};
        for (std::size_t i = 0; i < classes.size(); ++i) {
            if (classes[i] != c.name) continue;
            std::vector<double> known;
            for (std::size_t j = 0; j < classes.size(); ++j) {
                if (j != i && classes[j] == c.name && distances.known(i, j)) known.push_back(distances(i, j));
            }
            std::sort(known.begin(), known.end());  // a sum that does not depend on the order of the items
            const double average = c.members == 1 ? 0.0 : mean(known);
            const bool first = best.item == distances.size();
            const bool nearer =
                average < best.mean_distance || (std::isnan(best.mean_distance) && !std::isnan(average));
            const bool tied = average == best.mean_distance || (std::isnan(average) && std::isnan(best.mean_distance));
            if (first || nearer || (tied && distances.labels()[i] < distances.labels()[best.item])) {
                best = {c.name, i, average};
            }
        }
        result.push_back(best);
    }
    return result;
}

Permanova permanova(const DistanceMatrix& distances, std::span<const std::string> classes, std::size_t permutations,
                    std::uint64_t seed) {
    check_classes(distances, classes);
    const std::vector<ClassCount> counts = class_counts(classes);
    const std::vector<int> number = class_numbers(classes, counts);
    // Labelled items sorted by class: a permutation of this list is a permutation of the labels.
    std::vector<std::size_t> items;
    for (int c = 0; c < static_cast<int>(counts.size()); ++c) {
        for (std::size_t i = 0; i < classes.size(); ++i) {
            if (number[i] == c) items.push_back(i);
        }
    }
    const std::size_t n = items.size(), groups = counts.size();
    Permanova result;
    result.items = n;
    result.groups = groups;
    result.permutations = permutations;
    result.pseudo_f = result.r_squared = result.p_value = missing;
    std::vector<double> square(n * n, 0.0);
    double total = 0.0;
    for (std::size_t a = 0; a < n; ++a) {
        for (std::size_t b = a + 1; b < n; ++b) {
            const double d = distances(items[a], items[b]);
            if (std::isnan(d)) throw std::invalid_argument("PERMANOVA needs all distances; fill the gaps first");
            square[a * n + b] = square[b * n + a] = d * d;
            total += d * d;
        }
    }
    if (groups < 2 || n <= groups || total == 0.0) return result;
    total /= static_cast<double>(n);
    const auto within = [&](const std::vector<std::size_t>& order) {
        double sum = 0.0;
        std::size_t begin = 0;
        for (const ClassCount& c : counts) {
            double group = 0.0;
            for (std::size_t a = begin; a < begin + c.members; ++a) {
                const double* const row = &square[order[a] * n];
                for (std::size_t b = a + 1; b < begin + c.members; ++b) group += row[order[b]];
            }
            sum += group / static_cast<double>(c.members);
            begin += c.members;
        }
        return sum;
    };
    std::vector<std::size_t> identity(n);
    for (std::size_t a = 0; a < n; ++a) identity[a] = a;
    const double own = within(identity);
    const double between_freedom = static_cast<double>(groups - 1), within_freedom = static_cast<double>(n - groups);
    result.r_squared = 1.0 - own / total;
    result.pseudo_f =
        own > 0.0 ? (total - own) / between_freedom / (own / within_freedom) : std::numeric_limits<double>::infinity();
    // F grows as the sum within groups falls: comparing that sum compares F. Equal up to rounding counts as equal.
    std::vector<unsigned char> as_large(permutations, 0);
    parallel_for_each_index(permutations, 1, [&](std::size_t p) {
        std::vector<std::size_t> order = identity;
        Random random(seed, p);
        random.shuffle(order);
        as_large[p] = within(order) <= own + 1e-12 * total ? 1 : 0;
    });
    const auto count = std::count(as_large.begin(), as_large.end(), 1);
    if (permutations > 0) result.p_value = static_cast<double>(1 + count) / static_cast<double>(1 + permutations);
    return result;
}

}  // namespace morphodesic::analysis

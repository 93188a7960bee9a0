#include "analysis/diagnostics.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "analysis/agreement.h"
#include "analysis/kernels.h"
#include "analysis/parallel.h"
#include "analysis/random.h"
#include "analysis/special_numbers.h"
#include "analysis/statistics.h"

namespace morphodesic::analysis {
namespace {

double bar(const DistanceMatrix& d, std::size_t i, std::size_t j) {
    const double e = d.error(i, j);
    return std::isnan(e) ? 0.0 : e;
}

struct LongSide {
    std::size_t i, j;
    double excess;
};

bool worse(const LongSide& a, const LongSide& b) {
    return a.excess != b.excess ? a.excess > b.excess : std::pair(a.i, a.j) < std::pair(b.i, b.j);
}

}  // namespace

TriangleReport triangle_violations(const DistanceMatrix& distances, std::size_t worst_shown) {
    const std::size_t n = distances.size();
    TriangleReport result;
    // Missing distances are infinitely long detours and never long sides. The entries k = i and k = j of a row pair sum
    // up to the long side itself and are not below it.
    std::vector<double> plain = distances.dense(), upper;
    std::replace_if(
        plain.begin(), plain.end(), [](double d) { return std::isnan(d); }, infinity);
    if (distances.has_errors()) {
        upper = plain;
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = 0; j < n; ++j) upper[i * n + j] += bar(distances, i, j);
        }
    }
    constexpr double rounding = 1.0 - 1e-12;
    constexpr std::size_t tile = 32;
    const std::size_t tiles = (n + tile - 1) / tile;
    struct Row {
        std::size_t violated = 0, beyond = 0, detours = 0;
        std::vector<LongSide> worst;
    };
    std::vector<Row> rows(n);
    parallel_for_each_index(tiles, 1, [&](std::size_t t) {
        const std::size_t begin = t * tile, end = std::min(n, begin + tile);
        for (std::size_t j = begin + 1; j < n; ++j) {  // row j is used by all rows of the tile while it is in the cache
            for (std::size_t i = begin; i < std::min(end, j); ++i) {
                const double side = plain[i * n + j];
                if (side == infinity) continue;
                const SumsBelow below = sums_below(n, &plain[i * n], &plain[j * n], side * rounding);
                if (below.count == 0) continue;
                rows[i].violated += below.count;
                const double excess = side - below.smallest;
                if (rows[i].worst.size() < worst_shown || (worst_shown > 0 && excess > rows[i].worst.back().excess)) {
                    rows[i].worst.push_back({i, j, excess});
                    std::sort(rows[i].worst.begin(), rows[i].worst.end(), worse);
                    if (rows[i].worst.size() > worst_shown) rows[i].worst.pop_back();
                }
                if (upper.empty()) continue;
                const double limit = side * rounding - bar(distances, i, j);
                rows[i].beyond += sums_below(n, &upper[i * n], &upper[j * n], limit).count;
            }
        }
    });
    std::vector<LongSide> worst;
    for (const Row& row : rows) {
        result.violated += row.violated;
        result.beyond_error += upper.empty() ? row.violated : row.beyond;
        worst.insert(worst.end(), row.worst.begin(), row.worst.end());
    }
    std::sort(worst.begin(), worst.end(), worse);
    if (worst.size() > worst_shown) worst.resize(worst_shown);
    for (const LongSide& side : worst) {
        std::size_t via = n;
        double shortest = infinity;
        for (std::size_t k = 0; k < n; ++k) {
            if (k == side.i || k == side.j) continue;
            if (const double sum = plain[side.i * n + k] + plain[side.j * n + k]; sum < shortest) {
                shortest = sum;
                via = k;
            }
        }
        result.worst.push_back(
            {side.i, via, side.j, side.excess,
             distances.error(side.i, side.j) + distances.error(side.i, via) + distances.error(via, side.j)});
    }
    if (distances.missing_count() == 0) {
        result.triangles = n < 3 ? 0 : n * (n - 1) * (n - 2) / 6;
        return result;
    }
    std::vector<std::size_t> complete(n, 0);  // triangles with i as first corner
    parallel_for_each_index(n, 4, [&](std::size_t i) {
        for (std::size_t j = i + 1; j < n; ++j) {
            if (plain[i * n + j] == infinity) continue;
            complete[i] += sums_below(n - j - 1, &plain[i * n + j + 1], &plain[j * n + j + 1], infinity).count;
        }
    });
    for (const std::size_t c : complete) result.triangles += c;
    return result;
}

double DirectedPair::relative_difference() const {
    const double sum = forward + backward;
    return sum > 0.0 ? std::abs(forward - backward) / (0.5 * sum) : 0.0;
}

AsymmetryReport asymmetry(std::span<const DirectedPair> pairs, std::size_t worst_shown) {
    AsymmetryReport result;
    std::vector<double> differences;
    for (const DirectedPair& p : pairs) {
        if (std::isnan(p.forward) || std::isnan(p.backward)) continue;
        differences.push_back(p.relative_difference());
        if (p.forward != p.backward) result.worst.push_back(p);
    }
    result.pairs = differences.size();
    result.median = quantile(differences, 0.5);
    result.largest = quantile(differences, 1.0);
    std::stable_sort(result.worst.begin(), result.worst.end(), [](const DirectedPair& a, const DirectedPair& b) {
        return a.relative_difference() > b.relative_difference();
    });
    if (result.worst.size() > worst_shown) result.worst.resize(worst_shown);
    return result;
}

std::vector<CloseClusters> close_clusters(const DistanceMatrix& distances, const Clustering& clusters) {
    if (clusters.size() != distances.size()) throw std::invalid_argument("the clustering belongs to another matrix");
    std::vector<CloseClusters> result;
    if (!distances.has_errors()) return result;
    const std::size_t count = cluster_count(clusters);
    struct Sums {
        double distance = 0.0, pairs = 0.0, error = 0.0, bars = 0.0;
    };
    std::vector<Sums> sums(count * count);
    for (std::size_t i = 0; i < distances.size(); ++i) {
        for (std::size_t j = i + 1; j < distances.size(); ++j) {
            const double d = distances(i, j), e = distances.error(i, j);
            if (std::isnan(d)) continue;
            Sums& s = sums[std::min(clusters[i], clusters[j]) * count + std::max(clusters[i], clusters[j])];
            s.distance += d;
            s.pairs += 1.0;
            if (std::isnan(e)) continue;
            s.error += e;
            s.bars += 1.0;
        }
    }
    const auto inner = [&](std::size_t c) {
        const Sums& s = sums[c * count + c];
        return s.pairs > 0.0 ? s.distance / s.pairs : 0.0;
    };
    for (std::size_t a = 0; a < count; ++a) {
        for (std::size_t b = a + 1; b < count; ++b) {
            const Sums& s = sums[a * count + b];
            const Sums &in_a = sums[a * count + a], &in_b = sums[b * count + b];
            const double bars = s.bars + in_a.bars + in_b.bars;
            if (s.pairs == 0.0 || bars == 0.0) continue;
            const double separation = s.distance / s.pairs - 0.5 * (inner(a) + inner(b));
            const double error = (s.error + in_a.error + in_b.error) / bars;
            if (separation <= error) result.push_back({a, b, separation, error});
        }
    }
    std::stable_sort(result.begin(), result.end(), [](const CloseClusters& a, const CloseClusters& b) {
        return a.separation - a.error < b.separation - b.error;
    });
    return result;
}

StabilityReport cluster_stability(const DistanceMatrix& distances, const Clustering& clusters, LinkageMethod method,
                                  std::size_t runs, std::uint64_t seed) {
    if (clusters.size() != distances.size()) throw std::invalid_argument("the clustering belongs to another matrix");
    const std::size_t n = distances.size(), count = cluster_count(clusters);
    StabilityReport result;
    result.mean_rand = missing;
    if (!distances.has_errors() || n < 2 || runs == 0) return result;
    std::vector<Clustering> redone(runs);
    parallel_for_each_index(runs, 1, [&](std::size_t r) {
        std::vector<double> moved(distances.condensed().begin(), distances.condensed().end());
        const std::uint64_t stream = mix(mix(seed) + r);
        for (std::size_t k = 0; k < moved.size(); ++k) {
            const double e = distances.condensed_errors()[k];
            if (std::isnan(e)) continue;
            moved[k] = std::max(0.0, moved[k] + e * (2.0 * unit_interval(mix(stream + k)) - 1.0));
        }
        redone[r] = cut_by_count(linkage(moved, n, method), count);
    });
    result.runs = runs;
    std::vector<double> members(count, 0.0), jaccard(count, 0.0), item(n, 0.0);
    for (const std::size_t c : clusters) members[c] += 1.0;
    double sum = 0.0;
    for (const Clustering& run : redone) {
        sum += adjusted_rand(clusters, run);
        std::vector<double> shared(count * count, 0.0), sizes(count, 0.0);
        for (std::size_t i = 0; i < n; ++i) {
            shared[clusters[i] * count + run[i]] += 1.0;
            sizes[run[i]] += 1.0;
        }
        for (std::size_t c = 0; c < count; ++c) {
            double best = 0.0;
            for (std::size_t other = 0; other < count; ++other) {
                const double s = shared[c * count + other];
                best = std::max(best, s / (members[c] + sizes[other] - s));
            }
            jaccard[c] += best;
        }
        for (std::size_t i = 0; i < n; ++i) {
            const double others = members[clusters[i]] - 1.0;
            item[i] += others > 0.0 ? (shared[clusters[i] * count + run[i]] - 1.0) / others
                                    : (sizes[run[i]] == 1.0 ? 1.0 : 0.0);
        }
    }
    const auto times = static_cast<double>(runs);
    result.mean_rand = sum / times;
    for (std::size_t c = 0; c < count; ++c) {
        result.clusters.push_back({c, static_cast<std::size_t>(members[c]), jaccard[c] / times});
    }
    for (double& s : item) s /= times;
    result.item_stability = std::move(item);
    return result;
}

}  // namespace morphodesic::analysis

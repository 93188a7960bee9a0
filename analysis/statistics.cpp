#include "analysis/statistics.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "analysis/parallel.h"

namespace morphodesic::analysis {

double mean(std::span<const double> values) {
    if (values.empty()) return missing;
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double quantile(std::vector<double> values, double q) {
    if (values.empty()) return missing;
    std::sort(values.begin(), values.end());
    const double position = std::clamp(q, 0.0, 1.0) * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(position);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    return values[below] + (position - static_cast<double>(below)) * (values[above] - values[below]);
}

double pearson_correlation(std::span<const double> x, std::span<const double> y) {
    if (x.size() != y.size()) throw std::invalid_argument("correlation of lists of different length");
    double mean_x = 0.0, mean_y = 0.0, count = 0.0;
    const auto both = [&](std::size_t i) { return !std::isnan(x[i]) && !std::isnan(y[i]); };
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (!both(i)) continue;
        mean_x += x[i];
        mean_y += y[i];
        count += 1.0;
    }
    mean_x /= count;
    mean_y /= count;
    double xx = 0.0, yy = 0.0, xy = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (!both(i)) continue;
        const double a = x[i] - mean_x, b = y[i] - mean_y;
        xx += a * a;
        yy += b * b;
        xy += a * b;
    }
    // Rounding leaves a constant list with a variance of a few ulps squared.
    const double noise = 1e-28 * count;
    if (!(xx > noise * mean_x * mean_x) || !(yy > noise * mean_y * mean_y)) return missing;
    return std::clamp(xy / std::sqrt(xx) / std::sqrt(yy), -1.0, 1.0);
}

std::vector<double> ranks(std::span<const double> values) {
    std::vector<std::pair<double, std::size_t>> order;  // value beside number: the sort stays in the cache
    order.reserve(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!std::isnan(values[i])) order.emplace_back(values[i], i);
    }
    tbb::parallel_sort(order.begin(), order.end());  // no two alike: one order, whatever the threads
    std::vector<double> result(values.size(), missing);
    for (std::size_t begin = 0; begin < order.size();) {
        std::size_t end = begin;
        while (end < order.size() && order[end].first == order[begin].first) ++end;
        const double rank = 0.5 * static_cast<double>(begin + 1 + end);
        for (; begin < end; ++begin) result[order[begin].second] = rank;
    }
    return result;
}

double spearman_correlation(std::span<const double> x, std::span<const double> y) {
    if (x.size() != y.size()) throw std::invalid_argument("correlation of lists of different length");
    std::vector<double> a(x.begin(), x.end()), b(y.begin(), y.end());
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (std::isnan(a[i]) || std::isnan(b[i])) a[i] = b[i] = missing;
    }
    return pearson_correlation(ranks(a), ranks(b));
}

std::vector<double> silhouette_widths(const DistanceMatrix& distances, const std::vector<std::size_t>& clusters) {
    const std::size_t n = distances.size();
    if (clusters.size() != n) throw std::invalid_argument("the clustering belongs to another matrix");
    const std::size_t count = n == 0 ? 0 : 1 + *std::max_element(clusters.begin(), clusters.end());
    std::vector<double> widths(n, 0.0);
    if (count < 2) return widths;
    parallel_for_each_index(n, 16, [&](std::size_t i) {
        std::vector<double> sum(count, 0.0), known(count, 0.0);
        for (std::size_t j = 0; j < n; ++j) {
            const double d = distances(i, j);
            if (j == i || std::isnan(d)) continue;
            sum[clusters[j]] += d;
            known[clusters[j]] += 1.0;
        }
        if (known[clusters[i]] == 0.0) return;
        const double own = sum[clusters[i]] / known[clusters[i]];
        double other = std::numeric_limits<double>::infinity();
        for (std::size_t c = 0; c < count; ++c) {
            if (c != clusters[i] && known[c] > 0.0) other = std::min(other, sum[c] / known[c]);
        }
        const double larger = std::max(own, other);
        if (std::isfinite(other) && larger > 0.0) widths[i] = (other - own) / larger;
    });
    return widths;
}

}  // namespace morphodesic::analysis

#include "analysis/agreement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

namespace morphodesic::analysis {
namespace {

struct Contingency {
    std::size_t rows = 0, columns = 0;
    std::vector<double> counts, row_sums, column_sums;
    double total = 0.0;
};

Contingency contingency(std::span<const std::size_t> a, std::span<const std::size_t> b) {
    if (a.size() != b.size()) throw std::invalid_argument("the partitions have different numbers of items");
    Contingency t;
    for (const std::size_t p : a) t.rows = std::max(t.rows, p + 1);
    for (const std::size_t p : b) t.columns = std::max(t.columns, p + 1);
    t.counts.assign(t.rows * t.columns, 0.0);
    t.row_sums.assign(t.rows, 0.0);
    t.column_sums.assign(t.columns, 0.0);
    for (std::size_t i = 0; i < a.size(); ++i) {
        t.counts[a[i] * t.columns + b[i]] += 1.0;
        t.row_sums[a[i]] += 1.0;
        t.column_sums[b[i]] += 1.0;
    }
    t.total = static_cast<double>(a.size());
    return t;
}

double pairs(double n) {
    return 0.5 * n * (n - 1.0);
}

double adjusted_rand(const Contingency& t) {
    if (t.total == 0.0) return std::numeric_limits<double>::quiet_NaN();
    double together = 0.0, rows = 0.0, columns = 0.0;
    for (const double n : t.counts) together += pairs(n);
    for (const double n : t.row_sums) rows += pairs(n);
    for (const double n : t.column_sums) columns += pairs(n);
    if (t.total < 2.0) return 1.0;
    const double expected = rows * columns / pairs(t.total), largest = 0.5 * (rows + columns);
    return largest == expected ? 1.0 : (together - expected) / (largest - expected);
}

double entropy(const std::vector<double>& sums, double total) {
    double h = 0.0;
    for (const double n : sums) {
        if (n > 0.0) h -= n / total * std::log(n / total);
    }
    return h;
}

/// Mean mutual information of all pairs of partitions with these sizes of parts.
double expected_information(const Contingency& t) {
    const double n = t.total;
    const auto log_factorial = [](double x) { return std::lgamma(x + 1.0); };
    // Equal sizes give equal terms: group them.
    std::map<double, double> rows, columns;
    for (const double a : t.row_sums) rows[a] += 1.0;
    for (const double b : t.column_sums) columns[b] += 1.0;
    double sum = 0.0;
    for (const auto& [a, times_a] : rows) {
        for (const auto& [b, times_b] : columns) {
            if (a == 0.0 || b == 0.0) continue;
            double part = 0.0;
            for (double k = std::max(1.0, a + b - n); k <= std::min(a, b); k += 1.0) {
                const double log_probability = log_factorial(a) + log_factorial(b) + log_factorial(n - a) +
                                               log_factorial(n - b) - log_factorial(n) - log_factorial(k) -
                                               log_factorial(a - k) - log_factorial(b - k) -
                                               log_factorial(n - a - b + k);
                part += k / n * std::log(n * k / (a * b)) * std::exp(log_probability);
            }
            sum += times_a * times_b * part;
        }
    }
    return sum;
}

}  // namespace

double adjusted_rand(std::span<const std::size_t> a, std::span<const std::size_t> b) {
    return adjusted_rand(contingency(a, b));
}

Agreement agreement(std::span<const std::size_t> a, std::span<const std::size_t> b) {
    const Contingency t = contingency(a, b);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    if (t.total == 0.0) return {nan, nan, nan, nan};
    Agreement result;
    result.adjusted_rand = adjusted_rand(t);
    double information = 0.0;
    for (std::size_t r = 0; r < t.rows; ++r) {
        for (std::size_t c = 0; c < t.columns; ++c) {
            const double n = t.counts[r * t.columns + c];
            if (n > 0.0) information += n / t.total * std::log(n * t.total / (t.row_sums[r] * t.column_sums[c]));
        }
    }
    information = std::max(0.0, information);
    const double h_a = entropy(t.row_sums, t.total), h_b = entropy(t.column_sums, t.total), mean = 0.5 * (h_a + h_b);
    result.mutual_information = information;
    const bool both_trivial = h_a == 0.0 && h_b == 0.0;
    result.normalized_mutual_information = both_trivial ? 1.0 : information / mean;
    const double expected = expected_information(t);
    const double denominator = mean - expected;
    // Two partitions into single items (or into one part) agree completely, whatever chance would do.
    if (both_trivial || std::abs(denominator) < 1e-14 * std::max(1.0, mean)) {
        result.adjusted_mutual_information = both_trivial || std::abs(information - mean) < 1e-12 ? 1.0 : 0.0;
    } else {
        result.adjusted_mutual_information = (information - expected) / denominator;
    }
    return result;
}

Agreement agreement(std::span<const std::size_t> clusters, std::span<const std::string> classes) {
    if (clusters.size() != classes.size())
        throw std::invalid_argument("the partitions have different numbers of items");
    std::map<std::string, std::size_t> number;
    std::vector<std::size_t> a, b;
    for (std::size_t i = 0; i < classes.size(); ++i) {
        if (classes[i].empty()) continue;
        a.push_back(clusters[i]);
        b.push_back(number.emplace(classes[i], number.size()).first->second);
    }
    return agreement(a, b);
}

}  // namespace morphodesic::analysis

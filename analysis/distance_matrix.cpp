#include "analysis/distance_matrix.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <unordered_set>
#include <utility>

namespace morphodesic::analysis {
namespace {

void check_distance(double d) {
    if (!std::isnan(d) && !(d >= 0.0 && d <= largest_distance)) {
        throw std::invalid_argument("a distance must lie between 0 and 1e100, or be NaN if it is missing");
    }
}

}  // namespace

DistanceMatrix::DistanceMatrix(std::vector<std::string> labels) : labels_(std::move(labels)) {
    std::unordered_set<std::string_view> seen;
    for (const std::string& label : labels_) {
        if (label.empty()) throw std::invalid_argument("a label of a distance matrix is empty");
        if (!seen.insert(label).second) throw std::invalid_argument("label '" + label + "' appears twice");
    }
    distances_.assign(size() < 2 ? 0 : size() * (size() - 1) / 2, missing);
}

DistanceMatrix::DistanceMatrix(std::vector<std::string> labels, std::vector<double> condensed)
    : DistanceMatrix(std::move(labels)) {
    if (condensed.size() != distances_.size()) {
        throw std::invalid_argument("n labels need n (n - 1) / 2 condensed distances");
    }
    std::for_each(condensed.begin(), condensed.end(), check_distance);
    distances_ = std::move(condensed);
}

void DistanceMatrix::set(std::size_t i, std::size_t j, double d) {
    if (i >= size() || j >= size()) throw std::invalid_argument("no such row or column in the distance matrix");
    if (i == j) {
        if (d != 0.0) throw std::invalid_argument("the distance of an item to itself is 0");
        return;
    }
    check_distance(d);
    distances_[index(i, j)] = d + 0.0;  // -0 becomes 0
    if (std::isnan(d) && !errors_.empty()) errors_[index(i, j)] = missing;
}

void DistanceMatrix::set(std::size_t i, std::size_t j, double d, double error) {
    if (!std::isnan(error) && !(error >= 0.0 && error <= largest_distance)) {
        throw std::invalid_argument("an error bar must lie between 0 and 1e100, or be NaN if it is not known");
    }
    set(i, j, d);
    if (i == j || std::isnan(error) || std::isnan(d)) return;
    if (errors_.empty()) errors_.assign(distances_.size(), missing);
    errors_[index(i, j)] = error;
}

std::size_t DistanceMatrix::missing_count() const {
    return static_cast<std::size_t>(
        std::count_if(distances_.begin(), distances_.end(), [](double d) { return std::isnan(d); }));
}

std::vector<double> DistanceMatrix::dense() const {
    const std::size_t n = size();
    std::vector<double> full(n * n, 0.0);
    std::size_t pair = 0;
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = i + 1; j < n; ++j, ++pair) full[i * n + j] = full[j * n + i] = distances_[pair];
    }
    return full;
}

DistanceMatrix DistanceMatrix::subset(std::span<const std::size_t> items) const {
    std::vector<std::string> labels;
    labels.reserve(items.size());
    for (const std::size_t i : items) labels.push_back(labels_.at(i));
    DistanceMatrix result(std::move(labels));
    if (has_errors()) result.errors_.assign(result.distances_.size(), missing);
    std::size_t pair = 0;
    for (std::size_t a = 0; a < items.size(); ++a) {
        for (std::size_t b = a + 1; b < items.size(); ++b, ++pair) {
            const std::size_t from = index(items[a], items[b]);
            result.distances_[pair] = distances_[from];
            if (has_errors()) result.errors_[pair] = errors_[from];
        }
    }
    return result;
}

}  // namespace morphodesic::analysis

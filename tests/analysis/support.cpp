#include "tests/analysis/support.h"

#include <cmath>

#include "analysis/random.h"

namespace morphodesic::tests {

using analysis::DistanceMatrix;
using analysis::Random;

std::vector<std::string> numbered_labels(std::size_t n) {
    std::vector<std::string> labels;
    for (std::size_t i = 0; i < n; ++i) labels.push_back("s" + std::to_string(i));
    return labels;
}

DistanceMatrix distances_of(const std::vector<double>& points, std::size_t dimensions) {
    const std::size_t n = points.size() / dimensions;
    DistanceMatrix matrix(numbered_labels(n));
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = i + 1; j < n; ++j) {
            double square = 0.0;
            for (std::size_t a = 0; a < dimensions; ++a) {
                square += std::pow(points[i * dimensions + a] - points[j * dimensions + a], 2);
            }
            matrix.set(i, j, std::sqrt(square));
        }
    }
    return matrix;
}

DistanceMatrix grouped_matrix(std::size_t n, std::size_t groups, double spread, std::uint64_t seed) {
    Random random(seed);
    std::vector<double> centres, points;
    for (std::size_t g = 0; g < groups * 5; ++g) centres.push_back(spread * random.normal());
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t a = 0; a < 5; ++a) points.push_back(centres[i % groups * 5 + a] + random.normal());
    }
    return distances_of(points, 5);
}

DistanceMatrix tied_matrix(std::size_t n, int largest, std::uint64_t seed) {
    Random random(seed);
    DistanceMatrix matrix(numbered_labels(n));
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = i + 1; j < n; ++j) {
            matrix.set(i, j, 1.0 + static_cast<double>(random.below(static_cast<std::uint64_t>(largest))));
        }
    }
    return matrix;
}

DistanceMatrix reordered(const DistanceMatrix& matrix, const std::vector<std::size_t>& order) {
    return matrix.subset(order);
}

std::vector<std::size_t> random_order(std::size_t n, std::uint64_t seed) {
    std::vector<std::size_t> order(n);
    for (std::size_t i = 0; i < n; ++i) order[i] = i;
    Random(seed).shuffle(order);
    return order;
}

}  // namespace morphodesic::tests

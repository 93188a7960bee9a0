#include "analysis/diffusion.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "analysis/evaluation.h"
#include "analysis/parallel.h"

namespace morphodesic::analysis {
namespace {

struct Entry {
    std::size_t column;
    double value;
};
using SparseRows = std::vector<std::vector<Entry>>;

/// R = P W for dense W, then transposed into place by the caller's index order: result(i, j) = sum_k P_jk W_ik.
void times_transposed(const SparseRows& p, const std::vector<double>& w, std::vector<double>& result, std::size_t n) {
    parallel_for_each_index(n, 8, [&](std::size_t i) {
        const double* const row = &w[i * n];
        for (std::size_t j = 0; j < n; ++j) {
            double sum = 0.0;
            for (const Entry& e : p[j]) sum += e.value * row[e.column];
            result[j * n + i] = sum;  // stored transposed: (W P^T)^T = P W^T
        }
    });
}

}  // namespace

DistanceMatrix diffused_distances(const DistanceMatrix& distances, const DiffusionOptions& options) {
    const std::size_t n = distances.size();
    if (options.neighbours == 0) throw std::invalid_argument("diffusion needs at least one neighbour");
    DistanceMatrix result(distances.labels());
    if (n < 2) return result;
    std::vector<std::vector<Neighbour>> near(n);
    std::vector<double> scale(n, 0.0);
    parallel_for_each_index(n, 16, [&](std::size_t i) {
        near[i] = nearest_neighbours(distances, i, options.neighbours);
        if (!near[i].empty()) scale[i] = near[i].back().distance;
    });
    SparseRows p(n);
    for (std::size_t i = 0; i < n; ++i) {
        double sum = 1.0;
        p[i].push_back({i, 1.0});
        for (const Neighbour& other : near[i]) {
            const double s = scale[i] * scale[other.item], square = other.distance * other.distance;
            const double affinity = square == 0.0 ? 1.0 : s > 0.0 ? std::exp(-square / s) : 0.0;
            p[i].push_back({other.item, affinity});
            sum += affinity;
        }
        for (Entry& e : p[i]) e.value /= sum;
        std::sort(p[i].begin(), p[i].end(), [](const Entry& a, const Entry& b) { return a.column < b.column; });
    }
    std::vector<double> w(n * n, 0.0), half(n * n);
    for (std::size_t i = 0; i < n; ++i) {
        for (const Entry& e : p[i]) {
            w[i * n + e.column] += 0.5 * e.value;
            w[e.column * n + i] += 0.5 * e.value;
        }
    }
    for (std::size_t step = 0; step < options.iterations; ++step) {
        times_transposed(p, w, half, n);  // P W (W is symmetric)
        times_transposed(p, half, w, n);  // P (P W)^T = P W P^T
    }
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = i + 1; j < n; ++j) {
            if (near[i].empty() || near[j].empty()) continue;
            const double mean = 0.5 * (w[i * n + j] + w[j * n + i]);
            result.set(i, j, std::clamp(1.0 - mean / std::sqrt(w[i * n + i] * w[j * n + j]), 0.0, 1.0));
        }
    }
    return result;
}

}  // namespace morphodesic::analysis

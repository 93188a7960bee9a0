#include "analysis/k_medoids.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "analysis/parallel.h"
#include "analysis/special_numbers.h"

namespace morphodesic::analysis {
namespace {

struct Assignment {
    std::vector<std::size_t> nearest;   // index into the medoids
    std::vector<double> first, second;  // distance to the nearest and second nearest medoid
};

Assignment assign(const std::vector<double>& d, std::size_t n, const std::vector<std::size_t>& medoids) {
    Assignment a{std::vector<std::size_t>(n, 0), std::vector<double>(n, infinity), std::vector<double>(n, infinity)};
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t m = 0; m < medoids.size(); ++m) {
            // A medoid always belongs to itself, also if another item lies at distance 0.
            const double distance = medoids[m] == i ? -1.0 : d[i * n + medoids[m]];
            if (distance < a.first[i]) {
                a.second[i] = a.first[i];
                a.first[i] = distance;
                a.nearest[i] = m;
            } else if (distance < a.second[i]) {
                a.second[i] = distance;
            }
        }
        a.first[i] = std::max(a.first[i], 0.0);
    }
    return a;
}

}  // namespace

KMedoids k_medoids(const DistanceMatrix& distances, std::size_t k) {
    const std::size_t n = distances.size();
    if (k < 1 || k > n) throw std::invalid_argument("k-medoids: k must lie between 1 and the number of items");
    if (distances.missing_count() > 0)
        throw std::invalid_argument("k-medoids needs all distances; fill the gaps first");
    const std::vector<double> d = distances.dense();
    KMedoids result;
    std::vector<std::size_t>& medoids = result.medoids;
    std::vector<double> nearest(n, infinity), gain(n);
    std::vector<unsigned char> is_medoid(n, 0);
    while (medoids.size() < k) {
        parallel_for_each_index(n, 16, [&](std::size_t c) {
            double sum = 0.0;
            const double* const row = &d[c * n];
            if (medoids.empty()) {
                for (std::size_t j = 0; j < n; ++j) sum -= row[j];
            } else {
                for (std::size_t j = 0; j < n; ++j) sum += std::max(nearest[j] - row[j], 0.0);
            }
            gain[c] = is_medoid[c] ? -infinity : sum;
        });
        const auto best = static_cast<std::size_t>(std::max_element(gain.begin(), gain.end()) - gain.begin());
        medoids.push_back(best);
        is_medoid[best] = 1;
        for (std::size_t j = 0; j < n; ++j) nearest[j] = std::min(nearest[j], d[best * n + j]);
    }
    Assignment now = assign(d, n, medoids);
    const auto cost_of = [](const Assignment& a) { return std::accumulate(a.first.begin(), a.first.end(), 0.0); };
    result.cost = cost_of(now);
    std::vector<std::size_t> out(n);
    for (; k < n;) {
        // What it costs to take medoid m away, everything else unchanged.
        std::vector<double> removal(k, 0.0);
        for (std::size_t j = 0; j < n; ++j) {
            if (k > 1) removal[now.nearest[j]] += now.second[j] - now.first[j];
        }
        parallel_for_each_index(n, 8, [&](std::size_t c) {
            gain[c] = -infinity;
            if (is_medoid[c]) return;
            std::vector<double> change = removal;  // by the medoid that goes
            double shared = 0.0;
            const double* const row = &d[c * n];
            for (std::size_t j = 0; j < n; ++j) {
                const std::size_t m = now.nearest[j];
                if (k == 1) {
                    change[0] += row[j] - now.first[j];
                } else if (row[j] < now.first[j]) {
                    shared += row[j] - now.first[j];
                    change[m] += now.first[j] - now.second[j];
                } else if (row[j] < now.second[j]) {
                    change[m] += row[j] - now.second[j];
                }
            }
            const auto best = std::min_element(change.begin(), change.end());
            out[c] = static_cast<std::size_t>(best - change.begin());
            gain[c] = -(*best + shared);
        });
        const auto best = static_cast<std::size_t>(std::max_element(gain.begin(), gain.end()) - gain.begin());
        if (!(gain[best] > 1e-12 * result.cost)) break;
        is_medoid[medoids[out[best]]] = 0;
        is_medoid[best] = 1;
        medoids[out[best]] = best;
        now = assign(d, n, medoids);
        const double cost = cost_of(now);
        ++result.swaps;
        if (!(cost < result.cost)) break;  // only rounding is left
        result.cost = cost;
    }
    std::sort(medoids.begin(), medoids.end());
    result.clusters = assign(d, n, medoids).nearest;
    return result;
}

}  // namespace morphodesic::analysis

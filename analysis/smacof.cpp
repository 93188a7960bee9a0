#include "analysis/smacof.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "analysis/kernels.h"
#include "analysis/parallel.h"
#include "analysis/procrustes.h"
#include "analysis/random.h"

namespace morphodesic::analysis {
namespace {

/// One configuration under way. Everything is summed row by row in the order of the items, so the bits do not depend on
/// the number of threads.
class Majorization {
public:
    Majorization(const DistanceMatrix& distances, const SmacofOptions& options)
        : n_(distances.size()), options_(options), given_(distances.dense()) {
        for (const double d : distances.condensed()) given_squares_ += d * d;
        if (options_.metric) return;
        struct Keyed {
            double d;
            Pair pair;
        };
        std::vector<Keyed> keyed;
        keyed.reserve(distances.pair_count());
        for (std::size_t i = 0; i < n_; ++i) {
            for (std::size_t j = i + 1; j < n_; ++j) {
                keyed.push_back({given_[i * n_ + j], {static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j)}});
            }
        }
        tbb::parallel_sort(keyed.begin(), keyed.end(), [](const Keyed& p, const Keyed& q) {
            return p.d != q.d ? p.d < q.d : std::pair(p.pair.i, p.pair.j) < std::pair(q.pair.i, q.pair.j);
        });
        order_.reserve(keyed.size());
        for (const Keyed& k : keyed) order_.push_back(k.pair);
        for (std::size_t begin = 0; begin < order_.size();) {
            std::size_t end = begin + 1;
            while (end < order_.size() && given(order_[end]) == given(order_[begin])) ++end;
            if (end - begin > 1) ties_.emplace_back(begin, end);
            begin = end;
        }
    }

    struct State {
        std::vector<double> x;  // [n x dimensions]
        double stress = std::numeric_limits<double>::infinity();
        std::size_t iterations = 0;
        bool converged = false;
    };

    void run(State& state, std::size_t iterations) {
        measure(state.x);
        double criterion = misfit_;
        for (std::size_t k = 0; k < iterations && !state.converged; ++k) {
            state.x.swap(next_);
            measure(state.x);
            ++state.iterations;
            // The misfit to disparities of fixed size never grows; its root is the stress.
            state.converged = std::sqrt(criterion) - std::sqrt(misfit_) <= options_.tolerance * std::sqrt(criterion);
            criterion = misfit_;
        }
        state.stress = stress_1();
    }

    /// Everything about one configuration, non-metric ones brought to the size of the given distances.
    void report(const std::vector<double>& x, Smacof& result) {
        measure(x);
        result.stress = stress_1();
        double scale = 1.0;
        if (!options_.metric) {
            const double factor = best_factor();
            for (double& d : fitted_) d *= factor;
            sum_rows(x);
            if (squares_ > 0.0) scale = std::sqrt(2.0 * given_squares_ / squares_);
        }
        result.embedding = {options_.dimensions, x};
        for (double& c : result.embedding.coordinates) c *= scale;
        result.stress_per_item = row_misfit_;
        for (double& s : result.stress_per_item) s = result.stress > 1e-12 ? s / misfit_ : 0.0;
        result.disparities.resize(n_ < 2 ? 0 : n_ * (n_ - 1) / 2);
        for (std::size_t i = 0, pair = 0; i < n_; ++i) {
            for (std::size_t j = i + 1; j < n_; ++j, ++pair) result.disparities[pair] = scale * disparity()[i * n_ + j];
        }
        orient_to_principal_axes(result.embedding);
    }

private:
    struct Pair {
        std::uint32_t i, j;
    };
    [[nodiscard]] double given(const Pair& p) const { return given_[p.i * n_ + p.j]; }
    [[nodiscard]] const std::vector<double>& disparity() const { return options_.metric ? given_ : fitted_; }

    /// The factor that brings the disparities nearest to the embedded distances: 1 if metric.
    [[nodiscard]] double best_factor() const {
        if (options_.metric || given_squares_ == 0.0) return 1.0;
        return 0.25 * (squares_ + 2.0 * given_squares_ - misfit_) / given_squares_;
    }

    [[nodiscard]] double stress_1() const {
        if (squares_ == 0.0) return misfit_ > 0.0 ? 1.0 : 0.0;
        if (options_.metric) return std::sqrt(misfit_ / squares_);
        const double factor = best_factor();
        return std::sqrt(std::max(0.0, 1.0 - 2.0 * factor * factor * given_squares_ / squares_));
    }

    void measure(const std::vector<double>& x) {
        if (!options_.metric) fit_disparities(x);
        sum_rows(x);
    }

    /// One pass over all ordered pairs: sums of squared misfits and distances, and in next_ the Guttman transform
    /// x_i <- 1/n sum_j disparity_ij / |x_i - x_j| (x_i - x_j).
    void sum_rows(const std::vector<double>& x) {
        const std::size_t dim = options_.dimensions;
        row_misfit_.assign(n_, 0.0);
        row_squares_.assign(n_, 0.0);
        next_.assign(x.size(), 0.0);
        const std::vector<double>& target = disparity();
        const double share = 1.0 / static_cast<double>(n_);
        axes_.resize(n_ * dim);
        for (std::size_t i = 0; i < n_; ++i) {
            for (std::size_t a = 0; a < dim; ++a) axes_[a * n_ + i] = x[i * dim + a];
        }
        parallel_for_each_index(n_, 16, [&](std::size_t i) {
            const double* const row = &target[i * n_];
            if (dim == 2 || dim == 3) {
                const double* const axes[3] = {&axes_[0], &axes_[n_], dim == 3 ? &axes_[2 * n_] : nullptr};
                const GuttmanRow sums =
                    dim == 2 ? guttman_row_2d(n_, axes, &x[i * dim], row) : guttman_row_3d(n_, axes, &x[i * dim], row);
                for (std::size_t a = 0; a < dim; ++a) next_[i * dim + a] = share * sums.sum[a];
                row_misfit_[i] = sums.misfit;
                row_squares_[i] = sums.squares;
                return;
            }
            for (std::size_t j = 0; j < n_; ++j) {
                const double square = squared_distance(x, i, j, dim), length = std::sqrt(square);
                row_misfit_[i] += (length - row[j]) * (length - row[j]);
                row_squares_[i] += square;
                if (length == 0.0) continue;
                for (std::size_t a = 0; a < dim; ++a) {
                    next_[i * dim + a] += share * row[j] / length * (x[i * dim + a] - x[j * dim + a]);
                }
            }
        });
        misfit_ = std::accumulate(row_misfit_.begin(), row_misfit_.end(), 0.0);
        squares_ = std::accumulate(row_squares_.begin(), row_squares_.end(), 0.0);
    }

    /// Monotone regression on the order of the given distances, with the sum of squares of the given distances.
    void fit_disparities(const std::vector<double>& x) {
        const std::size_t dim = options_.dimensions, pairs = order_.size();
        fitted_.resize(n_ * n_, 0.0);
        ordered_.resize(pairs);
        const auto distance = [&](const Pair& p) { return std::sqrt(squared_distance(x, p.i, p.j, dim)); };
        for (const auto& [begin, end] : ties_) {
            std::sort(order_.begin() + static_cast<std::ptrdiff_t>(begin),
                      order_.begin() + static_cast<std::ptrdiff_t>(end), [&](const Pair& a, const Pair& b) {
                          const double u = distance(a), v = distance(b);
                          return u != v ? u < v : std::pair(a.i, a.j) < std::pair(b.i, b.j);
                      });
        }
        constexpr std::size_t chunk = 4096;
        const std::size_t chunks = (pairs + chunk - 1) / chunk;
        parallel_for_each_index(chunks, 1, [&](std::size_t c) {
            for (std::size_t k = c * chunk; k < std::min(pairs, (c + 1) * chunk); ++k)
                ordered_[k] = distance(order_[k]);
        });
        const std::vector<double> regression = isotonic_regression(ordered_);
        double fitted_squares = 0.0;
        for (const double d : regression) fitted_squares += d * d;
        const double scale = fitted_squares > 0.0 ? std::sqrt(given_squares_ / fitted_squares) : 0.0;
        parallel_for_each_index(chunks, 1, [&](std::size_t c) {
            for (std::size_t k = c * chunk; k < std::min(pairs, (c + 1) * chunk); ++k) {
                const auto [i, j] = order_[k];
                fitted_[i * n_ + j] = fitted_[j * n_ + i] = scale * regression[k];
            }
        });
    }

    static double squared_distance(const std::vector<double>& x, std::size_t i, std::size_t j, std::size_t dim) {
        double square = 0.0;
        for (std::size_t a = 0; a < dim; ++a) {
            const double difference = x[i * dim + a] - x[j * dim + a];
            square += difference * difference;
        }
        return square;
    }

    std::size_t n_;
    SmacofOptions options_;
    std::vector<double> given_, fitted_;                     // [n x n]
    double given_squares_ = 0.0;                             // over pairs i < j
    double misfit_ = 0.0, squares_ = 0.0;                    // over ordered pairs
    std::vector<Pair> order_;                                // pairs by given distance
    std::vector<std::pair<std::size_t, std::size_t>> ties_;  // ranges of equal given distances in order_
    std::vector<double> ordered_, axes_, next_, row_misfit_, row_squares_;
};

}  // namespace

Smacof smacof(const DistanceMatrix& distances, const SmacofOptions& options) {
    if (options.dimensions == 0 || options.starts == 0 || !(options.tolerance > 0.0)) {
        throw std::invalid_argument("SMACOF: dimensions and starts must be >= 1, the tolerance > 0");
    }
    if (distances.missing_count() > 0) throw std::invalid_argument("SMACOF needs all distances; fill the gaps first");
    const std::size_t n = distances.size();
    if (options.initial != nullptr &&
        (options.initial->dimensions != options.dimensions || options.initial->size() != n)) {
        throw std::invalid_argument("SMACOF: the initial embedding has other items or dimensions");
    }
    Majorization majorization(distances, options);
    std::vector<Majorization::State> states(options.starts);
    const double size = distances.pair_count() == 0
                            ? 0.0
                            : std::sqrt(std::accumulate(distances.condensed().begin(), distances.condensed().end(), 0.0,
                                                        [](double s, double d) { return s + d * d; }) /
                                        static_cast<double>(distances.pair_count()));
    const std::size_t selection =
        options.starts == 1 ? 0
                            : std::min(options.max_iterations, std::max<std::size_t>(5, options.max_iterations / 10));
    for (std::size_t s = 0; s < options.starts; ++s) {
        if (s == 0 && options.initial != nullptr) {
            states[s].x = options.initial->coordinates;
        } else if (s == 0) {
            states[s].x = classical_mds(distances, options.dimensions).embedding.coordinates;
        } else {
            Random random(options.seed, s);
            states[s].x.resize(n * options.dimensions);
            for (double& c : states[s].x) c = size * (random.uniform() - 0.5);
        }
        majorization.run(states[s], selection);
    }
    std::size_t best = 0;
    for (std::size_t s = 1; s < states.size(); ++s) {
        if (states[s].stress < states[best].stress) best = s;
    }
    Smacof result;
    std::vector<Embedding> pictures;
    for (const auto& state : states) pictures.push_back({options.dimensions, state.x});
    for (std::size_t s = 0; s < states.size(); ++s) {
        result.runs.push_back(
            {states[s].stress, procrustes(pictures[best], pictures[s], !options.metric).rms_distance});
    }
    majorization.run(states[best], options.max_iterations - std::min(options.max_iterations, states[best].iterations));
    majorization.report(states[best].x, result);
    result.iterations = states[best].iterations;
    result.converged = states[best].converged || n < 2;
    return result;
}

std::vector<double> isotonic_regression(std::span<const double> y, std::span<const double> weights) {
    if (!weights.empty() && weights.size() != y.size()) throw std::invalid_argument("one weight per value is needed");
    struct Block {
        double sum, weight;
        std::size_t end;
    };
    std::vector<Block> blocks;
    blocks.reserve(y.size());
    for (std::size_t k = 0; k < y.size(); ++k) {
        const double w = weights.empty() ? 1.0 : weights[k];
        blocks.push_back({w * y[k], w, k + 1});
        while (blocks.size() > 1) {
            Block& last = blocks.back();
            Block& before = blocks[blocks.size() - 2];
            if (before.sum * last.weight <= last.sum * before.weight) break;
            before = {before.sum + last.sum, before.weight + last.weight, last.end};
            blocks.pop_back();
        }
    }
    std::vector<double> result(y.size());
    std::size_t k = 0;
    for (const Block& block : blocks) {
        const double value = block.weight > 0.0 ? block.sum / block.weight : 0.0;
        for (; k < block.end; ++k) result[k] = value;
    }
    return result;
}

std::vector<double> disparities_at(std::span<const double> further, std::span<const double> distances,
                                   std::span<const double> disparities) {
    if (distances.empty() || distances.size() != disparities.size()) {
        throw std::invalid_argument("one disparity per distance of the map is needed");
    }
    std::vector<std::size_t> order(distances.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return distances[a] < distances[b]; });
    std::vector<double> known, value;
    for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
        double sum = 0.0;
        while (end < order.size() && distances[order[end]] == distances[order[begin]]) sum += disparities[order[end++]];
        known.push_back(distances[order[begin]]);
        value.push_back(sum / static_cast<double>(end - begin));
    }
    std::vector<double> result(further.begin(), further.end());
    for (double& d : result) {
        if (std::isnan(d)) continue;
        const auto after = static_cast<std::size_t>(std::lower_bound(known.begin(), known.end(), d) - known.begin());
        if (after == 0 || after == known.size()) {
            const std::size_t nearest = after == 0 ? 0 : after - 1;
            d = known[nearest] > 0.0 ? value[nearest] * (d / known[nearest]) : value[nearest];
            continue;
        }
        const double t = (d - known[after - 1]) / (known[after] - known[after - 1]);
        d = value[after - 1] + t * (value[after] - value[after - 1]);
    }
    return result;
}

}  // namespace morphodesic::analysis

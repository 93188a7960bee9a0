#include "pipeline/neighbor_screening.h"

#include <algorithm>
#include <cmath>

#include "analysis/special_numbers.h"

namespace morphodesic::pipeline {
namespace {

using analysis::infinity;
using analysis::nan;
/// Share of the measured factors that may lie below the least factor.
constexpr double least_share = 0.02;

/// Of numbers in any order; NaN of none.
double quantile(std::vector<double>& values, double share) {
    if (values.empty()) return nan;
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

class Screener {
public:
    Screener(std::size_t shapes, int neighbors, std::size_t levels, const Measured& measured)
        : n_(shapes), k_(static_cast<std::size_t>(std::max(neighbors, 1))), measured_(measured) {
        result_.pairs.resize(n_ * (n_ - std::min<std::size_t>(n_, 1)) / 2);
        result_.measured.assign(levels, 0);
    }

    Screening run() {
        std::vector<std::size_t> all(result_.pairs.size());
        ends_.reserve(all.size());
        for (std::size_t i = 0; i < n_; ++i) {
            for (std::size_t j = i + 1; j < n_; ++j) ends_.emplace_back(i, j);
        }
        for (std::size_t p = 0; p < all.size(); ++p) all[p] = p;
        if (!ask(0, all)) return std::move(result_);
        for (std::size_t p = 0; p < all.size(); ++p) {
            const PairMeasurement m = *measured_(0, ends_[p].first, ends_[p].second);
            result_.pairs[p] = {m.distance, m.error, 0};
        }
        for (std::size_t level = 1; level < result_.measured.size() && refine(level); ++level) {
        }
        return std::move(result_);
    }

private:
    [[nodiscard]] double estimate(std::size_t pair) const { return result_.pairs[pair].distance; }
    [[nodiscard]] bool in_ring(std::size_t i, std::size_t j) const { return j == i + 1 || (i == 0 && j + 1 == n_); }
    [[nodiscard]] bool alive(std::size_t pair, std::size_t level) const {
        return result_.pairs[pair].level + 1 == level;
    }

    /// Whether all of these pairs are measured; if not, they are what is to be done next.
    bool ask(std::size_t level, const std::vector<std::size_t>& pairs) {
        result_.level = level;
        result_.asked = static_cast<long>(pairs.size());
        for (const std::size_t p : pairs) {
            if (!measured_(level, ends_[p].first, ends_[p].second)) result_.missing.push_back(ends_[p]);
        }
        if (!result_.missing.empty()) return false;
        result_.measured[level] += result_.asked;
        return true;
    }

    /// The k nearest of every shape by the estimates, a ring, and pairs without a distance.
    [[nodiscard]] std::vector<std::size_t> first_choice(std::size_t level) const {
        std::vector<char> chosen(ends_.size(), 0);
        std::vector<std::vector<std::size_t>> of(n_);
        for (std::size_t p = 0; p < ends_.size(); ++p) {
            if (!alive(p, level)) continue;
            const auto [i, j] = ends_[p];
            if (std::isnan(estimate(p)) || in_ring(i, j)) chosen[p] = 1;
            if (std::isnan(estimate(p))) continue;
            of[i].push_back(p);
            of[j].push_back(p);
        }
        for (std::vector<std::size_t>& mine : of) {
            const std::size_t count = std::min(k_, mine.size());
            std::partial_sort(mine.begin(), mine.begin() + static_cast<std::ptrdiff_t>(count), mine.end(),
                              [&](std::size_t x, std::size_t y) {
                                  return estimate(x) != estimate(y) ? estimate(x) < estimate(y) : x < y;
                              });
            for (std::size_t c = 0; c < count; ++c) chosen[mine[c]] = 1;
        }
        return numbers_of(chosen);
    }

    static std::vector<std::size_t> numbers_of(const std::vector<char>& chosen) {
        std::vector<std::size_t> numbers;
        for (std::size_t p = 0; p < chosen.size(); ++p) {
            if (chosen[p]) numbers.push_back(p);
        }
        return numbers;
    }

    /// Distance of the k-th nearest of every shape among measured pairs; infinite if it has fewer.
    [[nodiscard]] std::vector<double> kth_nearest(const std::vector<std::size_t>& pairs,
                                                  const std::vector<PairMeasurement>& fine) const {
        std::vector<std::vector<double>> of(n_);
        for (std::size_t m = 0; m < pairs.size(); ++m) {
            if (std::isnan(fine[m].distance)) continue;
            of[ends_[pairs[m]].first].push_back(fine[m].distance);
            of[ends_[pairs[m]].second].push_back(fine[m].distance);
        }
        std::vector<double> kth(n_, infinity);
        for (std::size_t i = 0; i < n_; ++i) {
            if (of[i].size() < k_) continue;
            const auto at = of[i].begin() + static_cast<std::ptrdiff_t>(k_ - 1);
            std::nth_element(of[i].begin(), at, of[i].end());
            kth[i] = *at;
        }
        return kth;
    }

    [[nodiscard]] std::vector<PairMeasurement> values(std::size_t level, const std::vector<std::size_t>& pairs) const {
        std::vector<PairMeasurement> found;
        found.reserve(pairs.size());
        for (const std::size_t p : pairs) found.push_back(*measured_(level, ends_[p].first, ends_[p].second));
        return found;
    }

    /// One level; false if pairs are missing.
    bool refine(std::size_t level) {
        const std::vector<std::size_t> first = first_choice(level);
        if (!ask(level, first)) return false;
        std::vector<PairMeasurement> fine = values(level, first);
        std::vector<double> factors, of_ring;
        for (std::size_t m = 0; m < first.size(); ++m) {
            const double factor = fine[m].distance / estimate(first[m]);
            if (!std::isfinite(factor) || !(factor > 0)) continue;
            factors.push_back(factor);
            if (in_ring(ends_[first[m]].first, ends_[first[m]].second)) of_ring.push_back(factor);
        }
        const double low = quantile(factors, least_share), high = quantile(factors, 1 - least_share),
                     middle = quantile(of_ring.empty() ? factors : of_ring, 0.5);
        // Nothing to judge by: every pair may be near.
        const double least = std::isnan(low) ? 0.0 : low;

        std::vector<double> kth = kth_nearest(first, fine);
        std::vector<char> chosen(ends_.size(), 0), added(ends_.size(), 0);
        for (const std::size_t p : first) chosen[p] = 1;
        for (std::size_t p = 0; p < ends_.size(); ++p) {
            if (chosen[p] || !alive(p, level)) continue;
            if (estimate(p) * least <= std::max(kth[ends_[p].first], kth[ends_[p].second])) added[p] = 1;
        }
        if (!ask(level, numbers_of(added))) return false;
        for (std::size_t p = 0; p < ends_.size(); ++p) chosen[p] = static_cast<char>(chosen[p] | added[p]);
        const std::vector<std::size_t> all = numbers_of(chosen);
        fine = values(level, all);
        kth = kth_nearest(all, fine);
        for (std::size_t p = 0; p < ends_.size(); ++p) {
            if (chosen[p]) continue;
            Screening::Pair& pair = result_.pairs[p];
            const double coarse = pair.distance;
            const double beyond = std::max(kth[ends_[p].first], kth[ends_[p].second]);
            pair.distance = std::max(coarse * middle, std::isfinite(beyond) ? beyond : 0.0);
            pair.error = std::max(pair.error * middle, coarse * (high - low) / 2);
        }
        for (std::size_t m = 0; m < all.size(); ++m) result_.pairs[all[m]] = {fine[m].distance, fine[m].error, level};
        return true;
    }

    std::size_t n_, k_;
    const Measured& measured_;
    std::vector<std::pair<std::size_t, std::size_t>> ends_;
    Screening result_;
};

}  // namespace

std::vector<GeodesicOptions> screening_levels(const GeodesicOptions& options, int neighbors) {
    struct Coarse {
        int level, steps, starts;
    };
    std::vector<GeodesicOptions> levels;
    for (const Coarse& c : {Coarse{4, 1, 1}, Coarse{5, 2, 2}}) {
        if (neighbors <= 0 || options.level <= c.level || options.time_steps < c.steps) continue;
        GeodesicOptions coarse = options;
        coarse.level = c.level;
        coarse.time_steps = c.steps;
        coarse.starts = std::min(options.starts, c.starts);
        coarse.tolerance = std::max(options.tolerance, 1e-2);
        levels.push_back(coarse);
    }
    levels.push_back(options);
    return levels;
}

Screening screen_pairs(std::size_t shapes, int neighbors, std::size_t levels, const Measured& measured) {
    return Screener(shapes, neighbors, levels, measured).run();
}

}  // namespace morphodesic::pipeline

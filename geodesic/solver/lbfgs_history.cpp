#include "geodesic/solver/lbfgs_history.h"

#include <utility>

#include "geodesic/kernels/vector_kernels.h"

namespace morphodesic {

void LbfgsHistory::clear() {
    for (Pair& pair : pairs_) spare_.push_back(std::move(pair));
    pairs_.clear();
    added_ = false;
}

std::vector<std::span<const kernels::HalfFloat>> LbfgsHistory::all(
    std::vector<kernels::HalfFloat> Pair::*vector) const {
    std::vector<std::span<const kernels::HalfFloat>> views;
    for (const Pair& pair : pairs_) views.emplace_back(pair.*vector);
    return views;
}

void LbfgsHistory::before(std::span<const float> gradient, std::span<float> remainder) {
    const std::size_t count = pairs_.size();
    std::vector<double> slope(count), factor(count);
    kernels::dots(gradient, all(&Pair::s), slope);
    for (std::size_t i = 0; i < count; ++i) {
        // s_i . y of the newest pair is the change of s_i . g in the step that made it.
        if (added_ && i + 1 < count) pairs_[i].later.push_back(slope[i] - pairs_[i].slope);
        pairs_[i].slope = slope[i];
    }
    added_ = false;
    for (std::size_t i = count; i-- > 0;) {
        double sum = slope[i];
        for (std::size_t j = i + 1; j < count; ++j) sum -= pairs_[j].alpha * pairs_[i].later[j - i - 1];
        pairs_[i].alpha = sum / pairs_[i].curvature;
        factor[i] = -pairs_[i].alpha;
    }
    kernels::combine(remainder, 1.0, gradient, factor, all(&Pair::y));
}

void LbfgsHistory::after(std::span<float> direction) const {
    const std::size_t count = pairs_.size();
    std::vector<double> product(count), factor(count);
    kernels::dots(direction, all(&Pair::y), product);
    for (std::size_t i = 0; i < count; ++i) {
        double sum = product[i];
        for (std::size_t j = 0; j < i; ++j) sum -= factor[j] * pairs_[j].later[i - j - 1];
        factor[i] = sum / pairs_[i].curvature - pairs_[i].alpha;
    }
    kernels::combine(direction, -1.0, direction, factor, all(&Pair::s));
}

void LbfgsHistory::add(std::span<const double> x, std::span<const double> x0, std::span<const float> g,
                       std::span<const float> g0, double least) {
    if (pairs_.size() == capacity_) {
        spare_.push_back(std::move(pairs_.front()));
        pairs_.erase(pairs_.begin());
    }
    Pair pair;
    if (!spare_.empty()) {
        pair = std::move(spare_.back());
        spare_.pop_back();
    }
    pair.later.clear();
    pair.s.resize(size_);
    pair.y.resize(size_);
    pair.curvature = kernels::differences(pair.s, x, x0, pair.y, g, g0);
    if (!(pair.curvature > least)) {
        spare_.push_back(std::move(pair));
        return;
    }
    pairs_.push_back(std::move(pair));
    added_ = true;
}

void LbfgsHistory::add_tried(std::span<const double> x, std::span<const double> x0, std::span<const float> g,
                             std::span<const float> g0, double least) {
    add(x, x0, g, g0, least);
    if (!added_) return;
    added_ = false;
    std::vector<double> product(pairs_.size());
    kernels::dots(g, all(&Pair::s), product);
    for (std::size_t i = 0; i + 1 < pairs_.size(); ++i) pairs_[i].later.push_back(product[i] - pairs_[i].slope);
}

}  // namespace morphodesic

#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "geodesic/kernels/vector_kernels.h"

namespace morphodesic {

/// The last steps s_i and changes of the gradient y_i of a minimisation, half floats (memory is what they wait for, and
/// the curvature they tell holds to a per cent at best), and the direction of L-BFGS from them. The two loops [Nocedal
/// & Wright, algorithm 7.4] are run on scalar products: with s_i . y_j at hand, all s_i . g come from one pass over the
/// vectors, and so do the sums, so memory is read four times in all instead of four times per pair.
class LbfgsHistory {
public:
    LbfgsHistory(std::size_t size, int capacity) : size_(size), capacity_(static_cast<std::size_t>(capacity)) {}

    [[nodiscard]] bool empty() const { return pairs_.empty(); }
    void clear();

    /// First loop: remainder = g - sum_i alpha_i y_i, which the preconditioner is applied to.
    void before(std::span<const float> gradient, std::span<float> remainder);
    /// Second loop, in place: direction = -(r + sum_i (alpha_i - beta_i) s_i) from the preconditioned remainder r.
    void after(std::span<float> direction) const;

    /// Takes up the step x0 -> x if its curvature s . y is above `least`; the oldest pair goes if there is no room.
    /// The gradient g0 must be that of the last call of before().
    void add(std::span<const double> x, std::span<const double> x0, std::span<const float> g, std::span<const float> g0,
             double least);

    /// The same of a step that is not taken: the next call of before() is for g0 once more.
    void add_tried(std::span<const double> x, std::span<const double> x0, std::span<const float> g,
                   std::span<const float> g0, double least);

private:
    struct Pair {
        std::vector<kernels::HalfFloat> s, y;
        double curvature = 0.0;     // s . y
        std::vector<double> later;  // s . y_j of the pairs after this one
        double slope = 0.0;         // s . g at the last gradient seen
        double alpha = 0.0;
    };

    [[nodiscard]] std::vector<std::span<const kernels::HalfFloat>> all(
        std::vector<kernels::HalfFloat> Pair::*vector) const;

    std::size_t size_, capacity_;
    std::vector<Pair> pairs_;  // oldest first
    std::vector<Pair> spare_;  // memory of pairs that were dropped
    bool added_ = false;       // since the last gradient seen
};

}  // namespace morphodesic

#include "pipeline/memory_model.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "geodesic/kernels/vector_kernels.h"
#include "pipeline/memory_limits.h"

namespace morphodesic::pipeline {
namespace {

double nodes(int dimension, int level) {
    return std::pow(std::ldexp(1.0, level) + 1.0, dimension);
}

}  // namespace

std::size_t bytes_of_pair(int dimension, int level, int time_steps, double window_share) {
    // Starts compete on levels that are cheap beside the others, in windows of any size.
    constexpr int last_search_level = 5;
    const std::size_t search =
        level > last_search_level && window_share < 1.0 ? bytes_of_pair(dimension, last_search_level, time_steps) : 0;
    const double n = nodes(dimension, level), fields = dimension * time_steps + time_steps - 1;
    const double coarser = dimension == 2 ? 4.0 / 3.0 : 8.0 / 7.0;
    constexpr double history = 4;
    // The path and the next one; the path, two gradients and the direction in single precision; the history of halves.
    const double path = fields * (2 * sizeof(double) + 4 * sizeof(float) + 2 * history * sizeof(kernels::HalfFloat));
    // Multigrid: diagonal, mass and block inverse (symmetric matrices), edges.
    const double matrix = dimension * (dimension + 1) / 2.0;
    const double cycles = time_steps * (1 + 2 * matrix + dimension) * coarser + (time_steps - 1);
    // Trajectories: derivative of the map, place in the coarse grid, gradient of the level sets, their unit.
    const double trajectories = time_steps * (dimension * dimension + 2 * dimension + 1) + (time_steps - 1);
    // While they are assembled: origins, gradients, weights and masses of the shapes. While they are applied: three
    // vectors per V-cycle, which in 3D are freed before.
    const double assembly = time_steps * (2.0 * dimension + 3), vectors = time_steps * 3 * dimension * coarser;
    const double for_a_time = dimension == 3 ? std::max(assembly, vectors) : assembly + vectors;
    const double preconditioner = sizeof(float) * (cycles + trajectories + for_a_time);
    const double ends = 4 * sizeof(double);
    // Of the whole cube there are the path and the shapes, too, while a window is looked at.
    const double cube = window_share < 1.0 ? fields * sizeof(double) + ends : 0.0;
    return std::max(search, static_cast<std::size_t>(1.1 * n * (cube + window_share * (path + preconditioner + ends))));
}

std::size_t bytes_of_shape(int dimension, int level) {
    return static_cast<std::size_t>(nodes(dimension, level)) * sizeof(double);
}

MemoryPlan plan_memory(const std::string& memory_option, int dimension, int level, int shape_level, int time_steps,
                       std::size_t shapes, int threads, const std::function<double(int)>& window_share) {
    const auto pair_on = [&](int on) {
        return bytes_of_pair(dimension, on, time_steps, window_share ? window_share(on) : 1.0);
    };
    MemoryPlan plan;
    plan.limit = memory_option.empty() ? available_memory() / 10 * 8 : size_from_text(memory_option);
    plan.per_pair = pair_on(level);
    const std::size_t shape = bytes_of_shape(dimension, shape_level);
    plan.all_shapes = shapes * shape;
    // A pair in flight holds its two shapes, whatever is kept besides.
    const std::size_t one = plan.per_pair + 2 * shape;
    if (bytes_of_program + one > plan.limit) {
        std::string advice = memory_option.empty() ? "use a machine with more memory" : "give more --memory";
        for (int lower = level - 1; lower >= 3; --lower) {
            const std::size_t less = bytes_of_program + pair_on(lower) + 2 * shape;
            if (less > plan.limit) continue;
            advice += ", or choose --level " + std::to_string(lower);
            break;
        }
        throw std::invalid_argument("one pair on level " + std::to_string(level) + " with " +
                                    std::to_string(time_steps) + " steps needs about " +
                                    size_text(bytes_of_program + one) + ", and " + size_text(plan.limit) +
                                    " may be used; " + advice);
    }
    const std::size_t free = plan.limit - bytes_of_program;
    plan.pairs_in_flight =
        static_cast<int>(std::min<std::size_t>(static_cast<std::size_t>(std::max(threads, 1)), free / one));
    plan.shapes = std::min(plan.all_shapes, free - static_cast<std::size_t>(plan.pairs_in_flight) * one);
    plan.predicted = bytes_of_program + plan.shapes + static_cast<std::size_t>(plan.pairs_in_flight) * one;
    return plan;
}

std::string MemoryPlan::sentence() const {
    std::string text = "memory: about " + size_text(predicted) + " (" + std::to_string(pairs_in_flight) +
                       (pairs_in_flight == 1 ? " pair" : " pairs") + " at once, " + size_text(per_pair) +
                       " each; shapes " + size_text(shapes);
    if (shapes < all_shapes) text += " of " + size_text(all_shapes) + ", the others are read when needed";
    return text + "), limit " + size_text(limit);
}

}  // namespace morphodesic::pipeline

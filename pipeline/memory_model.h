#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace morphodesic::pipeline {

/// Most bytes that one pair holds while it is solved, the two shapes not counted, from the buffers of the solver on the
/// finest level and a tenth on top for what the allocator keeps. Compared with measured peaks in pipeline/COST.md.
/// @param window_share  share of the cube that the path is minimised in, see SolidReach
[[nodiscard]] std::size_t bytes_of_pair(int dimension, int level, int time_steps, double window_share = 1.0);

/// Bytes of one shape that is kept on this level (doubles).
[[nodiscard]] std::size_t bytes_of_shape(int dimension, int level);

/// What the program takes without any shape or pair: code, libraries, threads, pictures and report (measured, see
/// pipeline/COST.md).
inline constexpr std::size_t bytes_of_program = std::size_t{160} << 20;

/// How a study uses the memory it may take.
struct MemoryPlan {
    std::size_t limit = 0;       ///< --memory, else 80 % of what is available
    std::size_t per_pair = 0;    ///< bytes_of_pair
    std::size_t all_shapes = 0;  ///< bytes of all shapes
    std::size_t shapes = 0;      ///< bytes of shapes that are kept; the others are read when needed
    int pairs_in_flight = 1;     ///< <= threads
    std::size_t predicted = 0;   ///< peak

    [[nodiscard]] std::string sentence() const;
};
/// @param memory_option  --memory; empty: 80 % of what is available
/// @param window_share   share of the cube that a path is minimised in, by level; empty: all of it
/// @throws std::invalid_argument if one pair does not fit, with what would
[[nodiscard]] MemoryPlan plan_memory(const std::string& memory_option, int dimension, int level, int shape_level,
                                     int time_steps, std::size_t shapes, int threads,
                                     const std::function<double(int)>& window_share = {});

}  // namespace morphodesic::pipeline

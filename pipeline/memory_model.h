#pragma once

#include <cstddef>
#include <string>

namespace morphodesic::pipeline {

/// Most bytes that one pair holds while it is solved, the two shapes not counted. From the buffers of the solver on the
/// finest level with N = (2^L + 1)^Dim nodes and F = Dim K + K - 1 fields (K deformations, K - 1 shapes):
///   path, two gradients, next path, direction, work      6 F N doubles
///   history of L-BFGS: six pairs of s and y              12 F N floats
///   preconditioner: K V-cycles of Dim + 8 fields on all levels, sum of 2^(-Dim l) = 4/3 or 8/7, and K - 1 diagonals
///   the two ends, their copies in the energy             4 N doubles
/// and a tenth on top for what the allocator keeps. Compared with measured peaks in pipeline/COST.md.
[[nodiscard]] std::size_t bytes_of_pair(int dimension, int level, int time_steps);

/// Bytes of one shape that is kept on this level (doubles).
[[nodiscard]] std::size_t bytes_of_shape(int dimension, int level);

/// What the program takes without any shape or pair: code, libraries, threads (measured, see pipeline/COST.md).
inline constexpr std::size_t bytes_of_program = std::size_t{112} << 20;

/// Memory that this process may still take: what the system calls available, or less if its control group has a limit.
[[nodiscard]] std::size_t available_memory();

/// "4G", "512M", "1.5GiB", "800000K", plain bytes; K, M, G, T are powers of 1024.
/// @throws std::invalid_argument with an example if the text is no size
[[nodiscard]] std::size_t size_from_text(const std::string& text);
/// 3221225472 -> "3.0 GB" (powers of 1024)
[[nodiscard]] std::string size_text(std::size_t bytes);

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
/// @throws std::invalid_argument if one pair does not fit, with what would
[[nodiscard]] MemoryPlan plan_memory(const std::string& memory_option, int dimension, int level, int shape_level,
                                     int time_steps, std::size_t shapes, int threads);

}  // namespace morphodesic::pipeline

#pragma once

#include <cstddef>

/// Reading a large file takes minutes. Whoever wants to be able to stop it says here how to find out that it is to
/// stop; the readers ask every now and then.
namespace morphodesic::datasets {

/// Thrown where reading is given up on request. No std::exception, so that nobody takes it for a fault of the file.
struct Interrupted {};

/// @param is_wanted  called from any thread, often; null: reading is never given up
void set_interruption(bool (*is_wanted)());

/// @throws Interrupted if reading is to be given up
void interruption_point();

/// The same in loops of many short rounds: asks in some of them.
inline void interruption_point(std::size_t round, std::size_t every = 4096) {
    if (round % every == 0) interruption_point();
}

}  // namespace morphodesic::datasets

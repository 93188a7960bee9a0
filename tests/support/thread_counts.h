#pragma once

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <utility>

namespace morphodesic::tests {

/// Runs f on one and on eight threads, however many cores there are, and returns both results.
template <class F>
auto on_one_and_eight_threads(const F& f) {
    // The limit alone would not do: the arena of a thread has a place per core and no more.
    oneapi::tbb::global_control allow(oneapi::tbb::global_control::max_allowed_parallelism, 8);
    oneapi::tbb::task_arena one(1), eight(8);
    auto a = one.execute(f);
    auto b = eight.execute(f);
    return std::pair(std::move(a), std::move(b));
}

}  // namespace morphodesic::tests

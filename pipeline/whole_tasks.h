#pragma once

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <cstddef>
#include <type_traits>
#include <utility>

namespace morphodesic::pipeline {

/// Runs one of many tasks so that it is done whole or not at all. When a task of a parallel loop or graph throws, TBB
/// cancels the others together with all loops inside them: those return at once, nothing done, and their task would go
/// on with half of its data. In a context of its own it is not reached by that. Nor does a thread that waits inside the
/// task begin another one meanwhile.
template <class Body>
auto run_whole(const Body& body) {
    using Result = std::invoke_result_t<const Body&>;
    tbb::task_group_context own(tbb::task_group_context::isolated);
    tbb::task_group task(own);
    if constexpr (std::is_void_v<Result>) {
        tbb::this_task_arena::isolate([&] { task.run_and_wait([&] { body(); }); });
    } else {
        Result result{};
        tbb::this_task_arena::isolate([&] { task.run_and_wait([&] { result = body(); }); });
        return result;
    }
}

/// body(i) for 0 <= i < count, in parallel and each whole. After one has thrown no other is begun, and it is thrown
/// again when those under way are done.
template <class Body>
void for_each_whole(std::size_t count, const Body& body) {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
            for (std::size_t i = range.begin(); i < range.end(); ++i) run_whole([&] { body(i); });
        },
        tbb::simple_partitioner());
}

}  // namespace morphodesic::pipeline

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

#include "pipeline/whole_tasks.h"

namespace morphodesic::pipeline {
namespace {

/// As a solve: a loop whose results the rest of the task relies on.
long sum_of_ones() {
    std::vector<int> ones(1000);
    tbb::parallel_for(std::size_t{0}, ones.size(), [&](std::size_t i) { ones[i] = 1; });
    long sum = 0;
    for (const int one : ones) sum += one;
    return sum;
}

TEST(WholeTasks, WhatFailsBesideATaskDoesNotReachItsLoops) {
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 4);
    tbb::task_arena arena(4);
    std::atomic<bool> begun{false}, failed{false};
    std::atomic<long> sum{-1};
    const auto fails = [&] {
        while (!begun) std::this_thread::yield();
        failed = true;
        throw std::runtime_error("a full disk");
    };
    const auto is_beside = [&] {
        begun = true;
        while (!failed) std::this_thread::yield();
        std::this_thread::sleep_for(std::chrono::milliseconds(50));  // until the loop around is cancelled
        sum = sum_of_ones();
    };
    arena.execute([&] {
        EXPECT_THROW(for_each_whole(2, [&](std::size_t i) { i == 0 ? fails() : is_beside(); }), std::runtime_error);
    });
    EXPECT_EQ(sum, 1000);
}

TEST(WholeTasks, EveryTaskIsDoneOnce) {
    std::vector<int> done(100);
    for_each_whole(done.size(), [&](std::size_t i) { done[i] += 1; });
    EXPECT_EQ(done, std::vector<int>(100, 1));
    EXPECT_EQ(run_whole([] { return 7; }), 7);
    for_each_whole(0, [](std::size_t) { FAIL(); });
}

TEST(WholeTasks, NothingIsBegunAfterAFailure) {
    const tbb::global_control alone(tbb::global_control::max_allowed_parallelism, 1);
    int begun = 0;
    EXPECT_THROW(for_each_whole(100,
                                [&](std::size_t) {
                                    ++begun;
                                    throw std::runtime_error("broken");
                                }),
                 std::runtime_error);
    EXPECT_EQ(begun, 1);
}

}  // namespace
}  // namespace morphodesic::pipeline

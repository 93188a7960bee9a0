#include "pipeline/process_limits.h"

#include <pthread.h>

#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

namespace morphodesic::pipeline {
namespace {

void* wait_at(void* gate) {
    const std::scoped_lock passed(*static_cast<std::mutex*>(gate));
    return nullptr;
}

/// As many as can be started now, at most `most`. They take little memory and end at once.
int threads_left(int most) {
    constexpr std::size_t stack = std::size_t{1} << 18;
    pthread_attr_t attributes;
    if (::pthread_attr_init(&attributes) != 0) return 0;
    ::pthread_attr_setstacksize(&attributes, stack);
    std::vector<pthread_t> started;
    started.reserve(static_cast<std::size_t>(most));
    {
        std::mutex gate;
        std::unique_lock closed(gate);
        for (pthread_t thread{}; static_cast<int>(started.size()) < most; started.push_back(thread)) {
            if (::pthread_create(&thread, &attributes, wait_at, &gate) != 0) break;
        }
        closed.unlock();
        for (const pthread_t thread : started) ::pthread_join(thread, nullptr);
    }
    ::pthread_attr_destroy(&attributes);
    return static_cast<int>(started.size());
}

}  // namespace

void expect_threads(int wanted) {
    const int left = threads_left(wanted);
    if (left >= wanted) return;
    throw std::runtime_error("only " + std::to_string(left) + " more threads can be started, and " +
                             std::to_string(wanted) +
                             " are needed; raise the limit (ulimit -u, or that of the container) or use fewer "
                             "--threads");
}

}  // namespace morphodesic::pipeline

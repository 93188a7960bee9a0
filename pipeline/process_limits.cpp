#include "pipeline/process_limits.h"

#include <fcntl.h>
#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

namespace morphodesic::pipeline {
namespace {

/// As many as can be opened now, at most `most`: files that the process was started with count, too.
std::size_t files_left(std::size_t most) {
    std::vector<int> opened;
    while (opened.size() < most) {
        const int file = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
        if (file < 0) break;
        opened.push_back(file);
    }
    for (const int file : opened) ::close(file);
    return opened.size();
}

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

std::string open_files_problem() {
    constexpr rlim_t plenty = 4096;
    // The store and its log, libraries that draw, and a file for each of some ten threads.
    constexpr std::size_t least = 32;
    rlimit limit{};
    if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return {};
    if (limit.rlim_cur < plenty) {
        limit.rlim_cur = std::max(limit.rlim_cur, std::min(plenty, limit.rlim_max));
        static_cast<void>(::setrlimit(RLIMIT_NOFILE, &limit));
    }
    const std::size_t left = files_left(least);
    if (left == least) return {};
    return "only " + std::to_string(left) + " more files can be opened (ulimit -n is " +
           std::to_string(limit.rlim_cur) + "), and at least " + std::to_string(least) +
           " are needed; raise the limit, e.g. with ulimit -n 1024";
}

void expect_threads(int wanted) {
    const int left = threads_left(wanted);
    if (left >= wanted) return;
    throw std::runtime_error("only " + std::to_string(left) + " more threads can be started, and " +
                             std::to_string(wanted) +
                             " are needed; raise the limit (ulimit -u, or that of the container) or use fewer "
                             "--threads");
}

}  // namespace morphodesic::pipeline

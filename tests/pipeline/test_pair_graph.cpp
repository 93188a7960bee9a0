#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pthread.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <iostream>

#include "datasets/synthetic.h"
#include "end_to_end/program.h"
#include "pipeline/pair_graph.h"

#ifndef MORPHODESIC_SANITIZED  // sanitizers have a pthread_create of their own
namespace {
std::atomic<bool> no_more_threads{false};
}

extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*start)(void*),
                              void* argument) noexcept {
    if (no_more_threads) return EAGAIN;
    static const auto real = reinterpret_cast<decltype(&pthread_create)>(::dlsym(RTLD_NEXT, "pthread_create"));
    return real(thread, attributes, start, argument);
}

namespace morphodesic::pipeline {
namespace {

/// Computes the pairs of three disks with threads that cannot be started. @return exit code
int compute_without_threads() {
    const tests::TemporaryFolder folder;
    ResultStore store(folder / "study.sqlite", ResultStore::Access::write);
    Collection collection;
    for (const double radius : {0.2, 0.25, 0.3}) {
        CollectionEntry entry;
        entry.row.name = entry.row.content_digest = std::to_string(radius);
        store.put_level_set<2>(entry.row.content_digest, datasets::ball<2>(DyadicGrid<2>(5), {0.5, 0.5}, radius), {});
        collection.entries.push_back(std::move(entry));
    }
    PairGraphOptions options;
    options.geodesic.level = 5;
    options.threads = options.pairs_in_flight = 4;
    Progress progress(Progress::Style::silent);
    no_more_threads = true;
    try {
        run_pair_graph<2>(collection, store, options, progress);
    } catch (const std::exception& error) {
        std::cerr << error.what() << "\n";
        return 3;
    }
    return 0;
}

TEST(PairGraphDeathTest, AThreadThatCannotBeStartedIsAnExceptionAndNotACrash) {
    testing::FLAGS_gtest_death_test_style = "threadsafe";  // a process of its own, in which no thread runs yet
    EXPECT_EXIT(std::_Exit(compute_without_threads()), testing::ExitedWithCode(3), "pthread_create");
}

}  // namespace
}  // namespace morphodesic::pipeline
#endif

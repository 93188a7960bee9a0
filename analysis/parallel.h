#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstddef>

namespace morphodesic::analysis {

/// body(i) for i in [0, n). Every body writes only what belongs to its i, so the bits do not depend on the threads.
/// Private to the .cpp files of this folder (TBB is not part of the interface).
template <class Body>
void parallel_for_each_index(std::size_t n, std::size_t grain, const Body& body) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, grain == 0 ? 1 : grain),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
                      });
}

}  // namespace morphodesic::analysis

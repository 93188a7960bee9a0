#pragma once

namespace morphodesic::pipeline {

/// Tries whether so many threads can be started beside those that there are. Libraries that compute and draw start
/// theirs in the middle of the work, and some end the process where that is refused.
/// @throws std::runtime_error with the limit to raise
void expect_threads(int wanted);

}  // namespace morphodesic::pipeline

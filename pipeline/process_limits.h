#pragma once

#include <string>

namespace morphodesic::pipeline {

/// Raises the limit of files that this process may have open, where it may do so itself. Message if too few are left
/// to work with: any file, of the collection or of the study, could then be taken for one that cannot be read; empty
/// otherwise.
[[nodiscard]] std::string open_files_problem();

/// Tries whether so many threads can be started beside those that there are. Libraries that compute and draw start
/// theirs in the middle of the work, and some end the process where that is refused.
/// @throws std::runtime_error with the limit to raise
void expect_threads(int wanted);

}  // namespace morphodesic::pipeline

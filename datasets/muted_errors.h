#pragma once

namespace morphodesic::datasets {

/// While it lives, what its thread writes to std::cerr is dropped; other threads are heard as ever. For libraries that
/// print what they also report to their caller.
class MutedErrors {
public:
    MutedErrors();
    ~MutedErrors();
    MutedErrors(const MutedErrors&) = delete;
    MutedErrors& operator=(const MutedErrors&) = delete;
};

}  // namespace morphodesic::datasets

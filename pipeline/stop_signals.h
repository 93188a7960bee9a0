#pragma once

namespace morphodesic::pipeline {

/// SIGINT (Ctrl-C), SIGTERM and SIGHUP (the terminal is gone) ask the program to stop in good order; the second one
/// ends it at once. Either way every finished pair is in the store.
class StopSignals {
public:
    /// Catches the signals from now on. Writing to a closed pipe or beyond a file size limit becomes an ordinary error.
    static void install();
    /// The signal that asked to stop; 0 if none did.
    [[nodiscard]] static int caught();
};

}  // namespace morphodesic::pipeline

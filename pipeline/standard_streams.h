#pragma once

namespace morphodesic::pipeline {

/// Opens /dev/null in the place of standard input, output or error where the caller closed it. Otherwise the next file
/// that is opened, such as one of the study, would take its number, and be read or written to as if it were the stream.
void open_standard_streams();

/// Whether something that was printed to standard output did not arrive, though somebody waits for it: a full disk, but
/// not a reader that has gone, as in `| head -1`.
[[nodiscard]] bool output_lost();

}  // namespace morphodesic::pipeline

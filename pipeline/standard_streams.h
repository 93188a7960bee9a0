#pragma once

#include <memory>
#include <streambuf>
#include <string>
#include <string_view>

namespace morphodesic::pipeline {

/// Opens /dev/null in the place of standard input, output or error where the caller closed it. Otherwise the next file
/// that is opened, such as one of the study, would take its number, and be read or written to as if it were the stream.
void open_standard_streams();

/// Whether something that was printed to standard output did not arrive, though somebody waits for it: a full disk, but
/// not a reader that has gone, as in `| head -1`.
[[nodiscard]] bool output_lost();

/// A text for a terminal: control characters but tabs and line ends become \x1b and the like. Names of files may hold
/// any byte, among them commands that colour, overwrite or move what a terminal shows.
[[nodiscard]] std::string printable(std::string_view text);

/// While it lives, whatever goes to std::cerr is printable().
class PrintableErrors {
public:
    PrintableErrors();
    ~PrintableErrors();
    PrintableErrors(const PrintableErrors&) = delete;
    PrintableErrors& operator=(const PrintableErrors&) = delete;

private:
    std::unique_ptr<std::streambuf> filter_;
    std::streambuf* before_;
};

}  // namespace morphodesic::pipeline

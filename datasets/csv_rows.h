#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace morphodesic::datasets {

/// One record of a CSV file.
struct CsvRow {
    int line = 0;  ///< in the file, from 1, where the record begins
    std::vector<std::string> fields;
};

/// All records of an RFC 4180 file: commas, quotes doubled within quotes, line breaks within quotes, LF or CRLF; a
/// UTF-8 byte order mark is skipped.
/// @throws ReadError if the file cannot be read or a quote is never closed
std::vector<CsvRow> read_csv(const std::filesystem::path& file);

/// A field as it has to be written: quoted if it holds a comma, a quote or a line break.
std::string csv_field(const std::string& text);

}  // namespace morphodesic::datasets

#pragma once

#include <cstddef>
#include <functional>
#include <istream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace morphodesic::analysis {

/// A table that cannot be used: what is wrong, where (line and column count from 1), and what to do.
class ParseError : public std::runtime_error {
public:
    ParseError(const std::string& source, std::size_t line, std::size_t column, const std::string& problem,
               const std::string& remedy);
    [[nodiscard]] std::size_t line() const { return line_; }      ///< line of the file, 0 if the whole file is meant
    [[nodiscard]] std::size_t column() const { return column_; }  ///< cell within the row, 0 if the whole row is meant

private:
    std::size_t line_, column_;
};

/// One cell as RFC 4180 wants it: in quotes if it holds a comma, quote or line break, quotes doubled.
[[nodiscard]] std::string csv_cell(std::string_view text);
/// Shortest decimal that reads back as the same double; empty for NaN, "inf" and "-inf" for infinities.
[[nodiscard]] std::string csv_cell(double value);

/// Reads records of an RFC 4180 file one by one: quoted cells may hold commas, doubled quotes and line breaks; lines
/// end in LF or CRLF; a UTF-8 byte order mark is skipped.
class CsvReader {
public:
    /// @param source name for messages
    CsvReader(std::istream& in, std::string source);
    /// False at the end of the file. Blank lines are skipped.
    /// @throws ParseError on an unclosed quote, text after a closing quote, or a row beyond max_cells
    bool next(std::vector<std::string>& cells);
    [[nodiscard]] std::size_t line() const { return record_line_; }  ///< line where the last record began
    void limit_cells(std::size_t max_cells) { max_cells_ = max_cells; }

private:
    bool read_line(std::string& line);
    std::istream& in_;
    std::string source_;
    std::size_t line_ = 0, record_line_ = 0, max_cells_ = 1'000'000;
};

}  // namespace morphodesic::analysis

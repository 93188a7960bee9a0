#include "analysis/csv.h"

#include <charconv>
#include <cmath>
#include <utility>

namespace morphodesic::analysis {
namespace {

std::string message(const std::string& source, std::size_t line, std::size_t column, const std::string& problem,
                    const std::string& remedy) {
    std::string text = source;
    if (line > 0) text += ", line " + std::to_string(line);
    if (column > 0) text += ", column " + std::to_string(column);
    return text + ": " + problem + (remedy.empty() ? "" : "; " + remedy);
}

}  // namespace

ParseError::ParseError(const std::string& source, std::size_t line, std::size_t column, const std::string& problem,
                       const std::string& remedy)
    : std::runtime_error(message(source, line, column, problem, remedy)), line_(line), column_(column) {}

std::string csv_cell(std::string_view text) {
    if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"') quoted += '"';
        quoted += c;
    }
    return quoted + '"';
}

std::string csv_cell(double value) {
    if (std::isnan(value)) return {};
    char buffer[32];
    const auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, value);
    return {buffer, error == std::errc() ? end : buffer};
}

CsvReader::CsvReader(std::istream& in, std::string source) : in_(in), source_(std::move(source)) {}

bool CsvReader::read_line(std::string& line) {
    if (!std::getline(in_, line)) return false;
    ++line_;
    if (line_ == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    return true;
}

bool CsvReader::next(std::vector<std::string>& cells) {
    cells.clear();
    std::string line;
    do {
        if (!read_line(line)) return false;
    } while (line.empty() || line == "\r");
    record_line_ = line_;
    std::string cell;
    for (std::size_t p = 0;;) {
        cell.clear();
        if (p < line.size() && line[p] == '"') {
            ++p;
            for (;;) {
                if (p >= line.size()) {  // a quoted line break
                    cell += '\n';
                    if (!read_line(line)) {
                        throw ParseError(source_, record_line_, cells.size() + 1, "a quoted cell is never closed",
                                         "close the quotation mark or double those inside the name");
                    }
                    p = 0;
                } else if (line[p] != '"') {
                    cell += line[p++];
                } else if (p + 1 < line.size() && line[p + 1] == '"') {
                    cell += '"';
                    p += 2;
                } else {
                    ++p;
                    break;
                }
            }
            if (p + 1 == line.size() && line[p] == '\r') ++p;
            if (p < line.size() && line[p] != ',') {
                throw ParseError(source_, line_, cells.size() + 1, "text follows a closing quotation mark",
                                 "double the quotation marks inside a quoted cell");
            }
        } else {
            const std::size_t end = std::min(line.find(',', p), line.size());
            cell.assign(line, p, end - p);
            p = end;
            if (p == line.size() && cell.ends_with('\r')) cell.pop_back();
        }
        cells.push_back(cell);
        if (cells.size() > max_cells_) {
            throw ParseError(source_, record_line_, cells.size(),
                             "the row has more than " + std::to_string(max_cells_) + " cells",
                             "give every row as many cells as the header");
        }
        if (p >= line.size()) return true;
        ++p;  // the comma
    }
}

}  // namespace morphodesic::analysis

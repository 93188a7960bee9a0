#include "analysis/matrix_csv.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <ostream>
#include <unordered_map>

namespace morphodesic::analysis {
namespace {

std::string in_quotes(std::string_view text) {
    return "'" + std::string(text.substr(0, 60)) + (text.size() > 60 ? "...'" : "'");
}

/// A cell as distance: NaN if empty.
double parse_distance(std::string_view cell, const std::string& source, std::size_t line, std::size_t column) {
    const auto is_space = [](char c) { return c == ' ' || c == '\t'; };
    while (!cell.empty() && is_space(cell.front())) cell.remove_prefix(1);
    while (!cell.empty() && is_space(cell.back())) cell.remove_suffix(1);
    if (cell.empty() || cell == "NA" || cell == "NaN" || cell == "nan") return missing;
    std::string_view digits = cell;
    if (digits.front() == '+') digits.remove_prefix(1);
    double value = 0.0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error == std::errc::result_out_of_range && end == digits.data() + digits.size()) {
        // from_chars reports underflow and overflow alike; tiny positive numbers are zero for every practical purpose.
        const std::size_t exponent = digits.find_first_of("eE");
        if (exponent != std::string_view::npos && exponent + 1 < digits.size() && digits[exponent + 1] == '-')
            return 0.0;
        throw ParseError(source, line, column, in_quotes(cell) + " is too large",
                         "use larger units: distances go up to 1e100");
    }
    if (error != std::errc() || end != digits.data() + digits.size()) {
        throw ParseError(source, line, column, in_quotes(cell) + " is not a number",
                         "write distances with a decimal point and leave the cell empty where there is none");
    }
    if (!std::isfinite(value)) {
        throw ParseError(source, line, column, in_quotes(cell) + " is not a distance",
                         "leave the cell empty where there is no distance");
    }
    if (value > largest_distance) {
        throw ParseError(source, line, column, in_quotes(cell) + " is too large",
                         "use larger units: distances go up to 1e100");
    }
    if (value < 0.0) {
        throw ParseError(source, line, column, "the distance " + std::string(cell) + " is negative",
                         "distances are >= 0; turn similarities into distances first");
    }
    return value + 0.0;
}

/// Whether a cell would be read as a distance, or as a missing one that says so.
bool is_number(const std::string& cell) {
    try {
        static_cast<void>(parse_distance(cell, "", 0, 0));
        return cell.find_first_not_of(" \t") != std::string::npos;
    } catch (const ParseError&) {
        return false;
    }
}

}  // namespace

DistanceMatrix read_distance_csv(std::istream& in, const std::string& source, const CsvReadOptions& options) {
    CsvReader reader(in, source);
    reader.limit_cells(options.max_items + 1);
    std::vector<std::string> cells;
    if (!reader.next(cells)) {
        throw ParseError(source, 0, 0, "the file is empty", "the first row must hold the labels of the columns");
    }
    const std::size_t header_line = reader.line();
    if (cells.size() == 1) {
        const bool other = cells[0].find_first_of(";\t") != std::string::npos;
        throw ParseError(
            source, header_line, 1, other ? "cells are not separated by commas" : "the header has no labels",
            "save a square table as comma-separated values, first row and first column holding the labels");
    }
    // Symmetric, so the first column would agree with the first row and both would be taken for labels.
    if (std::all_of(cells.begin(), cells.end(), is_number)) {
        throw ParseError(source, header_line, 1, "the table has no labels: its first row holds numbers only",
                         "put a row with the label of each item above it and a column with the same labels before it, "
                         "with an empty cell in the corner");
    }
    std::vector<std::string> labels(cells.begin() + 1, cells.end());
    std::unordered_map<std::string, std::size_t> column_of;
    for (std::size_t j = 0; j < labels.size(); ++j) {
        if (labels[j].empty()) {
            throw ParseError(source, header_line, j + 2, "the column has no label", "give every column a label");
        }
        if (const auto [at, added] = column_of.emplace(labels[j], j + 2); !added) {
            throw ParseError(source, header_line, j + 2,
                             "label " + in_quotes(labels[j]) + " is also that of column " + std::to_string(at->second),
                             "make the labels unique");
        }
    }
    const std::size_t n = labels.size();
    DistanceMatrix matrix(std::move(labels));
    std::vector<double> lower(matrix.pair_count(), missing);  // (i, j) with i > j, compared when all rows are there
    std::vector<double> upper(matrix.pair_count(), missing);
    std::vector<std::size_t> line_of_row(n, 0);
    std::size_t row = 0;
    for (; reader.next(cells); ++row) {
        const std::size_t line = reader.line();
        if (row == n) {
            throw ParseError(source, line, 0, "there are more rows than the " + std::to_string(n) + " columns",
                             "a distance table is square: one row and one column per item");
        }
        if (cells.size() != n + 1) {
            throw ParseError(
                source, line, std::min(cells.size(), n + 2),
                "the row has " + std::to_string(cells.size()) + " cells instead of " + std::to_string(n + 1),
                "give every row its label and one cell per column (quote labels that hold commas)");
        }
        if (cells[0] != matrix.labels()[row]) {
            throw ParseError(source, line, 1,
                             "the row is labelled " + in_quotes(cells[0]) + " where the columns have " +
                                 in_quotes(matrix.labels()[row]),
                             "use the same labels in the same order for rows and columns");
        }
        line_of_row[row] = line;
        for (std::size_t j = 0; j < n; ++j) {
            const double d = parse_distance(cells[j + 1], source, line, j + 2);
            if (j == row) {
                if (d != 0.0 && !std::isnan(d)) {
                    throw ParseError(source, line, j + 2,
                                     "the distance of " + in_quotes(cells[0]) + " to itself is not 0",
                                     "write 0 on the diagonal; turn similarities into distances first");
                }
            } else {
                (j > row ? upper : lower)[matrix.index(row, j)] = d;
            }
        }
    }
    if (row < n) {
        throw ParseError(source, reader.line(), 0,
                         "the file ends after " + std::to_string(row) + " of " + std::to_string(n) + " rows",
                         "a distance table is square: one row and one column per item");
    }
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = i + 1; j < n; ++j) {
            const double a = upper[matrix.index(i, j)], b = lower[matrix.index(i, j)];
            if (options.both_ways != nullptr && std::isnan(a) != std::isnan(b)) {  // one direction is known
                matrix.set(i, j, std::isnan(a) ? b : a);
                continue;
            }
            const bool differ =
                std::isnan(a) != std::isnan(b) || std::abs(a - b) > options.asymmetry_tolerance * std::max(a, b);
            if (differ) {
                const auto show = [](double d) { return std::isnan(d) ? std::string("empty") : csv_cell(d); };
                throw ParseError(source, line_of_row[j], i + 2,
                                 "the table is not symmetric: " + show(b) + " here, " + show(a) + " in line " +
                                     std::to_string(line_of_row[i]) + ", column " + std::to_string(j + 2),
                                 "write the same distance on both sides, or say that both directions are given: "
                                 "--asymmetric");
            }
            if (options.both_ways != nullptr && !std::isnan(a)) options.both_ways->push_back({i, j, a, b});
            matrix.set(i, j, a == b ? a : a + 0.5 * (b - a));
        }
    }
    return matrix;
}

DistanceMatrix read_distance_csv(const std::filesystem::path& file, const CsvReadOptions& options) {
    std::ifstream in(file, std::ios::binary);
    if (!in) throw ParseError(file.string(), 0, 0, "cannot be opened", "check the name and the permission to read");
    DistanceMatrix matrix = read_distance_csv(in, file.string(), options);
    if (in.bad()) throw ParseError(file.string(), 0, 0, "reading failed", "check the disk");
    return matrix;
}

void write_distance_csv(std::ostream& out, const DistanceMatrix& matrix) {
    std::string row;
    for (const std::string& label : matrix.labels()) row += "," + csv_cell(label);
    out << row << '\n';
    for (std::size_t i = 0; i < matrix.size(); ++i) {
        row = csv_cell(matrix.labels()[i]);
        for (std::size_t j = 0; j < matrix.size(); ++j) row += "," + csv_cell(matrix(i, j));
        out << row << '\n';
    }
}

void write_distance_csv(const std::filesystem::path& file, const DistanceMatrix& matrix) {
    std::filesystem::path draft = file;
    draft += ".part";
    {
        std::ofstream out(draft, std::ios::binary);
        write_distance_csv(out, matrix);
        out.close();
        if (!out) throw std::runtime_error(file.string() + ": cannot be written; check the folder and the free space");
    }
    std::filesystem::rename(draft, file);
}

}  // namespace morphodesic::analysis

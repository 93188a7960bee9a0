#pragma once

#include <cstddef>
#include <filesystem>
#include <iosfwd>
#include <string>

#include "analysis/csv.h"
#include "analysis/diagnostics.h"
#include "analysis/distance_matrix.h"

namespace morphodesic::analysis {

/// distances.csv: a header row (empty corner cell, then n labels) and n rows (label, then n distances), labels in the
/// same order on both sides and quoted by RFC 4180, exactly symmetric, zero diagonal, empty cell = no trustworthy
/// distance; read are also "NA" and "NaN", as R and pandas may write them. Doubles are written so that they read back
/// bit by bit. Error bars are not part of this file.

struct CsvReadOptions {
    /// Cells (i, j) and (j, i) that differ by more than this share of the larger are an error; below, their mean is
    /// taken (rounding of other programs). 1 accepts every difference.
    double asymmetry_tolerance = 1e-9;
    /// Receives the pairs whose two cells differ, as both directions; then a pair with one empty cell takes the other.
    std::vector<DirectedPair>* both_ways = nullptr;
    std::size_t max_items = 20'000;  ///< refuse larger tables instead of using all memory (n = 20,000 takes 1.6 GB)
};

/// @param source name of the file, for messages
/// @throws ParseError  not square, labels differ between row and column, twice the same label, asymmetric, negative,
///                     non-zero diagonal, not a number (also "inf"), out of range, too large
[[nodiscard]] DistanceMatrix read_distance_csv(std::istream& in, const std::string& source,
                                               const CsvReadOptions& options = {});
/// @throws ParseError also if the file cannot be opened
[[nodiscard]] DistanceMatrix read_distance_csv(const std::filesystem::path& file, const CsvReadOptions& options = {});

void write_distance_csv(std::ostream& out, const DistanceMatrix& matrix);
/// Writes beside the file and renames, so that an interrupted write leaves the old file.
/// @throws std::runtime_error if the file cannot be written
void write_distance_csv(const std::filesystem::path& file, const DistanceMatrix& matrix);

}  // namespace morphodesic::analysis

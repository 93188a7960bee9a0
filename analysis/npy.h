#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "analysis/distance_matrix.h"

namespace morphodesic::analysis {

/// Two-dimensional array of doubles in NumPy's .npy format, version 1.0, little endian ("<f8"), C order.
struct NpyArray {
    std::size_t rows = 0, columns = 0;
    std::vector<double> values;  ///< row-major [rows x columns]
};

void write_npy(std::ostream& out, const NpyArray& array);
/// The square matrix, NaN where a distance is missing. @throws std::runtime_error if it cannot be written
void write_npy(const std::filesystem::path& file, const DistanceMatrix& matrix);
/// Reads "<f8" and "<f4", C or Fortran order, one or two dimensions (one: a single column).
/// @throws ParseError  not an .npy file, another type, cut off
[[nodiscard]] NpyArray read_npy(std::istream& in, const std::string& source);
[[nodiscard]] NpyArray read_npy(const std::filesystem::path& file);

}  // namespace morphodesic::analysis

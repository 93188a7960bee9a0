#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace morphodesic::datasets {

/// One grid of a .vdb file, in a form that a library can be let loose on.
struct CheckedVdb {
    std::string content;         ///< a stream of its own with this grid only; empty if no grid is one of numbers
    std::string grid_name;       ///< as the file has it
    std::size_t grid_count = 0;  ///< in the file
};

/// Walks through the header, the names and the descriptions of all grids, and takes the first level set, else the first
/// grid of floating-point numbers, else of whole numbers or of yes and no; one that says it is empty only as the last.
/// OpenVDB believes every count and length in a file, and beyond its end it finds garbage: a file that breaks off could
/// take all memory.
/// @param most_voxels  more are refused
/// @throws ReadError if the file breaks off, promises more than it holds, or is too large
CheckedVdb check_vdb(const std::filesystem::path& file, double max_megabytes, std::size_t most_voxels);

/// A text from a file or the library, fit for a message: damaged files put thousands of odd bytes into it.
std::string shortened(const std::string& text);

}  // namespace morphodesic::datasets

#pragma once

#include <openvdb/openvdb.h>

#include <filesystem>
#include <string>

namespace morphodesic::datasets {

/// The grid of a checked stream (CheckedVdb::content), its values as floats; null if it is no grid of numbers.
/// OpenVDB copies blocks of whatever length a file says over its own memory. So the values are read by a process of
/// their own, which ends alone where they are damaged, and this one gets what it wrote down anew.
/// @param file  for messages
/// @throws ReadError if the values are damaged or break off
openvdb::FloatGrid::Ptr read_vdb_values(std::string content, const std::filesystem::path& file);

}  // namespace morphodesic::datasets

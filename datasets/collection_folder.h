#pragma once

#include <filesystem>
#include <set>
#include <string>

#include "datasets/outline.h"

namespace morphodesic::datasets {

/// Creates the folder for a generated collection, or accepts one that holds no shapes but the ones to be written.
/// @throws ReadError   if it holds another shape, which would get into the collection
/// @throws WriteError  if it cannot be created
void prepare_collection_folder(const std::filesystem::path& folder, const std::set<std::string>& names);

/// Writes a coverage as a grey PNG, the object black on white or white on black.
/// @throws WriteError
void write_coverage(const std::filesystem::path& file, const Coverage& coverage, bool black_on_white);

/// @throws WriteError
void write_text_file(const std::filesystem::path& file, const std::string& text);

}  // namespace morphodesic::datasets

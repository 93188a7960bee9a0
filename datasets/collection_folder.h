#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "datasets/outline.h"
#include "datasets/shape_source.h"

namespace morphodesic::datasets {

/// Creates the folder for a generated collection, or accepts one that holds no shapes but the ones to be written.
/// @throws ReadError   if it holds another shape, which would get into the collection
/// @throws WriteError  if it cannot be created
void prepare_collection_folder(const std::filesystem::path& folder, const std::set<std::string>& names);

/// Refuses a folder for shapes that are made from others where it would mix both: written there they could replace what
/// they are made from, and whoever reads either folder again would take all of them in.
/// @throws ReadError  if the folder is that of the sources, lies in it or holds a file of theirs
void keep_apart_from(const std::vector<ShapeSource>& sources, const std::filesystem::path& folder);

/// Writes a coverage as a grey PNG, the object black on white or white on black.
/// @throws WriteError
void write_coverage(const std::filesystem::path& file, const Coverage& coverage, bool black_on_white);

/// @throws WriteError
void write_text_file(const std::filesystem::path& file, const std::string& text);

}  // namespace morphodesic::datasets

#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "datasets/shape_source.h"

namespace morphodesic::datasets {

struct ScanOptions {
    /// Where class labels come from: csv (labels.csv in the folder: file,label), folder (the folder a file lies in),
    /// name (before the last '-' or '_', else before the digits at the end), none, or auto: the first of these that is
    /// there.
    std::string labels = "auto";

    [[nodiscard]] std::vector<std::string> problems() const;  ///< every violated constraint; empty if usable
};

/// A file or folder that could not be taken in.
struct ScanProblem {
    std::filesystem::path path;
    std::string problem, remedy;
    [[nodiscard]] std::string message() const { return path.string() + ": " + problem + "; " + remedy; }
};

struct ScanResult {
    std::vector<ShapeSource> sources;   ///< sorted by name, bytewise
    std::vector<ScanProblem> problems;  ///< unreadable folders, dangling links, ...: lost input
    std::vector<std::string> notes;     ///< worth knowing, nothing lost: rows of labels.csv without a file, ...
};

/// All shape files below a folder. Hidden files, other kinds of files and folders with results of this program
/// (studies, analyses, paths, figures) are skipped; links are followed, every folder is read once (so loops end).
/// @throws ReadError if the folder or its labels.csv cannot be read
/// @throws std::invalid_argument if the options have problems
ScanResult scan_folder(const std::filesystem::path& folder, const ScanOptions& options = {});

/// What this program wrote into a folder, in words, by the files that it always writes there; empty if it did not.
/// @param names  of the files in the folder
[[nodiscard]] std::string results_in(const std::set<std::string>& names);

/// A table of two columns, file and label (labels.csv, truth.csv), with or without a heading; more columns are ignored.
/// @throws ReadError if it cannot be read, if a row has no label or if a file is given two
std::map<std::string, std::string> read_labels(const std::filesystem::path& file);

}  // namespace morphodesic::datasets

#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/commands.h"

namespace morphodesic::pipeline {

/// Options of figures.
struct FiguresOptions {
    CommonOptions common;
    std::vector<std::string> keys;          ///< which ones; empty: all
    std::filesystem::path out = "figures";  ///< folder, created if need be
    std::filesystem::path markdown;         ///< file for the same as Markdown, SVG pictures beside it; empty: none
    bool quick = false;
};

/// Keys and titles of all figures, for --help.
[[nodiscard]] std::string figures_help();

/// Computes figures and writes name.png, name.svg and name.csv of each, and gallery.html with those of this
/// run; files of figures of other runs stay beside it. A figure that fails is listed, the others go on.
int figures(const FiguresOptions& options);

}  // namespace morphodesic::pipeline

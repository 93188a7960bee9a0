#pragma once

#include <functional>

#include "datasets/occlude.h"
#include "datasets/synthetic.h"
#include "pipeline/commands.h"

namespace CLI {
class App;
}

namespace morphodesic::pipeline {

/// Options of the subcommands of `datasets`.
struct DatasetOptions {
    CommonOptions common;
    std::filesystem::path out;  ///< folder of the collection
    int side = 256;             ///< width and height of the pictures, pixels
    datasets::CollectionOptions collection;
    std::filesystem::path source;  ///< occlude: folder of the shapes
    datasets::OcclusionOptions occlusion;
    RunSettings reading;               ///< occlude: labels and how the shapes are read
    bool hide_limbs = false;           ///< matchstick: write queries with an arm and a leg hidden
    datasets::LettersOptions letters;  ///< its count, variation and seed are those of `collection`
};

/// Adds letters, bars, dumbbells, disks, matchstick and occlude to `datasets`; the one that is parsed hands its work to
/// `choose`.
void add_dataset_kinds(CLI::App& datasets_command, DatasetOptions& options,
                       const std::function<void(std::function<int()>)>& choose);

}  // namespace morphodesic::pipeline

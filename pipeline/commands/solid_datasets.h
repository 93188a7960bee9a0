#pragma once

#include <functional>

#include "datasets/synthetic_solids.h"
#include "pipeline/commands.h"

namespace CLI {
class App;
}

namespace morphodesic::pipeline {

/// Options of datasets feet and datasets quadrupeds.
struct SolidDatasetOptions {
    CommonOptions common;
    std::filesystem::path out;   ///< folder of the collection
    datasets::FeetOptions feet;  ///< quadrupeds use its count, variation and seed
    bool damaged = false;        ///< also a badly scanned copy of each
};

/// Adds feet and quadrupeds to `datasets`; the one that is parsed hands its work to `choose`.
void add_solid_kinds(CLI::App& datasets_command, SolidDatasetOptions& options,
                     const std::function<void(std::function<int()>)>& choose);

}  // namespace morphodesic::pipeline

#pragma once

#include <string>
#include <vector>

#include "datasets/import_options.h"
#include "pipeline/result_store.h"

namespace morphodesic::pipeline {

/// A shape as far as the common scale is concerned.
struct SizedFile {
    std::string name;
    std::string digest;  ///< of the file's bytes
    double size = 0.0;   ///< radius in file units
};

/// The scale that all shapes of a study are placed at.
struct CommonScale {
    double scale = 0.0;  ///< cube units per file unit; 0: there is no shape to place
    std::string fact;    ///< where it is frozen
    std::string origin;  ///< which files fixed it; empty in studies of older programs
    std::string remark;  ///< what a user should know, else empty
};

/// The frozen scale of a study, so that a file more or less leaves the distances of the others as they are; or a new
/// one where there is none, a shape does not fit, none of the shapes was there when it was fixed, or the file that
/// fixed it is gone and the others are much smaller. One is kept for each way of reading and each dimension, so that
/// whoever comes back to the options of before finds the distances of before. The store is only read.
[[nodiscard]] CommonScale choose_common_scale(const std::vector<SizedFile>& files,
                                              const datasets::ImportOptions& options, int dimension,
                                              const ResultStore& store);

inline constexpr const char* common_scale_help = "lengths of the unit cube per unit of the files, one for all";

/// The shortest text of a number that reads back exactly.
[[nodiscard]] std::string exact_text(double x);

/// Freezes a scale.
void keep_common_scale(const CommonScale& scale, ResultStore& store);

}  // namespace morphodesic::pipeline

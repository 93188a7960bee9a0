#pragma once

#include <filesystem>

#include "pipeline/study_data.h"

namespace morphodesic::pipeline {

/// A table of distances that some other program made, and what is known about its items besides.
struct GivenMatrixOptions {
    std::filesystem::path errors;  ///< table of the same labels with the error bars; empty: none are known
    bool asymmetric = false;       ///< the two sides of the diagonal are both directions; the distance is their mean
};

/// The table as a study without shapes and geodesics (StudyData::given): names and distances only.
/// @throws analysis::ParseError if a table cannot be used
[[nodiscard]] StudyData read_given_matrix(const std::filesystem::path& table, const GivenMatrixOptions& options);

/// Replaces the classes of the shapes by those of a table file,label (see datasets::read_labels). Names that only the
/// table has are said in the remarks.
/// @throws datasets::ReadError if the table cannot be read, std::invalid_argument if it names none of the shapes
void label_shapes(StudyData& data, const std::filesystem::path& table);

/// The distances of another study or table, to be set beside these.
/// @throws StoreError, analysis::ParseError if it cannot be read
[[nodiscard]] StudyData load_study_or_table(const std::filesystem::path& source, const GivenMatrixOptions& options);

}  // namespace morphodesic::pipeline

#pragma once

#include <string>
#include <vector>

#include "datasets/shape_source.h"
#include "pipeline/commands/classify.h"
#include "pipeline/study_data.h"

namespace morphodesic::pipeline {

struct Query {
    datasets::ShapeSource source;  ///< label: the true class, empty if unknown
    std::string name;              ///< in the results; no two queries have the same
};

/// The queries that were named, with what is known of their classes.
struct QueryList {
    std::vector<Query> queries;
    std::vector<StudyFailure> failures;
    std::vector<std::string> remarks;
};

/// Lists the files and folders that are to be classified. A query is named as its file in its folder; where that would
/// give one name to several files, all are named by their paths as given. A file that is named twice is one query.
/// @throws datasets::ReadError if a table or the mask cannot be read, std::invalid_argument if one mask is given for
/// several queries
[[nodiscard]] QueryList list_queries(const ClassifyCommandOptions& options);

}  // namespace morphodesic::pipeline

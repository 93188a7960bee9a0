#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/study.h"
#include "reports/report_model.h"

namespace morphodesic::pipeline {

/// Distances of a further shape to those of a study.
struct QueryRow {
    std::string name;
    std::vector<double> distances;  ///< one per item, in the order of the labels; NaN: not known
};

struct QueryTable {
    std::vector<QueryRow> queries;
    std::vector<std::string> strangers;  ///< what the table has distances to, but the study does not have
};

/// Reads the distances of further shapes to the items of a study. Two kinds of tables are understood, told apart by the
/// header: a row per query (first cell: its name) with a column per item, and ranking.csv of `classify` with a row per
/// query and template (columns file, template, distance). Items that the table does not name are not known.
/// @throws analysis::ParseError if the table cannot be read, names no item, or has two distances for one query and item
[[nodiscard]] QueryTable read_queries(const std::filesystem::path& table, const std::vector<std::string>& labels);

/// Every query placed in every map of the analysis, the shapes of the study held fixed; in Isomap's maps by its path
/// lengths along the neighbour graph.
/// @param queries  distances in the order of `result.labels`
[[nodiscard]] std::vector<reports::PlacedQuery> place_queries(const analysis::AnalysisResult& result,
                                                              const std::vector<QueryRow>& queries);

/// placed.csv: one row per query and map: name, method, dimensions, x, y, z, stress (misfit of its distances), nearest
/// (shape), distance, class (of the nearest shape).
[[nodiscard]] std::string placed_csv(const reports::ReportModel& model);

}  // namespace morphodesic::pipeline

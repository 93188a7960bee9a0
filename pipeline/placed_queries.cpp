#include "pipeline/placed_queries.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <optional>
#include <unordered_map>

#include "analysis/csv.h"
#include "analysis/procrustes.h"

namespace morphodesic::pipeline {
namespace {

using analysis::ParseError;

/// NaN for an empty cell.
double distance_in(const std::string& cell, const std::string& source, std::size_t line, std::size_t column) {
    if (cell.empty() || cell == "NA" || cell == "NaN") return analysis::missing;
    double value = 0.0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error != std::errc() || end != cell.data() + cell.size() || !(value >= 0.0) ||
        value > analysis::largest_distance) {
        throw ParseError(source, line, column, "'" + cell.substr(0, 60) + "' is not a distance",
                         "write numbers >= 0 with a decimal point, and leave the cell empty where there is none");
    }
    return value;
}

}  // namespace

std::vector<QueryRow> read_queries(const std::filesystem::path& table, const std::vector<std::string>& labels) {
    const std::string source = table.string();
    std::ifstream in(table, std::ios::binary);
    if (!in) throw ParseError(source, 0, 0, "cannot be opened", "check the name and the permission to read");
    analysis::CsvReader reader(in, source);
    std::vector<std::string> header, cells;
    if (!reader.next(header))
        throw ParseError(source, 0, 0, "the file is empty", "the first row must name the columns");
    std::unordered_map<std::string, std::size_t> item_of;
    for (std::size_t i = 0; i < labels.size(); ++i) item_of.emplace(labels[i], i);
    const auto column = [&](const char* name) -> std::optional<std::size_t> {
        const auto at = std::find(header.begin(), header.end(), name);
        if (at == header.end()) return std::nullopt;
        return static_cast<std::size_t>(at - header.begin());
    };
    const auto file = column("file"), item = column("template"), distance = column("distance");
    const bool is_ranking = file && item && distance;
    std::vector<std::size_t> item_of_column(header.size(), labels.size());
    for (std::size_t c = 1; c < header.size() && !is_ranking; ++c) {
        if (const auto found = item_of.find(header[c]); found != item_of.end()) item_of_column[c] = found->second;
    }
    std::vector<QueryRow> queries;
    std::map<std::string, std::size_t> number;
    bool any = false;
    while (reader.next(cells)) {
        if (cells.size() != header.size()) {
            throw ParseError(
                source, reader.line(), 0,
                "the row has " + std::to_string(cells.size()) + " cells instead of " + std::to_string(header.size()),
                "give every row one cell per column (quote names that hold commas)");
        }
        const std::string& name = cells[is_ranking ? *file : 0];
        const auto [at, fresh] = number.emplace(name, queries.size());
        if (fresh) queries.push_back({name, std::vector<double>(labels.size(), analysis::missing)});
        std::vector<double>& known = queries[at->second].distances;
        const auto take = [&](std::size_t to, std::size_t c) {
            known[to] = distance_in(cells[c], source, reader.line(), c + 1);
            any = any || !std::isnan(known[to]);
        };
        if (is_ranking) {
            if (const auto found = item_of.find(cells[*item]); found != item_of.end()) take(found->second, *distance);
            continue;
        }
        for (std::size_t c = 1; c < cells.size(); ++c) {
            if (item_of_column[c] < labels.size()) take(item_of_column[c], c);
        }
    }
    if (!any) {
        throw ParseError(source, 0, 0,
                         "there is no distance to any of the " + std::to_string(labels.size()) + " shapes",
                         "name the columns as the shapes of the study, first column: the name of the query");
    }
    return queries;
}

std::string placed_csv(const analysis::AnalysisResult& result, const std::vector<QueryRow>& queries) {
    std::string text = "name,method,dimensions,x,y,z,stress,nearest,distance,class\n";
    for (const QueryRow& query : queries) {
        std::size_t nearest = query.distances.size();
        for (std::size_t i = 0; i < query.distances.size(); ++i) {
            const double d = query.distances[i];
            if (!std::isnan(d) && (nearest == query.distances.size() || d < query.distances[nearest])) nearest = i;
        }
        for (const analysis::EmbeddingResult& map : result.embeddings) {
            text += analysis::csv_cell(std::string_view(query.name)) + "," + map.method + "," +
                    std::to_string(map.embedding.dimensions);
            if (nearest == query.distances.size()) {  // nothing is known of it
                text += ",,,,,,,\n";
                continue;
            }
            const analysis::Placement place = analysis::place_query(map.embedding, query.distances);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                text += "," + (axis < place.position.size() ? analysis::csv_cell(place.position[axis]) : "");
            }
            text += "," + analysis::csv_cell(place.stress) + "," +
                    analysis::csv_cell(std::string_view(result.labels[nearest])) + "," +
                    analysis::csv_cell(query.distances[nearest]) + "," +
                    (result.classes.empty() ? "" : analysis::csv_cell(std::string_view(result.classes[nearest]))) +
                    "\n";
        }
    }
    return text;
}

}  // namespace morphodesic::pipeline

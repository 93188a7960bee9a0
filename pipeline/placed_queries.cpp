#include "pipeline/placed_queries.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <optional>
#include <set>
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

QueryTable read_queries(const std::filesystem::path& table, const std::vector<std::string>& labels) {
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
    std::set<std::string> strangers;
    std::vector<std::size_t> item_of_column(header.size(), labels.size());
    for (std::size_t c = 1; c < header.size() && !is_ranking; ++c) {
        if (const auto found = item_of.find(header[c]); found != item_of.end()) {
            item_of_column[c] = found->second;
        } else {
            strangers.insert(header[c]);
        }
    }
    std::vector<QueryRow> queries;
    std::map<std::string, std::size_t> number;
    std::set<std::pair<std::size_t, std::size_t>> taken;  // query and item
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
        const std::size_t query = at->second;
        std::vector<double>& known = queries[query].distances;
        const auto take = [&](std::size_t to, std::size_t c) {
            if (!taken.emplace(query, to).second) {
                throw ParseError(
                    source, reader.line(), c + 1,
                    "a second distance of '" + name.substr(0, 60) + "' to '" + labels[to].substr(0, 60) + "'",
                    "name every query and every shape once");
            }
            known[to] = distance_in(cells[c], source, reader.line(), c + 1);
            any = any || !std::isnan(known[to]);
        };
        if (is_ranking) {
            if (const auto found = item_of.find(cells[*item]); found != item_of.end()) {
                take(found->second, *distance);
            } else {
                strangers.insert(cells[*item]);
            }
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
    return {std::move(queries), {strangers.begin(), strangers.end()}};
}

std::vector<reports::PlacedQuery> place_queries(const analysis::AnalysisResult& result,
                                                const std::vector<QueryRow>& queries) {
    std::vector<reports::PlacedQuery> placed;
    for (const QueryRow& query : queries) {
        reports::PlacedQuery found;
        found.name = query.name;
        for (std::size_t i = 0; i < query.distances.size(); ++i) {
            const double d = query.distances[i];
            if (std::isnan(d) || (found.nearest >= 0 && d >= found.distance)) continue;
            found.nearest = static_cast<int>(i);
            found.distance = d;
        }
        const std::vector<double> along_graph = analysis::query_path_distances(
            result.graph_distances, query.distances, static_cast<std::size_t>(result.options.neighbors));
        for (const analysis::EmbeddingResult& map : result.embeddings) {
            const bool has_place = found.nearest >= 0;
            analysis::Placement place{{}, reports::unknown};
            if (has_place) {
                place = analysis::place_query(
                    map.embedding,
                    map.method == "Isomap" ? along_graph
                    : map.disparities.empty()
                        ? query.distances
                        : analysis::disparities_at(query.distances, result.distances.condensed(), map.disparities));
            }
            found.positions.push_back(std::move(place.position));
            found.stress.push_back(place.stress);
        }
        placed.push_back(std::move(found));
    }
    return placed;
}

std::string placed_csv(const reports::ReportModel& model) {
    std::string text = "name,method,dimensions,x,y,z,stress,nearest,distance,class\n";
    for (const reports::PlacedQuery& query : model.placed) {
        std::string ending = ",,,\n";  // nothing is known of it
        if (query.nearest >= 0) {
            const reports::ReportShape& nearest = model.shapes[static_cast<std::size_t>(query.nearest)];
            ending = "," + analysis::csv_cell(std::string_view(nearest.name)) + "," +
                     analysis::csv_cell(query.distance) + "," + analysis::csv_cell(std::string_view(nearest.label)) +
                     "\n";
        }
        for (std::size_t m = 0; m < model.embeddings.size(); ++m) {
            const std::vector<double>& position = query.positions[m];
            text += analysis::csv_cell(std::string_view(query.name)) + "," + model.embeddings[m].method + "," +
                    std::to_string(model.embeddings[m].dimension);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                text += "," + (axis < position.size() ? analysis::csv_cell(position[axis]) : "");
            }
            text += "," + (position.empty() ? "" : analysis::csv_cell(query.stress[m])) + ending;
        }
    }
    return text;
}

}  // namespace morphodesic::pipeline

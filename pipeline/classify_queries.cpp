#include "pipeline/classify_queries.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>

#include "datasets/folder_scan.h"
#include "datasets/read_error.h"

namespace morphodesic::pipeline {
namespace {

namespace fs = std::filesystem;

std::string path_as_given(const datasets::ShapeSource& source) {
    return source.path.lexically_normal().generic_string();
}

/// @param first  number of the query from which on the table is meant
void apply_truth(const std::map<std::string, std::string>& truth, QueryList& list, std::size_t first) {
    long unknown = 0;
    for (std::size_t i = first; i < list.queries.size(); ++i) {
        datasets::ShapeSource& source = list.queries[i].source;
        auto found = truth.find(path_as_given(source));
        if (found == truth.end()) found = truth.find(source.name);
        source.label = found == truth.end() ? "" : found->second;
        unknown += found == truth.end() ? 1 : 0;
    }
    if (unknown > 0) {
        list.remarks.push_back(std::to_string(unknown) + (unknown == 1 ? " query is" : " queries are") +
                               " not in the table of true classes.");
    }
}

/// A folder and a file in it, or one folder twice: classified once, or its results would count twice.
void drop_repeated(QueryList& list) {
    std::set<fs::path> seen;
    const std::size_t before = list.queries.size();
    std::erase_if(list.queries, [&](const Query& query) {
        // A link in a folder is a shape of its own, as in a study: only the folders are followed.
        const fs::path file = fs::absolute(query.source.path);
        return !seen.insert(fs::weakly_canonical(file.parent_path()) / file.filename()).second;
    });
    const std::size_t dropped = before - list.queries.size();
    if (dropped == 0) return;
    list.remarks.push_back(std::to_string(dropped) + (dropped == 1 ? " file was" : " files were") +
                           " named more than once and " + (dropped == 1 ? "is" : "are") + " classified once.");
}

void tell_apart(QueryList& list) {
    std::set<std::string> names;
    for (Query& query : list.queries) {
        query.name = query.source.name;
        names.insert(query.name);
    }
    if (names.size() == list.queries.size()) return;
    for (Query& query : list.queries) query.name = path_as_given(query.source);
}

/// A table that nobody named: without it, or if it is none, the query has no known class.
std::map<std::string, std::string> table_beside(const fs::path& table, std::vector<std::string>& remarks) {
    std::error_code error;
    if (!fs::exists(table, error)) return {};
    try {
        return datasets::read_labels(table);
    } catch (const datasets::ReadError& problem) {
        remarks.push_back("No true classes are taken from the table beside the queries: " +
                          std::string(problem.what()));
        return {};
    }
}

}  // namespace

QueryList list_queries(const ClassifyCommandOptions& options) {
    QueryList list;
    std::optional<std::map<std::string, std::string>> truth;
    if (!options.truth.empty()) truth = datasets::read_labels(options.truth);
    std::map<fs::path, std::map<std::string, std::string>> beside;  // tables by the folders of files that are named
    for (const fs::path& named : options.queries) {
        const std::size_t first = list.queries.size();
        if (fs::is_directory(named)) {
            std::error_code error;
            const bool own_table = !truth && fs::exists(named / "truth.csv", error);
            datasets::ScanResult scan =
                datasets::scan_folder(named, {truth || own_table ? "none" : options.settings.labels});
            for (const auto& problem : scan.problems) list.failures.push_back({"", "", problem.message()});
            for (auto& source : scan.sources) list.queries.push_back({std::move(source), ""});
            if (own_table) apply_truth(datasets::read_labels(named / "truth.csv"), list, first);
        } else {
            try {
                datasets::ShapeSource source = datasets::single_source(named);
                if (!truth) {
                    const auto [at, fresh] = beside.try_emplace(named.parent_path() / "truth.csv");
                    if (fresh) at->second = table_beside(at->first, list.remarks);
                    const auto found = at->second.find(named.filename().string());
                    if (found != at->second.end()) source.label = found->second;
                }
                list.queries.push_back({std::move(source), ""});
            } catch (const datasets::ReadError& error) {
                list.failures.push_back({named.string(), "", error.what()});
                continue;
            }
        }
        if (truth) apply_truth(*truth, list, first);
    }
    drop_repeated(list);
    tell_apart(list);
    if (options.mask != "known" && options.mask != "none" && options.mask != "auto") {
        if (list.queries.size() != 1) {
            throw std::invalid_argument("--mask " + options.mask +
                                        ": one mask image belongs to one query; for many queries put NAME.mask.png "
                                        "beside each NAME, or use --mask auto");
        }
        if (!fs::exists(options.mask)) {
            throw datasets::ReadError(options.mask, "there is no such mask",
                                      "name a picture (white = hidden), or known, none or auto");
        }
        list.queries.front().source.mask_path = options.mask;
    }
    return list;
}

}  // namespace morphodesic::pipeline

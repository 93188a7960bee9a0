#include "pipeline/report_provenance.h"

#include <ctime>
#include <sstream>
#include <string>
#include <vector>

#include "pipeline/common_scale.h"

namespace morphodesic::pipeline {
namespace {

std::string utc_now() {
    const std::time_t now = std::time(nullptr);
    std::tm parts{};
    gmtime_r(&now, &parts);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
    return text;
}

/// A setting as text: numbers short, true and false in words.
template <class Value>
std::string text_of(const Value& value) {
    std::ostringstream text;
    text.precision(10);
    text << std::boolalpha << value;
    return text.str();
}

/// The options that lead from the preset to these settings, as words for the command line.
std::vector<std::string> words_of(const RunSettings& settings) {
    std::vector<std::string> lines[2];
    const RunSettings preset = settings_of_preset(settings.preset);
    for (const RunSettings* from : {&preset, &settings}) {
        RunSettings::for_each_field(*from, [&](const char* name, const auto& value, const char*) {
            std::ostringstream text;
            text.precision(17);
            text << std::boolalpha << value;
            lines[from == &settings].push_back("--" + std::string(name) + "=" + text.str());
        });
    }
    std::vector<std::string> words{"--preset=" + settings.preset};
    for (std::size_t i = 0; i < lines[1].size(); ++i) {
        if (lines[0][i] != lines[1][i]) words.push_back(lines[1][i]);
    }
    return words;
}

template <class Options>
void add_settings(const Options& options, reports::ReportModel& model) {
    Options::for_each_field(options, [&](const char* name, const auto& value, const char* help) {
        model.settings.push_back({name, text_of(value), help});
    });
}

std::vector<reports::Link> links(const reports::ReportModel& model) {
    const bool given = model.given_matrix;
    std::vector<reports::Link> all = {
        {"distances.csv", "distances.csv", "square matrix of distances; empty: no trustworthy distance"},
        {"distances.npy", "distances.npy", "the same for NumPy; NaN: no trustworthy distance"}};
    if (!given) {
        all.push_back({"pairs.csv", "pairs.csv", "every pair with error bar, energies, min det and termination"});
        all.push_back({"shapes.csv", "shapes.csv", "volume (area), scale and notes of every shape"});
    }
    all.push_back({"clusters.csv", "clusters.csv", "cluster of every shape"});
    all.push_back({"linkage.csv", "linkage.csv", "the dendrogram, rows as in SciPy"});
    all.push_back({"embedding.csv", "embedding.csv", "coordinates of the maps"});
    if (!model.placed.empty()) all.push_back({"placed.csv", "placed.csv", "further shapes placed in the maps"});
    all.push_back({"accuracy.csv", "accuracy.csv",
                   "how well the distances know the classes; no rows with fewer than two classes"});
    all.push_back({"report.json", "report.json", "everything in this report but the pictures"});
    all.push_back({"figures/", "figures", "every figure as SVG, PDF and PNG"});
    if (!given) all.push_back({"study.sqlite", "study.sqlite", "the store: every result with its settings"});
    return all;
}

std::string name_of(const StudyFolder& folder) {
    const std::filesystem::path& path = folder.path();
    return (path.has_filename() ? path : path.parent_path()).filename().string();
}

}  // namespace

void add_provenance(const StudyData& data, const ResultStore& store, const StudyFolder& folder,
                    const analysis::AnalysisOptions& options, reports::ReportModel& model) {
    model.study = name_of(folder);
    model.created = utc_now();
    model.collection = store.fact("folder").value_or("");
    model.study_folder = folder.path().string();
    if (const auto seconds = store.fact("seconds")) model.seconds = std::stod(*seconds);
    model.preset = data.settings.preset;
    model.geodesic_options = words_of(data.settings);
    model.distance_unit = data.dimension == 2 ? "length of the unit cube" : "length^1.5 of the unit cube";
    add_settings(data.settings, model);
    add_settings(data.settings.pairs, model);
    if (!data.common_scale.empty()) {
        model.geodesic_options.push_back("--scale=" + data.common_scale);
        model.settings.push_back({"common-scale", data.common_scale, common_scale_help});
    }
    const std::size_t of_pairs = model.settings.size();
    add_settings(options, model);
    for (std::size_t k = of_pairs; k < model.settings.size(); ++k) {  // each name once
        if (model.settings[k].name == "neighbors") model.settings[k].name = "graph-neighbors";
    }
    model.versions = {{"morphodesic", MORPHODESIC_VERSION, ""},
                      {"compiler", __VERSION__, "other compilers may give other last digits"},
                      {"solver revision", std::to_string(solver_revision), "part of the settings hash"},
                      {"settings hash", data.settings_hash, "results of other settings never share a matrix"},
                      {"store version", std::to_string(store_version), ""}};
    model.command = store.fact("command").value_or("");
    model.links = links(model);
    if (data.settings.pairs.neighbors > 0) {
        model.links.push_back({"distances_refined.csv", "distances_refined.csv",
                               "distances.csv without the estimates from coarse grids (empty cells)"});
    }
}

void add_provenance_of_table(const StudyOptions& options, const StudyFolder& folder, reports::ReportModel& model) {
    model.study = options.study.stem().string();
    model.created = utc_now();
    model.collection = options.study.string();
    model.study_folder = folder.path().string();
    model.cpu_seconds = reports::unknown;
    model.command = options.command;
    add_settings(options.analysis, model);
    model.versions = {{"morphodesic", MORPHODESIC_VERSION, ""}};
    model.links = links(model);
}

}  // namespace morphodesic::pipeline

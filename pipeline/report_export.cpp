// Pictures, paths, report.json and report.html of a study.
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <ctime>
#include <sstream>

#include "pipeline/collection.h"
#include "pipeline/commands/summary.h"
#include "pipeline/exports.h"
#include "pipeline/pair_graph.h"
#include "pipeline/path_files.h"
#include "pipeline/path_pictures.h"
#include "pipeline/solid_paths.h"
#include "pipeline/stop_signals.h"
#include "pipeline/volume_comparison.h"
#include "reports/figures.h"
#include "reports/report.h"

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

template <int Dim>
ImportedShape<Dim> stored_shape(const StoredShape& row, const ResultStore& store) {
    ImportedShape<Dim> shape;
    shape.row = row;
    ScalarField<Dim> mask;
    shape.level_set = std::make_shared<const LevelSet<Dim>>(store.level_set<Dim>(row.content_digest, &mask));
    if (!mask.values.empty()) shape.mask = std::make_shared<const ScalarField<Dim>>(std::move(mask));
    return shape;
}

template <int Dim>
void add_thumbnails(const StudyData& data, const ResultStore& store, const SolidView& view, AnalysedStudy& analysed) {
    tbb::parallel_for(std::size_t{0}, analysed.analysis.kept.size(), [&](std::size_t i) {
        const StoredShape& row = data.shapes[analysed.analysis.kept[i]];
        const RgbaImage image = shape_picture(store.level_set<Dim>(row.content_digest), thumbnail_pixels, view);
        analysed.model.shapes[i].thumbnail = {encode_png(image), image.width, image.height, row.name};
    });
}

/// "turned by 12.3 degrees, moved by (0.01, -0.02)"
std::string motion_text(const StoredGeodesic& g) {
    const std::size_t dim = g.translation.size();
    if (dim < 2 || g.rotation.size() != dim * dim) return "";
    double trace = 0.0;
    for (std::size_t a = 0; a < dim; ++a) trace += g.rotation[a * dim + a];
    const double cosine = dim == 2 ? trace / 2 : (trace - 1) / 2;
    double degrees = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / M_PI;
    if (dim == 2 && g.rotation[2] < 0) degrees = -degrees;
    char text[160];
    if (dim == 2) {
        std::snprintf(text, sizeof text, "turned by %.1f degrees, moved by (%.3f, %.3f)", degrees, g.translation[0],
                      g.translation[1]);
    } else {
        std::snprintf(text, sizeof text, "turned by %.1f degrees, moved by (%.3f, %.3f, %.3f)", degrees,
                      g.translation[0], g.translation[1], g.translation[2]);
    }
    return text;
}

/// The pictures of a path and, of solids, their files: from the store and an earlier report, else the path is computed
/// again (it is not kept) and drawn.
template <int Dim>
DrawnPath pictures_of(const StoredGeodesic& g, const StoredShape& from, const StoredShape& to,
                      const GeodesicOptions& geodesic, ResultStore& store, const SolidView& view,
                      const KeptSolids& kept, const StudyFolder& folder, const std::filesystem::path& below,
                      std::string& remark) {
    const std::string pair = g.a + " " + g.b + " " + g.settings_hash;
    const std::string key = Dim == 2 ? "path 1 " + pair : "path 3 " + pair + " " + key_of(view);
    const bool has_solids = Dim == 2 || kept.take(pair, below);
    if (const auto stored = store.picture(key); stored && has_solids) {
        DrawnPath drawn = unpack(*stored);
        if (!drawn.frames.empty()) return drawn;
    }
    GeodesicResult<Dim> path;
    const StoredGeodesic again = solve_pair<Dim>(
        stored_shape<Dim>(from, store), stored_shape<Dim>(to, store), geodesic,
        [] { return StopSignals::caught() != 0; }, &path);
    if (StopSignals::caught() != 0 || path.shapes.empty()) return {};
    if (again.path_length != g.path_length) {
        remark = from.name + " - " + to.name +
                 ": drawing the path gave another length than the store has; was the store "
                 "made by another build? `morphodesic verify` tells more.";
    }
    DrawnPath drawn = draw_path(path, view);
    store.put_picture(key, pack(drawn));
    if constexpr (Dim == 3) {
        write_path_solids(folder, below, path);
        kept.mark(pair, below);
    }
    return drawn;
}

/// A name that is a folder of its own on every file system.
std::string path_folder(std::size_t number, const std::string& a, const std::string& b) {
    std::string name = std::to_string(number + 1);
    name.insert(0, name.size() < 3 ? 3 - name.size() : 0, '0');
    for (const std::string* part : {&a, &b}) {
        name += '_';
        for (const char c : part->substr(0, part->rfind('.')).substr(0, 60)) {
            const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-';
            name += plain ? c : '-';
        }
    }
    return name;
}

template <int Dim>
void add_paths(const StudyData& data, ResultStore& store, const StudyFolder& folder, const StudyOptions& options,
               Progress& progress, const SolidView& view, AnalysedStudy& analysed) {
    const KeptSolids kept(folder);
    reports::ReportModel& model = analysed.model;
    const auto chosen = choose_paths(model, options.paths);
    if (!chosen.empty()) progress.message("drawing " + std::to_string(chosen.size()) + " paths");
    std::vector<reports::PathReport> paths(chosen.size());
    std::vector<std::string> remarks(chosen.size());
    tbb::parallel_for(std::size_t{0}, chosen.size(), [&](std::size_t p) {
        if (StopSignals::caught() != 0) return;
        const auto [a, b] = chosen[p];
        const std::size_t i = analysed.analysis.kept[static_cast<std::size_t>(a)],
                          j = analysed.analysis.kept[static_cast<std::size_t>(b)];
        const auto& pair = data.pairs[data.index(i, j)];
        if (!pair || !pair->problem().empty()) return;
        const bool forward = data.first_is_a[data.index(i, j)];
        const StoredShape &from = data.shapes[forward ? i : j], &to = data.shapes[forward ? j : i];
        const std::filesystem::path below = std::filesystem::path("paths") / path_folder(p, from.name, to.name);
        DrawnPath drawn = pictures_of<Dim>(*pair, from, to, data.geodesic_of(data.index(i, j)), store, view, kept,
                                           folder, below, remarks[p]);
        if (drawn.frames.empty()) return;
        write_path_files(folder, below, drawn);

        reports::PathReport& path = paths[p];
        path.a = forward ? a : b;
        path.b = forward ? b : a;
        path.colour_bar = drawn.colour_bar;
        for (std::size_t k = 0; k < drawn.frames.size(); ++k) {
            reports::Frame frame;
            frame.time =
                drawn.frames.size() > 1 ? static_cast<double>(k) / static_cast<double>(drawn.frames.size() - 1) : 0;
            frame.picture = std::move(drawn.frames[k]);
            if (k > 0 && k <= pair->deformation_energy.size())
                frame.deformation_energy = pair->deformation_energy[k - 1];
            if (k > 0 && k <= pair->mismatch_energy.size()) frame.mismatch_energy = pair->mismatch_energy[k - 1];
            path.frames.push_back(std::move(frame));
        }
        path.path_length = pair->path_length;
        path.error = pair->error;
        path.extrapolated_length = pair->extrapolated_length;
        path.path_energy = pair->path_energy;
        path.total_energy = pair->total_energy;
        path.min_det = pair->min_det;
        path.termination = to_string(pair->termination);
        path.message = pair->message;
        path.level = data.geodesic_of(data.index(i, j)).level;
        path.time_steps = data.geodesic_of(data.index(i, j)).time_steps;
        path.seconds = pair->seconds;
        path.motion = motion_text(*pair);
    });
    for (reports::PathReport& path : paths) {
        if (!path.frames.empty()) model.paths.push_back(std::move(path));
    }
    for (std::string& remark : remarks) {
        if (!remark.empty()) model.trust.remarks.push_back(std::move(remark));
    }
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

void add_provenance(const StudyData& data, const ResultStore& store, const StudyFolder& folder,
                    reports::ReportModel& model) {
    model.study = folder.path().filename().string();
    if (model.study.empty()) model.study = folder.path().parent_path().filename().string();
    model.created = utc_now();
    model.collection = store.fact("folder").value_or("");
    model.study_folder = folder.path().string();
    if (const auto seconds = store.fact("seconds")) model.seconds = std::stod(*seconds);
    model.preset = data.settings.preset;
    model.geodesic_options = words_of(data.settings);
    model.distance_unit = data.dimension == 2 ? "length of the unit cube" : "length^1.5 of the unit cube";
    const auto add = [&](const char* name, const auto& value, const char* help) {
        using Value = std::decay_t<decltype(value)>;
        std::string text;
        if constexpr (std::is_same_v<Value, std::string>)
            text = value;
        else if constexpr (std::is_same_v<Value, bool>)
            text = value ? "true" : "false";
        else {
            char buffer[40];
            std::snprintf(buffer, sizeof buffer, "%.10g", static_cast<double>(value));
            text = buffer;
        }
        model.settings.push_back({name, text, help});
    };
    RunSettings::for_each_field(data.settings, add);
    PairSelection::for_each_field(data.settings.pairs, add);
    if (const auto scale = store.fact("common_scale"); scale && data.settings.normalize == "common") {
        model.geodesic_options.push_back("--scale=" + *scale);
        model.settings.push_back(
            {"common-scale", *scale, "lengths of the unit cube per unit of the files, one for all"});
    }
    model.versions = {{"morphodesic", MORPHODESIC_VERSION, ""},
                      {"solver revision", std::to_string(solver_revision), "part of the settings hash"},
                      {"settings hash", data.settings_hash, "results of other settings never share a matrix"},
                      {"store version", std::to_string(store_version), ""}};
    model.command = store.fact("command").value_or("");
    model.links = {{"distances.csv", "distances.csv", "square matrix of path lengths; empty: no trustworthy distance"},
                   {"distances.npy", "distances.npy", "the same for NumPy; NaN: no trustworthy distance"},
                   {"pairs.csv", "pairs.csv", "every pair with error bar, energies, min det and termination"},
                   {"clusters.csv", "clusters.csv", "cluster of every shape"},
                   {"shapes.csv", "shapes.csv", "volume (area), scale and notes of every shape"},
                   {"linkage.csv", "linkage.csv", "average linkage, rows as in SciPy"},
                   {"embedding.csv", "embedding.csv", "the map"},
                   {"report.json", "report.json", "everything in this report but the pictures"},
                   {"figures/", "figures", "every figure as SVG, for print"},
                   {"study.sqlite", "study.sqlite", "the store: every result with its settings"}};
    if (data.levels.size() > 1) {
        model.links.push_back({"distances_refined.csv", "distances_refined.csv",
                               "distances.csv without the estimates from coarse grids (empty cells)"});
    }
}

}  // namespace

void export_report(const StudyData& data, ResultStore& store, const StudyFolder& folder, const StudyOptions& options,
                   Progress& progress, Summary& summary) {
    AnalysedStudy analysed = analyse_study(data, options.analysis);
    export_tables(data, analysed, folder);
    if (analysed.model.shapes.empty()) return;
    analysed.model.volumes = compare_with_volumes(data, analysed.analysis);
    with_dimension(data.dimension, [&]<int Dim>() {
        const SolidView view = Dim == 3 ? view_of_study(store, data.shapes) : SolidView{};
        add_thumbnails<Dim>(data, store, view, analysed);
        add_paths<Dim>(data, store, folder, options, progress, view, analysed);
    });
    if (const auto warning = store.fact("size_warning"); warning && !warning->empty()) {
        analysed.model.trust.remarks.push_back(*warning);
    }
    add_provenance(data, store, folder, analysed.model);
    folder.write("report.json", reports::to_json(analysed.model));
    folder.write("report.html", reports::render_html(analysed.model));
    for (const reports::Figure& figure : reports::figures(analysed.model)) {
        folder.write(std::filesystem::path("figures") / (figure.name + ".svg"), figure.svg);
    }
    summarise(analysed.model, summary);
    summary.data["report"] = (folder.path() / "report.html").string();
    summary.lines.push_back("Report: " + (folder.path() / "report.html").string());
}

}  // namespace morphodesic::pipeline

// Pictures, paths, report.json, report.html and figures/ of a study.

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "geodesic/solver/canonical_frame.h"
#include "pipeline/collection.h"
#include "pipeline/commands/summary.h"
#include "pipeline/exports.h"
#include "pipeline/figure_files.h"
#include "pipeline/given_matrix.h"
#include "pipeline/pair_graph.h"
#include "pipeline/path_files.h"
#include "pipeline/path_pictures.h"
#include "pipeline/placed_queries.h"
#include "pipeline/report_provenance.h"
#include "pipeline/shape_cache.h"
#include "pipeline/solid_paths.h"
#include "pipeline/stop_signals.h"
#include "pipeline/study_comparison.h"
#include "pipeline/volume_comparison.h"
#include "pipeline/whole_tasks.h"
#include "reports/report.h"

namespace morphodesic::pipeline {
namespace {

/// Pictures of all shapes at one scale: that of the largest of them. Where that leaves most shapes as specks, each
/// fills its picture, and the model says so.
template <int Dim>
void add_thumbnails(const StudyData& data, const ResultStore& store, const StudyView& view, AnalysedStudy& analysed) {
    const std::vector<std::size_t>& kept = analysed.analysis.kept;
    const auto shape = [&](std::size_t i) { return store.level_set<Dim>(data.shapes[kept[i]].content_digest); };
    std::vector<double> reach(kept.size());
    for_each_whole(kept.size(), [&](std::size_t i) { reach[i] = picture_reach<Dim>(shape(i), view.of(kept[i])); });
    std::vector<double> sorted = reach;
    std::sort(sorted.begin(), sorted.end());
    analysed.model.pictures_at_one_scale = sorted[sorted.size() / 2] >= 0.65 * sorted.back();
    if (analysed.model.pictures_at_one_scale) reach.assign(kept.size(), sorted.back());
    for_each_whole(kept.size(), [&](std::size_t i) {
        const RgbaImage image = shape_picture(shape(i), thumbnail_pixels, near_view<Dim>(view.of(kept[i]), reach[i]));
        analysed.model.shapes[i].thumbnail = {encode_png(image), image.width, image.height, data.shapes[kept[i]].name};
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
    const std::string beginning = (Dim == 2 ? "path 4 " : "path 6 ") + pair,
                      key = Dim == 2 ? beginning : beginning + " " + key_of(view);
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
    path = in_pose_of_last(std::move(path));
    DrawnPath drawn = draw_path(path, view);
    store.put_picture(key, pack(drawn));
    store.remove_pictures(beginning, key);  // seen from other sides, before the collection changed
    if constexpr (Dim == 3) {
        write_path_solids(folder, below, path);
        kept.mark(pair, below);
    }
    return drawn;
}

/// "unknown" where there is no number, as for the correlation of distances that are all the same.
std::string number_text(const char* format, double value) {
    if (!std::isfinite(value)) return "unknown";
    char text[40];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

template <int Dim>
void add_paths(const StudyData& data, ResultStore& store, const StudyFolder& folder, const StudyOptions& options,
               Progress& progress, const StudyView& view, AnalysedStudy& analysed) {
    KeptSolids kept(folder);
    reports::ReportModel& model = analysed.model;
    const auto chosen = choose_paths(model, options.paths);
    if (!chosen.empty()) progress.message("drawing " + std::to_string(chosen.size()) + " paths");
    std::vector<reports::PathReport> paths(chosen.size());
    std::vector<std::string> remarks(chosen.size());
    for_each_whole(chosen.size(), [&](std::size_t p) {
        if (StopSignals::caught() != 0) return;
        const auto [a, b] = chosen[p];
        const std::size_t i = analysed.analysis.kept[static_cast<std::size_t>(a)],
                          j = analysed.analysis.kept[static_cast<std::size_t>(b)];
        const StoredGeodesic* const pair = data.geodesic(data.index(i, j));
        if (pair == nullptr || !pair->problem().empty()) return;
        const bool forward = data.first_is_a[data.index(i, j)];
        const StoredShape &from = data.shapes[forward ? i : j], &to = data.shapes[forward ? j : i];
        const std::filesystem::path below = std::filesystem::path("paths") / path_folder(p, from.name, to.name);
        DrawnPath drawn = pictures_of<Dim>(*pair, from, to, data.geodesic_of(data.index(i, j)), store,
                                           view.of(forward ? j : i), kept, folder, below, remarks[p]);
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
    if (StopSignals::caught() != 0) return;
    kept.drop_rest();
    for (reports::PathReport& path : paths) {
        if (!path.frames.empty()) model.paths.push_back(std::move(path));
    }
    for (std::string& remark : remarks) {
        if (!remark.empty()) model.trust.remarks.push_back(std::move(remark));
    }
}

}  // namespace

bool export_report(const StudyData& data, ResultStore& store, const StudyFolder& folder, const StudyOptions& options,
                   Progress& progress, Summary& summary) {
    AnalysedStudy analysed = analyse_study(data, options.analysis);
    if (StopSignals::caught() != 0) return false;
    add_findings(data, options, analysed, summary);
    RunFiles tables = tables_of(data, analysed);
    if (analysed.model.shapes.empty()) {
        folder.write_together(tables);
        return true;
    }
    analysed.model.volumes = compare_with_volumes(data, analysed.analysis);
    analysed.model.volume_spread = volume_spread(data, analysed.analysis);
    with_dimension(data.dimension, [&]<int Dim>() {
        const StudyView view = view_of_study(store, data);
        add_thumbnails<Dim>(data, store, view, analysed);
        add_paths<Dim>(data, store, folder, options, progress, view, analysed);
    });
    if (StopSignals::caught() != 0) return false;
    if (const auto warning = store.fact("size_warning"); warning && !warning->empty()) {
        analysed.model.warnings.push_back(*warning);
    }
    if (!data.unfinished.empty()) analysed.model.warnings.push_back(data.unfinished);
    add_provenance(data, store, folder, options.analysis, analysed.model);
    write_report(std::move(tables), analysed.model, folder, summary);
    return true;
}

void add_findings(const StudyData& data, const StudyOptions& options, AnalysedStudy& analysed, Summary& summary) {
    if (!options.compare.empty()) {
        const StudyData other = load_study_or_table(options.compare, {{}, options.asymmetric});
        const std::filesystem::path named =
            options.compare.has_filename() ? options.compare : options.compare.parent_path();
        const reports::Comparison& compare = analysed.model.compare.emplace(
            compare_studies(data, other, named.filename().string(), options.analysis.neighbors));
        summary.lines.push_back(std::to_string(compare.common_pairs) + " pairs in common; Spearman correlation " +
                                number_text("%.4f", compare.spearman) + ", " +
                                number_text("%.1f %%", 100 * compare.mean_overlap) + " of the neighbours agree");
    }
    if (options.place.empty()) return;
    const QueryTable table = read_queries(options.place, analysed.analysis.labels);
    const std::vector<QueryRow>& queries = table.queries;
    if (const auto& strangers = table.strangers; !strangers.empty()) {
        const std::string remark =
            options.place.filename().string() + " has distances to " + strangers.front() +
            (strangers.size() > 1 ? " and " + std::to_string(strangers.size() - 1) + " more, which are"
                                  : ", which is") +
            " not among the shapes.";
        summary.add_remark(remark);
        analysed.model.trust.remarks.push_back(remark);
    }
    analysed.model.placed = place_queries(analysed.analysis, queries);
    summary.data["placed"] = queries.size();
    summary.lines.push_back(std::to_string(queries.size()) + (queries.size() == 1 ? " query" : " queries") +
                            " placed in the maps: placed.csv");
}

void write_report(RunFiles tables, const reports::ReportModel& model, const StudyFolder& folder, Summary& summary) {
    tables.written.emplace_back("report.json", reports::to_json(model));
    tables.written.emplace_back("report.html", reports::render_html(model));
    tables.dropped.emplace_back("analysis.json");  // report.json has the same of these tables
    folder.write_together(tables);
    write_figures(model, folder);
    summarise(model, summary);
    summary.data["report"] = (folder.path() / "report.html").string();
    summary.lines.push_back("Report: " + (folder.path() / "report.html").string());
}

}  // namespace morphodesic::pipeline

// geodesic A B: one pair.
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "datasets/solid_reader.h"
#include "geodesic/solver/canonical_frame.h"
#include "geodesic/solver/path_interpolation.h"
#include "pipeline/collection.h"
#include "pipeline/commands.h"
#include "pipeline/commands/summary.h"
#include "pipeline/figures/pair_pictures.h"
#include "pipeline/pair_graph.h"
#include "pipeline/path_files.h"
#include "pipeline/solid_paths.h"
#include "pipeline/stop_signals.h"
#include "pipeline/study_folder.h"
#include "pipeline/wanted_pairs.h"

namespace morphodesic::pipeline {
namespace {

constexpr const char* result_file = "geodesic.json";

/// Removes the pictures of the geodesic that was drawn here before: it may have had more steps.
void remove_former_pictures(const std::filesystem::path& folder) {
    std::ifstream in(folder / result_file);
    if (!in) return;
    const auto former = nlohmann::json::parse(in, nullptr, false);
    if (!former.is_object() || !former.contains("pictures") || !former["pictures"].is_array()) return;
    for (const auto& entry : former["pictures"]) {
        if (!entry.is_string()) continue;
        const std::filesystem::path name = entry.get<std::string>();
        std::error_code ignored;
        if (name == name.filename()) std::filesystem::remove(folder / name, ignored);
    }
}

template <int Dim>
ImportedShape<Dim> placed(const datasets::RawShape<Dim>& raw, const datasets::NormalizeOptions& placement) {
    ImportedShape<Dim> result;
    result.row.name = raw.source.path.string();
    result.row.extent_radius = raw.extent_radius;
    take_shape(result, datasets::normalize(raw, placement));
    return result;
}

/// Frames, solids and, of a good path, the picture of the pair. Returns the names of the files.
/// @param last  name of the file of the last shape
template <int Dim>
std::vector<std::string> write_pictures(const StudyFolder& folder, const GeodesicResult<Dim>& path,
                                        const std::string& last, bool is_good) {
    SolidView view;
    if constexpr (Dim == 3) view = view_of_path(path, last);
    std::vector<std::string> files = write_path_files(folder, "", draw_path(path, view));
    if constexpr (Dim == 3) {
        const std::vector<std::string> solids = write_path_solids(folder, "", path);
        files.insert(files.end(), solids.begin(), solids.end());
    }
    if (is_good) {
        for (std::string& name : write_pair_pictures(folder.path(), path, view)) files.push_back(std::move(name));
    }
    return files;
}

/// Whether the path is computed from b to a, as a study would.
template <int Dim>
bool is_backward(const PairOptions& options, const ImportedShape<Dim>& a, const ImportedShape<Dim>& b) {
    if (options.direction == "given") return false;
    const auto end = [](const ImportedShape<Dim>& shape) {
        return DifferentShapes::value_type(shape.row.content_digest, traits_of(shape.row, shape.mask != nullptr));
    };
    return oriented_pair(end(a), end(b)).first != a.row.content_digest;
}

template <int Dim>
int solve(const PairOptions& options, const datasets::ShapeSource& source_a, const datasets::ShapeSource& source_b) {
    if (options.scale > 0 && options.settings.normalize != "common") {
        throw std::invalid_argument("--scale is the common scale of both shapes, and --normalize " +
                                    options.settings.normalize + " has none; leave one of them out");
    }
    const auto raw_a = datasets::read_shape<Dim>(source_a, options.settings.import);
    const auto raw_b = datasets::read_shape<Dim>(source_b, options.settings.import);
    datasets::NormalizeOptions placement;
    placement.mode = options.settings.normalize;
    placement.level = shape_level(Dim, options.settings.geodesic);
    placement.solved_level = options.settings.geodesic.level;
    if (placement.mode == "common") {
        const double radii[] = {raw_a.extent_radius, raw_b.extent_radius};
        const double fits = datasets::common_scale(radii);
        placement.scale = options.scale > 0 ? options.scale : fits;
        if (placement.scale > fits * (1 + 1e-12)) {
            throw std::invalid_argument("at --scale " + std::to_string(options.scale) +
                                        " a shape does not fit into the cube; the largest scale is " +
                                        std::to_string(fits));
        }
    }
    const std::string warning = placement.mode == "common"
                                    ? size_warning({{source_a.path.string(), raw_a.extent_radius},
                                                    {source_b.path.string(), raw_b.extent_radius}})
                                    : "";
    if (!warning.empty()) std::cerr << "morphodesic: " << warning << "\n";
    const auto a = placed<Dim>(raw_a, placement), b = placed<Dim>(raw_b, placement);
    const bool backward = is_backward(options, a, b);
    const auto &from = backward ? b : a, &to = backward ? a : b;
    GeodesicResult<Dim> path;
    StoredGeodesic result = solve_pair<Dim>(
        from, to, options.settings.geodesic, [] { return StopSignals::caught() != 0; }, &path);
    if (StopSignals::caught() != 0) return stopped_by_signal("; nothing was written");
    if (backward) result = reversed(std::move(result));

    Summary summary;
    summary.data = to_json(result);
    if (to.mask) {
        summary.add_remark(
            to.row.name +
            ": what is hidden of it counts as if it were not there; of a path the shape that it is computed from may "
            "be partly hidden" +
            (from.mask ? "." : ", so give this one first."));
    }
    summary.data["a"] = a.row.name;
    summary.data["b"] = b.row.name;
    summary.data["path_from"] = from.row.name;
    summary.data["notes_a"] = a.row.notes;
    summary.data["notes_b"] = b.row.notes;
    for (const auto* shape : {&a, &b}) {
        for (const std::string& note : shape->row.notes) summary.lines.push_back(shape->row.name + ": " + note);
    }
    const std::string problem = result.problem();
    if (!problem.empty()) {
        summary.add_failures({{a.row.name, b.row.name, problem}});
    } else {
        char text[256];
        std::snprintf(text, sizeof text,
                      "path length   %.6g (error bar %.2g)\npath energy   %.6g\nmin det       %.4g (guaranteed: 1-1, "
                      "nothing shrinks to less than that share)\n"
                      "termination   %s after %s\n"
                      "computed from ",
                      result.path_length, result.error, result.path_energy, result.min_det,
                      to_string(result.termination), duration_text(result.seconds).c_str());
        summary.lines.emplace_back(text + from.row.name);
    }
    if (!options.out.empty()) {
        const StudyFolder folder(options.out);
        folder.create();
        const StudyLock lock(folder);
        remove_former_pictures(folder.path());
        if (!path.shapes.empty()) path = in_pose_of_last(backward ? reversed(std::move(path)) : std::move(path));
        const std::vector<std::string> files = path.shapes.empty()
                                                   ? std::vector<std::string>{}
                                                   : write_pictures(folder, path, b.row.name, problem.empty());
        summary.data["pictures"] = files;
        folder.write(result_file, summary.data.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
        summary.lines.push_back(!files.empty()    ? "pictures      " + folder.path().string()
                                : problem.empty() ? "no pictures: the two shapes are equal"
                                                  : "no pictures: there is no path");
    }
    return summary.print(options.common);
}

}  // namespace

int geodesic(const PairOptions& options) {
    const auto threads = static_cast<std::size_t>(thread_count(options.common));
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    if (!options.out.empty()) StudyFolder(options.out).refuse_if_foreign();  // before the work, not after it
    const datasets::ShapeSource a = datasets::single_source(options.a), b = datasets::single_source(options.b);
    if (a.dimension != b.dimension) {
        throw std::invalid_argument("one of the two shapes is 2D and the other 3D; give two of a kind");
    }
    const std::string& dimension = options.settings.dimension;
    if (dimension != "auto" && dimension != std::to_string(a.dimension)) {
        std::cerr << "morphodesic: --dimension " << dimension << " has no effect: both files are "
                  << (a.dimension == 2 ? "images" : "solids") << "\n";
    }
    if (options.settings.labels != "auto") {
        std::cerr << "morphodesic: --labels has no effect: of one pair no classes are asked\n";
    }
    if (const std::string remark = datasets::mirror_remark(options.settings.import.mirror, {a, b}); !remark.empty()) {
        std::cerr << "morphodesic: " << remark << "\n";
    }
    tbb::task_arena arena(static_cast<int>(threads));
    return arena.execute(
        [&] { return with_dimension(a.dimension, [&]<int Dim>() { return solve<Dim>(options, a, b); }); });
}

}  // namespace morphodesic::pipeline

#include "pipeline/classify_templates.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

#include "pipeline/collection.h"
#include "pipeline/result_store.h"
#include "pipeline/study_folder.h"
#include "pipeline/whole_tasks.h"

namespace morphodesic::pipeline {
namespace {

namespace fs = std::filesystem;

template <int Dim>
ComparedShape<Dim> compared(datasets::Shape<Dim> shape) {
    return {std::move(shape.name),      std::move(shape.label),          std::move(shape.digest),
            std::move(shape.level_set), std::move(shape.occlusion_mask), shape.volume,
            std::move(shape.notes)};
}

/// The shapes of a study are as they were read and placed: other options would be said and not done.
void expect_reading_of_study(const fs::path& folder, const RunSettings& study, const RunSettings& wanted,
                             int dimension) {
    datasets::ImportOptions reading = wanted.import;  // queries have an occluder and a border of their own
    reading.occluder = study.import.occluder;
    reading.border = study.import.border;
    if (canonical_text(reading) == canonical_text(study.import) && wanted.normalize == study.normalize &&
        wanted.labels == study.labels &&
        (wanted.dimension == "auto" || wanted.dimension == std::to_string(dimension))) {
        return;
    }
    throw std::invalid_argument(folder.string() +
                                ": is a study, whose shapes are read and placed already; leave out options such as "
                                "--normalize, --foreground, --labels and --dimension, or take the folder it was made "
                                "from as templates");
}

template <int Dim>
TemplateSet<Dim> from_store(const fs::path& folder, const RunSettings& wanted) {
    const ResultStore store(StudyFolder(folder).store(), ResultStore::Access::read);
    const RunSettings settings = settings_of_study(store);
    expect_reading_of_study(folder, settings, wanted, Dim);
    TemplateSet<Dim> set;
    set.import = settings.import;
    set.placement.mode = settings.normalize;
    set.placement.level = std::max(shape_level(Dim, settings.geodesic), shape_level(Dim, wanted.geodesic));
    set.placement.solved_level = wanted.geodesic.level;
    if (const auto scale = store.fact("common_scale"); scale && settings.normalize == "common") {
        std::from_chars(scale->data(), scale->data() + scale->size(), set.placement.scale);
    }
    for (const StoredShape& row : store.shapes()) {
        if (!row.problem.empty() || row.content_digest.empty()) {
            set.problems.push_back(row.problem.empty() ? row.name + ": not read yet" : row.problem);
            continue;
        }
        ComparedShape<Dim> shape;
        shape.name = row.name;
        shape.label = row.label;
        shape.digest = row.content_digest;
        shape.volume = row.volume;
        shape.notes = row.notes;
        shape.level_set = store.level_set<Dim>(row.content_digest, &shape.mask);
        if (shape.level_set.grid.level() < wanted.geodesic.level) {
            throw std::invalid_argument(folder.string() + ": its shapes are stored on level " +
                                        std::to_string(shape.level_set.grid.level()) +
                                        "; choose that --level, or take the folder of the files as templates");
        }
        set.placement.level = shape.level_set.grid.level();
        set.shapes.push_back(std::make_shared<const ComparedShape<Dim>>(std::move(shape)));
    }
    return set;
}

template <int Dim>
TemplateSet<Dim> from_files(const fs::path& folder, const RunSettings& settings) {
    datasets::ScanResult scan = datasets::scan_folder(folder, {settings.labels});
    TemplateSet<Dim> set;
    set.import = settings.import;
    set.placement.mode = settings.normalize;
    set.placement.level = shape_level(Dim, settings.geodesic);
    set.placement.solved_level = settings.geodesic.level;
    set.remarks = scan.notes;
    for (const auto& problem : scan.problems) set.problems.push_back(problem.message());
    choose_dimension(folder, settings.dimension, scan.sources, set.problems, set.remarks);
    const std::size_t count = scan.sources.size();
    std::vector<std::optional<datasets::RawShape<Dim>>> raw(count);
    std::vector<std::string> problems(count);
    for_each_whole(count, [&](std::size_t i) {
        try {
            raw[i] = datasets::read_shape<Dim>(scan.sources[i], settings.import);
        } catch (const std::exception&) {
            problems[i] = problem_of_file(scan.sources[i].path.string(), " to read it; use a smaller file");
        }
    });
    if (settings.normalize == "common") {
        std::vector<double> radii;
        for (const auto& shape : raw) {
            if (shape) radii.push_back(shape->extent_radius);
        }
        if (!radii.empty()) set.placement.scale = datasets::common_scale(radii);
    }
    std::vector<std::shared_ptr<const ComparedShape<Dim>>> shapes(count);
    for_each_whole(count, [&](std::size_t i) {
        if (!raw[i]) return;
        try {
            shapes[i] =
                std::make_shared<const ComparedShape<Dim>>(compared(datasets::normalize(*raw[i], set.placement)));
        } catch (const std::exception&) {
            problems[i] = problem_of_file(scan.sources[i].path.string(), " to read it; use a smaller file");
        }
    });
    for (std::size_t i = 0; i < count; ++i) {
        if (shapes[i]) set.shapes.push_back(shapes[i]);
        if (!problems[i].empty()) set.problems.push_back(problems[i]);
    }
    return set;
}

}  // namespace

bool is_study(const fs::path& folder) {
    return fs::exists(StudyFolder(folder).store());
}

int template_dimension(const fs::path& folder, const RunSettings& settings) {
    if (is_study(folder)) {
        return ResultStore(StudyFolder(folder).store(), ResultStore::Access::glance).fact("dimension") == "3" ? 3 : 2;
    }
    std::vector<std::string> ignored;  // said where they are read
    auto sources = datasets::scan_folder(folder, {settings.labels}).sources;
    return choose_dimension(folder, settings.dimension, sources, ignored, ignored);
}

template <int Dim>
TemplateSet<Dim> load_templates(const fs::path& folder, const RunSettings& settings) {
    TemplateSet<Dim> set = is_study(folder) ? from_store<Dim>(folder, settings) : from_files<Dim>(folder, settings);
    if (set.shapes.empty()) {
        throw std::invalid_argument(folder.string() + ": holds no shape that can be a template" +
                                    (set.problems.empty() ? "" : "; " + set.problems.front()));
    }
    std::sort(set.shapes.begin(), set.shapes.end(), [](const auto& a, const auto& b) { return a->name < b->name; });
    const auto unlabelled =
        std::count_if(set.shapes.begin(), set.shapes.end(), [](const auto& s) { return s->label.empty(); });
    if (unlabelled == static_cast<std::ptrdiff_t>(set.shapes.size())) {
        throw std::invalid_argument(folder.string() +
                                    ": the templates have no classes; put them into one folder per "
                                    "class, or write labels.csv (file,label)");
    }
    if (unlabelled > 0) {
        set.remarks.push_back(std::to_string(unlabelled) + " templates have no class and are never an answer.");
    }
    const auto hidden =
        std::count_if(set.shapes.begin(), set.shapes.end(), [](const auto& s) { return !s->mask.values.empty(); });
    if (hidden > 0) {
        set.remarks.push_back(std::to_string(hidden) +
                              " templates are partly hidden themselves; they are taken as what is visible of them.");
    }
    return set;
}

namespace {

/// Read on a finer grid than the templates where less of the contour than this is known for sure: a scan of which more
/// than 30 % would be new surface is refused, so the rest is lost to the rim of the mask, which is a few cells wide.
constexpr double least_visible = 0.6;
/// The finest grid that alignments look at.
constexpr int alignment_level = 6;

/// Nodes inside along the longest axis.
template <int Dim>
int cells_long(const LevelSet<Dim>& u) {
    std::array<int, Dim> low, high;
    low.fill(u.grid.nodes_per_axis());
    high.fill(-1);
    for (std::size_t i = 0; i < u.values.size(); ++i) {
        if (u.values[i] <= 0) continue;
        const auto node = u.grid.node(i);
        for (std::size_t a = 0; a < Dim; ++a) {
            low[a] = std::min(low[a], node[a]);
            high[a] = std::max(high[a], node[a]);
        }
    }
    int longest = 0;
    for (std::size_t a = 0; a < Dim; ++a) longest = std::max(longest, high[a] - low[a] + 1);
    return longest;
}

/// @param cells  of the templates' grid along the query
template <int Dim>
[[noreturn]] void refuse_as_hidden(const datasets::ShapeSource& source, const TemplateSet<Dim>& templates, int cells) {
    if (Dim == 2) {
        throw datasets::ReadError(source.path, "all of its contour is hidden, or so near the mask that nothing is sure",
                                  "let the mask leave a part of the contour visible, or use a finer --level");
    }
    throw datasets::ReadError(
        source.path,
        "too small on the grid of the templates: it is " + std::to_string(cells) + (cells == 1 ? " cell" : " cells") +
            " long, and what is left of its surface lies so near its openings that nothing is sure",
        "use a finer --level" + std::string(templates.placement.mode == "each" ? "" : ", --normalize each") +
            " or templates of its own size");
}

}  // namespace

template <int Dim>
double visible_contour(const LevelSet<Dim>& u, const ScalarField<Dim>& mask) {
    if (mask.values.empty()) return 1.0;
    std::size_t all = 0, visible = 0;
    for (std::size_t i = 0; i < u.values.size(); ++i) {
        const auto node = u.grid.node(i);
        for (std::size_t a = 0; a < Dim; ++a) {
            auto next = node;
            if (++next[a] == u.grid.nodes_per_axis()) continue;
            const std::size_t j = u.grid.index(next);
            const double v = u.values[i], w = u.values[j];
            if ((v > 0) == (w > 0)) continue;
            const double where = v / (v - w);
            ++all;
            visible += (1 - where) * mask.values[i] + where * mask.values[j] > 0.95 ? 1 : 0;
        }
    }
    return all > 0 ? static_cast<double>(visible) / static_cast<double>(all) : 0.0;
}

template <int Dim>
ComparedShape<Dim> load_query(const datasets::ShapeSource& source, const TemplateSet<Dim>& templates,
                              const datasets::ImportOptions& import, bool ignore_mask) {
    datasets::ShapeSource file = source;
    datasets::ImportOptions reading = import;
    if (ignore_mask) {
        file.mask_path.clear();
        reading.border = "free";
    }
    const datasets::RawShape<Dim> raw = datasets::read_shape<Dim>(file, reading);
    datasets::NormalizeOptions placement = templates.placement;
    ComparedShape<Dim> query;
    int cells = 0;  // on the grid of the templates
    for (;; ++placement.level) {
        const bool finest = Dim == 2 || placement.level >= alignment_level;
        try {
            query = compared(datasets::normalize(raw, placement));
        } catch (const datasets::ReadError&) {  // less than a cell of the grid, or none of its nodes
            if (finest) throw;
            continue;
        }
        const bool nothing_hidden =
            std::all_of(query.mask.values.begin(), query.mask.values.end(), [](double chi) { return chi > 0.99; });
        if (ignore_mask || nothing_hidden) query.mask = {};
        const int finer = placement.level - templates.placement.level;
        if (cells == 0) cells = std::max(1, cells_long(query.level_set) >> finer);
        if (finest || visible_contour(query.level_set, query.mask) >= least_visible) break;
    }
    if (visible_contour(query.level_set, query.mask) == 0.0) refuse_as_hidden<Dim>(source, templates, cells);
    if (placement.level > templates.placement.level) {
        query.notes.push_back("Only " + std::to_string(cells) +
                              " cells long on the grid of the templates: read on level " +
                              std::to_string(placement.level) + ", so that what is hidden is not too wide.");
    }
    return query;
}

template TemplateSet<2> load_templates<2>(const fs::path&, const RunSettings&);
template TemplateSet<3> load_templates<3>(const fs::path&, const RunSettings&);
template double visible_contour<2>(const LevelSet<2>&, const ScalarField<2>&);
template double visible_contour<3>(const LevelSet<3>&, const ScalarField<3>&);
template ComparedShape<2> load_query<2>(const datasets::ShapeSource&, const TemplateSet<2>&,
                                        const datasets::ImportOptions&, bool);
template ComparedShape<3> load_query<3>(const datasets::ShapeSource&, const TemplateSet<3>&,
                                        const datasets::ImportOptions&, bool);

}  // namespace morphodesic::pipeline

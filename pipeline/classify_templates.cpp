#include "pipeline/classify_templates.h"

#include <algorithm>
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

template <int Dim>
TemplateSet<Dim> from_store(const fs::path& folder, const RunSettings& wanted) {
    const ResultStore store(StudyFolder(folder).store(), ResultStore::Access::read);
    const RunSettings settings = settings_of_study(store);
    TemplateSet<Dim> set;
    set.import = settings.import;
    set.placement.mode = settings.normalize;
    set.placement.level = std::max(shape_level(Dim, settings.geodesic), shape_level(Dim, wanted.geodesic));
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
    set.remarks = scan.notes;
    for (const auto& problem : scan.problems) set.problems.push_back(problem.message());
    std::erase_if(scan.sources, [&](const datasets::ShapeSource& source) {
        if (source.dimension == Dim) return false;
        set.problems.push_back(source.path.string() +
                               ": is of another dimension than the other templates; put the "
                               "two kinds into folders of their own");
        return true;
    });
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
        return ResultStore(StudyFolder(folder).store(), ResultStore::Access::read).fact("dimension") == "3" ? 3 : 2;
    }
    const auto sources = datasets::scan_folder(folder, {settings.labels}).sources;
    const auto solids = std::count_if(sources.begin(), sources.end(), [](const auto& s) { return s.dimension == 3; });
    return 2 * static_cast<std::size_t>(solids) > sources.size() ? 3 : 2;
}

template <int Dim>
TemplateSet<Dim> load_templates(const fs::path& folder, const RunSettings& settings) {
    if (!fs::is_directory(folder)) {
        throw std::invalid_argument(folder.string() + (fs::exists(folder)
                                                           ? ": is a file; --templates wants a folder of "
                                                             "shapes or a study"
                                                           : ": there is no such folder of templates"));
    }
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

template <int Dim>
ComparedShape<Dim> load_query(const datasets::ShapeSource& source, const TemplateSet<Dim>& templates,
                              const datasets::ImportOptions& import, bool ignore_mask) {
    datasets::ShapeSource file = source;
    datasets::ImportOptions reading = import;
    if (ignore_mask) {
        file.mask_path.clear();
        reading.border = "free";
    }
    ComparedShape<Dim> query = compared(datasets::import_shape<Dim>(file, reading, templates.placement));
    if (ignore_mask) query.mask = {};
    const bool nothing_hidden =
        std::all_of(query.mask.values.begin(), query.mask.values.end(), [](double chi) { return chi > 0.99; });
    if (nothing_hidden) query.mask = {};
    return query;
}

template TemplateSet<2> load_templates<2>(const fs::path&, const RunSettings&);
template TemplateSet<3> load_templates<3>(const fs::path&, const RunSettings&);
template ComparedShape<2> load_query<2>(const datasets::ShapeSource&, const TemplateSet<2>&,
                                        const datasets::ImportOptions&, bool);
template ComparedShape<3> load_query<3>(const datasets::ShapeSource&, const TemplateSet<3>&,
                                        const datasets::ImportOptions&, bool);

}  // namespace morphodesic::pipeline

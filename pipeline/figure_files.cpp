#include "pipeline/figure_files.h"

#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include "pipeline/whole_tasks.h"
#include "reports/figures.h"

namespace morphodesic::pipeline {
namespace {

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// A name that only the report gives; whatever else lies in the folder is the user's.
bool is_figure(const fs::path& file) {
    const std::string ending = file.extension().string(), name = file.stem().string();
    if (ending != ".svg" && ending != ".pdf" && ending != ".png") return false;
    for (const char* beginning : {"path_", "dendrogram_", "embedding_", "shepard_"}) {
        if (name.rfind(beginning, 0) == 0) return true;
    }
    return std::set<std::string>{"heat_map", "graph", "page", "precision_recall", "volume_dendrogram", "compare"}
        .contains(name);
}

}  // namespace

void write_figures(const reports::ReportModel& model, const StudyFolder& folder) {
    const std::vector<reports::Figure> figures = reports::figures(model);
    const fs::path below = "figures", place = folder.path() / below;
    std::set<std::string> names;
    for (const reports::Figure& figure : figures) names.insert(figure.name);
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(place, ignored)) {
        const fs::path file = entry.path();
        if (is_figure(file) && !names.contains(file.stem().string())) fs::remove(file, ignored);
    }
    const auto file = [&](const reports::Figure& figure, const char* ending) { return below / (figure.name + ending); };
    // What an earlier report left goes before anything is written: none of it may stand beside the new figures.
    std::vector<const reports::Figure*> changed;
    for (const reports::Figure& figure : figures) {
        const fs::path pdf = folder.path() / file(figure, ".pdf"), png = folder.path() / file(figure, ".png"),
                       svg = folder.path() / file(figure, ".svg");
        if (fs::exists(pdf) && fs::exists(png) && fs::is_regular_file(svg) && bytes_of(svg) == figure.svg) continue;
        for (const fs::path& old : {svg, pdf, png}) fs::remove(old, ignored);
        changed.push_back(&figure);
    }
    for_each_whole(changed.size(), [&](std::size_t k) {
        const reports::Figure& figure = *changed[k];
        folder.write(file(figure, ".pdf"), reports::svg_to_pdf(figure.svg));
        folder.write(file(figure, ".png"), reports::svg_to_png(figure.svg, 0, 2.0));
        folder.write(file(figure, ".svg"), figure.svg);  // last: it says that all three are there
    });
}

}  // namespace morphodesic::pipeline

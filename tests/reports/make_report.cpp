/// Writes a synthetic report and its figures for looking at: make_report FOLDER [shapes classes paths labelled(0|1)]
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "reports/figures.h"
#include "reports/report.h"
#include "tests/reports/synthetic_model.h"

int main(int argc, char** argv) {
    using namespace morphodesic;
    tests::SyntheticStudy study;
    if (argc < 2) return 2;
    if (argc > 2) study.shapes = std::atoi(argv[2]);
    if (argc > 3) study.classes = std::atoi(argv[3]);
    if (argc > 4) study.paths = std::atoi(argv[4]);
    if (argc > 5) study.labelled = std::atoi(argv[5]) != 0;
    const std::filesystem::path folder = argv[1];
    std::filesystem::create_directories(folder);
    const auto model = tests::synthetic_model(study);
    std::ofstream(folder / "report.html", std::ios::binary) << reports::render_html(model);
    std::ofstream(folder / "report.json", std::ios::binary) << reports::to_json(model);
    for (const auto& f : reports::figures(model)) {
        std::ofstream(folder / (f.name + ".svg"), std::ios::binary) << f.svg;
        std::ofstream(folder / (f.name + ".png"), std::ios::binary) << reports::svg_to_png(f.svg, 0);
        std::ofstream(folder / (f.name + ".pdf"), std::ios::binary) << reports::svg_to_pdf(f.svg);
    }
}

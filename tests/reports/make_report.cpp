/// Writes a synthetic report for looking at: make_report OUTPUT.html [shapes classes paths labelled(0|1)]
#include <cstdlib>
#include <fstream>

#include "reports/report.h"
#include "tests/reports/synthetic_model.h"

int main(int argc, char** argv) {
    morphodesic::tests::SyntheticStudy study;
    if (argc > 2) study.shapes = std::atoi(argv[2]);
    if (argc > 3) study.classes = std::atoi(argv[3]);
    if (argc > 4) study.paths = std::atoi(argv[4]);
    if (argc > 5) study.labelled = std::atoi(argv[5]) != 0;
    if (argc < 2) return 2;
    std::ofstream(argv[1], std::ios::binary)
        << morphodesic::reports::render_html(morphodesic::tests::synthetic_model(study));
}

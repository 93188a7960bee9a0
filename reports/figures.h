#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "reports/report_model.h"

namespace morphodesic::reports {

/// A figure for print: a complete SVG 1.1 document on a white background, pictures included.
struct Figure {
    std::string name;  ///< file name without ending, e.g. "heat_map"
    std::string title;
    std::string svg;
};

/// Every figure that the model has data for: heat_map, dendrogram_<method>, embedding_<dim>d, graph, shepard_<dim>d,
/// precision_recall, page (up to 12 shapes: graph and matrix with pictures), path_<a>_<b>, volume_dendrogram, compare.
/// @throws std::invalid_argument with the first of problems(model), if any
[[nodiscard]] std::vector<Figure> figures(const ReportModel& model);

/// A filmstrip of one path as SVG.
[[nodiscard]] std::string path_figure(const ReportModel& model, const PathReport& path);

/// SVG to the bytes of a PNG (width in pixels; 0: the natural size, times scale) or a one-page PDF.
/// @throws std::runtime_error if the SVG cannot be read or drawn
[[nodiscard]] std::string svg_to_png(const std::string& svg, int width = 0, double scale = 1.0);
[[nodiscard]] std::string svg_to_pdf(const std::string& svg);

}  // namespace morphodesic::reports

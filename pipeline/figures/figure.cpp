#include "pipeline/figures/figure.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "datasets/csv_rows.h"

namespace morphodesic::pipeline {
namespace {

std::string line(const std::vector<std::string>& cells) {
    std::string text;
    for (std::size_t i = 0; i < cells.size(); ++i) text += (i > 0 ? "," : "") + datasets::csv_field(cells[i]);
    return text + "\n";
}

}  // namespace

std::string FigureTable::csv() const {
    std::string text = line(columns);
    for (const auto& row : rows) text += line(row);
    return text;
}

std::string exact(double value) {
    if (!std::isfinite(value)) return {};
    std::array<char, 40> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value);
    return {text.data(), end.ptr};
}

std::string rounded(double value, int digits) {
    std::array<char, 40> text{};
    std::snprintf(text.data(), text.size(), "%.*g", digits, value);
    return text.data();
}

GeodesicOptions FigureOptions::geodesic(int dimension) const {
    GeodesicOptions o;
    o.level = dimension == 2 ? (quick ? 5 : 7) : (quick ? 5 : 6);
    o.time_steps = quick ? (dimension == 2 ? 4 : 2) : 8;
    o.tolerance = quick ? 3e-3 : 1e-3;
    if (dimension == 3) o.tolerance = quick ? 1e-2 : 3e-3;
    o.align = "none";
    return o;
}

}  // namespace morphodesic::pipeline

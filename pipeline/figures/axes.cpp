#include "pipeline/figures/axes.h"

#include <algorithm>
#include <cmath>

#include "pipeline/figures/figure.h"

namespace morphodesic::pipeline {

void plot(reports::Svg& svg, const reports::Scale& x, const reports::Scale& y, const Series& series,
          const std::string& colour) {
    Series places;
    for (const auto& [a, b] : series) places.emplace_back(x(a), y(b));
    svg.polyline(places, colour, 2);
    for (const auto& [px, py] : places) svg.circle(px, py, 3.2, colour, "#ffffff", 1);
}

void draw_log2_axes(reports::Svg& svg, const reports::Scale& x, const reports::Scale& y, const std::string& x_title,
                    const std::string& y_title, const std::function<std::string(int)>& name) {
    for (int e = static_cast<int>(std::ceil(x.low)); e <= x.high; ++e) {
        svg.line(x(e), y.from, x(e), y.to, "#e6e9ee");
        svg.text(x(e), y.from + 12, name(e), 10, "middle");
    }
    for (const double v : reports::ticks(y.low, y.high, 5)) {
        svg.line(x.from, y(v), x.to, y(v), "#e6e9ee");
        svg.text(x.from - 6, y(v), rounded(v, 3), 10, "end");
    }
    svg.line(x.from, y.from, x.to, y.from, "#8b95a3");
    svg.line(x.from, y.from, x.from, y.to, "#8b95a3");
    svg.text((x.from + x.to) / 2, y.from + 30, x_title, 12, "middle");
    svg.vertical_text(x.from - 46, (y.from + y.to) / 2, y_title, 12);
}

std::pair<double, double> range_of(const std::vector<Series>& all) {
    double low = 1e300, high = -1e300;
    for (const Series& series : all) {
        for (const auto& [x, y] : series) {
            low = std::min(low, y);
            high = std::max(high, y);
        }
    }
    const double margin = 0.1 * std::max(high - low, 1e-6);
    return {low - margin, high + margin};
}

}  // namespace morphodesic::pipeline

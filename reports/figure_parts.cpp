#include "reports/figure_parts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "reports/text.h"

namespace morphodesic::reports {
namespace {

constexpr const char* missing = "#9aa1ab";

bool has_legend(const FigureStudy& s) {
    return s.group_names.size() >= 2 && s.group_names.size() <= 40;
}

/// Places of the entries of the legend, from its first row and column on.
std::vector<std::pair<double, double>> legend_places(const FigureStudy& s, double width) {
    std::vector<std::pair<double, double>> places;
    double x = 0, y = 0;
    for (const std::string& name : s.group_names) {
        const double room = 26 + 6.5 * static_cast<double>(std::count_if(name.begin(), name.end(), starts_letter));
        if (x + room > width && x > 0) x = 0, y += 18;
        places.emplace_back(x, y);
        x += room;
    }
    return places;
}

}  // namespace

bool starts_letter(char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
}

FigureStudy::FigureStudy(const ReportModel& model) : m(model), n(model.shapes.size()) {
    for (const double d : m.distances) {
        if (std::isfinite(d)) top = std::max(top, d);
    }
    pictured = std::any_of(m.shapes.begin(), m.shapes.end(), [](const auto& s) { return !s.thumbnail.bytes.empty(); });
    std::map<std::string, int> numbers;
    for (const auto& s : m.shapes) numbers[s.label];
    const bool by_class = numbers.size() > 1 && numbers.size() < n;
    int next = 0;
    for (auto& [label, number] : numbers) number = next++;
    for (std::size_t i = 0; i < n; ++i) {
        group.push_back(by_class                ? numbers[m.shapes[i].label]
                        : m.clusterings.empty() ? 0
                                                : m.clusterings[0].assignment[i]);
    }
    if (by_class) {
        for (const auto& [label, number] : numbers) group_names.push_back(label.empty() ? "no class" : label);
    } else {
        const int groups = group.empty() ? 0 : *std::max_element(group.begin(), group.end()) + 1;
        for (int k = 0; k < groups; ++k) group_names.push_back("cluster " + std::to_string(k + 1));
    }
}

double FigureStudy::distance(std::size_t i, std::size_t j) const {
    if (i == j) return 0.0;
    if (i > j) std::swap(i, j);
    return m.distances[n * i - i * (i + 1) / 2 + j - i - 1];
}

std::string FigureStudy::short_name(std::size_t i) const {
    const std::string& name = m.shapes[i].name;
    const std::size_t slash = name.rfind('/'), start = slash == std::string::npos ? 0 : slash + 1,
                      dot = name.rfind('.');
    std::string result =
        valid_utf8(name.substr(start, dot != std::string::npos && dot > start ? dot - start : std::string::npos));
    std::size_t letters = 0, end = 0;
    for (; end < result.size() && letters < 22; ++end) {
        if (starts_letter(result[end])) ++letters;
    }
    while (end < result.size() && !starts_letter(result[end])) ++end;
    return end < result.size() ? result.substr(0, end) + "…" : result;
}

std::vector<std::size_t> FigureStudy::order() const {
    std::vector<std::size_t> result(n);
    std::iota(result.begin(), result.end(), std::size_t{0});
    if (!m.linkages.empty())
        std::copy(m.linkages[0].leaf_order.begin(), m.linkages[0].leaf_order.end(), result.begin());
    return result;
}

double legend_height(const FigureStudy& s, double width) {
    return has_legend(s) ? legend_places(s, width).back().second + 18 : 0.0;
}

void draw_legend(Svg& svg, const FigureStudy& s, double x, double y, double width) {
    if (!has_legend(s)) return;
    const auto places = legend_places(s, width);
    for (std::size_t k = 0; k < places.size(); ++k) {
        const double left = x + places[k].first, middle = y + places[k].second;
        svg.circle(left + 5, middle, 5, group_colour(static_cast<int>(k), static_cast<int>(places.size())));
        svg.text(left + 14, middle, s.group_names[k]);
    }
}

void draw_tree(Svg& svg, const LinkageTree& tree, double cell, double height) {
    const std::size_t n = tree.leaf_order.size();
    std::vector<double> x(2 * n), y(2 * n, 0.0);
    for (std::size_t k = 0; k < n; ++k)
        x[static_cast<std::size_t>(tree.leaf_order[k])] = (static_cast<double>(k) + 0.5) * cell;
    double top = 0;
    for (const auto& merge : tree.merges) top = std::max(top, merge.height);
    const Scale up{0, top > 0 ? top : 1, height, 0};
    for (const double v : ticks(0, up.high, 3)) {
        svg.line(-8, up(v), -4, up(v), "#8b95a3");
        svg.text(-11, up(v), short_number(v), 10, "end");
    }
    svg.line(-4, height, -4, 0, "#8b95a3");
    svg.vertical_text(-44, height / 2, "height", 11);
    const double thickness = n > 150 ? 0.6 : 1.3;
    for (std::size_t row = 0; row < tree.merges.size(); ++row) {
        const auto p = static_cast<std::size_t>(tree.merges[row].first),
                   q = static_cast<std::size_t>(tree.merges[row].second);
        const double h = tree.merges[row].height;
        svg.polyline({{x[p], up(y[p])}, {x[p], up(h)}, {x[q], up(h)}, {x[q], up(y[q])}}, ink, thickness);
        x[n + row] = (x[p] + x[q]) / 2;
        y[n + row] = h;
    }
}

void draw_colour_bar(Svg& svg, double x, double y, double width, double top, const std::string& title) {
    svg.text(x, y, title);
    for (int k = 0; k < 64; ++k) svg.rect(x + k * width / 64, y + 10, width / 64 + 0.5, 10, viridis((k + 0.5) / 64));
    const Scale scale{0, top, x, x + width};
    for (const double v : ticks(0, top, 4)) svg.text(scale(v), y + 29, short_number(v), 10, "middle");
}

void draw_matrix(Svg& svg, const FigureStudy& s, const std::vector<std::size_t>& order, double cell, double side,
                 bool numbers) {
    const double size = cell * static_cast<double>(s.n), top = s.top > 0 ? s.top : 1;
    std::size_t longest = 1;  // number in a cell
    for (std::size_t k = 0; numbers && k < s.m.distances.size(); ++k) {
        if (std::isfinite(s.m.distances[k])) longest = std::max(longest, short_number(s.m.distances[k]).size());
    }
    const double letters = std::min({13.0, cell / 3.6, cell / (0.68 * static_cast<double>(longest))});
    std::vector<std::string> colours;
    for (const std::size_t i : order) {
        for (const std::size_t j : order) {
            const double d = s.distance(i, j);
            colours.push_back(std::isfinite(d) ? viridis(d / top) : missing);
        }
    }
    if (s.n > 60) {
        svg.image(0, 0, size, size, raster_png(static_cast<int>(s.n), static_cast<int>(s.n), colours), true);
    }
    for (std::size_t r = 0; r < s.n; ++r) {
        const double at = static_cast<double>(r) * cell;
        for (std::size_t c = 0; s.n <= 60 && c < s.n; ++c) {
            const double d = s.distance(order[r], order[c]), x = static_cast<double>(c) * cell;
            svg.rect(x, at, cell, cell, colours[r * s.n + c], colours[r * s.n + c]);
            if (numbers && std::isfinite(d)) {
                svg.text(x + cell / 2, at + cell / 2, r == c ? "0" : short_number(d), letters, "middle",
                         d > 0.6 * top ? "#111111" : "#ffffff");
            }
        }
        svg.rect(-7, at, 5, cell, s.colour(order[r]));
        svg.rect(at, -7, cell, 5, s.colour(order[r]));
        if (side > 0) {
            svg.image(-9 - side, at + (cell - side) / 2, side, side, s.m.shapes[order[r]].thumbnail.bytes);
            svg.image(at + (cell - side) / 2, -9 - side, side, side, s.m.shapes[order[r]].thumbnail.bytes);
        }
        if (cell >= 9) svg.text(-14 - side, at + cell / 2, s.short_name(order[r]), std::min(11.0, cell - 1), "end");
    }
}

}  // namespace morphodesic::reports

#include "reports/figures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>
#include <stdexcept>

#include "reports/report.h"
#include "reports/svg.h"
#include "reports/text.h"

namespace morphodesic::reports {
namespace {

constexpr const char* ink = "#1b2430";
constexpr const char* missing = "#9aa1ab";

std::string fixed_number(double value) {
    char buffer[40];
    std::snprintf(buffer, sizeof buffer, value < 0.1 ? "%.4f" : "%.3f", value);
    return buffer;
}

/// What the figures ask of a model.
class Study {
public:
    explicit Study(const ReportModel& model) : m(model), n(model.shapes.size()) {
        for (const double d : m.distances) {
            if (std::isfinite(d)) top = std::max(top, d);
        }
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
    [[nodiscard]] double distance(std::size_t i, std::size_t j) const {
        if (i == j) return 0.0;
        if (i > j) std::swap(i, j);
        return m.distances[n * i - i * (i + 1) / 2 + j - i - 1];
    }
    [[nodiscard]] std::string colour(std::size_t i) const {
        return group_colour(group[i], static_cast<int>(group_names.size()));
    }
    [[nodiscard]] std::string short_name(std::size_t i) const {
        const std::string& name = m.shapes[i].name;
        const std::size_t slash = name.rfind('/'), start = slash == std::string::npos ? 0 : slash + 1,
                          dot = name.rfind('.');
        std::string result =
            valid_utf8(name.substr(start, dot != std::string::npos && dot > start ? dot - start : std::string::npos));
        std::size_t letters = 0, end = 0;
        for (; end < result.size() && letters < 22; ++end) {
            if ((static_cast<unsigned char>(result[end]) & 0xC0U) != 0x80U) ++letters;
        }
        while (end < result.size() && (static_cast<unsigned char>(result[end]) & 0xC0U) == 0x80U) ++end;
        return end < result.size() ? result.substr(0, end) + "…" : result;
    }
    [[nodiscard]] std::vector<std::size_t> order() const {
        std::vector<std::size_t> result(n);
        std::iota(result.begin(), result.end(), std::size_t{0});
        if (!m.linkages.empty())
            std::copy(m.linkages[0].leaf_order.begin(), m.linkages[0].leaf_order.end(), result.begin());
        return result;
    }

    const ReportModel& m;
    std::size_t n;
    double top = 0;
    std::vector<int> group;
    std::vector<std::string> group_names;
};

void draw_legend(Svg& svg, const Study& s, double x, double y, double width) {
    if (s.group_names.size() < 2 || s.group_names.size() > 40) return;
    double at = x;
    for (std::size_t k = 0; k < s.group_names.size(); ++k) {
        const double room = 26 + 6.5 * static_cast<double>(s.group_names[k].size());
        if (at + room > x + width && at > x) at = x, y += 18;
        svg.circle(at + 5, y, 5, group_colour(static_cast<int>(k), static_cast<int>(s.group_names.size())));
        svg.text(at + 14, y, s.group_names[k]);
        at += room;
    }
}

/// Brackets of a tree: leaves at x = (k + 1/2) cell, heights upwards from y = height to 0.
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

/// Cells, pictures and group strips around the origin of the cells.
void draw_matrix(Svg& svg, const Study& s, const std::vector<std::size_t>& order, double cell, double side,
                 bool numbers) {
    const double size = cell * static_cast<double>(s.n), top = s.top > 0 ? s.top : 1;
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
                svg.text(x + cell / 2, at + cell / 2, r == c ? "0" : fixed_number(d), std::min(13.0, cell / 3.6),
                         "middle", d > 0.6 * top ? "#111111" : "#ffffff");
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

Figure heat_map(const Study& s) {
    const double cell = std::clamp(760.0 / static_cast<double>(s.n), 1.0, 64.0), size = cell * static_cast<double>(s.n);
    const double side = cell >= 10 ? std::min(cell - 2, 56.0) : 0, left = 20 + side + (cell >= 9 ? 130 : 50);
    const bool tree = !s.m.linkages.empty() && !s.m.linkages[0].merges.empty();
    const double top = 16 + (tree ? 110 : 0) + side + 12;
    Svg svg(left + size + 20, top + size + 90);
    if (tree) {
        svg.open_group(left, 16);
        draw_tree(svg, s.m.linkages[0], cell, 100);
        svg.close_group();
    }
    svg.open_group(left, top);
    draw_matrix(svg, s, s.order(), cell, side, cell >= 34);
    draw_colour_bar(svg, 0, size + 18, std::min(260.0, std::max(120.0, size)), s.top > 0 ? s.top : 1,
                    "geodesic distance");
    svg.close_group();
    draw_legend(svg, s, left, top + size + 72, size);
    return {"heat_map", "Distance matrix", svg.document("Distance matrix of " + s.m.study)};
}

Figure dendrogram(const Study& s, const LinkageTree& tree, const std::string& name, const std::string& title) {
    const double cell = std::clamp(900.0 / static_cast<double>(s.n), 1.5, 70.0), size = cell * static_cast<double>(s.n);
    const double side = cell >= 10 ? std::min(cell - 2, 60.0) : 0;
    const bool named = cell >= 9;
    Svg svg(size + 90, 240 + side + (named ? 130 : 10) + 40);
    svg.open_group(64, 16);
    draw_tree(svg, tree, cell, 200);
    for (std::size_t k = 0; k < s.n; ++k) {
        const auto i = static_cast<std::size_t>(tree.leaf_order[k]);
        const double x = (static_cast<double>(k) + 0.5) * cell;
        svg.rect(x - cell / 2 + 0.5, 203, std::max(1.0, cell - 1), 5, s.colour(i));
        if (side > 0) svg.image(x - side / 2, 211, side, side, s.m.shapes[i].thumbnail.bytes);
        if (named) svg.vertical_text(x, 216 + side, s.short_name(i), std::min(11.0, cell - 1), "end");
    }
    svg.close_group();
    draw_legend(svg, s, 64, 240 + side + (named ? 140 : 10), size);
    return {name, title, svg.document(title + " of " + s.m.study)};
}

struct Layout {
    std::vector<double> x, y, depth;
    double width = 0, height = 0;
    std::vector<std::size_t> drawn;  ///< shapes with a place, far ones first
    Scale across, up;
};

/// Scales that put the drawn places into a box with a margin; the same unit across and up.
void fit(Layout& l, double width, double tallest, double margin) {
    double low_x = 1e300, high_x = -1e300, low_y = 1e300, high_y = -1e300;
    for (const auto i : l.drawn) {
        low_x = std::min(low_x, l.x[i]), high_x = std::max(high_x, l.x[i]);
        low_y = std::min(low_y, l.y[i]), high_y = std::max(high_y, l.y[i]);
    }
    const double wide = std::max(high_x - low_x, 1e-12), tall = std::max(high_y - low_y, 1e-12);
    const double unit = std::min((width - 2 * margin) / wide, (tallest - 2 * margin) / tall);
    l.width = width;
    l.height = std::max(240.0, tall * unit + 2 * margin);
    const double cx = (low_x + high_x) / 2, cy = (low_y + high_y) / 2;
    l.across = {cx - width / 2 / unit, cx + width / 2 / unit, 0, width};
    l.up = {cy - l.height / 2 / unit, cy + l.height / 2 / unit, l.height, 0};
}

/// Places of an embedding in a box; three dimensions are seen from the direction that the page starts with.
Layout layout(const Embedding& e, std::size_t n, double width, double tallest, double margin) {
    Layout l;
    l.x.resize(n), l.y.resize(n), l.depth.assign(n, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
        const double* p = &e.coordinates[i * static_cast<std::size_t>(e.dimension)];
        if (!std::isfinite(p[0]) || !std::isfinite(p[1])) continue;
        l.drawn.push_back(i);
        l.x[i] = p[0], l.y[i] = p[1];
        if (e.dimension == 3) {
            const double yaw = 0.6, pitch = 0.35, z = p[2] * std::cos(yaw) - p[0] * std::sin(yaw);
            l.x[i] = p[0] * std::cos(yaw) + p[2] * std::sin(yaw);
            l.y[i] = p[1] * std::cos(pitch) - z * std::sin(pitch);
            l.depth[i] = p[1] * std::sin(pitch) + z * std::cos(pitch);
        }
    }
    std::stable_sort(l.drawn.begin(), l.drawn.end(), [&](auto i, auto j) { return l.depth[i] < l.depth[j]; });
    fit(l, width, tallest, margin);
    return l;
}

/// Moves shapes of a small graph apart until their pictures no longer overlap; the map is only a hint there.
void push_apart(Layout& l, double least) {
    const double unit_x = (l.across.to - l.across.from) / (l.across.high - l.across.low);
    const double unit_y = (l.up.from - l.up.to) / (l.up.high - l.up.low);
    for (int sweep = 0; sweep < 300; ++sweep) {
        bool moved = false;
        for (const auto i : l.drawn) {
            for (const auto j : l.drawn) {
                if (i >= j) continue;
                double dx = (l.x[j] - l.x[i]) * unit_x, dy = (l.y[j] - l.y[i]) * unit_y;
                const double r = std::hypot(dx, dy);
                if (r >= least) continue;
                if (r < 1e-6) dx = std::cos(static_cast<double>(j)), dy = std::sin(static_cast<double>(j));
                const double push = 0.26 * (least - r) / std::max(r, 1e-6 + (r < 1e-6 ? 1.0 : 0.0));
                l.x[i] -= push * dx / unit_x, l.x[j] += push * dx / unit_x;
                l.y[i] -= push * dy / unit_y, l.y[j] += push * dy / unit_y;
                moved = true;
            }
        }
        if (!moved) break;
    }
}

void draw_graph(Svg& svg, const Study& s, const Layout& l, const std::vector<Edge>& edges, double picture,
                bool labelled) {
    std::vector<bool> drawn(s.n, false);
    for (const auto i : l.drawn) drawn[i] = true;
    const auto visible = [&](const Edge& e) {
        return drawn[static_cast<std::size_t>(e.a)] && drawn[static_cast<std::size_t>(e.b)];
    };
    const auto x = [&](int i) { return l.across(l.x[static_cast<std::size_t>(i)]); };
    const auto y = [&](int i) { return l.up(l.y[static_cast<std::size_t>(i)]); };
    for (const auto& e : edges) {
        if (visible(e)) svg.line(x(e.a), y(e.a), x(e.b), y(e.b), "#8b95a3", labelled ? 1.5 : 1);
    }
    for (const auto i : l.drawn) {
        const int k = static_cast<int>(i);
        if (picture > 0 && !s.m.shapes[i].thumbnail.bytes.empty()) {
            svg.circle(x(k), y(k), 0.62 * picture, "#ffffff", s.colour(i), 1.6);
            svg.image(x(k) - picture / 2, y(k) - picture / 2, picture, picture, s.m.shapes[i].thumbnail.bytes);
        } else {
            svg.circle(x(k), y(k), 4.5, s.colour(i), "#ffffff", 0.8);
        }
        if (labelled) svg.text(x(k), y(k) + 0.62 * picture + 9, s.short_name(i), 10, "middle", ink, false, "#ffffff");
    }
    for (const auto& e : edges) {
        if (labelled && visible(e))
            svg.text((x(e.a) + x(e.b)) / 2, (y(e.a) + y(e.b)) / 2, fixed_number(e.length), 11, "middle", ink, true,
                     "#ffffff");
    }
}

double picture_size(std::size_t n) {
    return n > 400 ? 0 : std::clamp(230.0 / std::sqrt(static_cast<double>(n)), 14.0, 64.0);
}

Figure embedding(const Study& s, const Embedding& e) {
    const double picture = picture_size(s.n);
    const auto l = layout(e, s.n, 760, 640, picture + 14);
    Svg svg(850, l.height + 100);
    svg.open_group(64, 14);
    if (e.dimension == 2) draw_axes(svg, l.across, l.up, "unit of the distances", "");
    draw_graph(svg, s, l, s.m.spanning_tree, picture, false);
    svg.close_group();
    draw_legend(svg, s, 64, l.height + 66, 760);
    const std::string title = e.method + " in " + std::to_string(e.dimension) + " dimensions" +
                              (std::isfinite(e.stress) ? ", stress " + short_number(e.stress) : "");
    return {"embedding_" + std::to_string(e.dimension) + "d", title, svg.document(title)};
}

const Embedding* flat(const ReportModel& m) {
    for (const auto& e : m.embeddings) {
        if (e.dimension == 2) return &e;
    }
    return nullptr;
}

Figure graph(const Study& s, const Embedding& e) {
    const bool labelled = s.n <= 40;
    const double picture = picture_size(s.n);
    auto l = layout(e, s.n, 900, 760, picture + 24);
    for (int round = 0; labelled && round < 4; ++round) {  // pushing needs room, making room moves closer
        push_apart(l, 1.9 * picture);
        fit(l, 900, 760, picture + 24);
    }
    Svg svg(920, l.height + 50);
    svg.open_group(10, 10);
    draw_graph(svg, s, l, s.m.neighbour_graph.empty() ? s.m.spanning_tree : s.m.neighbour_graph, picture, labelled);
    svg.close_group();
    draw_legend(svg, s, 20, l.height + 28, 880);
    return {"graph", "Neighbour graph", svg.document("Neighbour graph of " + s.m.study)};
}

/// Small studies: labelled graph and matrix with pictures side by side, as Fig. 9 of [WBRS09]; A4 across.
Figure page(const Study& s, const Embedding& e) {
    const double cell = 430.0 / static_cast<double>(s.n), side = std::min(cell - 2, 56.0);
    Svg svg(1123, 794);
    svg.text(40, 44, s.m.study, 22, "start", ink, true);
    svg.text(40, 72,
             std::to_string(s.n) + " shapes, " + std::to_string(s.m.pairs_done) + " geodesics" +
                 (s.m.distance_unit.empty() ? "" : "; distances are path lengths, unit: " + s.m.distance_unit),
             12);
    auto l = layout(e, s.n, 500, 600, 70);
    for (int round = 0; round < 4; ++round) {
        push_apart(l, 1.9 * 62);
        fit(l, 500, 600, 70);
    }
    svg.open_group(30, 110 + std::max(0.0, (560 - l.height) / 2));
    draw_graph(svg, s, l, s.m.neighbour_graph.empty() ? s.m.spanning_tree : s.m.neighbour_graph, 62, true);
    svg.close_group();
    svg.open_group(640, 150 + side);
    draw_matrix(svg, s, s.order(), cell, side, true);
    draw_colour_bar(svg, 0, 450, 240, s.top > 0 ? s.top : 1, "geodesic distance");
    svg.close_group();
    draw_legend(svg, s, 40, 760, 1040);
    return {"page", "All shapes at a glance", svg.document(s.m.study)};
}

using Points = std::vector<std::pair<double, double>>;

Figure scatter(const std::string& name, const std::string& title, const Points& points, const Points& line,
               const std::string& x_title, const std::string& y_title) {
    double x_top = 1e-12, y_top = 1e-12;
    for (const auto& [x, y] : points) x_top = std::max(x_top, x), y_top = std::max(y_top, y);
    const Scale across{0, 1.05 * x_top, 0, 460}, up{0, 1.05 * y_top, 380, 0};
    Svg svg(560, 450);
    svg.open_group(70, 16);
    draw_axes(svg, across, up, x_title, y_title);
    for (const auto& [x, y] : points) svg.circle(across(x), up(y), points.size() > 400 ? 1.2 : 2.2, "#c2410c");
    Points drawn;
    for (const auto& [x, y] : line.empty() ? Points{{0, 0}, {std::min(x_top, y_top), std::min(x_top, y_top)}} : line)
        drawn.emplace_back(across(x), up(y));
    svg.polyline(drawn, ink, 1.2);
    svg.close_group();
    return {name, title, svg.document(title)};
}

Figure shepard(const Study& s, const Embedding& e) {
    Points points, fitted;
    const std::size_t stride = std::max<std::size_t>(1, s.m.distances.size() / 4000);
    const auto d = static_cast<std::size_t>(e.dimension);
    for (std::size_t i = 0, k = 0; i < s.n; ++i) {
        for (std::size_t j = i + 1; j < s.n; ++j, ++k) {
            if (k % stride != 0 || !std::isfinite(s.m.distances[k])) continue;
            double square = 0;
            for (std::size_t a = 0; a < d; ++a)
                square += std::pow(e.coordinates[i * d + a] - e.coordinates[j * d + a], 2);
            if (!std::isfinite(square)) continue;
            points.emplace_back(s.m.distances[k], std::sqrt(square));
            if (!e.disparities.empty()) fitted.emplace_back(s.m.distances[k], e.disparities[k]);
        }
    }
    std::sort(fitted.begin(), fitted.end());
    const std::string size = std::to_string(e.dimension) + "d";
    return scatter("shepard_" + size, "Shepard diagram, " + e.method + ", " + size, points, fitted, "geodesic distance",
                   "distance in the map");
}

Figure precision_recall(const Study& s) {
    const Scale across{0, 1, 0, 460}, up{0, 1, 380, 0};
    Svg svg(560, 480);
    svg.open_group(70, 16);
    draw_axes(svg, across, up, "recall", "precision");
    for (std::size_t t = 0; t < s.m.classes.size(); ++t) {
        Points points;
        for (const auto& p : s.m.classes[t].precision_recall) points.emplace_back(across(p.recall), up(p.precision));
        const std::string colour = group_colour(static_cast<int>(t), 10);
        svg.polyline(points, colour, 2);
        svg.line(0, 428 + 16 * static_cast<double>(t), 18, 428 + 16 * static_cast<double>(t), colour, 2);
        svg.text(24, 428 + 16 * static_cast<double>(t), s.m.classes[t].name);
    }
    svg.close_group();
    return {"precision_recall", "Precision and recall", svg.document("Precision and recall of " + s.m.study)};
}

}  // namespace

std::string path_figure(const ReportModel& model, const PathReport& path) {
    const double side = 120, gap = 8;
    const auto frames = static_cast<double>(path.frames.size());
    const double width = std::max(420.0, 40 + frames * (side + gap));
    Svg svg(width, side + 130);
    const auto name = [&](int i) { return model.shapes.at(static_cast<std::size_t>(i)).name; };
    svg.text(20, 20, name(path.a) + "  →  " + name(path.b), 13, "start", ink, true);
    std::string numbers = "path length " + short_number(path.path_length, 4);
    if (std::isfinite(path.error)) numbers += " ± " + short_number(path.error, 2);
    if (std::isfinite(path.min_det)) numbers += ", min det Dφ ≥ " + short_number(path.min_det);
    if (!path.termination.empty()) numbers += ", " + path.termination;
    svg.text(20, 40, numbers, 11);
    for (std::size_t k = 0; k < path.frames.size(); ++k) {
        const double x = 20 + static_cast<double>(k) * (side + gap);
        svg.image(x, 52, side, side, path.frames[k].picture.bytes);
        svg.text(x + side / 2, 60 + side, "t = " + short_number(path.frames[k].time), 10, "middle");
    }
    const auto& bar = path.colour_bar;
    if (bar.colours.size() >= 2) {
        const double y = side + 86, step = 220.0 / (static_cast<double>(bar.colours.size()) * 16 - 16);
        const auto channel = [](const std::string& c, std::size_t at) {
            return std::stoi(c.substr(at, 2), nullptr, 16);
        };
        for (std::size_t k = 0; k + 1 < bar.colours.size(); ++k) {
            const std::string &low = bar.colours[k], &high = bar.colours[k + 1];
            if (low.size() != 7 || high.size() != 7) break;
            for (int f = 0; f < 16; ++f) {
                std::string mixed = "rgb(";
                for (const std::size_t at : {1U, 3U, 5U}) {
                    mixed += std::to_string(channel(low, at) + (channel(high, at) - channel(low, at)) * f / 15) +
                             (at < 5 ? "," : ")");
                }
                svg.rect(20 + (static_cast<double>(k) * 16 + f) * step, y, step + 0.5, 10, mixed);
            }
        }
        svg.text(20, y + 20, short_number(bar.low), 10);
        svg.text(240, y + 20, short_number(bar.high), 10, "end");
        svg.text(250, y + 5, bar.quantity + (bar.unit.empty() ? "" : " [" + bar.unit + "]"));
    }
    return svg.document("Geodesic from " + name(path.a) + " to " + name(path.b));
}

std::vector<Figure> figures(const ReportModel& model) {
    if (const auto found = problems(model); !found.empty()) throw std::invalid_argument("report: " + found.front());
    const Study s(model);
    std::vector<Figure> result;
    if (s.n < 2) return result;
    result.push_back(heat_map(s));
    for (const auto& tree : model.linkages) {
        if (!tree.merges.empty())
            result.push_back(
                dendrogram(s, tree, "dendrogram_" + tree.method, "Dendrogram, " + tree.method + " linkage"));
    }
    for (const int dimension : {2, 3}) {  // the first map of each dimension
        const auto e = std::find_if(model.embeddings.begin(), model.embeddings.end(),
                                    [&](const auto& m) { return m.dimension == dimension; });
        if (e == model.embeddings.end()) continue;
        result.push_back(embedding(s, *e));
        result.push_back(shepard(s, *e));
    }
    if (const Embedding* e = flat(model);
        e != nullptr && !(model.neighbour_graph.empty() && model.spanning_tree.empty())) {
        result.push_back(graph(s, *e));
        if (s.n <= 12) result.push_back(page(s, *e));
    }
    if (std::any_of(model.classes.begin(), model.classes.end(),
                    [](const auto& c) { return !c.precision_recall.empty(); })) {
        result.push_back(precision_recall(s));
    }
    if (model.volumes && !model.volumes->tree.merges.empty()) {
        result.push_back(dendrogram(s, model.volumes->tree, "volume_dendrogram",
                                    model.dimension == 3 ? "Dendrogram by volume" : "Dendrogram by area"));
    }
    if (model.compare && !model.compare->distances.empty()) {
        result.push_back(scatter("compare", "Distances of two studies", model.compare->distances, {},
                                 "distance in " + model.study, "distance in " + model.compare->other));
    }
    for (const auto& path : model.paths) {
        if (path.frames.empty()) continue;
        result.push_back(
            {"path_" + std::to_string(path.a) + "_" + std::to_string(path.b), "Geodesic", path_figure(model, path)});
    }
    return result;
}

}  // namespace morphodesic::reports

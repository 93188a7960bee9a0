#include "reports/map_figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <set>

#include "reports/text.h"

namespace morphodesic::reports {
namespace {

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

/// Edges of a graph small enough for numbers: the spanning tree, and every shape with its two nearest.
std::vector<Edge> few_edges(const FigureStudy& s) {
    std::set<std::pair<int, int>> chosen;
    std::vector<Edge> edges;
    const auto add = [&](const Edge& e) {
        if (chosen.insert(std::minmax(e.a, e.b)).second) edges.push_back(e);
    };
    for (const Edge& e : s.m.spanning_tree) add(e);
    for (std::size_t i = 0; i < s.n; ++i) {
        std::vector<Edge> others;
        for (std::size_t j = 0; j < s.n; ++j) {
            if (j != i && std::isfinite(s.distance(i, j))) {
                others.push_back({static_cast<int>(i), static_cast<int>(j), s.distance(i, j)});
            }
        }
        std::stable_sort(others.begin(), others.end(),
                         [](const Edge& a, const Edge& b) { return a.length < b.length; });
        others.resize(std::min<std::size_t>(others.size(), 2));
        for (const Edge& e : others) add(e);
    }
    return edges;
}

/// Width of a text in small letters.
double text_width(const std::string& text) {
    return 5.8 * static_cast<double>(std::count_if(text.begin(), text.end(), starts_letter));
}

/// How much of two boxes, given by the distances of their middles and the sums of their half sides, is in common: 0
/// to 1.
double overlap(double dx, double dy, double wide, double tall) {
    return std::max(0.0, 1 - std::abs(dx) / wide) * std::max(0.0, 1 - std::abs(dy) / tall);
}

/// How far below the middle of a shape the middle of its name is.
double name_below(double picture) {
    return (picture > 0 ? 0.62 * picture : 4.5) + 9;
}

/// Where on its edge each number stands: as near to the middle as other numbers, pictures and names allow.
std::vector<std::pair<double, double>> label_places(const FigureStudy& s, const std::vector<Edge>& edges,
                                                    const Layout& l, double picture) {
    std::vector<std::pair<double, double>> places;
    const auto x = [&](int i) { return l.across(l.x[static_cast<std::size_t>(i)]); };
    const auto y = [&](int i) { return l.up(l.y[static_cast<std::size_t>(i)]); };
    constexpr double wide = 44, tall = 15;
    for (const Edge& e : edges) {
        std::pair<double, double> best;
        double least = HUGE_VAL;
        for (const double t : {0.5, 0.43, 0.57, 0.36, 0.64, 0.3, 0.7, 0.24, 0.76, 0.18, 0.82}) {
            const double px = x(e.a) + t * (x(e.b) - x(e.a)), py = y(e.a) + t * (y(e.b) - y(e.a));
            double harm = std::abs(t - 0.5);
            for (const auto& [qx, qy] : places) {
                harm += 10 * overlap(px - qx, py - qy, wide, tall);
            }
            for (const std::size_t i : l.drawn) {
                const double dx = px - x(static_cast<int>(i)), dy = py - y(static_cast<int>(i));
                harm += 10 * std::max(0.0, 1 - std::hypot(dx, dy) / (0.62 * picture + 14));
                harm += 10 * overlap(dx, dy - name_below(picture), (wide + text_width(s.short_name(i))) / 2, tall);
            }
            if (harm < least) least = harm, best = {px, py};
        }
        places.push_back(best);
    }
    return places;
}

void draw_graph(Svg& svg, const FigureStudy& s, const Layout& l, const std::vector<Edge>& edges, double picture,
                bool labelled) {
    std::vector<bool> drawn(s.n, false);
    for (const auto i : l.drawn) drawn[i] = true;
    const auto visible = [&](const Edge& e) {
        return drawn[static_cast<std::size_t>(e.a)] && drawn[static_cast<std::size_t>(e.b)];
    };
    const auto x = [&](int i) { return l.across(l.x[static_cast<std::size_t>(i)]); };
    const auto y = [&](int i) { return l.up(l.y[static_cast<std::size_t>(i)]); };
    const auto pictured = [&](std::size_t i) { return picture > 0 && !s.m.shapes[i].thumbnail.bytes.empty(); };
    for (const auto& e : edges) {
        if (visible(e)) svg.line(x(e.a), y(e.a), x(e.b), y(e.b), "#8b95a3", labelled ? 1.5 : 1);
    }
    for (const auto i : l.drawn) {
        const int k = static_cast<int>(i);
        if (pictured(i)) {
            svg.circle(x(k), y(k), 0.62 * picture, "#ffffff", s.colour(i), 1.6);
            svg.image(x(k) - picture / 2, y(k) - picture / 2, picture, picture, s.m.shapes[i].thumbnail.bytes);
        } else {
            svg.circle(x(k), y(k), 4.5, s.colour(i), "#ffffff", 0.8);
        }
    }
    if (!labelled) return;
    for (const auto i : l.drawn) {  // over all pictures, or a neighbour's would cover a name
        const int k = static_cast<int>(i);
        svg.text(x(k), y(k) + name_below(pictured(i) ? picture : 0), s.short_name(i), 10, "middle", ink, false,
                 "#ffffff");
    }
    std::vector<Edge> numbered;
    std::copy_if(edges.begin(), edges.end(), std::back_inserter(numbered), visible);
    const auto places = label_places(s, numbered, l, picture);
    for (std::size_t k = 0; k < numbered.size(); ++k) {
        svg.text(places[k].first, places[k].second, short_number(numbered[k].length), 11, "middle", ink, true,
                 "#ffffff");
    }
}

constexpr double least_picture = 44;  // dots keep as far apart as these: there are names below them

/// 0 for dots.
double picture_size(const FigureStudy& s) {
    return !s.pictured || s.n > 400 ? 0 : std::clamp(230.0 / std::sqrt(static_cast<double>(s.n)), 14.0, 64.0);
}

}  // namespace

Figure embedding_figure(const FigureStudy& s, const Embedding& e) {
    const double picture = picture_size(s);
    Embedding all = e;  // the shapes, then the queries placed among them
    std::vector<std::string> queries;
    const auto map = static_cast<std::size_t>(&e - s.m.embeddings.data());
    for (const PlacedQuery& query : s.m.placed) {
        const std::vector<double>& position = query.positions[map];
        all.coordinates.insert(all.coordinates.end(), position.begin(), position.end());
        if (!position.empty()) queries.push_back(query.name);
    }
    auto l = layout(all, s.n + queries.size(), 760, 640, picture + 14);
    std::erase_if(l.drawn, [&](std::size_t i) { return i >= s.n; });
    Svg svg(850, l.height + 82 + legend_height(s, 760));
    svg.open_group(64, 14);
    if (e.dimension == 2) draw_axes(svg, l.across, l.up, "unit of the distances", "");
    draw_graph(svg, s, l, s.m.spanning_tree, picture, false);
    for (std::size_t q = 0; q < queries.size(); ++q) {
        const double x = l.across(l.x[s.n + q]), y = l.up(l.y[s.n + q]), r = 8;
        svg.area({{{x, y - r}, {x + r, y}, {x, y + r}, {x - r, y}}}, "#c2410c", "#ffffff", 1.5);
    }
    std::vector<std::array<double, 3>> names;  // middle and width of those that stand already
    for (const std::string& query : queries) {
        const std::size_t q = s.n + names.size();
        const double x = l.across(l.x[q]), y = l.up(l.y[q]), width = 1.1 * text_width(query), beside = width / 2 + 12;
        std::array<double, 3> best{};
        double least = HUGE_VAL;
        for (const auto& [dx, dy] :
             {std::pair(0.0, -15.0), {0.0, 17.0}, {beside, 0.0}, {-beside, 0.0}, {0.0, -28.0}, {0.0, 30.0}}) {
            double harm = 0.001 * std::hypot(dx, dy);
            for (const auto& [nx, ny, wide] : names) harm += overlap(x + dx - nx, y + dy - ny, (width + wide) / 2, 13);
            if (harm < least) least = harm, best = {x + dx, y + dy, width};
        }
        names.push_back(best);
        svg.text(best[0], best[1], query, 10, "middle", ink, true, "#ffffff");
    }
    svg.close_group();
    draw_legend(svg, s, 64, l.height + 66, 760);
    const std::string title = e.method + " in " + std::to_string(e.dimension) + " dimensions" +
                              (std::isfinite(e.stress) ? ", stress " + short_number(e.stress) : "");
    return {"embedding_" + std::to_string(e.dimension) + "d", title, svg.document(title)};
}

Figure graph_figure(const FigureStudy& s, const Embedding& e) {
    const bool labelled = s.n <= 40;
    const double picture = picture_size(s);
    auto l = layout(e, s.n, 900, 760, picture + 24);
    for (int round = 0; labelled && round < 4; ++round) {  // pushing needs room, making room moves closer
        push_apart(l, 1.9 * std::max(picture, least_picture));
        fit(l, 900, 760, picture + 24);
    }
    Svg svg(920, l.height + 34 + legend_height(s, 880));
    svg.open_group(10, 10);
    const std::vector<Edge>& all = s.m.neighbour_graph.empty() ? s.m.spanning_tree : s.m.neighbour_graph;
    draw_graph(svg, s, l, labelled ? few_edges(s) : all, picture, labelled);
    svg.close_group();
    draw_legend(svg, s, 20, l.height + 28, 880);
    return {"graph", "Neighbour graph", svg.document("Neighbour graph of " + s.m.study)};
}

Figure page_figure(const FigureStudy& s, const Embedding& e) {
    double label = 0.0;  // of the rows, between the graph and the matrix
    for (std::size_t i = 0; i < s.n; ++i) label = std::max(label, text_width(s.short_name(i)));
    const double shapes = static_cast<double>(s.n), right = 1070.0;
    // The matrix keeps two thirds of its usual width however long the names are.
    const double left =
        std::clamp(545 + label + 14 + (s.pictured ? std::min(430.0 / shapes, 56.0) : 0), 640.0, right - 290);
    const double cell = (right - left) / shapes, side = s.pictured ? std::min(cell - 2, 56.0) : 0,
                 picture = s.pictured ? 62 : 0;
    Svg svg(1123, 776 + std::max(18.0, legend_height(s, 1040)));
    svg.text(40, 44, s.m.study, 22, "start", ink, true);
    svg.text(40, 72,
             std::to_string(s.n) + " shapes, " + std::to_string(s.m.pairs_done) +
                 (s.m.given_matrix ? " distances" : " pairs") +
                 (s.m.distance_unit.empty() ? "" : "; distances are path lengths, unit: " + s.m.distance_unit),
             12);
    auto l = layout(e, s.n, 500, 600, 70);
    for (int round = 0; round < 4; ++round) {
        push_apart(l, 1.9 * std::max(picture, least_picture));
        fit(l, 500, 600, 70);
    }
    svg.open_group(30, 110 + std::max(0.0, (560 - l.height) / 2));
    draw_graph(svg, s, l, few_edges(s), picture, true);
    svg.close_group();
    svg.open_group(left, 150 + side);
    draw_matrix(svg, s, s.order(), cell, side, true);
    draw_colour_bar(svg, 0, cell * shapes + 20, 240, s.top > 0 ? s.top : 1, s.distance_title());
    svg.close_group();
    draw_legend(svg, s, 40, 760, 1040);
    return {"page", "All shapes at a glance", svg.document(s.m.study)};
}

}  // namespace morphodesic::reports

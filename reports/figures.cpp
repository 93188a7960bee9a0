#include "reports/figures.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "reports/figure_parts.h"
#include "reports/map_figures.h"
#include "reports/report.h"
#include "reports/text.h"

namespace morphodesic::reports {
namespace {

Figure heat_map(const FigureStudy& s) {
    const double cell = std::clamp(760.0 / static_cast<double>(s.n), 1.0, 64.0), size = cell * static_cast<double>(s.n);
    const double side = s.pictured && cell >= 10 ? std::min(cell - 2, 56.0) : 0,
                 left = 20 + side + (cell >= 9 ? 130 : 50);
    const bool tree = !s.m.linkages.empty() && !s.m.linkages[0].merges.empty();
    const double top = 16 + (tree ? 110 : 0) + side + 12;
    const double width = left + size + 20, below = top + size + 72;
    Svg svg(width, below + legend_height(s, width - 40) + 18);
    if (tree) {
        svg.open_group(left, 16);
        draw_tree(svg, s.m.linkages[0], cell, 100);
        svg.close_group();
    }
    svg.open_group(left, top);
    draw_matrix(svg, s, s.order(), cell, side, cell >= 34);
    draw_colour_bar(svg, 0, size + 18, std::min(260.0, std::max(120.0, size)), s.top > 0 ? s.top : 1,
                    s.distance_title());
    svg.close_group();
    draw_legend(svg, s, 20, below, width - 40);
    return {"heat_map", "Distance matrix", svg.document("Distance matrix of " + s.m.study)};
}

Figure dendrogram(const FigureStudy& s, const LinkageTree& tree, const std::string& name, const std::string& title) {
    const double cell = std::clamp(900.0 / static_cast<double>(s.n), 1.5, 70.0), size = cell * static_cast<double>(s.n);
    const double side = s.pictured && cell >= 10 ? std::min(cell - 2, 60.0) : 0;
    const bool named = cell >= 9;
    const double below = 240 + side + (named ? 140 : 10);
    Svg svg(size + 90, below + legend_height(s, size) + 12);
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
    draw_legend(svg, s, 64, below, size);
    return {name, title, svg.document(title + " of " + s.m.study)};
}

const Embedding* flat(const ReportModel& m) {
    for (const auto& e : m.embeddings) {
        if (e.dimension == 2) return &e;
    }
    return nullptr;
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

Figure shepard(const FigureStudy& s, const Embedding& e) {
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
    return scatter("shepard_" + size, "Shepard diagram, " + e.method + ", " + size, points, fitted, s.distance_title(),
                   "distance in the map");
}

Figure precision_recall(const FigureStudy& s) {
    const Scale across{0, 1, 0, 460}, up{0, 1, 380, 0};
    Svg svg(560, 480);
    svg.open_group(70, 16);
    draw_axes(svg, across, up, "recall", "precision");
    for (std::size_t t = 0; t < s.m.classes.size(); ++t) {
        Points points;
        for (const auto& p : s.m.classes[t].precision_recall) {
            if (std::isfinite(p.precision)) points.emplace_back(across(p.recall), up(p.precision));
        }
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
    const double width = std::max(520.0, 40 + frames * (side + gap));  // the words beside the colours need it
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
    const FigureStudy s(model);
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
        result.push_back(embedding_figure(s, *e));
        result.push_back(shepard(s, *e));
    }
    if (const Embedding* e = flat(model);
        e != nullptr && !(model.neighbour_graph.empty() && model.spanning_tree.empty())) {
        result.push_back(graph_figure(s, *e));
        if (s.n <= 12) result.push_back(page_figure(s, *e));
    }
    if (std::any_of(model.classes.begin(), model.classes.end(), [](const auto& c) {
            return std::any_of(c.precision_recall.begin(), c.precision_recall.end(),
                               [](const auto& p) { return std::isfinite(p.precision); });
        })) {
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

#include "reports/svg.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "reports/text.h"

namespace morphodesic::reports {
namespace {

std::string px(double v) {
    char buffer[40];
    std::snprintf(buffer, sizeof buffer, "%.2f", std::isfinite(v) ? v : 0.0);
    std::string s = buffer;
    while (s.back() == '0') s.pop_back();
    if (s.back() == '.') s.pop_back();
    return s == "-0" ? "0" : s;
}
std::string attribute(const char* name, const std::string& value) {
    return std::string(" ") + name + "=\"" + escape_markup(value) + "\"";
}

}  // namespace

void Svg::line(double x1, double y1, double x2, double y2, const std::string& colour, double thickness,
               const std::string& dashes) {
    body_ += "<line" + attribute("x1", px(x1)) + attribute("y1", px(y1)) + attribute("x2", px(x2)) +
             attribute("y2", px(y2)) + attribute("stroke", colour) + attribute("stroke-width", px(thickness)) +
             (dashes.empty() ? "" : attribute("stroke-dasharray", dashes)) + "/>\n";
}

void Svg::rect(double x, double y, double width, double height, const std::string& fill, const std::string& stroke) {
    body_ += "<rect" + attribute("x", px(x)) + attribute("y", px(y)) + attribute("width", px(width)) +
             attribute("height", px(height)) + attribute("fill", fill) +
             (stroke.empty() ? "" : attribute("stroke", stroke)) + "/>\n";
}

void Svg::circle(double x, double y, double radius, const std::string& fill, const std::string& stroke,
                 double thickness) {
    body_ += "<circle" + attribute("cx", px(x)) + attribute("cy", px(y)) + attribute("r", px(radius)) +
             attribute("fill", fill) +
             (stroke.empty() ? "" : attribute("stroke", stroke) + attribute("stroke-width", px(thickness))) + "/>\n";
}

void Svg::polyline(const std::vector<std::pair<double, double>>& points, const std::string& colour, double thickness) {
    std::string list;
    for (const auto& [x, y] : points) list += px(x) + "," + px(y) + " ";
    body_ += "<polyline" + attribute("points", list) + attribute("fill", "none") + attribute("stroke", colour) +
             attribute("stroke-width", px(thickness)) + "/>\n";
}

void Svg::area(const std::vector<std::vector<std::pair<double, double>>>& loops, const std::string& fill,
               const std::string& stroke, double thickness) {
    std::string path;
    for (const auto& loop : loops) {
        for (std::size_t i = 0; i < loop.size(); ++i) {
            path += (i == 0 ? "M" : "L") + px(loop[i].first) + " " + px(loop[i].second);
        }
        path += "Z";
    }
    body_ += "<path" + attribute("d", path) + attribute("fill", fill.empty() ? "none" : fill) +
             attribute("fill-rule", "evenodd") +
             (stroke.empty() ? ""
                             : attribute("stroke", stroke) + attribute("stroke-width", px(thickness)) +
                                   attribute("stroke-linejoin", "round")) +
             "/>\n";
}

void Svg::text(double x, double y, const std::string& text, double size, const std::string& anchor,
               const std::string& colour, bool bold, const std::string& halo) {
    const std::string common = attribute("x", px(x)) + attribute("y", px(y + 0.35 * size)) +
                               attribute("font-size", px(size)) + attribute("text-anchor", anchor) +
                               (bold ? attribute("font-weight", "bold") : "");
    if (!halo.empty()) {
        body_ += "<text" + common + attribute("fill", "none") + attribute("stroke", halo) +
                 attribute("stroke-width", "4") + attribute("stroke-linejoin", "round") + ">" + escape_markup(text) +
                 "</text>\n";
    }
    body_ += "<text" + common + attribute("fill", colour) + ">" + escape_markup(text) + "</text>\n";
}

void Svg::vertical_text(double x, double y, const std::string& text, double size, const std::string& anchor) {
    body_ += "<text" + attribute("transform", "translate(" + px(x + 0.35 * size) + "," + px(y) + ") rotate(-90)") +
             attribute("font-size", px(size)) + attribute("text-anchor", anchor) + attribute("fill", "#1b2430") + ">" +
             escape_markup(text) + "</text>\n";
}

void Svg::image(double x, double y, double width, double height, const std::string& bytes, bool crisp) {
    if (bytes.empty()) return;
    body_ += "<image" + attribute("x", px(x)) + attribute("y", px(y)) + attribute("width", px(width)) +
             attribute("height", px(height)) +
             (crisp ? attribute("preserveAspectRatio", "none") + attribute("image-rendering", "optimizeSpeed") +
                          attribute("style", "image-rendering:pixelated")
                    : "") +
             attribute("xlink:href", data_uri(bytes)) + "/>\n";
}

void Svg::open_group(double x, double y) {
    body_ += "<g" + attribute("transform", "translate(" + px(x) + "," + px(y) + ")") + ">\n";
}

std::string Svg::document(const std::string& title) const {
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
           "xmlns:xlink=\"http://www.w3.org/1999/xlink\" version=\"1.1\"" +
           attribute("width", px(width_)) + attribute("height", px(height_)) +
           attribute("viewBox", "0 0 " + px(width_) + " " + px(height_)) +
           attribute("font-family", "Helvetica, Arial, DejaVu Sans, sans-serif") + ">\n<title>" + escape_markup(title) +
           "</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n" + body_ + "</svg>\n";
}

std::vector<double> ticks(double low, double high, int about) {
    if (!(high > low)) return {low};
    const double raw = (high - low) / about, power = std::pow(10.0, std::floor(std::log10(raw)));
    const double step = power * (raw / power < 1.5 ? 1 : raw / power < 3.5 ? 2 : raw / power < 7.5 ? 5 : 10);
    std::vector<double> result;
    for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k)
        result.push_back(k * step + 0.0);  // + 0: no negative zero
    return result;
}

void draw_axes(Svg& svg, const Scale& x, const Scale& y, const std::string& x_title, const std::string& y_title) {
    for (const double v : ticks(x.low, x.high, 5)) {
        svg.line(x(v), y.from, x(v), y.to, "#e6e9ee");
        svg.text(x(v), y.from + 12, short_number(v), 10, "middle");
    }
    for (const double v : ticks(y.low, y.high, 5)) {
        svg.line(x.from, y(v), x.to, y(v), "#e6e9ee");
        svg.text(x.from - 6, y(v), short_number(v), 10, "end");
    }
    svg.line(x.from, y.from, x.to, y.from, "#8b95a3");
    svg.line(x.from, y.from, x.from, y.to, "#8b95a3");
    svg.text((x.from + x.to) / 2, y.from + 30, x_title, 12, "middle");
    svg.vertical_text(x.from - 44, (y.from + y.to) / 2, y_title, 12);
}

std::string viridis(double t) {
    static constexpr std::array<unsigned, 11> stops = {0x440154, 0x482475, 0x414487, 0x355f8d, 0x2a788e, 0x21918c,
                                                       0x22a884, 0x44bf70, 0x7ad151, 0xbddf26, 0xfde725};
    const double at = std::clamp(t, 0.0, 1.0) * (stops.size() - 1);
    const auto k = std::min<std::size_t>(static_cast<std::size_t>(at), stops.size() - 2);
    const double f = at - static_cast<double>(k);
    unsigned colour = 0;
    for (const unsigned shift : {16U, 8U, 0U}) {
        const double low = (stops[k] >> shift) & 255U, high = (stops[k + 1] >> shift) & 255U;
        colour |= static_cast<unsigned>(std::lround(low + f * (high - low))) << shift;
    }
    char buffer[16];
    std::snprintf(buffer, sizeof buffer, "#%06x", colour);
    return buffer;
}

std::string group_colour(int k, int count) {
    static constexpr std::array<const char*, 10> ten = {"#4c78a8", "#f58518", "#e45756", "#72b7b2", "#54a24b",
                                                        "#eeca3b", "#b279a2", "#ff9da6", "#9d755d", "#bab0ac"};
    static constexpr std::array<const char*, 20> twenty = {
        "#4c78a8", "#9ecae9", "#f58518", "#ffbf79", "#54a24b", "#88d27a", "#b79a20", "#f2cf5b", "#439894", "#83bcb6",
        "#e45756", "#ff9d98", "#79706e", "#bab0ac", "#d67195", "#fcbfd2", "#b279a2", "#d6a5c9", "#9e765f", "#d8b5a5"};
    return count <= 10 ? ten[static_cast<std::size_t>(k) % 10] : twenty[static_cast<std::size_t>(k) % 20];
}

}  // namespace morphodesic::reports

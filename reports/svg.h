#pragma once

#include <string>
#include <utility>
#include <vector>

namespace morphodesic::reports {

/// An SVG document being written. Coordinates in pixels, y down; text is escaped here and nowhere else.
class Svg {
public:
    Svg(double width, double height) : width_(width), height_(height) {}

    void line(double x1, double y1, double x2, double y2, const std::string& colour, double thickness = 1,
              const std::string& dashes = {});
    void rect(double x, double y, double width, double height, const std::string& fill, const std::string& stroke = {});
    void circle(double x, double y, double radius, const std::string& fill, const std::string& stroke = {},
                double thickness = 1.5);
    void polyline(const std::vector<std::pair<double, double>>& points, const std::string& colour, double thickness);
    /// Closed polygons as one area, holes by the even-odd rule. @param fill, stroke  empty: none
    void area(const std::vector<std::vector<std::pair<double, double>>>& loops, const std::string& fill,
              const std::string& stroke = {}, double thickness = 1);
    /// @param anchor "start", "middle" or "end"; y is the middle of the line
    /// @param halo   colour of a rim that keeps the text readable on lines
    void text(double x, double y, const std::string& text, double size = 11, const std::string& anchor = "start",
              const std::string& colour = "#1b2430", bool bold = false, const std::string& halo = {});
    void vertical_text(double x, double y, const std::string& text, double size = 11,
                       const std::string& anchor = "middle");
    /// A picture centred in a square; nothing if there are no bytes. @param crisp pixels as squares, the box filled
    void image(double x, double y, double width, double height, const std::string& bytes, bool crisp = false);
    void open_group(double x, double y);
    void close_group() { body_ += "</g>\n"; }

    [[nodiscard]] std::string document(const std::string& title) const;

private:
    double width_, height_;
    std::string body_;
};

/// Round values from low to high, about so many.
[[nodiscard]] std::vector<double> ticks(double low, double high, int about);

/// Maps numbers to pixels.
struct Scale {
    double low = 0, high = 1, from = 0, to = 1;
    [[nodiscard]] double operator()(double v) const {
        return from + (to - from) * (high > low ? (v - low) / (high - low) : 0.5);
    }
};

/// Left and bottom axis with grid lines and titles.
void draw_axes(Svg& svg, const Scale& x, const Scale& y, const std::string& x_title, const std::string& y_title);

/// Colour of Matplotlib's viridis, t in [0, 1].
[[nodiscard]] std::string viridis(double t);
/// PNG of so many pixels "#rrggbb", row by row.
[[nodiscard]] std::string raster_png(int width, int height, const std::vector<std::string>& colours);
/// Colour number k of count groups (Vega's tableau10 / tableau20).
[[nodiscard]] std::string group_colour(int k, int count);

}  // namespace morphodesic::reports

#pragma once

#include <string>
#include <vector>

#include "reports/report_model.h"
#include "reports/svg.h"

namespace morphodesic::reports {

// What several figures draw. Private to the figures.

inline constexpr const char* ink = "#1b2430";

/// Whether a byte of UTF-8 begins a letter.
[[nodiscard]] bool starts_letter(char c);

/// What the figures ask of a model.
class FigureStudy {
public:
    explicit FigureStudy(const ReportModel& model);
    [[nodiscard]] double distance(std::size_t i, std::size_t j) const;
    [[nodiscard]] std::string colour(std::size_t i) const {
        return group_colour(group[i], static_cast<int>(group_names.size()));
    }
    /// File name without folder and ending, at most 22 letters.
    [[nodiscard]] std::string short_name(std::size_t i) const;
    /// Leaf order of the first tree.
    [[nodiscard]] std::vector<std::size_t> order() const;
    /// Of the distances, for axes and colour bars.
    [[nodiscard]] std::string distance_title() const { return m.given_matrix ? "distance" : "geodesic distance"; }

    const ReportModel& m;
    std::size_t n;
    double top = 0;          ///< the largest distance
    bool pictured = false;   ///< any shape has a picture
    std::vector<int> group;  ///< class of each shape if classes are known, else cluster
    std::vector<std::string> group_names;
};

/// Height of the rows of the legend within so much width; 0 if there is none.
[[nodiscard]] double legend_height(const FigureStudy& s, double width);
/// @param y  middle of the first row
void draw_legend(Svg& svg, const FigureStudy& s, double x, double y, double width);
/// Brackets of a tree: leaves at x = (k + 1/2) cell, heights upwards from y = height to 0.
void draw_tree(Svg& svg, const LinkageTree& tree, double cell, double height);
void draw_colour_bar(Svg& svg, double x, double y, double width, double top, const std::string& title);
/// Cells, pictures and group strips around the origin of the cells.
void draw_matrix(Svg& svg, const FigureStudy& s, const std::vector<std::size_t>& order, double cell, double side,
                 bool numbers);

}  // namespace morphodesic::reports

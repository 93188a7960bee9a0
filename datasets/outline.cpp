#include "datasets/outline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

namespace morphodesic::datasets {

namespace {

/// A crossing of the outline with the line between two neighbouring pixel centres.
struct Crossing {
    double column, row;  // of the first pixel of the pair, padded image
    bool vertical;       // the pair lies in one column
    double t;            // position between the first pixel (0) and the second (1)
    [[nodiscard]] double along() const { return (vertical ? row : column) + t; }
    [[nodiscard]] double across() const { return vertical ? column : row; }
};

/// Marching squares on the pixel centres, with a ring of empty pixels around the image.
class MarchingSquares {
public:
    explicit MarchingSquares(const Coverage& coverage)
        : coverage_(coverage), width_(coverage.width + 2), height_(coverage.height + 2) {}

    std::vector<std::vector<Crossing>> loops() {
        for (int row = 0; row + 1 < height_; ++row) {
            for (int column = 0; column + 1 < width_; ++column) add_cell(column, row);
        }
        std::sort(links_.begin(), links_.end());
        std::vector<bool> used(links_.size(), false);
        std::vector<std::vector<Crossing>> result;
        for (std::size_t first = 0; first < links_.size(); ++first) {
            if (used[first]) continue;
            std::vector<Crossing>& loop = result.emplace_back();
            for (std::size_t i = first; !used[i];) {
                used[i] = true;
                loop.push_back(crossing(links_[i].first));
                const auto next =
                    std::lower_bound(links_.begin(), links_.end(), std::make_pair(links_[i].second, std::int64_t{0}));
                i = static_cast<std::size_t>(next - links_.begin());
            }
        }
        return result;
    }

    /// Share of the crossings whose position the grey values tell.
    [[nodiscard]] static double antialiased_share(const std::vector<std::vector<Crossing>>& loops) {
        double grey = 0.0, all = 0.0;
        for (const auto& loop : loops) {
            for (const Crossing& c : loop) {
                all += 1.0;
                if (std::abs(c.t - 0.5) > 0.04) grey += 1.0;
            }
        }
        return all > 0.0 ? grey / all : 0.0;
    }

private:
    [[nodiscard]] double value(int column, int row) const {
        if (column < 1 || row < 1 || column > coverage_.width || row > coverage_.height) return 0.0;
        return coverage_.at(column - 1, row - 1);
    }
    [[nodiscard]] bool inside(int column, int row) const { return value(column, row) >= 0.5; }

    // The pair of pixels (column, row) and its right or lower neighbour.
    [[nodiscard]] std::int64_t pair(int column, int row, bool vertical) const {
        return 2 * (static_cast<std::int64_t>(row) * width_ + column) + (vertical ? 1 : 0);
    }
    [[nodiscard]] Crossing crossing(std::int64_t pair) const {
        const bool vertical = pair % 2 == 1;
        const int row = static_cast<int>(pair / 2 / width_), column = static_cast<int>(pair / 2 % width_);
        const double a = value(column, row), b = vertical ? value(column, row + 1) : value(column + 1, row);
        return {static_cast<double>(column), static_cast<double>(row), vertical, (0.5 - a) / (b - a)};
    }

    /// Links the crossings on the four sides of a cell, the object on the left as seen with y up.
    void add_cell(int column, int row) {
        const bool nw = inside(column, row), ne = inside(column + 1, row);
        const bool sw = inside(column, row + 1), se = inside(column + 1, row + 1);
        if (nw == ne && ne == sw && sw == se) return;
        const std::int64_t north = pair(column, row, false), south = pair(column, row + 1, false);
        const std::int64_t west = pair(column, row, true), east = pair(column + 1, row, true);
        const auto link = [&](std::int64_t from, std::int64_t to) { links_.emplace_back(from, to); };
        const bool joined =
            value(column, row) + value(column + 1, row) + value(column, row + 1) + value(column + 1, row + 1) >= 2.0;
        if (nw && se && !ne && !sw) {
            if (joined) {
                link(east, north), link(west, south);
            } else {
                link(west, north), link(east, south);
            }
            return;
        }
        if (ne && sw && !nw && !se) {
            if (joined) {
                link(north, west), link(south, east);
            } else {
                link(north, east), link(south, west);
            }
            return;
        }
        // Going around the cell counter-clockwise (north, west, south, east) the object is entered once and left once:
        // the outline starts where it is left and ends where it is entered, so that the object is on its left.
        const std::array<bool, 5> corners = {ne, nw, sw, se, ne};
        const std::array<std::int64_t, 4> sides = {north, west, south, east};
        std::int64_t enter = 0, leave = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            if (!corners[i] && corners[i + 1]) enter = sides[i];
            if (corners[i] && !corners[i + 1]) leave = sides[i];
        }
        link(leave, enter);
    }

    const Coverage& coverage_;
    int width_, height_;
    std::vector<std::pair<std::int64_t, std::int64_t>> links_;
};

/// Moves every crossing to the parabola that fits its neighbours best, as long as the outline is a graph over the
/// direction across its pixel pair: straight edges become straight, curvature and area stay, corners stay. A crossing
/// that is one step of a steep edge tells nothing about the place of that edge; its position is set to NaN.
std::vector<double> fitted_positions(const std::vector<Crossing>& loop) {
    constexpr int reach = 8;
    const int n = static_cast<int>(loop.size());
    const auto position = [&](int i, bool vertical) {
        const Crossing& c = loop[static_cast<std::size_t>(((i % n) + n) % n)];
        const double x = c.column + (c.vertical ? 0.0 : c.t), y = c.row + (c.vertical ? c.t : 0.0);
        return vertical ? std::make_pair(x, y) : std::make_pair(y, x);  // (across, along)
    };
    std::vector<double> result(loop.size());
    for (int i = 0; i < n; ++i) {
        const Crossing& c = loop[static_cast<std::size_t>(i)];
        result[static_cast<std::size_t>(i)] = c.t;
        if (n < 2 * reach + 1) continue;
        const auto [s0, h0] = position(i, c.vertical);
        const double direction = position(i + 1, c.vertical).first > s0 ? 1.0 : -1.0;
        // Both sides equally, as far as the outline runs on in the same direction. Where it turns away, the last
        // crossing belongs to what comes after the corner.
        const auto ahead = [&](int k) {  // whether the step from crossing k - 1 to k on either side goes on
            return direction * (position(i - k + 1, c.vertical).first - position(i - k, c.vertical).first) > 1e-9 &&
                   direction * (position(i + k, c.vertical).first - position(i + k - 1, c.vertical).first) > 1e-9;
        };
        int used = 0;
        while (used < reach && ahead(used + 1)) ++used;
        if (used == 1 && direction * (position(i - 1, c.vertical).first - position(i - 2, c.vertical).first) < 1e-9 &&
            direction * (position(i + 2, c.vertical).first - position(i + 1, c.vertical).first) < 1e-9) {
            result[static_cast<std::size_t>(i)] = std::nan("");
        }
        if (used < reach) --used;
        if (used < 2) continue;
        double m[5] = {1, 0, 0, 0, 0}, r[3] = {h0, 0, 0};
        for (int k = -used; k <= used; ++k) {
            if (k == 0) continue;
            const auto [s, h] = position(i + k, c.vertical);
            double power = 1.0;
            for (int q = 0; q < 5; ++q, power *= s - s0) m[q] += power;
            r[0] += h, r[1] += h * (s - s0), r[2] += h * (s - s0) * (s - s0);
        }
        // Least squares h = a + b s + c s^2; a is the wanted height at s = 0 (Cramer's rule).
        const double det = m[0] * (m[2] * m[4] - m[3] * m[3]) - m[1] * (m[1] * m[4] - m[3] * m[2]) +
                           m[2] * (m[1] * m[3] - m[2] * m[2]);
        const double num = r[0] * (m[2] * m[4] - m[3] * m[3]) - m[1] * (r[1] * m[4] - m[3] * r[2]) +
                           m[2] * (r[1] * m[3] - m[2] * r[2]);
        if (!(det > 1e-12)) continue;
        const double t = num / det - (c.vertical ? c.row : c.column);
        result[static_cast<std::size_t>(i)] = std::clamp(t, 0.01, 0.99);
    }
    return result;
}

}  // namespace

double signed_area(const Loop& loop) {
    double twice = 0.0;
    for (std::size_t i = 0, j = loop.size() - 1; i < loop.size(); j = i++) {
        // Relative to a vertex, so that nothing is lost to cancellation far from the origin.
        const double ax = loop[j][0] - loop[0][0], ay = loop[j][1] - loop[0][1];
        const double bx = loop[i][0] - loop[0][0], by = loop[i][1] - loop[0][1];
        twice += ax * by - bx * ay;
    }
    return 0.5 * twice;
}

OutlineMoments moments(const Outline& outline) {
    OutlineMoments result;
    if (outline.loops.empty()) return result;
    const Point<2> o = outline.loops[0][0];
    double mx = 0.0, my = 0.0;
    for (const Loop& loop : outline.loops) {
        for (std::size_t i = 0, j = loop.size() - 1; i < loop.size(); j = i++) {
            const double ax = loop[j][0] - o[0], ay = loop[j][1] - o[1], bx = loop[i][0] - o[0], by = loop[i][1] - o[1];
            const double cross = ax * by - bx * ay;
            result.area += 0.5 * cross;
            mx += cross * (ax + bx) / 6.0;
            my += cross * (ay + by) / 6.0;
        }
    }
    result.centroid = {o[0] + mx / result.area, o[1] + my / result.area};
    for (const Loop& loop : outline.loops) {
        for (const Point<2>& p : loop) {
            result.extent_radius =
                std::max(result.extent_radius, std::hypot(p[0] - result.centroid[0], p[1] - result.centroid[1]));
        }
    }
    return result;
}

Outline outline_of(const Coverage& coverage) {
    std::vector<std::vector<Crossing>> loops = MarchingSquares(coverage).loops();
    if (MarchingSquares::antialiased_share(loops) < 0.1) {
        for (auto& loop : loops) {
            const std::vector<double> t = fitted_positions(loop);
            for (std::size_t i = 0; i < loop.size(); ++i) loop[i].t = t[i];
        }
    }
    Outline outline;
    for (const auto& loop : loops) {
        Loop& polygon = outline.loops.emplace_back();
        for (const Crossing& c : loop) {
            // Padded pixel (1, 1) is the image's pixel (0, 0), whose centre is half a pixel from its corner.
            const double column = c.column + (c.vertical ? 0.0 : c.t) - 0.5,
                         row = c.row + (c.vertical ? c.t : 0.0) - 0.5;
            const Point<2> p = {column, coverage.height - row};
            if (!std::isnan(c.t) && (polygon.empty() || polygon.back() != p)) polygon.push_back(p);
        }
        while (polygon.size() > 1 && polygon.back() == polygon.front()) polygon.pop_back();
        if (polygon.size() < 3) outline.loops.pop_back();
    }
    return outline;
}

SpeckRemoval remove_specks(Outline& outline, double fraction) {
    SpeckRemoval removal;
    double total = 0.0;
    for (const Loop& loop : outline.loops) total += signed_area(loop);
    std::erase_if(outline.loops, [&](const Loop& loop) {
        const double area = signed_area(loop);
        if (std::abs(area) >= fraction * total) return false;
        if (area > 0.0) {
            ++removal.specks;
        } else {
            ++removal.pinholes;
        }
        removal.removed_area += std::abs(area);
        return true;
    });
    return removal;
}

}  // namespace morphodesic::datasets

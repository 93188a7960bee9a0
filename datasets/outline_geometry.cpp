#include "datasets/outline_geometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace morphodesic::datasets {

namespace {

struct Segment {
    double ax, ay, bx, by;

    [[nodiscard]] double squared_distance(double x, double y) const {
        const double dx = bx - ax, dy = by - ay, px = x - ax, py = y - ay;
        const double length2 = dx * dx + dy * dy;
        const double t = length2 > 0.0 ? std::clamp((px * dx + py * dy) / length2, 0.0, 1.0) : 0.0;
        const double ex = px - t * dx, ey = py - t * dy;
        return ex * ex + ey * ey;
    }
};

/// Boxes around runs of segments in the order of the outline, halved down to a few segments.
class SegmentTree {
public:
    explicit SegmentTree(const std::vector<Segment>& segments) : segments_(segments) {
        nodes_.reserve(segments.size());
        build(0, segments.size());
    }

    /// Smallest squared distance to a segment, or the bound if none is nearer.
    [[nodiscard]] double squared_distance(double x, double y, double bound) const {
        struct Entry {
            std::size_t node;
            double squared;
        };
        std::array<Entry, 128> stack;
        std::size_t size = 0;
        stack[size++] = {0, nodes_[0].squared_distance(x, y)};
        while (size > 0) {
            const Entry entry = stack[--size];
            if (entry.squared >= bound) continue;
            const Node& node = nodes_[entry.node];
            if (node.right == 0) {
                for (std::size_t i = node.begin; i < node.end; ++i)
                    bound = std::min(bound, segments_[i].squared_distance(x, y));
                continue;
            }
            const Entry left{entry.node + 1, nodes_[entry.node + 1].squared_distance(x, y)};
            const Entry right{node.right, nodes_[node.right].squared_distance(x, y)};
            const bool left_first = left.squared <= right.squared;
            stack[size++] = left_first ? right : left;
            stack[size++] = left_first ? left : right;
        }
        return bound;
    }

private:
    struct Node {
        double low[2], high[2];
        std::size_t begin, end;
        std::size_t right;  // index of the second child, the first follows at once; 0: a leaf

        [[nodiscard]] double squared_distance(double x, double y) const {
            const double dx = std::max({low[0] - x, 0.0, x - high[0]}), dy = std::max({low[1] - y, 0.0, y - high[1]});
            return dx * dx + dy * dy;
        }
    };

    std::size_t build(std::size_t begin, std::size_t end) {
        const std::size_t self = nodes_.size();
        constexpr double infinity = std::numeric_limits<double>::infinity();
        nodes_.push_back({{infinity, infinity}, {-infinity, -infinity}, begin, end, 0});
        for (std::size_t i = begin; i < end; ++i) {
            const Segment& s = segments_[i];
            Node& node = nodes_[self];
            node.low[0] = std::min({node.low[0], s.ax, s.bx});
            node.low[1] = std::min({node.low[1], s.ay, s.by});
            node.high[0] = std::max({node.high[0], s.ax, s.bx});
            node.high[1] = std::max({node.high[1], s.ay, s.by});
        }
        if (end - begin > 4) {
            const std::size_t middle = begin + (end - begin) / 2;
            build(begin, middle);
            const std::size_t right = build(middle, end);
            nodes_[self].right = right;
        }
        return self;
    }

    const std::vector<Segment>& segments_;
    std::vector<Node> nodes_;
};

std::vector<Segment> placed_segments(const Outline& outline, const Placement<2>& placement) {
    std::vector<Segment> segments;
    for (const Loop& loop : outline.loops) {
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const Point<2> a = placement(loop[i]), b = placement(loop[(i + 1) % loop.size()]);
            segments.push_back({a[0], a[1], b[0], b[1]});
        }
    }
    return segments;
}

/// Abscissas at which the outline crosses each row of nodes, sorted: inside is between the first and the second, ...
std::vector<std::vector<double>> row_crossings(const std::vector<Segment>& segments, const DyadicGrid<2>& grid) {
    const double h = grid.spacing();
    const int n = grid.nodes_per_axis();
    std::vector<std::vector<double>> rows(static_cast<std::size_t>(n));
    for (const Segment& s : segments) {
        const double low = std::min(s.ay, s.by), high = std::max(s.ay, s.by);
        const int first = static_cast<int>(std::clamp(std::floor(low / h), 0.0, double(n - 1)));
        const int last = static_cast<int>(std::clamp(std::ceil(high / h), 0.0, double(n - 1)));
        for (int j = first; j <= last; ++j) {
            const double y = j * h;
            if ((s.ay <= y) == (s.by <= y)) continue;  // half open: a vertex on the row counts once
            rows[static_cast<std::size_t>(j)].push_back(s.ax + (y - s.ay) / (s.by - s.ay) * (s.bx - s.ax));
        }
    }
    for (auto& row : rows) std::sort(row.begin(), row.end());
    return rows;
}

}  // namespace

LevelSet<2> signed_distance(const Outline& outline, const DyadicGrid<2>& grid, const Placement<2>& placement) {
    LevelSet<2> u(grid, -std::numeric_limits<double>::infinity());
    const std::vector<Segment> segments = placed_segments(outline, placement);
    if (segments.empty()) return u;
    const SegmentTree tree(segments);
    const std::vector<std::vector<double>> crossings = row_crossings(segments, grid);
    const double h = grid.spacing();
    const int n = grid.nodes_per_axis();
    double row_start = std::numeric_limits<double>::infinity();
    for (int j = 0; j < n; ++j) {
        const std::vector<double>& row = crossings[static_cast<std::size_t>(j)];
        std::size_t passed = 0;
        double distance = row_start;
        for (int i = 0; i < n; ++i) {
            const double x = i * h, bound = distance + 1.0001 * h;  // distance functions have slope 1
            distance = std::sqrt(tree.squared_distance(x, j * h, bound * bound));
            if (i == 0) row_start = distance;
            while (passed < row.size() && row[passed] < x) ++passed;
            u.values[grid.index({i, j})] = passed % 2 == 1 ? distance : -distance;
        }
    }
    return u;
}

LevelSet<2> OutlineGeometry::signed_distance(const DyadicGrid<2>& grid, const Placement<2>& placement) const {
    return datasets::signed_distance(outline_, grid, placement);
}

ScalarField<2> OutlineGeometry::occlusion_mask(const DyadicGrid<2>& grid, const Placement<2>& placement) const {
    const Coverage& pixels = hidden_.pixels;
    if (pixels.values.empty()) return {};
    const auto pixel = [&](double x, double y) {
        if ((hidden_.left && x < 0.0) || (hidden_.right && x > pixels.width) || (hidden_.bottom && y < 0.0) ||
            (hidden_.top && y > pixels.height)) {
            return 1.0;
        }
        const int column = static_cast<int>(std::floor(std::clamp(x, 0.0, pixels.width - 1.0)));
        const int row = static_cast<int>(std::floor(std::clamp(pixels.height - y, 0.0, pixels.height - 1.0)));
        return static_cast<double>(pixels.at(column, row));
    };
    constexpr int samples = 6;  // per axis and cell
    const double h = grid.spacing();
    ScalarField<2> chi(grid);
    for (int j = 0; j < grid.nodes_per_axis(); ++j) {
        for (int i = 0; i < grid.nodes_per_axis(); ++i) {
            double hidden = 0.0;
            for (int b = 0; b < samples; ++b) {
                for (int a = 0; a < samples; ++a) {
                    const double x = (i + (a + 0.5) / samples - 0.5) * h, y = (j + (b + 0.5) / samples - 0.5) * h;
                    hidden +=
                        pixel((x - placement.offset[0]) / placement.scale, (y - placement.offset[1]) / placement.scale);
                }
            }
            chi.values[grid.index({i, j})] = 1.0 - hidden / (samples * samples);
        }
    }
    return chi;
}

RawShape<2> raw_shape_of(const ShapeSource& source, Outline outline, HiddenPixels hidden) {
    RawShape<2> raw;
    raw.source = source;
    const OutlineMoments m = moments(outline);
    raw.centroid = m.centroid;
    raw.volume = m.area;
    raw.extent_radius = m.extent_radius;
    raw.frame_low = raw.frame_high = m.centroid;
    raw.holes = 0;
    for (const Loop& loop : outline.loops) {
        ++(signed_area(loop) > 0 ? raw.components : raw.holes);
        for (const Point<2>& p : loop) {
            for (int a = 0; a < 2; ++a) {
                raw.frame_low[a] = std::min(raw.frame_low[a], p[a]);
                raw.frame_high[a] = std::max(raw.frame_high[a], p[a]);
            }
        }
    }
    raw.geometry = std::make_shared<OutlineGeometry>(std::move(outline), std::move(hidden));
    return raw;
}

}  // namespace morphodesic::datasets

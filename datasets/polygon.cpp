#include "datasets/polygon.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace morphodesic::datasets {
namespace {

void cut_quad(const std::vector<Vector3>& points, std::span<const int> corners,
              std::vector<std::array<int, 3>>& triangles) {
    const auto toward = [&](std::size_t from, std::size_t to) {
        const Vector3 v = points[corners[to % 4]] - points[corners[from]];
        return (1.0 / norm(v)) * v;
    };
    std::size_t start = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const Vector3 across = toward(i, i + 2);
        if (std::acos(dot(toward(i, i + 3), across)) + std::acos(dot(toward(i, i + 1), across)) > std::numbers::pi) {
            start = i;
            break;
        }
    }
    const auto corner = [&](std::size_t i) { return corners[(start + i) % 4]; };
    triangles.push_back({corner(0), corner(1), corner(2)});
    triangles.push_back({corner(0), corner(2), corner(3)});
}

using Point2 = std::array<double, 2>;

double area(const Point2& a, const Point2& b, const Point2& c) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}
double squared_distance(const Point2& a, const Point2& b) {
    return (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]);
}

/// The corners seen along the axis that the polygon faces most, counter-clockwise.
std::vector<Point2> flattened(const std::vector<Vector3>& points, std::span<const int> corners) {
    const Vector3 o = points[corners[0]];
    Vector3 normal{};
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
        normal = normal + cross(points[corners[i]] - o, points[corners[i + 1]] - o);
    }
    int axis = 0;
    for (int a = 1; a < 3; ++a) axis = std::abs(normal[a]) > std::abs(normal[axis]) ? a : axis;
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    if (normal[axis] < 0) std::swap(u, v);
    std::vector<Point2> flat;
    for (const int c : corners) flat.push_back({points[c][u] - o[u], points[c][v] - o[v]});
    return flat;
}

/// Cuts ears off until a triangle is left.
class EarClipping {
public:
    explicit EarClipping(std::vector<Point2> corners) : p_(std::move(corners)), shape_(p_.size()), is_cut_(p_.size()) {
        const int n = static_cast<int>(p_.size());
        double size2 = 0.0;
        for (const auto& q : p_) size2 = std::max(size2, squared_distance(q, p_[0]));
        rounding_ = 1e-7 * size2;  // coordinates have single precision
        for (int i = 0; i < n; ++i) next_.push_back((i + 1) % n), before_.push_back((i + n - 1) % n);
        for (int i = 0; i < n; ++i) {
            if (area(p_[before_[i]], p_[i], p_[next_[i]]) <= rounding_) in_the_way_.push_back(i);
        }
        for (int i = 0; i < n; ++i) shape_[i] = shape_of(i);
    }
    /// @param take  gets the three corners of each triangle
    template <class Take>
    void run(Take&& take) {
        int last = 0;
        for (std::size_t left = p_.size(); left > 3; --left) {
            int best = last;
            for (int i = next_[last]; i != last; i = next_[i]) best = shape_[i] > shape_[best] ? i : best;
            const int a = before_[best], c = next_[best];
            take(a, best, c);
            is_cut_[best] = 1;
            next_[a] = c, before_[c] = a;
            shape_[a] = shape_of(a), shape_[c] = shape_of(c);
            last = a;
        }
        take(before_[last], last, next_[last]);
    }

private:
    /// Area over the square of the longest side of the ear at a corner: larger is better; of what is no ear negative.
    [[nodiscard]] double shape_of(int i) const {
        const Point2 &a = p_[before_[i]], &b = p_[i], &c = p_[next_[i]];
        const double s = area(a, b, c);
        const double longest2 = std::max({squared_distance(a, b), squared_distance(b, c), squared_distance(c, a)});
        const double shape = longest2 > 0 ? s / longest2 : 0.0;  // at most 1
        if (s <= rounding_) return shape - 2.0;
        for (const int k : in_the_way_) {
            if (is_cut_[k] != 0 || k == i || k == before_[i] || k == next_[i]) continue;
            const Point2& q = p_[k];
            if (q == a || q == b || q == c) continue;
            if (area(a, b, q) >= -rounding_ && area(b, c, q) >= -rounding_ && area(c, a, q) >= -rounding_) {
                return shape - 2.0;
            }
        }
        return shape;
    }

    std::vector<Point2> p_;
    std::vector<double> shape_;
    std::vector<char> is_cut_;
    std::vector<int> next_, before_;
    std::vector<int> in_the_way_;  ///< corners that are not convex: only they can lie within an ear
    double rounding_ = 0.0;
};

}  // namespace

void cut_polygon(const std::vector<Vector3>& points, std::span<const int> corners,
                 std::vector<std::array<int, 3>>& triangles) {
    if (corners.size() == 3) {
        triangles.push_back({corners[0], corners[1], corners[2]});
    } else if (corners.size() == 4) {
        cut_quad(points, corners, triangles);
    } else {
        EarClipping(flattened(points, corners)).run([&](int a, int b, int c) {
            triangles.push_back({corners[a], corners[b], corners[c]});
        });
    }
}

}  // namespace morphodesic::datasets

#include "datasets/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "datasets/interruption.h"

namespace morphodesic::datasets {
namespace {

constexpr double accuracy = 2.3;  // a node is far if it is more than this many radii away
constexpr int leaf_size = 8;

/// Solid angle of a triangle seen from the origin (van Oosterom, Strackee 1983).
double solid_angle(const Vector3& a, const Vector3& b, const Vector3& c) {
    const double la = norm(a), lb = norm(b), lc = norm(c);
    const double numerator = dot(a, cross(b, c));
    const double denominator = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
    return 2.0 * std::atan2(numerator, denominator);
}

double box_distance2(const Vector3& x, const Vector3& low, const Vector3& high) {
    double sum = 0.0;
    for (int a = 0; a < 3; ++a) {
        const double d = std::max({low[a] - x[a], x[a] - high[a], 0.0});
        sum += d * d;
    }
    return sum;
}

/// Point of a triangle nearest to x (Ericson, Real-Time Collision Detection, 5.1.5).
Vector3 nearest_on_triangle(const Vector3& x, const std::array<Vector3, 3>& c) {
    const Vector3 ab = c[1] - c[0], ac = c[2] - c[0], ax = x - c[0];
    const double d1 = dot(ab, ax), d2 = dot(ac, ax);
    if (d1 <= 0 && d2 <= 0) return c[0];
    const Vector3 bx = x - c[1];
    const double d3 = dot(ab, bx), d4 = dot(ac, bx);
    if (d3 >= 0 && d4 <= d3) return c[1];
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return c[0] + (d1 / (d1 - d3)) * ab;
    const Vector3 cx = x - c[2];
    const double d5 = dot(ab, cx), d6 = dot(ac, cx);
    if (d6 >= 0 && d5 <= d6) return c[2];
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return c[0] + (d2 / (d2 - d6)) * ac;
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
        return c[1] + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (c[2] - c[1]);
    }
    const double sum = va + vb + vc;
    return c[0] + (vb / sum) * ab + (vc / sum) * ac;
}

}  // namespace

TriangleTree::TriangleTree(const TriangleMesh& mesh) {
    if (mesh.triangles.empty()) throw std::invalid_argument("TriangleTree: no triangles");
    centres_.reserve(mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        triangles_.push_back(mesh.corners(t));
        const auto& c = triangles_.back();
        centres_.push_back((1.0 / 3.0) * (c[0] + c[1] + c[2]));
    }
    nodes_.reserve(2 * triangles_.size() / leaf_size + 16);
    nodes_.emplace_back();
    nodes_[0].last = static_cast<int>(triangles_.size());
    // Children are appended behind their parents, so the list grows while it is walked.
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
        interruption_point();
        build(static_cast<int>(n));
    }
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
        dipoles_.push_back(0.5 * area_vector(triangles_[t]));
        double radius2 = 0.0;
        for (const auto& c : triangles_[t]) radius2 = std::max(radius2, dot(c - centres_[t], c - centres_[t]));
        far_.push_back(16.0 * radius2);
    }
}

void TriangleTree::build(int number) {
    Node node = nodes_[number];
    node.low.fill(std::numeric_limits<double>::max());
    node.high.fill(std::numeric_limits<double>::lowest());
    double area = 0.0;
    for (int t = node.first; t < node.last; ++t) {
        for (const auto& c : triangles_[t]) {
            for (int a = 0; a < 3; ++a) {
                node.low[a] = std::min(node.low[a], c[a]);
                node.high[a] = std::max(node.high[a], c[a]);
            }
        }
        const Vector3 n = 0.5 * area_vector(triangles_[t]);
        node.dipole = node.dipole + n;
        node.centre = node.centre + norm(n) * centres_[t];
        area += norm(n);
    }
    node.centre = area > 0 ? (1.0 / area) * node.centre : 0.5 * (node.low + node.high);
    for (int t = node.first; t < node.last; ++t) {
        const Vector3 n = 0.5 * area_vector(triangles_[t]), r = centres_[t] - node.centre;
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) node.moment[3 * i + j] += r[i] * n[j];
        }
        for (const auto& c : triangles_[t]) node.radius = std::max(node.radius, norm(c - node.centre));
    }
    if (node.last - node.first > leaf_size) {
        const Vector3 side = node.high - node.low;
        const int axis = static_cast<int>(std::max_element(side.begin(), side.end()) - side.begin());
        const int middle = (node.first + node.last) / 2;
        std::vector<int> order(node.last - node.first);
        std::iota(order.begin(), order.end(), node.first);
        std::nth_element(order.begin(), order.begin() + (middle - node.first), order.end(), [&](int a, int b) {
            return centres_[a][axis] != centres_[b][axis] ? centres_[a][axis] < centres_[b][axis] : a < b;
        });
        std::vector<std::array<Vector3, 3>> t(order.size());
        std::vector<Vector3> c(order.size());
        for (std::size_t i = 0; i < order.size(); ++i) t[i] = triangles_[order[i]], c[i] = centres_[order[i]];
        std::copy(t.begin(), t.end(), triangles_.begin() + node.first);
        std::copy(c.begin(), c.end(), centres_.begin() + node.first);
        node.child = static_cast<int>(nodes_.size());
        Node left, right;
        left.first = node.first, left.last = right.first = middle, right.last = node.last;
        nodes_.push_back(left);
        nodes_.push_back(right);
    }
    nodes_[number] = node;
}

double TriangleTree::winding_number(const Vector3& x) const {
    std::array<int, 128> stack;
    int top = 0;
    stack[top++] = 0;
    double angle = 0.0;
    while (top > 0) {
        const Node& node = nodes_[stack[--top]];
        const Vector3 r = node.centre - x;
        const double distance2 = dot(r, r);
        if (distance2 > accuracy * accuracy * node.radius * node.radius) {
            // Taylor expansion of the integral of n . r / |r|^3 about the centre, two terms.
            const double inv = 1.0 / std::sqrt(distance2), inv3 = inv * inv * inv;
            double second = 0.0;
            for (int i = 0; i < 3; ++i) {
                for (int j = 0; j < 3; ++j) second += r[i] * r[j] * node.moment[3 * i + j];
            }
            const double trace = node.moment[0] + node.moment[4] + node.moment[8];
            angle += inv3 * (dot(node.dipole, r) + trace - 3.0 * second * inv * inv);
        } else if (node.child < 0) {
            for (int t = node.first; t < node.last; ++t) {
                const Vector3 s = centres_[t] - x;
                const double s2 = dot(s, s);
                if (s2 > far_[t]) {
                    angle += dot(dipoles_[t], s) / (s2 * std::sqrt(s2));
                    continue;
                }
                const auto& c = triangles_[t];
                angle += solid_angle(c[0] - x, c[1] - x, c[2] - x);
            }
        } else {
            stack[top++] = node.child;
            stack[top++] = node.child + 1;
        }
    }
    return angle / (4.0 * std::numbers::pi);
}

bool TriangleTree::is_blocked(const Vector3& origin, const Vector3& direction) const {
    Vector3 inverse;
    for (int a = 0; a < 3; ++a) inverse[a] = 1.0 / (direction[a] != 0 ? direction[a] : 1e-300);
    std::array<int, 128> stack;
    int top = 0;
    stack[top++] = 0;
    while (top > 0) {
        const Node& node = nodes_[stack[--top]];
        double near = 0.0, far = std::numeric_limits<double>::max();
        for (int a = 0; a < 3; ++a) {
            const double s = (node.low[a] - origin[a]) * inverse[a], t = (node.high[a] - origin[a]) * inverse[a];
            near = std::max(near, std::min(s, t));
            far = std::min(far, std::max(s, t));
        }
        if (near > far) continue;
        if (node.child >= 0) {
            stack[top++] = node.child;
            stack[top++] = node.child + 1;
            continue;
        }
        for (int t = node.first; t < node.last; ++t) {  // Moeller, Trumbore 1997
            const auto& c = triangles_[t];
            const Vector3 e1 = c[1] - c[0], e2 = c[2] - c[0], p = cross(direction, e2);
            const double det = dot(e1, p);
            if (det == 0.0) continue;
            const Vector3 s = origin - c[0], q = cross(s, e1);
            const double u = dot(s, p) / det, v = dot(direction, q) / det;
            if (u >= 0 && v >= 0 && u + v <= 1 && dot(e2, q) / det > 0) return true;
        }
    }
    return false;
}

TriangleTree::Nearest TriangleTree::nearest(const Vector3& x, double bound) const {
    double best2 = bound * bound;
    struct Entry {
        int node;
        double distance2;
    };
    std::array<Entry, 128> stack;
    int top = 0;
    stack[top++] = {0, box_distance2(x, nodes_[0].low, nodes_[0].high)};
    int found = -1;
    Vector3 point{};
    while (top > 0) {
        const Entry entry = stack[--top];
        if (entry.distance2 >= best2) continue;
        const Node& node = nodes_[entry.node];
        if (node.child < 0) {
            for (int t = node.first; t < node.last; ++t) {
                const Vector3 p = nearest_on_triangle(x, triangles_[t]);
                const double d2 = dot(x - p, x - p);
                if (d2 < best2) best2 = d2, found = t, point = p;
            }
            continue;
        }
        const Node &a = nodes_[node.child], &b = nodes_[node.child + 1];
        Entry near{node.child, box_distance2(x, a.low, a.high)}, far{node.child + 1, box_distance2(x, b.low, b.high)};
        if (near.distance2 > far.distance2) std::swap(near, far);
        stack[top++] = far;
        stack[top++] = near;
    }
    return found < 0 ? Nearest{bound, {}, x} : Nearest{std::sqrt(best2), 2.0 * dipoles_[found], point};
}

}  // namespace morphodesic::datasets

#include "geodesic/grid/measures.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "geodesic/grid/moments.h"

namespace morphodesic {

namespace {

template <int Dim>
Point<Dim> between(const Point<Dim>& a, const Point<Dim>& b, double fa, double fb) {
    const double s = fa / (fa - fb);
    Point<Dim> x{};
    for (std::size_t c = 0; c < Dim; ++c) x[c] = a[c] + s * (b[c] - a[c]);
    return x;
}

Point<3> difference(const Point<3>& a, const Point<3>& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Point<3> cross(const Point<3>& a, const Point<3>& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double size(const Point<3>& a) {
    return std::hypot(a[0], a[1], a[2]);
}
double triangle(const Point<3>& a, const Point<3>& b, const Point<3>& c) {
    return 0.5 * size(cross(difference(b, a), difference(c, a)));
}
double tetrahedron(const Point<3>& a, const Point<3>& b, const Point<3>& c, const Point<3>& d) {
    const Point<3> n = cross(difference(b, a), difference(c, a)), e = difference(d, a);
    return std::abs(n[0] * e[0] + n[1] * e[1] + n[2] * e[2]) / 6.0;
}
double whole(const std::array<Point<2>, 3>& x) {
    return 0.5 * std::abs((x[1][0] - x[0][0]) * (x[2][1] - x[0][1]) - (x[1][1] - x[0][1]) * (x[2][0] - x[0][0]));
}
double whole(const std::array<Point<3>, 4>& x) {
    return tetrahedron(x[0], x[1], x[2], x[3]);
}

}  // namespace

template <int Dim>
detail::SimplexPart detail::simplex_part(const std::array<Point<Dim>, Dim + 1>& x,
                                         const std::array<double, Dim + 1>& f) {
    std::array<std::size_t, Dim + 1> order;
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return f[a] > f[b]; });
    const auto inside = static_cast<std::size_t>(std::count_if(f.begin(), f.end(), [](double v) { return v > 0; }));
    SimplexPart part;
    const double all = whole(x);
    if (inside == 0) return part;
    if (inside == Dim + 1) {
        part.volume = all;
        return part;
    }
    const auto cut = [&](std::size_t a, std::size_t b) {
        return between<Dim>(x[order[a]], x[order[b]], f[order[a]], f[order[b]]);
    };
    if (inside == 1 || inside == Dim) {  // one corner is cut off
        const std::size_t corner = inside == 1 ? 0 : Dim;
        double share = 1.0;
        std::array<Point<Dim>, Dim> cuts;
        std::size_t count = 0;
        for (std::size_t other = 0; other <= Dim; ++other) {
            if (other == corner) continue;
            share *= f[order[corner]] / (f[order[corner]] - f[order[other]]);
            cuts[count++] = cut(corner, other);
        }
        part.volume = inside == 1 ? share * all : (1.0 - share) * all;
        if constexpr (Dim == 2) {
            part.surface = std::hypot(cuts[0][0] - cuts[1][0], cuts[0][1] - cuts[1][1]);
        } else {
            part.surface = triangle(cuts[0], cuts[1], cuts[2]);
        }
        return part;
    }
    if constexpr (Dim == 3) {  // two corners inside: a prism from corner 0 to corner 1
        const Point<3> ac = cut(0, 2), ad = cut(0, 3), bc = cut(1, 2), bd = cut(1, 3);
        const Point<3>&a = x[order[0]], &b = x[order[1]];
        part.volume = tetrahedron(a, ac, ad, bd) + tetrahedron(a, ac, bc, bd) + tetrahedron(a, b, bc, bd);
        part.surface = triangle(ac, ad, bd) + triangle(ac, bd, bc);
    }
    return part;
}

template <int Dim>
ShapeMeasures measure(const LevelSet<Dim>& u) {
    const auto& grid = u.grid;
    ShapeMeasures result;
    detail::for_each_simplex<Dim>(grid, [&](const auto& nodes) {
        std::array<Point<Dim>, Dim + 1> x;
        std::array<double, Dim + 1> f;
        bool any = false;
        for (std::size_t i = 0; i <= Dim; ++i) {
            f[i] = u.values[grid.index(nodes[i])];
            any = any || f[i] > 0;
        }
        if (!any) return;
        for (std::size_t i = 0; i <= Dim; ++i) x[i] = grid.position(nodes[i]);
        const auto part = detail::simplex_part<Dim>(x, f);
        result.volume += part.volume;
        result.surface += part.surface;
    });

    // Every face of the triangulation is a chain of offsets 0 < o_1 < ... < o_m (as sets of axes) from its first node.
    std::vector<std::size_t> parent(grid.node_count());
    std::iota(parent.begin(), parent.end(), std::size_t{0});
    const auto root = [&](std::size_t i) {
        while (parent[i] != i) i = parent[i] = parent[parent[i]];
        return i;
    };
    constexpr unsigned full = (1U << Dim) - 1;
    const auto count = [&](const auto& self, const typename DyadicGrid<Dim>::Index& first, unsigned last,
                           int sign) -> int {
        int sum = sign;
        for (unsigned o = last + 1; o <= full; ++o) {
            if ((o & last) != last) continue;
            auto node = first;
            bool within = true;
            for (std::size_t a = 0; a < Dim; ++a) {
                node[a] += static_cast<int>(o >> a & 1U);
                within = within && node[a] < grid.nodes(static_cast<int>(a));
            }
            if (!within || !(u.values[grid.index(node)] > 0)) continue;
            if (last == 0) parent[root(grid.index(node))] = root(grid.index(first));
            sum += self(self, first, o, -sign);
        }
        return sum;
    };
    for (std::size_t i = 0; i < grid.node_count(); ++i) {
        if (u.values[i] > 0) result.euler += count(count, grid.node(i), 0, 1);
    }
    for (std::size_t i = 0; i < grid.node_count(); ++i) result.components += u.values[i] > 0 && root(i) == i;
    return result;
}

template <int Dim>
double fullness(const LevelSet<Dim>& u) {
    const double h = u.grid.spacing();
    const Moments<Dim> moments(u);
    if (!(moments.volume > 0.0)) return 0.0;
    double surface = 0.0;  // in faces of cells
    for (const double value : u.values) surface += std::max(0.0, 0.5 - 0.25 * std::abs(value) / h);  // a hat of 4 h
    const double gyration = std::sqrt(moments.covariance.trace()) / h;
    const auto of = [](double v, double g, double s) {
        return v / std::pow(g, Dim) * std::pow(v, (Dim - 1.0) / Dim) / s;
    };
    const double unit_ball = Dim == 2 ? std::numbers::pi : 4.0 / 3.0 * std::numbers::pi;
    return of(moments.volume, gyration, surface) / of(unit_ball, std::sqrt(Dim / (Dim + 2.0)), Dim * unit_ball);
}

template double fullness<2>(const LevelSet<2>&);
template double fullness<3>(const LevelSet<3>&);
template detail::SimplexPart detail::simplex_part<2>(const std::array<Point<2>, 3>&, const std::array<double, 3>&);
template detail::SimplexPart detail::simplex_part<3>(const std::array<Point<3>, 4>&, const std::array<double, 4>&);
template ShapeMeasures measure<2>(const LevelSet<2>&);
template ShapeMeasures measure<3>(const LevelSet<3>&);

}  // namespace morphodesic

#include "geodesic/grid/contour.h"

#include <algorithm>
#include <array>
#include <map>

namespace morphodesic {

std::vector<ContourLoop> contour(const LevelSet<2>& u, double value) {
    const int n = u.grid.nodes_per_axis();
    const double h = u.grid.spacing();
    const auto at = [&](int i, int j) {
        if (i < 0 || j < 0 || i >= n || j >= n) return -h;
        return u.values[u.grid.index({i, j})] - value;
    };
    // Grid edges of the grid with one more row of nodes all around; edge (node, axis) has the number 2 node + axis.
    const int side = n + 2;
    const auto edge = [&](int i, int j, int axis) { return 2 * ((j + 1) * side + i + 1) + axis; };
    std::map<int, std::pair<int, Point<2>>> next;  // edge -> following edge, crossing on the edge
    for (int j = -1; j < n; ++j) {
        for (int i = -1; i < n; ++i) {
            const std::array<double, 4> f{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)};
            const std::array<std::array<int, 2>, 4> corner{{{i, j}, {i + 1, j}, {i + 1, j + 1}, {i, j + 1}}};
            const std::array<int, 4> edges{edge(i, j, 0), edge(i + 1, j, 1), edge(i, j + 1, 0), edge(i, j, 1)};
            const bool middle = f[0] + f[1] + f[2] + f[3] > 0;
            int crossings = 0;
            for (std::size_t e = 0; e < 4; ++e) crossings += (f[e] > 0) != (f[(e + 1) % 4] > 0);
            for (std::size_t e = 0; e < 4; ++e) {
                const std::size_t to = (e + 1) % 4;
                if (!(f[e] > 0 && f[to] <= 0)) continue;  // counter-clockwise around the cell, leaving the object
                // The contour goes on to the edge where the object is entered: the next one around the corner outside,
                // or the one before it around the corner inside.
                std::size_t enter = e;
                const std::size_t turn = crossings == 4 && !middle ? 3 : 1;
                do {
                    enter = (enter + turn) % 4;
                } while (!(f[enter] <= 0 && f[(enter + 1) % 4] > 0));
                const double s = f[e] / (f[e] - f[to]);
                Point<2> x{};
                for (std::size_t a = 0; a < 2; ++a) x[a] = h * (corner[e][a] + s * (corner[to][a] - corner[e][a]));
                next[edges[e]] = {edges[enter], x};
            }
        }
    }
    std::vector<ContourLoop> loops;
    while (!next.empty()) {
        ContourLoop loop;
        for (auto it = next.begin(); it != next.end();) {
            const int following = it->second.first;
            loop.push_back(it->second.second);
            next.erase(it);
            it = next.find(following);
        }
        loops.push_back(std::move(loop));
    }
    return loops;
}

}  // namespace morphodesic

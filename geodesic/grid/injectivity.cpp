#include "geodesic/grid/injectivity.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "geodesic/grid/node_loop.h"
#include "geodesic/grid/q1_element.h"
#include "geodesic/kernels/vector_kernels.h"

namespace morphodesic {

namespace {

template <int Dim>
double determinant_of(const double (&a)[Dim][Dim]) {
    if constexpr (Dim == 2) {
        return a[0][0] * a[1][1] - a[0][1] * a[1][0];
    } else {
        return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
               a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
    }
}

/// The least det D phi at the corners of a cell; there D phi has the differences along the cell's edges as columns.
template <int Dim>
double least_corner(const double (&w)[Dim][1 << Dim], double inverse_h) {
    double least = std::numeric_limits<double>::infinity();
    for (int c = 0; c < (1 << Dim); ++c) {
        double a[Dim][Dim];
        for (int i = 0; i < Dim; ++i) {
            for (int j = 0; j < Dim; ++j) {
                a[i][j] = (i == j ? 1.0 : 0.0) + (w[i][c | (1 << j)] - w[i][c & ~(1 << j)]) * inverse_h;
            }
        }
        const double det = determinant_of<Dim>(a);
        if (!(det >= least)) least = det;  // keeps a NaN
    }
    return least;
}

/// Cheap lower bound: columns of B = D phi - I are convex combinations of edge differences, so with b the largest
/// absolute row sum of these, every eigenvalue of B is at most b in size and det(I + B) >= (1 - b)^Dim for b < 1.
template <int Dim>
double quick_bound(const double (&w)[Dim][1 << Dim], double inverse_h) {
    double b = 0.0;
    const auto raise = [](double& value, double other) {  // the larger one, and NaN if either is
        if (!(other <= value) && !std::isnan(value)) value = other;
    };
    for (int i = 0; i < Dim; ++i) {
        double row = 0.0;
        for (int j = 0; j < Dim; ++j) {
            double most = 0.0;
            for (int c = 0; c < (1 << Dim); ++c) {
                if (!(c >> j & 1)) raise(most, std::abs(w[i][c | (1 << j)] - w[i][c]));
            }
            row += most * inverse_h;
        }
        raise(b, row);
    }
    return b < 1.0 ? std::pow(1.0 - b, Dim) : 0.0;
}

/// Least Bernstein coefficient of det over the box [low, low + size]^3 of the unit cell.
double least_bernstein(const double (&w)[3][8], double inverse_h, const Point<3>& low, double size, int splits) {
    // Column j of D phi does not depend on coordinate j and is linear in the two others: nine values each.
    double column[3][3][3][3];  // [j][second coordinate][first coordinate][component]
    for (int j = 0; j < 3; ++j) {
        const int first = j == 0 ? 1 : 0, second = j == 2 ? 1 : 2;
        double edge[4][3];
        for (int e = 0; e < 4; ++e) {
            const int c = ((e & 1) << first) | ((e >> 1) << second);
            for (int i = 0; i < 3; ++i) {
                edge[e][i] = (i == j ? 1.0 : 0.0) + (w[i][c | (1 << j)] - w[i][c]) * inverse_h;
            }
        }
        for (int t = 0; t < 3; ++t) {
            for (int s = 0; s < 3; ++s) {
                const double x = low[static_cast<std::size_t>(first)] + 0.5 * s * size;
                const double y = low[static_cast<std::size_t>(second)] + 0.5 * t * size;
                for (int i = 0; i < 3; ++i) {
                    column[j][t][s][i] =
                        (1 - y) * ((1 - x) * edge[0][i] + x * edge[1][i]) + y * ((1 - x) * edge[2][i] + x * edge[3][i]);
                }
            }
        }
    }
    double f[3][3][3];
    for (int k = 0; k < 3; ++k) {
        for (int j = 0; j < 3; ++j) {
            for (int i = 0; i < 3; ++i) {
                const double *c0 = column[0][k][j], *c1 = column[1][k][i], *c2 = column[2][j][i];
                f[k][j][i] = c0[0] * (c1[1] * c2[2] - c1[2] * c2[1]) - c0[1] * (c1[0] * c2[2] - c1[2] * c2[0]) +
                             c0[2] * (c1[0] * c2[1] - c1[1] * c2[0]);
            }
        }
    }
    const bool folds = !(*std::min_element(&f[0][0][0], &f[0][0][0] + 27) > 0);  // certainly: no use in splitting
    // Values at 0, 1/2, 1 to Bernstein coefficients: b0 = f0, b1 = 2 f(1/2) - (f0 + f1) / 2, b2 = f1.
    for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) f[a][b][1] = 2 * f[a][b][1] - 0.5 * (f[a][b][0] + f[a][b][2]);
    }
    for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) f[a][1][b] = 2 * f[a][1][b] - 0.5 * (f[a][0][b] + f[a][2][b]);
    }
    for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) f[1][a][b] = 2 * f[1][a][b] - 0.5 * (f[0][a][b] + f[2][a][b]);
    }
    const double least = *std::min_element(&f[0][0][0], &f[0][0][0] + 27);
    if (least > 0 || splits == 0 || folds) return least;
    double refined = std::numeric_limits<double>::infinity();
    for (int c = 0; c < 8; ++c) {
        Point<3> corner = low;
        for (int a = 0; a < 3; ++a) corner[a] += (c >> a & 1) ? 0.5 * size : 0.0;
        refined = std::min(refined, least_bernstein(w, inverse_h, corner, 0.5 * size, splits - 1));
    }
    return refined;
}

template <int Dim, class View>
void load_cell(const DyadicGrid<Dim>& grid, const View& displacement, std::size_t node, double (&w)[Dim][1 << Dim]) {
    const auto offsets = q1::corner_offsets(grid);
    for (int a = 0; a < Dim; ++a) {
        for (int c = 0; c < (1 << Dim); ++c) {
            w[a][c] = displacement[static_cast<std::size_t>(a)][node + offsets[static_cast<std::size_t>(c)]];
        }
    }
}

/// Lower bound of det D phi in a cell, exact in 2D; where the cheap bound is at least `enough`, that one.
template <int Dim, class View>
double cell_bound(const DyadicGrid<Dim>& grid, const View& displacement, std::size_t node, double enough) {
    double w[Dim][1 << Dim];
    load_cell(grid, displacement, node, w);
    const double inverse_h = grid.cells_per_unit();
    if constexpr (Dim == 2) {
        return least_corner<2>(w, inverse_h);
    } else {
        const double quick = quick_bound<3>(w, inverse_h);
        if (quick > 0 && quick >= enough) return quick;
        return least_bernstein(w, inverse_h, {0.0, 0.0, 0.0}, 1.0, 3);
    }
}

/// visit(row of cells on the last axis, index of the first node of a cell)
template <int Dim, class Visitor>
void for_cells_of_row(const DyadicGrid<Dim>& grid, int row, Visitor&& visit) {
    typename DyadicGrid<Dim>::Index i{};
    i[Dim - 1] = row;
    for (int y = 0; y < (Dim == 3 ? grid.cells(1) : 1); ++y) {
        if (Dim == 3) i[1] = y;
        for (i[0] = 0; i[0] < grid.cells(0); ++i[0]) visit(grid.index(i));
    }
}

/// Cells whose bound is below the threshold.
template <int Dim, class View>
std::vector<std::size_t> bad_cells(const DyadicGrid<Dim>& grid, const View& displacement, double threshold) {
    std::vector<std::vector<std::size_t>> per_row(static_cast<std::size_t>(grid.cells(Dim - 1)));
    for_indices(0, grid.cells(Dim - 1), [&](int row) {
        for_cells_of_row(grid, row, [&](std::size_t node) {
            if (!(cell_bound(grid, displacement, node, threshold) >= threshold))
                per_row[static_cast<std::size_t>(row)].push_back(node);
        });
    });
    std::vector<std::size_t> all;
    for (const auto& row : per_row) all.insert(all.end(), row.begin(), row.end());
    return all;
}

/// Whether a node is the first one of a cell.
template <int Dim>
bool has_cell(const DyadicGrid<Dim>& grid, const typename DyadicGrid<Dim>::Index& i) {
    for (int a = 0; a < Dim; ++a) {
        if (i[static_cast<std::size_t>(a)] < 0 || i[static_cast<std::size_t>(a)] >= grid.cells(a)) return false;
    }
    return true;
}

/// Visits the indices low + [from, to] on every axis.
template <class Index, class Visitor>
void for_box(const Index& low, int to, int from, Visitor&& visit) {
    Index i = low;
    for (int& c : i) c += from;
    while (true) {
        visit(i);
        std::size_t a = 0;
        while (a < i.size() && ++i[a] > low[a] + to) {
            i[a] = low[a] + from;
            ++a;
        }
        if (a == i.size()) return;
    }
}

}  // namespace

template <int Dim>
double det_lower_bound(const DyadicGrid<Dim>& grid, const DisplacementView<Dim>& displacement) {
    std::vector<double> least(static_cast<std::size_t>(grid.cells(Dim - 1)), std::numeric_limits<double>::infinity());
    for_indices(0, grid.cells(Dim - 1), [&](int row) {
        double& bound = least[static_cast<std::size_t>(row)];
        for_cells_of_row(grid, row, [&](std::size_t node) {
            const double here = cell_bound(grid, displacement, node, bound);
            if (!(here >= bound)) bound = here;
        });
    });
    double bound = std::numeric_limits<double>::infinity();
    for (const double value : least) {
        if (!(value >= bound)) bound = value;
    }
    return bound;
}

template <int Dim>
std::vector<double> least_node_det(const DyadicGrid<Dim>& grid, const DisplacementView<Dim>& displacement) {
    std::vector<double> cell(grid.node_count(), std::numeric_limits<double>::infinity());  // at the cell's first node
    for_indices(0, grid.cells(Dim - 1), [&](int row) {
        for_cells_of_row(grid, row, [&](std::size_t node) {
            double w[Dim][1 << Dim];
            load_cell(grid, displacement, node, w);
            cell[node] = least_corner<Dim>(w, grid.cells_per_unit());
        });
    });
    // Axis after axis: the least of the two cells before and after the node.
    for (int a = 0; a < Dim; ++a) {
        const std::size_t stride = grid.stride(a);
        for (std::size_t i = cell.size(); i-- > stride;) cell[i] = std::min(cell[i], cell[i - stride]);
    }
    return cell;
}

template <int Dim>
int repair_folds(const DyadicGrid<Dim>& grid, const std::array<double*, Dim>& displacement, double threshold,
                 int most) {
    auto bad = bad_cells(grid, displacement, threshold);
    const int folded = static_cast<int>(bad.size());
    if (folded > most) return folded;
    std::array<std::size_t, Dim> stride;
    for (std::size_t a = 0; a < Dim; ++a) stride[a] = grid.stride(static_cast<int>(a));

    constexpr int rounds = 60;
    std::vector<double> smoothed;
    std::vector<std::size_t> nodes, cells;
    // The round that listed a node or cell last: each is listed once a round.
    std::vector<int> node_seen(bad.empty() ? 0 : grid.node_count(), -1), cell_seen = node_seen;
    const auto list = [](std::vector<std::size_t>& items, std::vector<int>& seen, std::size_t i, int round) {
        if (std::exchange(seen[i], round) != round) items.push_back(i);
    };
    for (int round = 0; round < rounds && !bad.empty(); ++round) {
        const int reach = round / 6;
        nodes.clear();
        cells.clear();
        for (const std::size_t cell : bad) {
            const auto low = grid.node(cell);
            for_box(low, 1 + reach, -reach, [&](const auto& i) {  // nodes of the cell and `reach` beyond
                for (int a = 0; a < Dim; ++a) {
                    if (i[static_cast<std::size_t>(a)] <= 0 || i[static_cast<std::size_t>(a)] >= grid.cells(a)) return;
                }
                list(nodes, node_seen, grid.index(i), round);
            });
            for_box(low, 1 + reach, -1 - reach, [&](const auto& i) {  // the cells these nodes belong to
                if (!has_cell(grid, i)) return;
                list(cells, cell_seen, grid.index(i), round);
            });
        }
        smoothed.resize(nodes.size());
        for (double* w : displacement) {
            for (std::size_t k = 0; k < nodes.size(); ++k) {
                double sum = 0.0;
                for (const std::size_t s : stride) sum += w[nodes[k] + s] + w[nodes[k] - s];
                smoothed[k] = 0.5 * w[nodes[k]] + 0.5 * sum / (2 * Dim);
            }
            for (std::size_t k = 0; k < nodes.size(); ++k) w[nodes[k]] = smoothed[k];
        }
        bad.clear();
        for (const std::size_t cell : cells) {
            if (!(cell_bound(grid, displacement, cell, threshold) >= threshold)) bad.push_back(cell);
        }
    }
    while (!bad.empty()) {
        for (double* w : displacement) {
            for (std::size_t i = 0; i < grid.node_count(); ++i) w[i] = std::isfinite(w[i]) ? 0.8 * w[i] : 0.0;
        }
        bad = bad_cells(grid, displacement, threshold);
    }
    return folded;
}

template <int Dim>
int limit_change(const DyadicGrid<Dim>& grid, const DisplacementView<Dim>& displacement,
                 const std::array<float*, Dim>& change, double keep) {
    const double inverse_h = grid.cells_per_unit();
    const auto cells = static_cast<std::size_t>(grid.cells(0));
    const auto stride = grid.strides();
    const auto squeezed = [&](std::size_t node, std::size_t count, unsigned char* flag) {
        const double* w[Dim];
        const float* d[Dim];
        for (std::size_t a = 0; a < Dim; ++a) {
            w[a] = displacement[a] + node;
            d[a] = change[a] + node;
        }
        return kernels::squeezed_cells<Dim>(count, w, d, stride, inverse_h, keep, flag);
    };

    std::vector<std::size_t> bad;
    for_marked_cells(
        grid, [&](std::size_t row, unsigned char* flags) { return squeezed(row, cells, flags); },
        [&](std::size_t cell) { bad.push_back(cell); });
    const int count = static_cast<int>(bad.size());
    constexpr int rounds = 12;
    std::vector<std::size_t> around;
    std::vector<int> node_seen(bad.empty() ? 0 : grid.node_count(), -1), cell_seen = node_seen;
    for (int round = 0; round < rounds && !bad.empty(); ++round) {
        around.clear();
        for (const std::size_t cell : bad) {
            const auto low = grid.node(cell);
            for_box(low, 1, 0, [&](const auto& i) {
                const std::size_t node = grid.index(i);
                if (std::exchange(node_seen[node], round) == round) return;
                for (float* d : change) d[node] *= 0.5F;
            });
            for_box(low, 1, -1, [&](const auto& i) {  // the cells these nodes belong to
                if (!has_cell(grid, i)) return;
                const std::size_t at = grid.index(i);
                if (std::exchange(cell_seen[at], round) != round) around.push_back(at);
            });
        }
        bad.clear();
        for (const std::size_t cell : around) {
            unsigned char flag = 0;
            if (squeezed(cell, 1, &flag)) bad.push_back(cell);
        }
    }
    return count;
}

template double det_lower_bound<2>(const DyadicGrid<2>&, const DisplacementView<2>&);
template double det_lower_bound<3>(const DyadicGrid<3>&, const DisplacementView<3>&);
template std::vector<double> least_node_det<2>(const DyadicGrid<2>&, const DisplacementView<2>&);
template std::vector<double> least_node_det<3>(const DyadicGrid<3>&, const DisplacementView<3>&);
template int repair_folds<2>(const DyadicGrid<2>&, const std::array<double*, 2>&, double, int);
template int repair_folds<3>(const DyadicGrid<3>&, const std::array<double*, 3>&, double, int);
template int limit_change<2>(const DyadicGrid<2>&, const DisplacementView<2>&, const std::array<float*, 2>&, double);
template int limit_change<3>(const DyadicGrid<3>&, const DisplacementView<3>&, const std::array<float*, 3>&, double);

}  // namespace morphodesic

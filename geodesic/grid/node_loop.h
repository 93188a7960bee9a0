#pragma once

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "geodesic/grid/dyadic_grid.h"

namespace morphodesic {

/// body(i) for begin <= i < end, in parallel. A waiting thread does not wander into other work.
template <class Body>
void for_indices(int begin, int end, const Body& body) {
    oneapi::tbb::this_task_arena::isolate([&] { oneapi::tbb::parallel_for(begin, end, body); });
}

/// body(first node) for every row of nodes along axis 0, in parallel. A waiting thread does not wander into other work.
template <int Dim, class Body>
void for_rows(const DyadicGrid<Dim>& grid, const Body& body) {
    const auto n = static_cast<std::size_t>(grid.nodes(0));
    oneapi::tbb::this_task_arena::isolate([&] {
        oneapi::tbb::parallel_for(std::size_t{0}, grid.node_count() / n, [&](std::size_t row) { body(row * n); });
    });
}

/// body(i) for every node, in parallel over the rows.
template <int Dim, class Body>
void for_nodes(const DyadicGrid<Dim>& grid, const Body& body) {
    for_rows(grid, [&](std::size_t row) {
        for (std::size_t i = row; i < row + static_cast<std::size_t>(grid.nodes(0)); ++i) body(i);
    });
}

/// body(i, its index on each axis) for one node after the other.
template <int Dim, class Body>
void for_each_node(const DyadicGrid<Dim>& grid, const Body& body) {
    typename DyadicGrid<Dim>::Index node{};
    for (std::size_t i = 0; i < grid.node_count(); ++i) {
        body(i, node);
        for (std::size_t a = 0; a < Dim && ++node[a] == grid.nodes(static_cast<int>(a)); ++a) node[a] = 0;
    }
}

/// visit(first node) for cells that are marked, in the order of the grid, if their index on the last axis lies in
/// [begin, end). mark(node, flags) marks those of the row that starts at a node in flags, [cells of a row], and says
/// whether there is any.
template <int Dim, class Mark, class Visitor>
void for_marked_cells(const DyadicGrid<Dim>& grid, int begin, int end, const Mark& mark, const Visitor& visit) {
    const auto cells = static_cast<std::size_t>(grid.cells(0));
    static thread_local std::vector<unsigned char> flags;  // loops run often, and neither body starts another one
    flags.resize(cells);
    typename DyadicGrid<Dim>::Index low{};
    for (low[Dim - 1] = begin; low[Dim - 1] < end; ++low[Dim - 1]) {
        const int middle_rows = Dim == 3 ? grid.cells(1) : 1;
        for (int middle = 0; middle < middle_rows; ++middle) {
            if constexpr (Dim == 3) low[1] = middle;
            const std::size_t row = grid.index(low);
            if (!mark(row, flags.data())) continue;
            for (std::size_t i = 0; i < cells; ++i) {
                if (flags[i]) visit(row + i);
            }
        }
    }
}

/// The same for all cells.
template <int Dim, class Mark, class Visitor>
void for_marked_cells(const DyadicGrid<Dim>& grid, const Mark& mark, const Visitor& visit) {
    for_marked_cells(grid, 0, grid.cells(Dim - 1), mark, visit);
}

/// Zero at the nodes on the boundary.
template <int Dim, class T>
void clear_boundary(const DyadicGrid<Dim>& grid, T* field) {
    const auto row = static_cast<std::size_t>(grid.nodes(0)), rows = static_cast<std::size_t>(grid.nodes(1));
    const int planes = Dim == 3 ? grid.nodes(Dim - 1) : 1;
    for (int plane = 0; plane < planes; ++plane) {
        T* base = field + static_cast<std::size_t>(plane) * rows * row;
        if (Dim == 3 && (plane == 0 || plane == planes - 1)) {
            std::fill(base, base + rows * row, T{});
            continue;
        }
        std::fill(base, base + row, T{});
        std::fill(base + row * (rows - 1), base + row * rows, T{});
        for (std::size_t j = 1; j + 1 < rows; ++j) base[j * row] = base[j * row + row - 1] = T{};
    }
}

}  // namespace morphodesic

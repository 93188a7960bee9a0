#pragma once

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cstddef>

#include "geodesic/grid/dyadic_grid.h"

namespace morphodesic {

/// body(i) for begin <= i < end, in parallel. A waiting thread does not wander into other work.
template <class Body>
void for_indices(int begin, int end, const Body& body) {
    oneapi::tbb::this_task_arena::isolate([&] { oneapi::tbb::parallel_for(begin, end, body); });
}

/// body(i) for every node, in parallel over the rows of axis 0. A waiting thread does not wander into other work.
template <int Dim, class Body>
void for_nodes(const DyadicGrid<Dim>& grid, const Body& body) {
    const auto n = static_cast<std::size_t>(grid.nodes(0));
    oneapi::tbb::this_task_arena::isolate([&] {
        oneapi::tbb::parallel_for(std::size_t{0}, grid.node_count() / n, [&](std::size_t row) {
            for (std::size_t i = row * n; i < (row + 1) * n; ++i) body(i);
        });
    });
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

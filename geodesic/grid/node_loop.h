#pragma once

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

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
    const auto n = static_cast<std::size_t>(grid.nodes_per_axis());
    oneapi::tbb::this_task_arena::isolate([&] {
        oneapi::tbb::parallel_for(std::size_t{0}, grid.node_count() / n, [&](std::size_t row) {
            for (std::size_t i = row * n; i < (row + 1) * n; ++i) body(i);
        });
    });
}

}  // namespace morphodesic

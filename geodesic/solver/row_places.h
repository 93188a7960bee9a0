#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geodesic/grid/dyadic_grid.h"
#include "geodesic/kernels/place_kernel.h"

namespace morphodesic {

/// A place for each node of a row along axis 0, in units of h, and values there.
template <int Dim>
class RowPlaces {
public:
    /// The nodes themselves.
    /// @param row  the first node of the row
    RowPlaces(const DyadicGrid<Dim>& grid, std::size_t row)
        : count_(static_cast<std::size_t>(grid.nodes(0))), width_(whole_vectors(count_)), x_(Dim * width_) {
        std::copy(grid.cells().begin(), grid.cells().end(), cells_);
        const auto first = grid.node(row);
        for (std::size_t a = 0; a < Dim; ++a) {
            // What fills up the last vector repeats the last node.
            for (std::size_t i = 0; i < width_; ++i)
                (*this)[a][i] = a == 0 ? static_cast<double>(std::min(i, count_ - 1)) : first[a];
        }
    }

    [[nodiscard]] std::size_t count() const { return count_; }
    [[nodiscard]] double* operator[](std::size_t axis) { return x_.data() + axis * width_; }
    [[nodiscard]] const double* operator[](std::size_t axis) const { return x_.data() + axis * width_; }

    /// As kernels take them; longer than count().
    [[nodiscard]] kernels::Places<Dim> all() {
        kernels::Places<Dim> places{width_, {}};
        for (std::size_t a = 0; a < Dim; ++a) places.x[a] = (*this)[a];
        return places;
    }

    /// Values of a Q1 function on this grid at the places; longer than count(), until the next call.
    template <class T>
    const double* sample(const T* field) {
        values_.resize(width_);
        kernels::sample<Dim, T>(cells_, field, all(), values_.data());
        return values_.data();
    }

    /// Moves the places, from where they are, to the x that w takes to those of `y`: x + share w(x) = y.
    /// @param near_enough  residual that is good enough, in units of h
    void solve(RowPlaces& y, const std::array<const double*, Dim>& w, int cells_per_unit, double share,
               double near_enough, int iterations) {
        kernels::Inversion<Dim> problem{{}, {}, cells_per_unit, share, near_enough, iterations};
        std::copy(cells_, cells_ + Dim, problem.cells);
        std::copy(w.begin(), w.end(), problem.w);
        kernels::invert<Dim>(problem, y.all(), all());
    }

    /// Where the places, in units of the cells of `grid`, are in it: first nodes of their cells and places in these,
    /// [count()].
    void locate(const DyadicGrid<Dim>& grid, std::uint32_t* node, const std::array<float*, Dim>& fraction) {
        int cells[Dim];
        std::copy(grid.cells().begin(), grid.cells().end(), cells);
        std::vector<std::uint32_t> nodes(width_);
        std::vector<float> fractions(Dim * width_);
        float* out[Dim];
        for (std::size_t a = 0; a < Dim; ++a) out[a] = fractions.data() + a * width_;
        kernels::locate<Dim>(cells, all(), nodes.data(), out);
        std::copy_n(nodes.begin(), count_, node);
        for (std::size_t a = 0; a < Dim; ++a) std::copy_n(out[a], count_, fraction[a]);
    }

private:
    static std::size_t whole_vectors(std::size_t count) {
        return (count + kernels::place_lanes - 1) / kernels::place_lanes * kernels::place_lanes;
    }

    int cells_[Dim];
    std::size_t count_, width_;
    std::vector<double> x_, values_;
};

}  // namespace morphodesic

#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>

namespace morphodesic {

/// A point or vector of the unit cube [0,1]^Dim; axis 0 is x (to the right), axis 1 is y (up), axis 2 is z.
template <int Dim>
using Point = std::array<double, Dim>;

/// Nodes of the regular grid with 2^level + 1 nodes per axis on [0,1]^Dim, or of a box of its cells with a corner at
/// the origin. Storage order everywhere: axis 0 runs fastest, index = i0 + n0 (i1 + n1 i2) with n_a = nodes(a).
template <int Dim>
class DyadicGrid {
public:
    static_assert(Dim == 2 || Dim == 3);
    using Index = std::array<int, Dim>;

    explicit constexpr DyadicGrid(int level = 0) : level_(level) { cells_.fill(1 << level); }
    /// A box of so many cells per axis.
    constexpr DyadicGrid(int level, const Index& cells) : level_(level), cells_(cells) {}

    [[nodiscard]] constexpr int level() const { return level_; }
    [[nodiscard]] constexpr int cells_per_unit() const { return 1 << level_; }
    /// Grid size h = 2^-level.
    [[nodiscard]] constexpr double spacing() const { return 1.0 / cells_per_unit(); }

    [[nodiscard]] constexpr int cells(int axis) const { return cells_[static_cast<std::size_t>(axis)]; }
    [[nodiscard]] constexpr int nodes(int axis) const { return cells(axis) + 1; }
    [[nodiscard]] constexpr const Index& cells() const { return cells_; }
    [[nodiscard]] constexpr bool is_cube() const { return *this == DyadicGrid(level_); }
    /// Of the grid on the whole cube, which shapes live on.
    [[nodiscard]] constexpr int cells_per_axis() const {
        assert(is_cube());
        return 1 << level_;
    }
    [[nodiscard]] constexpr int nodes_per_axis() const { return cells_per_axis() + 1; }

    [[nodiscard]] constexpr std::size_t node_count() const {
        std::size_t count = 1;
        for (int a = 0; a < Dim; ++a) count *= static_cast<std::size_t>(nodes(a));
        return count;
    }
    [[nodiscard]] constexpr std::size_t cell_count() const {
        std::size_t count = 1;
        for (int a = 0; a < Dim; ++a) count *= static_cast<std::size_t>(cells(a));
        return count;
    }

    /// Distance in memory of neighbours on an axis.
    [[nodiscard]] constexpr std::size_t stride(int axis) const {
        std::size_t result = 1;
        for (int a = 0; a < axis; ++a) result *= static_cast<std::size_t>(nodes(a));
        return result;
    }
    /// The same for all axes, signed as kernels take it.
    [[nodiscard]] constexpr std::array<std::ptrdiff_t, Dim> strides() const {
        std::array<std::ptrdiff_t, Dim> result{};
        for (int a = 0; a < Dim; ++a) result[static_cast<std::size_t>(a)] = static_cast<std::ptrdiff_t>(stride(a));
        return result;
    }
    [[nodiscard]] constexpr std::size_t index(const Index& i) const {
        std::size_t result = static_cast<std::size_t>(i[Dim - 1]);
        for (int a = Dim - 2; a >= 0; --a) {
            result = result * static_cast<std::size_t>(nodes(a)) + static_cast<std::size_t>(i[a]);
        }
        return result;
    }
    [[nodiscard]] constexpr Index node(std::size_t index) const {
        Index result{};
        for (int a = 0; a < Dim; ++a) {
            const auto n = static_cast<std::size_t>(nodes(a));
            result[a] = static_cast<int>(index % n);
            index /= n;
        }
        return result;
    }
    [[nodiscard]] constexpr bool on_boundary(const Index& i) const {
        for (int a = 0; a < Dim; ++a) {
            if (i[a] == 0 || i[a] == cells(a)) return true;
        }
        return false;
    }
    [[nodiscard]] constexpr Point<Dim> position(const Index& i) const {
        Point<Dim> x{};
        for (int a = 0; a < Dim; ++a) x[a] = i[a] * spacing();
        return x;
    }

    /// The same box with cells half or twice as wide. Halving takes even numbers of cells.
    [[nodiscard]] constexpr bool can_be_coarser() const {
        return level_ > 0 && std::all_of(cells_.begin(), cells_.end(), [](int n) { return n % 2 == 0; });
    }
    [[nodiscard]] constexpr DyadicGrid coarser() const {
        assert(can_be_coarser());
        Index half = cells_;
        for (int& n : half) n /= 2;
        return {level_ - 1, half};
    }
    [[nodiscard]] constexpr DyadicGrid finer() const {
        Index twice = cells_;
        for (int& n : twice) n *= 2;
        return {level_ + 1, twice};
    }

    friend constexpr bool operator==(const DyadicGrid&, const DyadicGrid&) = default;

private:
    int level_;
    Index cells_{};
};

}  // namespace morphodesic

#pragma once

#include <array>
#include <cstddef>

namespace morphodesic {

/// A point or vector of the unit cube [0,1]^Dim; axis 0 is x (to the right), axis 1 is y (up), axis 2 is z.
template <int Dim>
using Point = std::array<double, Dim>;

/// Nodes of the regular grid with 2^level + 1 nodes per axis on [0,1]^Dim.
/// Storage order everywhere: axis 0 runs fastest, index = i0 + n (i1 + n i2) with n = nodes_per_axis().
template <int Dim>
class DyadicGrid {
public:
    static_assert(Dim == 2 || Dim == 3);
    using Index = std::array<int, Dim>;

    explicit constexpr DyadicGrid(int level = 0) : level_(level) {}

    [[nodiscard]] constexpr int level() const { return level_; }
    [[nodiscard]] constexpr int cells_per_axis() const { return 1 << level_; }
    [[nodiscard]] constexpr int nodes_per_axis() const { return (1 << level_) + 1; }
    /// Grid size h = 2^-level.
    [[nodiscard]] constexpr double spacing() const { return 1.0 / cells_per_axis(); }

    [[nodiscard]] constexpr std::size_t node_count() const { return power(nodes_per_axis()); }
    [[nodiscard]] constexpr std::size_t cell_count() const { return power(cells_per_axis()); }

    [[nodiscard]] constexpr std::size_t index(const Index& i) const {
        const auto n = static_cast<std::size_t>(nodes_per_axis());
        std::size_t result = static_cast<std::size_t>(i[Dim - 1]);
        for (int a = Dim - 2; a >= 0; --a) result = result * n + static_cast<std::size_t>(i[a]);
        return result;
    }
    [[nodiscard]] constexpr Index node(std::size_t index) const {
        const auto n = static_cast<std::size_t>(nodes_per_axis());
        Index result{};
        for (int a = 0; a < Dim; ++a, index /= n) result[a] = static_cast<int>(index % n);
        return result;
    }
    [[nodiscard]] constexpr Point<Dim> position(const Index& i) const {
        Point<Dim> x{};
        for (int a = 0; a < Dim; ++a) x[a] = i[a] * spacing();
        return x;
    }

    friend constexpr bool operator==(const DyadicGrid&, const DyadicGrid&) = default;

private:
    static constexpr std::size_t power(int n) {
        std::size_t result = 1;
        for (int a = 0; a < Dim; ++a) result *= static_cast<std::size_t>(n);
        return result;
    }
    int level_;
};

}  // namespace morphodesic

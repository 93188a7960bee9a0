#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace morphodesic::kernels {

/// Quadrature of a cell. All points of a rule weigh the same, and polynomials of third order are exact, as with 2 Gauss
/// points per axis. Unlike those, the points have different coordinates on every axis: a minimiser finds contours that
/// lie between quadrature points, where the mismatch does not see them, and with 2 Gauss points per axis (0.58 h apart)
/// it reported energies that were half of the true ones. How much a rule overlooks: with S(G) = mean over its points x
/// of exp(2 pi i G.x), for integer vectors G, and t = 2 pi 0.35 |G| (a rim of 0.35 h decays as (1 + t) exp(-t)), the
/// root of the sum of |S (1 + t) exp(-t)|^2 over G != 0 is 0.212 for 2 x 2 Gauss points, 0.090 for `few`, 0.074 for 3 x
/// 3 Gauss points and 0.029 for `many`; in 3D 0.265, 0.134, 0.092 (27 Gauss points) and 0.083.
enum class Quadrature {
    few,   ///< 5 points in 2D, 9 in 3D: for rims at least a cell wide
    many,  ///< 8 points in 2D, 14 in 3D: for narrower rims
};

namespace quadrature {

/// Pairs of points at opposite places of the cell.
template <int Dim, std::size_t Pairs>
constexpr auto around_middle(const double (&offsets)[Pairs][Dim]) {
    std::array<std::array<double, Dim>, 2 * Pairs> points{};
    for (std::size_t p = 0; p < Pairs; ++p) {
        for (std::size_t a = 0; a < Dim; ++a) {
            points[2 * p][a] = 0.5 + offsets[p][a];
            points[2 * p + 1][a] = 0.5 - offsets[p][a];
        }
    }
    return points;
}

/// The same and the middle.
template <int Dim, std::size_t Pairs>
constexpr auto middle_and_around(const double (&offsets)[Pairs][Dim]) {
    constexpr auto pairs = 2 * Pairs;
    const auto around = around_middle<Dim, Pairs>(offsets);
    std::array<std::array<double, Dim>, pairs + 1> points{};
    for (std::size_t p = 0; p < pairs; ++p) points[p] = around[p];
    for (std::size_t a = 0; a < Dim; ++a) points[pairs][a] = 0.5;
    return points;
}

// A square around the middle, turned as in the lattice of (1, 2) and (2, -1) and scaled to exact second moments.
constexpr double unit = 0.20412414523193150818;  // 1 / sqrt(24)
constexpr double few_2d[2][2] = {{unit, 2 * unit}, {2 * unit, -unit}};
// Two squares, sizes and turns by numerical minimisation of the sum above.
constexpr double many_2d[4][2] = {{0.2505759062440174, 0.4541942556623280},
                                  {0.4541942556623280, -0.2505759062440174},
                                  {-0.0390520525212178, 0.2504547141911023},
                                  {0.2504547141911023, 0.0390520525212178}};
// The middle and a turned cube; a turned cube and a turned octahedron, likewise.
constexpr double few_3d[4][3] = {{-0.2540541156093309, -0.1072323663455540, 0.4529985937614970},
                                 {-0.1072328196562308, 0.4530017615316505, 0.2540482758016595},
                                 {-0.3061808312862630, 0.3061889322835132, -0.3061888899028429},
                                 {0.4530021272393631, 0.2540451955936913, 0.1072385719430053}};
constexpr double many_3d[7][3] = {{0.3139915469078978, -0.1484654148880635, 0.4846991887360493},
                                  {-0.3405919133443768, -0.3256167445616503, 0.3654269540337346},
                                  {0.1768678792434957, 0.4949796666948418, 0.2815650144450750},
                                  {0.4777155810087789, -0.3178283370212550, -0.1622927797427602},
                                  {-0.0219452763328063, 0.1303818537397821, 0.3029263019012107},
                                  {0.3144418261503863, -0.0832771809734574, 0.0586226612993033},
                                  {0.0994490328528920, 0.2920802127258550, -0.1185090988917404}};

template <int Dim, Quadrature Rule>
constexpr auto points_of() {
    if constexpr (Dim == 2 && Rule == Quadrature::few) return middle_and_around<2>(few_2d);
    if constexpr (Dim == 2 && Rule == Quadrature::many) return around_middle<2>(many_2d);
    if constexpr (Dim == 3 && Rule == Quadrature::few) return middle_and_around<3>(few_3d);
    if constexpr (Dim == 3 && Rule == Quadrature::many) return around_middle<3>(many_3d);
}

/// The points of a rule in the unit cell [0,1]^Dim.
template <int Dim, Quadrature Rule>
inline constexpr auto points = points_of<Dim, Rule>();

}  // namespace quadrature

/// The same for a rule known at run time, [points][Dim].
template <int Dim>
constexpr std::span<const std::array<double, Dim>> quadrature_points(Quadrature rule) {
    if (rule == Quadrature::few) return quadrature::points<Dim, Quadrature::few>;
    return quadrature::points<Dim, Quadrature::many>;
}

}  // namespace morphodesic::kernels

#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "geodesic/energy/path_energy.h"

namespace morphodesic {

/// Keeps the shapes between from becoming steep where their contours are: on edges and diagonals of cells that the
/// contour of u_k crosses, u_k changes by at most `steepest` times their length.
///
/// H_eps(u) of a steep u jumps within a part of a cell, which the quadrature points do not resolve; a minimiser finds
/// that out and hides the mismatch of cracks between them. Distances, for which eps is meant, have the slope 1.
template <int Dim>
class SlopeLimit {
public:
    static constexpr double steepest = 2.0;

    explicit SlopeLimit(const PathLayout<Dim>& layout);

    /// Scales both values of an edge that is too steep by one factor, so that the contour stays where it is; of several
    /// factors a node takes the least.
    void apply(std::span<double> x);
    /// After apply(x): clears the gradient at those nodes where a descent would be taken back by the next apply().
    void hold(std::span<const double> x, std::span<float> gradient) const;

private:
    struct Scaled {
        std::size_t node;
        double factor;
    };
    void list_steep(const double* u, std::size_t node, double limit, std::vector<Scaled>& scaled) const;

    PathLayout<Dim> layout_;
    std::vector<std::vector<Scaled>> scaled_;  // by the last apply(), k = 0..K-1, by node
};

}  // namespace morphodesic

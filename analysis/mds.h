#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "analysis/distance_matrix.h"

namespace morphodesic::analysis {

/// Points of n items. Units: those of the distances.
struct Embedding {
    std::size_t dimensions = 0;
    std::vector<double> coordinates;  ///< row-major [n x dimensions]
    [[nodiscard]] std::size_t size() const { return dimensions == 0 ? 0 : coordinates.size() / dimensions; }
    [[nodiscard]] double operator()(std::size_t item, std::size_t axis) const {
        return coordinates[item * dimensions + axis];
    }
};

/// Condensed Euclidean distances of the points.
[[nodiscard]] std::vector<double> embedded_distances(const Embedding& embedding);

/// Centroid to the origin, axes along the principal directions in order of decreasing variance, and the point with the
/// largest absolute value on each axis on the positive side: the same picture from every run.
void orient_to_principal_axes(Embedding& embedding);

struct ClassicalScaling {
    Embedding embedding;              ///< columns scaled by sqrt(eigenvalue); 0 where the eigenvalue is not positive
    std::vector<double> eigenvalues;  ///< the largest of the centred matrix B = -J D^2 J / 2, decreasing (up to ten)
};

/// Classical (Torgerson) scaling: the best inner products of rank `dimensions`. For more than 400 items only the
/// largest eigenvalues are computed (Lanczos with restarts, library Spectra).
/// @param dimensions >= 1; more than n - 1 give columns of zeros
/// @throws std::invalid_argument if a distance is missing
[[nodiscard]] ClassicalScaling classical_mds(const DistanceMatrix& distances, std::size_t dimensions);

}  // namespace morphodesic::analysis

#pragma once

#include <span>

#include "analysis/mds.h"

namespace morphodesic::analysis {

struct Procrustes {
    Embedding aligned;   ///< the moved embedding, turned, mirrored, moved (and scaled) onto the reference
    double scale = 1.0;  ///< 1 unless scaling was allowed
    double rms_distance =
        0.0;  ///< root mean square distance of corresponding points afterwards, units of the reference
};

/// Best fit of `moved` onto `reference` in the sense of least squares by a rigid motion with reflection.
/// @param allow_scaling also a common factor
/// @throws std::invalid_argument if they differ in points or dimensions
/// Source: Gower 1975; Kabsch's solution by singular values, determinant not restricted.
[[nodiscard]] Procrustes procrustes(const Embedding& reference, const Embedding& moved, bool allow_scaling = false);

/// Place of a query in a given embedding: the point x that minimises sum_j (|x - x_j| - d_j)^2 over the known d_j,
/// found by majorisation from several starts (nearest items, centroid, Gower's formula for an added point);
/// deterministic.
struct Placement {
    std::vector<double> position;  ///< [dimensions]
    double stress = 0.0;           ///< sqrt(sum (|x - x_j| - d_j)^2 / sum d_j^2), 0 if all d_j are 0
};
/// @param query_distances one per item of the embedding, NaN where missing
/// @throws std::invalid_argument if the lengths differ or no distance is known
[[nodiscard]] Placement place_query(const Embedding& embedding, std::span<const double> query_distances);

}  // namespace morphodesic::analysis

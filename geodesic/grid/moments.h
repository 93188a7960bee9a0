#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "geodesic/grid/fields.h"

namespace morphodesic {

/// Volume, centroid and second moments of the object {u > 0}. A node counts by the share of its cell that a straight
/// contour at its distance leaves: no tails as those of H_eps, which would pull the centroid to the middle of the cube.
/// @param u  signed distance; without an object the volume is 0, and so is all the rest
template <int Dim>
struct Moments {
    using Vector = Eigen::Matrix<double, Dim, 1>;

    double volume = 0.0;  ///< in cells
    Vector centroid = Vector::Zero();
    Eigen::Matrix<double, Dim, Dim> covariance = Eigen::Matrix<double, Dim, Dim>::Zero();

    explicit Moments(const LevelSet<Dim>& u) {
        const auto visit = [&](auto&& add) {
            for (std::size_t i = 0; i < u.values.size(); ++i) {
                const double share = std::clamp(0.5 + u.values[i] / u.grid.spacing(), 0.0, 1.0);
                if (!(share > 0.0)) continue;
                const Point<Dim> x = u.grid.position(u.grid.node(i));
                add(share, Eigen::Map<const Vector>(x.data()));
            }
        };
        visit([&](double share, const auto& x) {
            volume += share;
            centroid += share * x;
        });
        if (!(volume > 0.0)) return;
        centroid /= volume;
        visit([&](double share, const auto& x) {
            const Vector d = x - centroid;
            covariance += share / volume * d * d.transpose();
        });
    }
};

}  // namespace morphodesic

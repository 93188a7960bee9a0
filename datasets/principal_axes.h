#pragma once

#include <Eigen/Eigenvalues>

#include "datasets/triangle_mesh.h"

namespace morphodesic::datasets {

struct PrincipalAxes {
    Vector3 mean{};
    Eigen::Vector3d variances;  ///< along the axes, ascending, >= 0 up to rounding
    Eigen::Matrix3d axes;       ///< columns of length 1: the first is the normal of the plane that fits best

    /// Coordinates of a direction along the axes.
    [[nodiscard]] Eigen::Vector3d along(const Vector3& d) const {
        return axes.transpose() * Eigen::Vector3d(d[0], d[1], d[2]);
    }
    [[nodiscard]] Vector3 normal() const { return {axes(0, 0), axes(1, 0), axes(2, 0)}; }
};

/// @param count  of points, > 0
/// @param point  (index below count) -> Vector3
template <class Point>
PrincipalAxes principal_axes(std::size_t count, Point&& point) {
    PrincipalAxes result;
    const double share = 1.0 / static_cast<double>(count);
    for (std::size_t i = 0; i < count; ++i) result.mean = result.mean + share * point(i);
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < count; ++i) {
        const Vector3 d = point(i) - result.mean;
        const Eigen::Vector3d e(d[0], d[1], d[2]);
        covariance += share * e * e.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
    result.variances = solver.eigenvalues();
    result.axes = solver.eigenvectors();
    return result;
}

}  // namespace morphodesic::datasets

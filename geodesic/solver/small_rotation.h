#pragma once

#include <Eigen/Dense>

namespace morphodesic {

/// Rotation by a small angle (2D: one number, 3D: axis times angle). For .cpp files: brings Eigen.
template <int Dim>
Eigen::Matrix<double, Dim, Dim> small_rotation(const Eigen::VectorXd& angles) {
    if constexpr (Dim == 2) {
        return Eigen::Rotation2D<double>(angles(0)).toRotationMatrix();
    } else {
        const Eigen::Vector3d w = angles.head<3>();
        const double angle = w.norm();
        if (angle < 1e-14) return Eigen::Matrix3d::Identity();
        return Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
    }
}

}  // namespace morphodesic

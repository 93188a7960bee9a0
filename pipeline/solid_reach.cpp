#include "pipeline/solid_reach.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "geodesic/grid/moments.h"
#include "geodesic/grid/transfer.h"
#include "geodesic/solver/path_window.h"

namespace morphodesic::pipeline {
namespace {

constexpr int reach_level = 5;
/// Ratio of variances from which on two principal axes are told apart.
constexpr double clear_ratio = 1.5;
/// What the shapes between may bulge and alignments may differ from that of centroids and axes, besides the cell of
/// level 5 by which reaches are larger than the shapes.
constexpr double slack = 0.01;

/// Half the side of the box of the cylinder about an axis, along axis a of the cube.
double half_side(const SolidReach::Axis& size, const SolidReach::Axis& place, std::size_t a) {
    const double cosine = std::min(std::abs(place.direction[a]), 1.0);
    return size.along * cosine + size.across * std::sqrt(1.0 - cosine * cosine);
}

/// The same of the box along all principal axes, which all are laid on those of the other solid.
double half_side_of_box(const SolidReach& size, const SolidReach& place, std::size_t a) {
    const double first = std::abs(place.longest.direction[a]), last = std::abs(place.shortest.direction[a]);
    const double between = std::sqrt(std::max(1.0 - first * first - last * last, 0.0));
    return size.longest.along * first + size.between * between + size.shortest.along * last;
}

}  // namespace

SolidReach SolidReach::scaled(double factor) const {
    SolidReach result = *this;
    for (std::size_t a = 0; a < 3; ++a) result.low[a] *= factor, result.high[a] *= factor;
    result.radius *= factor;
    result.between *= factor;
    for (Axis* axis : {&result.longest, &result.shortest}) axis->along *= factor, axis->across *= factor;
    return result;
}

SolidReach reach_of(const LevelSet<3>& u) {
    const LevelSet<3> coarse = restricted(u, std::min(u.grid.level(), reach_level));
    const double h = coarse.grid.spacing();
    const Moments<3> moments(coarse);
    if (!(moments.volume > 0.0)) return reach_of_ball(0.5);
    // With the nodes that are less than a cell outside: no part is so thin that all of it lies between nodes.
    std::vector<Eigen::Vector3d> near;  // seen from the centroid
    for (std::size_t i = 0; i < coarse.values.size(); ++i) {
        if (coarse.values[i] <= -h) continue;
        const auto p = coarse.grid.position(coarse.grid.node(i));
        near.push_back(Eigen::Vector3d(p[0], p[1], p[2]) - moments.centroid);
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(moments.covariance);  // increasing
    const Eigen::Vector3d variance = axes.eigenvalues();
    SolidReach reach;
    const auto cylinder = [&](int which, bool clear) {
        SolidReach::Axis axis;
        axis.clear = clear;
        const Eigen::Vector3d d = axes.eigenvectors().col(which);
        axis.direction = {d[0], d[1], d[2]};
        for (const auto& p : near) {
            const double along = d.dot(p);
            axis.along = std::max(axis.along, std::abs(along));
            axis.across = std::max(axis.across, (p - along * d).norm());
        }
        return axis;
    };
    reach.longest = cylinder(2, variance[2] > clear_ratio * variance[1]);
    reach.shortest = cylinder(0, variance[1] > clear_ratio * variance[0]);
    const Eigen::Vector3d between = axes.eigenvectors().col(1);
    for (const auto& p : near) {
        reach.between = std::max(reach.between, std::abs(between.dot(p)));
        reach.radius = std::max(reach.radius, p.norm());
        for (int a = 0; a < 3; ++a) {
            const auto at = static_cast<std::size_t>(a);
            reach.low[at] = std::min(reach.low[at], p[a]);
            reach.high[at] = std::max(reach.high[at], p[a]);
        }
    }
    return reach;
}

SolidReach reach_of_ball(double radius) {
    SolidReach reach;
    reach.low.fill(-radius);
    reach.high.fill(radius);
    reach.radius = radius;
    return reach;
}

double window_share(const SolidReach& moved, const SolidReach& fixed, int level, bool rigid) {
    std::array<double, 3> sides;
    for (std::size_t a = 0; a < 3; ++a) {
        double below = -moved.low[a], above = moved.high[a];
        if (rigid) {
            double half = moved.radius;
            const bool longest = moved.longest.clear && fixed.longest.clear;
            const bool shortest = moved.shortest.clear && fixed.shortest.clear;
            if (longest) half = std::min(half, half_side(moved.longest, fixed.longest, a));
            if (shortest) half = std::min(half, half_side(moved.shortest, fixed.shortest, a));
            if (longest && shortest) half = std::min(half, half_side_of_box(moved, fixed, a));
            below = above = half;
        }
        sides[a] = std::max(above, fixed.high[a]) + std::max(below, -fixed.low[a]) + 2 * slack;
    }
    return morphodesic::window_share<3>(level, sides);
}

double largest_window_share(std::span<const SolidReach> reaches, int level, bool rigid) {
    double largest = 0.0;
    for (const SolidReach& moved : reaches) {
        for (const SolidReach& fixed : reaches) {
            if (&moved != &fixed) largest = std::max(largest, window_share(moved, fixed, level, rigid));
            if (largest == 1.0) return largest;
        }
    }
    return largest > 0.0 ? largest : 1.0;
}

}  // namespace morphodesic::pipeline

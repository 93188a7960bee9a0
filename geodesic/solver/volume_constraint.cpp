#include "geodesic/solver/volume_constraint.h"

#include <algorithm>
#include <cmath>

namespace morphodesic {

namespace {

/// Volume and its derivative under a shift of u, both by the ramp clamp(1/2 + u / (2 h), 0, 1).
template <int Dim>
double ramp_volume(const DyadicGrid<Dim>& grid, const double* u, double shift, double* derivative) {
    const double h = grid.spacing(), node = std::pow(h, Dim);
    double volume = 0.0, rim = 0.0;
    for (std::size_t i = 0; i < grid.node_count(); ++i) {
        const double v = u[i] + shift;
        if (v >= h) {
            volume += 1.0;
        } else if (v > -h) {
            volume += 0.5 + 0.5 * v / h;
            rim += 0.5 / h;
        }
    }
    if (derivative) *derivative = rim * node;
    return volume * node;
}

}  // namespace

template <int Dim>
double enclosed_volume(const DyadicGrid<Dim>& grid, const double* u) {
    return ramp_volume<Dim>(grid, u, 0.0, nullptr);
}

template <int Dim>
VolumeConstraint<Dim>::VolumeConstraint(const PathEnergy<Dim>& energy) : layout_(energy.layout()) {
    const int steps = layout_.time_steps;
    const double first = enclosed_volume(layout_.grid, energy.first().values.data());
    const double last = enclosed_volume(layout_.grid, energy.last().values.data());
    for (int k = 0; k <= steps; ++k) target_.push_back(first + (last - first) * k / steps);
}

template <int Dim>
bool VolumeConstraint<Dim>::correct(std::span<double> x) const {
    for (int k = 1; k < layout_.time_steps; ++k) {
        double* u = x.data() + layout_.level_set(k);
        const double target = target_[static_cast<std::size_t>(k)], h = layout_.grid.spacing();
        const auto [least, most] = std::minmax_element(u, u + layout_.nodes());
        if (!(*most > -h)) return false;  // vanished: there is no contour to shift
        // Newton; where no node is near the contour of a steep level set, the middle of what encloses the shift.
        double low = -*most - h, high = h - *least, shift = 0.0;
        bool found = false;
        for (int iteration = 0; iteration < 100; ++iteration) {
            double derivative = 0.0;
            const double error = ramp_volume(layout_.grid, u, shift, &derivative) - target;
            found = std::abs(error) <= 1e-10 * target;
            if (found) break;
            (error > 0.0 ? high : low) = shift;
            shift = derivative > 0.0 ? shift - std::clamp(error / derivative, -h, h) : low;
            if (!(shift > low && shift < high)) shift = 0.5 * (low + high);
        }
        if (!found) return false;
        for (std::size_t i = 0; i < layout_.nodes(); ++i) u[i] += shift;
    }
    return true;
}

template <int Dim>
template <class Body>
void VolumeConstraint<Dim>::for_each_shape(std::span<const double> x, const Body& body) const {
    const double h = layout_.grid.spacing();
    std::vector<double> normal(layout_.nodes());
    for (int k = 1; k < layout_.time_steps; ++k) {
        const double* u = x.data() + layout_.level_set(k);
        double sum = 0.0;
        for (std::size_t i = 0; i < normal.size(); ++i) sum += normal[i] = std::abs(u[i]) < h ? 1.0 : 0.0;
        if (sum > 0) body(layout_.level_set(k), normal, sum);
    }
}

template <int Dim>
void VolumeConstraint<Dim>::project_gradient(std::span<const double> x, std::span<float> gradient) const {
    for_each_shape(x, [&](std::size_t at, const std::vector<double>& normal, double sum) {
        double total = 0.0;
        for (std::size_t i = 0; i < normal.size(); ++i) total += static_cast<double>(gradient[at + i]);
        for (std::size_t i = 0; i < normal.size(); ++i) gradient[at + i] -= static_cast<float>(total / sum * normal[i]);
    });
}

template <int Dim>
void VolumeConstraint<Dim>::project_direction(std::span<const double> x, std::span<float> direction) const {
    for_each_shape(x, [&](std::size_t at, const std::vector<double>& normal, double sum) {
        double across = 0.0;
        for (std::size_t i = 0; i < normal.size(); ++i) across += normal[i] * static_cast<double>(direction[at + i]);
        for (std::size_t i = 0; i < normal.size(); ++i) direction[at + i] -= static_cast<float>(across / sum);
    });
}

template double enclosed_volume<2>(const DyadicGrid<2>&, const double*);
template double enclosed_volume<3>(const DyadicGrid<3>&, const double*);
template class VolumeConstraint<2>;
template class VolumeConstraint<3>;

}  // namespace morphodesic

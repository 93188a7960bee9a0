#include "geodesic/error_bar.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "geodesic/energy/end_stiffness.h"
#include "geodesic/solver/volume_constraint.h"

namespace morphodesic {

namespace {

// With a smaller weight of the mismatch per step a path may leave a good part of the way to it.
constexpr double firm_weight = 25.0;

/// What more time steps would still change, as a share of the length. That error is first order in 1 / K (a step has
/// the energy of a finite strain), so as much is left as the last doubling of K changed.
double share_in_time(const std::vector<LevelReport>& levels) {
    for (std::size_t i = 1; i < levels.size(); ++i) {
        const LevelReport &before = levels[i - 1], &after = levels[i];
        if (before.time_steps == after.time_steps || after.time_steps != levels.back().time_steps) continue;
        return after.path_length > 0 ? std::abs(after.path_length - before.path_length) / after.path_length : 0.0;
    }
    return 0.0;
}

/// By how much the length changes where each step has the mean of the energies with the stiffness of either of its ends
/// (trapezoid rule): much where material appears or vanishes in long steps.
template <int Dim>
double change_by_end_stiffness(const GeodesicResult<Dim>& result) {
    double length = 0.0;
    for (std::size_t k = 0; k < result.deformations.size(); ++k) {
        const double at_end = end_deformation_energy(result.deformations[k], result.shapes[k + 1], result.options);
        length += std::sqrt(0.5 * (result.deformation_energy[k] + at_end));
    }
    const double change = std::abs(length - result.path_length);
    return result.deformations.empty() || !std::isfinite(change) ? 0.0 : change;
}

/// Change of the length by the last halving of the grid, both solves with the wide rim and the time steps that the
/// level before the last ended with; nothing if the cascade has no such pair.
std::optional<double> change_by_grid(const std::vector<LevelReport>& levels) {
    const LevelReport *before = nullptr, *after = nullptr;
    for (const LevelReport& report : levels) {
        if (report.level + 1 == levels.back().level) {
            before = &report;
        } else if (before && report.time_steps == before->time_steps && report.rim_width == before->rim_width) {
            after = &report;
        }
    }
    if (!after) return {};
    const double change = after->path_length - before->path_length;
    return std::isfinite(change) ? std::optional(change) : std::nullopt;
}

}  // namespace

template <int Dim>
void add_error_bar(GeodesicResult<Dim>& result, double wide_length, double wide_rim, bool masked) {
    const auto& options = result.options;
    const double length = result.path_length;
    const double factor = options.rim_width / (wide_rim - options.rim_width);
    const double by_rim = factor * (length - wide_length);
    // What is left, and what the last halving of the grid should have changed.
    double rest = by_rim, predicted = by_rim * wide_rim / options.rim_width;
    if (by_rim < 0) {
        const double gained = wide_length * wide_length - length * length;
        rest = std::sqrt(std::max(0.0, length * length - factor * gained)) - length;
        predicted = wide_length - std::sqrt(wide_length * wide_length + factor * wide_rim / options.rim_width * gained);
    }
    result.extrapolated_length = length + rest;
    const double unseen = std::abs(change_by_grid(result.levels).value_or(predicted) - predicted);
    const double in_space = 1.75 * std::abs(rest) + unseen;
    const double left = (share_in_time(result.levels) + options.tolerance) * length;
    result.error = in_space + left;
    if (!(length > 0)) return;
    const auto volume = [](const LevelSet<Dim>& u) { return enclosed_volume(u.grid, u.values.data()); };
    const auto [smaller, larger] = std::minmax({volume(result.shapes.front()), volume(result.shapes.back())});
    const int steps = options.time_steps;
    const bool all = steps == 1 || options.eta(steps) < firm_weight * steps;
    const double share = all ? 1.0 : masked ? 0.0 : 1.0 - smaller / larger;
    double energy = result.path_energy;
    for (const double mismatch : result.mismatch_energy) energy += options.eta(steps) * mismatch;
    result.error = std::max({in_space, share * (energy / length - length), change_by_end_stiffness(result)}) + left;
}

template void add_error_bar<2>(GeodesicResult<2>&, double, double, bool);
template void add_error_bar<3>(GeodesicResult<3>&, double, double, bool);

}  // namespace morphodesic

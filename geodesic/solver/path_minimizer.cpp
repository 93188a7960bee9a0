#include "geodesic/solver/path_minimizer.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <optional>
#include <stdexcept>

#include "geodesic/grid/injectivity.h"
#include "geodesic/grid/node_loop.h"
#include "geodesic/kernels/vector_kernels.h"
#include "geodesic/solver/lbfgs_history.h"
#include "geodesic/solver/path_preconditioner.h"
#include "geodesic/solver/slope_limit.h"
#include "geodesic/solver/volume_constraint.h"

namespace morphodesic {

namespace {

constexpr double armijo = 1e-4;
constexpr int max_halvings = 25;
constexpr int lessons = 1;  // full steps that may fail in an iteration: the history learns from them
// Along a full step that fails, slopes change by about what they were at least, if the energy is convex. Less of it is
// a kink, which the history would make a step without end of.
constexpr double least_lesson = 0.5;
constexpr int patience = 2;           // more steps tried, each shorter, before the history is given up
constexpr int refresh = 15;           // iterations between two updates of the preconditioner
constexpr double least_share = 0.3;   // of det D phi in a cell that is left by one step
constexpr double most_folded = 0.02;  // share of the cells of one deformation that are repaired where a step folds
constexpr double rounding = 1e-7;     // of energies in single precision, relative
constexpr double vanishing = 1e-10;   // energy that rounding leaves between equal shapes, in units of mu
constexpr int max_renewals = 3;       // of history and preconditioner where steps stall
constexpr int window = 5;             // iterations over which the decrease is measured

/// Cells of the background that a step would squeeze at once stop it as a whole, or fold; there the step is shortened,
/// in those cells alone.
template <int Dim>
void limit_direction(const PathLayout<Dim>& layout, const std::vector<double>& x, std::vector<float>& direction) {
    for_indices(1, layout.time_steps + 1, [&](int k) {
        limit_change<Dim>(layout.grid, layout.displacements(x.data(), k), layout.displacements(direction.data(), k),
                          least_share);
    });
}

/// Repairs the deformations that fold, if no more than `most` cells of each do. @return whether there was one to repair
template <int Dim>
bool repair(const PathLayout<Dim>& layout, const PathTerms& terms, std::vector<double>& x,
            int most = std::numeric_limits<int>::max()) {
    bool repaired = false;
    for (int k = 1; k <= layout.time_steps; ++k) {
        if (terms.step_min_det[static_cast<std::size_t>(k - 1)] >= PathEnergy<Dim>::least_det_single) continue;
        const auto w = layout.displacements(x.data(), k);
        if (repair_folds<Dim>(layout.grid, w, 2 * PathEnergy<Dim>::least_det, most) > most) return false;
        repaired = true;
    }
    return repaired;
}

}  // namespace

template <int Dim>
MinimizerSummary minimize_path(PathEnergy<Dim>& energy, std::vector<double>& x, const MinimizerOptions& options) {
    MinimizerSummary summary;
    std::vector<double> next(x.size());
    std::vector<float> gradient(x.size()), next_gradient(x.size()), direction(x.size());
    std::optional<VolumeConstraint<Dim>> constraint;
    if (energy.options().preserve_volume && energy.layout().time_steps > 1) constraint.emplace(energy);
    SlopeLimit<Dim> slope_limit(energy.layout());
    const auto evaluate = [&](std::vector<double>& at, std::vector<float>& g) {
        slope_limit.apply(at);
        if (constraint && !constraint->correct(at)) {
            PathTerms vanished;
            vanished.total = std::numeric_limits<double>::infinity();
            vanished.step_min_det.assign(static_cast<std::size_t>(energy.layout().time_steps), 1.0);
            return vanished;
        }
        auto found = energy.evaluate_single(at, g);
        if (std::isfinite(found.total)) slope_limit.hold(at, g);
        if (constraint && std::isfinite(found.total)) constraint->project_gradient(at, g);
        return found;
    };
    PathTerms terms = evaluate(x, gradient);
    summary.evaluations = 1;
    if (!std::isfinite(terms.total) && repair<Dim>(energy.layout(), terms, x)) terms = evaluate(x, gradient);
    if (!std::isfinite(terms.total))
        throw std::invalid_argument(
            "the energy of the first guess is infinite: the weights are too far apart (lambda, mu, mismatch-weight, "
            "outside-stiffness), or a deformation folds");

    const int most_folds = static_cast<int>(most_folded * static_cast<double>(energy.layout().grid.cell_count()));
    PathPreconditioner<Dim> preconditioner(energy);
    LbfgsHistory history(x.size(), options.history);
    const auto find_direction = [&] {
        history.before(gradient, direction);
        preconditioner.apply(direction);
        history.after(direction);
        if (constraint) constraint->project_direction(x, direction);
        limit_direction(energy.layout(), x, direction);
        return kernels::dot(gradient, direction);
    };
    const auto find_descent = [&] {
        const double slope = find_direction();
        if (slope < 0) return slope;
        history.clear();  // it misleads, or its direction was limited too much: from the preconditioned gradient again
        return find_direction();
    };
    std::deque<double> energies{terms.total};
    summary.termination = Termination::max_steps;
    int renewals = 0;
    while (summary.iterations < options.max_iterations) {
        if (summary.iterations % refresh == 0) preconditioner.update(energy, x);
        double slope = find_descent();
        if (!std::isfinite(slope)) {  // the energy cannot be told in single precision: no step may be made of it
            summary.termination = Termination::no_descent;
            break;
        }
        // Nothing left to gain beside rounding: also the case of two equal shapes.
        if (-slope <= rounding * terms.total || terms.total < vanishing * energy.options().mu) {
            summary.termination = slope <= 0 ? Termination::converged : Termination::no_descent;
            break;
        }

        double t = 1.0;
        PathTerms next_terms;
        bool accepted = false;
        // Lessons fill the history and directions without descent clear it: what counts is where the iteration began.
        const bool fresh = history.empty();
        const int shorter = fresh ? max_halvings : patience;
        for (int trial = 0; trial < lessons + shorter && slope < 0; ++trial) {
            kernels::step(next, x, t, direction);
            next_terms = evaluate(next, next_gradient);
            ++summary.evaluations;
            // Folds appear where the soft background is squeezed: undo them there instead of shortening the whole step,
            // unless so many cells fold that it is the step which makes no sense.
            if (!std::isfinite(next_terms.total) && repair<Dim>(energy.layout(), next_terms, next, most_folds)) {
                next_terms = evaluate(next, next_gradient);
                ++summary.evaluations;
            }
            accepted = next_terms.total <= terms.total + armijo * t * slope;
            if (accepted) break;
            // The change of the gradient on the way tells which parts of the step were too long; the rest stays full.
            if (trial < lessons && t == 1.0 && std::isfinite(next_terms.total)) {
                history.add_tried(next, x, next_gradient, gradient, least_lesson * std::abs(slope));
                slope = find_descent();
                continue;
            }
            if (std::isfinite(next_terms.total)) {
                const double parabola = -0.5 * slope * t * t / (next_terms.total - terms.total - slope * t);
                t = std::clamp(parabola, 0.1 * t, 0.5 * t);
            } else {
                t *= 0.5;
            }
        }
        if (!accepted) {
            history.clear();
            if (!fresh) {
                preconditioner.update(energy, x);
                ++summary.iterations;
                continue;
            }
            if (preconditioner.drop_transport()) continue;
            summary.termination = Termination::no_descent;
            break;
        }
        ++summary.iterations;

        history.add(next, x, next_gradient, gradient, 1e-10 * std::abs(t * slope));
        std::swap(x, next);
        std::swap(gradient, next_gradient);
        terms = std::move(next_terms);
        energies.push_back(terms.total);
        if (energies.size() > window + 1) energies.pop_front();
        if (energies.size() == window + 1 &&
            energies.front() - energies.back() <= options.tolerance * energies.back()) {
            // Short steps against a steep slope: a kink the history knows nothing of, not a minimum.
            if (-slope > 2.0 * options.tolerance * terms.total && renewals < max_renewals) {
                ++renewals;
                history.clear();
                preconditioner.update(energy, x);
                energies = {terms.total};
                continue;
            }
            summary.termination = Termination::converged;
            break;
        }
    }
    summary.terms = energy.evaluate(x, {});
    if (!std::isfinite(summary.terms.total) && repair<Dim>(energy.layout(), summary.terms, x)) {
        summary.terms = energy.evaluate(x, {});
    }
    if (!std::isfinite(summary.terms.total)) summary.termination = Termination::no_descent;
    return summary;
}

template MinimizerSummary minimize_path<2>(PathEnergy<2>&, std::vector<double>&, const MinimizerOptions&);
template MinimizerSummary minimize_path<3>(PathEnergy<3>&, std::vector<double>&, const MinimizerOptions&);

}  // namespace morphodesic

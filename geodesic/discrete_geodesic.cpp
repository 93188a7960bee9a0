#include "geodesic/discrete_geodesic.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "geodesic/error_bar.h"
#include "geodesic/grid/injectivity.h"
#include "geodesic/grid/transfer.h"
#include "geodesic/solver/alignment.h"
#include "geodesic/solver/canonical_frame.h"
#include "geodesic/solver/cascade.h"
#include "geodesic/solver/partial_alignment.h"
#include "geodesic/solver/path_minimizer.h"
#include "geodesic/solver/path_window.h"

namespace morphodesic {

namespace {

using Clock = std::chrono::steady_clock;

// The search for the best start happens from this level on, with at most so many time steps; at its end the
// finalists get at most so many, and no more than half of the steps asked for where no finer level follows.
constexpr int start_level = 4;
constexpr int search_steps = 2, settled_steps = 4;
// From so many time steps on, what one iteration gains shrinks with their number, and so must the tolerance.
constexpr int many_steps = 8;
// While starts compete, the rim is one cell wide: with a narrower one the quadrature points see the contours jump from
// one to the next, and the energy has many small steps that say nothing.
constexpr double search_rim = 1.0;
constexpr double start_tolerance = 5e-3, search_tolerance = 2e-2;  // of the energy, on the start level and above it
// The tolerance with the wide rim, in units of the one asked for: what comes after moves the path by more than the last
// iterations there would. No more than so much of the energy.
constexpr double wide_rim_share = 5.0, wide_rim_tolerance = 1e-2;

// While rounds are left, the last solve gets so many iterations: what creeps on is stuck in cracks. It is loosened with
// a rim wider by this than the wide one, and a tolerance larger by that.
constexpr int long_solve = 45, unlimited = std::numeric_limits<int>::max();
constexpr double loose_rim = 1.5, loose_tolerance = 2.0;

/// From this level on solves look at a window around the shapes.
constexpr int window_level = 5;

/// Up to this level starts compete. Above, their order hardly changes and each costs much.
template <int Dim>
constexpr int last_search_level = Dim == 2 ? 6 : 5;

/// Starts that go on from a level of the search: at most `count`, with an energy up to `margin` times the least.
/// Measured on letters: energies of one start on levels 4 and 6 differ by up to a quarter, on levels 5 and 6 by up to
/// an eighth.
struct Cut {
    double margin;
    int count;
};
Cut cut_before(int level, int starts) {
    return level == start_level + 1 ? Cut{1.4, starts} : Cut{1.08, (starts + 1) / 2};
}

/// Those that are close on the last level of the search get more time steps before one of them goes on: often these
/// tell which path is the lower one. Where finer levels follow they cost little (measured on letters: energies up
/// to 1.5 % lower for the same work, as what is chosen then takes less on fine levels), else two are what pays (5 %
/// more time; of shapes that were moved, 87 instead of 80 % keep their distances within 1 %). Solids do not pay for it.
template <int Dim>
Cut finalists(bool finer_levels) {
    if (Dim == 3) return {1.0, 1};
    return finer_levels ? Cut{1.15, 4} : Cut{1.06, 2};
}

/// Starts are cut into more steps up to this multiple of the least energy with one step (measured: the same paths).
constexpr double one_step_margin = 1.3;

/// Alignments that move more than this share of a shape out of the cube are not used.
constexpr double most_lost = 0.002;

struct Cancelled {};

/// One start of the cascade: an alignment and a schedule, carried from level to level.
template <int Dim>
struct Start {
    RigidMotion<Dim> motion;
    PathState<Dim> path;
    PathTerms terms;
    Termination termination = Termination::converged;
    std::vector<LevelReport> levels;
};

template <int Dim>
class Cascade {
public:
    Cascade(const LevelSet<Dim>& a, const LevelSet<Dim>& b, const GeodesicOptions& options,
            const ScalarField<Dim>& mask, const GeodesicObserver& observer)
        : a_(a),
          b_(b),
          options_(options),
          mask_(mask),
          observer_(observer),
          coarse_a_(restricted(a, std::min(options.level, last_search_level<Dim>))) {}

    GeodesicResult<Dim> run() {
        const auto begin = Clock::now();
        GeodesicResult<Dim> result;
        result.options = options_;
        Start<Dim> best;
        double wide_length = 0.0;
        try {
            best = search();
            wide_length = finish(best);
            result.min_det = certify(best);
        } catch (const Cancelled&) {
            result.termination = Termination::cancelled;
            result.message = "the solve was cancelled";
            result.path_length = result.path_energy = result.total_energy = result.error = result.extrapolated_length =
                std::numeric_limits<double>::quiet_NaN();
            return result;
        }
        fill(result, best, wide_length);
        result.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
        return result;
    }

private:
    LevelSet<Dim> first_on(const RigidMotion<Dim>& motion, int level) const {
        return options_.align == "none" ? restricted(a_, level) : moved(a_, motion, level);
    }

    ScalarField<Dim> mask_on(const RigidMotion<Dim>& motion, int level) const {
        if (mask_.values.empty()) return {};
        if (options_.align == "none") return restricted(mask_, level);
        return carried_mask(mask_, Similarity<Dim>{motion}, level);  // as the alignment sees it
    }

    /// The shapes between are renewed from the two ends where that lowers the energy.
    static void adopt_transported_shapes(PathState<Dim>& path, PathEnergy<Dim>& energy) {
        if (path.layout.time_steps == 1) return;
        const double before = energy.evaluate_single(path.x, {}).total;
        std::vector<double> old(path.x.begin() + static_cast<std::ptrdiff_t>(path.layout.level_set(1)), path.x.end());
        transport_shapes(path, energy.first(), energy.last(), energy.eps());
        if (energy.evaluate_single(path.x, {}).total < before) return;
        std::copy(old.begin(), old.end(), path.x.begin() + static_cast<std::ptrdiff_t>(path.layout.level_set(1)));
    }

    static MinimizerSummary minimize(PathState<Dim>& path, PathEnergy<Dim>& energy, const MinimizerOptions& options) {
        adopt_transported_shapes(path, energy);
        return minimize_path<Dim>(energy, path.x, options);
    }

    /// The same, on a window. @return the terms of the whole path
    static MinimizerSummary minimize_on(const PathWindow<Dim>& window, PathState<Dim>& path, PathEnergy<Dim>& energy,
                                        const ScalarField<Dim>& mask, const MinimizerOptions& minimizer, int& folds) {
        PathEnergy<Dim> part_energy(window.cut_out(energy.first()), window.cut_out(energy.last()),
                                    path.layout.time_steps, energy.options(),
                                    mask.values.empty() ? mask : window.cut_out(mask));
        auto part = window.cut_out(path);
        auto summary = minimize(part, part_energy, minimizer);
        window.put_back(part, path);
        summary.terms = energy.evaluate(path.x, {});
        if (!std::isfinite(summary.terms.total)) {  // across the faces of the window
            folds += repair_folds(path);
            summary.terms = energy.evaluate(path.x, {});
            if (!std::isfinite(summary.terms.total)) summary.termination = Termination::no_descent;
        }
        return summary;
    }

    /// Minimises on the level and K of the path, with the given rim.
    void solve(Start<Dim>& start, int folds, double rim_width, double tolerance, int at_most = unlimited) {
        const auto begin = Clock::now();
        const int level = start.path.layout.grid.level(), steps = start.path.layout.time_steps;
        GeodesicOptions options = options_;
        options.rim_width = rim_width;
        const auto mask = mask_on(start.motion, level);
        PathEnergy<Dim> energy(first_on(start.motion, level), restricted(b_, level), steps, options, mask);
        MinimizerOptions minimizer;
        minimizer.tolerance = tolerance * std::min(1.0, static_cast<double>(many_steps) / steps);
        minimizer.max_iterations = std::min(at_most, options_.max_iterations);
        std::optional<PathWindow<Dim>> window;
        if (level >= window_level) window = PathWindow<Dim>::around(start.path, energy.first(), energy.last());
        const auto summary = window ? minimize_on(*window, start.path, energy, mask, minimizer, folds)
                                    : minimize(start.path, energy, minimizer);
        start.terms = summary.terms;
        start.termination = summary.termination;
        LevelReport report;
        report.level = level;
        report.time_steps = steps;
        report.rim_width = rim_width;
        report.iterations = summary.iterations;
        report.evaluations = summary.evaluations;
        report.total_energy = summary.terms.total;
        report.path_length = summary.terms.path_length();
        report.min_det = summary.terms.min_det;
        report.folds_repaired = folds;
        report.termination = summary.termination;
        report.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
        start.levels.push_back(report);
        if (observer_ && !observer_(report)) throw Cancelled{};
    }

    /// Rim of all but the last solve.
    [[nodiscard]] double wide_rim() const { return std::max(2.0 * options_.rim_width, search_rim); }
    [[nodiscard]] double wide_tolerance() const {
        return std::max(options_.tolerance, std::min(wide_rim_share * options_.tolerance, wide_rim_tolerance));
    }

    /// K -> 2 K on the level of the path.
    void double_steps(Start<Dim>& start, double tolerance) {
        const int level = start.path.layout.grid.level();
        int folds = 0;
        start.path = split_in_time(start.path, first_on(start.motion, level), restricted(b_, level), folds);
        solve(start, folds, wide_rim(), tolerance);
    }

    /// Rigid motions of a from which the search starts. Where only a part of a is known, that part is aligned.
    std::vector<RigidMotion<Dim>> alignments() const {
        std::vector<RigidMotion<Dim>> motions;
        if (mask_.values.empty() || options_.align == "none") {
            for (const auto& found : align(a_, b_, options_.align, options_.starts)) motions.push_back(found.motion);
        } else {
            const int level = std::min(options_.level, last_search_level<Dim>);
            PartialAlignmentOptions partial;
            partial.rotate = options_.align == "rigid";
            partial.count = options_.starts;
            const PartialAligner<Dim> aligner(restricted(a_, level), restricted(mask_, level));
            for (const auto& found : aligner.align(restricted(b_, level), partial)) {
                motions.push_back(found.motion.motion);
            }
        }
        std::erase_if(motions, [&](const auto& motion) { return leaves_cube(motion); });
        if (motions.empty()) motions.push_back({});  // a fits as it stands
        return motions;
    }

    /// Whether a motion would cut off a part of shape a at the faces of the cube.
    [[nodiscard]] bool leaves_cube(const RigidMotion<Dim>& motion) const {
        const auto& grid = coarse_a_.grid;
        std::size_t inside = 0, lost = 0;
        for (std::size_t i = 0; i < coarse_a_.values.size(); ++i) {
            if (!(coarse_a_.values[i] > 0)) continue;
            ++inside;
            lost += in_unit_cube(motion(grid.position(grid.node(i)))) ? 0 : 1;
        }
        return static_cast<double>(lost) > most_lost * static_cast<double>(inside);
    }

    /// The alignments, each solved on the start level with the time steps of the search.
    std::vector<Start<Dim>> coarse_starts() {
        const int level = std::min(start_level, options_.level);
        const int steps = std::min(options_.time_steps, search_steps);
        const double tolerance = std::max(options_.tolerance, start_tolerance);
        std::vector<Start<Dim>> starts;
        double least = std::numeric_limits<double>::infinity();
        // One schedule is enough: with the wide rim, all time steps at once end in the same path (measured on letters).
        for (const auto& motion : alignments()) {
            const auto first = first_on(motion, level);
            const auto last = restricted(b_, level);
            // K = 1, 2, 4, ...: the deformation of one step is cut again and again.
            Start<Dim> doubling;
            doubling.motion = motion;
            doubling.path = blended_path(first, last, 1);
            solve(doubling, 0, wide_rim(), tolerance);
            least = std::min(least, doubling.terms.total);
            if (doubling.terms.total > one_step_margin * least) continue;
            while (doubling.path.layout.time_steps < steps) double_steps(doubling, tolerance);
            starts.push_back(std::move(doubling));
        }
        sort(starts);
        return starts;
    }

    static void sort(std::vector<Start<Dim>>& starts) {
        std::stable_sort(starts.begin(), starts.end(),
                         [](const Start<Dim>& x, const Start<Dim>& y) { return x.terms.total < y.terms.total; });
    }

    /// Drops all but the promising of the sorted starts.
    static void keep(std::vector<Start<Dim>>& starts, const Cut& cut) {
        const double limit = cut.margin * starts.front().terms.total;
        std::erase_if(starts, [&](const Start<Dim>& s) { return s.terms.total > limit; });
        if (starts.size() > static_cast<std::size_t>(cut.count)) starts.resize(static_cast<std::size_t>(cut.count));
    }

    /// Level after level the promising starts go on; returns the best on the last level of the search, with its steps
    /// until one level is left.
    Start<Dim> search() {
        auto starts = coarse_starts();
        const double tolerance = std::max(options_.tolerance, search_tolerance);
        const int last = std::min(options_.level, last_search_level<Dim>);
        for (int level = starts.front().path.layout.grid.level() + 1; level <= last; ++level) {
            keep(starts, cut_before(level, options_.starts));
            for (auto& start : starts) {
                int folds = 0;
                start.path = prolong_in_space(start.path, folds);
                solve(start, folds, wide_rim(), tolerance);
            }
            sort(starts);
        }
        const bool finer = last < options_.level;
        keep(starts, finalists<Dim>(finer));
        for (auto& start : starts) {
            solve(start, 0, wide_rim(), wide_tolerance());
            double_steps_up_to(start, finer ? settled_steps : std::min(settled_steps, options_.time_steps / 2));
        }
        sort(starts);
        return std::move(starts.front());
    }

    /// Many short steps are coupled stiffly; they start from few long ones that have converged.
    void double_steps_up_to(Start<Dim>& start, int steps) {
        while (start.path.layout.time_steps < std::min(steps, options_.time_steps)) {
            double_steps(start, wide_tolerance());
        }
    }

    /// The path smoothed, and solved with a wider rim: it leaves cracks that more iterations do not get it out of.
    Start<Dim> loosened(Start<Dim> start) {
        const int folds = smooth_deformations(start.path);
        solve(start, folds, loose_rim * wide_rim(), loose_tolerance * wide_tolerance());
        return start;
    }

    /// Makes the rim narrow. A path that does not settle soon is loosened and settled anew, once a round.
    /// @return length with the wide rim, as much shorter as the path became by the rounds
    double settle(Start<Dim>& best) {
        double wide = best.terms.path_length();
        int rounds = Dim == 2 && options_.max_iterations > long_solve ? options_.rounds : 0;
        const auto make_rim_narrow = [&](Start<Dim>& start) {
            solve(start, 0, options_.rim_width, options_.tolerance, rounds > 0 ? long_solve : unlimited);
        };
        make_rim_narrow(best);
        while (rounds > 0 && best.termination == Termination::max_steps) {
            --rounds;
            Start<Dim> again = loosened(best);
            make_rim_narrow(again);
            if (again.termination != Termination::no_descent && again.terms.total < best.terms.total) {
                wide *= again.terms.path_length() / best.terms.path_length();
                best = std::move(again);
            } else {
                rounds = 0;
                make_rim_narrow(best);
            }
        }
        return wide;
    }

    /// Takes the best start of the search to the wanted level and number of steps with the wide rim; then the rim is
    /// made narrow. The error bar compares the two lengths.
    /// @return length with the wide rim
    double finish(Start<Dim>& best) {
        for (int level = best.path.layout.grid.level(); level < options_.level; ++level) {
            if (level + 1 == options_.level) double_steps_up_to(best, options_.time_steps);
            int folds = 0;
            best.path = prolong_in_space(best.path, folds);
            solve(best, folds, wide_rim(), wide_tolerance());
        }
        double_steps_up_to(best, options_.time_steps);
        return settle(best);
    }

    static double min_det_of(const PathState<Dim>& path) {
        double least = std::numeric_limits<double>::infinity();
        for (int k = 1; k <= path.layout.time_steps; ++k) {
            const double bound = det_lower_bound<Dim>(path.layout.grid, path.layout.displacements(path.x.data(), k));
            if (!(bound >= least)) least = bound;  // keeps a NaN
        }
        return least;
    }

    /// The minimiser looks at quadrature points and cell corners only. Where the certificate for whole cells fails
    /// nevertheless (3D), the cells are repaired and the path is minimised on from there.
    /// @return the certificate: a bound of det D phi, not positive if that did not help
    double certify(Start<Dim>& best) {
        constexpr int rounds = 3;
        double bound = min_det_of(best.path);
        for (int round = 0; round < rounds && bound <= 0; ++round) {
            const int folds = repair_folds(best.path, 4 * PathEnergy<Dim>::least_det);
            solve(best, folds, options_.rim_width, options_.tolerance);
            bound = min_det_of(best.path);
        }
        return bound;
    }

    void fill(GeodesicResult<Dim>& result, Start<Dim>& best, double wide_length) const {
        const auto& layout = best.path.layout;
        result.termination = best.termination;
        if (best.termination == Termination::max_steps) {
            result.message = "the iteration limit was reached before the energy settled";
        } else if (best.termination == Termination::no_descent) {
            result.message = "the line search found no lower energy before the tolerance was met";
        }
        result.path_length = best.terms.path_length();
        result.path_energy = best.terms.path_energy();
        result.total_energy = best.terms.total - best.terms.barrier;
        result.deformation_energy = best.terms.deformation;
        result.mismatch_energy = best.terms.mismatch;
        result.motion = best.motion;
        result.levels = best.levels;
        result.shapes.push_back(first_on(best.motion, layout.grid.level()));
        for (int k = 1; k <= layout.time_steps; ++k) {
            Deformation<Dim> phi(layout.grid);
            for (int a = 0; a < Dim; ++a) {
                const auto from = best.path.x.begin() + static_cast<std::ptrdiff_t>(layout.displacement(k, a));
                phi.displacement.components[static_cast<std::size_t>(a)].assign(
                    from, from + static_cast<std::ptrdiff_t>(layout.nodes()));
            }
            result.deformations.push_back(std::move(phi));
            if (k == layout.time_steps) break;
            LevelSet<Dim> u(layout.grid);
            const auto from = best.path.x.begin() + static_cast<std::ptrdiff_t>(layout.level_set(k));
            u.values.assign(from, from + static_cast<std::ptrdiff_t>(layout.nodes()));
            result.shapes.push_back(std::move(u));
        }
        result.shapes.push_back(restricted(b_, layout.grid.level()));
        add_error_bar(result, wide_length, wide_rim(), !mask_.values.empty());
        if (!(result.min_det > 0)) {
            result.termination = Termination::no_descent;
            result.message = "a deformation could not be shown to be 1-1";
        } else if (!std::isfinite(result.total_energy)) {
            result.termination = Termination::no_descent;
            result.message = "a deformation squeezes a cell to next to nothing, where its energy cannot be told";
        }
        if (!result.levels.empty()) result.levels.back().min_det = result.min_det;
    }

    const LevelSet<Dim>& a_;
    const LevelSet<Dim>& b_;
    const GeodesicOptions& options_;
    const ScalarField<Dim>& mask_;
    const GeodesicObserver& observer_;
    const LevelSet<Dim> coarse_a_;
};

/// Whether any part of the contour lies where the mask does not hide it.
template <int Dim>
bool shows_contour(const LevelSet<Dim>& u, const ScalarField<Dim>& mask) {
    for (std::size_t i = 0; i < u.values.size(); ++i) {
        const auto node = u.grid.node(i);
        for (int a = 0; a < Dim; ++a) {
            if (node[static_cast<std::size_t>(a)] + 1 >= u.grid.nodes(a)) continue;
            const std::size_t next = i + u.grid.stride(a);
            const bool crosses = (u.values[i] > 0) != (u.values[next] > 0);
            if (crosses && (mask.values[i] > 0 || mask.values[next] > 0)) return true;
        }
    }
    return false;
}

}  // namespace

template <int Dim>
GeodesicResult<Dim> compute_discrete_geodesic(const LevelSet<Dim>& a, const LevelSet<Dim>& b,
                                              const GeodesicOptions& options, const ScalarField<Dim>& mask,
                                              const GeodesicObserver& observer) {
    const auto problems = options.problems();
    if (!problems.empty()) throw std::invalid_argument("geodesic options: " + problems.front());
    for (const LevelSet<Dim>* u : {&a, &b}) {
        if (u->grid.level() < options.level) {
            throw std::invalid_argument(
                "compute_discrete_geodesic: a shape is sampled on a coarser grid than the level");
        }
        if (!std::all_of(u->values.begin(), u->values.end(), [](double v) { return std::isfinite(v); })) {
            throw std::invalid_argument("compute_discrete_geodesic: a level set has values that are not finite");
        }
        const LevelSet<Dim> seen = restricted(*u, options.level);
        if (!std::any_of(seen.values.begin(), seen.values.end(), [](double v) { return v > 0; })) {
            throw std::invalid_argument("compute_discrete_geodesic: a shape is empty on its grid");
        }
    }
    if (!mask.values.empty() && mask.grid.level() < options.level) {
        throw std::invalid_argument("compute_discrete_geodesic: the mask is sampled on a coarser grid than the level");
    }
    if (!std::all_of(mask.values.begin(), mask.values.end(), [](double v) { return v >= 0.0 && v <= 1.0; })) {
        throw std::invalid_argument("compute_discrete_geodesic: the mask has values outside [0, 1]");
    }
    if (!mask.values.empty() && !shows_contour(restricted(a, options.level), restricted(mask, options.level))) {
        throw std::invalid_argument("compute_discrete_geodesic: the mask hides the whole contour of the first shape");
    }
    // What is hidden often ends where a shape was cut: off the nodes both edges would part by a share of a cell.
    // Equal shapes fit exactly as they are.
    const bool equal = a.grid.level() == b.grid.level() && a.values == b.values;
    const bool posed = options.align == "rigid" && mask.values.empty() && !equal;
    const auto frame = posed ? canonical_frame(b) : RigidMotion<Dim>{};
    if (frame.is_identity() || !turns_freely(a)) return Cascade<Dim>(a, b, options, mask, observer).run();
    const LevelSet<Dim> turned = moved(b, frame, b.grid.level());
    auto result = Cascade<Dim>(a, turned, options, mask, observer).run();
    result.frame = frame;
    result.motion = frame.inverse().after(result.motion);
    return result;
}

template GeodesicResult<2> compute_discrete_geodesic<2>(const LevelSet<2>&, const LevelSet<2>&, const GeodesicOptions&,
                                                        const ScalarField<2>&, const GeodesicObserver&);
template GeodesicResult<3> compute_discrete_geodesic<3>(const LevelSet<3>&, const LevelSet<3>&, const GeodesicOptions&,
                                                        const ScalarField<3>&, const GeodesicObserver&);

}  // namespace morphodesic

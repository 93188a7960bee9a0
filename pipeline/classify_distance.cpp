#include "pipeline/classify_distance.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <numbers>

#include "analysis/special_numbers.h"
#include "geodesic/grid/contour.h"
#include "geodesic/grid/transfer.h"

namespace morphodesic::pipeline {
namespace {

using analysis::infinity;
using analysis::nan;

/// Grid on which guesses are judged.
constexpr int guess_level(int dimension) {
    return dimension == 2 ? 5 : 4;
}
/// eta of one time step: what the mismatch of an alignment costs if nothing is deformed.
constexpr double mismatch_scale = 25.0;

/// Level on which masks are grown and shares are counted.
constexpr int mask_level(int dimension) {
    return dimension == 2 ? 6 : 5;
}

/// Calls visit(neighbour) for all nodes that share a cell with the node.
template <int Dim, class Visit>
void for_each_neighbour(const DyadicGrid<Dim>& grid, std::size_t index, const Visit& visit) {
    const auto node = grid.node(index);
    for (int code = 0; code < (Dim == 2 ? 9 : 27); ++code) {
        auto next = node;
        int rest = code;
        bool inside = true;
        for (std::size_t a = 0; a < Dim; ++a, rest /= 3) {
            next[a] += rest % 3 - 1;
            inside = inside && next[a] >= 0 && next[a] < grid.nodes_per_axis();
        }
        if (inside) visit(grid.index(next));
    }
}

/// The hidden region one cell wider: along its rim the visible part ends without there being a contour.
template <int Dim>
ScalarField<Dim> widened(const ScalarField<Dim>& mask) {
    ScalarField<Dim> result = mask;
    for (std::size_t i = 0; i < mask.values.size(); ++i) {
        for_each_neighbour<Dim>(mask.grid, i,
                                [&](std::size_t j) { result.values[i] = std::min(result.values[i], mask.values[j]); });
    }
    return result;
}

/// What the energy of the visible part is divided by. Its share alone is not enough: the less of a template is
/// compared, the more freely size and place can be chosen; the power is the one that ranks best (CLASSIFY.md).
double visible_weight(double hidden_share) {
    return std::pow(std::max(0.05, 1.0 - hidden_share), 1.5);
}

/// Share of the whole shape where chi is 0, weighted by 1 - chi.
template <int Dim>
double hidden_share(const LevelSet<Dim>& whole, const ScalarField<Dim>& mask) {
    double all = 0.0, hidden = 0.0;
    const double h = whole.grid.spacing();
    for (std::size_t i = 0; i < whole.values.size(); ++i) {
        const double inside = std::clamp(0.5 + whole.values[i] / h, 0.0, 1.0);
        all += inside;
        hidden += inside * (1.0 - mask.values[i]);
    }
    constexpr double rounding = 1e-9;  // of interpolated masks
    return hidden > rounding * all ? hidden / all : 0.0;
}

/// The whole shape where it is visible.
template <int Dim>
LevelSet<Dim> cut_off(const LevelSet<Dim>& whole, const ScalarField<Dim>& mask) {
    LevelSet<Dim> result = whole;
    for (std::size_t i = 0; i < result.values.size(); ++i) {
        result.values[i] = std::min(result.values[i], (mask.values[i] - 0.5) * 2 * whole.grid.spacing());
    }
    return redistanced(result);
}

template <int Dim>
bool is_unmoved(const Similarity<Dim>& s) {
    return s.scale == 1.0 && s.motion.is_identity();
}

}  // namespace

const char* to_string(Hypothesis hypothesis) {
    switch (hypothesis) {
        case Hypothesis::complete:
            return "complete";
        case Hypothesis::known:
            return "known mask";
        case Hypothesis::missing:
            return "a part is missing";
        case Hypothesis::added:
            return "a part was added";
        case Hypothesis::cut_off:
            return "a part beyond a straight line is missing";
    }
    return "?";
}

template <int Dim>
LevelSet<Dim> redistanced(const LevelSet<Dim>& u) {
    const DyadicGrid<Dim>& grid = u.grid;
    const double h = grid.spacing();
    std::vector<double> best(u.values.size(), std::numeric_limits<double>::infinity());
    std::vector<Point<Dim>> nearest(u.values.size());
    const auto offer = [&](std::size_t i, const Point<Dim>& p) {
        const Point<Dim> x = grid.position(grid.node(i));
        double squared = 0.0;
        for (std::size_t a = 0; a < Dim; ++a) squared += (x[a] - p[a]) * (x[a] - p[a]);
        if (squared < best[i]) {
            best[i] = squared;
            nearest[i] = p;
        }
    };
    for (std::size_t i = 0; i < u.values.size(); ++i) {
        const auto node = grid.node(i);
        for (std::size_t a = 0; a < Dim; ++a) {
            auto next = node;
            if (++next[a] == grid.nodes_per_axis()) continue;
            const std::size_t j = grid.index(next);
            if ((u.values[i] > 0) == (u.values[j] > 0)) continue;
            Point<Dim> p = grid.position(node);
            p[a] += h * u.values[i] / (u.values[i] - u.values[j]);
            offer(i, p);
            offer(j, p);
        }
    }
    // Forward and backward sweeps until nothing changes; two pairs are nearly always enough.
    bool changed = true;
    for (int sweep = 0; sweep < 8 && changed; ++sweep) {
        changed = false;
        for (std::size_t k = 0; k < best.size(); ++k) {
            const std::size_t i = sweep % 2 == 0 ? k : best.size() - 1 - k;
            const double before = best[i];
            for_each_neighbour<Dim>(grid, i, [&](std::size_t j) {
                if (std::isfinite(best[j])) offer(i, nearest[j]);
            });
            changed = changed || best[i] < before;
        }
    }
    LevelSet<Dim> result = u;
    for (std::size_t i = 0; i < best.size(); ++i) {
        if (std::isfinite(best[i])) result.values[i] = std::copysign(std::sqrt(best[i]), u.values[i] > 0 ? 1.0 : -1.0);
    }
    return result;
}

template <int Dim>
LevelSet<Dim> filled_in(const LevelSet<Dim>& visible, const LevelSet<Dim>& whole, const ScalarField<Dim>& mask) {
    LevelSet<Dim> result = visible;
    const double h = visible.grid.spacing();
    for (std::size_t i = 0; i < result.values.size(); ++i) {
        // The hidden region reaches a little into the visible one, so that no seam is left.
        const double hidden = (0.75 - mask.values[i]) * 2 * h;
        result.values[i] = std::max(visible.values[i], std::min(whole.values[i], hidden));
    }
    return redistanced(result);
}

template <int Dim>
ScalarField<Dim> grown_mask(const LevelSet<Dim>& query, const LevelSet<Dim>& whole, Hypothesis hypothesis) {
    const double h = query.grid.spacing(), core = 1.0 / 32, rim = 1.0 / 32;
    LevelSet<Dim> depth(query.grid);
    bool any = false;
    for (std::size_t i = 0; i < depth.values.size(); ++i) {
        const double q = query.values[i], t = whole.values[i];
        depth.values[i] = hypothesis == Hypothesis::missing ? std::min(t, -q) : std::min(q, -t);
        depth.values[i] -= core;
        any = any || depth.values[i] > 0;
    }
    ScalarField<Dim> chi(query.grid, 1.0);
    if (!any) return chi;
    const LevelSet<Dim> distance = redistanced(depth);
    for (std::size_t i = 0; i < chi.values.size(); ++i) {
        chi.values[i] = std::clamp(0.5 - (distance.values[i] + core + rim) / h, 0.0, 1.0);
    }
    return chi;
}

template <int Dim>
ComparedShape<Dim> mirror_image(const ComparedShape<Dim>& shape) {
    ComparedShape<Dim> result = shape;
    const auto turn = [](const DyadicGrid<Dim>& grid, const std::vector<double>& from, std::vector<double>& to) {
        for (std::size_t i = 0; i < from.size(); ++i) {
            auto node = grid.node(i);
            node[0] = grid.cells_per_axis() - node[0];
            to[grid.index(node)] = from[i];
        }
    };
    turn(shape.level_set.grid, shape.level_set.values, result.level_set.values);
    turn(shape.mask.grid, shape.mask.values, result.mask.values);
    result.digest += " mirrored";
    return result;
}

template <>
std::vector<ScalarField<3>> cut_off_masks<3>(const LevelSet<3>&, std::size_t) {
    return {};
}

template <>
std::vector<ScalarField<2>> cut_off_masks<2>(const LevelSet<2>& visible, std::size_t count) {
    const double h = visible.grid.spacing(), tolerance = 0.6 * h;
    std::vector<Point<2>> points;
    double area = 0.0;
    for (const double u : visible.values) area += u > 0 ? h * h : 0.0;
    for (const ContourLoop& loop : contour(visible)) points.insert(points.end(), loop.begin(), loop.end());
    struct Line {
        double angle, offset, contact;  ///< {x cos + y sin = offset}; the shape lies below
    };
    const auto line_at = [&](double angle) {
        const double c = std::cos(angle), s = std::sin(angle);
        double most = -1e300;
        for (const auto& p : points) most = std::max(most, c * p[0] + s * p[1]);
        double sum = 0.0, crossings = 0.0;
        for (const auto& p : points) {
            const double at = c * p[0] + s * p[1];
            if (at < most - 2 * tolerance) continue;
            sum += at, crossings += 1.0;
        }
        // Vertices lie on grid edges: a straight piece of length l crosses so many of them.
        return Line{angle, sum / crossings, crossings * h / (std::abs(c) + std::abs(s))};
    };
    constexpr int directions = 360;
    const double step = 2 * std::numbers::pi / directions;
    std::vector<Line> lines;
    for (int k = 0; k < directions; ++k) lines.push_back(line_at(k * step));
    std::stable_sort(lines.begin(), lines.end(), [](const Line& a, const Line& b) { return a.contact > b.contact; });
    std::vector<Line> kept;
    for (Line& line : lines) {
        if (kept.size() == count || line.contact < 0.35 * std::sqrt(area)) break;
        const bool known = std::any_of(kept.begin(), kept.end(), [&](const Line& k) {
            return std::abs(std::remainder(k.angle - line.angle, 2 * std::numbers::pi)) < 10.5 * step;
        });
        if (known) continue;
        for (const double offset : {-0.5, -0.25, 0.25, 0.5}) {
            const Line near = line_at(line.angle + offset * step);
            if (near.contact > line.contact) line = near;
        }
        kept.push_back(line);
    }
    std::vector<ScalarField<2>> masks;
    for (const Line& line : kept) {
        ScalarField<2> chi(visible.grid);
        for (std::size_t i = 0; i < chi.values.size(); ++i) {
            const Point<2> p = chi.grid.position(chi.grid.node(i));
            const double beyond = std::cos(line.angle) * p[0] + std::sin(line.angle) * p[1] - line.offset;
            chi.values[i] = std::clamp(0.5 - beyond / h, 0.0, 1.0);
        }
        masks.push_back(std::move(chi));
    }
    return masks;
}

template <int Dim>
PartialMatcher<Dim>::PartialMatcher(std::shared_ptr<const ComparedShape<Dim>> query, const ClassifyOptions& options,
                                    const std::string& normalize, const std::string& align, bool estimate, bool mirror)
    : query_(std::move(query)), options_(options), free_size_(normalize == "each"), align_(align) {
    add_views(*query_, false, estimate);
    if (!mirror) return;
    mirrored_ = std::make_shared<const ComparedShape<Dim>>(mirror_image(*query_));
    add_views(*mirrored_, true, estimate);
}

template <int Dim>
void PartialMatcher<Dim>::add_views(const ComparedShape<Dim>& shape, bool mirrored, bool estimate) {
    const auto aligner = std::make_shared<const PartialAligner<Dim>>(shape.level_set, shape.mask);
    if (!shape.mask.values.empty()) {
        views_.push_back({Hypothesis::known, mirrored, shape.mask, aligner});
        return;
    }
    views_.push_back({Hypothesis::complete, mirrored, {}, aligner});
    if (!estimate) return;
    for (ScalarField<Dim>& mask : cut_off_masks<Dim>(shape.level_set, 2)) {
        auto own = std::make_shared<const PartialAligner<Dim>>(shape.level_set, mask);
        views_.push_back({Hypothesis::cut_off, mirrored, std::move(mask), std::move(own)});
    }
    views_.push_back({Hypothesis::missing, mirrored, {}, aligner});
    views_.push_back({Hypothesis::added, mirrored, {}, aligner});
}

template <int Dim>
bool PartialMatcher<Dim>::is_identical(const ComparedShape<Dim>& whole) const {
    return query_->digest == whole.digest || (query_->level_set.grid.level() == whole.level_set.grid.level() &&
                                              query_->level_set.values == whole.level_set.values);
}

template <int Dim>
PartialAlignmentOptions PartialMatcher<Dim>::alignment_options(const View& view,
                                                               const ComparedShape<Dim>& whole) const {
    PartialAlignmentOptions align;
    align.move = align_ != "none";
    align.rotate = align_ == "rigid";
    align.count = options_.alignments;
    if (view.hypothesis == Hypothesis::missing || view.hypothesis == Hypothesis::added) align.count = 1;
    if (view.hypothesis == Hypothesis::missing) align.missing_weight = 0.1;
    if (view.hypothesis == Hypothesis::added) align.added_weight = 0.1;
    if (!free_size_ || view.hypothesis == Hypothesis::complete) return align;
    const double equal = std::pow(whole.volume / std::max(query_->volume, 1e-12), 1.0 / Dim);
    const double least = std::pow(1.0 - options_.largest_hidden, 1.0 / Dim);
    const bool added = view.hypothesis == Hypothesis::added;
    align.least_scale = equal * (added ? 0.95 : least);
    align.largest_scale = equal * (added ? 1.0 / least : 1.05);
    return align;
}

template <int Dim>
PartialStart<Dim> PartialMatcher<Dim>::start_of(const View& view, const PartialAlignmentCandidate<Dim>& candidate,
                                                const ComparedShape<Dim>& whole,
                                                const LevelSet<Dim>& template_here) const {
    PartialStart<Dim> start;
    start.motion = candidate.motion;
    start.mirrored = view.mirrored;
    start.mismatch = candidate.mismatch;
    start.hypothesis = view.hypothesis;
    const int level = template_here.grid.level();
    double share = 0.0;  // of what the hypothesis explains away
    if (!view.mask.values.empty()) {
        start.mask = carried_mask(view.mask, start.motion, level);
        share = start.hidden_share = hidden_share(template_here, start.mask);
    } else if (view.hypothesis != Hypothesis::complete) {
        const auto query_here = carried(level_set(start), start.motion, level);
        start.mask = grown_mask(query_here, template_here, view.hypothesis);
        start.hidden_share = hidden_share(template_here, start.mask);
        share = view.hypothesis == Hypothesis::missing ? start.hidden_share : hidden_share(query_here, start.mask);
    }
    const bool estimated = view.hypothesis != Hypothesis::complete && view.hypothesis != Hypothesis::known;
    if (estimated) start.penalty = options_.hidden_cost * options_.hidden_cost * share * whole.volume;
    if (estimated && (share == 0.0 || share > options_.largest_hidden)) start.penalty = infinity;
    return start;
}

template <int Dim>
std::vector<typename PartialMatcher<Dim>::Guess> PartialMatcher<Dim>::guesses(const ComparedShape<Dim>& whole) const {
    std::vector<Guess> result;
    if (is_identical(whole)) return {Guess{}};
    const AlignmentTarget<Dim> target(whole.level_set);
    const LevelSet<Dim> template_here =
        restricted(whole.level_set, std::min(guess_level(Dim), whole.level_set.grid.level()));
    for (std::size_t v = 0; v < views_.size(); ++v) {
        const View& view = views_[v];
        for (const auto& candidate : view.aligner->search(target, alignment_options(view, whole))) {
            PartialStart<Dim> start = start_of(view, candidate, whole, template_here);
            const double squared =
                mismatch_scale * candidate.mismatch / visible_weight(start.hidden_share) + start.penalty;
            if (std::isfinite(squared)) result.push_back({v, std::move(start), std::sqrt(squared)});
        }
    }
    std::stable_sort(result.begin(), result.end(), [](const Guess& a, const Guess& b) { return a.score < b.score; });
    const auto most = static_cast<std::size_t>(2 * options_.alignments);
    if (result.size() > most) result.erase(result.begin() + static_cast<std::ptrdiff_t>(most), result.end());
    return result;
}

template <int Dim>
std::vector<PartialStart<Dim>> PartialMatcher<Dim>::starts(const ComparedShape<Dim>& whole,
                                                           const std::vector<Guess>& guesses) const {
    if (is_identical(whole)) return {{}};
    const AlignmentTarget<Dim> target(whole.level_set);
    const int level = std::min({mask_level(Dim), query_->level_set.grid.level(), whole.level_set.grid.level()});
    const LevelSet<Dim> template_here = restricted(whole.level_set, level);
    std::vector<PartialStart<Dim>> result;
    for (std::size_t v = 0; v < views_.size(); ++v) {
        std::vector<PartialAlignmentCandidate<Dim>> candidates;
        for (const Guess& guess : guesses) {
            if (guess.view == v) candidates.push_back({guess.start.motion, guess.start.mismatch});
        }
        for (const auto& candidate :
             views_[v].aligner->refine(target, candidates, alignment_options(views_[v], whole))) {
            PartialStart<Dim> start = start_of(views_[v], candidate, whole, template_here);
            if (std::isfinite(start.penalty)) result.push_back(std::move(start));
        }
    }
    return result;
}

template <int Dim>
PartialDistance PartialMatcher<Dim>::measure(const ComparedShape<Dim>& whole, const PartialStart<Dim>& start,
                                             const GeodesicOptions& options, const std::function<bool()>& stop,
                                             GeodesicResult<Dim>* path) const {
    PartialDistance result;
    result.level = options.level;
    result.time_steps = options.time_steps;
    if (is_identical(whole) && path == nullptr) return result;
    try {
        GeodesicOptions solver = options;
        solver.align = "none";
        solver.starts = 1;
        const LevelSet<Dim>& shape = level_set(start);
        LevelSet<Dim> query = is_unmoved(start.motion) && shape.grid.level() >= options.level
                                  ? restricted(shape, options.level)
                                  : carried(shape, start.motion, options.level);
        LevelSet<Dim> target = restricted(whole.level_set, options.level);
        ScalarField<Dim> mask;
        if (!start.mask.values.empty()) {
            mask = start.mask.grid.level() >= options.level
                       ? restricted(start.mask, options.level)
                       : carried_mask(start.mask, Similarity<Dim>{}, options.level);
            if (options_.correction == "filled") {
                query = filled_in(query, target, mask);
                mask = widened(mask);
            } else if (options_.correction == "cut") {
                query = cut_off(query, mask);
                target = cut_off(target, mask);
                mask = {};
            } else {
                mask = widened(mask);
            }
        }
        GeodesicResult<Dim> solved = tbb::this_task_arena::isolate([&] {
            return compute_discrete_geodesic<Dim>(query, target, solver, mask,
                                                  [&](const LevelReport&) { return !(stop && stop()); });
        });
        result.length = solved.path_length;
        // What no path explains (the mismatch in the total energy) counts as well: templates that the query cannot
        // reach would else look near. A part of a shape costs less than the whole, so it is compared per visible share.
        const bool literal = options_.correction == "none";
        const double squared = literal ? result.length * result.length : solved.total_energy;
        const double visible = literal ? 1.0 : visible_weight(start.hidden_share);
        result.distance = std::sqrt(std::max(0.0, squared) / visible + start.penalty);
        result.error = solved.error / std::sqrt(visible);
        if (solved.termination == Termination::cancelled) {
            result.problem = "cancelled";
        } else if (!std::isfinite(result.length)) {
            result.problem = "the solver found no admissible path";
        }
        if (path) *path = std::move(solved);
    } catch (const std::bad_alloc&) {
        result.problem = "not enough memory; choose a lower --level or fewer --threads";
    } catch (const std::exception& error) {
        result.problem = error.what();
    }
    if (!result.problem.empty()) result.distance = result.error = result.length = nan;
    return result;
}

template ComparedShape<2> mirror_image<2>(const ComparedShape<2>&);
template ComparedShape<3> mirror_image<3>(const ComparedShape<3>&);
template class PartialMatcher<2>;
template class PartialMatcher<3>;
template LevelSet<2> filled_in<2>(const LevelSet<2>&, const LevelSet<2>&, const ScalarField<2>&);
template LevelSet<3> filled_in<3>(const LevelSet<3>&, const LevelSet<3>&, const ScalarField<3>&);
template LevelSet<2> redistanced<2>(const LevelSet<2>&);
template LevelSet<3> redistanced<3>(const LevelSet<3>&);
template ScalarField<2> grown_mask<2>(const LevelSet<2>&, const LevelSet<2>&, Hypothesis);
template ScalarField<3> grown_mask<3>(const LevelSet<3>&, const LevelSet<3>&, Hypothesis);

}  // namespace morphodesic::pipeline

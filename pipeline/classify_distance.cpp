#include "pipeline/classify_distance.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include "geodesic/grid/transfer.h"

namespace morphodesic::pipeline {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

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
    return all > 0 ? hidden / all : 0.0;
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
    const Similarity<Dim> identity;
    return s.scale == 1.0 && s.motion.rotation == identity.motion.rotation &&
           s.motion.translation == identity.motion.translation;
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
PartialMatcher<Dim>::PartialMatcher(std::shared_ptr<const ComparedShape<Dim>> query, const ClassifyOptions& options,
                                    const std::string& normalize, const std::string& align, bool estimate)
    : query_(std::move(query)),
      options_(options),
      free_size_(normalize == "each"),
      estimate_(estimate && query_->mask.values.empty()),
      align_(align),
      aligner_(query_->level_set, query_->mask) {}

template <int Dim>
std::vector<PartialStart<Dim>> PartialMatcher<Dim>::starts(const ComparedShape<Dim>& whole) const {
    std::vector<PartialStart<Dim>> result;
    const bool masked = !query_->mask.values.empty();
    if (!masked && query_->digest == whole.digest) {
        result.push_back({});
        return result;
    }
    PartialAlignmentOptions align;
    align.move = align_ != "none";
    align.rotate = align_ == "rigid";
    align.count = options_.alignments;
    const int level = std::min({mask_level(Dim), query_->level_set.grid.level(), whole.level_set.grid.level()});
    const LevelSet<Dim> template_here = restricted(whole.level_set, level);
    const double equal = std::pow(whole.volume / std::max(query_->volume, 1e-12), 1.0 / Dim);
    const double least = std::pow(1.0 - options_.largest_hidden, 1.0 / Dim);
    const auto add = [&](Hypothesis hypothesis) {
        for (const auto& candidate : aligner_.align(whole.level_set, align)) {
            PartialStart<Dim> start;
            start.motion = candidate.motion;
            start.mismatch = candidate.mismatch;
            start.hypothesis = hypothesis;
            if (hypothesis == Hypothesis::known) {
                start.mask = carried_mask(query_->mask, start.motion, level);
                start.hidden_share = hidden_share(template_here, start.mask);
            } else if (hypothesis != Hypothesis::complete) {
                const auto query_here = carried(query_->level_set, start.motion, level);
                start.mask = grown_mask(query_here, template_here, hypothesis);
                start.hidden_share = hidden_share(template_here, start.mask);
                const double share =
                    hypothesis == Hypothesis::missing ? start.hidden_share : hidden_share(query_here, start.mask);
                if (share == 0.0 || share > options_.largest_hidden) continue;
                start.penalty = options_.hidden_cost * options_.hidden_cost * share * whole.volume;
            }
            result.push_back(std::move(start));
        }
    };
    if (masked) {
        if (free_size_) {
            align.least_scale = equal * least;
            align.largest_scale = equal * 1.05;
        }
        add(Hypothesis::known);
        return result;
    }
    add(Hypothesis::complete);
    if (!estimate_) return result;
    align.missing_weight = 0.1;
    if (free_size_) {
        align.least_scale = equal * least;
        align.largest_scale = equal * 1.05;
    }
    add(Hypothesis::missing);
    align.missing_weight = 1.0;
    align.added_weight = 0.1;
    if (free_size_) {
        align.least_scale = equal * 0.95;
        align.largest_scale = equal / least;
    }
    add(Hypothesis::added);
    return result;
}

template <int Dim>
PartialDistance PartialMatcher<Dim>::measure(const ComparedShape<Dim>& whole, const PartialStart<Dim>& start,
                                             const GeodesicOptions& options, const std::function<bool()>& stop,
                                             GeodesicResult<Dim>* path) const {
    PartialDistance result;
    result.level = options.level;
    result.time_steps = options.time_steps;
    if (query_->mask.values.empty() && query_->digest == whole.digest && path == nullptr) return result;
    try {
        GeodesicOptions solver = options;
        solver.align = "none";
        solver.starts = 1;
        LevelSet<Dim> query = is_unmoved(start.motion) && query_->level_set.grid.level() >= options.level
                                  ? restricted(query_->level_set, options.level)
                                  : carried(query_->level_set, start.motion, options.level);
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
        const double visible = literal ? 1.0 : std::max(0.05, 1.0 - start.hidden_share);
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

template class PartialMatcher<2>;
template class PartialMatcher<3>;
template LevelSet<2> filled_in<2>(const LevelSet<2>&, const LevelSet<2>&, const ScalarField<2>&);
template LevelSet<3> filled_in<3>(const LevelSet<3>&, const LevelSet<3>&, const ScalarField<3>&);
template LevelSet<2> redistanced<2>(const LevelSet<2>&);
template LevelSet<3> redistanced<3>(const LevelSet<3>&);
template ScalarField<2> grown_mask<2>(const LevelSet<2>&, const LevelSet<2>&, Hypothesis);
template ScalarField<3> grown_mask<3>(const LevelSet<3>&, const LevelSet<3>&, Hypothesis);

}  // namespace morphodesic::pipeline

#include "pipeline/classify_screening.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace morphodesic::pipeline {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

}  // namespace

std::vector<ScreeningStage> screening_stages(const GeodesicOptions& options) {
    struct Coarse {
        int level, steps;
        double least, largest;
    };
    std::vector<ScreeningStage> stages;
    for (const Coarse& c : {Coarse{4, 1, 0.65, 1.9}, Coarse{5, 2, 0.85, 1.4}}) {
        if (options.level <= c.level || options.time_steps < c.steps) continue;
        ScreeningStage stage{options, c.least, c.largest};
        stage.geodesic.level = c.level;
        stage.geodesic.time_steps = c.steps;
        stage.geodesic.tolerance = std::max(options.tolerance, 1e-2);
        stages.push_back(stage);
    }
    stages.push_back({options, 1.0, 1.0});
    return stages;
}

template <int Dim>
std::vector<TemplateResult<Dim>> compare_with_templates(
    const PartialMatcher<Dim>& query, const std::vector<std::shared_ptr<const ComparedShape<Dim>>>& templates,
    const GeodesicOptions& geodesic, const ClassifyOptions& options, const std::function<bool()>& stop,
    std::optional<std::size_t> skip) {
    const std::vector<ScreeningStage> stages = screening_stages(geodesic);
    std::vector<TemplateResult<Dim>> results;
    for (std::size_t t = 0; t < templates.size(); ++t) {
        if (skip != t) results.push_back({t, {}, {}, nan, nan, false});
    }
    // First stage: all templates, all starts.
    tbb::parallel_for(std::size_t{0}, results.size(), [&](std::size_t r) {
        TemplateResult<Dim>& result = results[r];
        result.measured.distance = nan;
        if (stop && stop()) return;
        std::string problem = "no alignment was found";
        try {
            for (PartialStart<Dim>& start : query.starts(*templates[result.item])) {
                const PartialDistance d = query.measure(*templates[result.item], start, stages.front().geodesic, stop);
                if (!d.problem.empty()) {
                    problem = d.problem;
                } else if (!(d.distance >= result.measured.distance)) {
                    result.measured = d;
                    result.start = std::move(start);
                }
            }
        } catch (const std::exception& error) {
            problem = error.what();
        }
        if (std::isnan(result.measured.distance)) result.measured.problem = problem;
    });
    std::vector<char> alive(results.size(), 1);
    std::vector<double> first(results.size());  // distances of the stage before
    std::vector<double> estimate(results.size());
    for (std::size_t r = 0; r < results.size(); ++r) {
        estimate[r] = results[r].measured.distance;
        alive[r] = results[r].measured.problem.empty() ? 1 : 0;
    }
    for (std::size_t s = 1; s < stages.size(); ++s) {
        const ScreeningStage& before = stages[s - 1];
        if (options.screening) {
            // Upper ends of the bars: of the best template, and of the best one of another class.
            double best = infinity, second = infinity;
            std::string best_class;
            std::vector<double> nearest;
            for (std::size_t r = 0; r < results.size(); ++r) {
                if (!alive[r]) continue;
                nearest.push_back(estimate[r]);
                if (estimate[r] < best) {
                    best = estimate[r];
                    best_class = templates[results[r].item]->label;
                }
            }
            for (std::size_t r = 0; r < results.size(); ++r) {
                if (alive[r] && templates[results[r].item]->label != best_class) second = std::min(second, estimate[r]);
            }
            // A mean over k templates needs k of them.
            std::sort(nearest.begin(), nearest.end());
            const std::size_t k = std::min(nearest.size(), static_cast<std::size_t>(options.neighbours));
            if (k > 0) best = std::max(best, nearest[k - 1]);
            for (std::size_t r = 0; r < results.size(); ++r) {
                if (!alive[r]) continue;
                const bool may_win = estimate[r] * before.least_factor <= best * before.largest_factor;
                const bool is_second = estimate[r] == second;
                if (!may_win && !is_second) alive[r] = 0;
            }
        }
        double sum_before = 0.0, sum_now = 0.0;
        first = estimate;
        tbb::parallel_for(std::size_t{0}, results.size(), [&](std::size_t r) {
            if (!alive[r] || (stop && stop())) return;
            TemplateResult<Dim>& result = results[r];
            result.measured = query.measure(*templates[result.item], result.start, stages[s].geodesic, stop);
            estimate[r] = result.measured.distance;
        });
        for (std::size_t r = 0; r < results.size(); ++r) {
            if (!alive[r] || std::isnan(estimate[r])) continue;
            sum_before += first[r];
            sum_now += estimate[r];
        }
        // Those left behind: their distance grows like that of those that went on.
        const double growth = sum_before > 0 ? sum_now / sum_before : 1.0;
        double least = infinity;
        for (std::size_t r = 0; r < results.size(); ++r) {
            if (alive[r] && !std::isnan(estimate[r])) least = std::min(least, estimate[r]);
        }
        for (std::size_t r = 0; r < results.size(); ++r) {
            if (alive[r]) {
                if (std::isnan(estimate[r])) alive[r] = 0;
            } else if (!std::isnan(estimate[r])) {
                estimate[r] = std::max(estimate[r] * growth, least);
            }
        }
    }
    for (std::size_t r = 0; r < results.size(); ++r) {
        results[r].refined = alive[r] && results[r].measured.level == geodesic.level &&
                             results[r].measured.time_steps == geodesic.time_steps;
        results[r].distance = estimate[r];
        results[r].error = results[r].refined ? results[r].measured.error : 0.4 * estimate[r];
    }
    return results;
}

template std::vector<TemplateResult<2>> compare_with_templates<2>(
    const PartialMatcher<2>&, const std::vector<std::shared_ptr<const ComparedShape<2>>>&, const GeodesicOptions&,
    const ClassifyOptions&, const std::function<bool()>&, std::optional<std::size_t>);
template std::vector<TemplateResult<3>> compare_with_templates<3>(
    const PartialMatcher<3>&, const std::vector<std::shared_ptr<const ComparedShape<3>>>&, const GeodesicOptions&,
    const ClassifyOptions&, const std::function<bool()>&, std::optional<std::size_t>);

}  // namespace morphodesic::pipeline

#include "pipeline/classify_screening.h"

#include <algorithm>
#include <cmath>

#include "analysis/special_numbers.h"
#include "pipeline/whole_tasks.h"

namespace morphodesic::pipeline {
namespace {

using analysis::infinity;
using analysis::nan;

/// A template goes on to geodesics if its distance as laid upon, without any deformation, is at most so many times that
/// of the best one.
constexpr double guess_factor = 2.0;

/// Estimates for those that were left out: their distance grows like that of those that went on.
void estimate_left_out(const std::vector<double>& before, const std::vector<char>& alive,
                       std::vector<double>& estimate) {
    double sum_before = 0.0, sum_now = 0.0, least = infinity;
    for (std::size_t r = 0; r < estimate.size(); ++r) {
        if (!alive[r] || std::isnan(estimate[r])) continue;
        sum_before += before[r];
        sum_now += estimate[r];
        least = std::min(least, estimate[r]);
    }
    const double growth = sum_before > 0 ? sum_now / sum_before : 1.0;
    for (std::size_t r = 0; r < estimate.size(); ++r) {
        if (!alive[r] && !std::isnan(estimate[r])) estimate[r] = std::max(estimate[r] * growth, least);
    }
}

}  // namespace

std::vector<ScreeningStage> screening_stages(const GeodesicOptions& options) {
    struct Coarse {
        int level, steps;
        double least, largest;
    };
    std::vector<ScreeningStage> stages;
    for (const Coarse& c : {Coarse{4, 1, 0.85, 2.15}, Coarse{5, 2, 0.85, 1.4}}) {
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
    // The largest distance that goes on to the next stage: those that can be among the k nearest (a mean over k
    // templates needs k of them), and the best of another class, which the margin needs.
    const auto limit_of = [&](const std::vector<double>& distances, double factor) {
        if (distances.empty()) return infinity;
        std::vector<double> sorted = distances;
        std::sort(sorted.begin(), sorted.end());
        const double kth = sorted[std::min(sorted.size(), static_cast<std::size_t>(options.neighbours)) - 1];
        const auto best =
            static_cast<std::size_t>(std::min_element(distances.begin(), distances.end()) - distances.begin());
        double other = infinity;
        for (std::size_t r = 0; r < distances.size(); ++r) {
            if (templates[results[r].item]->label != templates[results[best].item]->label) {
                other = std::min(other, distances[r]);
            }
        }
        return std::isfinite(other) ? std::max(factor * kth, other) : factor * kth;
    };
    for (std::size_t t = 0; t < templates.size(); ++t) {
        if (skip != t) results.push_back({t, {}, {}, nan, nan, false});
    }
    // All templates, all ways to lay the query on them: nothing is deformed yet.
    std::vector<std::vector<typename PartialMatcher<Dim>::Guess>> guesses(results.size());
    std::vector<std::string> problems(results.size(), "no alignment was found");
    for_each_whole(results.size(), [&](std::size_t r) {
        results[r].measured.distance = nan;
        if (stop && stop()) return;
        try {
            guesses[r] = query.guesses(*templates[results[r].item]);
        } catch (const std::exception& error) {
            problems[r] = error.what();
        }
    });
    std::vector<double> guessed(results.size(), infinity);
    for (std::size_t r = 0; r < results.size(); ++r) {
        for (auto& guess : guesses[r]) {
            if (guess.score >= guessed[r]) continue;
            guessed[r] = guess.score;
            results[r].start = guess.start;
        }
    }
    const double guess_limit = options.screening ? limit_of(guessed, guess_factor) : infinity;
    // First geodesics: the best start of each template.
    for_each_whole(results.size(), [&](std::size_t r) {
        TemplateResult<Dim>& result = results[r];
        if (stop && stop()) return;
        std::erase_if(guesses[r], [&](const auto& guess) { return guess.score > guess_limit; });
        if (guesses[r].empty()) {
            if (std::isfinite(guessed[r])) problems[r].clear();
            return;
        }
        try {
            for (PartialStart<Dim>& start : query.starts(*templates[result.item], guesses[r])) {
                const PartialDistance d = query.measure(*templates[result.item], start, stages.front().geodesic, stop);
                if (!d.problem.empty()) {
                    problems[r] = d.problem;
                } else if (!(d.distance >= result.measured.distance)) {
                    result.measured = d;
                    result.start = std::move(start);
                }
            }
        } catch (const std::exception& error) {
            problems[r] = error.what();
        }
        if (std::isnan(result.measured.distance)) result.measured.problem = problems[r];
    });
    std::vector<char> alive(results.size(), 1);
    std::vector<double> first = guessed;  // distances of the stage before
    std::vector<double> estimate(results.size());
    for (std::size_t r = 0; r < results.size(); ++r) {
        estimate[r] = results[r].measured.distance;
        alive[r] = std::isnan(estimate[r]) ? 0 : 1;
        const bool left_out = !alive[r] && problems[r].empty();
        if (left_out) estimate[r] = guessed[r];
    }
    estimate_left_out(first, alive, estimate);
    for (std::size_t s = 1; s < stages.size(); ++s) {
        const ScreeningStage& before = stages[s - 1];
        if (options.screening) {
            std::vector<double> known = estimate;
            for (std::size_t r = 0; r < results.size(); ++r) {
                if (!alive[r]) known[r] = infinity;
            }
            const double limit = limit_of(known, before.largest_factor / before.least_factor);
            for (std::size_t r = 0; r < results.size(); ++r) {
                if (alive[r] && estimate[r] > limit) alive[r] = 0;
            }
        }
        first = estimate;
        for_each_whole(results.size(), [&](std::size_t r) {
            if (!alive[r] || (stop && stop())) return;
            TemplateResult<Dim>& result = results[r];
            result.measured = query.measure(*templates[result.item], result.start, stages[s].geodesic, stop);
            estimate[r] = result.measured.distance;
        });
        estimate_left_out(first, alive, estimate);
        for (std::size_t r = 0; r < results.size(); ++r) alive[r] = alive[r] && !std::isnan(estimate[r]);
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

#include "analysis/classify.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>

#include "analysis/evaluation.h"
#include "analysis/statistics.h"

namespace morphodesic::analysis {
namespace {

std::vector<RankedClass> rank_classes(std::span<const RankedTemplate> templates, std::span<const std::string> classes,
                                      std::size_t neighbours) {
    struct Sums {
        std::size_t count = 0, nearest = 0;
        double distance = 0.0, error = 0.0;
    };
    std::map<std::string_view, Sums> sums;
    for (const RankedTemplate& t : templates) {  // nearest first
        if (classes[t.item].empty()) continue;
        Sums& s = sums[classes[t.item]];
        if (s.count == neighbours) continue;
        if (s.count++ == 0) s.nearest = t.item;
        s.distance += t.distance;
        s.error += t.error;
    }
    std::vector<RankedClass> ranked;
    for (const auto& [name, s] : sums) {
        const auto count = static_cast<double>(s.count);
        ranked.push_back({std::string(name), s.distance / count, s.error / count, s.nearest});
    }
    std::stable_sort(ranked.begin(), ranked.end(),
                     [](const RankedClass& a, const RankedClass& b) { return a.distance < b.distance; });
    return ranked;
}

double margin_of(const std::vector<RankedClass>& ranked) {
    if (ranked.size() < 2) return 1.0;
    const double sum = ranked[0].distance + ranked[1].distance;
    return sum > 0.0 ? (ranked[1].distance - ranked[0].distance) / sum : 0.0;
}

std::vector<RankedTemplate> rank_templates(std::span<const double> distances, std::span<const double> errors) {
    std::vector<RankedTemplate> ranked;
    for (std::size_t t = 0; t < distances.size(); ++t) {
        if (!std::isnan(distances[t])) ranked.push_back({t, distances[t], errors.empty() ? missing : errors[t]});
    }
    std::stable_sort(ranked.begin(), ranked.end(),
                     [](const RankedTemplate& a, const RankedTemplate& b) { return a.distance < b.distance; });
    return ranked;
}

double scale_of(const Calibration& calibration, const std::string& name) {
    for (const auto& s : calibration.scales) {
        if (s.name == name) return s.scale;
    }
    return missing;
}

/// d1 / scale (d1 / d2)^exponent, for the scale of the nearest class.
double novelty_of(const std::vector<RankedClass>& ranked, double scale, double exponent) {
    const double distance = ranked.front().distance;
    if (distance == 0.0) return 0.0;
    if (!(scale > 0.0)) return std::isnan(scale) ? missing : std::numeric_limits<double>::infinity();
    if (exponent == 0.0 || ranked.size() < 2) return distance / scale;
    return distance / scale * std::pow(distance / ranked[1].distance, exponent);
}

/// Scale of a class whose members are so far from their nearest other member. Few members tell little of their class,
/// so it is drawn towards the typical distance of all classes: as if by one more member, and then half the way.
double class_scale(std::vector<double> within, double typical) {
    if (!std::isnan(typical)) within.push_back(typical);
    const double own = mean(within);
    return typical > 0.0 ? std::sqrt(own * typical) : own;
}

/// The rank that keeps the promised rate also for the next query (conformal prediction). @return NaN: too few values
double conformal_limit(std::vector<double> values, double rate) {
    std::sort(values.begin(), values.end());
    const double rank = std::ceil((1.0 - rate) * static_cast<double>(values.size() + 1));
    if (!(rate > 0.0) || !(rank <= static_cast<double>(values.size()))) return missing;
    return values[static_cast<std::size_t>(rank) - 1];
}

/// A template as if it were a query.
struct LeftOut {
    std::vector<RankedClass> ranked;
    double scale;  ///< of the nearest class, as the other templates tell it
};

/// Exponent and limit of the novelty: members must be accepted at the promised rate, and as many templates as possible
/// turned away whose own class is left out. Larger exponents turn away more of them, and break the promise to members
/// that are no templates.
void calibrate_novelty(const std::vector<LeftOut>& members, const std::vector<LeftOut>& strangers,
                       Calibration& result) {
    result.strangers = strangers.size();
    for (const double exponent : {0.0, 0.5, 1.0, 2.0}) {
        std::vector<double> novelties;
        for (const LeftOut& m : members) novelties.push_back(novelty_of(m.ranked, m.scale, exponent));
        const double limit = conformal_limit(novelties, result.options.false_rejection);
        const auto rejected =
            static_cast<std::size_t>(std::count_if(strangers.begin(), strangers.end(), [&](const LeftOut& s) {
                return s.ranked.size() > 1 && novelty_of(s.ranked, s.scale, exponent) > limit;
            }));
        if (exponent > 0.0 && rejected <= result.strangers_rejected) continue;
        result.novelty_exponent = exponent;
        result.novelty_limit = limit;
        result.strangers_rejected = rejected;
    }
}

void check(const ClassifyOptions& options) {
    if (options.neighbours == 0) throw std::invalid_argument("classification needs at least one neighbour");
    if (!(options.false_rejection >= 0.0 && options.false_rejection < 1.0) ||
        !(options.least_confidence >= 0.0 && options.least_confidence <= 1.0)) {
        throw std::invalid_argument("rates of rejection and confidence lie between 0 and 1");
    }
}

}  // namespace

const char* to_string(Rejection rejection) {
    switch (rejection) {
        case Rejection::accepted:
            return "accepted";
        case Rejection::no_known_distance:
            return "no known distance";
        case Rejection::too_far:
            return "too far from all classes";
        case Rejection::too_uncertain:
            return "too uncertain";
    }
    return "?";
}

Calibration calibrate(const DistanceMatrix& templates, std::span<const std::string> classes,
                      const ClassifyOptions& options) {
    check(options);
    const std::size_t n = templates.size();
    if (classes.size() != n) throw std::invalid_argument("one class per template is needed, \"\" if there is none");
    Calibration result;
    result.options = options;
    result.confidence.kind = options.calibration;
    const std::vector<ClassCount> counts = class_counts(classes);
    std::map<std::string, std::vector<double>> own;  // distance of each member to its own class
    std::vector<double> all, margins;
    std::vector<std::vector<RankedClass>> rankings;
    std::vector<std::pair<std::string, double>> queries;  // class and distance to it, NaN if not known
    std::vector<unsigned char> right;
    std::vector<double> row(n);
    for (std::size_t i = 0; i < n; ++i) {
        if (classes[i].empty()) continue;
        const auto count =
            std::find_if(counts.begin(), counts.end(), [&](const ClassCount& c) { return c.name == classes[i]; });
        if (count->members < 2) continue;
        for (std::size_t j = 0; j < n; ++j) row[j] = j == i ? missing : templates(i, j);
        const std::vector<RankedClass> ranked = rank_classes(rank_templates(row, {}), classes, options.neighbours);
        ++result.queries;
        if (ranked.empty()) continue;
        const bool good = ranked.front().name == classes[i];
        result.right += good ? 1 : 0;
        margins.push_back(margin_of(ranked));
        right.push_back(good ? 1 : 0);
        queries.emplace_back(classes[i], missing);
        for (const RankedClass& c : ranked) {
            if (c.name != classes[i]) continue;
            own[classes[i]].push_back(c.distance);
            all.push_back(c.distance);
            queries.back().second = c.distance;
        }
        rankings.push_back(ranked);
    }
    // Among members of one class no answer could be wrong.
    if (result.queries > 0 && counts.size() > 1)
        result.accuracy = static_cast<double>(result.right) / static_cast<double>(result.queries);
    const double typical = quantile(all, 0.5);
    for (const ClassCount& c : counts) {
        result.scales.push_back({c.name, class_scale(own[c.name], typical)});
    }
    std::vector<LeftOut> members, strangers;
    for (std::size_t q = 0; q < rankings.size(); ++q) {
        const auto& [name, distance] = queries[q];
        std::vector<double> others = own[name];
        if (!std::isnan(distance)) others.erase(std::find(others.begin(), others.end(), distance));
        const std::string& nearest = rankings[q].front().name;
        members.push_back({rankings[q], nearest == name ? class_scale(others, typical) : scale_of(result, nearest)});
        std::vector<RankedClass> foreign = rankings[q];
        std::erase_if(foreign, [&, &own_class = name](const RankedClass& c) { return c.name == own_class; });
        if (foreign.empty()) continue;
        const double scale = scale_of(result, foreign.front().name);
        strangers.push_back({std::move(foreign), scale});
    }
    result.members = members.size();
    calibrate_novelty(members, strangers, result);
    result.confidence = fit_confidence(margins, right, options.calibration);
    if (margins.size() < 2) {  // nothing to judge the confidences by
        result.reliability = reliability({}, {});
        return result;
    }
    // Five folds over the margins in order, so that every fold has small and large ones.
    std::vector<std::size_t> order(margins.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return margins[a] < margins[b]; });
    std::vector<double> said(margins.size());
    for (std::size_t fold = 0; fold < 5; ++fold) {
        std::vector<double> fold_margins;
        std::vector<unsigned char> fold_right;
        for (std::size_t k = 0; k < order.size(); ++k) {
            if (k % 5 == fold) continue;
            fold_margins.push_back(margins[order[k]]);
            fold_right.push_back(right[order[k]]);
        }
        const ConfidenceCurve curve = fit_confidence(fold_margins, fold_right, options.calibration);
        for (std::size_t k = fold; k < order.size(); k += 5) said[order[k]] = curve(margins[order[k]]);
    }
    result.reliability = reliability(said, right);
    return result;
}

Classification classify(std::span<const double> distances, std::span<const std::string> classes,
                        const ClassifyOptions& options, const Calibration* calibration,
                        std::span<const double> errors) {
    check(options);
    if (distances.size() != classes.size() || (!errors.empty() && errors.size() != distances.size())) {
        throw std::invalid_argument("distances, classes and error bars of the templates differ in number");
    }
    if (std::any_of(distances.begin(), distances.end(), [](double d) { return d < 0.0; })) {
        throw std::invalid_argument("a distance is negative");
    }
    Classification result;
    result.templates = rank_templates(distances, errors);
    result.classes = rank_classes(result.templates, classes, options.neighbours);
    if (result.classes.empty()) {
        result.rejection = Rejection::no_known_distance;
        return result;
    }
    const RankedClass& best = result.classes.front();
    result.label = best.name;
    result.margin = margin_of(result.classes);
    if (result.classes.size() > 1) {
        const RankedClass& second = result.classes[1];
        result.separated = best.distance + best.error < second.distance - second.error;  // false for NaN
    }
    if (calibration == nullptr) return result;
    result.confidence = calibration->confidence(result.margin);
    result.novelty = novelty_of(result.classes, scale_of(*calibration, best.name), calibration->novelty_exponent);
    if (result.novelty > calibration->novelty_limit) {
        result.rejection = Rejection::too_far;
    } else if (result.confidence < options.least_confidence) {
        result.rejection = Rejection::too_uncertain;
    }
    return result;
}

}  // namespace morphodesic::analysis

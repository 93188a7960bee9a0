#include "pipeline/study_comparison.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <stdexcept>

#include "analysis/comparison.h"
#include "pipeline/common_scale.h"

namespace morphodesic::pipeline {
namespace {

std::vector<std::pair<std::string, std::pair<std::string, std::string>>> settings_of(const StudyData& study) {
    const RunSettings& settings = study.settings;
    std::vector<std::pair<std::string, std::pair<std::string, std::string>>> result;
    const auto add = [&](const char* name, const auto& value, const char* help) {
        std::ostringstream text;
        text << std::boolalpha << value;
        result.push_back({name, {text.str(), help}});
    };
    RunSettings::for_each_field(settings, add);
    PairSelection::for_each_field(settings.pairs, add);
    add("common-scale", study.common_scale, common_scale_help);
    return result;
}

/// Distances of the pairs that both know, (here, there); about so many of them, evenly chosen.
std::vector<std::pair<double, double>> common_distances(const analysis::DistanceMatrix& here,
                                                        const analysis::DistanceMatrix& there, std::size_t most) {
    std::map<std::string, std::size_t> number;
    for (std::size_t i = 0; i < there.size(); ++i) number.emplace(there.labels()[i], i);
    std::vector<std::pair<std::size_t, std::size_t>> common;
    for (std::size_t i = 0; i < here.size(); ++i) {
        if (const auto found = number.find(here.labels()[i]); found != number.end()) {
            common.emplace_back(i, found->second);
        }
    }
    std::vector<std::pair<double, double>> all;
    for (std::size_t p = 0; p < common.size(); ++p) {
        for (std::size_t q = p + 1; q < common.size(); ++q) {
            const double a = here(common[p].first, common[q].first), b = there(common[p].second, common[q].second);
            if (!std::isnan(a) && !std::isnan(b)) all.emplace_back(a, b);
        }
    }
    if (all.size() <= most) return all;
    std::vector<std::pair<double, double>> chosen;
    for (std::size_t k = 0; k < most; ++k) chosen.push_back(all[k * all.size() / most]);
    return chosen;
}

}  // namespace

reports::Comparison compare_studies(const StudyData& here, const StudyData& there, const std::string& other_name,
                                    int neighbours) {
    const analysis::MatrixComparison found =
        analysis::compare(here.distances, there.distances, static_cast<std::size_t>(neighbours));
    if (found.pairs == 0) {
        throw std::invalid_argument(other_name + ": no pair of shapes has a distance in both studies; shapes are " +
                                    "matched by their names");
    }
    reports::Comparison result;
    result.other = other_name;
    result.common_shapes = static_cast<int>(found.labels.size());
    result.common_pairs = static_cast<int>(found.pairs);
    result.spearman = found.spearman;
    result.kendall = found.kendall;
    result.pearson = found.pearson;
    result.neighbours = neighbours;
    result.mean_overlap = found.mean_overlap;
    for (const analysis::MovedNeighbours& m : found.moved) {
        result.moved.push_back({found.labels[m.item], m.nearest_here, m.nearest_there, m.overlap});
    }
    result.distances = common_distances(here.distances, there.distances, 5000);
    if (here.given || there.given) return result;
    const auto ours = settings_of(here), theirs = settings_of(there);
    for (std::size_t k = 0; k < ours.size(); ++k) {
        const std::string &a = ours[k].second.first, &b = theirs[k].second.first;
        if (a != b) result.different_settings.push_back({ours[k].first, a + " | " + b, ours[k].second.second});
    }
    return result;
}

}  // namespace morphodesic::pipeline

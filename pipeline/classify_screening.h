#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "pipeline/classify_distance.h"

namespace morphodesic::pipeline {

/// What is known of one template after the screening.
template <int Dim>
struct TemplateResult {
    std::size_t item = 0;  ///< number of the template
    PartialStart<Dim> start;
    PartialDistance measured;  ///< on the finest level that was solved
    double distance = 0.0;     ///< on the finest level; an estimate from coarser ones if the screening left it out; NaN
    double error = 0.0;        ///< error bar of distance
    bool refined = false;      ///< solved on the finest level
};

/// One round of the screening: how fine, and between which factors of a distance found there that of the finest level
/// is taken to lie. The factors are assumed, not measured: wide enough for the first order in h of the lengths
///, and the tests compare answers with and without screening.
struct ScreeningStage {
    GeodesicOptions geodesic;
    double least_factor = 1.0, largest_factor = 1.0;
};

/// From coarse to what the options ask for.
[[nodiscard]] std::vector<ScreeningStage> screening_stages(const GeodesicOptions& options);

/// Compares a query with all templates: coarsely with all, finely with those whose bars reach below the upper end of
/// the best one's, for the distance to the best class also with the best of the second class. Without screening all
/// stages are solved for all templates.
/// @param skip  this template is left out (leave-one-out)
/// @return one entry per template but the skipped one, in the order of the templates
template <int Dim>
[[nodiscard]] std::vector<TemplateResult<Dim>> compare_with_templates(
    const PartialMatcher<Dim>& query, const std::vector<std::shared_ptr<const ComparedShape<Dim>>>& templates,
    const GeodesicOptions& geodesic, const ClassifyOptions& options, const std::function<bool()>& stop,
    std::optional<std::size_t> skip = {});

}  // namespace morphodesic::pipeline

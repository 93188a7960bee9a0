#pragma once

#include "pipeline/classify_distance.h"
#include "pipeline/classify_results.h"
#include "reports/classification_page.h"

namespace morphodesic::pipeline {

/// What is visible of a query in one colour; hatched where it is hidden.
template <int Dim>
[[nodiscard]] reports::Picture query_picture(const LevelSet<Dim>& visible, const ScalarField<Dim>& mask, int pixels);

/// Solves the masked geodesic, its hidden part as stiff as the template's, and draws it.
template <int Dim>
[[nodiscard]] reports::Filmstrip filmstrip(std::shared_ptr<const ComparedShape<Dim>> query,
                                           const ComparedShape<Dim>& whole, const PartialStart<Dim>& start,
                                           const ClassificationRun& run);

/// The page of a run; pictures and strips of the queries are added by the caller.
[[nodiscard]] reports::ClassificationPage classification_page(const ClassificationRun& run, const std::string& command);

}  // namespace morphodesic::pipeline

#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "datasets/import.h"
#include "pipeline/classify_distance.h"
#include "pipeline/run_settings.h"

namespace morphodesic::pipeline {

/// Complete shapes of known classes, and how queries are to be read and placed to be comparable with them.
template <int Dim>
struct TemplateSet {
    std::vector<std::shared_ptr<const ComparedShape<Dim>>> shapes;  ///< sorted by name
    datasets::ImportOptions import;
    datasets::NormalizeOptions placement;
    std::vector<std::string> remarks;   ///< what a user should know, one sentence each
    std::vector<std::string> problems;  ///< files that could not be used, in words
};

/// True for a study folder.
[[nodiscard]] bool is_study(const std::filesystem::path& folder);

/// Dimension of the shapes in a study or folder. @throws datasets::ReadError, StoreError
[[nodiscard]] int template_dimension(const std::filesystem::path& folder, const RunSettings& settings);

/// Takes the templates from the store of a study, or reads a folder.
/// @param settings  of a folder; a study has its own way of reading and placing, only the solver's level is used
/// @throws datasets::ReadError, StoreError, std::invalid_argument if there are no templates
template <int Dim>
[[nodiscard]] TemplateSet<Dim> load_templates(const std::filesystem::path& folder, const RunSettings& settings);

/// Share of the places where the contour crosses the grid at which chi is 1, as alignments need it.
template <int Dim>
[[nodiscard]] double visible_contour(const LevelSet<Dim>& u, const ScalarField<Dim>& mask);

/// Reads and places one query; a scan that is small beside the templates on a finer grid than theirs, since what is
/// hidden has a rim of a few cells.
/// @throws datasets::ReadError also where nothing of its contour is visible
/// @param ignore_mask  take the picture as it is, whatever is known to be hidden
template <int Dim>
[[nodiscard]] ComparedShape<Dim> load_query(const datasets::ShapeSource& source, const TemplateSet<Dim>& templates,
                                            const datasets::ImportOptions& import, bool ignore_mask);

}  // namespace morphodesic::pipeline

#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "geodesic/discrete_geodesic.h"
#include "geodesic/solver/partial_alignment.h"
#include "pipeline/classify_options.h"

namespace morphodesic::pipeline {

/// A shape that is compared: a template, or a query of which a part may be hidden.
template <int Dim>
struct ComparedShape {
    std::string name, label, digest;
    LevelSet<Dim> level_set;  ///< of what is visible
    ScalarField<Dim> mask;    ///< chi, 0 where nothing is known; empty: known everywhere
    double volume = 0.0;      ///< of what is visible, in units of the cube
    std::vector<std::string> notes;
};

/// Why the visible part of a query may differ from the template.
enum class Hypothesis {
    complete,  ///< nothing is hidden
    known,     ///< hidden where the mask says so
    missing,   ///< estimated: a part of the query is missing
    added,     ///< estimated: something was added to the query, e.g. an occluder of the same colour
};
[[nodiscard]] const char* to_string(Hypothesis hypothesis);

/// Where the geodesic from the query to a template starts.
template <int Dim>
struct PartialStart {
    Similarity<Dim> motion;  ///< from the query's frame to that of the template
    Hypothesis hypothesis = Hypothesis::complete;
    ScalarField<Dim> mask;      ///< chi in the frame of the template; empty: known everywhere
    double hidden_share = 0.0;  ///< share of the template's area (volume) that lies where chi = 0
    double penalty = 0.0;       ///< squared distance that an estimated mask costs
    double mismatch = 0.0;      ///< of the alignment
};

/// Distance of the visible part of a query from a template.
struct PartialDistance {
    /// sqrt((path energy + what the mismatch weighs) / visible share of the template); with the correction "none" the
    /// path length.
    double distance = 0.0;
    double error = 0.0;   ///< its error bar
    double length = 0.0;  ///< path length as solved
    int level = 0, time_steps = 0;
    std::string problem;  ///< why there is no trustworthy distance; empty if there is one
};

/// Compares one query with templates: alignment of what is visible, hypotheses on what is hidden, masked geodesics.
template <int Dim>
class PartialMatcher {
public:
    /// @param normalize  datasets::NormalizeOptions::mode: "each" leaves the size of a partly hidden query open
    /// @param estimate   with no mask known, look for missing and added parts
    PartialMatcher(std::shared_ptr<const ComparedShape<Dim>> query, const ClassifyOptions& options,
                   const std::string& normalize, const std::string& align, bool estimate);

    [[nodiscard]] const ComparedShape<Dim>& query() const { return *query_; }

    /// Starts that are worth a coarse geodesic.
    [[nodiscard]] std::vector<PartialStart<Dim>> starts(const ComparedShape<Dim>& whole) const;

    /// Solves the geodesic from the query to the template.
    /// @param path  receives the path in the frame of the template, unless null
    [[nodiscard]] PartialDistance measure(const ComparedShape<Dim>& whole, const PartialStart<Dim>& start,
                                          const GeodesicOptions& options, const std::function<bool()>& stop,
                                          GeodesicResult<Dim>* path = nullptr) const;

private:
    std::shared_ptr<const ComparedShape<Dim>> query_;
    ClassifyOptions options_;
    bool free_size_, estimate_;
    std::string align_;
    PartialAligner<Dim> aligner_;
};

/// The union of what is visible and of the part of a whole shape that lies where chi < 1/2, as a signed distance near
/// its contour.
template <int Dim>
[[nodiscard]] LevelSet<Dim> filled_in(const LevelSet<Dim>& visible, const LevelSet<Dim>& whole,
                                      const ScalarField<Dim>& mask);

/// A level set with the same contour whose values are distances to it again, by propagation of the nearest contour
/// points over the grid.
template <int Dim>
[[nodiscard]] LevelSet<Dim> redistanced(const LevelSet<Dim>& u);

/// chi in the frame of the template where the two shapes, laid on each other, do not belong together: the template
/// alone (missing) or the query alone (added) deeper than 1/32 of the cube.
template <int Dim>
[[nodiscard]] ScalarField<Dim> grown_mask(const LevelSet<Dim>& query, const LevelSet<Dim>& whole,
                                          Hypothesis hypothesis);

}  // namespace morphodesic::pipeline

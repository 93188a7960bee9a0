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
    cut_off,   ///< estimated: what lay beyond a straight line is missing
};
[[nodiscard]] const char* to_string(Hypothesis hypothesis);

/// Where the geodesic from the query to a template starts.
template <int Dim>
struct PartialStart {
    Similarity<Dim> motion;  ///< from the frame of the query (of its mirror image) to that of the template
    bool mirrored = false;   ///< the mirror image of the query is compared, see mirror_image()
    Hypothesis hypothesis = Hypothesis::complete;
    ScalarField<Dim> mask;      ///< chi in the frame of the template; empty: known everywhere
    double hidden_share = 0.0;  ///< share of the template's area (volume) that lies where chi = 0
    double penalty = 0.0;       ///< squared distance that an estimated mask costs
    double mismatch = 0.0;      ///< of the alignment
};

/// Distance of the visible part of a query from a template.
struct PartialDistance {
    /// sqrt((path energy + what the mismatch weighs) / (visible share of the template)^1.5); with the correction "none"
    /// the path length.
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
    /// @param mirror     compare the mirror image of the query as well
    /// @param normalize  datasets::NormalizeOptions::mode: "each" leaves the size of a partly hidden query open
    /// @param estimate   with no mask known, look for missing and added parts
    PartialMatcher(std::shared_ptr<const ComparedShape<Dim>> query, const ClassifyOptions& options,
                   const std::string& normalize, const std::string& align, bool estimate, bool mirror = false);

    [[nodiscard]] const ComparedShape<Dim>& query() const { return *query_; }

    /// The query as a start sees it: itself or its mirror image.
    [[nodiscard]] const LevelSet<Dim>& level_set(const PartialStart<Dim>& start) const {
        return start.mirrored ? mirrored_->level_set : query_->level_set;
    }

    /// A way to lay the query on a template, found on a coarse lattice.
    struct Guess {
        std::size_t view = 0;  ///< which hypothesis, and whether mirrored
        PartialStart<Dim> start;
        double score = 0.0;  ///< distance if nothing could be deformed: from the mismatch alone
    };
    /// Guesses for one template, best first, at most twice ClassifyOptions::alignments.
    [[nodiscard]] std::vector<Guess> guesses(const ComparedShape<Dim>& whole) const;

    /// Starts that are worth a coarse geodesic, from some guesses.
    [[nodiscard]] std::vector<PartialStart<Dim>> starts(const ComparedShape<Dim>& whole,
                                                        const std::vector<Guess>& guesses) const;
    [[nodiscard]] std::vector<PartialStart<Dim>> starts(const ComparedShape<Dim>& whole) const {
        return starts(whole, guesses(whole));
    }

    /// Solves the geodesic from the query to the template.
    /// @param path  receives the path in the frame of the template, unless null
    [[nodiscard]] PartialDistance measure(const ComparedShape<Dim>& whole, const PartialStart<Dim>& start,
                                          const GeodesicOptions& options, const std::function<bool()>& stop,
                                          GeodesicResult<Dim>* path = nullptr) const;

private:
    /// The query under one hypothesis on what is hidden.
    struct View {
        Hypothesis hypothesis;
        bool mirrored;
        ScalarField<Dim> mask;  ///< in the frame of the query or its mirror image; empty: none, or to be grown
        std::shared_ptr<const PartialAligner<Dim>> aligner;
    };
    /// The same contour, whatever is known to be hidden: nothing but the template itself.
    bool is_identical(const ComparedShape<Dim>& whole) const;
    void add_views(const ComparedShape<Dim>& shape, bool mirrored, bool estimate);
    PartialAlignmentOptions alignment_options(const View& view, const ComparedShape<Dim>& whole) const;
    PartialStart<Dim> start_of(const View& view, const PartialAlignmentCandidate<Dim>& candidate,
                               const ComparedShape<Dim>& whole, const LevelSet<Dim>& template_here) const;

    std::shared_ptr<const ComparedShape<Dim>> query_, mirrored_;
    ClassifyOptions options_;
    bool free_size_;
    std::string align_;
    std::vector<View> views_;
};

/// The shape x -> (1 - x, y, ...) with its mask.
template <int Dim>
[[nodiscard]] ComparedShape<Dim> mirror_image(const ComparedShape<Dim>& shape);

/// Masks of what may have been cut off along straight lines: the half planes beyond those lines that touch the shape
/// along much of their length and do not cross it. The longest contact first, at most `count`. In space none.
template <int Dim>
[[nodiscard]] std::vector<ScalarField<Dim>> cut_off_masks(const LevelSet<Dim>& visible, std::size_t count);

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

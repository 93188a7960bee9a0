#pragma once

#include <memory>
#include <vector>

#include "geodesic/solver/rigid_motion.h"

namespace morphodesic {

/// x -> R scale (x - c) + c + t with c = (1/2, ..., 1/2): a rigid motion after a change of size about the centre of the
/// cube. No reflections.
template <int Dim>
struct Similarity {
    RigidMotion<Dim> motion;
    double scale = 1.0;  ///< > 0

    [[nodiscard]] Point<Dim> operator()(const Point<Dim>& x) const {
        Point<Dim> y{};
        for (int a = 0; a < Dim; ++a) y[a] = 0.5 + scale * (x[a] - 0.5);
        return motion(y);
    }
    /// The point that is mapped to y.
    [[nodiscard]] Point<Dim> back(const Point<Dim>& y) const {
        Point<Dim> x = motion.inverse()(y);
        for (int a = 0; a < Dim; ++a) x[a] = 0.5 + (x[a] - 0.5) / scale;
        return x;
    }
};

struct PartialAlignmentOptions {
    bool move = true;            ///< false: the identity is the only candidate (its mismatch is still measured)
    bool rotate = true;          ///< false: translations only
    double least_scale = 1.0;    ///< range of sizes that are tried; both 1: the size is kept
    double largest_scale = 1.0;  ///< >= least_scale > 0
    /// Weights of the two kinds of mismatch: where only the whole shape is, and where only the partial shape is. Both
    /// 1: the partial shape is known wherever the mask says so. Small ones are robust against parts nobody has masked.
    double missing_weight = 1.0, added_weight = 1.0;
    int count = 2;  ///< at most so many candidates, >= 1
};

template <int Dim>
struct PartialAlignmentCandidate {
    Similarity<Dim> motion;  ///< from the frame of the partial shape to that of the whole one
    double mismatch = 0.0;  ///< weighted int chi (H(partial) - H(whole o motion))^2, in units of the whole shape's cube
};

/// A whole shape as PartialAligner needs it: what depends on it alone is computed once for many alignments.
template <int Dim>
class AlignmentTarget {
public:
    /// @throws std::invalid_argument if the shape is empty on the grid
    explicit AlignmentTarget(const LevelSet<Dim>& whole);
    ~AlignmentTarget();
    AlignmentTarget(AlignmentTarget&&) noexcept;

    struct Impl;
    [[nodiscard]] const Impl& impl() const { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
};

/// Aligns a shape of which only a part is known with whole shapes. The centroid of what is left is of no use, so
/// candidates come from the visible contour: each pair of a visible contour point and a contour point of the whole
/// shape gives the motion that lays point on point and normal on normal; those with the least mismatch of the visible
/// region are refined by Levenberg-Marquardt. Everything that depends on the partial shape alone is computed once.
template <int Dim>
class PartialAligner {
public:
    /// @param partial  level set of what is visible; at the rim of the mask it may end anywhere
    /// @param mask     chi in [0,1], 0 where nothing is known; continued beyond the cube by its border; empty: known
    /// all
    ///                 over
    /// @throws std::invalid_argument if the partial shape is empty or nothing of its contour is visible
    PartialAligner(const LevelSet<Dim>& partial, const ScalarField<Dim>& mask);
    ~PartialAligner();
    PartialAligner(PartialAligner&&) noexcept;

    /// Candidates for one whole shape, least mismatch first, different from each other: search, then refine.
    [[nodiscard]] std::vector<PartialAlignmentCandidate<Dim>> align(const LevelSet<Dim>& whole,
                                                                    const PartialAlignmentOptions& options) const;

    /// The same on a coarse lattice, for a small part of the cost: which motions are worth refining, and about how
    /// large the mismatch is.
    [[nodiscard]] std::vector<PartialAlignmentCandidate<Dim>> search(const AlignmentTarget<Dim>& whole,
                                                                     const PartialAlignmentOptions& options) const;

    /// Candidates of a search, brought to the least mismatch on the fine lattice.
    [[nodiscard]] std::vector<PartialAlignmentCandidate<Dim>> refine(
        const AlignmentTarget<Dim>& whole, const std::vector<PartialAlignmentCandidate<Dim>>& candidates,
        const PartialAlignmentOptions& options) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// A level set carried along by a similarity, sampled on a grid; distances grow with the size. Beyond its cube u goes
/// on as a distance. A field that is not moved and keeps its nodes keeps its values exactly.
template <int Dim>
[[nodiscard]] LevelSet<Dim> carried(const LevelSet<Dim>& u, const Similarity<Dim>& motion, int level);

/// An occlusion mask carried along; beyond its cube it goes on with the values of its border.
template <int Dim>
[[nodiscard]] ScalarField<Dim> carried_mask(const ScalarField<Dim>& mask, const Similarity<Dim>& motion, int level);

}  // namespace morphodesic

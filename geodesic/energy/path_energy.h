#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "geodesic/grid/fields.h"
#include "geodesic/kernels/step_kernel.h"
#include "geodesic/solver/geodesic_options.h"

namespace morphodesic {

/// Where the unknowns of a discrete path lie in one vector: phi_1 .. phi_K (Dim displacement components each), then
/// u_1 .. u_{K-1}; every field is [N] in the order of DyadicGrid.
template <int Dim>
struct PathLayout {
    DyadicGrid<Dim> grid;
    int time_steps = 1;

    [[nodiscard]] std::size_t nodes() const { return grid.node_count(); }
    [[nodiscard]] int field_count() const { return Dim * time_steps + time_steps - 1; }
    [[nodiscard]] std::size_t size() const { return nodes() * static_cast<std::size_t>(field_count()); }
    /// Component a of phi_k - id, k = 1..K.
    [[nodiscard]] std::size_t displacement(int k, int a) const {
        return nodes() * static_cast<std::size_t>(Dim * (k - 1) + a);
    }
    /// All components of phi_k - id in a vector of this layout, k = 1..K.
    template <class T>
    [[nodiscard]] std::array<T*, Dim> displacements(T* x, int k) const {
        std::array<T*, Dim> w;
        for (int a = 0; a < Dim; ++a) w[static_cast<std::size_t>(a)] = x + displacement(k, a);
        return w;
    }
    /// u_k, k = 1..K-1.
    [[nodiscard]] std::size_t level_set(int k) const {
        return nodes() * static_cast<std::size_t>(Dim * time_steps + k - 1);
    }
};

/// The parts of (14) at one path.
struct PathTerms {
    double total = 0.0;                ///< E of (14); +infinity where a deformation folds
    std::vector<double> deformation;   ///< E_deform,k, k = 1..K, without the factor K
    std::vector<double> mismatch;      ///< E_match,k, k = 1..K, without eta
    double area = 0.0;                 ///< sum over k = 1..K of E_area[u_k], without nu / K
    double barrier = 0.0;              ///< barrier against folds, with its factor (see kernels::StepSums)
    double min_det = 0.0;              ///< least det D phi at quadrature points and cell corners
    std::vector<double> step_min_det;  ///< the same for each phi_k

    [[nodiscard]] double path_length() const;  ///< sum_k sqrt(E_deform,k)
    [[nodiscard]] double path_energy() const;  ///< K sum_k E_deform,k
};

/// The energy (14) of discrete paths between two fixed shapes on one grid, with its gradient.
template <int Dim>
class PathEnergy {
public:
    /// @param first, last  u_0 and u_K on the same grid
    /// @param mask         occlusion mask chi of the mismatch of step 1, on the same grid; empty: chi = 1
    /// @throws std::invalid_argument if the grids differ
    PathEnergy(const LevelSet<Dim>& first, const LevelSet<Dim>& last, int time_steps, const GeodesicOptions& options,
               const ScalarField<Dim>& mask = {});

    [[nodiscard]] const PathLayout<Dim>& layout() const { return layout_; }
    [[nodiscard]] const LevelSet<Dim>& first() const { return first_; }
    [[nodiscard]] const LevelSet<Dim>& last() const { return last_; }
    [[nodiscard]] double eta() const { return eta_; }
    /// Width of the diffuse contour, eps = rim_width h.
    [[nodiscard]] double eps() const { return options_.rim_width * layout_.grid.spacing(); }
    /// Points at which the integrals are taken; the narrower the rim, the more of them.
    [[nodiscard]] kernels::Quadrature quadrature() const {
        return options_.rim_width < 1.0 ? kernels::Quadrature::many : kernels::Quadrature::few;
    }
    [[nodiscard]] const GeodesicOptions& options() const { return options_; }

    /// u_k of a path, k = 0..K.
    [[nodiscard]] const double* level_set(std::span<const double> x, int k) const;

    /// Deformations with a det D phi below this at a quadrature point or cell corner count as folded.
    static constexpr double least_det = 0.002;
    /// The same in single precision, whose rounding (of displacements, times 1 / h) must not let pass what folds in
    /// double precision.
    static constexpr double least_det_single = 1.01 * least_det;
    /// Stiffness of squeezed cells (det < barrier_onset) at their corners, beside 1 inside and delta outside.
    static constexpr double barrier_weight = 0.1;

    /// E of (14) at the path x (see PathLayout); its gradient goes to `gradient` unless that is empty, with zeros for
    /// the displacements on the boundary of the cube. The bits do not depend on the number of threads.
    PathTerms evaluate(std::span<const double> x, std::span<double> gradient);

    /// The same in single precision (relative errors of E and its gradient about 1e-6) in half of the time.
    PathTerms evaluate_single(std::span<const double> x, std::span<float> gradient);

private:
    struct Slab {
        int begin, end;     // cells on the last axis
        int first_row = 0;  // of the gradient in u_k it reaches
        kernels::StepSums sums;
    };
    /// What evaluation in one precision needs, [K][slabs]: gradients in u_k from first_row on.
    template <class T>
    using Scatter = std::vector<std::vector<std::vector<T>>>;
    /// The fields of a path in one precision, as for level_set().
    template <class T>
    struct Fields {
        const T *x, *first, *last, *mask;
    };

    template <class T>
    PathTerms evaluate_as(const Fields<T>& fields, std::span<const double> x, std::span<T> gradient,
                          Scatter<T>& scatter);
    template <class T>
    void evaluate_slab(int k, Slab& slab, bool shares_rows, const Fields<T>& fields, std::span<T> gradient,
                       std::vector<T>& scatter);
    PathTerms collect(double least) const;

    PathLayout<Dim> layout_;
    GeodesicOptions options_;
    LevelSet<Dim> first_, last_;
    ScalarField<Dim> mask_;
    double eta_;
    double last_area_ = 0.0;                // E_area[u_K], if it counts
    std::vector<std::vector<Slab>> slabs_;  // [K][slabs]
    Scatter<double> scatter_;
    Scatter<float> single_scatter_;
    std::vector<float> single_x_, single_first_, single_last_, single_mask_;
};

}  // namespace morphodesic

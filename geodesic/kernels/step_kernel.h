#pragma once

#include "geodesic/kernels/quadrature.h"

namespace morphodesic::kernels {

/// The most lanes of a vector of floats.
inline constexpr int single_lanes = 16;

/// Fields of one time step k on a grid of so many cells per axis; [nodes] each, axis 0 fastest. T is double, or float
/// for the minimiser: twice the lanes, half the memory.
template <int Dim, class T>
struct StepFields {
    int cells[Dim];              ///< on axis 0 a multiple of 8, with float of single_lanes
    const T* displacement[Dim];  ///< phi_k - id, one array per component
    const T* u_previous;         ///< u_{k-1}
    const T* u_next;             ///< u_k
    const T* mask;               ///< chi in [0,1], or null for chi = 1
    /// Rows of u_k along the last axis that deformed points of the cells asked for may lie between, both included; at
    /// least 4. Only these are read, and written in the gradient.
    int u_next_first_row, u_next_last_row;
};

/// Gradients are added to these arrays (same layout); a null pointer means: not wanted.
/// u_next holds the rows u_next_first_row to u_next_last_row only (the kernel scatters into it).
template <int Dim, class T>
struct StepGradients {
    T* displacement[Dim];
    T* u_previous;
    T* u_next;
};

struct StepWeights {
    int level;              ///< L: cells have the width 2^-L
    double lambda, mu;      ///< W, see stored_energy_density.h
    double delta;           ///< stiffness of the background in (13)
    double eps;             ///< width of H_eps
    double deformation;     ///< factor of E_deform in the gradients (K in (14))
    double mismatch;        ///< factor of E_match in the gradients (eta in (14))
    double barrier;         ///< factor of the barrier against folds, see StepSums::barrier
    Quadrature quadrature;  ///< points of a cell
};

constexpr double barrier_onset = 0.25;

struct StepSums {
    double deformation = 0.0;  ///< E_deform of the rows, without its factor
    double mismatch = 0.0;     ///< E_match of the rows, without its factor
    /// int b(det D phi) dx by the corners of the cells, b(s) = -log(s / s0) + s / s0 - 1 for s < s0 = barrier_onset,
    /// else 0. It keeps the corners of squeezed background cells away from folding, which the quadrature points of (13)
    /// do not see. Already multiplied by its factor.
    double barrier = 0.0;
    double min_det = 1e300;  ///< least det D phi at the quadrature points and cell corners; <= 0: inadmissible
};

/// E_deform (13) and E_match (12) of one time step over the cells whose index on the last axis lies in
/// [row_begin, row_end), and their gradients in phi_k, u_{k-1} and u_k. u_k o phi_k is evaluated exactly at the
/// quadrature points. SIMD over the cells along axis 0; the sums have a fixed order, so the bits depend on the
/// instruction set only. Where min_det <= 0 energies and gradients are meaningless.
template <int Dim, class T>
StepSums step_energy_rows(int row_begin, int row_end, const StepFields<Dim, T>& fields, const StepWeights& weights,
                          const StepGradients<Dim, T>& gradients);

/// The instruction set the kernels run on, e.g. "AVX3" or "AVX2".
const char* instruction_set();

}  // namespace morphodesic::kernels

#pragma once

#include <string>
#include <vector>

namespace morphodesic {

/// Everything that changes the result of a geodesic computation. One list of fields feeds command line, hash, store and
/// report: add a parameter here and to for_each_field, nowhere else.
struct GeodesicOptions {
    int level = 6;                           ///< L, 3 <= L <= 10: grid with 2^L + 1 nodes per axis
    int time_steps = 8;                      ///< K >= 1, a power of two: the path has K + 1 shapes
    double mismatch_weight_per_step = 25.0;  ///< eta = 25 K, > 0: with a fixed eta lengths do not converge in K
    double mismatch_weight = 0.0;            ///< fixed eta in (14), the paper's literal choice; 0: eta grows with K
    double lambda = 3.0;                     ///< Lame parameter lambda >= 0 of the dissipation (1)
    double mu = 1.0;                         ///< Lame parameter mu > 0
    double outside_stiffness = 1e-4;         ///< delta in (13), > 0
    double rim_width = 0.5;                  ///< eps / h in H_eps, > 0; the paper has 1, half of it halves the error
    double area_weight = 0.0;                ///< nu in (14), >= 0
    bool preserve_volume = false;            ///< shapes between keep the area (volume) interpolated between the ends
    double tolerance = 1e-3;                 ///< stop: relative decrease of the energy over five iterations, > 0
    int max_iterations = 400;                ///< per level, > 0
    std::string align = "rigid";             ///< rigid | translation | none
    int starts = 24;                         ///< alignments from which the search starts, >= 1
    int rounds = 1;                          ///< times a path in 2D that is stuck is loosened and settled anew, >= 0

    template <class Self, class Visitor>
    static void for_each_field(Self& self, Visitor&& visit) {
        visit("level", self.level, "grid level L: 2^L + 1 nodes per axis");
        visit("steps", self.time_steps, "number K of time steps, a power of two");
        visit("mismatch-weight-per-step", self.mismatch_weight_per_step, "eta / K, weight of the mismatch energy");
        visit("mismatch-weight", self.mismatch_weight,
              "fixed eta as in the paper (200); 0: eta = K times the weight per step");
        visit("lambda", self.lambda, "resistance to change of volume in the dissipation (1)");
        visit("mu", self.mu, "resistance to change of length in the dissipation (1)");
        visit("outside-stiffness", self.outside_stiffness, "delta: stiffness of the background");
        visit("rim-width", self.rim_width, "width eps of the diffuse contour in units of the grid size (paper: 1)");
        visit("area-weight", self.area_weight, "nu: weight of the contour length (surface area) term");
        visit("preserve-volume", self.preserve_volume, "keep the area (volume) of the shapes between the two ends");
        visit("tolerance", self.tolerance, "stop when five iterations lower the energy by less than this share");
        visit("max-iterations", self.max_iterations, "limit on the iterations per level");
        visit("align", self.align, "motion removed before the solve: rigid, translation or none");
        visit("starts", self.starts, "alignments from which the search for the shortest path starts");
        visit("rounds", self.rounds,
              "times a path in 2D that does not settle soon is smoothed, loosened with a wide rim and settled anew");
    }
    /// Every violated constraint, in words; empty if the options are usable.
    [[nodiscard]] std::vector<std::string> problems() const;

    /// eta of (14) for K time steps.
    [[nodiscard]] double eta(int steps) const {
        return mismatch_weight > 0 ? mismatch_weight : mismatch_weight_per_step * steps;
    }
    friend bool operator==(const GeodesicOptions&, const GeodesicOptions&) = default;
};

/// Why a solve stopped.
enum class Termination {
    converged,   ///< the energy no longer decreases (tolerance)
    max_steps,   ///< iteration limit reached on the finest level; the distance is not trustworthy
    no_descent,  ///< the line search failed before convergence
    cancelled,   ///< the observer asked to stop
};
[[nodiscard]] const char* to_string(Termination termination);

}  // namespace morphodesic

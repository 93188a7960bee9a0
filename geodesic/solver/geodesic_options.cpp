#include "geodesic/solver/geodesic_options.h"

namespace morphodesic {

namespace {
constexpr double largest_weight = 1e9;
}

std::vector<std::string> GeodesicOptions::problems() const {
    std::vector<std::string> found;
    const auto require = [&](bool holds, const char* sentence) {
        if (!holds) found.emplace_back(sentence);
    };
    require(level >= 3 && level <= 10, "level must be between 3 and 10");
    require(time_steps >= 1 && time_steps <= 256 && (time_steps & (time_steps - 1)) == 0,
            "steps must be a power of two between 1 and 256");
    // Energies are computed in single precision: beyond these weights one term is all that is left of the others.
    require(mismatch_weight_per_step > 0 && mismatch_weight_per_step <= largest_weight,
            "mismatch-weight-per-step must be positive and at most 1e9");
    require(mismatch_weight >= 0 && mismatch_weight <= largest_weight, "mismatch-weight must lie in [0, 1e9]");
    require(lambda >= 0 && lambda <= largest_weight, "lambda must lie in [0, 1e9]");
    require(mu >= 1 / largest_weight && mu <= largest_weight, "mu must lie in [1e-9, 1e9]");
    require(outside_stiffness >= 1 / largest_weight && outside_stiffness <= 1,
            "outside-stiffness must lie in [1e-9, 1]");
    require(rim_width >= 0.25 && rim_width <= 4, "rim-width must lie in [0.25, 4]");
    require(area_weight >= 0 && area_weight <= largest_weight, "area-weight must lie in [0, 1e9]");
    require(tolerance > 0 && tolerance < 1, "tolerance must lie in (0, 1)");
    require(max_iterations > 0, "max-iterations must be positive");
    require(align == "rigid" || align == "translation" || align == "none", "align must be rigid, translation or none");
    require(starts >= 1, "starts must be at least 1");
    require(rounds >= 0, "rounds must not be negative");
    return found;
}

const char* to_string(Termination termination) {
    switch (termination) {
        case Termination::converged:
            return "converged";
        case Termination::max_steps:
            return "max_steps";
        case Termination::no_descent:
            return "no_descent";
        case Termination::cancelled:
            return "cancelled";
    }
    return "unknown";
}

}  // namespace morphodesic

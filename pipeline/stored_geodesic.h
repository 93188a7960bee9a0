#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "geodesic/discrete_geodesic.h"

namespace morphodesic::pipeline {

/// A solved pair, or the reason why there is no result. The path runs from the shape with digest a to the one with b.
struct StoredGeodesic {
    std::string a, b;           ///< content digests
    std::string settings_hash;  ///< of the geodesic settings
    std::string failure;        ///< what the solver threw; empty if it returned a result
    Termination termination = Termination::converged;
    std::string message;
    double path_length = 0.0, path_energy = 0.0, total_energy = 0.0, error = 0.0, extrapolated_length = 0.0;
    double min_det = 0.0;
    double seconds = 0.0;
    std::vector<double> deformation_energy, mismatch_energy;  ///< per step
    std::vector<LevelReport> levels;
    std::vector<double> rotation, translation;  ///< the motion applied to a: row-major matrix, vector

    /// Why the path length must not be used as a distance; empty if it may.
    [[nodiscard]] std::string problem() const;
};

/// The numbers of a row, in the order of its columns and of its checksum.
inline constexpr std::array<double StoredGeodesic::*, 7> row_numbers{
    &StoredGeodesic::path_length, &StoredGeodesic::path_energy,         &StoredGeodesic::total_energy,
    &StoredGeodesic::error,       &StoredGeodesic::extrapolated_length, &StoredGeodesic::min_det,
    &StoredGeodesic::seconds};

/// The row of the same path walked back: from b to a, steps in reverse order, the motion that of b onto a.
[[nodiscard]] StoredGeodesic reversed(StoredGeodesic geodesic);

/// The row of a solver result.
template <int Dim>
[[nodiscard]] StoredGeodesic to_record(const GeodesicResult<Dim>& result, std::string a, std::string b,
                                       std::string settings_hash);

/// A row as one line of JSON with a checksum over all of it, and back; nothing if the line is damaged.
[[nodiscard]] std::string line_of(const StoredGeodesic& geodesic);
[[nodiscard]] std::optional<StoredGeodesic> geodesic_from_line(const std::string& line);

/// The parts of a row in the table of the store: what has no column of its own as JSON, the outcome by its name, and a
/// checksum over every column.
[[nodiscard]] std::string details_of(const StoredGeodesic& geodesic);
void read_details(const std::string& details, StoredGeodesic& geodesic);
[[nodiscard]] Termination termination_from(std::string_view name);
[[nodiscard]] std::string row_checksum(const StoredGeodesic& geodesic, const std::string& details);

}  // namespace morphodesic::pipeline

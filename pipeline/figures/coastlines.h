#pragma once

#include <vector>

#include "pipeline/figures/sphere_geodesic.h"

namespace morphodesic::pipeline {

/// One closed coast, land inside; the last point is joined to the first. Longitudes go beyond 180 degrees where a coast
/// crosses that meridian.
using Coast = std::vector<GeographicPosition>;

/// Continents and larger islands, placed by hand to about a degree: enough to know where one is on a globe, no map to
/// measure on..
[[nodiscard]] const std::vector<Coast>& coastlines();

/// Waters inside the continents, wide enough to be seen on a globe.
[[nodiscard]] const std::vector<Coast>& inland_seas();

}  // namespace morphodesic::pipeline

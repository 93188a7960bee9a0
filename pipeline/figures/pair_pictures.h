#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "geodesic/discrete_geodesic.h"
#include "pipeline/figures/figure.h"

namespace morphodesic::pipeline {

/// One figure of a path: shapes, dissipation, level lines (3D: in a cut), the grid carried along by the deformation
/// (2D), energy and length per step; its table; 2D: an animation. Named "path".
template <int Dim>
[[nodiscard]] Figure path_figure_of(const GeodesicResult<Dim>& path);

/// Writes path.png, path.svg, path.csv and, in 2D, the animation path.webp into a folder that exists. (The solids of the
/// steps are written by write_path_solids.)
/// @return the names of the files
/// @throws StoreError if a file cannot be written
template <int Dim>
std::vector<std::string> write_pair_pictures(const std::filesystem::path& folder, const GeodesicResult<Dim>& path);

}  // namespace morphodesic::pipeline

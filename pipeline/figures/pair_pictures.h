#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "geodesic/discrete_geodesic.h"
#include "pipeline/figures/figure.h"
#include "pipeline/path_pictures.h"

namespace morphodesic::pipeline {

/// One figure of a path: shapes, dissipation, level lines, a grid carried along by the deformation (3D: both in a cut),
/// energy and length per step; with its table. Named "path".
/// @param view  where solids are looked at from; size and zoom are chosen here
template <int Dim>
[[nodiscard]] Figure path_figure_of(const GeodesicResult<Dim>& path, const SolidView& view = {});

/// Writes path.png, path.svg, path.csv and the animation path.webp into a folder that exists. (The solids of the steps
/// are written by write_path_solids.)
/// @return the names of the files
/// @throws StoreError if a file cannot be written
template <int Dim>
std::vector<std::string> write_pair_pictures(const std::filesystem::path& folder, const GeodesicResult<Dim>& path,
                                             const SolidView& view = {});

}  // namespace morphodesic::pipeline

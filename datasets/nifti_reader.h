#pragma once

#include <filesystem>

#include "datasets/volume.h"

namespace morphodesic::datasets {

/// Reads a NIfTI-1 or NIfTI-2 file (.nii, .nii.gz) of one volume of plain numbers, with its scaling. The place of the
/// voxels is the sform of the file, else its qform, else its spacings alone.
/// @throws ReadError
Volume read_nifti(const std::filesystem::path& file, double max_megabytes);

}  // namespace morphodesic::datasets

#pragma once

#include <filesystem>

#include "datasets/volume.h"

namespace morphodesic::datasets {

/// Reads a NRRD file (.nrrd, or .nhdr with the numbers in a file beside it) of one volume of plain numbers: raw, gzip
/// or text. Its axes are its space directions, else its spacings. Source: https://teem.sourceforge.net/nrrd/format.html
/// @throws ReadError
Volume read_nrrd(const std::filesystem::path& file, double max_megabytes);

/// Reads a MetaImage (.mha, or .mhd with the numbers in a file beside it) of one volume of plain numbers, raw, packed
/// (zlib) or text.
/// Source: https://itk.org/Wiki/ITK/MetaIO/Documentation
/// @throws ReadError
Volume read_metaimage(const std::filesystem::path& file, double max_megabytes);

}  // namespace morphodesic::datasets

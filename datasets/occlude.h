#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "datasets/folder_scan.h"
#include "datasets/import_options.h"
#include "datasets/outline.h"

namespace morphodesic::datasets {

/// How parts of shapes are hidden, to make queries for classification.
struct OcclusionOptions {
    double fraction = 0.3;            ///< share of the shape's area to hide, in (0, 1)
    std::string kind = "half-plane";  ///< half-plane | disk | stripe | limb
    std::uint64_t seed = 1;           ///< direction and place are random, but the same for the same file name and seed
    int per_shape = 1;                ///< queries made from every shape, >= 1
    bool largest_part = false;        ///< hide all of what is left but its largest part

    [[nodiscard]] std::vector<std::string> problems() const;  ///< every violated constraint; empty if usable
};

/// A picture of which a part is hidden.
struct OccludedPicture {
    Coverage visible;           ///< the object where it is not hidden
    Coverage hidden;            ///< 1 where the picture is hidden, object and background alike, else 0
    double hidden_share = 0.0;  ///< share of the object's area that is hidden
};

/// Hides a part of an object.
///   half-plane: everything beyond a line in a random direction; disk: a disk around a random point of the object;
///   stripe: a band in a random direction around a random point; limb: what can be reached within the object from one
///   of its tips in some distance, with a seam of background around it.
/// @throws std::invalid_argument if the options have problems or the object is empty
OccludedPicture occlude(const Coverage& object, const OcclusionOptions& options, std::uint64_t seed);

struct OcclusionSummary {
    int queries = 0;
    std::vector<ScanProblem> problems;  ///< shapes that could not be read
};

/// Makes queries from shapes: NAME.png (black on white), NAME.mask.png (white = hidden), truth.csv (file,label) and
/// parameters.csv (file, label, source, kind, hidden share) in a folder that is created if need be.
/// @throws ReadError   if the folder holds other shapes
/// @throws WriteError  if a file cannot be written
OcclusionSummary write_occluded(const std::vector<ShapeSource>& sources, const std::filesystem::path& folder,
                                const OcclusionOptions& options, const ImportOptions& import_options = {});

}  // namespace morphodesic::datasets

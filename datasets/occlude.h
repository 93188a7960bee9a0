#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "datasets/drawing.h"
#include "datasets/folder_scan.h"
#include "datasets/import_options.h"
#include "datasets/outline.h"
#include "datasets/triangle_mesh.h"

namespace morphodesic::datasets {

/// How parts of shapes are hidden, to make queries for classification.
struct OcclusionOptions {
    double fraction = 0.3;            ///< share of the shape's area to hide, in (0, 1)
    std::string kind = "half-plane";  ///< half-plane | disk | stripe | limb
    std::uint64_t seed = 1;           ///< direction and place are random, but the same for the same file name and seed
    int per_shape = 1;                ///< queries made from every shape, >= 1
    bool largest_part = false;        ///< hide all of what is left but its largest part
    /// half-plane: towards which side the hidden part lies, (x, y) with y up, for solids (x, y, z); empty: random
    std::vector<double> direction;

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
    int repeated = 0;  ///< queries that are not there, as they would be others over again
    std::vector<ScanProblem> problems;  ///< shapes that could not be read
};

/// Hides a part of a drawing and what lies around it, but nothing of its other parts.
/// @param part    numbers of the polygons that are hidden
/// @param margin  reach of the hidden region around them, in units of the square
OccludedPicture hide_polygons(const Drawing& drawing, const std::vector<std::size_t>& part, double margin, int side);

/// What is left of a closed surface where a part of its volume lies beyond a plane and is missing: open along the cut.
/// @param direction  normal of the plane, towards the missing part
/// @throws std::invalid_argument if the direction is zero or the mesh encloses nothing
TriangleMesh cut_by_plane(const TriangleMesh& closed_mesh, double fraction, const Vector3& direction);

/// Makes queries from drawings of datasets::matchstick of which one arm and one leg, on sides chosen at random, are
/// hidden: files as write_occluded writes them.
/// @throws ReadError, WriteError as there
void write_hidden_limbs(const std::vector<Drawing>& men, const std::filesystem::path& folder, int side,
                        std::uint64_t seed);

/// Makes queries from shapes: NAME.png (black on white), NAME.mask.png (white = hidden), truth.csv (file,label) and
/// parameters.csv (file, label, source, kind, hidden share) in a folder that is created if need be. From solids scans
/// are made that are cut off by a plane: NAME.ply, open where they are cut (half-plane only).
/// @throws ReadError   if the folder holds other shapes, or if the queries would lie among the sources
/// @throws WriteError  if a file cannot be written
OcclusionSummary write_occluded(const std::vector<ShapeSource>& sources, const std::filesystem::path& folder,
                                const OcclusionOptions& options, const ImportOptions& import_options = {});

}  // namespace morphodesic::datasets

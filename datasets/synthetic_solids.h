#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "datasets/synthetic.h"
#include "datasets/triangle_mesh.h"

/// Solids from formulas: smooth unions of round cones, as closed meshes in millimetres. The same options always give
/// the same solids.
namespace morphodesic::datasets {

struct GeneratedSolid {
    std::string name;                                             ///< file name without ending
    std::string label;                                            ///< class label
    std::vector<std::pair<std::string, std::string>> parameters;  ///< what it was made from: (name, value)
    TriangleMesh mesh;
};

struct FeetOptions : CollectionOptions {
    bool equal_volume = false;  ///< all feet are scaled to the volume of the mean foot
    FeetOptions() { count = 8; }
};

/// Left feet that differ in length, width, arch, instep and toes; x runs from heel to toes, z up, the big toe is on the
/// side of negative y. Classes by the arch: flat, normal, high. The last one (if there are at least three) is an
/// outlier, short, broad and high, of class outlier.
std::vector<GeneratedSolid> feet(const FeetOptions& options);

/// Cats and lions in turn, in poses (standing, walking, looking round, tail up); x runs from tail to head, z up. Lions
/// are larger and have a mane, a tuft and round ears.
std::vector<GeneratedSolid> quadrupeds(const CollectionOptions& options);

/// Writes a binary PLY file of each solid, labels.csv (file,label) and parameters.csv into a folder, which is created
/// if need be.
/// @throws ReadError   if the folder holds other shapes, which would get into the collection
/// @throws WriteError  if a file cannot be written
void write_collection(const std::filesystem::path& folder, const std::vector<GeneratedSolid>& solids);

/// How badly a scan is damaged: it sees the surface in points twice as dense as the mesh, with noise, and is then
/// decimated.
struct DamageOptions {
    double holes = 0.05;   ///< share of the area that is missing, in five holes
    double noise = 0.005;  ///< standard deviation of the points' error, as a share of the bounding box's diagonal
    double turned = 0.1;   ///< share of the area whose triangles are inside out, in four patches
    double kept = 0.5;     ///< share of the scan's points that decimation leaves, about; 1: all
    std::uint64_t seed = 1;
};
/// A bad scan of a closed mesh.
TriangleMesh damaged(const TriangleMesh& mesh, const DamageOptions& options);

}  // namespace morphodesic::datasets

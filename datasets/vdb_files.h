#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "datasets/triangle_mesh.h"
#include "geodesic/grid/fields.h"

namespace morphodesic::datasets {

/// True if the name ends in .vdb, in letters of any size.
bool is_vdb(const std::filesystem::path& file);

/// Closed surface of the first level set of a .vdb file, else of its first grid of numbers: level sets at 0, other
/// volumes at the isovalue (inside above).
/// @param isovalue  a number, or "auto": 0 for a level set, 0.5 for other volumes
/// @throws ReadError
TriangleMesh read_vdb_surface(const std::filesystem::path& file, const std::string& isovalue, double max_megabytes,
                              std::vector<std::string>& notes);

/// A scalar field to go with a shape, by the name a viewer shows.
struct NamedField {
    std::string name;
    const ScalarField<3>* field;
};

/// Writes a level set (negative inside, as OpenVDB and its viewers have it, narrow band of four cells) and, in the band
/// and inside, more fields of the same grid size. Units of the cube.
/// @throws WriteError
void write_vdb(const std::filesystem::path& file, const LevelSet<3>& shape, const std::vector<NamedField>& fields = {});

/// Writes the surface of a level set as binary PLY, with the fields as properties of the points.
/// @throws WriteError
void write_ply(const std::filesystem::path& file, const LevelSet<3>& shape, const std::vector<NamedField>& fields = {});

/// Writes a mesh as binary PLY, without further properties.
/// @throws WriteError
void write_ply(const std::filesystem::path& file, const TriangleMesh& mesh);

/// Value of the Q1 function at a point of the cube (points beyond it count as its border).
double value_at(const ScalarField<3>& field, const Vector3& x);

}  // namespace morphodesic::datasets

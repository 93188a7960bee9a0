#pragma once

#include "datasets/import_options.h"
#include "datasets/raw_shape.h"
#include "datasets/triangle_mesh.h"

namespace morphodesic::datasets {

/// A solid bounded by a closed mesh in file units.
class SolidGeometry : public Geometry<3> {
public:
    explicit SolidGeometry(TriangleMesh closed_mesh) : mesh_(std::move(closed_mesh)) {}
    [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }
    [[nodiscard]] LevelSet<3> signed_distance(const DyadicGrid<3>& grid, const Placement<3>& placement) const override;

private:
    TriangleMesh mesh_;
};

/// Reads a mesh, point cloud or volume and makes a solid of it; read_shape<3> of the front door.
/// @throws ReadError if the file cannot be used; the message says why and what to do
RawShape<3> read_shape_3d(const ShapeSource& source, const ImportOptions& options = {});

}  // namespace morphodesic::datasets

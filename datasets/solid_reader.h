#pragma once

#include <vector>

#include "datasets/import_options.h"
#include "datasets/raw_shape.h"
#include "datasets/triangle_mesh.h"

namespace morphodesic::datasets {

/// A solid bounded by a closed mesh in file units.
class SolidGeometry : public Geometry<3> {
public:
    /// @param invented  triangles of the closed mesh, by number, that no scan has seen: beyond them all is unknown
    explicit SolidGeometry(TriangleMesh closed_mesh, std::vector<std::size_t> invented = {})
        : mesh_(std::move(closed_mesh)), invented_(std::move(invented)) {}
    [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }
    [[nodiscard]] LevelSet<3> signed_distance(const DyadicGrid<3>& grid, const Placement<3>& placement) const override;
    /// Unknown is what lies outside and is nearer to the invented surface than to the other one, or as near, and a seam
    /// within.
    [[nodiscard]] ScalarField<3> occlusion_mask(const DyadicGrid<3>& grid,
                                                const Placement<3>& placement) const override;

private:
    TriangleMesh mesh_;
    std::vector<std::size_t> invented_;
};

/// Reads a mesh, point cloud or volume and makes a solid of it; read_shape<3> of the front door. With border "hides"
/// what lies beyond the holes of an open mesh is unknown.
/// @throws ReadError if the file cannot be used; the message says why and what to do
RawShape<3> read_shape_3d(const ShapeSource& source, const ImportOptions& options = {});

/// A sentence on patterns of ImportOptions::mirror that no solid among the sources fits; empty if there are none. A
/// mistyped pattern would otherwise leave a solid as it is without a word.
[[nodiscard]] std::string mirror_remark(const std::string& mirror, const std::vector<ShapeSource>& sources);

}  // namespace morphodesic::datasets

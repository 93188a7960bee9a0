#include "datasets/voxelize.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/MeshToVolume.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "datasets/distance_transform.h"
#include "datasets/interruption.h"
#include "datasets/level_set_surface.h"
#include "datasets/triangle_tree.h"
#include "datasets/winding_number.h"

namespace morphodesic::datasets {
namespace {

/// Shows a mesh to OpenVDB, with the nodes of the lattice as its voxels.
class MeshOnLattice {
public:
    MeshOnLattice(const TriangleMesh& mesh, const Lattice& lattice) : mesh_(mesh), lattice_(lattice) {}
    [[nodiscard]] std::size_t polygonCount() const { return mesh_.triangles.size(); }
    [[nodiscard]] std::size_t pointCount() const { return mesh_.points.size(); }
    [[nodiscard]] std::size_t vertexCount(std::size_t) const { return 3; }
    void getIndexSpacePoint(std::size_t triangle, std::size_t corner, openvdb::Vec3d& position) const {
        const Vector3& p = mesh_.points[mesh_.triangles[triangle][corner]];
        for (int a = 0; a < 3; ++a) position[a] = (p[a] - lattice_.origin[a]) / lattice_.spacing;
    }

private:
    const TriangleMesh& mesh_;
    const Lattice& lattice_;
};

/// Has OpenVDB end early if reading is to be given up; what it then returns is of no use.
class Interrupter {
public:
    void start(const char* = nullptr) {}
    void end() {}
    [[nodiscard]] bool wasInterrupted(int = -1) const {
        try {
            interruption_point();
        } catch (const Interrupted&) {
            return true;
        }
        return false;
    }
};

openvdb::CoordBBox nodes_of(const Lattice& lattice) {
    return {openvdb::Coord(0), openvdb::Coord(lattice.nodes[0] - 1, lattice.nodes[1] - 1, lattice.nodes[2] - 1)};
}

}  // namespace

std::vector<float> distance_to_triangles(const TriangleMesh& mesh, const Lattice& lattice, double band) {
    const auto voxels = openvdb::math::Transform::createLinearTransform(1.0);
    Interrupter interruption;
    const auto grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(
        interruption, MeshOnLattice(mesh, lattice), *voxels, static_cast<float>(band), static_cast<float>(band),
        openvdb::tools::UNSIGNED_DISTANCE_FIELD);
    interruption_point();
    std::vector<float> distance(lattice.node_count());
    openvdb::tools::Dense<float, openvdb::tools::LayoutXYZ> dense(nodes_of(lattice), distance.data());
    openvdb::tools::copyToDense(*grid, dense);
    for (auto& d : distance) d = static_cast<float>(std::min<double>(std::abs(d), band) * lattice.spacing);
    return distance;
}

TriangleMesh isosurface(const Lattice& lattice, const std::vector<float>& values) {
    constexpr float band = 3.0F;
    std::vector<float> outward(values.size());  // OpenVDB counts level sets negative inside
    const float smallest = 1e-4F;               // a surface through a node would give triangles without area
    for (std::size_t i = 0; i < values.size(); ++i) {
        const auto v = static_cast<float>(-values[i] / lattice.spacing);
        outward[i] = v < 0 ? std::clamp(v, -band, -smallest) : std::clamp(v, smallest, band);
    }
    const openvdb::tools::Dense<float, openvdb::tools::LayoutXYZ> dense(nodes_of(lattice), outward.data());
    auto grid = openvdb::FloatGrid::create(band);
    openvdb::tools::copyFromDense(dense, *grid, 0.0F);
    TriangleMesh mesh = surface_of(*grid, 0.0);
    for (Vector3& p : mesh.points) p = lattice.origin + lattice.spacing * p;
    if (signed_volume(mesh) < 0) {
        turn_inside_out(mesh);
    }
    return mesh;
}

LevelSet<3> signed_distance(const TriangleMesh& mesh, const DyadicGrid<3>& grid) {
    const int n = grid.nodes_per_axis();
    const double h = grid.spacing(), band = 2.0;  // beyond it OpenVDB's distances are only bounds
    const Lattice lattice{{n, n, n}, {0.0, 0.0, 0.0}, h};
    const std::vector<float> near = distance_to_triangles(mesh, lattice, band);
    const std::vector<float> far = distance_to_points(lattice, surface_samples(mesh, 0.7 * h));  // never too small
    const TriangleTree tree(mesh);
    const auto winding = winding_numbers(mesh, lattice);
    LevelSet<3> u(grid);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, u.values.size(), 4096), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            interruption_point(i);
            double distance = far[i];
            if (near[i] < 1.5 * h) {
                distance = near[i];
            } else if (distance < 4.5 * h) {
                distance = tree.nearest(grid.position(grid.node(i)), 1.001 * distance).distance;
            }
            u.values[i] = winding[i] > 0 ? distance : -distance;
        }
    });
    return u;
}

}  // namespace morphodesic::datasets

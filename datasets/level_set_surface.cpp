#include "datasets/level_set_surface.h"

#include <openvdb/tools/VolumeToMesh.h>

namespace morphodesic::datasets {

TriangleMesh surface_of(const openvdb::FloatGrid& grid, double value) {
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec3I> triangles;
    std::vector<openvdb::Vec4I> quads;
    openvdb::tools::volumeToMesh(grid, points, triangles, quads, value, 0.0, false);

    TriangleMesh mesh;
    mesh.points.reserve(points.size());
    for (const auto& p : points) mesh.points.push_back({p[0], p[1], p[2]});
    const auto add = [&](unsigned a, unsigned b, unsigned c) {
        mesh.triangles.push_back({static_cast<int>(a), static_cast<int>(b), static_cast<int>(c)});
    };
    for (const auto& t : triangles) add(t[0], t[1], t[2]);
    for (const auto& q : quads) {
        if ((points[q[0]] - points[q[2]]).lengthSqr() <= (points[q[1]] - points[q[3]]).lengthSqr()) {
            add(q[0], q[1], q[2]), add(q[0], q[2], q[3]);
        } else {
            add(q[1], q[2], q[3]), add(q[1], q[3], q[0]);
        }
    }
    return mesh;
}

}  // namespace morphodesic::datasets

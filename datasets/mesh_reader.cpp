#include "datasets/mesh_reader.h"

#include <span>

#include "datasets/mesh_check.h"
#include "datasets/polygon.h"

namespace morphodesic::datasets {
namespace {

constexpr double far = 16.0;  // of the object's size: nearer, single precision takes no more than a millionth of it

/// Rounds to single precision, as most files have it: where neighbouring triangles name a point each with other last
/// digits, it becomes one point. Far from the origin that would be coarser than the object: there what is rounded is
/// the offset from its middle.
void round_coordinates(std::vector<Vector3>& points) {
    const Box3 box = bounding_box(points);
    const Vector3 centre = box.low + 0.5 * box.side();
    const Vector3 origin = norm(centre) > far * box.diagonal() ? centre : Vector3{};
    for (auto& p : points) {
        for (int a = 0; a < 3; ++a) p[a] = origin[a] + static_cast<double>(static_cast<float>(p[a] - origin[a]));
    }
}

}  // namespace

MeshFile read_mesh(const std::filesystem::path& file, double max_megabytes) {
    CheckedMesh checked = check_mesh(file, file_content(file, max_megabytes));
    MeshFile result;
    result.notes = std::move(checked.notes);
    result.mesh.points = std::move(checked.points);
    if (checked.face_sizes.empty()) return result;
    round_coordinates(result.mesh.points);
    result.mesh.triangles.reserve(checked.corners.size() - 2 * checked.face_sizes.size());
    std::span<const int> rest = checked.corners;
    for (const int size : checked.face_sizes) {
        cut_polygon(result.mesh.points, rest.first(static_cast<std::size_t>(size)), result.mesh.triangles);
        rest = rest.subspan(static_cast<std::size_t>(size));
    }
    return result;
}

}  // namespace morphodesic::datasets

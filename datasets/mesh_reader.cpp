#include "datasets/mesh_reader.h"

#include <assimp/MemoryIOWrapper.h>
#include <assimp/mesh.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <cstdint>
#include <span>
#include <string>

#include "datasets/bytes.h"
#include "datasets/interruption.h"
#include "datasets/mesh_check.h"
#include "datasets/polygon.h"
#include "datasets/read_error.h"

namespace morphodesic::datasets {
namespace {

constexpr double far = 16.0;  // of the object's size: nearer, single precision takes no more than a millionth of it

/// Where the parser's coordinates count from. It has single precision, which far from the origin would be coarser than
/// the object: there they are offsets from its middle.
Vector3 origin_for(const std::vector<Vector3>& points) {
    const Box3 box = bounding_box(points);
    const Vector3 centre = box.low + 0.5 * box.side();
    return norm(centre) > far * box.diagonal() ? centre : Vector3{};
}

/// The file that the parser sees: it is read piece by piece, and may be given up between them.
class InterruptibleStream : public Assimp::MemoryIOStream {
public:
    using MemoryIOStream::MemoryIOStream;
    size_t Read(void* to, size_t size, size_t count) override {
        interruption_point();
        return MemoryIOStream::Read(to, size, count);
    }
};
class InterruptibleFile : public Assimp::MemoryIOSystem {
public:
    explicit InterruptibleFile(const std::string& content)
        : MemoryIOSystem(bytes_of(content), content.size(), nullptr), content_(content) {}
    Assimp::IOStream* Open(const char* file, const char*) override {
        return Exists(file) ? new InterruptibleStream(bytes_of(content_), content_.size()) : nullptr;
    }
    void Close(Assimp::IOStream* stream) override { delete stream; }

private:
    static const std::uint8_t* bytes_of(const std::string& content) {
        return reinterpret_cast<const std::uint8_t*>(content.data());
    }
    const std::string& content_;
};

/// What was checked as a file that the parser can be let loose on: binary PLY, nothing in it but points and faces. In
/// front of the points stands one more: the parser skips blanks and line ends behind the header, and a coordinate may
/// begin with such a byte.
std::string plain_file(const CheckedMesh& mesh, const Vector3& origin) {
    std::string file = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                       std::to_string(mesh.points.size() + 1) +
                       "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                       std::to_string(mesh.face_sizes.size()) + "\nproperty list int int vertex_indices\nend_header\n";
    file.reserve(file.size() + 12 * mesh.points.size() + 4 * (mesh.face_sizes.size() + mesh.corners.size()));
    for (int a = 0; a < 3; ++a) put(file, 1.0F);
    for (const Vector3& p : mesh.points) {
        for (int a = 0; a < 3; ++a) put(file, static_cast<float>(p[a] - origin[a]));
    }
    std::span<const int> rest = mesh.corners;
    for (const int size : mesh.face_sizes) {
        put(file, static_cast<std::int32_t>(size));
        for (const int corner : rest.first(static_cast<std::size_t>(size)))
            put(file, static_cast<std::int32_t>(corner + 1));
        rest = rest.subspan(static_cast<std::size_t>(size));
    }
    return file;
}

}  // namespace

MeshFile read_mesh(const std::filesystem::path& file, double max_megabytes) {
    CheckedMesh checked = check_mesh(file, file_content(file, max_megabytes));
    MeshFile result;
    result.notes = std::move(checked.notes);
    if (checked.face_sizes.empty()) {
        result.mesh.points = std::move(checked.points);
        return result;
    }
    const Vector3 origin = origin_for(checked.points);
    const std::string content = plain_file(checked, origin);
    const std::size_t face_count = checked.face_sizes.size();
    checked = {};
    Assimp::Importer importer;
    // The parser sees this one buffer and no other file.
    importer.SetIOHandler(new InterruptibleFile(content));
    const aiScene* scene = importer.ReadFile(AI_MEMORYIO_MAGIC_FILENAME ".ply", 0);
    interruption_point();
    if (scene == nullptr || (scene->mFlags & AI_SCENE_FLAGS_INCOMPLETE) != 0) {
        throw ReadError(file, std::string("it cannot be parsed (") + importer.GetErrorString() + ")",
                        "export or download the file again");
    }
    std::size_t faces = 0;
    std::vector<int> corners;
    for (const aiMesh* part : std::span(scene->mMeshes, scene->mNumMeshes)) {
        const auto points = std::span(part->mVertices, part->mNumVertices);
        const auto first = static_cast<int>(result.mesh.points.size());
        if (points.empty()) continue;
        for (const aiVector3D& p : points.subspan(1)) result.mesh.points.push_back(Vector3{p.x, p.y, p.z} + origin);
        for (const aiFace& face : std::span(part->mFaces, part->mNumFaces)) {
            corners.assign(face.mIndices, face.mIndices + face.mNumIndices);
            for (int& corner : corners) corner += first - 1;
            interruption_point(faces);
            cut_polygon(result.mesh.points, corners, result.mesh.triangles);
            ++faces;
        }
    }
    if (faces != face_count) {
        throw ReadError(
            file, "only " + std::to_string(faces) + " of " + std::to_string(face_count) + " faces could be parsed",
            "cut the faces into triangles, then save it again");
    }
    return result;
}

}  // namespace morphodesic::datasets

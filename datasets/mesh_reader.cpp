#include "datasets/mesh_reader.h"

#include <assimp/MemoryIOWrapper.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <cmath>

#include "datasets/mesh_check.h"
#include "datasets/read_error.h"

namespace morphodesic::datasets {
namespace {

const char* file_name_for(MeshFormat format) {  // only its ending means something to the parser
    switch (format) {
        case MeshFormat::obj:
            return AI_MEMORYIO_MAGIC_FILENAME ".obj";
        case MeshFormat::ply:
            return AI_MEMORYIO_MAGIC_FILENAME ".ply";
        case MeshFormat::stl:
            return AI_MEMORYIO_MAGIC_FILENAME ".stl";
        case MeshFormat::off:
            return AI_MEMORYIO_MAGIC_FILENAME ".off";
    }
    return "";
}

}  // namespace

MeshFile read_mesh(const std::filesystem::path& file, double max_megabytes) {
    CheckedMesh checked = check_mesh(file, file_content(file, max_megabytes));
    MeshFile result;
    result.notes = std::move(checked.notes);
    if (checked.face_count == 0) {
        result.mesh.points = std::move(checked.points);
        return result;
    }
    Assimp::Importer importer;
    // The parser sees this one buffer and no other file, whatever the content names.
    importer.SetIOHandler(new Assimp::MemoryIOSystem(reinterpret_cast<const std::uint8_t*>(checked.content.data()),
                                                     checked.content.size(), nullptr));
    const aiScene* scene = importer.ReadFile(file_name_for(checked.format), aiProcess_Triangulate);
    if (scene == nullptr || (scene->mFlags & AI_SCENE_FLAGS_INCOMPLETE) != 0) {
        throw ReadError(file, std::string("it cannot be parsed (") + importer.GetErrorString() + ")",
                        "export or download the file again");
    }
    for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
        const aiMesh& part = *scene->mMeshes[m];
        const auto first = static_cast<int>(result.mesh.points.size());
        for (unsigned v = 0; v < part.mNumVertices; ++v) {
            const aiVector3D& p = part.mVertices[v];
            result.mesh.points.push_back({p.x, p.y, p.z});
        }
        for (unsigned f = 0; f < part.mNumFaces; ++f) {
            const aiFace& face = part.mFaces[f];
            if (face.mNumIndices != 3) continue;  // points and lines
            result.mesh.triangles.push_back({first + static_cast<int>(face.mIndices[0]),
                                             first + static_cast<int>(face.mIndices[1]),
                                             first + static_cast<int>(face.mIndices[2])});
        }
    }
    if (result.mesh.triangles.size() < checked.face_count) {
        result.notes.push_back("Only " + std::to_string(result.mesh.triangles.size()) + " of " +
                               std::to_string(checked.face_count) + " faces could be cut into triangles.");
    }
    return result;
}

}  // namespace morphodesic::datasets

// OBJ, PLY, STL and OFF. The first byte chooses the ending of the file's name; the rest is the file.
#include <array>

#include "datasets/mesh_reader.h"
#include "datasets/read_error.h"
#include "tests/fuzz/scratch_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace morphodesic;
    if (size == 0) return 0;
    constexpr std::array endings{".obj", ".ply", ".stl", ".off"};
    const auto file = tests::scratch_file(data + 1, size - 1, endings[data[0] % endings.size()]);
    try {
        const datasets::MeshFile mesh = datasets::read_mesh(file, 1.0);
        for (const auto& triangle : mesh.mesh.triangles) {
            for (const int corner : triangle) {
                if (corner < 0 || static_cast<std::size_t>(corner) >= mesh.mesh.points.size()) std::abort();
            }
        }
    } catch (const datasets::ReadError&) {
        // The one way to refuse a file; anything else is a finding.
    }
    return 0;
}

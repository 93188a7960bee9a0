// NIfTI, NRRD, MetaImage and OpenVDB. The first byte chooses the ending of the file's name; the rest is the file.
#include <array>
#include <cmath>

#include "datasets/read_error.h"
#include "datasets/vdb_files.h"
#include "datasets/volume.h"
#include "tests/fuzz/scratch_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace morphodesic;
    if (size == 0) return 0;
    constexpr std::array endings{".nii", ".nii.gz", ".nrrd", ".nhdr", ".mhd", ".mha", ".vdb"};
    const auto file = tests::scratch_file(data + 1, size - 1, endings[data[0] % endings.size()]);
    constexpr double max_megabytes = 0.2;
    try {
        datasets::TriangleMesh mesh;
        if (datasets::is_vdb(file)) {
            // Values are read by a child process, whose coverage is not seen here; what guards it is.
            std::vector<std::string> notes;
            mesh = datasets::read_vdb_surface(file, "auto", max_megabytes, notes);
        } else {
            datasets::Volume volume = datasets::read_volume(file, max_megabytes);
            mesh = datasets::surface_of(file, volume, "auto", data[0] % 2 == 0 ? "above" : "below").mesh;
        }
        for (const auto& point : mesh.points) {
            for (const double x : point) {
                if (!std::isfinite(x)) std::abort();
            }
        }
    } catch (const datasets::ReadError&) {
        // The one way to refuse a file; anything else is a finding.
    }
    return 0;
}

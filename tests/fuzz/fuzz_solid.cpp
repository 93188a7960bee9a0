// From a small mesh file of any format to a closed solid: damaged surfaces are closed, mended or refused.
#include <array>
#include <cmath>

#include "datasets/import.h"
#include "tests/fuzz/scratch_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace morphodesic;
    if (size == 0) return 0;
    constexpr std::array endings{".obj", ".ply", ".stl", ".off", ".pcd", ".xyz"};
    datasets::ShapeSource source;
    source.path = tests::scratch_file(data + 1, size - 1, endings[data[0] % endings.size()]);
    source.name = source.path.filename();
    source.dimension = 3;
    datasets::ImportOptions options;
    options.max_megabytes = 0.02;
    try {
        const auto raw = datasets::read_shape<3>(source, options);
        if (!(raw.volume > 0) || !std::isfinite(raw.volume) || !(raw.extent_radius > 0)) std::abort();
    } catch (const datasets::ReadError&) {
        // The one way to refuse a file; anything else is a finding.
    }
    return 0;
}

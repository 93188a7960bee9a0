// PCD and XYZ. The first byte chooses the ending of the file's name; the rest is the file.
#include <cmath>

#include "datasets/point_cloud_reader.h"
#include "datasets/read_error.h"
#include "tests/fuzz/scratch_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace morphodesic;
    if (size == 0) return 0;
    const auto file = tests::scratch_file(data + 1, size - 1, data[0] % 2 == 0 ? ".pcd" : ".xyz");
    try {
        std::vector<std::string> notes;
        for (const auto& point : datasets::read_point_cloud(file, 1.0, notes)) {
            for (const double x : point) {
                if (!std::isfinite(x)) std::abort();
            }
        }
    } catch (const datasets::ReadError&) {
        // The one way to refuse a file; anything else is a finding.
    }
    return 0;
}

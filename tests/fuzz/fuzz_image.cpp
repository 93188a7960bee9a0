// Images of every format: the bytes tell the format, as in a real collection.
#include "datasets/import.h"
#include "tests/fuzz/scratch_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace morphodesic;
    datasets::ShapeSource source;
    source.path = tests::scratch_file(data, size, ".png");
    source.name = "input.png";
    datasets::ImportOptions options;
    options.max_megapixels = 0.02;  // large ones only take longer
    try {
        datasets::read_shape<2>(source, options);
    } catch (const datasets::ReadError&) {
        // The one way to refuse a file; anything else is a finding.
    }
    return 0;
}

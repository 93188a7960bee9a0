// labels.csv of a collection.
#include "datasets/folder_scan.h"
#include "datasets/read_error.h"
#include "tests/fuzz/scratch_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace morphodesic;
    try {
        datasets::read_labels(tests::scratch_file(data, size, ".csv"));
    } catch (const datasets::ReadError&) {
        // The one way to refuse a file; anything else is a finding.
    }
    return 0;
}

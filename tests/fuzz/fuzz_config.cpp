// TOML configuration files, and the settings that a store keeps as text.
#include <stdexcept>

#include "pipeline/cli.h"
#include "tests/fuzz/scratch_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace morphodesic;
    try {
        for (const pipeline::ConfigOption& option :
             pipeline::options_of_config(tests::scratch_file(data, size, ".toml"))) {
            if (option.name.empty() || option.token().rfind("--", 0) != 0) std::abort();
        }
    } catch (const std::invalid_argument&) {
        // The one way to refuse a file; anything else is a finding.
    }
    return 0;
}

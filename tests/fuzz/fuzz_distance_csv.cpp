// distances.csv: what is read without complaint is a distance matrix, and writing and reading it again changes nothing.
#include <sstream>
#include <string>

#include "analysis/matrix_csv.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace morphodesic;
    std::istringstream in(std::string(reinterpret_cast<const char*>(data), size));
    analysis::CsvReadOptions options;
    options.max_items = 100;
    try {
        const analysis::DistanceMatrix matrix = analysis::read_distance_csv(in, "input.csv", options);
        std::ostringstream first, second;
        analysis::write_distance_csv(first, matrix);
        std::istringstream again(first.str());
        analysis::write_distance_csv(second, analysis::read_distance_csv(again, "written.csv", options));
        if (first.str() != second.str()) std::abort();
    } catch (const analysis::ParseError& error) {
        if (std::string(error.what()).find("input.csv") == std::string::npos) std::abort();  // our own file was refused
    }
    return 0;
}

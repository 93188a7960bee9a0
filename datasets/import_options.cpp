#include "datasets/import_options.h"

#include <cmath>

namespace morphodesic::datasets {

std::vector<std::string> ImportOptions::problems() const {
    std::vector<std::string> result;
    if (foreground != "auto" && foreground != "dark" && foreground != "light" && foreground != "alpha") {
        result.push_back("foreground must be auto, dark, light or alpha, not \"" + foreground + "\"");
    }
    if (!(speck_fraction >= 0.0 && speck_fraction < 1.0)) result.push_back("speck-fraction must be in [0, 1)");
    if (!(max_megapixels > 0.0 && std::isfinite(max_megapixels))) result.push_back("max-megapixels must be positive");
    return result;
}

}  // namespace morphodesic::datasets

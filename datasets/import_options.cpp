#include "datasets/import_options.h"

#include <cmath>

#include "datasets/text_scan.h"

namespace morphodesic::datasets {

std::vector<std::string> ImportOptions::problems() const {
    std::vector<std::string> result;
    if (foreground != "auto" && foreground != "dark" && foreground != "light" && foreground != "alpha") {
        result.push_back("foreground must be auto, dark, light or alpha, not \"" + foreground + "\"");
    }
    if (!(speck_fraction >= 0.0 && speck_fraction < 1.0)) result.push_back("speck-fraction must be in [0, 1)");
    if (!(max_megapixels > 0.0 && std::isfinite(max_megapixels))) result.push_back("max-megapixels must be positive");
    if (!occluder.empty() && occluder != "alpha" &&
        (occluder.size() != 7 || occluder[0] != '#' ||
         occluder.find_first_not_of("0123456789abcdefABCDEF", 1) != std::string::npos)) {
        result.push_back("occluder must be alpha or a colour like #808080, not \"" + occluder + "\"");
    }
    if (noise != "smooth" && noise != "keep") result.push_back("noise must be smooth or keep, not \"" + noise + "\"");
    if (border != "free" && border != "hides") result.push_back("border must be free or hides, not \"" + border + "\"");
    if (!(close_gaps >= 0.0 && std::isfinite(close_gaps))) result.push_back("close-gaps must not be negative");
    if (!(max_megabytes > 0.0 && std::isfinite(max_megabytes))) result.push_back("max-megabytes must be positive");
    if (inside != "auto" && inside != "above" && inside != "below") {
        result.push_back("inside must be auto, above or below, not \"" + inside + "\"");
    }
    double value = 0.0;
    if (isovalue != "auto" && !(TextScan::number(isovalue, value) && std::isfinite(value))) {
        result.push_back("isovalue must be auto or a number, not \"" + isovalue + "\"");
    }
    return result;
}

}  // namespace morphodesic::datasets

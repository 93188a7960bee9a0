#pragma once

#include <string_view>

/// Files that are compiled into the program, see embed.cmake.
namespace morphodesic::reports::assets {

extern const std::string_view skeleton;       ///< templates/report.html
extern const std::string_view style;          ///< templates/report.css
extern const std::string_view script;         ///< Vega and the scripts of templates/
extern const std::string_view script_sha256;  ///< of script, hexadecimal

}  // namespace morphodesic::reports::assets

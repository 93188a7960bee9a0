#pragma once

#include <cstddef>
#include <cstdio>
#include <string>

/// Words of the notes on what was done to a scan.
namespace morphodesic::datasets {

inline std::string number(double value, const char* format = "%.3g") {
    char text[32];
    std::snprintf(text, sizeof text, format, value);
    return text;
}
inline std::string percent(double share) {
    return number(100.0 * share, "%.1f") + " %";
}
inline std::string count(std::size_t n, const char* noun) {
    return std::to_string(n) + " " + noun + (n == 1 ? "" : "s");
}
/// One of two things that were counted, or both with "and" between them. @param m, n  how many; not both 0
inline std::string either_or_both(std::size_t m, const std::string& first, std::size_t n, const std::string& second) {
    return m == 0 ? second : n == 0 ? first : first + " and " + second;
}

}  // namespace morphodesic::datasets

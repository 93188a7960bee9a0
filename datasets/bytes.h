#pragma once

#include <string>

namespace morphodesic::datasets {

/// Appends the bytes of a number as they lie in memory.
template <class T>
void put(std::string& to, T value) {
    to.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace morphodesic::datasets

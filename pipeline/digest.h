#pragma once

#include <string>
#include <string_view>

namespace morphodesic::pipeline {

/// 128-bit digest (XXH3) as 32 hexadecimal digits: equal bytes, equal digest, on every machine. Names settings and
/// finds damaged rows; it protects against accidents, not against forgers.
[[nodiscard]] std::string digest(std::string_view bytes);

}  // namespace morphodesic::pipeline

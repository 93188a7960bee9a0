#pragma once

#include <string>
#include <string_view>

namespace morphodesic::reports {

/// The text with every byte that is not part of valid UTF-8 replaced by U+FFFD, so that any file name can be shown.
[[nodiscard]] std::string valid_utf8(std::string_view bytes);

/// Text as content or quoted attribute of XML and HTML; control characters that XML forbids become U+FFFD.
[[nodiscard]] std::string escape_markup(std::string_view text);

[[nodiscard]] std::string base64(std::string_view bytes);

/// "data:image/png;base64,..." of a picture's bytes; empty for no bytes.
/// @throws std::invalid_argument if the bytes are not PNG, JPEG or WebP
[[nodiscard]] std::string data_uri(std::string_view bytes);

/// Number with so many significant digits; "–" for NaN.
[[nodiscard]] std::string short_number(double value, int digits = 3);

/// 0.123 -> "12.3 %"; what rounding left of nothing is "0 %", a little is "< 0.1 %", NaN "–".
[[nodiscard]] std::string share_text(double share);

}  // namespace morphodesic::reports

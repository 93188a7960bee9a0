#include "reports/text.h"

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <stdexcept>

namespace morphodesic::reports {
namespace {

constexpr std::string_view replacement = "\xEF\xBF\xBD";

/// Length of the valid UTF-8 sequence at the start of s, 0 if there is none (no overlong forms, no surrogates).
std::size_t sequence_length(std::string_view s) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(s[i]); };
    const unsigned char first = byte(0);
    if (first < 0x80) return 1;
    std::size_t length = 0;
    std::uint32_t code = 0;
    if (first >= 0xC2 && first <= 0xDF)
        length = 2, code = first & 0x1FU;
    else if (first >= 0xE0 && first <= 0xEF)
        length = 3, code = first & 0x0FU;
    else if (first >= 0xF0 && first <= 0xF4)
        length = 4, code = first & 0x07U;
    if (length == 0 || s.size() < length) return 0;
    for (std::size_t i = 1; i < length; ++i) {
        if ((byte(i) & 0xC0U) != 0x80U) return 0;
        code = (code << 6U) | (byte(i) & 0x3FU);
    }
    if (length == 3 && (code < 0x800 || (code >= 0xD800 && code <= 0xDFFF))) return 0;
    if (length == 4 && (code < 0x10000 || code > 0x10FFFF)) return 0;
    return length;
}

}  // namespace

std::string valid_utf8(std::string_view bytes) {
    std::string result;
    result.reserve(bytes.size());
    while (!bytes.empty()) {
        const std::size_t length = sequence_length(bytes);
        result += length > 0 ? bytes.substr(0, length) : replacement;
        bytes.remove_prefix(length > 0 ? length : 1);
    }
    return result;
}

std::string escape_markup(std::string_view text) {
    std::string result;
    for (const char c : valid_utf8(text)) {
        switch (c) {
            case '<':
                result += "&lt;";
                break;
            case '>':
                result += "&gt;";
                break;
            case '&':
                result += "&amp;";
                break;
            case '"':
                result += "&quot;";
                break;
            case '\'':
                result += "&#39;";
                break;
            case '\t':
            case '\n':
            case '\r':
                result += ' ';
                break;
            default:
                if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F)
                    result += replacement;
                else
                    result += c;
        }
    }
    return result;
}

std::string base64(std::string_view bytes) {
    static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string result;
    result.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t group = 0;
        for (std::size_t j = 0; j < 3; ++j) {
            group = (group << 8U) | (i + j < bytes.size() ? static_cast<unsigned char>(bytes[i + j]) : 0U);
        }
        for (std::size_t j = 0; j < 4; ++j) {
            result += i + j <= bytes.size() ? digits[(group >> (18U - 6U * j)) & 63U] : '=';
        }
    }
    return result;
}

std::string data_uri(std::string_view bytes) {
    if (bytes.empty()) return {};
    const char* type = nullptr;
    if (bytes.starts_with("\x89PNG\r\n\x1a\n"))
        type = "png";
    else if (bytes.starts_with("\xFF\xD8\xFF"))
        type = "jpeg";
    else if (bytes.starts_with("RIFF") && bytes.substr(0, 12).ends_with("WEBP"))
        type = "webp";
    if (type == nullptr) throw std::invalid_argument("a picture of the report is not a PNG, JPEG or WebP file");
    return std::string("data:image/") + type + ";base64," + base64(bytes);
}

std::string short_number(double value, int digits) {
    if (!std::isfinite(value)) return "–";
    char buffer[40];
    std::snprintf(buffer, sizeof buffer, "%.*g", digits, value);
    return buffer;
}

std::string share_text(double share) {
    if (!std::isfinite(share)) return "–";
    const double percent = 100.0 * share;
    if (std::abs(percent) < 1e-9) return "0 %";  // rounding left something of nothing
    if (percent > 0 && percent < 0.1) return "< 0.1 %";
    return short_number(percent, 3) + " %";
}

}  // namespace morphodesic::reports

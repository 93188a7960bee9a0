#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

#include "datasets/interruption.h"

namespace morphodesic::datasets {

/// The text with small letters in place of A to Z, whatever the locale.
inline std::string lower_case(std::string_view text) {
    std::string result(text);
    for (char& c : result) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return result;
}

/// Walks through the lines and words of a text without copying it; numbers do not depend on the locale.
class TextScan {
public:
    explicit TextScan(std::string_view text) : rest_(text) {}

    [[nodiscard]] bool done() const { return rest_.empty(); }
    [[nodiscard]] std::size_t line_number() const { return line_number_; }

    /// The next line without its end (LF, CR LF or CR).
    std::string_view line() {
        interruption_point(line_number_);
        const std::size_t end = rest_.find_first_of("\r\n");
        const std::string_view result = rest_.substr(0, end);
        if (end == std::string_view::npos) {
            rest_ = {};
        } else {
            rest_.remove_prefix(end + (rest_.substr(end, 2) == "\r\n" ? 2 : 1));
        }
        ++line_number_;
        return result;
    }

    /// Cuts the next word off a line; empty at its end.
    static std::string_view word(std::string_view& line) {
        const std::size_t begin = line.find_first_not_of(" \t\v\f");
        if (begin == std::string_view::npos) {
            line = {};
            return {};
        }
        line.remove_prefix(begin);
        const std::size_t end = line.find_first_of(" \t\v\f");
        const std::string_view result = line.substr(0, end);
        line.remove_prefix(result.size());
        return result;
    }

    /// A text without the mark that some editors put before its first letter (UTF-8).
    static std::string_view without_mark(std::string_view text) {
        return text.starts_with("\xEF\xBB\xBF") ? text.substr(3) : text;
    }

    /// True if a word is the given one, in letters of any size.
    static bool is_word(std::string_view word, std::string_view in_small_letters) {
        return word.size() == in_small_letters.size() && lower_case(word) == in_small_letters;
    }

    /// True if the whole word is a number (nan and inf are numbers too).
    template <class Number>
    static bool number(std::string_view word, Number& value) {
        if (!word.empty() && word.front() == '+') word.remove_prefix(1);
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (error == std::errc::result_out_of_range && std::is_floating_point_v<Number>) {
            value = 0;  // too small, or too large: the latter has a positive exponent
            const std::size_t e = word.find_first_of("eE");
            if (e == std::string_view::npos || word.substr(e + 1, 1) != "-") value = static_cast<Number>(INFINITY);
            return end == word.data() + word.size();
        }
        return error == std::errc() && end == word.data() + word.size();
    }

private:
    std::string_view rest_;
    std::size_t line_number_ = 0;
};

}  // namespace morphodesic::datasets

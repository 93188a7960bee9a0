#include "datasets/point_cloud_reader.h"

#include <lzf.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "datasets/mesh_check.h"
#include "datasets/read_error.h"
#include "datasets/shape_source.h"
#include "datasets/text_scan.h"

namespace morphodesic::datasets {
namespace {

namespace fs = std::filesystem;

bool is_usable(const Vector3& p) {
    return std::all_of(p.begin(), p.end(), [](double x) { return coordinate_problem(x) == nullptr; });
}

struct Field {
    std::string name;
    std::size_t size = 4, count = 1, offset = 0, column = 0;
    char type = 'F';
};

/// What the data of a compressed PCD unpack to: two lengths, then the packed bytes.
std::string unpacked_pcd(const fs::path& file, std::string_view data) {
    constexpr std::size_t best_compression = 100;  // LZF makes at most 264 bytes of three
    std::uint32_t packed = 0, length = 0;
    if (data.size() >= 8) {
        std::memcpy(&packed, data.data(), 4);  // little endian, as this machine
        std::memcpy(&length, data.data() + 4, 4);
    }
    if (data.size() < 8 || packed == 0 || packed > data.size() - 8 || length / best_compression > packed) {
        refuse(file, "its packed points break off, or their lengths are wrong");
    }
    std::string result(length, '\0');
    if (lzf_decompress(data.data() + 8, packed, result.data(), length) != length) {
        refuse(file, "its packed points cannot be unpacked");
    }
    return result;
}

std::vector<Vector3> read_pcd(const fs::path& file, std::string_view content, std::vector<std::string>& notes) {
    std::vector<Field> fields;
    std::size_t count = 0, width = 0, height = 1, data_begin = 0;
    bool has_points = false;
    std::string data;
    TextScan scan(content);
    while (!scan.done() && data.empty()) {
        std::string_view line = scan.line();
        const std::string_view key = TextScan::word(line);
        if (key == "FIELDS") {
            for (auto w = TextScan::word(line); !w.empty(); w = TextScan::word(line)) {
                fields.emplace_back();
                fields.back().name = w;
            }
        } else if (key == "SIZE" || key == "COUNT") {
            for (Field& f : fields) {
                std::size_t& to = key == "SIZE" ? f.size : f.count;
                if (!TextScan::number(TextScan::word(line), to) || to > 1000)
                    refuse(file, "its header has a bad " + std::string(key));
            }
        } else if (key == "TYPE") {
            for (Field& f : fields) {
                const std::string_view w = TextScan::word(line);
                f.type = w.empty() ? '?' : w.front();
            }
        } else if (key == "WIDTH" || key == "HEIGHT") {
            if (!TextScan::number(TextScan::word(line), key == "WIDTH" ? width : height))
                refuse(file, "its header has a bad " + std::string(key));
        } else if (key == "POINTS") {
            has_points = TextScan::number(TextScan::word(line), count);
            if (!has_points) refuse(file, "its header does not say how many points there are");
        } else if (key == "DATA") {
            data = TextScan::word(line);
            data_begin = static_cast<std::size_t>(line.data() - content.data());
            data_begin = std::min(content.find('\n', data_begin), content.size() - 1) + 1;
        }
    }
    const bool is_packed = data == "binary_compressed", is_binary = data == "binary" || is_packed;
    if (data != "ascii" && !is_binary)
        refuse(file, "its header does not lead to data (line \"DATA ascii\" or \"DATA binary\")");
    if (!has_points) {
        if (height > 0 && width > SIZE_MAX / height) {
            refuse(file, "its header promises " + std::to_string(width) + " x " + std::to_string(height) +
                             " points, more than the file has room for");
        }
        count = width * height;
    }
    std::size_t bytes = 0, columns = 0;
    const Field* axis[3] = {nullptr, nullptr, nullptr};
    for (Field& f : fields) {
        f.offset = bytes, f.column = columns;
        bytes += f.size * f.count, columns += f.count;
        if (f.name.size() == 1 && f.name[0] >= 'x' && f.name[0] <= 'z') axis[f.name[0] - 'x'] = &f;
    }
    for (const Field* a : axis) {
        if (a == nullptr || a->count == 0) refuse(file, "its points have no x, y and z");
        if (is_binary && (a->type != 'F' || (a->size != 4 && a->size != 8)))
            refuse(file, "its coordinates are not floating point numbers");
    }
    const std::size_t left = content.size() - std::min(data_begin, content.size());
    std::string unpacked;
    if (is_packed) unpacked = unpacked_pcd(file, content.substr(content.size() - left));
    const std::size_t room = is_packed ? unpacked.size() / bytes : is_binary ? left / bytes : left / 2 + 1;
    if (count > room) {
        refuse(file, "its header promises " + std::to_string(count) + " points, more than the file has room for");
    }
    std::vector<Vector3> points;
    std::size_t unseen = 0;
    for (std::size_t i = 0; i < count; ++i) {
        Vector3 p{};
        if (is_binary) {
            for (int a = 0; a < 3; ++a) {
                const Field& f = *axis[a];
                // Packed are all values of the first field, then all of the second.
                const char* from = is_packed ? unpacked.data() + f.offset * count + i * f.size * f.count
                                             : content.data() + data_begin + i * bytes + f.offset;
                float single = 0.0F;
                if (f.size == 8) std::memcpy(&p[a], from, 8);
                if (f.size == 4) std::memcpy(&single, from, 4), p[a] = single;
            }
        } else {
            if (scan.done())
                refuse(file,
                       "its header promises " + std::to_string(count) + " points, it ends after " + std::to_string(i));
            std::string_view line = scan.line();
            for (std::size_t column = 0; column < columns; ++column) {
                const std::string_view word = TextScan::word(line);
                for (int a = 0; a < 3; ++a) {
                    if (axis[a]->column == column && !TextScan::number(word, p[a])) {
                        refuse(file, "line " + std::to_string(scan.line_number()) + ": \"" +
                                         std::string(word.substr(0, 40)) + "\" is not a number");
                    }
                }
            }
        }
        if (is_usable(p)) {
            points.push_back(p);
        } else {
            ++unseen;
        }
    }
    if (unseen > 0) notes.push_back(std::to_string(unseen) + " points without a position were left out.");
    return points;
}

/// Digits, which an exponent may follow.
bool is_fraction(std::string_view text) {
    constexpr std::string_view digits = "0123456789";
    const std::size_t end = std::min(text.find_first_not_of(digits), text.size());
    if (end == 0 || end == text.size()) return end > 0;
    if (text[end] != 'e' && text[end] != 'E') return false;
    text.remove_prefix(end + 1);
    if (text.starts_with('-') || text.starts_with('+')) text.remove_prefix(1);
    return !text.empty() && text.find_first_not_of(digits) == std::string_view::npos;
}

/// The first three numbers of a line, cut apart at blanks, tabs and semicolons. A comma between digits of the words
/// they leave is a decimal sign; in a line that they do not cut in three it parts numbers.
struct Line {
    explicit Line(std::string_view line) : text(line) {
        std::replace(text.begin(), text.end(), ';', ' ');
        std::string_view rest = text;
        for (int i = 0; i < 3; ++i) {
            const std::string_view word = TextScan::word(rest);
            const std::size_t comma = word.find(',');
            const bool is_between = comma != std::string_view::npos && comma > 0 && word[comma - 1] >= '0' &&
                                    word[comma - 1] <= '9' && is_fraction(word.substr(comma + 1));
            if (word.empty() || (comma != std::string_view::npos && !is_between)) {
                has_decimal_commas = false;
                break;
            }
            has_decimal_commas |= is_between;
        }
        std::replace(text.begin(), text.end(), ',', has_decimal_commas ? '.' : ' ');
    }
    std::string text;
    bool has_decimal_commas = false;
};

/// Which columns of the rows are x, y and z.
struct Columns {
    std::array<std::size_t, 3> of{0, 1, 2};
    std::size_t words = 0;  ///< of the heading that names them; 0: there is none

    [[nodiscard]] bool are_in_order() const { return of[1] == of[0] + 1 && of[2] == of[1] + 1; }
    /// Of a line that names x, y and z, each once.
    [[nodiscard]] static Columns headed(std::string text) {
        for (char& c : text) {
            if (std::string_view("#/,;\"'").find(c) != std::string_view::npos) c = ' ';
        }
        Columns columns;
        std::array<int, 3> named{};
        std::string_view rest = text;
        for (std::string_view word = TextScan::word(rest); !word.empty(); word = TextScan::word(rest)) {
            for (std::size_t a = 0; a < 3; ++a) {
                if (!TextScan::is_word(word, std::array<std::string_view, 3>{"x", "y", "z"}[a])) continue;
                columns.of[a] = columns.words;
                ++named[a];
            }
            ++columns.words;
        }
        return named == std::array<int, 3>{1, 1, 1} ? columns : Columns{};
    }
    [[nodiscard]] bool read(std::string_view line, Vector3& p) const {
        const std::size_t last = *std::max_element(of.begin(), of.end());
        for (std::size_t column = 0; column <= last; ++column) {
            const std::string_view word = TextScan::word(line);
            for (std::size_t a = 0; a < 3; ++a) {
                if (of[a] == column && !TextScan::number(word, p[a])) return false;
            }
        }
        return true;
    }
};

std::size_t word_count(std::string_view line) {
    std::size_t words = 0;
    while (!TextScan::word(line).empty()) ++words;
    return words;
}

std::vector<Vector3> read_xyz(const fs::path& file, std::string_view content, std::vector<std::string>& notes) {
    std::vector<Vector3> points;
    bool has_decimal_commas = false;
    Columns columns, headed;
    TextScan scan(content);
    const auto is_heading = [&](std::string_view line) {
        const Columns found = Columns::headed(std::string(line));
        if (found.words > 0) headed = found;
        return found.words > 0;
    };
    while (!scan.done()) {
        const std::string_view whole = scan.line();
        const Line plain(whole.substr(0, whole.find('#')));
        const std::size_t words = word_count(plain.text);
        if (words == 0) {
            if (points.empty()) is_heading(whole);
            continue;
        }
        // A heading of as many words as a row has numbers; others are sentences in which x, y and z occur.
        if (points.empty()) columns = headed.words == words ? headed : Columns{};
        Vector3 p{};
        if (!columns.read(plain.text, p)) {
            if (points.empty() && (is_heading(whole) || scan.line_number() <= 2)) continue;  // or a count or a title
            refuse(file, "line " + std::to_string(scan.line_number()) +
                             (columns.words > 0 ? " has no numbers in the columns headed x, y and z"
                                                : " does not begin with three numbers"));
        }
        if (points.empty() && headed.words > 0 && columns.words == 0 && !headed.are_in_order()) {
            refuse(file, "line " + std::to_string(scan.line_number()) + " has " + std::to_string(words) +
                             " columns, the heading above it names " + std::to_string(headed.words) +
                             ", among them x, y and z in an order of their own");
        }
        for (const double x : p) {
            if (const char* problem = coordinate_problem(x))
                refuse(file, "line " + std::to_string(scan.line_number()) + ": a coordinate is " + problem);
        }
        has_decimal_commas |= plain.has_decimal_commas;
        points.push_back(p);
    }
    if (has_decimal_commas) notes.emplace_back("Commas between digits were read as decimal signs.");
    return points;
}

}  // namespace

bool is_point_cloud(const fs::path& file) {
    return ending_of(file) == ".pcd" || ending_of(file) == ".xyz";
}

std::vector<Vector3> read_point_cloud(const fs::path& file, double max_megabytes, std::vector<std::string>& notes) {
    const std::string bytes = file_content(file, max_megabytes);
    const std::string_view content = TextScan::without_mark(bytes);
    std::vector<Vector3> points =
        ending_of(file) == ".pcd" ? read_pcd(file, content, notes) : read_xyz(file, content, notes);
    if (points.empty()) refuse(file, "there are no points in it");
    return points;
}

}  // namespace morphodesic::datasets

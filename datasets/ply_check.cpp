#include "datasets/ply_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>

#include "datasets/interruption.h"
#include "datasets/read_error.h"
#include "datasets/text_scan.h"

namespace morphodesic::datasets {
namespace {

namespace fs = std::filesystem;

/// Corners of a face: a list that the file has no room for was cut off up to here, beyond it its length is a lie.
constexpr double plausible_corners = 1000.0;

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct Property {
    std::string name;
    Type type = Type::float32;
    bool is_list = false;
    Type count_type = Type::uint8;
};
struct Element {
    std::string name;
    std::size_t count = 0;
    std::vector<Property> properties;
};

Type type_named(const fs::path& file, std::string_view name) {
    static constexpr std::array<std::pair<std::string_view, Type>, 16> names{{
        {"char", Type::int8},
        {"int8", Type::int8},
        {"uchar", Type::uint8},
        {"uint8", Type::uint8},
        {"short", Type::int16},
        {"int16", Type::int16},
        {"ushort", Type::uint16},
        {"uint16", Type::uint16},
        {"int", Type::int32},
        {"int32", Type::int32},
        {"uint", Type::uint32},
        {"uint32", Type::uint32},
        {"float", Type::float32},
        {"float32", Type::float32},
        {"double", Type::float64},
        {"float64", Type::float64},
    }};
    for (const auto& [known, type] : names) {
        if (name == known) return type;
    }
    refuse(file, "its header has a property of the unknown type \"" + std::string(name.substr(0, 40)) + "\"");
}

std::size_t size_of(Type type) {
    switch (type) {
        case Type::int8:
        case Type::uint8:
            return 1;
        case Type::int16:
        case Type::uint16:
            return 2;
        case Type::float64:
            return 8;
        default:
            return 4;
    }
}

/// Where the numbers come from: words or bytes.
class Source {
public:
    Source(std::string_view data, bool is_text, bool swap_bytes) : rest_(data), is_text_(is_text), swap_(swap_bytes) {}

    /// False at the end of the data or at a word that is no number.
    bool next(Type type, double& value) {
        if (is_text_) {
            const std::size_t begin = rest_.find_first_not_of(" \t\r\n\v\f");
            if (begin == std::string_view::npos) return false;
            rest_.remove_prefix(begin);
            const std::string_view word = rest_.substr(0, rest_.find_first_of(" \t\r\n\v\f"));
            rest_.remove_prefix(word.size());
            return TextScan::number(word, value);
        }
        const std::size_t n = size_of(type);
        if (rest_.size() < n) return false;
        char bytes[8];
        std::memcpy(bytes, rest_.data(), n);
        if (swap_) std::reverse(bytes, bytes + n);
        rest_.remove_prefix(n);
        switch (type) {
            case Type::int8:
                value = as<std::int8_t>(bytes);
                break;
            case Type::uint8:
                value = as<std::uint8_t>(bytes);
                break;
            case Type::int16:
                value = as<std::int16_t>(bytes);
                break;
            case Type::uint16:
                value = as<std::uint16_t>(bytes);
                break;
            case Type::int32:
                value = as<std::int32_t>(bytes);
                break;
            case Type::uint32:
                value = as<std::uint32_t>(bytes);
                break;
            case Type::float32:
                value = as<float>(bytes);
                break;
            case Type::float64:
                value = as<double>(bytes);
                break;
        }
        return true;
    }
    [[nodiscard]] std::size_t bytes_left() const { return rest_.size(); }

private:
    template <class T>
    static double as(const char* bytes) {
        T value;
        std::memcpy(&value, bytes, sizeof value);
        return static_cast<double>(value);
    }
    std::string_view rest_;
    bool is_text_, swap_;
};

struct Header {
    std::string format;
    std::vector<Element> elements;
    std::size_t size = 0;  ///< bytes up to the data
};

Header parsed_header(const fs::path& file, std::string_view content) {
    Header header;
    const std::size_t end = content.find("end_header");
    if (end == std::string_view::npos || end > 1'000'000) refuse(file, "its header has no end");
    header.size = end + 10;
    while (header.size < content.size() && (content[header.size] == ' ' || content[header.size] == '\t')) ++header.size;
    if (content.substr(header.size, 2) == "\r\n") {
        header.size += 2;
    } else if (header.size < content.size()) {
        ++header.size;
    }
    TextScan scan(content.substr(0, end));
    while (!scan.done()) {
        std::string_view line = scan.line();
        const std::string_view key = TextScan::word(line);
        if (key == "format") {
            header.format = TextScan::word(line);
        } else if (key == "element") {
            Element element;
            element.name = TextScan::word(line);
            if (!TextScan::number(TextScan::word(line), element.count)) {
                refuse(file,
                       "its header does not say how many elements \"" + element.name.substr(0, 40) + "\" there are");
            }
            header.elements.push_back(std::move(element));
        } else if (key == "property") {
            if (header.elements.empty()) refuse(file, "its header has a property of no element");
            Property property;
            std::string_view type = TextScan::word(line);
            property.is_list = type == "list";
            if (property.is_list) {
                property.count_type = type_named(file, TextScan::word(line));
                type = TextScan::word(line);
            }
            property.type = type_named(file, type);
            property.name = TextScan::word(line);
            header.elements.back().properties.push_back(std::move(property));
        }
    }
    if (header.format != "ascii" && header.format != "binary_little_endian" && header.format != "binary_big_endian") {
        refuse(file, "its header names the unknown format \"" + header.format.substr(0, 40) + "\"");
    }
    return header;
}

bool is_index_list(const Property& p) {
    return p.is_list && (p.name == "vertex_indices" || p.name == "vertex_index");
}

}  // namespace

CheckedMesh check_ply(const fs::path& file, std::string_view content) {
    const Header header = parsed_header(file, content);
    const bool is_text = header.format == "ascii";
    CheckedMesh result;
    Source source(content.substr(header.size), is_text, header.format == "binary_big_endian");
    std::size_t strips = 0, point_count = 0;
    for (const Element& element : header.elements) {  // faces may come before the points they name
        if (element.name == "vertex") point_count = std::min<std::size_t>(element.count, largest_point_count);
    }
    for (const Element& element : header.elements) {
        const bool is_point = element.name == "vertex", is_face = element.name == "face";
        strips += element.name == "tristrips" ? element.count : 0;
        // A property needs two characters or one byte at least: a lying count shows before memory is asked for.
        const std::size_t least = is_text ? 2 : 1;
        if (!element.properties.empty() && element.count > source.bytes_left() / least + 1) {
            refuse(file, "its header promises " + std::to_string(element.count) + " elements \"" +
                             element.name.substr(0, 40) + "\", more than the file has room for");
        }
        if (element.properties.empty()) continue;
        std::array<int, 3> axis{-1, -1, -1};
        for (std::size_t p = 0; is_point && p < element.properties.size(); ++p) {
            const std::string& name = element.properties[p].name;
            if (name.size() == 1 && name[0] >= 'x' && name[0] <= 'z' && !element.properties[p].is_list) {
                axis[name[0] - 'x'] = static_cast<int>(p);
            }
        }
        if (is_point && *std::min_element(axis.begin(), axis.end()) < 0) refuse(file, "its points have no x, y and z");
        if (is_point && !result.points.empty()) refuse(file, "its header has two lists of points");
        if (is_face && element.count > 0 &&
            std::none_of(element.properties.begin(), element.properties.end(), is_index_list)) {
            throw ReadError(file, "its faces have no list vertex_indices", "export it again with the usual names");
        }
        for (std::size_t i = 0; i < element.count; ++i) {
            interruption_point(i);
            Vector3 point{};
            for (std::size_t p = 0; p < element.properties.size(); ++p) {
                const Property& property = element.properties[p];
                const auto broken = [&] {
                    refuse(file, "its header promises " + std::to_string(element.count) + " elements \"" +
                                     element.name.substr(0, 40) + "\", the data end or break off after " +
                                     std::to_string(i));
                };
                double value = 0.0;
                if (!property.is_list) {
                    if (!source.next(property.type, value)) broken();
                    for (int a = 0; a < 3; ++a) {
                        if (is_point && axis[a] == static_cast<int>(p)) point[a] = value;
                    }
                    continue;
                }
                double length = 0.0;
                if (!source.next(property.count_type, length)) broken();
                const auto bytes_left = static_cast<double>(source.bytes_left());
                if (length > bytes_left && length <= plausible_corners) broken();
                if (!(length >= 0.0 && length <= bytes_left)) {
                    refuse(file, "element " + std::to_string(i) + " of \"" + element.name.substr(0, 40) +
                                     "\" promises a list of " +
                                     std::to_string(static_cast<long long>(std::clamp(length, -1e15, 1e15))) +
                                     " entries");
                }
                const bool is_corners = is_face && is_index_list(property) && length >= 3;
                if (is_corners) {
                    check_corner_count(file, i, static_cast<std::size_t>(length));
                    result.face_sizes.push_back(static_cast<int>(length));
                    check_face_count(file, result.face_sizes.size());
                }
                for (std::size_t c = 0; c < static_cast<std::size_t>(length); ++c) {
                    if (!source.next(property.type, value)) broken();
                    if (!is_face || !is_index_list(property)) continue;
                    if (!(value >= 0.0 && value < static_cast<double>(point_count)) || value != std::floor(value)) {
                        char text[32];
                        std::snprintf(text, sizeof text, "%.17g", value);
                        refuse(file, "face " + std::to_string(i + 1) + " names point " + text + " of " +
                                         std::to_string(point_count) + " (counted from 0)");
                    }
                    if (is_corners) result.corners.push_back(static_cast<int>(value));
                }
            }
            if (is_point) {
                for (const double x : point) {
                    if (const char* problem = coordinate_problem(x)) {
                        refuse(file, "a coordinate of point " + std::to_string(i + 1) + " is " + problem);
                    }
                }
                result.points.push_back(point);
            }
        }
    }
    if (result.points.empty()) refuse(file, "there are no points in it");
    if (strips > 0 && result.face_sizes.empty()) {
        throw ReadError(file, "its faces are triangle strips, an old kind that is not read",
                        "convert it to plain triangles, for example with MeshLab");
    }
    return result;
}

}  // namespace morphodesic::datasets

#include "datasets/nrrd_reader.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "datasets/mesh_check.h"
#include "datasets/read_error.h"
#include "datasets/text_scan.h"

namespace morphodesic::datasets {
namespace {

namespace fs = std::filesystem;

std::string_view trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
    return first == std::string_view::npos ? std::string_view() : text.substr(first, last - first + 1);
}

/// The lines of a header by name.
class Fields {
public:
    Fields(const fs::path& file, std::string_view text, char separator) : file_(file) {
        for (TextScan scan(text); !scan.done();) {
            const std::string_view line = scan.line();
            const std::size_t at = line.find(separator);
            if (line.starts_with('#') || at == std::string_view::npos) continue;
            // "key:=value" tells what is no field; keys may have colons of their own.
            if (separator == ':' && line.find(":=") < line.find(": ")) continue;
            std::string name = lower_case(line.substr(0, at));
            std::erase_if(name, [](char c) { return c == ' ' || c == '\t'; });
            if (!values_.emplace(name, trimmed(line.substr(at + 1))).second) {
                refuse(file_, "its header gives " + name + " twice");
            }
        }
    }
    [[nodiscard]] std::string get(const std::string& name, const std::string& otherwise = "") const {
        const auto it = values_.find(name);
        return it == values_.end() ? otherwise : it->second;
    }
    [[nodiscard]] bool is_true(const std::string& name) const { return lower_case(get(name)) == "true"; }

    /// The numbers of a field, which may be grouped by brackets and commas; empty if there is no such field.
    template <class Number>
    [[nodiscard]] std::vector<Number> numbers(const std::string& name) const {
        std::string text = get(name);
        std::replace_if(
            text.begin(), text.end(), [](char c) { return c == '(' || c == ')' || c == ','; }, ' ');
        std::vector<Number> result;
        for (std::string_view rest = text, word = TextScan::word(rest); !word.empty(); word = TextScan::word(rest)) {
            Number value{};
            if (!TextScan::number(word, value)) {
                refuse(file_, "in its header \"" + std::string(word) + "\" in " + name + " is not a number");
            }
            result.push_back(value);
        }
        return result;
    }
    template <class Number>
    [[nodiscard]] std::vector<Number> three(const std::string& name, std::size_t count = 3) const {
        std::vector<Number> result = numbers<Number>(name);
        if (!result.empty() && result.size() != count) {
            refuse(file_, "its header gives " + std::to_string(result.size()) + " numbers for " + name +
                              " instead of " + std::to_string(count));
        }
        return result;
    }

private:
    fs::path file_;
    std::map<std::string, std::string> values_;
};

enum class Packing { raw, packed, text };

/// Where the numbers are: in the file itself from an offset on, or in one beside it.
struct Numbers {
    std::string file_name;  ///< empty: the file itself
    std::size_t offset = 0;
    std::int64_t skipped_bytes = 0;  ///< of the unpacked numbers; -1: the numbers are the end of the file
    std::int64_t skipped_lines = 0;
    Packing packing = Packing::raw;
};

void read_numbers(const fs::path& file, const std::string& own_content, const Numbers& where, const VoxelLayout& layout,
                  double max_megabytes, Volume& volume) {
    std::string other;
    fs::path holder = file;
    if (where.file_name.starts_with("LIST") || where.file_name.find('%') != std::string::npos) {
        refuse(file, "its numbers are spread over several files", "save it with all numbers in one file");
    }
    if (!where.file_name.empty()) {
        // A header names what lies beside it: nothing else of this machine is read on its word.
        std::string name = where.file_name;
        while (name.starts_with("./")) name.erase(0, 2);
        if (name.empty() || fs::path(name).filename() != name || name == "." || name == "..") {
            refuse(file, "its numbers are said to be in \"" + where.file_name + "\", which is not a file beside it",
                   "put both files into one folder and name the file without a folder");
        }
        holder = file.parent_path() / name;
        std::error_code error;
        if (!fs::exists(holder, error)) {
            refuse(file, "its numbers are in \"" + name + "\", and there is no such file beside it",
                   "copy that file too");
        }
        other = file_content(holder, max_megabytes);
    }
    std::string_view data = where.file_name.empty() ? std::string_view(own_content).substr(where.offset) : other;
    for (std::int64_t line = 0; line < where.skipped_lines; ++line) {
        const std::size_t end = data.find('\n');
        if (end == std::string_view::npos) refuse(holder, "it has fewer lines than its header skips");
        data.remove_prefix(end + 1);
    }
    const std::size_t count = layout.byte_count();
    const auto skipped = static_cast<std::size_t>(std::max<std::int64_t>(where.skipped_bytes, 0));
    if (where.packing == Packing::packed) {
        if (skipped > 1'000'000) refuse(file, "its header skips more than a megabyte of the unpacked numbers");
        return decode(inflated(holder, data, skipped, layout), layout, volume);
    }
    if (where.packing == Packing::raw) {
        const std::size_t held = data.size() - std::min(skipped, data.size());
        if (held < count) {
            refuse(holder, "the header promises " + std::to_string(count) + " bytes of numbers, but there are only " +
                               std::to_string(held));
        }
        if (where.skipped_bytes >= 0 && held > count + layout.most_padding()) refuse_surplus(holder, layout);
        const std::size_t from = where.skipped_bytes < 0 ? data.size() - count : skipped;
        return decode(std::string(data.substr(from, count)), layout, volume);
    }
    const std::size_t wanted = count / bytes_of(layout.type);
    if (data.size() < 2 * wanted - 1) {
        refuse(holder, "the header promises " + std::to_string(wanted) + " numbers, more than there is text for");
    }
    for (int a = 0; a < 3; ++a) volume.nodes[a] = static_cast<int>(layout.nodes[a]);
    const std::size_t slice = wanted / static_cast<std::size_t>(layout.nodes[2]);
    for (TextScan scan(data); !scan.done() && volume.values.size() < wanted + slice;) {
        std::string_view line = scan.line();
        for (std::string_view word = TextScan::word(line); !word.empty(); word = TextScan::word(line)) {
            float value = 0.0F;
            if (!TextScan::number(word, value)) refuse(holder, "\"" + std::string(word) + "\" is not a number");
            volume.values.push_back(value);
        }
    }
    if (volume.values.size() < wanted) {
        refuse(holder, "the header promises " + std::to_string(wanted) + " numbers, but there are only " +
                           std::to_string(volume.values.size()));
    }
    if (volume.values.size() >= wanted + slice) refuse_surplus(holder, layout);
    volume.values.resize(wanted);
}

std::optional<VoxelType> nrrd_type(const std::string& name) {
    static const std::map<std::string, VoxelType> types = [] {
        std::map<std::string, VoxelType> result;
        const auto add = [&](VoxelType type, std::initializer_list<const char*> names) {
            for (const char* n : names) result[n] = type;
        };
        add(VoxelType::int8, {"signed char", "int8", "int8_t"});
        add(VoxelType::uint8, {"uchar", "unsigned char", "uint8", "uint8_t"});
        add(VoxelType::int16, {"short", "short int", "signed short", "signed short int", "int16", "int16_t"});
        add(VoxelType::uint16, {"ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"});
        add(VoxelType::int32, {"int", "signed int", "int32", "int32_t"});
        add(VoxelType::uint32, {"uint", "unsigned int", "uint32", "uint32_t"});
        add(VoxelType::int64,
            {"longlong", "long long", "long long int", "signed long long", "signed long long int", "int64", "int64_t"});
        add(VoxelType::uint64, {"ulonglong", "unsigned long long", "unsigned long long int", "uint64", "uint64_t"});
        add(VoxelType::float32, {"float"});
        add(VoxelType::float64, {"double"});
        return result;
    }();
    const auto it = types.find(lower_case(name));
    return it == types.end() ? std::nullopt : std::optional(it->second);
}

std::optional<VoxelType> metaimage_type(const std::string& name) {
    static const std::map<std::string, VoxelType> types{
        {"MET_CHAR", VoxelType::int8},         {"MET_UCHAR", VoxelType::uint8},   {"MET_SHORT", VoxelType::int16},
        {"MET_USHORT", VoxelType::uint16},     {"MET_INT", VoxelType::int32},     {"MET_UINT", VoxelType::uint32},
        {"MET_LONG", VoxelType::int32},        {"MET_ULONG", VoxelType::uint32},  {"MET_LONG_LONG", VoxelType::int64},
        {"MET_ULONG_LONG", VoxelType::uint64}, {"MET_FLOAT", VoxelType::float32}, {"MET_DOUBLE", VoxelType::float64}};
    const auto it = types.find(name);
    return it == types.end() ? std::nullopt : std::optional(it->second);
}

VoxelType known(const fs::path& file, std::optional<VoxelType> type, const std::string& name) {
    if (!type) refuse(file, "its numbers are of the kind \"" + name + "\"", "save it as integers or floats");
    return *type;
}

void take_sizes(const fs::path& file, const std::vector<std::int64_t>& sizes, VoxelLayout& layout) {
    if (sizes.size() != 3) refuse(file, "its header does not give the sizes of three axes");
    std::copy(sizes.begin(), sizes.end(), layout.nodes.begin());
}

/// Millimetres in a NRRD's space unit ("mm", "m", ...).
double millimetres(const std::string& units) {
    const std::string unit = units.substr(0, units.find('"', 1) + 1);
    return unit == "\"m\"" ? 1000.0 : unit == "\"cm\"" ? 10.0 : unit == "\"um\"" || unit == "\"µm\"" ? 0.001 : 1.0;
}

}  // namespace

Volume read_nrrd(const fs::path& file, double max_megabytes) {
    const std::string content = file_content(file, max_megabytes);
    if (!content.starts_with("NRRD000")) refuse(file, "it does not begin like a NRRD file");
    // The header ends at the first empty line; a detached one may end with the file.
    std::size_t end = content.find("\n\n");
    std::size_t data_at = end == std::string::npos ? content.size() : end + 2;
    if (const std::size_t dos = content.find("\r\n\r\n"); dos < end) end = dos, data_at = dos + 4;
    const Fields fields(file, std::string_view(content).substr(0, end), ':');

    VoxelLayout layout;
    const std::string axes = fields.get("dimension");
    if (axes != "3")
        refuse(file, "it has " + (axes.empty() ? "no" : axes) + " axes, not three", "save one volume of plain numbers");
    take_sizes(file, fields.three<std::int64_t>("sizes"), layout);
    layout.type = known(file, nrrd_type(fields.get("type")), fields.get("type"));
    const std::string endian = lower_case(fields.get("endian"));
    layout.big_endian = endian == "big";
    Numbers where;
    const std::string encoding = lower_case(fields.get("encoding"));
    if (encoding == "gzip" || encoding == "gz") {
        where.packing = Packing::packed;
    } else if (encoding == "text" || encoding == "txt" || encoding == "ascii") {
        where.packing = Packing::text;
    } else if (encoding != "raw") {
        refuse(file, "its numbers are packed as \"" + encoding + "\"", "save it raw or with gzip");
    }
    if (where.packing != Packing::text && bytes_of(layout.type) > 1 && endian != "big" && endian != "little") {
        refuse(file, "its header does not say the order of the bytes (endian)");
    }
    check_layout(file, layout, max_megabytes);
    const auto count_of = [&](const char* name) {
        const auto numbers = fields.numbers<std::int64_t>(name);
        return numbers.empty() ? 0 : numbers.front();
    };
    where.file_name = fields.get("datafile");
    where.offset = data_at;
    where.skipped_bytes = count_of("byteskip");
    where.skipped_lines = count_of("lineskip");
    if (where.skipped_bytes < -1 || where.skipped_lines < 0) refuse(file, "its header skips a negative length");

    Volume volume;
    const std::string space = lower_case(fields.get("space"));
    double unit = 1.0;
    if (const auto directions = fields.three<double>("spacedirections", 9); !directions.empty()) {
        unit = millimetres(fields.get("spaceunits"));
        for (int a = 0; a < 3; ++a) {
            for (int c = 0; c < 3; ++c) volume.step[a][c] = unit * directions[3 * a + c];
        }
        const auto origin = fields.three<double>("spaceorigin");
        for (std::size_t c = 0; c < origin.size(); ++c) volume.origin[c] = unit * origin[c];
        // Of these spaces x points the wrong way: without turning it, the solid would be its mirror image.
        const bool is_left_handed = space == "las" || space == "left-anterior-superior" ||
                                    space.starts_with("left-anterior-superior-time") || space == "last" ||
                                    space.starts_with("3d-left-handed") || space.starts_with("3dlh");
        if (is_left_handed) {
            for (auto& step : volume.step) step[0] = -step[0];
            volume.origin[0] = -volume.origin[0];
        }
    } else {
        unit = millimetres(fields.get("units"));
        const auto spacings = fields.three<double>("spacings");
        for (int a = 0; a < 3; ++a) volume.step[a][a] = unit * (spacings.empty() ? 1.0 : spacings[a]);
    }
    if (space.empty()) {
        volume.notes.emplace_back("The file does not say where its axes point: it may be a mirror image.");
    }
    check_geometry(file, volume);
    read_numbers(file, content, where, layout, max_megabytes, volume);
    return volume;
}

Volume read_metaimage(const fs::path& file, double max_megabytes) {
    const std::string content = file_content(file, max_megabytes);
    const std::size_t last = content.find("ElementDataFile");  // always the last line of the header
    if (last == std::string::npos) refuse(file, "it has no ElementDataFile, so it is not the header of a MetaImage");
    const std::size_t end = std::min(content.find('\n', last), content.size() - 1);
    const Fields fields(file, std::string_view(content).substr(0, end), '=');

    VoxelLayout layout;
    if (fields.get("ndims") != "3")
        refuse(file, "it has " + fields.get("ndims", "no") + " axes, not three", "save one volume of plain numbers");
    if (fields.get("elementnumberofchannels", "1") != "1") {
        refuse(file, "it has several numbers in each voxel", "save one volume of plain numbers");
    }
    take_sizes(file, fields.three<std::int64_t>("dimsize"), layout);
    layout.type = known(file, metaimage_type(fields.get("elementtype")), fields.get("elementtype"));
    layout.big_endian = fields.is_true("binarydatabyteordermsb") || fields.is_true("elementbyteordermsb");
    check_layout(file, layout, max_megabytes);
    Numbers where;
    where.packing = lower_case(fields.get("binarydata", "true")) != "true" ? Packing::text
                    : fields.is_true("compresseddata")                     ? Packing::packed
                                                                           : Packing::raw;
    where.file_name = fields.get("elementdatafile");
    if (lower_case(where.file_name) == "local") where.file_name.clear();
    where.offset = end + 1;
    if (const auto skipped = fields.numbers<std::int64_t>("headersize"); !skipped.empty()) {
        where.skipped_bytes = skipped.front();
        if (where.skipped_bytes < -1) refuse(file, "its header skips a negative length");
    }

    Volume volume;
    const auto first_of = [&](std::initializer_list<const char*> names, std::size_t count) {
        for (const char* name : names) {
            if (auto numbers = fields.three<double>(name, count); !numbers.empty()) return numbers;
        }
        return std::vector<double>();
    };
    const auto spacing = first_of({"elementspacing", "elementsize"}, 3);
    const auto axes = first_of({"transformmatrix", "rotation", "orientation"}, 9);
    const auto origin = first_of({"offset", "position", "origin"}, 3);
    for (int a = 0; a < 3; ++a) {
        for (int c = 0; c < 3; ++c) {
            const double direction = axes.empty() ? static_cast<double>(a == c) : axes[3 * a + c];
            volume.step[a][c] = (spacing.empty() ? 1.0 : spacing[a]) * direction;
        }
        if (!origin.empty()) volume.origin[a] = origin[a];
    }
    check_geometry(file, volume);
    read_numbers(file, content, where, layout, max_megabytes, volume);
    return volume;
}

}  // namespace morphodesic::datasets

#include "datasets/vdb_check.h"

#include <openvdb/version.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "datasets/bytes.h"
#include "datasets/mesh_check.h"
#include "datasets/read_error.h"

namespace morphodesic::datasets {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t magic_number = 0x56444220;  // " BDV"
constexpr std::uint32_t oldest_version = 218;      // of the format: from then on names have the lengths read here
constexpr std::uint32_t flag_per_file = 220, flag_per_grid = 222;  // where it is said how values are packed
constexpr std::size_t uuid_length = 36;

/// Takes values off the front of a file's bytes; never reads beyond them.
class Bytes {
public:
    Bytes(const fs::path& file, std::string_view content) : file_(file), content_(content) {}

    template <class T>
    T value() {
        T result;
        std::memcpy(&result, take(sizeof(T)).data(), sizeof(T));
        return result;
    }
    std::string_view take(std::size_t count) {
        if (count > content_.size() - at_) breaks_off();
        const std::string_view result = content_.substr(at_, count);
        at_ += count;
        return result;
    }
    std::string_view name() { return take(value<std::uint32_t>()); }
    [[nodiscard]] std::size_t at() const { return at_; }
    /// The bytes from first to last; both as the file says.
    [[nodiscard]] std::string_view range(std::int64_t first, std::int64_t last) const {
        if (first < 0 || last < first || static_cast<std::uint64_t>(last) > content_.size()) breaks_off();
        return content_.substr(static_cast<std::size_t>(first), static_cast<std::size_t>(last - first));
    }
    void go_to(std::int64_t position) {
        if (position < static_cast<std::int64_t>(at_)) breaks_off();
        take(static_cast<std::size_t>(position) - at_);
    }
    [[noreturn]] void breaks_off() const {
        throw ReadError(file_, "the file breaks off, or its header promises more than it holds",
                        "export or download the file again");
    }

private:
    const fs::path& file_;
    std::string_view content_;
    std::size_t at_ = 0;
};

struct Description {
    bool is_level_set = false;
    std::int64_t voxels = -1;  ///< as the file says, -1 if it does not
};

/// Pairs of a name and a value of any type.
Description read_metadata(Bytes& bytes) {
    Description result;
    const auto count = bytes.value<std::uint32_t>();
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::string_view name = bytes.name();
        bytes.name();  // of the type
        const std::string_view value = bytes.take(bytes.value<std::uint32_t>());
        if (name == "class") result.is_level_set = value == "level set";
        if (name == "file_voxel_count" && value.size() == sizeof result.voxels) {
            std::memcpy(&result.voxels, value.data(), sizeof result.voxels);
        }
    }
    return result;
}

/// How likely a grid is the shape; 0 if it can be none.
int rank_of(std::string_view type, const Description& description) {
    const auto begins_with = [&](std::string_view begin) { return type.starts_with(begin); };
    constexpr std::array<std::string_view, 2> numbers{"Tree_float_5_4_3", "Tree_double_5_4_3"};
    constexpr std::array<std::string_view, 4> masks{"Tree_int32_5_4_3", "Tree_int64_5_4_3", "Tree_bool_5_4_3",
                                                    "Tree_mask_5_4_3"};
    const bool holds_numbers = std::any_of(numbers.begin(), numbers.end(), begins_with);
    if (!holds_numbers && std::none_of(masks.begin(), masks.end(), begins_with)) return 0;
    if (description.voxels == 0) return 1;
    return !holds_numbers ? 2 : description.is_level_set ? 4 : 3;
}

bool is_regular(std::string_view map) {
    constexpr std::array<std::string_view, 7> regular{"AffineMap",      "ScaleMap",          "UniformScaleMap",
                                                      "TranslationMap", "ScaleTranslateMap", "UniformScaleTranslateMap",
                                                      "UnitaryMap"};
    for (const std::string_view name : regular) {
        if (map == name) return true;
    }
    return false;
}

}  // namespace

std::string shortened(const std::string& text) {
    constexpr std::size_t longest = 100;
    std::string result = text.substr(0, longest);
    std::replace_if(
        result.begin(), result.end(), [](unsigned char c) { return c < ' ' || c > '~'; }, '?');
    return text.size() > longest ? result + "..." : result;
}

CheckedVdb check_vdb(const fs::path& file, double max_megabytes, std::size_t most_voxels) {
    const std::string content = file_content(file, max_megabytes);
    Bytes bytes(file, content);
    if (bytes.value<std::int64_t>() != magic_number) {
        throw ReadError(file, "it does not begin like a VDB file", "export or download the file again");
    }
    const auto version = bytes.value<std::uint32_t>();
    if (version > openvdb::OPENVDB_FILE_VERSION) {
        throw ReadError(file,
                        "it has version " + std::to_string(version) + " of the VDB format, newer than is read here",
                        "save it for an older version");
    }
    bytes.take(2 * sizeof(std::uint32_t));  // of the library
    const bool has_offsets = bytes.value<char>() != 0;
    if (version < oldest_version || !has_offsets) {
        throw ReadError(file, "it is an old or rare kind of VDB file (version " + std::to_string(version) + ")",
                        "save it again as a file, with a newer program");
    }
    if (version >= flag_per_file && version < flag_per_grid) bytes.take(1);
    bytes.take(uuid_length);
    const std::size_t header_size = bytes.at();
    read_metadata(bytes);
    CheckedVdb result;
    const auto count = bytes.value<std::int32_t>();
    if (count < 0) bytes.breaks_off();
    int best = 0;
    for (std::int32_t i = 0; i < count; ++i) {
        const std::size_t begin = bytes.at();
        const std::string_view name = bytes.name(), type = bytes.name(), shared_with = bytes.name();
        const auto first = bytes.value<std::int64_t>();
        bytes.value<std::int64_t>();  // where the values begin
        const auto end = bytes.value<std::int64_t>();
        const std::string_view descriptor = std::string_view(content).substr(begin, bytes.at() - begin);
        if (first < static_cast<std::int64_t>(bytes.at())) bytes.breaks_off();
        const std::string_view grid = bytes.range(first, end);
        bytes.go_to(end);
        ++result.grid_count;
        // A grid that shares the tree of another is that grid elsewhere: the other one will do.
        if (!shared_with.empty()) continue;
        Bytes inside(file, grid);
        if (version >= flag_per_grid) inside.take(sizeof(std::uint32_t));
        const Description description = read_metadata(inside);
        const int rank = rank_of(type, description);
        if (rank <= best) continue;
        best = rank;
        // What the file says of itself is looked at before its values are read.
        if (description.voxels > static_cast<std::int64_t>(most_voxels)) {
            throw ReadError(file, "it has more voxels than 512 x 512 x 512", "resample the volume");
        }
        if (!is_regular(inside.name())) throw ReadError(file, "its grid is not a regular one", "resample it");
        result.grid_name = name.substr(0, name.find('\x1e'));  // a number that tells grids of one name apart follows
        result.content.assign(content, 0, header_size);
        put(result.content, std::uint32_t{0});  // metadata
        put(result.content, std::uint32_t{1});  // grids
        result.content.append(descriptor).append(grid);
    }
    return result;
}

}  // namespace morphodesic::datasets

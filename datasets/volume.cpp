#include "datasets/volume.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string_view>
#include <tuple>
#include <utility>

#include "datasets/interruption.h"
#include "datasets/nifti_reader.h"
#include "datasets/nrrd_reader.h"
#include "datasets/read_error.h"
#include "datasets/shape_source.h"
#include "datasets/text_scan.h"
#include "datasets/voxelize.h"

namespace morphodesic::datasets {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t most_nodes = 512LL * 512 * 512;
constexpr std::size_t best_compression = 1100;  // deflate makes at most 1032 bytes of one
constexpr double most_border = 0.75;            // of the border's voxels: where more are inside, it is the background

template <class T>
void decode_as(const std::string& bytes, bool swapped, std::vector<float>& values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
        char one[sizeof(T)];
        std::memcpy(one, bytes.data() + i * sizeof(T), sizeof(T));
        if (swapped) std::reverse(one, one + sizeof(T));
        T value;
        std::memcpy(&value, one, sizeof(T));
        values[i] = static_cast<float>(value);
    }
}

/// The value at the surface.
float chosen_isovalue(const fs::path& file, const Volume& volume, const std::string& isovalue, float low, float high) {
    char text[160];
    if (isovalue != "auto") {
        double value = 0.0;
        TextScan::number(isovalue, value);
        if (low < value && value < high) return static_cast<float>(value);
        std::snprintf(text, sizeof text, "its values run from %g to %g, so there is no surface at %g", low, high,
                      value);
        throw ReadError(file, text, "choose --isovalue between them");
    }
    if (!(low < high)) {
        std::snprintf(text, sizeof text, "all its values are %g, so there is no surface in it", low);
        throw ReadError(file, text, "check what was exported");
    }
    const bool is_mask = std::all_of(volume.values.begin(), volume.values.end(),
                                     [&](float v) { return v == low || v == high || std::isnan(v); });
    if (is_mask) return 0.5F * (low + high);
    constexpr float rounding = 1e-5F;  // of values that were scaled when they were stored
    if (low >= -rounding && high <= 1.0F + rounding && high > 0.5F) return 0.5F;
    std::snprintf(text, sizeof text, "its values run from %g to %g and nothing says which of them is the surface", low,
                  high);
    throw ReadError(file, text, "name it with --isovalue (inside is above it, or below with --inside below)");
}

/// Share of the voxels at the border of the volume that are inside.
double share_of_border(const Volume& volume, float iso) {
    std::size_t inside = 0, all = 0, n = 0;
    for (int k = 0; k < volume.nodes[2]; ++k) {
        for (int j = 0; j < volume.nodes[1]; ++j) {
            const bool whole_row = k == 0 || k == volume.nodes[2] - 1 || j == 0 || j == volume.nodes[1] - 1;
            for (int i = 0; i < volume.nodes[0]; ++i, ++n) {
                if (!whole_row && i != 0 && i != volume.nodes[0] - 1) continue;
                ++all;
                inside += volume.values[n] > iso ? 1 : 0;
            }
        }
    }
    return static_cast<double>(inside) / static_cast<double>(all);
}

}  // namespace

std::size_t bytes_of(VoxelType type) {
    switch (type) {
        case VoxelType::int8:
        case VoxelType::uint8:
            return 1;
        case VoxelType::int16:
        case VoxelType::uint16:
            return 2;
        case VoxelType::int32:
        case VoxelType::uint32:
        case VoxelType::float32:
            return 4;
        case VoxelType::int64:
        case VoxelType::uint64:
        case VoxelType::float64:
            return 8;
    }
    return 8;
}

std::size_t VoxelLayout::byte_count() const {
    return static_cast<std::size_t>(nodes[0]) * static_cast<std::size_t>(nodes[1]) *
           static_cast<std::size_t>(nodes[2]) * bytes_of(type);
}

std::size_t VoxelLayout::most_padding() const {
    const std::size_t slice = byte_count() / static_cast<std::size_t>(nodes[2]);
    return std::max<std::size_t>(slice, 4096) - 1;
}

void refuse_surplus(const fs::path& file, const VoxelLayout& layout) {
    refuse(file, "its header promises " + std::to_string(layout.byte_count()) +
                     " bytes of numbers, but there are more: part of the volume would be left out");
}

void check_layout(const fs::path& file, const VoxelLayout& layout, double max_megabytes) {
    std::int64_t count = 1;
    for (const std::int64_t n : layout.nodes) {
        if (n < 2) {
            throw ReadError(file, "one of its axes has " + std::to_string(n) + " nodes, so it is not a volume",
                            "export the whole volume, not a slice");
        }
        if (n > most_nodes / count) throw ReadError(file, "it has more voxels than 512 x 512 x 512", "resample it");
        count *= n;
    }
    if (static_cast<double>(layout.byte_count()) > 1e6 * max_megabytes) {
        throw ReadError(file, "its numbers need more than the limit", "reduce the volume or raise --max-megabytes");
    }
}

void check_geometry(const fs::path& file, const Volume& volume) {
    const auto& [a, b, c] = volume.step;
    const double spanned = std::abs(dot(a, cross(b, c))), box = norm(a) * norm(b) * norm(c);
    const bool finite = std::isfinite(dot(volume.origin, volume.origin)) && std::isfinite(box);
    if (!finite || !(spanned > 1e-6 * box)) {
        throw ReadError(file, "its axes or spacings are zero, not finite or do not span space",
                        "correct them in the program that wrote the file");
    }
}

void decode(const std::string& bytes, const VoxelLayout& layout, Volume& volume) {
    const bool swapped = layout.big_endian != (std::endian::native == std::endian::big);
    for (int a = 0; a < 3; ++a) volume.nodes[a] = static_cast<int>(layout.nodes[a]);
    auto& values = volume.values;
    values.resize(bytes.size() / bytes_of(layout.type));
    switch (layout.type) {
        case VoxelType::int8:
            return decode_as<std::int8_t>(bytes, swapped, values);
        case VoxelType::uint8:
            return decode_as<std::uint8_t>(bytes, swapped, values);
        case VoxelType::int16:
            return decode_as<std::int16_t>(bytes, swapped, values);
        case VoxelType::uint16:
            return decode_as<std::uint16_t>(bytes, swapped, values);
        case VoxelType::int32:
            return decode_as<std::int32_t>(bytes, swapped, values);
        case VoxelType::uint32:
            return decode_as<std::uint32_t>(bytes, swapped, values);
        case VoxelType::int64:
            return decode_as<std::int64_t>(bytes, swapped, values);
        case VoxelType::uint64:
            return decode_as<std::uint64_t>(bytes, swapped, values);
        case VoxelType::float32:
            return decode_as<float>(bytes, swapped, values);
        case VoxelType::float64:
            return decode_as<double>(bytes, swapped, values);
    }
}

namespace {

/// Exactly count bytes, and behind them at most so many more.
std::string bytes_between(const fs::path& file, std::size_t offset, std::size_t count, std::size_t most_more,
                          bool is_header) {
    const std::unique_ptr<gzFile_s, int (*)(gzFile)> in(gzopen(file.c_str(), "rb"), gzclose);
    if (!in) throw ReadError(file, "it cannot be read", "check the path and its permissions");
    const auto breaks_off = [&](std::size_t held) {
        if (is_header) refuse(file, "it breaks off within its header");
        refuse(file, "its header promises " + std::to_string(count) + " bytes of numbers, but there are only " +
                         std::to_string(held));
    };
    // Before memory is asked for: what the file can hold at best.
    std::error_code error;
    const std::size_t size = fs::file_size(file, error);
    if (!error && size == 0) refuse(file, "the file is empty");
    const std::size_t at_most = gzdirect(in.get()) != 0 ? size : best_compression * size;
    if (at_most < offset + count) breaks_off(at_most > offset ? at_most - offset : 0);
    std::string result(count + most_more, '\0');
    if (gzseek(in.get(), static_cast<z_off_t>(offset), SEEK_SET) < 0) breaks_off(0);
    std::size_t done = 0;
    while (done < result.size()) {
        const auto step = static_cast<unsigned>(std::min<std::size_t>(result.size() - done, 1U << 30));
        interruption_point();
        const int got = gzread(in.get(), result.data() + done, step);
        if (got <= 0) break;
        done += static_cast<std::size_t>(got);
    }
    if (done < count) breaks_off(done);
    result.resize(done);
    return result;
}

}  // namespace

std::string bytes_from(const fs::path& file, std::size_t offset, std::size_t count, bool is_header) {
    return bytes_between(file, offset, count, 0, is_header);
}

std::string numbers_from(const fs::path& file, std::size_t offset, const VoxelLayout& layout) {
    const std::size_t count = layout.byte_count(), most = layout.most_padding();
    std::string result = bytes_between(file, offset, count, most + 1, false);
    if (result.size() > count + most) refuse_surplus(file, layout);
    result.resize(count);
    return result;
}

std::string inflated(const fs::path& file, std::string_view stream, std::size_t skipped, const VoxelLayout& layout) {
    const std::size_t count = skipped + layout.byte_count(), most = layout.most_padding();
    if (best_compression * stream.size() < count) {
        refuse(file, "its header promises " + std::to_string(count) + " bytes of numbers, far more than its " +
                         std::to_string(stream.size()) + " packed bytes can hold");
    }
    std::string result(count + most + 1, '\0');
    z_stream zip{};
    constexpr int any_header = 15 + 32;  // zlib or gzip, told by its first bytes
    if (inflateInit2(&zip, any_header) != Z_OK) refuse(file, "it cannot be unpacked");
    // Volumes have at most 512^3 numbers of 8 bytes: 2^30, within an unsigned int.
    zip.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(stream.data()));
    zip.avail_in = static_cast<unsigned>(std::min<std::size_t>(stream.size(), 0xffffffffU));
    zip.next_out = reinterpret_cast<Bytef*>(result.data());
    zip.avail_out = static_cast<unsigned>(result.size());
    const int state = inflate(&zip, Z_FINISH);
    const std::size_t held = result.size() - zip.avail_out;
    inflateEnd(&zip);
    if (held < count || (state != Z_STREAM_END && state != Z_BUF_ERROR && state != Z_OK)) {
        refuse(file, "its header promises " + std::to_string(count) + " bytes of numbers, but only " +
                         std::to_string(held) + " can be unpacked");
    }
    if (held > count + most) refuse_surplus(file, layout);
    return result.substr(skipped, layout.byte_count());
}

VolumeSurface surface_of(const fs::path& file, Volume& volume, const std::string& isovalue, const std::string& inside) {
    float low = INFINITY, high = -INFINITY;
    std::size_t unknown = 0;
    for (const float v : volume.values) {
        if (!std::isfinite(v)) {
            ++unknown;
            continue;
        }
        low = std::min(low, v);
        high = std::max(high, v);
    }
    if (unknown == volume.values.size()) refuse(file, "none of its values is a finite number");
    if (unknown > 0) {
        volume.notes.push_back(std::to_string(unknown) + " voxels without a finite number count as outside.");
        for (float& v : volume.values) v = std::isfinite(v) ? v : NAN;
    }
    float iso = chosen_isovalue(file, volume, isovalue, low, high);
    if (inside == "below") {
        for (float& v : volume.values) v = -v;
        iso = -iso;
        std::tie(low, high) = std::pair(-high, -low);
    } else if (inside == "auto") {
        if (const double share = share_of_border(volume, iso); share > most_border) {
            char text[160];
            std::snprintf(text, sizeof text,
                          "%.0f %% of its border is above the surface's value %g, so it seems to be the background "
                          "that is above it",
                          100.0 * share, iso);
            throw ReadError(file, text, "say --inside below; or --inside above, if the object fills the whole volume");
        }
    }

    // Only the part around the object, with a margin that is outside.
    std::array<int, 3> first = volume.nodes, last{-1, -1, -1};
    const auto index = [&](int i, int j, int k) {
        return static_cast<std::size_t>(i) +
               static_cast<std::size_t>(volume.nodes[0]) *
                   (static_cast<std::size_t>(j) +
                    static_cast<std::size_t>(volume.nodes[1]) * static_cast<std::size_t>(k));
    };
    for (int k = 0; k < volume.nodes[2]; ++k) {
        interruption_point();
        for (int j = 0; j < volume.nodes[1]; ++j) {
            for (int i = 0; i < volume.nodes[0]; ++i) {
                if (!(volume.values[index(i, j, k)] > iso)) continue;
                const std::array<int, 3> node{i, j, k};
                for (int a = 0; a < 3; ++a) {
                    first[a] = std::min(first[a], node[a]);
                    last[a] = std::max(last[a], node[a]);
                }
            }
        }
    }
    Lattice lattice;
    bool is_cut = false;
    for (int a = 0; a < 3; ++a) {
        lattice.origin[a] = first[a] - 2;
        lattice.nodes[a] = last[a] - first[a] + 5;
        is_cut |= first[a] == 0 || last[a] == volume.nodes[a] - 1;
    }
    if (is_cut) volume.notes.emplace_back("It reaches the border of the volume and was cut off flat there.");
    const float range = std::max(high - iso, iso - low);
    constexpr float band = 3.0F;  // what isosurface keeps of the values on either side
    std::vector<float> values(lattice.node_count());
    for (int k = 0; k < lattice.nodes[2]; ++k) {
        interruption_point();
        for (int j = 0; j < lattice.nodes[1]; ++j) {
            for (int i = 0; i < lattice.nodes[0]; ++i) {
                const std::array<int, 3> node{i + first[0] - 2, j + first[1] - 2, k + first[2] - 2};
                bool is_in = true;
                for (int a = 0; a < 3; ++a) is_in &= node[a] >= 0 && node[a] < volume.nodes[a];
                float v = is_in ? volume.values[index(node[0], node[1], node[2])] : low;
                if (std::isnan(v)) v = low;
                values[lattice.index(i, j, k)] = band * (v - iso) / range;
            }
        }
    }
    VolumeSurface result{isosurface(lattice, values), {}};
    TriangleMesh& mesh = result.mesh;
    if (is_cut) {
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            const auto c = mesh.corners(t);
            const Vector3 centre = (1.0 / 3.0) * (c[0] + c[1] + c[2]);
            bool beyond = false;
            for (int a = 0; a < 3; ++a) beyond |= centre[a] < 0 || centre[a] > volume.nodes[a] - 1;
            if (!beyond) result.seen.triangles.push_back(mesh.triangles[t]);
        }
    }
    for (auto& p : mesh.points) {
        p = volume.origin + p[0] * volume.step[0] + p[1] * volume.step[1] + p[2] * volume.step[2];
    }
    if (dot(volume.step[0], cross(volume.step[1], volume.step[2])) < 0) {
        turn_inside_out(mesh);
    }
    if (is_cut) result.seen.points = mesh.points;
    return result;
}

bool is_volume(const fs::path& file) {
    constexpr std::array<std::string_view, 6> endings{".nii", ".nii.gz", ".nrrd", ".nhdr", ".mhd", ".mha"};
    return std::find(endings.begin(), endings.end(), ending_of(file)) != endings.end();
}

Volume read_volume(const fs::path& file, double max_megabytes) {
    const std::string ending = ending_of(file);
    if (ending == ".nii" || ending == ".nii.gz") return read_nifti(file, max_megabytes);
    if (ending == ".nrrd" || ending == ".nhdr") return read_nrrd(file, max_megabytes);
    return read_metaimage(file, max_megabytes);
}

}  // namespace morphodesic::datasets

#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/triangle_mesh.h"

/// Volumes: numbers at the nodes of a regular grid in space, as scanners and segmentations give them.
namespace morphodesic::datasets {

struct Volume {
    std::array<int, 3> nodes{};      ///< per axis, >= 2
    Vector3 origin{};                ///< position of node (0, 0, 0), millimetres
    std::array<Vector3, 3> step{};   ///< from a node to the next along each axis, millimetres; may be oblique
    std::vector<float> values;       ///< [N], axis 0 runs fastest; NaN where nothing is known
    std::vector<std::string> notes;  ///< what a user should know, one sentence each
};

/// Kinds of numbers in a file.
enum class VoxelType { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };
std::size_t bytes_of(VoxelType type);

/// What the header of a file says of its numbers, checked before any memory is asked for.
struct VoxelLayout {
    std::array<std::int64_t, 3> nodes{};
    VoxelType type = VoxelType::float32;
    bool big_endian = false;
    [[nodiscard]] std::size_t byte_count() const;
    /// Bytes behind the numbers that may be padding. More of them are numbers that the header says nothing of.
    [[nodiscard]] std::size_t most_padding() const;
};

/// @throws ReadError if an axis has fewer than two nodes, if there are more than 512^3 of them, or if they need more
/// than max_megabytes
void check_layout(const std::filesystem::path& file, const VoxelLayout& layout, double max_megabytes);

/// @throws ReadError if the steps are not finite or do not span space
void check_geometry(const std::filesystem::path& file, const Volume& volume);

/// Numbers from bytes [layout.byte_count()], and the nodes into the volume.
void decode(const std::string& bytes, const VoxelLayout& layout, Volume& volume);

/// Exactly so many bytes of a file from an offset on; if it is compressed by gzip, of its content.
/// @param is_header  for the message
/// @throws ReadError if it holds fewer
std::string bytes_from(const std::filesystem::path& file, std::size_t offset, std::size_t count,
                       bool is_header = false);

/// The numbers from an offset on, as bytes_from.
/// @throws ReadError if there are fewer, or more than padding explains
std::string numbers_from(const std::filesystem::path& file, std::size_t offset, const VoxelLayout& layout);

/// The numbers out of a zlib or gzip stream, behind so many bytes that are skipped.
/// @throws ReadError if the stream is damaged, holds fewer, or more than padding explains
std::string inflated(const std::filesystem::path& file, std::string_view stream, std::size_t skipped,
                     const VoxelLayout& layout);

/// @throws ReadError  the header promises fewer numbers than there are
[[noreturn]] void refuse_surplus(const std::filesystem::path& file, const VoxelLayout& layout);

/// A closed surface, and what of it is not the flat cut at the border of the volume.
struct VolumeSurface {
    TriangleMesh mesh;
    TriangleMesh seen;  ///< without the cut; no triangles if nothing is cut off
};
/// Closed surface of {value > isovalue}; where the object reaches the border of the volume it is cut off flat.
/// @param isovalue  a number, or "auto": midway for masks (two values) and for shares between 0 and 1
/// @param inside    above, below (the isovalue), or auto: above, if the border of the volume does not contradict
/// @throws ReadError if auto cannot know the value or the side, or no surface has it
VolumeSurface surface_of(const std::filesystem::path& file, Volume& volume, const std::string& isovalue,
                         const std::string& inside = "auto");

/// True for the volumes read here: .nii, .nii.gz, .nrrd, .nhdr, .mhd, .mha.
bool is_volume(const std::filesystem::path& file);
/// @throws ReadError
Volume read_volume(const std::filesystem::path& file, double max_megabytes);

}  // namespace morphodesic::datasets

#include "datasets/nifti_reader.h"

#include <nifti/nifti2_io.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <memory>

#include "datasets/read_error.h"

namespace morphodesic::datasets {
namespace {

namespace fs = std::filesystem;

/// A field of the header, in the machine's byte order.
template <class T>
T field(const std::string& header, std::size_t offset, bool swapped) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, header.data() + offset, sizeof(T));
    if (swapped) std::reverse(bytes, bytes + sizeof(T));
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return value;
}

struct Header {
    VoxelLayout layout;
    std::size_t offset = 0;  ///< of the numbers
};

VoxelType voxel_type(const fs::path& file, int code) {
    switch (code) {
        case DT_INT8:
            return VoxelType::int8;
        case DT_UINT8:
            return VoxelType::uint8;
        case DT_INT16:
            return VoxelType::int16;
        case DT_UINT16:
            return VoxelType::uint16;
        case DT_INT32:
            return VoxelType::int32;
        case DT_UINT32:
            return VoxelType::uint32;
        case DT_INT64:
            return VoxelType::int64;
        case DT_UINT64:
            return VoxelType::uint64;
        case DT_FLOAT32:
            return VoxelType::float32;
        case DT_FLOAT64:
            return VoxelType::float64;
        default:
            throw ReadError(file, "its numbers are of NIfTI's kind " + std::to_string(code) + " (colours, complex)",
                            "save it as integers or floats");
    }
}

template <class Struct, class Dim>
Header checked(const fs::path& file, const std::string& bytes, bool swapped, std::size_t dim_at, std::size_t type_at,
               std::size_t bits_at, double offset) {
    Header header;
    std::array<std::int64_t, 8> dim{};
    for (std::size_t a = 0; a < dim.size(); ++a) dim[a] = field<Dim>(bytes, dim_at + a * sizeof(Dim), swapped);
    if (dim[0] < 3 || dim[0] > 7) {
        throw ReadError(file, "it says that it has " + std::to_string(dim[0]) + " axes, not three",
                        "export one volume of three axes");
    }
    for (int a = 0; a < 3; ++a) header.layout.nodes[a] = dim[a + 1];
    for (int a = 4; a <= dim[0]; ++a) {
        if (dim[a] > 1) {
            throw ReadError(file, "it holds a series of " + std::to_string(dim[a]) + " volumes",
                            "save the volume that is meant to a file of its own");
        }
    }
    header.layout.type = voxel_type(file, field<std::int16_t>(bytes, type_at, swapped));
    header.layout.big_endian = swapped == (std::endian::native == std::endian::little);
    const int bits = field<std::int16_t>(bytes, bits_at, swapped);
    if (bits != 8 * static_cast<int>(bytes_of(header.layout.type))) {
        refuse(file, "its header contradicts itself: " + std::to_string(bits) + " bits a number");
    }
    if (!(offset >= static_cast<double>(sizeof(Struct)) && offset < 1e9)) {
        refuse(file, "its header names no place for the numbers behind it");
    }
    header.offset = static_cast<std::size_t>(offset);
    return header;
}

Header checked_header(const fs::path& file) {
    const std::string size_field = bytes_from(file, 0, sizeof(std::int32_t), true);
    const auto size = field<std::int32_t>(size_field, 0, false), other = field<std::int32_t>(size_field, 0, true);
    constexpr int size_1 = sizeof(nifti_1_header), size_2 = sizeof(nifti_2_header);
    const bool swapped = other == size_1 || other == size_2;
    const int version = size == size_1 || other == size_1 ? 1 : size == size_2 || other == size_2 ? 2 : 0;
    if (version == 0) refuse(file, "it does not begin like a NIfTI file");
    const std::string bytes = bytes_from(file, 0, version == 1 ? size_1 : size_2, true);
    const std::string magic =
        bytes.substr(version == 1 ? offsetof(nifti_1_header, magic) : offsetof(nifti_2_header, magic), 3);
    if (magic != (version == 1 ? "n+1" : "n+2")) {
        throw ReadError(file, "it is not a NIfTI file of one piece (its mark is missing)",
                        "save it as .nii or .nii.gz with header and numbers in one file");
    }
    if (version == 1) {
        return checked<nifti_1_header, std::int16_t>(
            file, bytes, swapped, offsetof(nifti_1_header, dim), offsetof(nifti_1_header, datatype),
            offsetof(nifti_1_header, bitpix), field<float>(bytes, offsetof(nifti_1_header, vox_offset), swapped));
    }
    return checked<nifti_2_header, std::int64_t>(
        file, bytes, swapped, offsetof(nifti_2_header, dim), offsetof(nifti_2_header, datatype),
        offsetof(nifti_2_header, bitpix),
        static_cast<double>(field<std::int64_t>(bytes, offsetof(nifti_2_header, vox_offset), swapped)));
}

double millimetres(int unit) {
    return unit == NIFTI_UNITS_METER ? 1000.0 : unit == NIFTI_UNITS_MICRON ? 0.001 : 1.0;
}

}  // namespace

Volume read_nifti(const fs::path& file, double max_megabytes) {
    const Header header = checked_header(file);
    check_layout(file, header.layout, max_megabytes);
    nifti_set_debug_level(0);  // its messages would go to the terminal
    const std::unique_ptr<nifti_image, void (*)(nifti_image*)> image(nifti_image_read(file.c_str(), 0),
                                                                     nifti_image_free);
    if (!image) refuse(file, "its header cannot be understood");
    Volume volume;
    const double unit = millimetres(image->xyz_units);
    if (image->sform_code > 0 || image->qform_code > 0) {
        const auto& m = image->sform_code > 0 ? image->sto_xyz.m : image->qto_xyz.m;
        for (int row = 0; row < 3; ++row) {
            for (int a = 0; a < 3; ++a) volume.step[a][row] = unit * m[row][a];
            volume.origin[row] = unit * m[row][3];
        }
    } else {
        const std::array<double, 3> spacing{image->dx, image->dy, image->dz};
        for (int a = 0; a < 3; ++a) volume.step[a][a] = unit * std::abs(spacing[a]);
        volume.notes.emplace_back("The file does not say where its axes point: it may be a mirror image.");
    }
    check_geometry(file, volume);
    decode(numbers_from(file, header.offset, header.layout), header.layout, volume);
    const double slope = image->scl_slope, shift = image->scl_inter;
    if (std::isfinite(slope) && std::isfinite(shift) && slope != 0.0 && (slope != 1.0 || shift != 0.0)) {
        for (float& v : volume.values) v = static_cast<float>(slope * v + shift);
    }
    return volume;
}

}  // namespace morphodesic::datasets

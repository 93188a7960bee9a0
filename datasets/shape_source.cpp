#include "datasets/shape_source.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>

#include "datasets/read_error.h"
#include "datasets/text_scan.h"

namespace morphodesic::datasets {

namespace {

constexpr std::array<std::string_view, 14> image_endings = {".png",  ".jpg", ".jpeg", ".jpe", ".bmp", ".dib",  ".tif",
                                                            ".tiff", ".pgm", ".pbm",  ".ppm", ".pnm", ".webp", ".gif"};
constexpr std::array<std::string_view, 13> solid_endings = {".ply", ".obj",    ".stl",  ".off",  ".pcd", ".xyz", ".vdb",
                                                            ".nii", ".nii.gz", ".nrrd", ".nhdr", ".mhd", ".mha"};

int dimension_by_content(std::string_view head) {
    using namespace std::string_view_literals;
    const auto begins = [&](std::string_view magic) { return head.starts_with(magic); };
    if (begins("\x89PNG\r\n\x1a\n"sv) || begins("\xff\xd8\xff"sv) || begins("GIF87a"sv) || begins("GIF89a"sv) ||
        begins("II*\0"sv) || begins("MM\0*"sv) ||
        (begins("RIFF"sv) && head.size() >= 12 && head.substr(8, 4) == "WEBP"sv)) {
        return 2;
    }
    if (begins("ply\n"sv) || begins("ply\r"sv) || begins("OFF\n"sv) || begins("OFF\r"sv)) return 3;
    return 0;
}

}  // namespace

std::string ending_of(const std::filesystem::path& file) {
    std::string ending = lower_case(file.extension().string());
    if (ending == ".gz" && ending_of(file.stem()) == ".nii") ending = ".nii.gz";
    return ending;
}

int shape_dimension(const std::filesystem::path& file) {
    const std::string ending = ending_of(file);
    int by_ending = 0;
    if (std::find(image_endings.begin(), image_endings.end(), ending) != image_endings.end()) by_ending = 2;
    if (std::find(solid_endings.begin(), solid_endings.end(), ending) != solid_endings.end()) by_ending = 3;
    // A wrong ending among those of shapes, or none at all; every other ending says that the file is something else.
    if (by_ending == 0 && !ending.empty()) return 0;
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) return by_ending;  // opening a pipe would wait for its writer
    std::array<char, 16> head{};
    std::ifstream in(file, std::ios::binary);
    in.read(head.data(), head.size());
    const int by_content = dimension_by_content({head.data(), static_cast<std::size_t>(in.gcount())});
    return by_content != 0 ? by_content : by_ending;
}

ShapeSource single_source(const std::filesystem::path& file) {
    std::error_code error;
    if (!std::filesystem::exists(file, error)) throw ReadError(file, "there is no such file", "check the path");
    if (!std::filesystem::is_regular_file(file, error)) {
        throw ReadError(file, "this is not a file", "name one image, mesh, point cloud or volume");
    }
    ShapeSource source;
    source.path = file;
    source.name = file.filename().string();
    source.dimension = shape_dimension(file);
    if (source.dimension == 0) {
        throw ReadError(
            file, "this is not a kind of file that holds a shape",
            "use an image (PNG, JPEG, BMP, TIFF, PNM, WebP, GIF) or a solid (PLY, OBJ, STL, OFF, PCD, XYZ, VDB, NIfTI, "
            "NRRD, MHD)");
    }
    const std::filesystem::path mask = file.parent_path() / (file.stem().string() + ".mask.png");
    if (std::filesystem::is_regular_file(mask, error)) source.mask_path = mask;
    return source;
}

}  // namespace morphodesic::datasets

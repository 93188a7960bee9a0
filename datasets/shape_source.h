#pragma once

#include <filesystem>
#include <string>

namespace morphodesic::datasets {

/// A file that holds one shape, as found by scan_folder.
struct ShapeSource {
    std::filesystem::path path;       ///< where the file is
    std::string name;                 ///< path relative to the collection's folder, with '/'; unique in a collection
    std::string label;                ///< class label; empty if unknown
    int dimension = 2;                ///< 2: an image, 3: a mesh, point cloud or volume
    std::filesystem::path mask_path;  ///< name.mask.png beside the file (white = hidden); empty if there is none
};

/// The ending of a file's name in small letters, with its dot, ".nii.gz" as one; empty if there is none.
std::string ending_of(const std::filesystem::path& file);

/// 2 or 3 by the beginning of the file (PNG, JPEG, ..., PLY, OFF), else by the name's ending; 0 if neither tells a
/// shape. A file that cannot be opened is judged by its ending.
int shape_dimension(const std::filesystem::path& file);

/// A source for one file outside any collection: named by its file name, no label, mask found beside it.
/// @throws ReadError if there is no such file or if it is not a shape
ShapeSource single_source(const std::filesystem::path& file);

}  // namespace morphodesic::datasets

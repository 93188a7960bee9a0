#include "datasets/collection_folder.h"

#include <algorithm>
#include <cmath>
#include <fstream>

#include "datasets/image_pixels.h"
#include "datasets/read_error.h"

namespace morphodesic::datasets {

namespace fs = std::filesystem;

namespace {

/// Whether a file or folder is another folder or lies below it, links followed.
bool lies_in(const fs::path& inner, const fs::path& outer) {
    const fs::path below = fs::weakly_canonical(inner), above = fs::weakly_canonical(outer);
    return std::mismatch(above.begin(), above.end(), below.begin(), below.end()).first == above.end();
}

/// The folder that a source's name is relative to.
fs::path folder_of(const ShapeSource& source) {
    fs::path folder = fs::absolute(source.path);
    for (const fs::path& part : fs::path(source.name)) {
        static_cast<void>(part);
        folder = folder.parent_path();
    }
    return folder;
}

}  // namespace

void prepare_collection_folder(const fs::path& folder, const std::set<std::string>& names) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (!fs::is_directory(folder)) throw WriteError(folder);
    std::string table;  // that belongs to shapes
    bool known_shapes = false;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        if (name == "labels.csv" || name == "parameters.csv" || name == "truth.csv") table = name;
        known_shapes = known_shapes || names.contains(name);
        if (entry.is_regular_file(error) && shape_dimension(entry.path()) != 0 && !names.contains(name)) {
            throw ReadError(folder, "the folder holds another shape (" + name + ")", "name a new or an empty folder");
        }
    }
    if (!table.empty() && !known_shapes) {
        throw ReadError(folder, "the folder holds a " + table + " of something else", "name a new or an empty folder");
    }
}

void keep_apart_from(const std::vector<ShapeSource>& sources, const fs::path& folder) {
    for (const ShapeSource& source : sources) {
        if (!lies_in(folder, folder_of(source)) && !lies_in(source.path, folder)) continue;
        throw ReadError(folder, "it would hold the shapes and what is made from them (" + source.path.string() + ")",
                        "name a folder beside that of the shapes");
    }
}

void write_coverage(const fs::path& file, const Coverage& coverage, bool black_on_white) {
    PixelImage image{coverage.width, coverage.height, 1, 255.0, std::vector<std::uint16_t>(coverage.values.size())};
    for (std::size_t p = 0; p < coverage.values.size(); ++p) {
        const double tone = black_on_white ? 1.0 - coverage.values[p] : coverage.values[p];
        image.values[p] = static_cast<std::uint16_t>(std::lround(255.0 * tone));
    }
    write_png(file, image);
}

void write_text_file(const fs::path& file, const std::string& text) {
    std::ofstream out(file, std::ios::binary);
    out << text;
    out.close();
    if (!out) throw WriteError(file);
}

}  // namespace morphodesic::datasets

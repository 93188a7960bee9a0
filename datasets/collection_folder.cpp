#include "datasets/collection_folder.h"

#include <cmath>
#include <fstream>

#include "datasets/image_pixels.h"
#include "datasets/read_error.h"
#include "datasets/shape_source.h"

namespace morphodesic::datasets {

namespace fs = std::filesystem;

void prepare_collection_folder(const fs::path& folder, const std::set<std::string>& names) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (!fs::is_directory(folder)) throw WriteError(folder);
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        if (entry.is_regular_file(error) && shape_dimension(entry.path()) != 0 && !names.contains(name)) {
            throw ReadError(folder, "the folder holds another shape (" + name + ")", "name a new or an empty folder");
        }
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

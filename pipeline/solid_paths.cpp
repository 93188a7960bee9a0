#include "pipeline/solid_paths.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>

#include "datasets/read_error.h"
#include "datasets/vdb_files.h"
#include "pipeline/colour_map.h"

namespace morphodesic::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr const char* mark_file = "solids.key";

RgbaImage to_rgba(const datasets::PixelImage& image) {
    RgbaImage result(image.width, image.height);
    for (std::size_t i = 0; i < result.pixels.size(); ++i) {
        result.pixels[i] = static_cast<unsigned char>(std::min<int>(image.values[i], 255));
    }
    return result;
}

/// One picture on top of the other, of equal width, with a gap.
RgbaImage stacked(const RgbaImage& top, const RgbaImage& bottom, int gap) {
    RgbaImage result(top.width, top.height + gap + bottom.height);
    std::copy(top.pixels.begin(), top.pixels.end(), result.pixels.begin());
    std::copy(bottom.pixels.begin(), bottom.pixels.end(),
              result.pixels.end() - static_cast<std::ptrdiff_t>(bottom.pixels.size()));
    return result;
}

/// The slice as it is seen from the camera's side.
datasets::PixelImage seen_from(const datasets::View& camera, int slice_axis, datasets::PixelImage slice) {
    // The camera's right is up x from; the slice has the axis that is neither up nor across to the right.
    const int right = 3 - camera.up_axis - slice_axis;
    const double azimuth = camera.azimuth * std::numbers::pi / 180.0;
    const double to_the_right = right == (camera.up_axis + 1) % 3 ? -std::sin(azimuth) : std::cos(azimuth);
    if (to_the_right >= 0) return slice;
    const auto channels = static_cast<std::ptrdiff_t>(slice.channels);
    for (int row = 0; row < slice.height; ++row) {
        auto* first = slice.values.data() + static_cast<std::ptrdiff_t>(row) * slice.width * channels;
        for (std::ptrdiff_t i = 0, j = slice.width - 1; i < j; ++i, --j) {
            std::swap_ranges(first + i * channels, first + (i + 1) * channels, first + j * channels);
        }
    }
    return slice;
}

datasets::View sized(datasets::View view, int pixels) {
    view.width = view.height = pixels;
    return view;
}

datasets::ColourRange dissipation_range(double high) {
    return {0.0, high, [](double t) {
                const Colour c = dissipation_colour(t);
                return std::array<double, 3>{c[0] / 255.0, c[1] / 255.0, c[2] / 255.0};
            }};
}

std::string key_in(const fs::path& folder) {
    std::ifstream in(folder / mark_file);
    std::string key;
    std::getline(in, key);
    return key;
}

}  // namespace

RgbaImage shaded_picture(const LevelSet<3>& u, const datasets::View& camera, const ScalarField<3>* rate, double high) {
    return to_rgba(datasets::shaded_view(u, camera, rate, dissipation_range(high)));
}

template <>
RgbaImage shape_picture<3>(const LevelSet<3>& u, int pixels, const SolidView& view) {
    return shaded_picture(u, sized(view.camera, pixels));
}

template <>
PathPictures path_pictures<3>(const GeodesicResult<3>& path, int pixels, const SolidView& view) {
    const std::vector<ScalarField<3>> rates = dissipation_of_frames(path);
    PathPictures pictures;
    pictures.highest = upper_end<3>(std::span(rates).first(path.deformations.size()), path.shapes);
    const datasets::ColourRange range = dissipation_range(pictures.highest);
    for (std::size_t k = 0; k < rates.size(); ++k) {
        const RgbaImage solid = shaded_picture(path.shapes[k], sized(view.camera, pixels), &rates[k], pictures.highest);
        const auto slice =
            seen_from(view.camera, view.slice_axis,
                      datasets::slice_picture(path.shapes[k], view.slice_axis, 0.5, pixels, &rates[k], range,
                                              view.camera.up_axis, datasets::view_radius(view.camera)));
        pictures.frames.push_back(stacked(solid, to_rgba(slice), 4));
    }
    return pictures;
}

SolidView view_of_study(const ResultStore& store, const std::vector<StoredShape>& shapes) {
    std::vector<std::string> files;
    for (const StoredShape& shape : shapes) files.push_back(shape.name);
    datasets::CommonView common(datasets::up_axis_by_custom(files));
    constexpr std::size_t looked_at = 30;  // spread over the collection
    const std::size_t stride = std::max<std::size_t>(1, shapes.size() / looked_at);
    for (std::size_t i = 0; i < shapes.size(); i += stride) {
        if (shapes[i].dimension == 3) common.add(store.level_set<3>(shapes[i].content_digest));
    }
    return {common.view(), common.slice_axis()};
}

SolidView view_of_path(const GeodesicResult<3>& path, const std::vector<std::string>& files) {
    datasets::CommonView common(datasets::up_axis_by_custom(files));
    for (const LevelSet<3>& shape : path.shapes) common.add(shape);
    return {common.view(), common.slice_axis()};
}

std::string key_of(const SolidView& view) {
    char text[96];
    std::snprintf(text, sizeof text, "up %d azimuth %.3f elevation %.3f slice %d", view.camera.up_axis,
                  view.camera.azimuth, view.camera.elevation, view.slice_axis);
    return text;
}

std::vector<std::string> write_path_solids(const StudyFolder& folder, const fs::path& below,
                                           const GeodesicResult<3>& path) {
    const std::vector<ScalarField<3>> rates = dissipation_of_frames(path);
    std::error_code ignored;
    fs::create_directories(folder.path() / below, ignored);
    std::vector<std::string> names;
    try {
        for (std::size_t k = 0; k < path.shapes.size(); ++k) {
            std::vector<datasets::NamedField> fields;
            if (k < rates.size()) fields.push_back({"dissipation", &rates[k]});
            char name[32];
            std::snprintf(name, sizeof name, "step-%02zu", k);
            const std::string stem = (below / name).generic_string();
            datasets::write_vdb(folder.path() / (stem + ".vdb"), path.shapes[k], fields);
            datasets::write_ply(folder.path() / (stem + ".ply"), path.shapes[k], fields);
            names.push_back(stem + ".vdb");
            names.push_back(stem + ".ply");
        }
    } catch (const datasets::WriteError&) {
        throw StoreError(folder.path() / below,
                         "the solids of a path cannot be written; free some space and check the permissions, then give "
                         "the same command again");
    }
    return names;
}

KeptSolids::KeptSolids(const StudyFolder& folder) : folder_(folder), aside_(folder.path() / "paths.old") {
    std::error_code ignored;
    fs::remove_all(aside_, ignored);
    fs::rename(folder_.paths(), aside_, ignored);
    fs::remove_all(folder_.paths(), ignored);  // if the folder could not be moved
}

KeptSolids::~KeptSolids() {
    std::error_code ignored;
    fs::remove_all(aside_, ignored);
}

bool KeptSolids::take(const std::string& key, const fs::path& below) const {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(aside_, error)) {
        if (!entry.is_directory(error) || key_in(entry.path()) != key) continue;
        const fs::path target = folder_.path() / below;
        fs::create_directories(target, error);
        std::vector<fs::path> files;
        for (const auto& file : fs::directory_iterator(entry.path(), error)) {
            const std::string ending = file.path().extension().string();
            if (ending == ".vdb" || ending == ".ply") files.push_back(file.path());
        }
        for (const fs::path& file : files) {
            fs::rename(file, target / file.filename(), error);
            if (error) return false;
        }
        if (files.empty()) return false;
        mark(key, below);
        return true;
    }
    return false;
}

void KeptSolids::mark(const std::string& key, const fs::path& below) const {
    folder_.write(below / mark_file, key + "\n");
}

}  // namespace morphodesic::pipeline

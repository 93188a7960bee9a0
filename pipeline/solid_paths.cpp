#include "pipeline/solid_paths.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <numeric>
#include <optional>

#include "datasets/read_error.h"
#include "datasets/vdb_files.h"
#include "pipeline/colour_map.h"
#include "pipeline/common_frame.h"
#include "pipeline/path_files.h"

namespace morphodesic::pipeline {
namespace {

namespace fs = std::filesystem;

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

/// Turns one axis of the cube into another by renaming all three in turn.
datasets::Rotation axis_turn(int from, int to) {
    datasets::Rotation turn{};
    for (int a = 0; a < 3; ++a) turn[static_cast<std::size_t>(3 * ((a + to - from + 3) % 3) + a)] = 1.0;
    return turn;
}

datasets::Rotation turn_about(int axis, double degrees) {
    const auto u = static_cast<std::size_t>(axis), a = (u + 1) % 3, b = (u + 2) % 3;
    const double angle = degrees * std::numbers::pi / 180.0;
    datasets::Rotation turn{};
    turn[3 * u + u] = 1.0;
    turn[3 * a + a] = turn[3 * b + b] = std::cos(angle);
    turn[3 * b + a] = std::sin(angle);
    turn[3 * a + b] = -turn[3 * b + a];
    return turn;
}

/// The folders of paths in a folder. Links are none: what they lead to is not the program's.
std::vector<fs::path> path_folders_in(const fs::path& folder) {
    std::vector<fs::path> found;
    std::error_code error;
    fs::directory_iterator it(folder, error);
    for (; !error && it != fs::directory_iterator(); it.increment(error)) {
        std::error_code ignored;
        const bool real = fs::is_directory(it->symlink_status(ignored));
        if (real && is_path_folder(it->path().filename().string())) found.push_back(it->path());
    }
    return found;
}

/// Calls f with every file in the folder of a path that the program wrote; then removes the folder if nothing else is
/// in it.
template <class F>
void empty_path_folder(const fs::path& folder, const F& f) {
    std::vector<fs::path> files;
    std::error_code error;
    fs::directory_iterator it(folder, error);
    for (; !error && it != fs::directory_iterator(); it.increment(error)) {
        if (is_path_file(it->path().filename())) files.push_back(it->path());
    }
    for (const fs::path& file : files) f(file);
    fs::remove(folder, error);
}

/// Removes the paths in a folder, and the folder if nothing else is in it.
void remove_paths(const fs::path& folder) {
    std::error_code ignored;
    for (const fs::path& path : path_folders_in(folder)) {
        empty_path_folder(path, [&](const fs::path& file) { fs::remove(file, ignored); });
    }
    if (fs::is_directory(fs::symlink_status(folder, ignored))) fs::remove(folder, ignored);
}

std::string key_in(const fs::path& folder) {
    std::ifstream in(folder / solids_mark);
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
    const double cut = datasets::slice_position(path.shapes, view.slice_axis, view.camera.turn);
    for (std::size_t k = 0; k < rates.size(); ++k) {
        const RgbaImage solid = shaded_picture(path.shapes[k], sized(view.camera, pixels), &rates[k], pictures.highest);
        const auto slice = seen_from(
            view.camera, view.slice_axis,
            datasets::slice_picture(path.shapes[k], view.slice_axis, cut, pixels, &rates[k], range, view.camera.up_axis,
                                    datasets::view_radius(view.camera), view.camera.turn));
        pictures.frames.push_back(stacked(solid, to_rgba(slice), 4));
    }
    return pictures;
}

SolidView StudyView::of(std::size_t shape) const {
    SolidView view = common;
    if (shape < turns.size()) view.camera.turn = turns[shape];
    return view;
}

StudyView view_of_study(const ResultStore& store, const StudyData& data) {
    StudyView view;
    if (data.dimension != 3) return view;
    std::vector<std::string> labels;
    for (const StoredShape& shape : data.shapes) labels.push_back(shape.label);
    CommonFrames frames = common_frames(labels, pair_turns(data));
    view.turns = std::move(frames.turns);
    std::vector<std::vector<std::size_t>> members(
        frames.groups.empty() ? 0 : 1 + *std::max_element(frames.groups.begin(), frames.groups.end()));
    for (std::size_t i = 0; i < frames.groups.size(); ++i) members[frames.groups[i]].push_back(i);
    const auto up_axis_of = [&](const std::vector<std::size_t>& shapes) {
        std::vector<std::string> files;  // that lie in their frame as they are
        for (const std::size_t i : shapes) {
            if (view.turns[i] == datasets::unturned) files.push_back(data.shapes[i].name);
        }
        return datasets::up_axis_by_custom(files);
    };
    std::vector<std::size_t> all(data.shapes.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    const int up = up_axis_of(all);
    // How groups lie to each other is not known: each shows its wide side, as the largest one of them does.
    std::stable_sort(members.begin(), members.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
    datasets::CommonView common(up);
    const std::size_t looked_at = std::max<std::size_t>(2, 30 / std::max<std::size_t>(1, members.size()));
    std::optional<double> wide;
    for (const std::vector<std::size_t>& group : members) {
        const datasets::Rotation upright = axis_turn(up_axis_of(group), up);
        for (const std::size_t i : group) view.turns[i] = product(upright, view.turns[i]);
        datasets::CommonView own(up);
        const std::size_t stride = std::max<std::size_t>(1, group.size() / looked_at);
        for (std::size_t m = 0; m < group.size(); m += stride) {
            own.add(store.level_set<3>(data.shapes[group[m]].content_digest), view.turns[group[m]]);
        }
        const std::optional<double> longest = own.longest();
        if (!wide) wide = longest;
        if (longest && std::abs(std::remainder(*wide - *longest, 180.0)) > 10.0) {
            const datasets::Rotation around = turn_about(up, std::remainder(*wide - *longest, 180.0));
            for (const std::size_t i : group) view.turns[i] = product(around, view.turns[i]);
        }
        if (&group == &members.front()) common = own;
    }
    view.common = {common.view(), common.slice_axis()};
    return view;
}

SolidView view_of_path(const GeodesicResult<3>& path, const std::string& file) {
    datasets::CommonView common(datasets::up_axis_by_custom({file}));
    for (const LevelSet<3>& shape : path.shapes) common.add(shape);
    return {common.view(), common.slice_axis()};
}

std::string key_of(const SolidView& view) {
    char text[96];
    std::snprintf(text, sizeof text, "up %d azimuth %.3f elevation %.3f slice %d", view.camera.up_axis,
                  view.camera.azimuth, view.camera.elevation, view.slice_axis);
    std::string key = text;
    if (view.camera.turn == datasets::unturned) return key;
    key += " turn";
    for (const double entry : view.camera.turn) {
        std::snprintf(text, sizeof text, " %.3f", entry);
        key += text;
    }
    return key;
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
    remove_paths(aside_);
    for (const fs::path& path : path_folders_in(folder_.paths())) {
        const fs::path target = aside_ / path.filename();
        std::error_code error;
        fs::create_directories(target, error);
        empty_path_folder(path, [&](const fs::path& file) {
            fs::rename(file, target / file.filename(), error);
            if (error) fs::remove(file, error);  // then it is drawn again
        });
    }
    remove_paths(folder_.paths());
}

KeptSolids::~KeptSolids() {
    std::error_code error;
    for (const fs::path& path : path_folders_in(aside_)) {
        const fs::path target = folder_.paths() / path.filename();
        fs::create_directories(target, error);
        empty_path_folder(path, [&](const fs::path& file) {
            if (!fs::exists(target / file.filename(), error)) fs::rename(file, target / file.filename(), error);
        });
    }
    drop_rest();
}

void KeptSolids::drop_rest() {
    remove_paths(aside_);
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
    folder_.write(below / solids_mark, key + "\n");
}

}  // namespace morphodesic::pipeline

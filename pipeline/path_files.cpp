#include "pipeline/path_files.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string_view>

#include "pipeline/colour_map.h"
#include "pipeline/path_pictures.h"
#include "reports/json_number.h"

namespace morphodesic::pipeline {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;
using reports::json_number;

ordered_json numbers(const std::vector<double>& values) {
    ordered_json array = ordered_json::array();
    for (const double x : values) array.push_back(json_number(x));
    return array;
}

constexpr const char* colours_file = "colours.json";

bool is_plain(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-';
}

/// How many digits a text begins with.
std::size_t digits_of(std::string_view text) {
    return static_cast<std::size_t>(std::find_if(text.begin(), text.end(), [](char c) { return c < '0' || c > '9'; }) -
                                    text.begin());
}

}  // namespace

std::string path_folder(std::size_t number, const std::string& a, const std::string& b) {
    std::string name = std::to_string(number + 1);
    name.insert(0, name.size() < 3 ? 3 - name.size() : 0, '0');
    for (const std::string* part : {&a, &b}) {
        name += '_';
        for (const char c : part->substr(0, part->rfind('.')).substr(0, 60)) name += is_plain(c) ? c : '-';
    }
    return name;
}

bool is_path_folder(const std::string& name) {
    const std::size_t digits = digits_of(name);
    return digits >= 3 && digits < name.size() && name[digits] == '_' &&
           std::count(name.begin(), name.end(), '_') == 2 &&
           std::all_of(name.begin(), name.end(), [](char c) { return is_plain(c) || c == '_'; });
}

bool is_path_file(const fs::path& name) {
    const fs::path whole = name.extension() == ".part" ? name.stem() : name;  // the rest of a write that was stopped
    if (whole == colours_file || whole == solids_mark) return true;
    const std::string stem = whole.stem().string(), ending = whole.extension().string();
    if (stem.rfind("step-", 0) != 0 || (ending != ".png" && ending != ".vdb" && ending != ".ply")) return false;
    const std::string_view number = std::string_view(stem).substr(5);
    return number.size() >= 2 && digits_of(number) == number.size();
}

reports::ColourBar colour_bar_of(const PathPictures& pictures) {
    reports::ColourBar bar;
    bar.quantity = "viscous dissipation rate density";
    bar.unit = "1/time²";
    bar.low = 0.0;
    bar.high = pictures.highest;
    bar.colours = dissipation_colours(9);
    return bar;
}

template <int Dim>
DrawnPath draw_path(const GeodesicResult<Dim>& path, const SolidView& view) {
    double reach = 0.0;
    for (const LevelSet<Dim>& shape : path.shapes) reach = std::max(reach, picture_reach<Dim>(shape, view, true));
    const PathPictures pictures = path_pictures(path, frame_pixels, near_view<Dim>(view, reach));
    DrawnPath drawn;
    for (const RgbaImage& frame : pictures.frames)
        drawn.frames.push_back({encode_png(frame), frame.width, frame.height, ""});
    drawn.colour_bar = colour_bar_of(pictures);
    return drawn;
}

std::string pack(const DrawnPath& drawn) {
    ordered_json j{{"quantity", drawn.colour_bar.quantity}, {"unit", drawn.colour_bar.unit},
                   {"low", drawn.colour_bar.low},           {"high", drawn.colour_bar.high},
                   {"colours", drawn.colour_bar.colours},   {"frames", ordered_json::array()}};
    for (const reports::Picture& frame : drawn.frames) {
        const std::vector<std::uint8_t> bytes(frame.bytes.begin(), frame.bytes.end());
        j["frames"].push_back({{"png", ordered_json::binary(bytes)}, {"width", frame.width}, {"height", frame.height}});
    }
    const std::vector<std::uint8_t> bytes = ordered_json::to_cbor(j);
    return {bytes.begin(), bytes.end()};
}

DrawnPath unpack(const std::string& bytes) {
    DrawnPath drawn;
    const ordered_json j = ordered_json::from_cbor(bytes, true, false);
    if (j.is_discarded()) return drawn;
    drawn.colour_bar.quantity = j.at("quantity").get<std::string>();
    drawn.colour_bar.unit = j.at("unit").get<std::string>();
    drawn.colour_bar.low = j.at("low").get<double>();
    drawn.colour_bar.high = j.at("high").get<double>();
    drawn.colour_bar.colours = j.at("colours").get<std::vector<std::string>>();
    for (const ordered_json& frame : j.at("frames")) {
        const auto& png = frame.at("png").get_binary();
        drawn.frames.push_back(
            {{png.begin(), png.end()}, frame.at("width").get<int>(), frame.at("height").get<int>(), ""});
    }
    return drawn;
}

std::vector<std::string> write_path_files(const StudyFolder& folder, const fs::path& below, const DrawnPath& drawn) {
    std::vector<std::string> names;
    for (std::size_t k = 0; k < drawn.frames.size(); ++k) {
        char name[32];
        std::snprintf(name, sizeof name, "step-%02zu.png", k);
        folder.write(below / name, drawn.frames[k].bytes);
        names.push_back((below / name).generic_string());
    }
    const ordered_json meaning{{"quantity", drawn.colour_bar.quantity},
                               {"unit", drawn.colour_bar.unit},
                               {"low", json_number(drawn.colour_bar.low)},
                               {"high", json_number(drawn.colour_bar.high)},
                               {"colours", drawn.colour_bar.colours}};
    folder.write(below / colours_file, meaning.dump(2) + "\n");
    return names;
}

ordered_json to_json(const StoredGeodesic& g) {
    ordered_json levels = ordered_json::array();
    for (const LevelReport& l : g.levels) {
        levels.push_back({{"level", l.level},
                          {"time_steps", l.time_steps},
                          {"rim_width", json_number(l.rim_width)},
                          {"iterations", l.iterations},
                          {"evaluations", l.evaluations},
                          {"total_energy", json_number(l.total_energy)},
                          {"path_length", json_number(l.path_length)},
                          {"min_det", json_number(l.min_det)},
                          {"folds_repaired", l.folds_repaired},
                          {"termination", to_string(l.termination)},
                          {"seconds", json_number(l.seconds)}});
    }
    const std::string problem = g.problem();
    const bool solved = g.failure.empty();  // else there are no numbers, and the fields only have their defaults
    const auto result = [&](double x) { return solved ? json_number(x) : ordered_json(nullptr); };
    return {{"path_length", result(g.path_length)},
            {"error", result(g.error)},
            {"extrapolated_length", result(g.extrapolated_length)},
            {"path_energy", result(g.path_energy)},
            {"total_energy", result(g.total_energy)},
            {"min_det", result(g.min_det)},
            {"termination", solved ? to_string(g.termination) : "failed"},
            {"message", g.message},
            {"problem", problem.empty() ? ordered_json(nullptr) : ordered_json(problem)},
            {"deformation_energy", numbers(g.deformation_energy)},
            {"mismatch_energy", numbers(g.mismatch_energy)},
            {"rotation", numbers(g.rotation)},
            {"translation", numbers(g.translation)},
            {"levels", levels},
            {"digest_a", g.a},
            {"digest_b", g.b},
            {"settings", g.settings_hash},
            {"seconds", result(g.seconds)}};
}

template DrawnPath draw_path<2>(const GeodesicResult<2>&, const SolidView&);
template DrawnPath draw_path<3>(const GeodesicResult<3>&, const SolidView&);

}  // namespace morphodesic::pipeline

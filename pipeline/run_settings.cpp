#include "pipeline/run_settings.h"

#include <algorithm>
#include <charconv>
#include <sstream>
#include <stdexcept>
#include <type_traits>

#include "pipeline/digest.h"
#include "pipeline/toml.h"

namespace morphodesic::pipeline {
namespace {

std::string value_text(bool value) {
    return value ? "true" : "false";
}
std::string value_text(int value) {
    return std::to_string(value);
}
std::string value_text(double value) {
    char buffer[32];
    const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
    std::string text(buffer, end);
    // TOML tells floats from integers by the point or the exponent.
    if (text.find_first_of(".en") == std::string::npos) text += ".0";
    return text;
}
std::string value_text(const std::string& value) {
    std::ostringstream text;
    text << toml::value<std::string>(value);
    return text.str();
}

template <class Options>
std::string lines_of(const Options& options) {
    std::string text;
    Options::for_each_field(options, [&](const char* name, const auto& value, const char*) {
        text += std::string(name) + " = " + value_text(value) + "\n";
    });
    return text;
}

}  // namespace

std::vector<std::string> RunSettings::problems() const {
    std::vector<std::string> found = datasets::ScanOptions{labels}.problems();
    const auto add = [&](const std::vector<std::string>& more) { found.insert(found.end(), more.begin(), more.end()); };
    if (dimension != "auto" && dimension != "2" && dimension != "3") {
        found.push_back("dimension must be auto, 2 or 3, not \"" + dimension + "\"");
    }
    add(import.problems());
    datasets::NormalizeOptions place;
    place.mode = normalize;
    add(place.problems());
    add(geodesic.problems());
    if (pairs.neighbors < 0) {
        found.push_back("neighbors must be 0 (all pairs) or more, not " + std::to_string(pairs.neighbors));
    }
    return found;
}

const std::vector<Preset>& presets() {
    static const std::vector<Preset> all{
        {"fast",
         "level 5, 2 steps: a first look; 0.04 s of a core per 2D pair. Disks: 8 % short, extrapolated within 2 %;\n"
         "            letters: error bars of 30 to 50 %; thin shapes that bend come out too long",
         5, 2, 1e-2, 3, 0},
        {"standard",
         "level 6, 8 steps: for studies; 0.2 s of a core per 2D pair. Disks: 5 % short, extrapolated within 1.5 %", 6,
         8, 1e-3, 24, 1},
        {"fine",
         "level 7, 8 steps: for final numbers; five times the cost of standard. Disks: 2.5 % short, extrapolated\n"
         "            within 0.5 %",
         7, 8, 2.5e-4, 24, 1},
    };
    return all;
}

void take_preset(RunSettings& settings, const std::string& name) {
    for (const Preset& preset : presets()) {
        if (name != preset.name) continue;
        settings.preset = name;
        settings.geodesic.level = preset.level;
        settings.geodesic.time_steps = preset.time_steps;
        settings.geodesic.tolerance = preset.tolerance;
        settings.geodesic.starts = preset.starts;
        settings.geodesic.rounds = preset.rounds;
        return;
    }
    throw std::invalid_argument("there is no preset \"" + name + "\"; choose fast, standard or fine");
}

RunSettings settings_of_preset(const std::string& name) {
    RunSettings settings;
    take_preset(settings, name);
    return settings;
}

std::string canonical_text(const RunSettings& settings) {
    return "preset = " + value_text(settings.preset) + "\n" + lines_of(settings) + lines_of(settings.pairs);
}
std::string canonical_text(const GeodesicOptions& options) {
    return lines_of(options);
}
std::string canonical_text(const datasets::ImportOptions& options) {
    return lines_of(options);
}

std::string settings_hash(const GeodesicOptions& options) {
    return digest("solver revision " + std::to_string(solver_revision) + "\n" + lines_of(options));
}

RunSettings settings_from_text(const std::string& text) {
    const toml::table table = [&] {
        try {
            return toml::parse(text);
        } catch (const toml::parse_error& error) {
            throw std::invalid_argument("the settings cannot be read: " + std::string(error.description()));
        }
    }();
    RunSettings settings;
    std::size_t used = 0;
    const auto take = [&](const char* name, auto& field, const char*) {
        const auto* node = table.get(name);
        if (!node) return;
        ++used;
        const auto value = node->value<std::decay_t<decltype(field)>>();
        if (!value) throw std::invalid_argument("the value of " + std::string(name) + " cannot be read");
        field = *value;
    };
    take("preset", settings.preset, "");
    RunSettings::for_each_field(settings, take);
    PairSelection::for_each_field(settings.pairs, take);
    if (used != table.size()) throw std::invalid_argument("there is a setting this program does not know");
    return settings;
}

int shape_level(int dimension, const GeodesicOptions& options) {
    return dimension == 2 ? std::min(std::max(options.level + 1, 7), 10) : options.level;
}

}  // namespace morphodesic::pipeline

#include "pipeline/stored_geodesic.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "pipeline/digest.h"

namespace morphodesic::pipeline {
namespace {

using nlohmann::json;

/// NaN and infinities have no JSON number; they travel as strings.
json number_to_json(double x) {
    return std::isfinite(x) ? json(x) : json(std::isnan(x) ? "nan" : x > 0 ? "inf" : "-inf");
}

double number_from_json(const json& j) {
    if (j.is_number()) return j.get<double>();
    const auto text = j.get<std::string>();
    if (text == "nan") return std::numeric_limits<double>::quiet_NaN();
    return text == "inf" ? HUGE_VAL : -HUGE_VAL;
}

json numbers_to_json(const std::vector<double>& values) {
    json array = json::array();
    for (const double x : values) array.push_back(number_to_json(x));
    return array;
}

std::vector<double> numbers_from_json(const json& array) {
    std::vector<double> values;
    for (const json& x : array) values.push_back(number_from_json(x));
    return values;
}

}  // namespace

Termination termination_from(std::string_view text) {
    for (const Termination t : {Termination::converged, Termination::max_steps, Termination::no_descent}) {
        if (text == to_string(t)) return t;
    }
    return Termination::cancelled;
}

std::string details_of(const StoredGeodesic& g) {
    json levels = json::array();
    for (const LevelReport& l : g.levels) {
        levels.push_back({{"level", l.level},
                          {"time_steps", l.time_steps},
                          {"rim_width", number_to_json(l.rim_width)},
                          {"iterations", l.iterations},
                          {"evaluations", l.evaluations},
                          {"total_energy", number_to_json(l.total_energy)},
                          {"path_length", number_to_json(l.path_length)},
                          {"min_det", number_to_json(l.min_det)},
                          {"folds_repaired", l.folds_repaired},
                          {"termination", to_string(l.termination)},
                          {"seconds", number_to_json(l.seconds)}});
    }
    return json{{"message", g.message},
                {"deformation_energy", numbers_to_json(g.deformation_energy)},
                {"mismatch_energy", numbers_to_json(g.mismatch_energy)},
                {"rotation", numbers_to_json(g.rotation)},
                {"translation", numbers_to_json(g.translation)},
                {"levels", levels}}
        .dump(-1, ' ', false, json::error_handler_t::replace);
}

void read_details(const std::string& text, StoredGeodesic& g) {
    const json details = json::parse(text);
    g.message = details.at("message").get<std::string>();
    g.deformation_energy = numbers_from_json(details.at("deformation_energy"));
    g.mismatch_energy = numbers_from_json(details.at("mismatch_energy"));
    g.rotation = numbers_from_json(details.at("rotation"));
    g.translation = numbers_from_json(details.at("translation"));
    for (const json& l : details.at("levels")) {
        LevelReport level;
        level.level = l.at("level");
        level.time_steps = l.at("time_steps");
        if (l.contains("rim_width")) level.rim_width = number_from_json(l.at("rim_width"));  // not in older studies
        level.iterations = l.at("iterations");
        level.evaluations = l.at("evaluations");
        level.total_energy = number_from_json(l.at("total_energy"));
        level.path_length = number_from_json(l.at("path_length"));
        level.min_det = number_from_json(l.at("min_det"));
        level.folds_repaired = l.at("folds_repaired");
        level.termination = termination_from(l.at("termination").get<std::string>());
        level.seconds = number_from_json(l.at("seconds"));
        g.levels.push_back(level);
    }
}

/// Over every column of a row: text with separators, numbers by their bits.
std::string row_checksum(const StoredGeodesic& g, const std::string& details) {
    std::string bytes;
    for (const std::string* text : {&g.a, &g.b, &g.settings_hash, &g.failure, &details}) bytes += *text + '\n';
    bytes += to_string(g.termination);
    for (const auto number : row_numbers) {
        const double x = g.*number;
        const double canonical = std::isnan(x) ? std::numeric_limits<double>::quiet_NaN() : x;
        bytes.append(reinterpret_cast<const char*>(&canonical), sizeof canonical);
    }
    return digest(bytes);
}

std::string StoredGeodesic::problem() const {
    if (!failure.empty()) return failure;
    if (termination == Termination::max_steps) return "not converged: the iteration limit was reached";
    if (termination == Termination::no_descent) return "not converged: the line search found no descent";
    if (termination == Termination::cancelled) return "cancelled";
    if (!std::isfinite(path_length)) return "the path length is not finite";
    if (!(min_det > 0))
        return "the deformations are not certified to be one-to-one (min det " + std::to_string(min_det) + ")";
    return {};
}

StoredGeodesic reversed(StoredGeodesic g) {
    std::swap(g.a, g.b);
    std::reverse(g.deformation_energy.begin(), g.deformation_energy.end());
    std::reverse(g.mismatch_energy.begin(), g.mismatch_energy.end());
    const std::vector<double> rotation = g.rotation, translation = g.translation;
    const std::size_t dim = translation.size();
    for (std::size_t a = 0; a < dim; ++a) {
        g.translation[a] = 0.0;
        for (std::size_t b = 0; b < dim; ++b) {
            g.rotation[a * dim + b] = rotation[b * dim + a];
            g.translation[a] -= rotation[b * dim + a] * translation[b];
        }
    }
    return g;
}

template <int Dim>
StoredGeodesic to_record(const GeodesicResult<Dim>& result, std::string a, std::string b, std::string settings_hash) {
    StoredGeodesic g;
    g.a = std::move(a);
    g.b = std::move(b);
    g.settings_hash = std::move(settings_hash);
    g.termination = result.termination;
    g.message = result.message;
    g.path_length = result.path_length;
    g.path_energy = result.path_energy;
    g.total_energy = result.total_energy;
    g.error = result.error;
    g.extrapolated_length = result.extrapolated_length;
    g.min_det = result.min_det;
    g.seconds = result.seconds;
    g.deformation_energy = result.deformation_energy;
    g.mismatch_energy = result.mismatch_energy;
    g.levels = result.levels;
    g.rotation.assign(result.motion.rotation.begin(), result.motion.rotation.end());
    g.translation.assign(result.motion.translation.begin(), result.motion.translation.end());
    return g;
}

std::string line_of(const StoredGeodesic& g) {
    const std::string details = details_of(g);
    json numbers = json::array();
    for (const auto number : row_numbers) numbers.push_back(number_to_json(g.*number));
    return json{{"a", g.a},
                {"b", g.b},
                {"settings", g.settings_hash},
                {"failure", g.failure},
                {"termination", to_string(g.termination)},
                {"numbers", numbers},
                {"details", details},
                {"checksum", row_checksum(g, details)}}
        .dump(-1, ' ', false, json::error_handler_t::replace);
}

std::optional<StoredGeodesic> geodesic_from_line(const std::string& line) {
    try {
        const json j = json::parse(line);
        StoredGeodesic g;
        g.a = j.at("a");
        g.b = j.at("b");
        g.settings_hash = j.at("settings");
        g.failure = j.at("failure");
        g.termination = termination_from(j.at("termination").get<std::string>());
        const std::vector<double> numbers = numbers_from_json(j.at("numbers"));
        if (numbers.size() != row_numbers.size()) return std::nullopt;
        for (std::size_t i = 0; i < numbers.size(); ++i) g.*row_numbers[i] = numbers[i];
        const auto details = j.at("details").get<std::string>();
        if (row_checksum(g, details) != j.at("checksum")) return std::nullopt;
        read_details(details, g);
        return g;
    } catch (const json::exception&) {
        return std::nullopt;
    }
}

template StoredGeodesic to_record<2>(const GeodesicResult<2>&, std::string, std::string, std::string);
template StoredGeodesic to_record<3>(const GeodesicResult<3>&, std::string, std::string, std::string);

}  // namespace morphodesic::pipeline

#include <algorithm>
#include <stdexcept>

#include "reports/assets.h"
#include "reports/json.h"
#include "reports/report.h"
#include "reports/text.h"

namespace morphodesic::reports {
namespace {

using Json = nlohmann::ordered_json;

/// A report is mailed: pictures of paths beyond this size stay out and the page says how to compute them.
constexpr std::size_t largest_file = 19'000'000;

std::string csp_hash(std::string_view hexadecimal) {
    std::string bytes;
    for (std::size_t i = 0; i + 1 < hexadecimal.size(); i += 2) {
        bytes += static_cast<char>(std::stoi(std::string(hexadecimal.substr(i, 2)), nullptr, 16));
    }
    return "sha256-" + base64(bytes);
}

/// JSON that cannot end or open an element, whatever it says: these characters only occur inside strings.
std::string json_for_script(const Json& json) {
    const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    std::string result;
    result.reserve(text.size());
    for (const char c : text) {
        switch (c) {
            case '<':
                result += "\\u003c";
                break;
            case '>':
                result += "\\u003e";
                break;
            case '&':
                result += "\\u0026";
                break;
            default:
                result += c;
        }
    }
    return result;
}

Json picture_json(const Picture& p) {
    if (p.bytes.empty()) return nullptr;
    return {{"uri", data_uri(p.bytes)}, {"width", p.width}, {"height", p.height}, {"alt", p.alt}};
}

/// The model with its pictures, as far as they fit. Beyond about 1100 shapes the page keeps four digits and leaves the
/// error bars of all pairs to pairs.csv and the fitted distances of maps to report.json, so that it can still be
/// mailed.
Json page_json(const ReportModel& model) {
    const bool huge = model.distances.size() > 600'000;
    Json data = model_json(model, huge ? 4 : 6);
    data["errors_left_out"] = huge && !model.errors.empty();
    if (huge) {
        data["errors"] = Json::array();
        for (Json& map : data["embeddings"]) map["disparities"] = Json::array();
    }
    std::size_t size = assets::script.size() + assets::style.size() + assets::skeleton.size();
    for (const auto& [key, value] : data.items()) {
        if (key != "paths") size += value.dump(-1, ' ', false, Json::error_handler_t::replace).size();
    }
    for (std::size_t i = 0; i < model.shapes.size(); ++i) {
        Json picture = picture_json(model.shapes[i].thumbnail);
        size += model.shapes[i].thumbnail.bytes.size() * 4 / 3 + 100;
        data["shapes"][i]["picture"] = std::move(picture);
    }
    Json kept = Json::array();
    int left_out = 0;
    for (std::size_t i = 0; i < model.paths.size(); ++i) {
        Json& path = data["paths"][i];
        std::size_t path_size = path.dump(-1, ' ', false, Json::error_handler_t::replace).size();
        for (const auto& f : model.paths[i].frames)
            path_size += f.picture.bytes.size() * 4 / 3 + 100 + f.picture.alt.size();
        if (size + path_size > largest_file) {
            ++left_out;
            continue;
        }
        size += path_size;
        for (std::size_t k = 0; k < model.paths[i].frames.size(); ++k) {
            path["frames"][k]["picture"] = picture_json(model.paths[i].frames[k].picture);
        }
        kept.push_back(std::move(path));
    }
    data["paths"] = std::move(kept);
    data["paths_left_out"] = left_out;
    return data;
}

std::string headline(const ReportModel& m) {
    std::string text = std::to_string(m.shapes.size()) + (m.dimension == 3 ? " surfaces" : " shapes") +
                       (m.given_matrix ? " with " : " compared in ") + std::to_string(m.pairs_done) +
                       (m.given_matrix      ? " given distances"
                        : m.pairs_done == 1 ? " pair"
                                            : " pairs");
    if (m.pairs_done < m.pairs_total)
        text += " (of " + std::to_string(m.pairs_total) + (m.given_matrix ? " pairs)" : ")");
    std::ptrdiff_t files = 0, pairs = 0, cut_off = 0;
    for (const Failure& failure : m.failures) ++(failure.cut_off ? cut_off : failure.b.empty() ? files : pairs);
    if (m.failures.empty()) return text + (m.given_matrix ? "." : "; nothing failed.");
    const auto counted = [](std::ptrdiff_t number, const std::string& what) {
        return std::to_string(number) + " " + what + (number == 1 ? "" : "s");
    };
    if (files + pairs > 0) text += "; failed: ";
    if (files > 0) text += counted(files, "file");
    if (files > 0 && pairs > 0) text += " and ";
    if (pairs > 0) text += counted(pairs, "pair");
    if (cut_off > 0) text += "; cut off from the others: " + counted(cut_off, "shape");
    return text + ".";
}

/// Replaces each {{NAME}} of the skeleton once; what is put in is not searched again.
std::string fill(std::string_view skeleton, const std::vector<std::pair<std::string_view, std::string>>& parts) {
    std::string result;
    while (!skeleton.empty()) {
        const std::size_t open = skeleton.find("{{"), close = skeleton.find("}}");
        if (open == std::string_view::npos || close == std::string_view::npos) break;
        const std::string_view name = skeleton.substr(open + 2, close - open - 2);
        const auto part = std::find_if(parts.begin(), parts.end(), [&](const auto& p) { return p.first == name; });
        if (part == parts.end()) throw std::logic_error("report.html: unknown part " + std::string(name));
        result += skeleton.substr(0, open);
        result += part->second;
        skeleton.remove_prefix(close + 2);
    }
    return result += skeleton;
}

}  // namespace

std::string render_html(const ReportModel& model) {
    if (const auto found = problems(model); !found.empty()) throw std::invalid_argument("report: " + found.front());
    return fill(assets::skeleton, {{"TITLE", escape_markup(model.study)},
                                   {"HEADLINE", escape_markup(headline(model))},
                                   {"SCRIPT_HASH", csp_hash(assets::script_sha256)},
                                   {"STYLE", std::string(assets::style)},
                                   {"DATA", json_for_script(page_json(model))},
                                   {"SCRIPT", std::string(assets::script)}});
}

}  // namespace morphodesic::reports

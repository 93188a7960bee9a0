#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "pipeline/cli.h"
#include "pipeline/toml.h"

namespace morphodesic::pipeline {
namespace {

std::string text_of(const toml::node& node) {
    if (const auto* text = node.as_string()) return text->get();
    if (const auto* flag = node.as_boolean()) return flag->get() ? "true" : "false";
    std::ostringstream out;
    if (const auto* whole = node.as_integer()) out << whole->get();
    if (const auto* real = node.as_floating_point()) out << toml::value<double>(real->get());
    return out.str();
}

/// Where the options of a subcommand begin: behind its name, for `datasets` behind the kind.
std::ptrdiff_t options_begin(const std::vector<std::string>& arguments) {
    if (arguments.front() != "datasets") return 1;
    for (std::size_t i = 1; i < arguments.size(); ++i) {
        if (arguments[i] == "--config") {
            ++i;  // its value
        } else if (arguments[i].rfind('-', 0) != 0) {
            return static_cast<std::ptrdiff_t>(i) + 1;
        }
    }
    return 1;
}

}  // namespace

std::vector<ConfigOption> options_of_config(const std::string& file) {
    const auto fail = [&](const toml::source_position& at, const std::string& problem) {
        throw std::invalid_argument(file + ", line " + std::to_string(at.line) + ": " + problem);
    };
    std::error_code ignored;
    if (std::filesystem::is_directory(file, ignored)) {
        throw std::invalid_argument(file + ": is a folder; name a TOML file after --config");
    }
    std::ifstream in(file, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    if (!in.is_open() || in.bad())
        throw std::invalid_argument(file + ": cannot be read; check the name after --config");
    // TOML forbids control characters; the parser does not look at all of them.
    unsigned line = 1;
    for (const char c : text) {
        if (c == '\n') ++line;
        const auto byte = static_cast<unsigned char>(c);
        if ((byte < 0x20 && c != '\t' && c != '\n' && c != '\r') || byte == 0x7f) {
            fail({line, 1}, "there is a byte that no text has; is this a TOML file?");
        }
    }
    std::vector<ConfigOption> options;
    try {
        const toml::table table = toml::parse(text, file);
        for (const auto& [key, node] : table) {
            const std::string name(std::string_view{key});
            if (name == "config") fail(node.source().begin, "a configuration file cannot name another one");
            if (name.empty() || name.find_first_of("= \t\n") != std::string::npos) {
                fail(node.source().begin, "\"" + name + "\" is not the name of an option");
            }
            if (!node.is_string() && !node.is_boolean() && !node.is_number()) {
                fail(node.source().begin,
                     "the value of \"" + name +
                         "\" must be a text, a number, true or false; options stand at the top, as "
                         "in: level = 6");
            }
            options.push_back({file, name, text_of(node), node.source().begin.line});
        }
    } catch (const toml::parse_error& error) {
        fail(error.source().begin, std::string(error.description()));
    } catch (const NotToml&) {
        throw std::invalid_argument(file + ": this is not TOML; write one option per line, as in: level = 6");
    }
    std::stable_sort(options.begin(), options.end(), [](const auto& a, const auto& b) { return a.line < b.line; });
    return options;
}

std::vector<std::string> with_config(std::vector<std::string> arguments, std::vector<ConfigOption>& options) {
    // --config FILE in front of the command is as good as behind it.
    std::size_t command = 0;
    while (command < arguments.size() && arguments[command].rfind("--config", 0) == 0) {
        command += arguments[command] == "--config" ? 2 : 1;
    }
    if (command < arguments.size()) {
        const auto first = arguments.begin();
        std::rotate(first, first + static_cast<std::ptrdiff_t>(command),
                    first + static_cast<std::ptrdiff_t>(command) + 1);
    }
    std::vector<std::string> tokens;  // of several files in their order: the last word counts
    for (std::size_t i = 0; i < arguments.size() && arguments[i] != "--"; ++i) {
        std::string file;
        if (arguments[i].rfind("--config=", 0) == 0) file = arguments[i].substr(9);
        if (arguments[i] == "--config" && i + 1 < arguments.size()) file = arguments[++i];
        if (file.empty()) continue;
        for (ConfigOption& option : options_of_config(file)) {
            tokens.push_back(option.token());
            options.push_back(std::move(option));
        }
    }
    arguments.insert(arguments.begin() + options_begin(arguments), tokens.begin(), tokens.end());
    return arguments;
}

}  // namespace morphodesic::pipeline

#include "pipeline/cli_hints.h"

#include <CLI/CLI.hpp>
#include <filesystem>

namespace morphodesic::pipeline {

std::string unknown_command(const CLI::App& app, const std::vector<std::string>& words, std::size_t first) {
    while (first < words.size() && words[first].rfind("--config", 0) == 0) first += words[first] == "--config" ? 2 : 1;
    if (first >= words.size() || words[first].rfind('-', 0) == 0) return "";
    std::string known;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
        if (command->get_name() == words[first]) {
            const bool has_kinds = command->get_require_subcommand_min() > 0;
            return has_kinds ? unknown_command(*command, words, first + 1) : "";
        }
        known += (known.empty() ? "" : ", ") + command->get_name();
    }
    const std::string behind = app.get_name().empty() ? "" : app.get_name() + " ";
    return "there is no command \"" + behind + words[first] + "\"; there are: " + known;
}

namespace {

/// The command that the words name, for `datasets` its kind; null if there is none.
CLI::App* named_command(CLI::App& app, const std::vector<std::string>& words) {
    CLI::App* command = &app;
    for (std::size_t i = 0; i < words.size() && words[i] != "--"; ++i) {
        if (words[i] == "--config") ++i;  // its value
        if (i >= words.size() || words[i].rfind('-', 0) == 0) continue;
        const auto found = command->get_subcommands([&](CLI::App* sub) { return sub->get_name() == words[i]; });
        if (found.empty()) return nullptr;
        command = found.front();
        if (command->get_require_subcommand_min() == 0) return command;
    }
    return nullptr;
}

/// The command as it is given: "datasets letters".
std::string call_of(const CLI::App& command) {
    std::string call = command.get_name();
    for (const CLI::App* at = command.get_parent(); at->get_parent() != nullptr; at = at->get_parent()) {
        call = at->get_name() + " " + call;
    }
    return call;
}

/// Names of the commands below `app`, kinds of datasets among them, that have an option.
void commands_with(CLI::App& app, const std::string& option, std::string& names) {
    for (CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
        if (command->get_option_no_throw(option) != nullptr) names += (names.empty() ? "" : ", ") + call_of(*command);
        commands_with(*command, option, names);
    }
}

/// What an option takes, by the type that CLI11 gives it; empty if it may be any text.
std::string kind_of(const CLI::Option& option) {
    const std::string type = option.get_type_name();
    if (option.get_items_expected_max() == 0) return "true or false";
    if (type.rfind("INT", 0) == 0 || type.rfind("UINT", 0) == 0) return "a whole number";
    return type.rfind("FLOAT", 0) == 0 ? "a number" : "";
}

/// What the option says to a value; empty if it takes it.
std::string refusal(CLI::Option& option, const ConfigOption& given) {
    try {
        const bool flag = option.get_items_expected_max() == 0;
        option.add_result(flag ? option.get_flag_value("--" + given.name, given.value) : given.value);
        option.run_callback();
        return "";
    } catch (const CLI::ConversionError& error) {
        const std::string kind = kind_of(option);
        return kind.empty() ? error.what() : "it must be " + kind;
    } catch (const CLI::ParseError& error) {
        const std::string said = error.what(), name = "--" + given.name + ": ";
        return said.rfind(name, 0) == 0 ? said.substr(name.size()) : said;
    }
}

}  // namespace

std::vector<std::string> wrong_options(CLI::App& app, const std::vector<std::string>& arguments,
                                       const std::vector<ConfigOption>& options) {
    std::vector<std::string> problems;
    CLI::App* command = named_command(app, arguments);
    if (command == nullptr) return problems;
    const std::string call = call_of(*command);
    for (const ConfigOption& given : options) {
        const std::string at = given.file + ", line " + std::to_string(given.line) + ": ",
                          help = "; see morphodesic " + call + " --help";
        CLI::Option* option = command->get_option_no_throw("--" + given.name);
        if (option == nullptr) {
            problems.push_back(at + "there is no option \"" + given.name + "\"" + help);
            continue;
        }
        const std::string refused = refusal(*option, given);
        if (!refused.empty()) {
            problems.push_back(at + "\"" + given.name + "\" cannot be " + given.value + ": " + refused + help);
        }
    }
    return problems;
}

std::string unknown_option(CLI::App& app, const std::vector<std::string>& words) {
    CLI::App* command = named_command(app, words);
    if (command == nullptr) return "";
    for (const std::string& word : words) {
        if (word == "--") break;
        const std::string name = word.substr(0, word.find('='));
        if (name.rfind("--", 0) != 0 || name == "--config" || command->get_option_no_throw(name) != nullptr) continue;
        std::string others;
        commands_with(app, name, others);
        const std::string call = call_of(*command);
        return call + " has no option " + name + (others.empty() ? "" : ", it is one of: " + others) +
               "; see morphodesic " + call + " --help";
    }
    return "";
}

std::string wrong_value(CLI::App& app, const std::vector<std::string>& words) {
    CLI::App* command = named_command(app, words);
    if (command == nullptr) return "";
    for (std::size_t i = 0; i < words.size() && words[i] != "--"; ++i) {
        const std::size_t equals = words[i].find('=');
        const std::string name = words[i].substr(0, equals);
        CLI::Option* option = name.rfind("--", 0) == 0 ? command->get_option_no_throw(name) : nullptr;
        if (option == nullptr || (equals == std::string::npos && i + 1 == words.size())) continue;
        const bool flag = option->get_items_expected_max() == 0;
        if (flag && equals == std::string::npos) continue;
        const ConfigOption given{"", name.substr(2),
                                 equals == std::string::npos ? words[i + 1] : words[i].substr(equals + 1)};
        if (const std::string refused = refusal(*option, given); !refused.empty()) {
            return name + " cannot be " + given.value + ": " + refused;
        }
    }
    return "";
}

std::string dash_hint(const std::vector<std::string>& words) {
    std::error_code error;
    for (const std::string& word : words) {
        if (word == "--") break;
        if (word.rfind('-', 0) == 0 && std::filesystem::exists(word, error)) {
            return word + " is taken for an option; to name the file of that name, write ./" + word;
        }
    }
    return "";
}

}  // namespace morphodesic::pipeline

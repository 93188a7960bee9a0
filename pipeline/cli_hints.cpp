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

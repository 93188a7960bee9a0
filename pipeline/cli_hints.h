#pragma once

#include <string>
#include <vector>

#include "pipeline/cli.h"

namespace CLI {
class App;
}

namespace morphodesic::pipeline {

/// What is wrong if the first word, or that behind `datasets`, is no command; empty if it is one or none is there.
/// @param first  number of the word that names the command of `app`
[[nodiscard]] std::string unknown_command(const CLI::App& app, const std::vector<std::string>& words,
                                          std::size_t first = 0);

/// What is wrong with options of configuration files, file and line in front: names that the command does not have and
/// values that are not what they take. Empty also where the arguments name no command.
/// @param app  parses them into variables that nobody uses
[[nodiscard]] std::vector<std::string> wrong_options(CLI::App& app, const std::vector<std::string>& arguments,
                                                     const std::vector<ConfigOption>& options);

/// An option among the words that the command does not have, with the commands that have it; else empty.
[[nodiscard]] std::string unknown_option(CLI::App& app, const std::vector<std::string>& words);

/// A value among the words that is not of the kind its option takes ("5.5" for a whole number); else empty.
/// @param app  parses them into variables that nobody uses
[[nodiscard]] std::string wrong_value(CLI::App& app, const std::vector<std::string>& words);

/// What to write for a file whose name begins as options do, if there is one among the words; else empty.
[[nodiscard]] std::string dash_hint(const std::vector<std::string>& words);

}  // namespace morphodesic::pipeline

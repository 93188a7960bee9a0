#pragma once

#include <string>
#include <vector>

namespace morphodesic::pipeline {

/// Parses the command line (without the program's name), runs the subcommand and turns exceptions into messages and
/// exit codes.
int run_program(const std::vector<std::string>& arguments);

/// The options in a TOML file as command line tokens, "--name=value" each.
/// @throws std::invalid_argument naming file and line if it cannot be read or holds something that is not an option
[[nodiscard]] std::vector<std::string> tokens_of_config(const std::string& file);

/// The arguments with the options of the file that --config names, if any, behind the name of the subcommand, so that
/// those on the command line come later and win.
[[nodiscard]] std::vector<std::string> with_config(std::vector<std::string> arguments);

}  // namespace morphodesic::pipeline

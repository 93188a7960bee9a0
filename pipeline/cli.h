#pragma once

#include <string>
#include <vector>

namespace morphodesic::pipeline {

/// Parses the command line (without the program's name), runs the subcommand and turns exceptions into messages and
/// exit codes.
int run_program(const std::vector<std::string>& arguments);

/// An option of a configuration file, and where it stands.
struct ConfigOption {
    std::string file, name, value;
    unsigned line = 0;
    [[nodiscard]] std::string token() const { return "--" + name + "=" + value; }
};

/// The options in a TOML file, by their lines.
/// @throws std::invalid_argument naming file and line if it cannot be read or holds something that is not an option
[[nodiscard]] std::vector<ConfigOption> options_of_config(const std::string& file);

/// The arguments with the options of the files that --config names, if any, behind the name of the subcommand, so that
/// those on the command line come later and win.
/// @param options  receives those of the files
[[nodiscard]] std::vector<std::string> with_config(std::vector<std::string> arguments,
                                                   std::vector<ConfigOption>& options);

}  // namespace morphodesic::pipeline

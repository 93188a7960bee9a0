#include "pipeline/cli.h"

#include <iostream>

#include "analysis/csv.h"
#include "datasets/interruption.h"
#include "datasets/read_error.h"
#include "pipeline/cli_hints.h"
#include "pipeline/command_line.h"
#include "pipeline/commands/summary.h"
#include "pipeline/memory_limits.h"
#include "pipeline/process_limits.h"
#include "pipeline/standard_streams.h"
#include "pipeline/stop_signals.h"
#include "pipeline/store_error.h"
#include "pipeline/study_folder.h"
#include "pipeline/study_report.h"

namespace morphodesic::pipeline {
namespace {

namespace fs = std::filesystem;

/// Defaults of the second pass: what the study was made with, with the solver of the preset if one is named (how its
/// files were read and placed is settled); without a study the preset alone.
RunSettings defaults_after(const CommandLine& first) {
    const bool classifies = !first.classify.templates.empty();
    const std::filesystem::path study = classifies                       ? first.classify.templates
                                        : first.study.collection.empty() ? first.study.study
                                                                         : std::filesystem::path{};
    const std::string text = study.empty() ? "" : stored_settings(study);
    if (text.empty()) {
        return settings_of_preset(!first.preset.empty() ? first.preset : classifies ? "fast" : "standard");
    }
    RunSettings settings = settings_from_text(text);
    if (!first.preset.empty()) take_preset(settings, first.preset);
    return settings;
}

/// What is wrong with the arguments, better than CLI11 says it; empty if it says it well.
std::string problem_of(const CLI::ParseError& error, const std::vector<std::string>& arguments) {
    const bool unknown = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
    if (!unknown && dynamic_cast<const CLI::ConversionError*>(&error) == nullptr) return "";
    CommandLine tried(settings_of_preset("standard"));
    return unknown ? unknown_option(tried.app, arguments) : wrong_value(tried.app, arguments);
}

int parse_and_run(std::vector<std::string> arguments) {
    std::string repeat = "morphodesic";
    for (const std::string& word : arguments) repeat += " " + shell_word(word);
    std::vector<ConfigOption> from_files;
    if (!arguments.empty()) arguments = with_config(std::move(arguments), from_files);
    const std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());  // as CLI11 wants them

    const auto parse = [&](CommandLine& line) {
        std::vector<std::string> words = reversed;
        line.app.parse(words);
    };
    CommandLine first(settings_of_preset("standard"));
    if (const std::string problem = unknown_command(first.app, arguments); !problem.empty()) {
        std::cerr << "morphodesic: " << problem << "\n";
        return bad_usage;
    }
    if (!from_files.empty()) {
        CommandLine tried(settings_of_preset("standard"));
        const std::vector<std::string> problems = wrong_options(tried.app, arguments, from_files);
        for (const std::string& problem : problems) std::cerr << "morphodesic: " << problem << "\n";
        if (!problems.empty()) return bad_usage;
    }
    try {
        parse(first);
        for (const std::string& problem : {address_space_problem(), open_files_problem()}) {
            if (problem.empty()) continue;
            std::cerr << "morphodesic: " << problem << "\n";
            return environment_failed;
        }
        CommandLine second(defaults_after(first));
        parse(second);
        second.study.command = second.classify.command = repeat;
        if (second.study.study.empty() && !second.study.collection.empty()) {
            second.study.study = StudyFolder::of_collection(second.study.collection).path();
        }
        for (const RunSettings* settings : {&second.study.settings, &second.pair.settings, &second.classify.settings}) {
            std::vector<std::string> problems = settings->problems();
            if (settings == &second.study.settings) {
                const auto more = second.study.analysis.problems();
                problems.insert(problems.end(), more.begin(), more.end());
                // Before hours of work, not when the paths are drawn.
                if (std::string bad = path_choice_problem(second.study.paths); !bad.empty()) {
                    problems.push_back(std::move(bad));
                }
            } else if (settings == &second.classify.settings) {
                const auto more = second.classify.classify.problems();
                problems.insert(problems.end(), more.begin(), more.end());
            }
            for (const std::string& problem : problems) std::cerr << "morphodesic: " << problem << "\n";
            if (!problems.empty()) return bad_usage;
        }
        return second.action();
    } catch (const CLI::ParseError& error) {
        const std::string problem = problem_of(error, arguments);
        if (!problem.empty()) std::cerr << "morphodesic: " << problem << "\n";
        const int code = problem.empty() ? first.app.exit(error, std::cout, std::cerr) : bad_usage;
        const std::string hint = code == 0 ? "" : dash_hint(arguments);
        if (!hint.empty()) std::cerr << "morphodesic: " << hint << "\n";
        return code == 0 ? all_done : bad_usage;
    }
}

/// Exceptions become messages and exit codes.
int guarded_run(const std::vector<std::string>& arguments) {
    try {
        return parse_and_run(arguments);
    } catch (const datasets::Interrupted&) {
        std::cerr << "morphodesic: stopped while a file was read. To go on, give the same command again\n";
        return 128 + StopSignals::caught();
    } catch (const StoreError& error) {
        std::cerr << "morphodesic: " << error.what() << "\n";
        return environment_failed;
    } catch (const datasets::ReadError& error) {
        std::cerr << "morphodesic: " << error.what() << "\n";
    } catch (const std::invalid_argument& error) {
        std::cerr << "morphodesic: " << error.what() << "\n";
    } catch (const analysis::ParseError& error) {
        std::cerr << "morphodesic: " << error.what() << "\n";
    } catch (const std::bad_alloc&) {
        std::cerr << "morphodesic: not enough memory; use a lower --level or fewer --threads\n";
        return environment_failed;
    } catch (const fs::filesystem_error& error) {
        std::cerr << "morphodesic: " << error.path1().string() << ": " << error.code().message()
                  << "; check that it is there, and its permissions and those of its folders\n";
        return environment_failed;
    } catch (const std::exception& error) {
        std::cerr << "morphodesic: " << error.what() << "\n";
        return environment_failed;
    }
    return bad_usage;
}

}  // namespace

int run_program(const std::vector<std::string>& arguments) {
    open_standard_streams();
    const PrintableErrors printable_errors;
    StopSignals::install();
    datasets::set_interruption([] { return StopSignals::caught() != 0; });
    const int code = guarded_run(arguments);
    if ((code == all_done || code == some_failed) && output_lost()) {
        std::cerr << "morphodesic: standard output cannot be written; files of the command are whole, what was to be "
                     "printed is missing: free some space, then give the same command again\n";
        return environment_failed;
    }
    return code;
}

}  // namespace morphodesic::pipeline

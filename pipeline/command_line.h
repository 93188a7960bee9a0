#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "pipeline/commands.h"
#include "pipeline/commands/classify.h"
#include "pipeline/commands/datasets.h"
#include "pipeline/commands/figures.h"
#include "pipeline/commands/solid_datasets.h"
#include "pipeline/run_settings.h"

namespace morphodesic::pipeline {

/// One pass over the command line. A preset changes the defaults, so there are two: the first finds the preset.
struct CommandLine {
    CLI::App app{"Geodesics in shape space, and studies of shape collections made out of them."};
    StudyOptions study;
    PairOptions pair;
    ClassifyCommandOptions classify;
    DatasetOptions dataset;
    SolidDatasetOptions solids;
    FiguresOptions figures;
    ShardOptions shards;
    std::string preset, config;
    std::function<int()> action;

    explicit CommandLine(const RunSettings& defaults);

private:
    CLI::App* command(const std::string& name, const std::string& help, const std::string& footer);
    void add_config(CLI::App* command);
    void add_common(CLI::App* command, CommonOptions& common, bool computes);
    void add_settings(CLI::App* command, RunSettings& settings, bool with_import);
    void add_study_command(const std::string& name, const std::string& help, const std::string& footer,
                           int (*function)(const StudyOptions&), bool from_files, bool computes);
    void add_findings(CLI::App* command);
    void add_geodesic();
    void add_classify();
    void add_datasets();
    void add_figures();
    void add_shards();
};

}  // namespace morphodesic::pipeline

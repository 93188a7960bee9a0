#pragma once

#include <filesystem>
#include <vector>

#include "pipeline/classify_options.h"
#include "pipeline/commands.h"

namespace morphodesic::pipeline {

/// Options of classify QUERY...
struct ClassifyCommandOptions {
    CommonOptions common;
    std::vector<std::filesystem::path> queries;  ///< files, or folders of which all shapes are queries
    std::filesystem::path templates;             ///< folder of shapes, or a study
    std::string mask = "known";                  ///< known | none | auto, or a mask image for the one query
    std::filesystem::path truth;  ///< table file,label; empty: truth.csv beside the queries, if there is one
    std::filesystem::path out;    ///< folder for the results; empty: beside the first query
    bool leave_one_out = false;   ///< the templates are the queries
    int pictures = 12;            ///< queries whose paths are drawn on the page
    int filmstrips = 3;           ///< paths per query
    RunSettings settings;
    ClassifyOptions classify;
    std::string command;
};

int classify(const ClassifyCommandOptions& options);

}  // namespace morphodesic::pipeline

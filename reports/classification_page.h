#pragma once

#include <string>
#include <utility>
#include <vector>

#include "reports/report_model.h"

namespace morphodesic::reports {

/// A path from a query to a template.
struct Filmstrip {
    std::string title;
    std::vector<Picture> frames;
    ColourBar colour_bar;  ///< of the frames after the first
    Picture inferred;  ///< the query completed by this template; empty if nothing was hidden
};

struct RankedRow {
    std::string name, label;
    double distance = unknown, error = unknown, hidden_share = unknown;
    bool refined = true;  ///< false: estimated from coarse levels
};

struct ClassifiedQuery {
    std::string name, truth, verdict;  ///< verdict: one sentence
    bool right = true;                 ///< or truth unknown
    Picture picture;                   ///< what is visible, and in grey what is hidden
    std::vector<std::pair<std::string, std::string>> facts;
    std::vector<std::string> notes;
    std::vector<RankedRow> rows;  ///< nearest first
    std::vector<Filmstrip> strips;
};

/// One bin of a reliability diagram.
struct ReliabilityPoint {
    double confidence = 0.0, accuracy = 0.0;
    int count = 0;
};

/// Plain data of the page on a classification. NaN means unknown; strings are data, nothing is read as markup.
struct ClassificationPage {
    std::string title, headline, command;
    std::vector<std::pair<std::string, std::string>> tiles;  ///< value, what it is
    std::vector<std::string> classes;
    std::vector<std::vector<int>> confusion;  ///< row: true class; one more column: no answer; empty without labels
    std::vector<ReliabilityPoint> reliability;
    std::vector<double> hits_at_rank;  ///< of leave-one-out; empty else
    std::vector<ClassifiedQuery> queries;
    std::vector<std::pair<std::string, std::string>> settings;
    std::vector<std::string> remarks;
};

/// One self-contained page without scripts that asks no network for anything.
[[nodiscard]] std::string render_classification(const ClassificationPage& page);

/// A reliability diagram as SVG: what was said against what was true.
[[nodiscard]] std::string reliability_figure(const std::vector<ReliabilityPoint>& points);

}  // namespace morphodesic::reports

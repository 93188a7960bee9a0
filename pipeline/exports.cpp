#include "pipeline/exports.h"

#include <cmath>
#include <sstream>

#include "analysis/csv.h"
#include "analysis/matrix_csv.h"
#include "analysis/npy.h"
#include "pipeline/commands/summary.h"

namespace morphodesic::pipeline {
namespace {

/// Rows of an RFC 4180 file.
class CsvText {
public:
    explicit CsvText(const std::vector<std::string>& header) {
        for (const std::string& name : header) cell(name);
        end_row();
    }
    CsvText& cell(const std::string& text) { return put(analysis::csv_cell(std::string_view(text))); }
    CsvText& cell(double value) { return put(std::isfinite(value) ? analysis::csv_cell(value) : ""); }
    CsvText& cell(long value) { return put(std::to_string(value)); }
    void end_row() {
        text_ += '\n';
        first_ = true;
    }
    [[nodiscard]] const std::string& text() const { return text_; }

private:
    CsvText& put(const std::string& text) {
        if (!first_) text_ += ',';
        first_ = false;
        text_ += text;
        return *this;
    }
    std::string text_;
    bool first_ = true;
};

std::string pairs_csv(const StudyData& data) {
    CsvText csv({"a", "b", "label_a", "label_b", "distance", "error", "extrapolated_length", "path_length",
                 "path_energy", "total_energy", "min_det", "termination", "problem", "path_from", "level", "steps",
                 "seconds"});
    for (std::size_t i = 0; i < data.shapes.size(); ++i) {
        for (std::size_t j = i + 1; j < data.shapes.size(); ++j) {
            const StoredShape &a = data.shapes[i], &b = data.shapes[j];
            const auto& pair = data.pairs[data.index(i, j)];
            csv.cell(a.name).cell(b.name).cell(a.label).cell(b.label);
            csv.cell(data.distances(i, j)).cell(data.distances.error(i, j));
            if (pair && pair->failure.empty()) {
                csv.cell(pair->extrapolated_length).cell(pair->path_length).cell(pair->path_energy);
                csv.cell(pair->total_energy).cell(pair->min_det).cell(std::string(to_string(pair->termination)));
            } else {
                for (int column = 0; column < 6; ++column) csv.cell(std::string());
            }
            const bool same = a.content_digest == b.content_digest;
            csv.cell(pair ? pair->problem() : same ? "" : "not computed yet");
            csv.cell(!pair ? "" : data.first_is_a[data.index(i, j)] ? a.name : b.name);
            csv.cell(static_cast<long>(data.settings.geodesic.level));
            csv.cell(static_cast<long>(data.settings.geodesic.time_steps));
            csv.cell(pair ? pair->seconds : std::nan(""));
            csv.end_row();
        }
    }
    return csv.text();
}

std::string clusters_csv(const reports::ReportModel& model) {
    CsvText csv({"file", "label", "cluster", "medoid", "silhouette"});
    const reports::Clustering& clusters = model.clusterings.front();
    for (std::size_t i = 0; i < model.shapes.size(); ++i) {
        const int cluster = clusters.assignment[i];
        csv.cell(model.shapes[i].name).cell(model.shapes[i].label).cell(static_cast<long>(cluster));
        csv.cell(static_cast<long>(clusters.medoids[static_cast<std::size_t>(cluster)] == static_cast<int>(i)));
        csv.cell(model.trust.silhouettes[i]).end_row();
    }
    return csv.text();
}

std::string linkage_csv(const reports::ReportModel& model) {
    CsvText csv({"first", "second", "height", "size"});
    for (const reports::Merge& merge : model.linkages.front().merges) {
        csv.cell(static_cast<long>(merge.first)).cell(static_cast<long>(merge.second));
        csv.cell(merge.height).cell(static_cast<long>(merge.size)).end_row();
    }
    return csv.text();
}

std::string embedding_csv(const reports::ReportModel& model) {
    CsvText csv({"file", "label", "x", "y"});
    const reports::Embedding& plane = model.embeddings.front();
    for (std::size_t i = 0; i < model.shapes.size(); ++i) {
        csv.cell(model.shapes[i].name).cell(model.shapes[i].label);
        csv.cell(plane.coordinates[2 * i]).cell(plane.coordinates[2 * i + 1]).end_row();
    }
    return csv.text();
}

}  // namespace

void export_tables(const StudyData& data, const AnalysedStudy& analysed, const StudyFolder& folder) {
    std::ostringstream distances;
    analysis::write_distance_csv(distances, data.distances);
    folder.write("distances.csv", distances.str());
    std::ostringstream npy;
    analysis::write_npy(npy, analysis::NpyArray{data.distances.size(), data.distances.size(), data.distances.dense()});
    folder.write("distances.npy", npy.str());
    folder.write("pairs.csv", pairs_csv(data));
    if (analysed.model.shapes.empty()) return;
    folder.write("clusters.csv", clusters_csv(analysed.model));
    folder.write("linkage.csv", linkage_csv(analysed.model));
    folder.write("embedding.csv", embedding_csv(analysed.model));
}

void summarise(const reports::ReportModel& model, Summary& summary) {
    if (!model.clusterings.empty() && !model.clusterings.front().medoids.empty()) {
        summary.data["clusters"] = model.clusterings.front().medoids.size();
    }
    if (model.classes.empty() || !std::isfinite(model.classes.front().nearest_neighbour)) return;
    const double accuracy = model.classes.front().nearest_neighbour;
    summary.data["nearest_neighbour_accuracy"] = accuracy;
    char text[120];
    std::snprintf(text, sizeof text, "%.1f %% of the shapes have a nearest neighbour of their own class",
                  100 * accuracy);
    summary.lines.emplace_back(text);
}

}  // namespace morphodesic::pipeline

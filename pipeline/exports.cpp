#include "pipeline/exports.h"

#include <cmath>
#include <cstdio>
#include <map>
#include <sstream>

#include "analysis/csv.h"
#include "analysis/matrix_csv.h"
#include "analysis/npy.h"
#include "pipeline/commands/summary.h"
#include "pipeline/placed_queries.h"

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
                 "seconds", "refined"});
    for (std::size_t i = 0; i < data.shapes.size(); ++i) {
        for (std::size_t j = i + 1; j < data.shapes.size(); ++j) {
            const StoredShape &a = data.shapes[i], &b = data.shapes[j];
            const std::size_t p = data.index(i, j);
            const auto row = [&](const StoredGeodesic* pair, bool first_is_a) {
                csv.cell(a.name).cell(b.name).cell(a.label).cell(b.label);
                csv.cell(data.distances(i, j)).cell(data.distances.error(i, j));
                if (pair != nullptr && pair->failure.empty()) {
                    csv.cell(pair->extrapolated_length).cell(pair->path_length).cell(pair->path_energy);
                    csv.cell(pair->total_energy).cell(pair->min_det).cell(std::string(to_string(pair->termination)));
                } else {
                    for (int column = 0; column < 6; ++column) csv.cell(std::string());
                }
                const bool same = a.content_digest == b.content_digest;
                const char* without = same ? "" : data.damaged.contains(p) ? "damaged" : "not computed yet";
                csv.cell(pair != nullptr ? pair->problem() : without);
                csv.cell(pair == nullptr ? "" : first_is_a ? a.name : b.name);
                csv.cell(static_cast<long>(data.geodesic_of(p).level));
                csv.cell(static_cast<long>(data.geodesic_of(p).time_steps));
                csv.cell(pair != nullptr ? pair->seconds : std::nan(""));
                csv.cell(data.refined(p) ? 1L : 0L);
                csv.end_row();
            };
            row(data.geodesic(p), data.first_is_a[p]);
            if (data.backward_geodesic(p) != nullptr) row(data.backward_geodesic(p), !data.first_is_a[p]);
        }
    }
    return csv.text();
}

std::string shapes_csv(const StudyData& data) {
    CsvText csv({"name", "class", "volume", "scale", "volume_in_file_units", "notes"});
    for (const StoredShape& shape : data.shapes) {
        csv.cell(shape.name).cell(shape.label).cell(shape.volume).cell(shape.scale);
        csv.cell(shape.volume / std::pow(shape.scale, data.dimension));
        std::string notes;
        for (const std::string& note : shape.notes) notes += (notes.empty() ? "" : " ") + note;
        csv.cell(notes).end_row();
    }
    return csv.text();
}

std::string accuracy_csv(const reports::ReportModel& model) {
    CsvText csv({"ranking", "measure", "value"});
    for (const reports::ClassTable& table : model.classes) {
        const auto row = [&](const std::string& measure, double value) {
            csv.cell(table.name).cell(measure).cell(value).end_row();
        };
        for (const auto& [k, accuracy] : table.k_nearest) row(std::to_string(k) + "-NN", accuracy);
        row("bulls_eye", table.bulls_eye);
        row("mean_average_precision", table.mean_average_precision);
        for (const reports::PrecisionRecall& point : table.precision_recall) {
            row("precision_at_recall_" + analysis::csv_cell(point.recall), point.precision);
        }
        row("adjusted_rand", table.adjusted_rand);
        row("adjusted_mutual_information", table.adjusted_mutual_information);
        row("permanova_f", table.permanova_f);
        row("permanova_r2", table.permanova_r2);
        row("permanova_p", table.permanova_p);
    }
    return csv.text();
}

/// "100.0 % of the shapes have a nearest neighbour of their own class"; where that is not the share of all shapes, of
/// which. Nothing right can be found for the only member of a class, and nothing is known of a shape without one.
std::string nearest_neighbour_sentence(const reports::ReportModel& model) {
    std::map<std::string, long> members;
    for (const reports::ReportShape& shape : model.shapes) ++members[shape.label];
    const long unlabelled = members.contains("") ? members.at("") : 0;
    members.erase("");
    long alone = 0, counted = 0;
    for (const auto& [label, count] : members) (count == 1 ? alone : counted) += count;
    std::string shapes = "the shapes", others;
    const auto leave_out = [&](long count, const char* one, const char* many) {
        if (count > 0) others += (others.empty() ? " (" : ", ") + std::to_string(count) + (count == 1 ? one : many);
    };
    leave_out(alone, " is alone", " are alone");
    leave_out(unlabelled, " has no class", " have no class");
    if (!others.empty()) {
        shapes = "the " + std::to_string(counted) + " shapes " +
                 (alone > 0 ? "that are not alone in their class" : "with a class");
        others += ")";
    }
    char share[40];
    std::snprintf(share, sizeof share, "%.1f %% of ", 100 * model.classes.front().nearest_neighbour);
    return share + shapes + " have a nearest neighbour of their own class" + others;
}

}  // namespace

RunFiles tables_of(const StudyData& data, const AnalysedStudy& analysed) {
    RunFiles files;
    const auto add = [&](const char* name, std::string text) { files.written.emplace_back(name, std::move(text)); };
    const auto text = [](auto&& write) {
        std::ostringstream out;
        write(out);
        return out.str();
    };
    add("distances.csv", text([&](std::ostream& out) { analysis::write_distance_csv(out, data.distances); }));
    if (data.settings.pairs.neighbors > 0) {
        analysis::DistanceMatrix refined = data.distances;
        for (std::size_t i = 0; i < refined.size(); ++i) {
            for (std::size_t j = i + 1; j < refined.size(); ++j) {
                if (!data.refined(data.index(i, j))) refined.set(i, j, analysis::missing);
            }
        }
        add("distances_refined.csv", text([&](std::ostream& out) { analysis::write_distance_csv(out, refined); }));
    } else {
        files.dropped.emplace_back("distances_refined.csv");
    }
    add("distances.npy", text([&](std::ostream& out) {
            const std::size_t n = data.distances.size();
            analysis::write_npy(out, analysis::NpyArray{n, n, data.distances.dense()});
        }));
    if (!data.given) {
        add("pairs.csv", pairs_csv(data));
        add("shapes.csv", shapes_csv(data));
    }
    const analysis::AnalysisResult& result = analysed.analysis;
    add("clusters.csv", text([&](std::ostream& out) { analysis::write_clusters_csv(out, result, data.distances); }));
    add("linkage.csv", text([&](std::ostream& out) { analysis::write_linkage_csv(out, result); }));
    add("embedding.csv", text([&](std::ostream& out) { analysis::write_embedding_csv(out, result); }));
    add("accuracy.csv", accuracy_csv(analysed.model));
    if (analysed.model.placed.empty()) {
        files.dropped.emplace_back("placed.csv");
    } else {
        add("placed.csv", placed_csv(analysed.model));
    }
    return files;
}

void summarise(const reports::ReportModel& model, Summary& summary) {
    for (const reports::Failure& failure : model.failures) {
        if (failure.cut_off) summary.cut_off.push_back({failure.a, "", failure.a + ": " + failure.reason, true});
    }
    summary.data["shapes_left_out"] = summary.cut_off.size();
    if (!model.clusterings.empty() && !model.clusterings.front().medoids.empty()) {
        summary.data["clusters"] = model.clusterings.front().medoids.size();
    }
    if (model.classes.empty() || !std::isfinite(model.classes.front().nearest_neighbour)) return;
    summary.data["nearest_neighbour_accuracy"] = model.classes.front().nearest_neighbour;
    summary.lines.push_back(nearest_neighbour_sentence(model));
}

}  // namespace morphodesic::pipeline

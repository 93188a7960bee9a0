#include "pipeline/classify_results.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "analysis/csv.h"
#include "pipeline/run_settings.h"
#include "reports/json_number.h"

namespace morphodesic::pipeline {
namespace {

using Json = nlohmann::ordered_json;
using reports::json_number;

Json share(long part, long whole) {
    return whole > 0 ? Json(static_cast<double>(part) / static_cast<double>(whole)) : Json(nullptr);
}

std::string cell(const std::string& text) {
    return analysis::csv_cell(std::string_view(text));
}
std::string cell(double value) {
    return std::isfinite(value) ? analysis::csv_cell(value) : "";
}

Json to_json(const analysis::Reliability& reliability) {
    Json bins = Json::array();
    for (const auto& bin : reliability.bins) {
        bins.push_back({{"low", bin.low},
                        {"high", bin.high},
                        {"count", bin.count},
                        {"mean_confidence", json_number(bin.mean_confidence)},
                        {"accuracy", json_number(bin.accuracy)}});
    }
    return {{"expected_calibration_error", json_number(reliability.expected_calibration_error)},
            {"brier_score", json_number(reliability.brier_score)},
            {"bins", std::move(bins)}};
}

Json to_json(const analysis::ConfusionMatrix& confusion) {
    Json rows = Json::array();
    for (std::size_t i = 0; i < confusion.classes.size(); ++i) {
        Json row = Json::array();
        for (std::size_t j = 0; j <= confusion.classes.size(); ++j) row.push_back(confusion(i, j));
        rows.push_back(std::move(row));
    }
    return {{"classes", confusion.classes}, {"rows_true_columns_found", std::move(rows)}};
}

bool is_accepted(const QueryResult& query) {
    return query.problem.empty() && query.answer.rejection == analysis::Rejection::accepted;
}

Json to_json(const QueryResult& q) {
    Json json = {{"file", q.name}, {"truth", q.truth.empty() ? Json(nullptr) : Json(q.truth)}};
    if (!q.problem.empty()) {
        json["problem"] = q.problem;
        return json;
    }
    const auto& a = q.answer;
    json["answer"] = is_accepted(q) ? Json(a.label) : Json(nullptr);
    json["rejected"] = is_accepted(q) ? Json(nullptr) : Json(analysis::to_string(a.rejection));
    json["best_class"] = a.label.empty() ? Json(nullptr) : Json(a.label);
    json["confidence"] = json_number(a.confidence);
    json["margin"] = json_number(a.margin);
    json["separated"] = a.separated;
    json["novelty"] = json_number(a.novelty);
    json["mask"] = q.mask;
    if (!q.templates.empty()) {
        json["hypothesis"] = q.templates.front().hypothesis;
        json["hidden_share"] = json_number(q.templates.front().hidden_share);
    }
    Json classes = Json::array();
    for (const auto& c : a.classes) {
        const auto nearest = std::find_if(q.templates.begin(), q.templates.end(),
                                          [&](const TemplateRow& t) { return t.label == c.name; });
        classes.push_back({{"class", c.name},
                           {"distance", json_number(c.distance)},
                           {"error", json_number(c.error)},
                           {"nearest", nearest == q.templates.end() ? Json(nullptr) : Json(nearest->name)}});
    }
    json["classes"] = std::move(classes);
    Json templates = Json::array();
    for (const TemplateRow& t : q.templates) {
        templates.push_back({{"template", t.name},
                             {"class", t.label},
                             {"distance", json_number(t.distance)},
                             {"error", json_number(t.error)},
                             {"refined", t.refined},
                             {"level", t.level},
                             {"steps", t.time_steps},
                             {"turn_degrees", json_number(t.turn)},
                             {"scale", json_number(t.scale)},
                             {"hypothesis", t.hypothesis},
                             {"hidden_share", json_number(t.hidden_share)}});
    }
    json["templates"] = std::move(templates);
    json["notes"] = q.notes;
    json["seconds"] = q.seconds;
    return json;
}

}  // namespace

void ClassificationRun::evaluate() {
    const std::set<std::string> known(classes.begin(), classes.end());
    std::vector<std::string> truths;
    std::vector<analysis::NeighbourPrediction> predictions;
    std::vector<double> confidences;
    std::vector<unsigned char> right_answers;
    for (const QueryResult& q : queries) {
        if (q.truth.empty()) continue;
        if (!q.problem.empty()) {
            labelled_failed += known.contains(q.truth) ? 1 : 0;
            continue;
        }
        if (!known.contains(q.truth)) {
            ++foreign;
            if (!is_accepted(q)) ++foreign_rejected;
            continue;
        }
        const bool good = q.answer.label == q.truth;
        ++labelled;
        right += good ? 1 : 0;
        if (is_accepted(q)) {
            ++this->accepted;
            accepted_right += good ? 1 : 0;
        }
        predictions.push_back({truths.size(), q.answer.label});
        truths.push_back(q.truth);
        if (!std::isnan(q.answer.confidence)) {
            confidences.push_back(q.answer.confidence);
            right_answers.push_back(good ? 1 : 0);
        }
    }
    if (labelled == 0) return;
    // Classes that only occur as answers need a column, too: they come in as items that are no predictions.
    for (const std::string& name : classes) truths.push_back(name);
    confusion = analysis::confusion_matrix(truths, predictions);
    if (!confidences.empty()) reliability = analysis::reliability(confidences, right_answers);
}

Json to_json(const ClassificationRun& run) {
    Json json = {{"schema", 1}, {"templates", run.templates}, {"template_count", run.template_count}};
    json["classes"] = run.classes;
    json["accuracy"] = share(run.right, run.labelled);
    json["labelled"] = run.labelled;
    json["labelled_failed"] = run.labelled_failed;
    json["right"] = run.right;
    json["accepted"] = run.accepted;
    json["accuracy_of_accepted"] = share(run.accepted_right, run.accepted);
    json["foreign"] = run.foreign;
    json["foreign_rejected"] = run.foreign_rejected;
    json["seconds"] = run.seconds;
    json["queries_per_second"] =
        run.seconds > 0 ? Json(static_cast<double>(run.queries.size()) / run.seconds) : Json(nullptr);
    Json settings = {{"preset", run.preset}, {"normalize", run.normalize}, {"mask", run.mask}};
    ClassifyOptions::for_each_field(run.options,
                                    [&](const char* name, const auto& value, const char*) { settings[name] = value; });
    GeodesicOptions::for_each_field(run.geodesic,
                                    [&](const char* name, const auto& value, const char*) { settings[name] = value; });
    json["settings"] = std::move(settings);
    if (run.calibration) {
        json["calibration"] = {{"templates", run.calibration->queries},
                               {"right", run.calibration->right},
                               {"accuracy", json_number(run.calibration->accuracy)},
                               {"novelty_limit", json_number(run.calibration->novelty_limit)},
                               {"novelty_exponent", run.calibration->novelty_exponent},
                               {"strangers", run.calibration->strangers},
                               {"strangers_rejected", run.calibration->strangers_rejected},
                               {"reliability", to_json(run.calibration->reliability)}};
    }
    if (run.retrieval) {
        json["retrieval"] = {{"queries", run.retrieval->queries},
                             {"bulls_eye", json_number(run.retrieval->bulls_eye)},
                             {"mean_average_precision", json_number(run.retrieval->mean_average_precision)},
                             {"hits_at_rank", run.retrieval->hits_at_rank},
                             {"possible_at_rank", run.retrieval->possible_at_rank}};
    }
    if (run.confusion) json["confusion"] = to_json(*run.confusion);
    if (run.reliability) json["reliability"] = to_json(*run.reliability);
    Json queries = Json::array();
    for (const QueryResult& q : run.queries) queries.push_back(to_json(q));
    json["queries"] = std::move(queries);
    json["remarks"] = run.remarks;
    return json;
}

std::string queries_csv(const ClassificationRun& run) {
    std::string text =
        "file,truth,answer,best_class,rejected,confidence,margin,separated,novelty,nearest,distance,error,mask,"
        "hypothesis,hidden_share,seconds,problem\n";
    for (const QueryResult& q : run.queries) {
        const bool usable = q.problem.empty();
        text += cell(q.name) + "," + cell(q.truth) + "," + cell(is_accepted(q) ? q.answer.label : "") + "," +
                cell(q.answer.label) + "," +
                cell(!usable || is_accepted(q) ? "" : analysis::to_string(q.answer.rejection)) + ",";
        if (usable) {
            text += cell(q.answer.confidence) + "," + cell(q.answer.margin) + "," + (q.answer.separated ? "1" : "0") +
                    "," + cell(q.answer.novelty) + ",";
        } else {
            text += ",,,,";
        }
        if (usable && !q.templates.empty()) {
            const TemplateRow& best = q.templates.front();
            text += cell(best.name) + "," + cell(best.distance) + "," + cell(best.error) + "," + cell(q.mask) + "," +
                    cell(best.hypothesis) + "," + cell(best.hidden_share) + "," + cell(q.seconds) + ",";
        } else {
            text += ",,,,,,,";
        }
        text += cell(q.problem) + "\n";
    }
    return text;
}

std::string ranking_csv(const ClassificationRun& run) {
    std::string text = "file,rank,template,class,distance,error,refined,level,steps,hypothesis,hidden_share\n";
    for (const QueryResult& q : run.queries) {
        for (std::size_t r = 0; r < q.templates.size(); ++r) {
            const TemplateRow& t = q.templates[r];
            text += cell(q.name) + "," + std::to_string(r + 1) + "," + cell(t.name) + "," + cell(t.label) + "," +
                    cell(t.distance) + "," + cell(t.error) + "," + (t.refined ? "1" : "0") + "," +
                    std::to_string(t.level) + "," + std::to_string(t.time_steps) + "," + cell(t.hypothesis) + "," +
                    cell(t.hidden_share) + "\n";
        }
    }
    return text;
}

}  // namespace morphodesic::pipeline

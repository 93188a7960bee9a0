#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>

#include "reports/report.h"
#include "tests/reports/evil_names.h"
#include "tests/reports/synthetic_model.h"
#include "tests/support/json_schema.h"

namespace morphodesic::reports {
namespace {

using nlohmann::json;

std::string read(const std::string& name) {
    std::ifstream file(std::string(MORPHODESIC_REPORTS_DIR) + "/" + name, std::ios::binary);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

std::string schema_errors(const json& document, const std::string& schema_file) {
    return tests::schema_errors(document, std::string(MORPHODESIC_REPORTS_DIR) + "/" + schema_file);
}

TEST(ReportJson, HasExactlyTheDocumentedKeys) {
    auto model = tests::synthetic_model({.queries = 2});
    model.placed.push_back({"far away.png", -1, unknown, {{}, {}}, {unknown, unknown}});
    EXPECT_EQ(schema_errors(json::parse(to_json(model)), "report.schema.json"), "");
    model.volumes.reset();
    model.compare.reset();
    EXPECT_EQ(schema_errors(json::parse(to_json(model)), "report.schema.json"), "");
    EXPECT_EQ(schema_errors(json::parse(to_json(ReportModel{})), "report.schema.json"), "");
}

TEST(ReportJson, SchemaNoticesMissingAndUnknownKeys) {
    const json good = json::parse(to_json(tests::synthetic_model()));
    for (const auto& [key, value] : good.items()) {
        json less = good;
        less.erase(key);
        EXPECT_NE(schema_errors(less, "report.schema.json"), "") << key;
    }
    json more = good;
    more["trust"]["surprise"] = 1;
    EXPECT_NE(schema_errors(more, "report.schema.json"), "");
}

TEST(ReportJson, EveryKeyOfTheSchemasIsExplained) {
    const std::string format = read("FORMAT.md");
    std::function<void(const json&)> visit = [&](const json& node) {
        if (node.is_object()) {
            if (node.contains("properties")) {
                for (const auto& [key, value] : node["properties"].items()) {
                    EXPECT_NE(format.find("`" + key + "`"), std::string::npos) << key << " is not in FORMAT.md";
                }
            }
            for (const auto& [key, value] : node.items()) visit(value);
        } else if (node.is_array()) {
            for (const auto& value : node) visit(value);
        }
    };
    visit(json::parse(read("report.schema.json")));
    visit(json::parse(read("geodesic.schema.json")));
}

TEST(ReportJson, DoublesSurviveTheRoundTrip) {
    auto model = tests::synthetic_model({.shapes = 5, .classes = 2});
    model.distances[0] = 0.1 + 0.2;
    model.distances[1] = 5e-324;
    model.distances[2] = 1.7976931348623157e308;
    model.distances[3] = unknown;
    const json document = json::parse(to_json(model));
    for (std::size_t k = 0; k < model.distances.size(); ++k) {
        if (k == 3)
            EXPECT_TRUE(document["distances"][k].is_null());
        else
            EXPECT_EQ(document["distances"][k].get<double>(), model.distances[k]);
    }
    EXPECT_EQ(document["linkages"][0]["merges"][0][2].get<double>(), model.linkages[0].merges[0].height);
}

TEST(ReportJson, NamesAreKeptAsTheyAre) {
    auto model = tests::synthetic_model({.shapes = static_cast<int>(tests::evil_names.size()), .classes = 3});
    for (std::size_t i = 0; i < model.shapes.size(); ++i) model.shapes[i].name = tests::evil_names[i];
    const json document = json::parse(to_json(model));
    for (std::size_t i = 0; i < model.shapes.size(); ++i) {
        const std::string& name = tests::evil_names[i];
        if (name.find('\xFF') == std::string::npos)
            EXPECT_EQ(document["shapes"][i]["name"], name);
        else
            EXPECT_EQ(document["shapes"][i]["name"], "not utf-8 \xEF\xBF\xBD\xEF\xBF\xBD.png");
    }
}

TEST(ReportJson, SameModelSameText) {
    EXPECT_EQ(to_json(tests::synthetic_model()), to_json(tests::synthetic_model()));
}

TEST(ReportJson, RefusesInconsistentModels) {
    const auto broken = [](const std::function<void(ReportModel&)>& change) {
        auto model = tests::synthetic_model({.queries = 1});
        EXPECT_TRUE(problems(model).empty());
        change(model);
        return problems(model).size();
    };
    EXPECT_GT(broken([](auto& m) { m.distances.pop_back(); }), 0U);
    EXPECT_GT(broken([](auto& m) { m.distances[0] = -1; }), 0U);
    EXPECT_GT(broken([](auto& m) { m.linkages[0].leaf_order[0] = m.linkages[0].leaf_order[1]; }), 0U);
    EXPECT_GT(broken([](auto& m) { m.linkages[0].merges[0].second = 99; }), 0U);
    EXPECT_GT(broken([](auto& m) { m.embeddings[0].coordinates.push_back(0); }), 0U);
    EXPECT_GT(broken([](auto& m) { m.clusterings[0].assignment[0] = 77; }), 0U);
    EXPECT_GT(broken([](auto& m) { m.spanning_tree[0].b = 12; }), 0U);
    EXPECT_GT(broken([](auto& m) { m.placed[0].nearest = 12; }), 0U);
    EXPECT_GT(broken([](auto& m) { m.placed[0].positions.pop_back(); }), 0U);
    EXPECT_GT(broken([](auto& m) { m.placed[0].positions[0].push_back(0); }), 0U);
    EXPECT_GT(broken([](auto& m) { m.paths[0].b = m.paths[0].a; }), 0U);
    EXPECT_GT(broken([](auto& m) { m.trust.silhouettes.pop_back(); }), 0U);
    EXPECT_GT(broken([](auto& m) { m.classes[0].confusion.pop_back(); }), 0U);
    auto model = tests::synthetic_model();
    model.distances.clear();
    EXPECT_THROW((void)to_json(model), std::invalid_argument);
    EXPECT_THROW((void)render_html(model), std::invalid_argument);
}

}  // namespace
}  // namespace morphodesic::reports

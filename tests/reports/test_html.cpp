#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>

#include "reports/report.h"
#include "tests/reports/evil_names.h"
#include "tests/reports/synthetic_model.h"

namespace morphodesic::reports {
namespace {

constexpr std::size_t size_limit = 20'000'000;

std::size_t occurrences(const std::string& text, const std::string& what) {
    std::size_t count = 0;
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) ++count;
    return count;
}

/// The data block of a page.
nlohmann::json page_data(const std::string& html) {
    const std::string open = "<script type=\"application/json\" id=\"data\">";
    const std::size_t start = html.find(open) + open.size();
    return nlohmann::json::parse(html.substr(start, html.find("</script>", start) - start));
}

ReportModel evil_model() {
    auto model = tests::synthetic_model({.shapes = static_cast<int>(tests::evil_names.size()), .classes = 3});
    for (std::size_t i = 0; i < model.shapes.size(); ++i) {
        model.shapes[i].name = model.shapes[i].label = tests::evil_names[i];
        model.shapes[i].notes = {tests::evil_names[i]};
        model.shapes[i].thumbnail.alt = tests::evil_names[i];
        model.failures.push_back({tests::evil_names[i], "", tests::evil_names[i]});
    }
    model.study = model.command = model.collection = tests::evil_names[1];
    return model;
}

TEST(ReportHtml, IsOneFileWithAPolicyThatForbidsTheNetwork) {
    const std::string html = render_html(tests::synthetic_model());
    EXPECT_NE(html.find("default-src 'none'; img-src data:; script-src 'sha256-"), std::string::npos);
    EXPECT_EQ(occurrences(html, "<script"), 2U);
    EXPECT_EQ(occurrences(html, "</script"), 2U);
    EXPECT_EQ(html.find("unsafe-eval"), std::string::npos);
    const std::string head = html.substr(0, html.find("<script"));
    EXPECT_FALSE(std::regex_search(head, std::regex("(src|href)=\"(https?:|//|/)")));
    EXPECT_EQ(html.find("@import"), std::string::npos);
    EXPECT_EQ(html.find("url("), html.find("url(", html.find("vegaModules")));  // none in the style sheet
}

TEST(ReportHtml, HasLandmarksAndLanguage) {
    const std::string html = render_html(tests::synthetic_model());
    for (const char* part : {"<html lang=\"en\">", "<main id=\"main\"", "<nav id=\"contents\" aria-label=", "<header",
                             "<footer", "aria-live=\"polite\"", "class=\"skip\"", "<noscript>", "name=\"viewport\"",
                             "prefers-color-scheme: dark", "@media print"}) {
        EXPECT_NE(html.find(part), std::string::npos) << part;
    }
}

TEST(ReportHtml, NamesCannotBecomeMarkup) {
    const std::string html = render_html(evil_model());
    EXPECT_EQ(occurrences(html, "<script"), 2U);
    EXPECT_EQ(occurrences(html, "</script"), 2U);
    EXPECT_EQ(html.find("<img src=x"), std::string::npos);
    const std::size_t data = html.find("id=\"data\">");
    const std::string block = html.substr(data + 10, html.find("</script>", data) - data - 10);
    EXPECT_EQ(block.find_first_of("<>&"), std::string::npos);
    const auto document = page_data(html);
    EXPECT_EQ(document["shapes"][0]["name"], tests::evil_names[0]);
    EXPECT_EQ(document["shapes"][1]["name"], tests::evil_names[1]);
    EXPECT_EQ(document["shapes"][8]["name"], tests::evil_names[8]);
    EXPECT_NE(html.find("<title>&lt;/script&gt;&lt;script&gt;alert(2)"), std::string::npos);
}

TEST(ReportHtml, HeadlineSaysWhatFailed) {
    auto model = tests::synthetic_model();
    EXPECT_NE(render_html(model).find("12 shapes compared in 66 pairs; failed: 1 file."), std::string::npos);
    model.failures.push_back({"a.png", "b.png", "the solve did not converge"});
    model.pairs_done = 65;
    EXPECT_NE(render_html(model).find("12 shapes compared in 65 pairs (of 66); failed: 1 file and 1 pair."),
              std::string::npos);
    model.failures = {{"a.png", "", "nothing joins it to the others", true}};
    EXPECT_NE(render_html(model).find("(of 66); cut off from the others: 1 shape."), std::string::npos);
    model.failures.clear();
    EXPECT_NE(render_html(model).find("; nothing failed."), std::string::npos);
}

TEST(ReportHtml, FiveHundredShapesStayBelowTwentyMegabytes) {
    auto model = tests::synthetic_model({.shapes = 500, .classes = 25, .paths = 40});
    const std::string html = render_html(model);
    EXPECT_LT(html.size(), size_limit);
    EXPECT_EQ(page_data(html)["paths"].size(), model.paths.size());
    // Far more filmstrips than fit: the page stays small, says how many are left out, and keeps the first.
    const auto one = model.paths.at(0);
    while (model.paths.size() < 600) model.paths.push_back(one);
    std::size_t pictures = 0;
    for (const auto& path : model.paths) {
        for (const auto& frame : path.frames) pictures += frame.picture.bytes.size();
    }
    ASSERT_GT(pictures, size_limit);
    const std::string full = render_html(model);
    EXPECT_LT(full.size(), size_limit);
    const auto data = page_data(full);
    EXPECT_GT(data["paths_left_out"].get<std::size_t>(), 0U);
    EXPECT_EQ(data["paths"].size() + data["paths_left_out"].get<std::size_t>(), 600U);
    EXPECT_EQ(data["paths"][0]["b"], model.paths[0].b);
}

TEST(ReportHtml, TwoThousandShapesStayBelowTwentyMegabytes) {
    ReportModel model;
    const auto thumbnail = tests::synthetic_model({.shapes = 1, .classes = 1, .paths = 0}).shapes[0];
    model.shapes.assign(2000, thumbnail);
    model.distances.assign(2000 * 1999 / 2, 0.123456789);
    model.errors.assign(model.distances.size(), 0.00123456789);
    for (const char* method : {"SMACOF", "non-metric SMACOF", "classical MDS", "Isomap"}) {
        for (const int dimension : {2, 3}) {
            const std::vector<double> coordinates(2000 * static_cast<std::size_t>(dimension), 0.123456789);
            Embedding map{method, dimension, coordinates, 0.1, std::vector<double>(2000, 0.000512345), {}};
            if (map.method == "non-metric SMACOF") map.disparities = model.distances;
            model.embeddings.push_back(std::move(map));
        }
    }
    const std::string html = render_html(model);
    EXPECT_LT(html.size(), size_limit);
    const auto data = page_data(html);
    EXPECT_EQ(data["errors_left_out"], true);
    EXPECT_EQ(data["distances"][0], 0.1235);
}

TEST(ReportHtml, OddStudiesAreRendered) {
    EXPECT_NO_THROW((void)render_html(ReportModel{}));
    auto one = tests::synthetic_model({.shapes = 1, .classes = 1, .paths = 0});
    EXPECT_NO_THROW((void)render_html(one));
    auto bare = tests::synthetic_model({.shapes = 3, .classes = 1, .paths = 0, .labelled = false});
    bare.linkages.clear(), bare.clusterings.clear(), bare.embeddings.clear(), bare.volumes.reset(),
        bare.compare.reset();
    for (double& d : bare.distances) d = unknown;
    EXPECT_NO_THROW((void)render_html(bare));
}

}  // namespace
}  // namespace morphodesic::reports

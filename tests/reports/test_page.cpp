/// Opens reports in headless Chromium: nothing here looks at how the page is made, only at what a reader gets.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "reports/report.h"
#include "tests/reports/browser.h"
#include "tests/reports/evil_names.h"
#include "tests/reports/synthetic_model.h"

namespace morphodesic::reports {
namespace {

using nlohmann::json;
using testing::IsEmpty;

class Page : public testing::Test {
protected:
    static void SetUpTestSuite() {
        if (!tests::Browser::missing().empty()) return;
        folder_ = std::filesystem::temp_directory_path() / ("morphodesic-page-" + std::to_string(getpid()));
        std::filesystem::create_directories(folder_);
        browser_ = std::make_unique<tests::Browser>(folder_ / "profile");
    }
    static void TearDownTestSuite() {
        browser_.reset();
        if (!folder_.empty()) std::filesystem::remove_all(folder_);
    }
    void SetUp() override {
        if (const std::string why = tests::Browser::missing(); !why.empty()) GTEST_SKIP() << why;
        browser_->devtools("Emulation.clearDeviceMetricsOverride");
        browser_->devtools("Emulation.setEmulatedMedia", {{"media", ""}, {"features", json::array()}});
    }
    void write(const std::string& html) { std::ofstream(folder_ / "report.html", std::ios::binary) << html; }
    void show(const ReportModel& model) {
        write(render_html(model));
        browser_->open(folder_ / "report.html");
        ASSERT_TRUE(browser_->wait_for("return document.documentElement.dataset.ready"));
    }
    void expect_quiet() {
        EXPECT_THAT(browser_->console_errors(), IsEmpty());
        for (const auto& url : browser_->requests()) EXPECT_EQ(url, "file://" + (folder_ / "report.html").string());
    }
    /// Middle of an element that the script returns, scrolled into view.
    json middle(const std::string& element, const json& arguments = json::array()) {
        return browser_->run(
            "const e = (function () { " + element +
                " }).apply(null, arguments); if (!e) return null;"
                "e.scrollIntoView({block: 'center', behavior: 'instant'}); const r = e.getBoundingClientRect();"
                "return {x: r.x + r.width / 2, y: r.y + r.height / 2, width: r.width, height: r.height, left: r.left, "
                "top: r.top};",
            arguments);
    }
    void click_shape(int shape) {
        const json at = middle(
            "return [...document.querySelectorAll('#embedding-chart :is(.shape > path, .shape > g > "
            ".background)')].find(p => p.__data__.datum.i === "
            "arguments[0]);",
            {shape});
        ASSERT_TRUE(at.is_object());
        browser_->click(at["x"], at["y"]);
    }
    std::string text(const std::string& selector) {
        return browser_->run("const e = document.querySelector(arguments[0]); return e ? e.textContent : '';",
                             {selector});
    }
    json chosen() {
        return browser_->run(
            "return [Number(document.getElementById('pair-a').value), "
            "Number(document.getElementById('pair-b').value)];");
    }

    inline static std::filesystem::path folder_;
    inline static std::unique_ptr<tests::Browser> browser_;
};

/// The watcher sees what it is there for: a page that asks the network and throws is caught.
TEST_F(Page, WatcherSeesRequestsAndErrors) {
    write(
        "<!DOCTYPE html><html><body><img "
        "src='http://127.0.0.1:9/x.png'><script>undefinedFunction()</script></body></html>");
    browser_->open(folder_ / "report.html");
    ASSERT_TRUE(browser_->wait_for("return document.readyState === 'complete'"));
    EXPECT_THAT(browser_->requests(), testing::Contains("http://127.0.0.1:9/x.png"));
    EXPECT_THAT(browser_->console_errors(), testing::Contains(testing::HasSubstr("undefinedFunction")));
}

TEST_F(Page, DrawsEveryChartWithoutErrorsOrRequests) {
    show(tests::synthetic_model({.shapes = 9, .classes = 3, .paths = 3}));
    for (const auto& [chart, marks] : std::vector<std::pair<std::string, int>>{{"glance-graph", 9 + 8},
                                                                               {"glance-matrix", 81 + 9 + 9},
                                                                               {"matrix-chart", 81 + 9 + 9 + 24},
                                                                               {"embedding-chart", 9 + 8},
                                                                               {"pair-energies", 8},
                                                                               {"pr-chart", 1},
                                                                               {"shepard-chart", 36},
                                                                               {"silhouette-chart", 9},
                                                                               {"compare-chart", 36},
                                                                               {"by-distance", 24 + 9},
                                                                               {"by-volume", 24 + 9}}) {
        const json drawn = browser_->run(
            "return document.querySelectorAll('#' + arguments[0] + ' svg .role-mark > :is(path, line, image, "
            "text)').length",
            {chart});
        EXPECT_GE(drawn.get<int>(), marks) << chart;
        EXPECT_GT(
            middle("return document.querySelector('#' + arguments[0] + ' svg');", {chart})["height"].get<double>(), 60)
            << chart;
    }
    // The matrix is a picture: it has many colours.
    EXPECT_TRUE(browser_
                    ->run("return [...document.querySelectorAll('#matrix-chart image')].some(i => "
                          "(i.getAttribute('href') || i.getAttribute('xlink:href') || '').length > 300)")
                    .get<bool>());
    EXPECT_EQ(text("h1"), "Leaves of 3 kinds");
    expect_quiet();
}

TEST_F(Page, SharesOfRightNeighboursSayWhichShapesTheyLeaveOut) {
    auto model = tests::synthetic_model({.shapes = 9, .classes = 3, .paths = 0});
    show(model);
    EXPECT_THAT(text("#summary .tiles"), testing::HasSubstr("nearest neighbour of the same class"));
    EXPECT_THAT(text("#summary .tiles"), testing::Not(testing::HasSubstr("alone")));
    EXPECT_THAT(text("#classes"), testing::Not(testing::HasSubstr("alone")));
    model.shapes[0].label = "newt", model.shapes[1].label = "", model.shapes[2].label = "toad";
    show(model);
    EXPECT_THAT(text("#summary .tiles"),
                testing::HasSubstr(
                    "nearest neighbour of the same class, of 6 shapes; 2 are alone in their classes, 1 has no class"));
    EXPECT_THAT(text("#classes"), testing::HasSubstr("recall and confusion are of 6 shapes: 2 are alone in"));
    expect_quiet();
}

TEST_F(Page, ClickOnTwoShapesShowsTheirPath) {
    auto model = tests::synthetic_model({.shapes = 9, .classes = 3, .paths = 1});
    model.paths[0].a = 7, model.paths[0].b = 2;
    show(model);
    const json box = middle("return document.getElementById('embedding-pictures');");
    browser_->click(box["x"], box["y"]);
    ASSERT_TRUE(
        browser_->wait_for("return document.querySelectorAll('#embedding-chart :is(.shape > path, .shape > g > "
                           ".background)').length === 9 && "
                           "!document.querySelector('#embedding-chart image')"));
    click_shape(3);
    EXPECT_THAT(text("#pick"), testing::HasSubstr("now choose the second shape"));
    click_shape(5);
    EXPECT_EQ(chosen(), json({3, 5}));
    EXPECT_EQ(browser_->run("return document.getElementById('film')"), nullptr);
    EXPECT_EQ(text("#pair pre"),
              "morphodesic geodesic --preset fast --out clover-2-oak-2.geodesic leaves/clover/clover-2.png "
              "leaves/oak/oak-2.png");
    click_shape(7);
    click_shape(2);
    EXPECT_EQ(chosen(), json({7, 2}));
    EXPECT_EQ(browser_->run("return document.querySelectorAll('#film .frame img').length"), 9);
    EXPECT_EQ(text("#pair pre"), "");
    // The slider goes through time.
    const json first = browser_->run("return document.querySelector('#film .stage').src");
    browser_->run("const s = document.getElementById('time'); s.value = 8; s.dispatchEvent(new Event('input'));");
    EXPECT_NE(browser_->run("return document.querySelector('#film .stage').src"), first);
    EXPECT_EQ(text("#film output"), "t = 1");
    for (const char* part : {"path length", "certificate: min det Dφ ≥", "(one-to-one)", "converged", "±"}) {
        EXPECT_THAT(text("#pair-body"), testing::HasSubstr(part));
    }
    EXPECT_THAT(text("#film .colour-bar"), testing::HasSubstr("dissipation rate density [1/time²]"));
    expect_quiet();
}

TEST_F(Page, CellsOfTheMatrixAndKeysChoosePairs) {
    const auto model = tests::synthetic_model({.shapes = 9, .classes = 3, .paths = 1});
    show(model);
    const auto& order = model.linkages[0].leaf_order;
    const json field = middle("return document.querySelector('#matrix-chart .field > path');");
    const double cell = field["width"].get<double>() / 9;
    browser_->click(field["left"].get<double>() + 6.5 * cell,
                    field["top"].get<double>() + 2.5 * cell);  // row 2, column 6
    ASSERT_TRUE(browser_->wait_for("return document.getElementById('live').textContent"));
    EXPECT_EQ(chosen(), json({order[2], order[6]}));
    EXPECT_THAT(text("#live"), testing::HasSubstr("distance"));
    ASSERT_TRUE(browser_->wait_for("return !document.getElementById('tip').hidden"));  // the mouse still rests there
    EXPECT_THAT(text("#tip"), testing::HasSubstr(model.shapes[static_cast<std::size_t>(order[2])].name));
    EXPECT_EQ(browser_->run("return document.querySelectorAll('#tip img').length"), 2);
    browser_->run("document.getElementById('matrix-chart').focus()");
    browser_->key("ArrowDown", 40);
    browser_->key("Enter", 13);
    EXPECT_EQ(chosen(), json({order[3], order[6]}));
    // By name: the rows are in another order, the chosen pair stays.
    browser_->run(
        "const s = document.getElementById('matrix-order'); s.value = 'name'; s.dispatchEvent(new Event('change'));");
    ASSERT_TRUE(browser_->wait_for("return !document.querySelector('#matrix-chart .branch')"));
    EXPECT_EQ(chosen(), json({order[3], order[6]}));
    expect_quiet();
}

TEST_F(Page, ColoursFollowTheChosenGroups) {
    show(tests::synthetic_model({.shapes = 9, .classes = 3, .paths = 0}));
    const std::string strips =
        "return [...document.querySelectorAll('#silhouette-chart .mark-rect.role-mark path')].map(p => "
        "p.getAttribute('fill')).join(' ')";
    const json by_class = browser_->run(strips);
    EXPECT_THAT(text("#matrix .hint"), testing::HasSubstr("The strips along the sides show: classes."));
    browser_->run("const s = document.getElementById('colours'); s.value = 2; s.dispatchEvent(new Event('change'));");
    ASSERT_TRUE(
        browser_->wait_for("return document.querySelector('#embedding-chart .role-legend-title').textContent "
                           "=== 'clusters, k-medoids'"));
    ASSERT_TRUE(browser_->wait_for(
        "return [...document.querySelectorAll('#silhouette-chart .mark-rect.role-mark path')].length === 9"));
    EXPECT_NE(browser_->run(strips), by_class);  // k-medoids puts the last shape into the first cluster
    EXPECT_THAT(text("#matrix .hint"), testing::HasSubstr("show: clusters, k-medoids."));
    // Both clusterings have their tables.
    EXPECT_THAT(text("#matrix"), testing::HasSubstr("Clusters by average linkage, mean silhouette 0.61"));
    EXPECT_THAT(text("#matrix"), testing::HasSubstr("Clusters by k-medoids, mean silhouette 0.57, adjusted Rand index "
                                                    "with average linkage 0.83"));
    EXPECT_EQ(
        browser_->run("return document.querySelectorAll('#matrix .clusters:nth-of-type(2) tbody tr:first-child th')"
                      "[0].textContent"),
        "1");
    browser_->run(
        "const s = document.getElementById('matrix-order'); s.value = 'cluster1'; s.dispatchEvent(new "
        "Event('change'));");
    ASSERT_TRUE(browser_->wait_for("return !document.querySelector('#matrix-chart .branch')"));
    expect_quiet();
}

TEST_F(Page, PlacedQueriesStandInTheMaps) {
    auto model = tests::synthetic_model({.shapes = 9, .classes = 3, .paths = 0, .queries = 3});
    model.placed[1].name = tests::evil_names[0];
    model.placed[2].positions[0].clear();  // no place in the plane
    show(model);
    const std::string diamonds = "return document.querySelectorAll('#embedding-chart .query > path').length";
    EXPECT_EQ(browser_->run(diamonds), 2);
    EXPECT_THAT(text("#embedding-chart"), testing::HasSubstr("<img src=x onerror"));
    EXPECT_EQ(
        browser_->run("const q = document.querySelector('#embedding-chart .query > path').getBoundingClientRect(),"
                      " s = [...document.querySelectorAll('#embedding-chart .shape > g > .background')].find(p =>"
                      " p.__data__.datum.i === 0).getBoundingClientRect();"
                      "return Math.abs(q.x + q.width / 2 - s.x - s.width / 2) < 2 && Math.abs(q.y + q.height / 2 "
                      "- s.y - s.height / 2) < 2"),
        true);  // the first query was put where the first shape is
    EXPECT_THAT(text("#embedding table"), testing::HasSubstr("query-1.png0.050.1" + model.shapes[0].label));
    EXPECT_EQ(browser_->run("return document.querySelectorAll('#embedding tbody tr').length"), 3);
    browser_->run(
        "const s = document.getElementById('embedding-which'); s.value = 1; s.dispatchEvent(new Event('change'));");
    EXPECT_TRUE(browser_->wait_for("return document.querySelectorAll('#embedding-chart .query > path').length === 3"));
    expect_quiet();
}

TEST_F(Page, NamesAreShownAsTextAndDoNothing) {
    auto model =
        tests::synthetic_model({.shapes = static_cast<int>(tests::evil_names.size()), .classes = 3, .paths = 2});
    for (std::size_t i = 0; i < model.shapes.size(); ++i) {
        model.shapes[i].name = model.shapes[i].label = tests::evil_names[i];
        model.shapes[i].notes = {tests::evil_names[i]};
        model.failures.push_back({tests::evil_names[i], "", tests::evil_names[i]});
    }
    model.study = tests::evil_names[1];
    model.collection = "";
    model.links.push_back({"javascript:alert(4)", "a link", ""});
    model.links.push_back({"https://example.invalid/x", "another", ""});
    show(model);
    const std::string page = text("main");
    EXPECT_THAT(page, testing::HasSubstr(tests::evil_names[0]));
    EXPECT_THAT(page, testing::HasSubstr(tests::evil_names[1]));
    EXPECT_EQ(text("h1"), tests::evil_names[1]);
    EXPECT_EQ(browser_->run(
                  "return [...document.querySelectorAll('img')].filter(i => !i.src.startsWith('data:image/')).length"),
              0);
    EXPECT_EQ(browser_->run("return document.querySelectorAll('script').length"), 2);
    EXPECT_EQ(
        browser_->run("return [...document.querySelectorAll('a')].filter(a => !/^(file:|#)/.test(a.href)).length"), 0);
    browser_->run(
        "document.getElementById('pair-a').value = 5; document.getElementById('pair-a').dispatchEvent(new "
        "Event('change'));");
    browser_->run(
        "document.getElementById('pair-b').value = 11; document.getElementById('pair-b').dispatchEvent(new "
        "Event('change'));");
    EXPECT_EQ(text("#pair pre"),
              "morphodesic geodesic --preset fast --out rf-_touch_pwned_id_HOME.geodesic -- -rf.png '$(touch pwned) "
              "`id` $HOME.png'");
    expect_quiet();
}

TEST_F(Page, NoOtherScriptCanRun) {
    show(tests::synthetic_model({.shapes = 4, .classes = 2, .paths = 0}));
    browser_->run(
        "const s = document.createElement('script'); s.textContent = 'window.intruder = 1'; document.body.append(s);"
        "const d = document.createElement('div'); d.innerHTML = '<img src=data:, onerror=\"window.intruder = 2\">'; "
        "document.body.append(d);"
        "const i = new Image(); i.src = 'http://127.0.0.1:9/leak.png'; document.body.append(i);");
    EXPECT_FALSE(browser_->wait_for("return window.intruder", 0.5));
    EXPECT_THAT(browser_->console_errors(), testing::Contains(testing::HasSubstr("Content Security Policy")));
}

TEST_F(Page, AGivenTableHasNoGeodesics) {
    auto model = tests::synthetic_model({.shapes = 8, .classes = 2, .paths = 0});
    model.given_matrix = true;
    model.volumes.reset();
    model.links.clear();
    for (auto& shape : model.shapes) shape.thumbnail = {}, shape.volume = unknown;
    model.errors.clear();
    model.trust.triangles_checked = 56;
    model.trust.triangles_violated = model.trust.triangles_beyond_error = 1;
    for (double& d : model.distances) d *= 1e-4;
    show(model);
    const std::string page = text("main");
    EXPECT_THAT(text("#trust"), testing::HasSubstr("1 of 56 triangles violates the triangle inequality."));
    EXPECT_NE(text("#neighbours button.near strong"), "");  // without pictures neighbours are known by their names
    EXPECT_THAT(text("#neighbours"), testing::HasSubstr("10⁻"));
    EXPECT_THAT(text("#embedding"), testing::Not(testing::HasSubstr("Pictures")));
    EXPECT_THAT(text(".headline"), testing::HasSubstr("given distances"));
    EXPECT_THAT(page, testing::Not(testing::HasSubstr("morphodesic geodesic")));
    EXPECT_THAT(page, testing::Not(testing::HasSubstr("Every computed pair converged")));
    EXPECT_EQ(text("#pair h2"), "Two shapes");
    expect_quiet();
}

TEST_F(Page, EqualVolumesAreSaid) {
    auto model = tests::synthetic_model({.shapes = 5, .classes = 2, .paths = 0});
    model.volumes.reset();
    model.volume_spread = 0.00312;
    show(model);
    EXPECT_THAT(text("#volumes"), testing::HasSubstr("equal within 0.31 %"));
    EXPECT_THAT(text("#volumes"), testing::HasSubstr("tells nothing of these shapes"));
    model.volume_spread = 3e-9;
    show(model);
    EXPECT_THAT(text("#volumes"), testing::HasSubstr("equal to all digits shown"));
    model.volume_spread = unknown;
    show(model);
    EXPECT_EQ(text("#volumes"), "");
    expect_quiet();
}

TEST_F(Page, TrianglesAreCountedInWords) {
    auto model = tests::synthetic_model({.shapes = 5, .classes = 2, .paths = 0});
    const auto said = [&](long violated, long beyond) {
        model.trust.triangles_checked = 56;
        model.trust.triangles_violated = violated;
        model.trust.triangles_beyond_error = beyond;
        show(model);
        return text("#trust");
    };
    EXPECT_THAT(said(0, 0), testing::HasSubstr("The triangle inequality holds in all 56 triangles."));
    EXPECT_THAT(said(0, 0), testing::Not(testing::HasSubstr("error bars explain all")));
    EXPECT_THAT(said(1, 0), testing::HasSubstr("1 of 56 triangles violates the triangle inequality; its error bars"));
    EXPECT_THAT(said(3, 2), testing::HasSubstr("3 of 56 triangles violate the triangle inequality; 2 of them by"));
}

TEST_F(Page, FailedPairsOfShapesThatAreLeftOutCount) {
    auto model = tests::synthetic_model({.shapes = 4, .classes = 2, .paths = 0});
    model.trust.not_converged.clear();
    show(model);
    EXPECT_THAT(text("#trust"), testing::HasSubstr("Every computed pair converged."));
    model.failures.push_back({"x.png", "y.png", "not converged"});
    show(model);
    EXPECT_THAT(text("#trust"), testing::HasSubstr("1 pair did not converge or gave no trustworthy path."));
    EXPECT_THAT(text("#trust"), testing::Not(testing::HasSubstr("Every computed pair converged.")));
}

TEST_F(Page, WarningsStandFirst) {
    auto model = tests::synthetic_model({.shapes = 4, .classes = 2, .paths = 0});
    model.warnings = {"The sizes differ by a factor of 836."};
    show(model);
    EXPECT_EQ(text("#summary .notice"), "The sizes differ by a factor of 836.");
    expect_quiet();
}

TEST_F(Page, LightAndDark) {
    const auto background = [&] {
        return browser_->run("return getComputedStyle(document.body).backgroundColor").get<std::string>();
    };
    const auto axis = [&] {
        return browser_->run("return getComputedStyle(document.querySelector('#shepard-chart text')).fill")
            .get<std::string>();
    };
    browser_->devtools("Emulation.setEmulatedMedia",
                       {{"features", {{{"name", "prefers-color-scheme"}, {"value", "dark"}}}}});
    show(tests::synthetic_model({.shapes = 6, .classes = 2, .paths = 1}));
    EXPECT_EQ(background(), "rgb(18, 22, 28)");
    const std::string dark_axis = axis();
    browser_->run("document.getElementById('theme').click()");
    EXPECT_EQ(background(), "rgb(255, 255, 255)");
    EXPECT_NE(axis(), dark_axis);
    browser_->devtools("Emulation.setEmulatedMedia",
                       {{"features", {{{"name", "prefers-color-scheme"}, {"value", "light"}}}}});
    browser_->run("document.getElementById('theme').click()");
    EXPECT_EQ(background(), "rgb(18, 22, 28)");
    browser_->devtools("Emulation.setEmulatedMedia", {{"media", "print"}});
    EXPECT_EQ(background(), "rgb(255, 255, 255)");
    expect_quiet();
}

TEST_F(Page, LongNamesWithoutBreaksFit) {
    browser_->devtools("Emulation.setDeviceMetricsOverride",
                       {{"width", 1400}, {"height", 844}, {"deviceScaleFactor", 1}, {"mobile", false}});
    auto model = tests::synthetic_model({.shapes = 12, .classes = 3, .paths = 2});
    for (std::size_t i = 0; i < model.shapes.size(); ++i) {
        model.shapes[i].name = std::string(225, static_cast<char>('a' + i)) + ".png";
    }
    model.failures.push_back({std::string(225, 'z') + ".png", "", "/" + std::string(225, 'z') + ".png: is empty"});
    show(model);
    EXPECT_LE(browser_->run("return document.documentElement.scrollWidth").get<int>(), 1400);
    EXPECT_EQ(browser_->run("return [...document.querySelectorAll('.stack, #summary table')].filter(t => t.scrollWidth "
                            "> t.parentNode.clientWidth + 1).length"),
              0);
    browser_->devtools("Emulation.clearDeviceMetricsOverride");
}

/// Nothing wider than its place, which would move clicks away from what is seen.
TEST_F(Page, FitsPhonesAndScreens) {
    for (const int width : {360, 1400}) {
        browser_->devtools("Emulation.setDeviceMetricsOverride",
                           {{"width", width}, {"height", 844}, {"deviceScaleFactor", 2}, {"mobile", width < 600}});
        for (const int shapes : {12, 40}) {
            show(tests::synthetic_model({.shapes = shapes, .classes = 3, .paths = 2}));
            EXPECT_LE(browser_->run("return document.documentElement.scrollWidth").get<int>(), width);
            // Tables with long texts are read without moving them sideways.
            EXPECT_EQ(browser_->run("return [...document.querySelectorAll('.stack')].filter(t => t.scrollWidth > "
                                    "t.parentNode.clientWidth + 1).length"),
                      0)
                << width << " pixels";
            EXPECT_THAT(browser_->run("return [...document.querySelectorAll('.chart')].filter(c => c.clientWidth && "
                                      "c.querySelector('svg')).filter("
                                      "c => c.querySelector('svg').getBoundingClientRect().width > c.clientWidth + "
                                      "1).map(c => c.id + ' ' + "
                                      "c.querySelector('svg').getBoundingClientRect().width + ' > ' + c.clientWidth)"),
                        IsEmpty())
                << width << " pixels, " << shapes << " shapes";
            expect_quiet();
        }
    }
}

TEST_F(Page, WorksForReadersWhoDoNotSeeIt) {
    show(tests::synthetic_model({.shapes = 8, .classes = 2, .paths = 2}));
    EXPECT_THAT(browser_->run("return [...document.querySelectorAll('img')].filter(i => !i.hasAttribute('alt')).map(i "
                              "=> i.outerHTML.slice(0, 80))"),
                IsEmpty());
    EXPECT_THAT(browser_->run("return [...document.querySelectorAll('svg')].filter(s => s.getAttribute('role') !== "
                              "'img' || (s.getAttribute('aria-label') || '').length < 20).map(s => s.parentNode.id)"),
                IsEmpty());
    EXPECT_THAT(browser_->run("return [...document.querySelectorAll('select, input')].filter(c => !(c.labels && "
                              "c.labels.length) && !c.getAttribute('aria-label')).map(c => c.outerHTML.slice(0, 80))"),
                IsEmpty());
    EXPECT_THAT(
        browser_->run(
            "return [...document.querySelectorAll('button')].filter(b => !b.textContent.trim() && "
            "!b.getAttribute('aria-label') && !b.querySelector('img[alt]')).map(b => b.outerHTML.slice(0, 80))"),
        IsEmpty());
    EXPECT_THAT(browser_->run("return [...document.querySelectorAll('section')].filter(s => "
                              "!document.getElementById(s.getAttribute('aria-labelledby'))).map(s => s.id)"),
                IsEmpty());
    EXPECT_THAT(browser_->run("return [...document.querySelectorAll('table')].filter(t => !t.caption || "
                              "!t.querySelector('th[scope]')).length"),
                0);
    EXPECT_THAT(browser_->run("return [...document.querySelectorAll('nav a')].filter(a => "
                              "!document.querySelector(a.getAttribute('href'))).length"),
                0);
    EXPECT_EQ(browser_->run("return document.querySelectorAll('h1').length"), 1);
    EXPECT_EQ(
        browser_->run(
            "const ids = [...document.querySelectorAll('[id]')].map(e => e.id); return ids.length - new Set(ids).size"),
        0);
}

TEST_F(Page, SpaceTurns) {
    show(tests::synthetic_model({.shapes = 9, .classes = 3, .paths = 1}));
    browser_->run(
        "const s = document.getElementById('embedding-which'); s.value = 1; s.dispatchEvent(new Event('change'));");
    ASSERT_TRUE(
        browser_->wait_for("return document.querySelectorAll('#embedding-chart :is(.shape > path, .shape > g > "
                           ".background)').length === 9 && "
                           "!document.querySelector('#embedding-chart .role-axis')"));
    const std::string places =
        "return [...document.querySelectorAll('#embedding-chart :is(.shape > path, .shape > g > .background)')].map(p "
        "=> "
        "p.getBoundingClientRect().x).join(' ')";
    const json before = browser_->run(places);
    const json at = middle("return document.querySelector('#embedding-chart .back > path');");
    const double x = at["left"].get<double>() + 6, y = at["top"].get<double>() + 6;
    browser_->drag(x, y, x + 90, y + 30);
    EXPECT_NE(browser_->run(places), before);
    expect_quiet();
}

TEST_F(Page, OddAndLargeStudiesOpen) {
    show(ReportModel{});
    expect_quiet();
    show(tests::synthetic_model({.shapes = 1, .classes = 1, .paths = 0}));
    expect_quiet();
    auto bare = tests::synthetic_model({.shapes = 3, .classes = 1, .paths = 0, .labelled = false});
    bare.linkages.clear(), bare.clusterings.clear(), bare.errors.clear(), bare.volumes.reset(), bare.compare.reset();
    bare.trust = {};
    for (double& d : bare.distances) d = unknown;
    for (auto& s : bare.shapes) s.thumbnail = {};
    show(bare);
    EXPECT_THAT(text("#pair-body"), testing::HasSubstr("no trustworthy distance"));
    expect_quiet();
    show(tests::synthetic_model({.shapes = 200, .classes = 20, .paths = 5}));
    EXPECT_EQ(
        browser_->run(
            "return document.querySelectorAll('#embedding-chart :is(.shape > path, .shape > g > .background)').length"),
        200);
    expect_quiet();
}

}  // namespace
}  // namespace morphodesic::reports

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "datasets/read_error.h"
#include "pipeline/classify_page.h"
#include "pipeline/classify_results.h"
#include "pipeline/classify_screening.h"
#include "pipeline/classify_templates.h"
#include "pipeline/cli.h"
#include "tests/support/temporary_folder.h"

namespace morphodesic::pipeline {
namespace {

/// Ellipse, bar, cross and ring: four classes with one shape each, and a second size of each.
LevelSet<2> shape(int kind, double size) {
    LevelSet<2> u{DyadicGrid<2>(6)};
    const auto box = [](double x, double y, double a, double b) { return std::min(a - std::abs(x), b - std::abs(y)); };
    for (std::size_t i = 0; i < u.values.size(); ++i) {
        const Point<2> p = u.grid.position(u.grid.node(i));
        const double x = (p[0] - 0.5) / size, y = (p[1] - 0.5) / size, r = std::hypot(x, y);
        const double v = kind == 0   ? 0.17 - r
                         : kind == 1 ? box(x, y, 0.3, 0.07)
                         : kind == 2 ? std::max(box(x, y, 0.3, 0.06), box(x, y, 0.06, 0.3))
                                     : std::min(0.26 - r, r - 0.15);
        u.values[i] = v * size;
    }
    return redistanced(u);
}

std::shared_ptr<const ComparedShape<2>> compared(int kind, double size) {
    auto s = std::make_shared<ComparedShape<2>>();
    s->label = std::string(1, static_cast<char>('a' + kind));
    s->name = s->label + std::to_string(size);
    s->digest = s->name;
    s->level_set = shape(kind, size);
    for (const double v : s->level_set.values) s->volume += v > 0 ? 1.0 / 4096 : 0.0;
    return s;
}

std::vector<std::shared_ptr<const ComparedShape<2>>> all_templates() {
    std::vector<std::shared_ptr<const ComparedShape<2>>> templates;
    for (int kind = 0; kind < 4; ++kind) {
        for (const double size : {0.9, 1.0}) templates.push_back(compared(kind, size));
    }
    return templates;
}

GeodesicOptions coarse() {
    GeodesicOptions options;
    options.level = 5;
    options.time_steps = 2;
    options.tolerance = 1e-2;
    return options;
}

const TemplateResult<2>& nearest(const std::vector<TemplateResult<2>>& results) {
    return *std::min_element(results.begin(), results.end(),
                             [](const auto& a, const auto& b) { return a.distance < b.distance; });
}

TEST(Classify, AQueryLikeATemplateHasDistanceZeroAndRankOne) {
    const auto templates = all_templates();
    const PartialMatcher<2> matcher(templates[5], {}, "common", "rigid", false);
    const auto results = compare_with_templates<2>(matcher, templates, coarse(), {}, {});
    EXPECT_EQ(nearest(results).item, 5U);
    EXPECT_EQ(nearest(results).distance, 0.0);
}

TEST(Classify, ScreeningGivesTheSameAnswerForLessWork) {
    const auto templates = all_templates();
    for (int kind = 0; kind < 4; ++kind) {
        auto query = std::make_shared<ComparedShape<2>>(*compared(kind, 0.95));
        query->mask = ScalarField<2>(query->level_set.grid, 1.0);
        for (std::size_t i = 0; i < query->mask.values.size(); ++i) {
            if (query->mask.grid.position(query->mask.grid.node(i))[0] > 0.58) {
                query->mask.values[i] = 0.0;
                query->level_set.values[i] = std::min(query->level_set.values[i], -0.01);
            }
        }
        query->level_set = redistanced(query->level_set);
        const PartialMatcher<2> matcher(query, {}, "common", "rigid", false);
        ClassifyOptions all;
        all.screening = false;
        const auto screened = compare_with_templates<2>(matcher, templates, coarse(), {}, {});
        const auto full = compare_with_templates<2>(matcher, templates, coarse(), all, {});
        EXPECT_EQ(nearest(screened).item, nearest(full).item) << kind;
        EXPECT_EQ(nearest(screened).distance, nearest(full).distance) << kind;
        EXPECT_EQ(templates[nearest(full).item]->label, std::string(1, static_cast<char>('a' + kind)));
        const auto refined = [](const auto& results) {
            return std::count_if(results.begin(), results.end(), [](const auto& r) { return r.refined; });
        };
        EXPECT_LT(refined(screened), refined(full)) << kind;
        EXPECT_EQ(refined(full), 8);
    }
}

TEST(Classify, AMaskGrowsWhereAPartIsMissing) {
    const LevelSet<2> whole = shape(2, 1.0), part = shape(1, 1.0);  // a cross that lost two arms
    const ScalarField<2> mask = grown_mask<2>(part, whole, Hypothesis::missing);
    const auto at = [&](double x, double y) {
        return mask.values[mask.grid.index({static_cast<int>(x * 64), static_cast<int>(y * 64)})];
    };
    EXPECT_EQ(at(0.5, 0.7), 0.0);
    EXPECT_EQ(at(0.5, 0.3), 0.0);
    EXPECT_EQ(at(0.7, 0.5), 1.0);
    EXPECT_EQ(at(0.25, 0.5), 1.0);
    const ScalarField<2> none = grown_mask<2>(part, whole, Hypothesis::added);
    EXPECT_EQ(none.values, std::vector<double>(none.values.size(), 1.0));
}

/// An L, which is not its own mirror image.
ComparedShape<2> hook() {
    ComparedShape<2> s;
    s.name = s.digest = s.label = "hook";
    s.level_set = LevelSet<2>{DyadicGrid<2>(6)};
    for (std::size_t i = 0; i < s.level_set.values.size(); ++i) {
        const Point<2> p = s.level_set.grid.position(s.level_set.grid.node(i));
        const auto box = [&](double x0, double x1, double y0, double y1) {
            return std::min({p[0] - x0, x1 - p[0], p[1] - y0, y1 - p[1]});
        };
        s.level_set.values[i] = std::max(box(0.3, 0.42, 0.25, 0.8), box(0.3, 0.62, 0.25, 0.37));
    }
    s.level_set = redistanced(s.level_set);
    for (const double v : s.level_set.values) s.volume += v > 0 ? 1.0 / 4096 : 0.0;
    return s;
}

TEST(Classify, MirrorImagesCountAsTheSameIfAskedFor) {
    const ComparedShape<2> whole = hook();
    const auto query = std::make_shared<const ComparedShape<2>>(mirror_image(whole));
    EXPECT_EQ(mirror_image(*query).level_set.values, whole.level_set.values);
    const auto distance = [&](bool mirror) {
        const PartialMatcher<2> matcher(query, {}, "common", "rigid", false, mirror);
        double least = 1e300;
        for (const auto& start : matcher.starts(whole)) {
            least = std::min(least, matcher.measure(whole, start, coarse(), {}).distance);
        }
        return least;
    };
    EXPECT_LT(distance(true), 0.25 * distance(false));
}

TEST(Classify, AStraightCutIsRecognised) {
    LevelSet<2> cut = shape(0, 1.0);  // a disk around the middle
    const double c = std::cos(0.5), s = std::sin(0.5);
    for (std::size_t i = 0; i < cut.values.size(); ++i) {
        const Point<2> p = cut.grid.position(cut.grid.node(i));
        cut.values[i] = std::min(cut.values[i], 0.05 - c * (p[0] - 0.5) - s * (p[1] - 0.5));
    }
    const auto masks = cut_off_masks<2>(redistanced(cut), 1);
    ASSERT_EQ(masks.size(), 1U);
    for (const double along : {-0.3, 0.0, 0.3}) {
        for (const double beyond : {-0.1, 0.02, 0.08, 0.2}) {
            const double x = 0.5 + c * beyond - s * along, y = 0.5 + s * beyond + c * along;
            const std::size_t node =
                masks[0].grid.index({static_cast<int>(std::lround(64 * x)), static_cast<int>(std::lround(64 * y))});
            EXPECT_EQ(masks[0].values[node], beyond > 0.05 ? 0.0 : 1.0) << along << " " << beyond;
        }
    }
}

TEST(Classify, RedistancedGivesDistances) {
    LevelSet<2> u{DyadicGrid<2>(6)};
    for (std::size_t i = 0; i < u.values.size(); ++i) {
        const Point<2> p = u.grid.position(u.grid.node(i));
        const double r = std::hypot(p[0] - 0.5, p[1] - 0.5);
        u.values[i] = 5 * (0.25 * 0.25 - r * r);
    }
    const LevelSet<2> d = redistanced(u);
    for (std::size_t i = 0; i < u.values.size(); ++i) {
        const Point<2> p = u.grid.position(u.grid.node(i));
        EXPECT_NEAR(d.values[i], 0.25 - std::hypot(p[0] - 0.5, p[1] - 0.5), 0.3 / 64);
    }
}

/// Takes away what a clock says.
void forget_times(nlohmann::json& json) {
    if (!json.is_structured()) return;
    if (json.is_object()) {
        for (const char* key : {"seconds", "queries_per_second"}) json.erase(key);
    }
    for (auto& value : json) forget_times(value);
}

/// Three bars and three disks, and the same with a fifth of each hidden as queries.
struct OccludedBars {
    const tests::TemporaryFolder folder;
    const std::string templates = (folder / "templates").string(), queries = (folder / "queries").string(),
                      out = (folder / "out").string();

    OccludedBars() {
        for (const char* kind : {"bars", "disks"}) {
            EXPECT_EQ(run_program({"datasets", kind, "--out", templates + "/" + kind, "--count", "3", "--size", "96",
                                   "--quiet"}),
                      0);
        }
        EXPECT_EQ(run_program({"datasets", "occlude", templates, "--fraction", "0.2", "--out", queries, "--labels",
                               "folder", "--quiet"}),
                  0);
    }
    [[nodiscard]] nlohmann::json classify(const std::vector<std::string>& more) const {
        std::vector<std::string> words = {"classify", queries,   "--templates", templates,    "--labels",
                                          "folder",   "--level", "4",           "--steps",    "1",
                                          "--out",    out,       "--quiet",     "--pictures", "0"};
        words.insert(words.end(), more.begin(), more.end());
        EXPECT_EQ(run_program(words), 0);
        auto json = nlohmann::json::parse(tests::file_content(folder / "out/classification.json"));
        forget_times(json);
        return json;
    }
};

TEST(Classify, BatchOfOccludedBarsFromTheCommandLine) {
    const OccludedBars bars;
    const auto json = bars.classify({"--filmstrips", "1", "--pictures", "2"});
    EXPECT_EQ(json["queries"].size(), 6U);
    EXPECT_EQ(json["labelled"], 6);
    EXPECT_GE(json["accuracy"].get<double>(), 0.99);
    EXPECT_EQ(json["queries"][0]["mask"], "known");
    EXPECT_EQ(json["queries"][0]["templates"].size(), 6U);
    EXPECT_TRUE(json["calibration"]["novelty_limit"].is_null());
    EXPECT_THAT(json["remarks"].dump(), testing::HasSubstr("at least 19 templates are needed"));
    const std::string page = tests::file_content(bars.folder / "out/classification.html");
    EXPECT_THAT(page, testing::HasSubstr("Confusion matrix"));
    EXPECT_THAT(page, testing::HasSubstr("viscous dissipation rate density"));  // what colours of the paths say
    EXPECT_THAT(page, testing::HasSubstr("data:image/png;base64,"));
    EXPECT_THAT(page, testing::Not(testing::HasSubstr("http://")));
}

TEST(Classify, AnswersAreTheSameForAnyNumberOfThreads) {
    const OccludedBars bars;
    EXPECT_EQ(bars.classify({"--threads", "1"}), bars.classify({"--threads", "8"}));
}

TEST(Classify, OptionsChooseWhatDistancesCountAndWhoStandsForAClass) {
    const OccludedBars bars;
    const auto sum_of_nearest = [](const nlohmann::json& json) {
        double sum = 0.0;
        for (const auto& query : json["queries"]) sum += query["templates"][0]["distance"].get<double>();
        return sum;
    };
    const auto visible = bars.classify({"--correction", "visible"}), none = bars.classify({"--correction", "none"});
    EXPECT_EQ(bars.classify({}), visible) << "the default";
    EXPECT_LT(sum_of_nearest(none), 0.5 * sum_of_nearest(visible));  // what is hidden costs nothing
    for (const char* correction : {"cut", "filled"}) {
        const auto json = bars.classify({"--correction", correction});
        EXPECT_EQ(json["right"], 6) << correction;
        EXPECT_NE(sum_of_nearest(json), sum_of_nearest(visible)) << correction;
    }
    const auto unmasked = bars.classify({"--mask", "none"});
    EXPECT_EQ(unmasked["queries"][0]["mask"], "none");
    EXPECT_GT(sum_of_nearest(unmasked), 2 * sum_of_nearest(visible));  // as if nothing were hidden
    const auto medoids = bars.classify({"--templates-per-class", "1"});
    EXPECT_EQ(medoids["template_count"], 2);
    for (const auto& query : medoids["queries"]) EXPECT_EQ(query["templates"].size(), 2U);
}

TEST(Classify, EveryTemplateByTheOthers) {
    const tests::TemporaryFolder folder;
    const std::string all = (folder / "all").string(), out = (folder / "out").string();
    for (const char* kind : {"bars", "disks"}) {
        ASSERT_EQ(run_program({"datasets", kind, "--out", all + "/" + kind, "--count", "3", "--size", "96", "--quiet"}),
                  0);
    }
    ASSERT_EQ(run_program({"classify", "--leave-one-out", "--templates", all, "--labels", "folder", "--level", "4",
                           "--steps", "1", "--out", out, "--quiet"}),
              0);
    const auto json = nlohmann::json::parse(tests::file_content(folder / "out/classification.json"));
    EXPECT_EQ(json["labelled"], 6);
    EXPECT_GE(json["right"], 5);
    for (const auto& query : json["queries"]) {
        EXPECT_EQ(query["templates"].size(), 5U);  // not itself
        EXPECT_GT(query["seconds"].get<double>(), 0.0);
    }
}

TEST(Classify, AMatchstickManWithoutAnArmAndALegIsRecognised) {
    const tests::TemporaryFolder folder;
    const std::string men = (folder / "men").string(), hidden = (folder / "hidden").string(),
                      out = (folder / "out").string();
    ASSERT_EQ(run_program({"datasets", "matchstick", "--count", "9", "--seed", "1", "--out", men, "--quiet"}), 0);
    ASSERT_EQ(run_program({"datasets", "matchstick", "--count", "9", "--seed", "2", "--hide-limbs", "--out", hidden,
                           "--quiet"}),
              0);
    ASSERT_EQ(run_program({"classify", hidden, "--templates", men, "--level", "5", "--steps", "2", "--out", out,
                           "--filmstrips", "1", "--pictures", "1", "--quiet"}),
              0);
    const auto json = nlohmann::json::parse(tests::file_content(folder / "out/classification.json"));
    ASSERT_EQ(json["labelled"], 9);
    EXPECT_GE(json["right"].get<int>(), 8);  // person and pose
    for (const auto& query : json["queries"]) EXPECT_GT(query["hidden_share"].get<double>(), 0.1);
}

TEST(Classify, AFootWithoutToesIsRecognised) {
    const tests::TemporaryFolder folder;
    const std::string feet = (folder / "feet").string(), cut = (folder / "cut").string(),
                      out = (folder / "out").string();
    ASSERT_EQ(run_program({"datasets", "feet", "--count", "2", "--out", feet, "--quiet"}), 0);
    ASSERT_EQ(run_program({"datasets", "occlude", feet, "--fraction", "0.15", "--direction", "1,0,0", "--out", cut,
                           "--labels", "csv", "--quiet"}),
              0);
    ASSERT_EQ(run_program({"classify", cut, "--templates", feet, "--level", "4", "--steps", "1", "--out", out,
                           "--no-calibrate", "--filmstrips", "1", "--pictures", "1", "--quiet"}),
              0);
    const auto json = nlohmann::json::parse(tests::file_content(folder / "out/classification.json"));
    EXPECT_EQ(json["right"], 2);
    for (const auto& query : json["queries"]) {
        EXPECT_EQ(query["mask"], "known");
        // The mask has a seam of a coarse cell within, so it hides more than was cut off.
        EXPECT_GT(query["hidden_share"].get<double>(), 0.13);
        EXPECT_LT(query["hidden_share"].get<double>(), 0.4);
    }
}

/// A ball of radius 1 without the cap above z = 0.4.
std::string open_ball() {
    constexpr int around = 24, along = 18;
    const double top = std::acos(0.4), bottom = std::acos(-1.0);
    std::ostringstream text;
    for (int i = 0; i <= along; ++i) {
        const double polar = top + (bottom - top) * i / along;
        for (int j = 0; j < around; ++j) {
            const double angle = 2 * bottom * j / around;
            text << "v " << std::sin(polar) * std::cos(angle) << ' ' << std::sin(polar) * std::sin(angle) << ' '
                 << std::cos(polar) << '\n';
        }
    }
    for (int i = 0; i < along; ++i) {
        for (int j = 0; j < around; ++j) {
            const int a = i * around + j + 1, b = i * around + (j + 1) % around + 1;
            text << "f " << a << ' ' << a + around << ' ' << b << "\nf " << b << ' ' << a + around << ' ' << b + around
                 << '\n';
        }
    }
    return text.str();
}

TEST(Classify, AnOpenScanThatIsSmallBesideTheTemplatesIsReadOnAFinerGrid) {
    const tests::TemporaryFolder folder;
    const auto source = datasets::single_source(folder.write("scan.obj", open_ball()));
    TemplateSet<3> templates;
    templates.placement.mode = "common";
    templates.placement.level = 5;
    datasets::ImportOptions import;
    import.border = "hides";
    const auto read = [&](double scale) {
        templates.placement.scale = scale;
        return load_query<3>(source, templates, import, false);
    };
    const auto large = read(0.3), small = read(0.07);
    EXPECT_EQ(large.level_set.grid.level(), 5);
    EXPECT_TRUE(large.notes.empty() || !large.notes.back().starts_with("Only"));
    EXPECT_EQ(small.level_set.grid.level(), 6);
    EXPECT_THAT(small.notes.back(), testing::HasSubstr("cells long on the grid of the templates: read on level 6"));
    EXPECT_GT(visible_contour(small.level_set, small.mask), 0.3);
    try {
        (void)read(0.012);
        FAIL() << "it is smaller than the rim of its mask";
    } catch (const datasets::ReadError& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("too small on the grid of the templates: it is"));
        EXPECT_THAT(error.what(), testing::HasSubstr("use a finer --level, --normalize each or templates of its own"));
    }
}

TEST(Classify, QueriesThatFailedAreNamedBesideTheShareOfRightAnswers) {
    ClassificationRun run;
    run.classes = {"a", "b"};
    run.queries.resize(3);
    run.queries[0].truth = run.queries[0].answer.label = "a";
    run.queries[1].truth = "b";
    run.queries[1].problem = "too small";
    run.queries[2].truth = "c";
    run.queries[2].problem = "of no template's class, and too small";
    run.evaluate();
    const auto json = to_json(run);
    EXPECT_EQ(json["labelled"], 1);
    EXPECT_EQ(json["labelled_failed"], 1);
    const auto page = classification_page(run, "");
    EXPECT_THAT(page.tiles, testing::Contains(testing::Pair(
                                "1", "more with a known class could not be classified: right are 1 of all 2")));
}

TEST(Classify, AStudyAsTemplatesIsNotSaidToBeReadInAnotherWay) {
    const tests::TemporaryFolder folder;
    const std::string letters = (folder / "letters").string(), study = letters + ".study";
    ASSERT_EQ(run_program({"datasets", "letters", "--out", letters, "--count", "4", "--quiet"}), 0);
    ASSERT_EQ(run_program({"ingest", letters, "--level", "4", "--steps", "1", "--quiet"}), 0);
    const auto classify = [&](const std::vector<std::string>& more) {
        std::vector<std::string> words{"classify", letters, "--templates", study, "--no-calibrate", "--quiet"};
        words.insert(words.end(), more.begin(), more.end());
        return run_program(words);
    };
    EXPECT_EQ(classify({}), 0);
    EXPECT_TRUE(std::filesystem::exists(letters + ".classified/classification.csv"));
    EXPECT_EQ(classify({"--occluder", "#808080", "--preset", "fast", "--level", "4"}), 0);
    for (const std::vector<std::string>& more :
         {std::vector<std::string>{"--normalize", "each"}, {"--foreground", "light"}, {"--dimension", "3"}}) {
        EXPECT_EQ(classify(more), 2) << more.front();
    }
}

TEST(Classify, BadUsageIsExitCodeTwo) {
    const tests::TemporaryFolder folder;
    EXPECT_EQ(run_program({"classify", "nothing.png", "--templates", (folder / "no").string(), "--quiet"}), 2);
    EXPECT_EQ(run_program({"classify", "--templates", folder.path().string(), "--quiet"}), 2);
    EXPECT_EQ(run_program({"classify", "x.png", "--templates", folder.path().string(), "--correction", "magic"}), 2);
    ClassifyOptions options;
    options.least_confidence = 0.9;
    EXPECT_THAT(options.problems(), testing::IsEmpty());
    options.calibrate = false;
    EXPECT_THAT(options.problems(), testing::ElementsAre(testing::HasSubstr("--least-confidence needs")));
    options.least_confidence = 0.0;
    options.false_rejection = 0.5;
    EXPECT_THAT(options.problems(), testing::ElementsAre(testing::HasSubstr("--false-rejection has no effect")));
}

}  // namespace
}  // namespace morphodesic::pipeline

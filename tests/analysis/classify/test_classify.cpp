#include <gtest/gtest.h>

#include <cmath>

#include "analysis/classify.h"
#include "analysis/random.h"
#include "tests/analysis/support.h"

namespace morphodesic::analysis {
namespace {

using Names = std::vector<std::string>;

TEST(Classify, RanksMarginAndNeighbours) {
    const Names classes{"dog", "cat", "cat", "dog", ""};
    const std::vector<double> d{3.0, 1.0, 2.0, missing, 0.5};
    const Classification c = classify(d, classes);
    EXPECT_EQ(c.label, "cat");
    ASSERT_EQ(c.classes.size(), 2u);
    EXPECT_EQ(c.classes[0].nearest, 1u);
    EXPECT_DOUBLE_EQ(c.margin, 0.5);
    ASSERT_EQ(c.templates.size(), 4u);
    EXPECT_EQ(c.templates[0].item, 4u);  // shown, but without class never an answer
    EXPECT_TRUE(std::isnan(c.confidence));
    ClassifyOptions two;
    two.neighbours = 2;
    EXPECT_DOUBLE_EQ(classify(d, classes, two).classes[0].distance, 1.5);
}

TEST(Classify, SeparatedOnlyWhenTheErrorBarsAreApart) {
    const Names classes{"a", "b"};
    const std::vector<double> d{1.0, 2.0};
    EXPECT_TRUE(classify(d, classes, {}, nullptr, std::vector<double>{0.4, 0.5}).separated);
    EXPECT_FALSE(classify(d, classes, {}, nullptr, std::vector<double>{0.5, 0.5}).separated);
    EXPECT_FALSE(classify(d, classes).separated);
}

TEST(Classify, EdgeCases) {
    EXPECT_EQ(classify(std::vector<double>{missing}, Names{"a"}).rejection, Rejection::no_known_distance);
    EXPECT_EQ(classify({}, Names{}).label, "");
    EXPECT_EQ(classify(std::vector<double>{1.0}, Names{"a"}).margin, 1.0);
    EXPECT_EQ(classify(std::vector<double>{0.0, 0.0}, Names{"b", "a"}).label, "a");  // equal: by name
    EXPECT_EQ(classify(std::vector<double>{0.0, 0.0}, Names{"b", "a"}).margin, 0.0);
    EXPECT_THROW((void)classify(std::vector<double>{1.0}, Names{"a", "b"}), std::invalid_argument);
    EXPECT_THROW((void)classify(std::vector<double>{-1.0}, Names{"a"}), std::invalid_argument);
}

/// Templates and queries around four centres, further queries around centres of their own.
struct Problem {
    DistanceMatrix templates;
    Names classes;
    std::vector<std::vector<double>> members, strangers;
};

Problem problem() {
    Random random(21);
    constexpr std::size_t dim = 4, groups = 4, per_group = 15;
    std::vector<double> centres, points;
    for (std::size_t k = 0; k < 2 * groups * dim; ++k) centres.push_back(5.0 * random.normal());
    Problem p;
    const auto draw = [&](std::size_t group) {
        std::vector<double> x;
        for (std::size_t a = 0; a < dim; ++a) x.push_back(centres[group * dim + a] + random.normal());
        return x;
    };
    for (std::size_t i = 0; i < groups * per_group; ++i) {
        const auto x = draw(i % groups);
        points.insert(points.end(), x.begin(), x.end());
        p.classes.push_back("class" + std::to_string(i % groups));
    }
    p.templates = tests::distances_of(points, dim);
    const auto distances = [&](const std::vector<double>& x) {
        std::vector<double> d;
        for (std::size_t t = 0; t < p.templates.size(); ++t) {
            double square = 0.0;
            for (std::size_t a = 0; a < dim; ++a) square += std::pow(x[a] - points[t * dim + a], 2);
            d.push_back(std::sqrt(square));
        }
        return d;
    };
    for (std::size_t q = 0; q < 200; ++q) {
        p.members.push_back(distances(draw(q % groups)));
        p.strangers.push_back(distances(draw(groups + q % groups)));
    }
    return p;
}

TEST(Classify, RejectsStrangersAtTheAgreedPrice) {
    const Problem p = problem();
    const Calibration calibration = calibrate(p.templates, p.classes);
    EXPECT_EQ(calibration.queries, 60u);
    EXPECT_GT(calibration.accuracy, 0.9);
    int turned_away = 0, kept_out = 0, right = 0;
    for (std::size_t q = 0; q < 200; ++q) {
        const Classification member = classify(p.members[q], p.classes, {}, &calibration);
        turned_away += member.rejection != Rejection::accepted ? 1 : 0;
        right += member.label == "class" + std::to_string(q % 4) ? 1 : 0;
        kept_out += classify(p.strangers[q], p.classes, {}, &calibration).rejection == Rejection::too_far ? 1 : 0;
    }
    EXPECT_GE(right, 190);
    EXPECT_LE(turned_away, 24);  // 5 % asked for, with the spread of 60 templates
    EXPECT_GE(kept_out, 160);
}

TEST(Classify, ACloseSecondClassMakesAStranger) {
    // Members lie more or less loosely in their classes, but all are 1.6 times as far from other classes. A stranger
    // lies between two classes, as near as a member may lie: only the second distance tells.
    const std::size_t classes = 4, members = 12;
    Names names, items;
    for (std::size_t i = 0; i < classes * members; ++i) {
        names.push_back(std::string(1, static_cast<char>('a' + i / members)));
        items.push_back("item " + std::to_string(i));
    }
    DistanceMatrix distances(items);
    for (std::size_t i = 0; i < items.size(); ++i) {
        for (std::size_t j = i + 1; j < items.size(); ++j) {
            const double loose = std::sqrt((1.0 + 0.7 * static_cast<double>(i % members)) *
                                           (1.0 + 0.7 * static_cast<double>(j % members)));
            distances.set(i, j, names[i] == names[j] ? loose : 1.6 * loose);
        }
    }
    const Calibration calibration = calibrate(distances, names);
    EXPECT_GT(calibration.novelty_exponent, 0.0);
    EXPECT_EQ(calibration.strangers, items.size());
    EXPECT_GT(calibration.strangers_rejected, items.size() * 9 / 10);
    std::vector<double> member(items.size()), stranger(items.size());
    for (std::size_t j = 0; j < items.size(); ++j) {
        member[j] = names[j] == "b" ? 2.4 : 3.9;
        stranger[j] = names[j] == "b" ? 2.4 : 2.5;
    }
    EXPECT_EQ(classify(member, names, {}, &calibration).rejection, Rejection::accepted);
    EXPECT_EQ(classify(stranger, names, {}, &calibration).rejection, Rejection::too_far);
}

TEST(Classify, ACopyOfATemplateHasDistanceZeroAndIsAccepted) {
    const Problem p = problem();
    const Calibration calibration = calibrate(p.templates, p.classes);
    std::vector<double> row(p.templates.size());
    for (std::size_t j = 0; j < row.size(); ++j) row[j] = p.templates(7, j);
    const Classification c = classify(row, p.classes, {}, &calibration);
    EXPECT_EQ(c.templates.front().item, 7u);
    EXPECT_EQ(c.novelty, 0.0);
    EXPECT_EQ(c.margin, 1.0);
    EXPECT_EQ(c.rejection, Rejection::accepted);
    ClassifyOptions strict;
    strict.least_confidence = 1.0;
    EXPECT_EQ(classify(row, p.classes, strict, &calibration).rejection, Rejection::too_uncertain);
}

TEST(Classify, TooFewTemplatesNeverReject) {
    const DistanceMatrix d = tests::distances_of({0, 1, 10, 11}, 1);
    const Names classes{"a", "a", "b", "b"};
    const Calibration calibration = calibrate(d, classes);
    EXPECT_TRUE(std::isnan(calibration.novelty_limit));  // 5 % of four cannot be told
    EXPECT_EQ(classify(std::vector<double>{100, 99, 90, 89}, classes, {}, &calibration).rejection, Rejection::accepted);
    const Calibration alike = calibrate(d, Names{"a", "a", "a", "a"});
    EXPECT_TRUE(std::isnan(alike.accuracy));  // of one class no answer could be wrong
    const Calibration none = calibrate(DistanceMatrix({"x"}), Names{"a"});
    EXPECT_EQ(none.queries, 0u);
    EXPECT_TRUE(std::isnan(classify(std::vector<double>{1.0}, Names{"a"}, {}, &none).confidence));
}

}  // namespace
}  // namespace morphodesic::analysis

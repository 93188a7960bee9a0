#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/common_scale.h"
#include "tests/support/temporary_folder.h"

namespace morphodesic::pipeline {
namespace {

using testing::HasSubstr;
using Files = std::vector<SizedFile>;

class CommonScaleOfAStudy : public testing::Test {
protected:
    /// What a run with these files does.
    CommonScale settle(const Files& files) {
        const CommonScale chosen = choose_common_scale(files, options_, 2, store_);
        keep_common_scale(chosen, store_);
        return chosen;
    }
    tests::TemporaryFolder folder_;
    ResultStore store_{folder_ / "study.sqlite", ResultStore::Access::write};
    datasets::ImportOptions options_;
    const SizedFile small_{"small.png", "5", 10}, middle_{"middle.png", "6", 12}, large_{"large.png", "7", 14},
        stray_{"stray.png", "8", 2000};
};

TEST_F(CommonScaleOfAStudy, StaysWhenFilesComeAndGo) {
    const double scale = settle({small_, large_}).scale;
    EXPECT_EQ(settle({small_, middle_, large_}).scale, scale);
    EXPECT_EQ(settle({small_, middle_, large_}).remark, "");
    const CommonScale kept = settle({small_, middle_});  // a new study would take 14/12 of it
    EXPECT_EQ(kept.scale, scale);
    EXPECT_THAT(kept.remark, testing::AllOf(HasSubstr("large.png, which is no longer among"), HasSubstr("1.17 times")));
    EXPECT_THAT(settle({small_, {"large.png", "70", 12}}).remark, HasSubstr("large.png, which is another shape now"));
    EXPECT_EQ(settle({small_, large_}).remark, "");
}

TEST_F(CommonScaleOfAStudy, IsChosenAnewWhereAShapeDoesNotFitAndComesBackWithoutIt) {
    const double scale = settle({small_, middle_, large_}).scale;
    const CommonScale tiny = settle({small_, middle_, large_, stray_});
    EXPECT_LT(tiny.scale, scale / 100);
    EXPECT_THAT(tiny.remark, testing::AllOf(HasSubstr("stray.png"), HasSubstr("does not fit"), HasSubstr("6 pairs")));
    const CommonScale back = settle({small_, middle_, large_});
    EXPECT_EQ(back.scale, scale);
    EXPECT_THAT(back.remark,
                testing::AllOf(HasSubstr("stray.png, which is no longer among the shapes"), HasSubstr("3 pairs")));
    EXPECT_EQ(settle({small_, middle_, large_}).remark, "");
}

/// When the file that fixed it is gone the scale stays while the others are not much smaller: a half.
TEST_F(CommonScaleOfAStudy, StaysUnlessTheRestIsMuchSmaller) {
    const SizedFile kept{"kept.png", "k", 10};
    const double scale = settle({kept, {"a.png", "a", 14.5}}).scale;
    EXPECT_EQ(settle({kept}).scale, scale);
    const double smaller = settle({kept, {"b.png", "b", 15.5}}).scale;
    EXPECT_LT(smaller, scale);
    EXPECT_GT(settle({kept}).scale, 1.5 * smaller);
}

TEST_F(CommonScaleOfAStudy, IsOneForEachDimension) {
    store_.set_fact("dimension", "2");
    const double scale = settle({small_, large_}).scale;
    const CommonScale solids = choose_common_scale({{"a.stl", "s", 2000}}, options_, 3, store_);
    EXPECT_LT(solids.scale, scale / 100);
    EXPECT_EQ(solids.remark, "");
    keep_common_scale(solids, store_);
    store_.set_fact("dimension", "3");
    EXPECT_EQ(settle({small_, large_}).scale, scale);
    EXPECT_EQ(settle({small_, large_}).remark, "");
}

/// Older programs kept one scale for images and solids.
TEST_F(CommonScaleOfAStudy, OfAnOlderStudyStays) {
    const CommonScale first = settle({small_, large_});
    const std::string former = first.fact.substr(0, first.fact.rfind(" in "));
    tests::TemporaryFolder other;
    ResultStore older(other / "study.sqlite", ResultStore::Access::write);
    older.set_fact(former, exact_text(first.scale / 2));
    older.set_fact("origin of " + former, "7 \nlarge.png");
    older.set_fact("dimension", "2");
    EXPECT_EQ(choose_common_scale({small_, {"large.png", "7", 27}}, options_, 2, older).scale, first.scale / 2);
    older.set_fact("dimension", "3");
    EXPECT_EQ(choose_common_scale({small_, large_}, options_, 2, older).scale, first.scale);
}

TEST_F(CommonScaleOfAStudy, OfOtherShapesIsNotTakenOver) {
    const double scale = settle({large_, middle_}).scale;
    const Files others{{"a.png", "a", 13}, {"b.png", "b", 11}};
    const CommonScale own = settle(others);
    EXPECT_GT(own.scale, scale);
    EXPECT_THAT(own.remark, testing::AllOf(HasSubstr("none of the shapes was there"), HasSubstr("up to 1 pair to")));
    EXPECT_EQ(settle(others).remark, "");
}

TEST_F(CommonScaleOfAStudy, OfAStudyThatDoesNotKnowItsOriginStaysWhileAShapeIsThere) {
    const double scale = settle({small_, large_}).scale;
    store_.set_fact("origin of " + settle({small_, large_}).fact, "");
    StoredShape row;
    row.name = small_.name;
    row.file_digest = small_.digest;
    store_.put_shape(row);
    EXPECT_EQ(settle({small_, middle_}).scale, scale);
    EXPECT_THAT(settle({small_, middle_}).remark, HasSubstr("a file that is no longer among the shapes"));
    EXPECT_GT(settle({middle_}).scale, scale);
}

TEST_F(CommonScaleOfAStudy, IsNotThereWithoutShapes) {
    EXPECT_EQ(settle({}).scale, 0.0);
}

}  // namespace
}  // namespace morphodesic::pipeline

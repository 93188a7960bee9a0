#include <gtest/gtest.h>

#include "end_to_end/program.h"
#include "pipeline/study_folder.h"

namespace morphodesic::pipeline {
namespace {

TEST(StudyFolder, LiesBesideTheCollectionWhateverTheSpelling) {
    EXPECT_EQ(StudyFolder::of_collection("/data/letters").path(), "/data/letters.study");
    EXPECT_EQ(StudyFolder::of_collection("/data/letters/").path(), "/data/letters.study");
    EXPECT_EQ(StudyFolder::of_collection("/data/other/../letters/.").path(), "/data/letters.study");
}

TEST(StudyFolder, WritesWholeFilesAndLeavesNoRests) {
    const tests::TemporaryFolder folder;
    const StudyFolder study(folder / "study");
    study.create();
    study.write("paths/a/step.png", "first");
    study.write("paths/a/step.png", "second");
    EXPECT_EQ(tests::read_file(folder / "study/paths/a/step.png"), "second");
    EXPECT_FALSE(std::filesystem::exists(folder / "study/paths/a/step.png.part"));
}

TEST(StudyLock, IsHeldByOneAndFreeAfterwards) {
    const tests::TemporaryFolder folder;
    const StudyFolder study(folder / "study");
    study.create();
    {
        const StudyLock lock(study);
        EXPECT_THROW(StudyLock{study}, StoreError);
    }
    EXPECT_NO_THROW(StudyLock{study});
}

}  // namespace
}  // namespace morphodesic::pipeline

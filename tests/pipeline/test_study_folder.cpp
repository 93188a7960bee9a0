#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>

#include "end_to_end/program.h"
#include "pipeline/study_folder.h"

namespace {
int flock_error = 0;  // what flock reports in this program instead of locking; 0: it locks
}

extern "C" int flock(int file, int operation) noexcept {
    if (flock_error == 0) return static_cast<int>(::syscall(SYS_flock, file, operation));
    errno = flock_error;
    return -1;
}

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

TEST(StudyFolder, WritesFilesOfOneRunTogetherOrNot) {
    const tests::TemporaryFolder folder;
    const StudyFolder results(folder / "results");
    results.create();
    const auto bytes = [&](const char* name) { return tests::read_file(folder / "results" / name); };
    const auto run = [&](const std::string& all, std::vector<std::filesystem::path> dropped = {}) {
        results.write_together({{{"a.csv", all}, {"b.html", all}, {"c.json", all}}, std::move(dropped)});
    };
    run("1");
    results.write("only_in_one.csv", "1");
    run("2", {"only_in_one.csv"});
    EXPECT_EQ(bytes("a.csv") + bytes("b.html") + bytes("c.json"), "222");
    EXPECT_FALSE(std::filesystem::exists(folder / "results/only_in_one.csv"));
    results.write("only_in_one.csv", "2");
    std::filesystem::remove(folder / "results/b.html");
    std::filesystem::create_directory(folder / "results/b.html");
    EXPECT_THROW(run("3", {"only_in_one.csv"}), StoreError);
    std::filesystem::remove(folder / "results/b.html");
    std::filesystem::create_directory(folder / "results/c.json.part");
    EXPECT_THROW(run("4", {"only_in_one.csv"}), StoreError);
    EXPECT_EQ(bytes("a.csv") + bytes("c.json") + bytes("only_in_one.csv"), "222");
    for (const char* name : {"a.csv.part", "b.html", "b.html.part"}) {
        EXPECT_FALSE(std::filesystem::exists(folder / "results" / name)) << name;
    }
}

TEST(StudyFolder, TakesAnEmptyFolderButNotThatOfOthers) {
    const tests::TemporaryFolder folder;
    const StudyFolder study(folder / "mine");
    for (const char* name : {".DS_Store", "lost+found/x"}) folder.write(std::string("mine/") + name, "");
    EXPECT_NO_THROW(study.create());
    folder.write("mine/thesis.txt", "");
    EXPECT_THROW(study.create(), std::invalid_argument);
    { const StudyLock lock(study); }
    EXPECT_NO_THROW(study.create());  // it is known again
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

TEST(StudyLock, AFileSystemWithoutLocksIsNotAnotherProcess) {
    const tests::TemporaryFolder folder;
    const StudyFolder study(folder / "study");
    study.create();
    for (const int error : {ENOLCK, ENOSYS}) {
        flock_error = error;
        try {
            const StudyLock lock(study);
            ADD_FAILURE() << "no exception";
        } catch (const StoreError& problem) {
            EXPECT_THAT(problem.what(), testing::AllOf(testing::HasSubstr("study.lock: cannot be locked"),
                                                       testing::Not(testing::HasSubstr("another process"))));
        }
        flock_error = 0;
    }
}

}  // namespace
}  // namespace morphodesic::pipeline

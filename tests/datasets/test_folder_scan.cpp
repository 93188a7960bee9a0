#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "datasets/folder_scan.h"
#include "datasets/read_error.h"
#include "tests/support/temporary_folder.h"

namespace morphodesic::datasets {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

std::vector<std::string> names(const ScanResult& result) {
    std::vector<std::string> list;
    for (const ShapeSource& source : result.sources) list.push_back(source.name);
    return list;
}
std::vector<std::string> labels(const ScanResult& result) {
    std::vector<std::string> list;
    for (const ShapeSource& source : result.sources) list.push_back(source.label);
    return list;
}

TEST(FolderScan, FindsShapesSortedBytewiseAndNothingElse) {
    const tests::TemporaryFolder folder;
    for (const char* name : {"b.PNG", "a/z.obj", "a/A b\nc\"d\".jpg", "\xc3\xa4.gif", "B.png", ".hidden.png",
                             ".git/x.png", "README.md", "notes.txt", "table.csv", "Makefile"}) {
        folder.write(name, "x");
    }
    const ScanResult result = scan_folder(folder.path());
    EXPECT_THAT(names(result), ElementsAre("B.png", "a/A b\nc\"d\".jpg", "a/z.obj", "b.PNG", "\xc3\xa4.gif"));
    EXPECT_EQ(result.sources[0].dimension, 2);
    EXPECT_EQ(result.sources[2].dimension, 3);
    EXPECT_THAT(result.problems, IsEmpty());
}

TEST(FolderScan, FilesOfOtherKindsAreCounted) {
    const tests::TemporaryFolder folder;
    for (const char* name : {"a.png", "b.GLB", "c/d.glb", "e.hdr", "f.ply.gz", "LICENSE", "a.mtl", "x.csv"}) {
        folder.write(name, "x");
    }
    EXPECT_THAT(scan_folder(folder.path()).notes,
                ElementsAre("Passed over 4 files of kinds that are not read: .glb (2), .gz, .hdr."));
}

TEST(FolderScan, ContentOverrulesTheEnding) {
    const tests::TemporaryFolder folder;
    folder.write("mesh.png", "ply\nformat ascii 1.0\n");
    folder.write("image.stl", "GIF89a......");
    folder.write("image", "\x89PNG\r\n\x1a\n....");
    const ScanResult result = scan_folder(folder.path());
    ASSERT_THAT(names(result), ElementsAre("image", "image.stl", "mesh.png"));
    EXPECT_EQ(result.sources[0].dimension, 2);
    EXPECT_EQ(result.sources[1].dimension, 2);
    EXPECT_EQ(result.sources[2].dimension, 3);
}

TEST(FolderScan, LabelsComeFromTheFolderElseFromTheName) {
    const tests::TemporaryFolder folder;
    for (const char* name : {"cat/x.png", "dog/old/y.png"}) folder.write(name, "x");
    EXPECT_THAT(labels(scan_folder(folder.path())), ElementsAre("cat", "old"));
    const tests::TemporaryFolder flat;
    for (const char* name : {"device0-12.png", "device0-3.png", "left_foot_1.png", "leaf07.png", "12.png"})
        flat.write(name, "x");
    EXPECT_THAT(labels(scan_folder(flat.path())), ElementsAre("", "device0", "device0", "leaf", "left_foot"));
    EXPECT_THAT(labels(scan_folder(flat.path(), {"none"})), ElementsAre("", "", "", "", ""));
    EXPECT_THAT(labels(scan_folder(folder.path(), {"name"})), ElementsAre("x", "y"));
    EXPECT_THROW(scan_folder(flat.path(), {"colour"}), std::invalid_argument);
}

TEST(FolderScan, NamesThatAllDifferAreNotClasses) {
    const tests::TemporaryFolder folder;
    for (const char* name : {"apple.png", "pear.png"}) folder.write(name, "x");
    EXPECT_THAT(labels(scan_folder(folder.path())), ElementsAre("", ""));
    EXPECT_THAT(labels(scan_folder(folder.path(), {"name"})), ElementsAre("apple", "pear"));
}

TEST(FolderScan, LabelsCsvOverrulesFolders) {
    const tests::TemporaryFolder folder;
    for (const char* name : {"s/a,b.png", "s/c.png", "d.png"}) folder.write(name, "x");
    folder.write("labels.csv", "file,label\n\"s/a,b.png\",one\n./d.png,two\ngone.png,three\n");
    const ScanResult result = scan_folder(folder.path());
    EXPECT_THAT(labels(result), ElementsAre("two", "one", ""));
    ASSERT_THAT(result.notes, SizeIs(2));
    EXPECT_THAT(result.notes[0], HasSubstr("1 of 3 files have no label"));
    EXPECT_THAT(result.notes[1], HasSubstr("gone.png"));
    EXPECT_THAT(labels(scan_folder(folder.path(), {"folder"})), ElementsAre("", "s", "s"));
    folder.write("labels.csv", "d.png\n");
    EXPECT_THROW(scan_folder(folder.path()), ReadError);
    folder.write("labels.csv", "d.png,x\nd.png,y\n");
    EXPECT_THROW(scan_folder(folder.path()), ReadError);
}

TEST(FolderScan, MasksBelongToTheShapeBesideThem) {
    const tests::TemporaryFolder folder;
    for (const char* name : {"q/a.jpg", "q/a.mask.png", "q/b.jpg", "q/b.MASK.PNG", "q/lost.mask.png"}) {
        folder.write(name, "x");
    }
    const ScanResult result = scan_folder(folder.path());
    ASSERT_THAT(names(result), ElementsAre("q/a.jpg", "q/b.jpg"));
    EXPECT_EQ(result.sources[0].mask_path, folder / "q/a.mask.png");
    EXPECT_EQ(result.sources[1].mask_path, folder / "q/b.MASK.PNG");
    ASSERT_THAT(result.notes, SizeIs(1));
    EXPECT_THAT(result.notes[0], HasSubstr("lost.mask.png"));
    EXPECT_EQ(single_source(folder / "q/a.jpg").mask_path, folder / "q/a.mask.png");
}

TEST(FolderScan, LinkLoopsEndAndDanglingLinksAreProblems) {
    const tests::TemporaryFolder folder, elsewhere;
    folder.write("a/x.png", "x");
    elsewhere.write("far.png", "x");
    fs::create_directory_symlink(folder.path(), folder / "a/loop");
    fs::create_directory_symlink(folder / "a", folder / "0again");
    fs::create_directory_symlink(elsewhere.path(), folder / "linked");
    fs::create_symlink(folder / "a/x.png", folder / "also.png");
    fs::create_symlink(folder / "gone", folder / "dangling.png");
    fs::create_symlink(folder / "self.png", folder / "self.png");
    const ScanResult result = scan_folder(folder.path());
    EXPECT_THAT(names(result), ElementsAre("a/x.png", "also.png", "linked/far.png"));
    ASSERT_THAT(result.problems, SizeIs(2));
    EXPECT_THAT(result.problems[0].message(), HasSubstr("dangling.png: the link leads nowhere"));
}

TEST(FolderScan, PipesAndDevicesAreProblemsAndNeverOpened) {
    const tests::TemporaryFolder folder;
    folder.write("a.png", "x");
    ASSERT_EQ(mkfifo((folder / "pipe.png").c_str(), 0600), 0);
    ASSERT_EQ(mkfifo((folder / "a.mask.png").c_str(), 0600), 0);
    ASSERT_EQ(mkfifo((folder / "no_shape.txt").c_str(), 0600), 0);
    fs::create_symlink(folder / "pipe.png", folder / "to_pipe.png");
    fs::create_symlink("/dev/zero", folder / "zero.stl");
    ScanResult result = scan_folder(folder.path());
    EXPECT_THAT(names(result), ElementsAre("a.png"));
    EXPECT_TRUE(result.sources[0].mask_path.empty());
    ASSERT_THAT(result.problems, SizeIs(4));
    for (const ScanProblem& problem : result.problems) EXPECT_THAT(problem.message(), HasSubstr("not a file"));
    ASSERT_EQ(mkfifo((folder / "labels.csv").c_str(), 0600), 0);
    EXPECT_THROW(scan_folder(folder.path()), ReadError);
    fs::remove(folder / "labels.csv");
    fs::create_directory(folder / "labels.csv");
    EXPECT_THROW(scan_folder(folder.path()), ReadError);
}

/// Root may read every folder: for a while it is somebody else.
class SomebodyElse {
public:
    SomebodyElse() : changed_(geteuid() == 0 && seteuid(65534) == 0) {}
    ~SomebodyElse() {
        if (changed_) static_cast<void>(seteuid(0));
    }
    SomebodyElse(const SomebodyElse&) = delete;
    SomebodyElse& operator=(const SomebodyElse&) = delete;

private:
    bool changed_;
};

TEST(FolderScan, UnreadableFoldersAreProblemsAndTheRestGoesOn) {
    const tests::TemporaryFolder folder;
    folder.write("a/x.png", "x");
    folder.write("b/y.png", "x");
    constexpr fs::perms open = fs::perms::owner_all | fs::perms::group_all | fs::perms::others_all;
    for (const fs::path& readable : {folder.path(), folder / "b", folder / "b/y.png"}) fs::permissions(readable, open);
    fs::permissions(folder / "a", fs::perms::none);
    const SomebodyElse somebody;
    std::error_code error;
    if (geteuid() == 0) GTEST_SKIP() << "root may read every folder, and is not let be somebody else";
    if (!fs::exists(folder / "b/y.png", error)) GTEST_SKIP() << "only root may enter the folder of temporary files";
    const ScanResult result = scan_folder(folder.path());
    EXPECT_THAT(names(result), ElementsAre("b/y.png"));
    ASSERT_THAT(result.problems, SizeIs(1));
    EXPECT_EQ(result.problems[0].path, folder / "a");
}

TEST(FolderScan, FoldersBeyondTheLongestPathAreProblems) {
    const tests::TemporaryFolder folder;
    folder.write("a.png", "x");
    const std::string name(200, 'n');
    int at = open(folder.path().c_str(), O_RDONLY | O_DIRECTORY);
    for (int depth = 0; depth < 25; ++depth) {  // no path leads there, only one folder after the other
        ASSERT_EQ(mkdirat(at, name.c_str(), 0700), 0);
        const int next = openat(at, name.c_str(), O_RDONLY | O_DIRECTORY);
        close(at);
        at = next;
    }
    close(openat(at, "far.png", O_WRONLY | O_CREAT, 0600));
    close(at);
    const ScanResult result = scan_folder(folder.path());
    EXPECT_THAT(names(result), ElementsAre("a.png"));
    ASSERT_THAT(result.problems, SizeIs(1));
    EXPECT_THAT(result.problems[0].message(), HasSubstr("move it to a place with a shorter path"));
}

TEST(FolderScan, StudyFoldersInsideTheCollectionAreSkipped) {
    const tests::TemporaryFolder folder;
    for (const char* name : {"a.png", "old.study/study.sqlite", "old.study/paths/a.png"}) folder.write(name, "x");
    EXPECT_THAT(names(scan_folder(folder.path())), ElementsAre("a.png"));
}

TEST(FolderScan, ResultsOfTheProgramInsideTheCollectionAreSkippedAndThatIsSaid) {
    const tests::TemporaryFolder folder;
    for (const char* name : {"a.png", "d.analysis/clusters.csv", "d.analysis/linkage.csv", "d.analysis/embedding.csv",
                             "d.analysis/figures/page.png", "path/colours.json", "path/step-00.png", "path/step-01.png",
                             "q.classified/classification.csv", "q.classified/ranking.csv", "q.classified/x.png",
                             "figures/heat_map.svg", "figures/heat_map.pdf", "figures/heat_map.png",
                             "paper/gallery.html", "paper/figure-2.svg", "paper/figure-2.png", "paper/figure-2.csv"}) {
        folder.write(name, "x");
    }
    const ScanResult result = scan_folder(folder.path());
    EXPECT_THAT(names(result), ElementsAre("a.png"));
    EXPECT_THAT(result.problems, IsEmpty());
    ASSERT_THAT(result.notes, SizeIs(5));
    EXPECT_THAT(result.notes, testing::Contains(HasSubstr("path: it holds the path of a geodesic")));
    // Named itself, such a folder is one of shapes.
    EXPECT_THAT(names(scan_folder(folder / "path")), ElementsAre("step-00.png", "step-01.png"));
}

TEST(FolderScan, FoldersThatOnlyLookABitLikeResultsAreRead) {
    const tests::TemporaryFolder folder;
    for (const char* name : {"a/gallery.html", "a/x.png", "a/x.svg", "b/colours.json", "b/y.png", "c/distances.csv",
                             "c/step-00.png", "d.analysis/z.png", "figures/page.png"}) {
        folder.write(name, "x");
    }
    EXPECT_THAT(names(scan_folder(folder.path())),
                ElementsAre("a/x.png", "b/y.png", "c/step-00.png", "d.analysis/z.png", "figures/page.png"));
}

TEST(FolderScan, AMissingFolderIsAnErrorThatSaysSo) {
    const tests::TemporaryFolder folder;
    EXPECT_THROW(scan_folder(folder / "gone"), ReadError);
    EXPECT_THROW(scan_folder(folder.write("file.png", "x")), ReadError);
    EXPECT_THROW(single_source(folder / "gone.png"), ReadError);
    EXPECT_THROW(single_source(folder.write("text.txt", "x")), ReadError);
}

}  // namespace
}  // namespace morphodesic::datasets

#include <gtest/gtest.h>

#include "pipeline/path_files.h"

namespace morphodesic::pipeline {
namespace {

TEST(PathFolder, IsKnownAgain) {
    EXPECT_EQ(path_folder(6, "cats/a_1.png", "Ä.obj"), "007_cats-a-1_--");
    for (const std::string& name : {path_folder(0, "a.png", "b.png"), path_folder(4711, "x_y.png", ""),
                                    path_folder(1, std::string(300, 'a'), "b")}) {
        EXPECT_TRUE(is_path_folder(name)) << name;
    }
    for (const char* name :
         {"", "001", "01_a_b", "001_a", "001_a_b_c", "001-a_b", "001_a b_c", "thesis", "2024_trip"}) {
        EXPECT_FALSE(is_path_folder(name)) << name;
    }
}

TEST(PathFiles, AreKnownAgain) {
    for (const char* name : {"colours.json", "solids.key", "step-00.png", "step-100.vdb", "step-04.ply",
                             "step-00.png.part", "colours.json.part"}) {
        EXPECT_TRUE(is_path_file(name)) << name;
    }
    for (const char* name :
         {"", "note.txt", "step-0.png", "step-00.txt", "step-aa.png", "step-00.png.bak", "colours"}) {
        EXPECT_FALSE(is_path_file(name)) << name;
    }
}

}  // namespace
}  // namespace morphodesic::pipeline

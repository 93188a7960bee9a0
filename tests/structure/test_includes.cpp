// Reads every #include of the sources: fails on a forbidden arrow between folders, on an include that does not exist,
// and on a cycle. The checker is itself tested on small forged trees.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {
namespace fs = std::filesystem;

/// Includes of ours per file, both relative to the top.
using IncludeGraph = std::map<std::string, std::set<std::string>>;

const std::vector<std::string> folders{"pipeline", "geodesic", "analysis", "datasets", "reports"};

IncludeGraph read_includes(const fs::path& top) {
    static const std::regex directive("^\\s*#\\s*include\\s*\"([^\"]+)\"");
    IncludeGraph graph;
    for (const std::string& folder : folders) {
        if (!fs::exists(top / folder)) continue;
        for (const auto& entry : fs::recursive_directory_iterator(top / folder)) {
            const std::string ending = entry.path().extension().string();
            if (ending != ".h" && ending != ".cpp") continue;
            std::set<std::string>& includes = graph[fs::relative(entry.path(), top).generic_string()];
            std::ifstream file(entry.path());
            std::smatch match;
            for (std::string line; std::getline(file, line);) {
                if (std::regex_search(line, match, directive)) includes.insert(match[1]);
            }
        }
    }
    return graph;
}

/// Libraries whose own rules want their headers in quotes (Highway includes a file several times, by its path).
bool of_a_library(const std::string& include) {
    const auto slash = include.find('/');
    return slash != std::string::npos && include[0] != '.' &&
           std::find(folders.begin(), folders.end(), include.substr(0, slash)) == folders.end();
}

/// Whether an include in `from` may name `to`; both are paths relative to the top.
bool allowed(const std::string& from, const std::string& to) {
    const auto folder = [](const std::string& path) { return path.substr(0, path.find('/')); };
    const std::string a = folder(from), b = folder(to);
    if (b == "tests") return false;
    if (a == b) return true;
    if (a == "pipeline") return b == "datasets" || b == "geodesic" || b == "analysis" || b == "reports";
    if (a == "datasets") return to.rfind("geodesic/grid/", 0) == 0;
    if (a == "reports") return b == "analysis";
    return false;
}

/// Arrows inside geodesic: kernels <- grid <- energy <- solver <- discrete_geodesic.
int geodesic_layer(const std::string& file) {
    const std::vector<std::string> layers{"geodesic/kernels/", "geodesic/grid/", "geodesic/energy/",
                                          "geodesic/solver/"};
    for (std::size_t i = 0; i < layers.size(); ++i) {
        if (file.rfind(layers[i], 0) == 0) return static_cast<int>(i);
    }
    return static_cast<int>(layers.size());
}

/// Arrows that lead up inside geodesic and are accepted: plain option and result structs without code.
bool plain_struct(const std::string& include) {
    return include == "geodesic/solver/geodesic_options.h" || include == "geodesic/discrete_geodesic.h";
}

std::vector<std::string> violations(const fs::path& top) {
    const IncludeGraph graph = read_includes(top);
    std::vector<std::string> found;
    for (const auto& [file, includes] : graph) {
        for (const std::string& include : includes) {
            if (of_a_library(include)) continue;
            if (!fs::exists(top / include)) {
                found.push_back(file + " includes " + include + ", which does not exist (paths start at the top)");
            } else if (!allowed(file, include)) {
                found.push_back(file + " must not include " + include);
            } else if (include.rfind("geodesic/", 0) == 0 && file.rfind("geodesic/", 0) == 0 &&
                       geodesic_layer(include) > geodesic_layer(file) && !plain_struct(include)) {
                found.push_back(file + " must not include " + include + " of a higher layer");
            }
        }
    }
    std::map<std::string, int> state;  // 0: not seen, 1: on the way, 2: done
    std::vector<std::string> way;
    const std::function<void(const std::string&)> visit = [&](const std::string& at) {
        state[at] = 1;
        const auto includes = graph.find(at);
        if (includes == graph.end()) {
            state[at] = 2;
            return;
        }
        way.push_back(at);
        for (const std::string& next : includes->second) {
            if (state[next] == 1) {
                std::string cycle = "cycle:";
                for (auto it = std::find(way.begin(), way.end(), next); it != way.end(); ++it)
                    cycle += " " + *it + " ->";
                found.push_back(cycle + " " + next);
            } else if (state[next] == 0) {
                visit(next);
            }
        }
        way.pop_back();
        state[at] = 2;
    };
    for (const auto& [file, includes] : graph) {
        if (state[file] == 0) visit(file);
    }
    return found;
}

/// Writes a tree of files into a fresh folder and removes it at the end.
class ForgedTree : public testing::Test {
protected:
    void SetUp() override {
        top_ = fs::temp_directory_path() /
               ("morphodesic-structure-" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
        fs::remove_all(top_);
    }
    void TearDown() override { fs::remove_all(top_); }
    void write(const std::string& file, const std::string& text) {
        fs::create_directories((top_ / file).parent_path());
        std::ofstream(top_ / file) << text;
    }
    fs::path top_;
};

TEST(Structure, TheSourcesKeepToTheArrows) {
    const fs::path top = MORPHODESIC_SOURCE_DIR;
    ASSERT_GT(read_includes(top).size(), 10u);
    EXPECT_THAT(violations(top), testing::IsEmpty());
}

TEST(Structure, TheTopLevelIsWhatTheReadmeSays) {
    const std::set<std::string> expected{"CMakeLists.txt", "CMakePresets.json", "LICENSE",  "README.md", "pipeline",
                                         "geodesic",       "analysis",          "datasets", "reports",   "tests"};
    std::set<std::string> found;
    for (const auto& entry : fs::directory_iterator(MORPHODESIC_SOURCE_DIR)) {
        const std::string name = entry.path().filename().string();
        const bool built = name == "build" || name.rfind("build-", 0) == 0 || name == "compile_commands.json";
        if (name.front() != '.' && !built) found.insert(name);
    }
    EXPECT_EQ(found, expected);
}

TEST_F(ForgedTree, AGoodTreePasses) {
    write("geodesic/grid/fields.h", "#pragma once\n");
    write("datasets/shape.h", "#include \"geodesic/grid/fields.h\"\n#include <vector>\n");
    write("pipeline/main.cpp", "#include \"datasets/shape.h\"\n");
    EXPECT_THAT(violations(top_), testing::IsEmpty());
}

TEST_F(ForgedTree, EveryForbiddenArrowIsFound) {
    write("geodesic/discrete_geodesic.h", "#pragma once\n");
    write("analysis/linkage.h", "  #  include \"geodesic/discrete_geodesic.h\"\n");
    write("datasets/shape.h", "#include \"geodesic/discrete_geodesic.h\"\n");
    write("reports/report.h", "#include \"datasets/shape.h\"\n");
    write("geodesic/kernels/sums.h", "#include \"analysis/linkage.h\"\n");
    write("datasets/import.h", "#include \"pipeline/cli.h\"\n");
    write("pipeline/cli.h", "");
    EXPECT_THAT(violations(top_),
                testing::UnorderedElementsAre("analysis/linkage.h must not include geodesic/discrete_geodesic.h",
                                              "datasets/shape.h must not include geodesic/discrete_geodesic.h",
                                              "reports/report.h must not include datasets/shape.h",
                                              "geodesic/kernels/sums.h must not include analysis/linkage.h",
                                              "datasets/import.h must not include pipeline/cli.h"));
}

TEST_F(ForgedTree, AnUpwardArrowInsideGeodesicIsFound) {
    write("geodesic/solver/cascade.h", "");
    write("geodesic/energy/path_energy.h", "#include \"geodesic/solver/cascade.h\"\n");
    EXPECT_THAT(violations(top_), testing::ElementsAre(testing::HasSubstr("of a higher layer")));
}

TEST_F(ForgedTree, CyclesAreFound) {
    write("analysis/a.h", "#include \"analysis/b.h\"\n");
    write("analysis/b.h", "#include \"analysis/c.h\"\n");
    write("analysis/c.h", "#include \"analysis/a.h\"\n");
    write("analysis/d.cpp", "#include \"analysis/a.h\"\n");
    EXPECT_THAT(violations(top_),
                testing::ElementsAre("cycle: analysis/a.h -> analysis/b.h -> analysis/c.h -> analysis/a.h"));
}

TEST_F(ForgedTree, HeadersOfALibraryAreNotOurs) {
    write("geodesic/kernels/sums.cpp", "#include \"hwy/highway.h\"\n");
    EXPECT_THAT(violations(top_), testing::IsEmpty());
}

TEST_F(ForgedTree, AnIncludeThatDoesNotExistIsFound) {
    write("analysis/a.h", "#include \"linkage.h\"\n");
    EXPECT_THAT(violations(top_), testing::ElementsAre(testing::HasSubstr("which does not exist")));
}

}  // namespace

// What the program writes against what reports/FORMAT.md says of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "program.h"

namespace morphodesic::tests {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Words = std::set<std::string>;

/// What stands between backticks.
Words words_in(const std::string& text) {
    static const std::regex word("`([^`]+)`");
    Words words;
    for (std::sregex_iterator it(text.begin(), text.end(), word), end; it != end; ++it) words.insert((*it)[1]);
    return words;
}

/// The section of FORMAT.md with that title.
std::string section(const std::string& title) {
    const std::string text = read_file(fs::path(MORPHODESIC_SOURCE_DIR) / "reports/FORMAT.md");
    const std::size_t begin = text.find("\n## " + title + "\n");
    if (begin == std::string::npos) return "";
    return text.substr(begin, text.find("\n## ", begin + 4) - begin);
}

TEST(Formats, EveryKeyOfTheJsonOfACommandIsDocumented) {
    std::string common;
    std::map<std::string, Words> keys_of;  // by command
    std::istringstream lines(section("--json"));
    for (std::string line; std::getline(lines, line);) {
        if (line.rfind("| `", 0) != 0) {
            common += line + "\n";
            continue;
        }
        const std::size_t bar = line.find(" | ");
        for (const std::string& command : words_in(line.substr(0, bar))) keys_of[command] = words_in(line.substr(bar));
    }
    ASSERT_GT(keys_of.size(), 8U);
    for (const std::string& key : keys_of["report"]) keys_of["run"].insert(key);

    const TemporaryFolder folder;
    make_disks(folder / "disks", 4);
    const std::string disks = (folder / "disks").string(), study = disks + ".study";
    const std::vector<std::vector<std::string>> commands{
        {"datasets", "bars", "--count", "2", "--out", (folder / "bars").string()},
        {"datasets", "occlude", disks},
        quick({"ingest", disks, "--neighbors", "1"}),
        {"plan", study, "--shards", "1"},
        {"shard", study, "1/1"},
        {"merge", study},
        {"geodesics", study},
        {"verify", study, "--sample", "1"},
        {"analyze", study},
        {"report", study, "--paths", "none"},
        quick({"run", disks, "--neighbors", "1"}),
    };
    for (std::vector<std::string> command : commands) {
        const std::string name = command.front();
        command.insert(command.end(), {"--json", "--quiet"});
        const Outcome done = morphodesic(command);
        ASSERT_NE(done.code, 2) << name << ": " << done.err;
        Words documented = words_in(common), used;
        documented.insert(keys_of[name].begin(), keys_of[name].end());
        const json said = json::parse(done.out);
        for (const auto& [key, value] : said.items()) {
            EXPECT_TRUE(documented.contains(key)) << key << " of " << name;
            used.insert(key);
        }
        EXPECT_TRUE(used.contains("exit_code")) << name;
    }
}

TEST(Formats, ColumnsOfTheTablesAreThoseOfTheirSections) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 5);
    ASSERT_EQ(morphodesic(quick({"run", (folder / "disks").string(), "--both-directions", "--quiet"})).code, 0);
    for (const char* table : {"pairs.csv", "clusters.csv", "linkage.csv", "shapes.csv"}) {
        const std::string text = section(table);
        ASSERT_NE(text, "") << table;
        const std::string bytes = read_file(folder / "disks.study" / table);
        std::istringstream heads(bytes.substr(0, bytes.find('\n')));
        for (std::string head; std::getline(heads, head, ',');) {
            const std::regex named("(^|[^a-z_])" + head + "($|[^a-z_])");
            EXPECT_TRUE(std::regex_search(text, named)) << head << " of " << table;
        }
    }
}

}  // namespace
}  // namespace morphodesic::tests

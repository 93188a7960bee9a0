// What the program says where the command line is wrong, and what an option means.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "program.h"

namespace morphodesic::tests {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

TEST(Usage, EveryMistakeHasItsExitCode) {
    const TemporaryFolder folder;
    EXPECT_EQ(morphodesic({}).code, 2);
    EXPECT_EQ(morphodesic({"run"}).code, 2);
    EXPECT_EQ(morphodesic({"fly"}).code, 2);
    EXPECT_EQ(morphodesic({"run", folder.path().string(), "--wings"}).code, 2);
    EXPECT_EQ(morphodesic({"run", (folder / "nothing").string()}).code, 2);
    EXPECT_EQ(morphodesic({"geodesic", (folder / "a.png").string(), (folder / "b.png").string()}).code, 2);
    const Outcome level = morphodesic({"run", folder.path().string(), "--level", "99"});
    EXPECT_EQ(level.code, 2);
    EXPECT_THAT(level.err, HasSubstr("level must be between"));
    EXPECT_EQ(morphodesic({"--help"}).code, 0);
    EXPECT_THAT(morphodesic({"--version"}).out, HasSubstr("morphodesic "));
}

TEST(Usage, WrongWordsAreNamed) {
    const TemporaryFolder folder;
    write_file(folder / "x.toml", "seed = 2\n");
    const Outcome command = morphodesic({"fly"}),
                  kind = morphodesic({"datasets", "--config", (folder / "x.toml").string(), "birds"});
    EXPECT_EQ(command.code, 2);
    EXPECT_THAT(command.err, HasSubstr("no command \"fly\"; there are: run, "));
    EXPECT_EQ(kind.code, 2);
    EXPECT_THAT(kind.err, HasSubstr("no command \"datasets birds\"; there are: occlude, "));
    const Outcome option = morphodesic({"geodesics", (folder / "study").string(), "--normalize", "each"});
    EXPECT_EQ(option.code, 2);
    EXPECT_THAT(option.err, HasSubstr("morphodesic: geodesics has no option --normalize, it is one of: run, ingest"));
    const Outcome value = morphodesic({"run", folder.path().string(), "--preset", "fast", "--level", "5.5"});
    EXPECT_EQ(value.code, 2);
    EXPECT_THAT(value.err, HasSubstr("morphodesic: --level cannot be 5.5: it must be a whole number"));
    EXPECT_THAT(morphodesic({"run", folder.path().string(), "--steps=many"}).err, HasSubstr("--steps cannot be many"));
    make_disks(folder / "disks", 2);
    fs::copy_file(folder / "disks/disk-01.png", folder / "disks/-a.png");
    const Outcome file =
        shell("cd '" + (folder / "disks").string() + "' && \"$MORPHODESIC\" geodesic -a.png disk-02.png");
    EXPECT_EQ(file.code, 2);
    EXPECT_THAT(file.err, HasSubstr("write ./-a.png"));
}

TEST(Usage, OptionsWithoutEffectAreSaid) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 2);
    const std::string disks = (folder / "disks").string();
    const Outcome pair = morphodesic(quick(
        {"geodesic", disks + "/disk-01.png", disks + "/disk-02.png", "--mirror", "*", "--dimension", "3", "--quiet"}));
    EXPECT_EQ(pair.code, 0) << pair.err;
    EXPECT_THAT(pair.err, HasSubstr("--dimension 3 has no effect: both files are images"));
    EXPECT_THAT(pair.err, HasSubstr("--mirror has no effect for *"));
    EXPECT_THAT(morphodesic(quick({"ingest", disks, "--mirror", "nosuch"})).err,
                HasSubstr("--mirror has no effect for nosuch"));
}

TEST(Usage, AStudyThatDoesNotExistIsAWrongName) {
    const TemporaryFolder folder;
    const std::string nothing = (folder / "nothing").string();
    make_disks(folder / "disks", 2);
    std::vector<std::vector<std::string>> commands{{"plan", nothing, "--shards", "2"},
                                                   {"classify", "--templates", nothing, "--leave-one-out"}};
    for (const char* command : {"report", "analyze", "verify", "geodesics", "merge"}) {
        commands.push_back({command, nothing});
    }
    for (const auto& command : commands) {
        const Outcome done = morphodesic(command);
        EXPECT_EQ(done.code, 2) << command.front();
        EXPECT_THAT(done.err, HasSubstr("nothing")) << command.front();
        EXPECT_FALSE(fs::exists(nothing)) << command.front();
    }
    // A study that was begun, with no shapes in it.
    write_file(folder / "empty/readme.txt", "");
    ASSERT_EQ(morphodesic({"run", (folder / "empty").string()}).code, 2);
    for (auto command : commands) {
        if (command.front() == "classify") continue;
        command[1] = (folder / "empty.study").string();
        const Outcome done = morphodesic(command);
        EXPECT_EQ(done.code, 2) << command.front() << done.err;
    }
}

TEST(Usage, AWrongChoiceOfPathsIsRefusedBeforeAnyWork) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 3);
    const std::string disks = (folder / "disks").string();
    write_file(folder / "table.csv", ",a,b\na,0,1\nb,1,0\n");
    for (const char* paths : {"foo", "-3", "2.5"}) {
        const std::string choice = std::string("--paths=") + paths;
        for (const auto& command : std::vector<std::vector<std::string>>{
                 quick({"run", disks, choice}), {"report", (folder / "table.csv").string(), choice}}) {
            const Outcome done = morphodesic(command);
            EXPECT_EQ(done.code, 2) << choice;
            EXPECT_THAT(done.err, HasSubstr("--paths")) << choice;
        }
    }
    EXPECT_FALSE(fs::exists(folder / "disks.study"));
    EXPECT_FALSE(fs::exists(folder / "table.analysis"));
}

TEST(Usage, AScaleNeedsTheCommonOne) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 2);
    const std::string a = (folder / "disks" / "disk-01.png").string(), b = (folder / "disks" / "disk-02.png").string();
    for (const std::string normalize : {"none", "each"}) {
        const Outcome done = morphodesic({"geodesic", a, b, "--scale", "0.001", "--normalize", normalize});
        EXPECT_EQ(done.code, 2) << normalize;
        EXPECT_THAT(done.err, HasSubstr("--scale")) << normalize;
    }
}

TEST(Usage, NumbersMustBeFinite) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 2);
    const std::string disks = (folder / "disks").string(), a = disks + "/disk-01.png", b = disks + "/disk-02.png";
    const std::vector<std::string> compare{"geodesic", a, b}, study{"run", disks}, men{"datasets", "matchstick"},
        occlude{"datasets", "occlude", disks}, query{"classify", a, "--templates", disks};
    for (const char* number : {"nan", "-nan", "inf", "1e999"}) {
        for (const auto& [command, option] :
             std::vector<std::pair<std::vector<std::string>, std::string>>{{compare, "--scale"},
                                                                           {study, "--lambda"},
                                                                           {study, "--mismatch-weight"},
                                                                           {study, "--cut-height"},
                                                                           {study, "--max-megapixels"},
                                                                           {men, "--variation"},
                                                                           {occlude, "--fraction"},
                                                                           {occlude, "--direction"},
                                                                           {query, "--hidden-cost"}}) {
            std::vector<std::string> words = command;
            words.push_back(option + "=" + number);
            if (option == "--direction") words.back() += ",1";
            if (command != compare) words.insert(words.end(), {"--out", (folder / "out").string()});
            const Outcome done = morphodesic(words);
            EXPECT_EQ(done.code, 2) << option << " " << number;
            EXPECT_THAT(done.err, HasSubstr(option)) << number;
            EXPECT_FALSE(fs::exists(folder / "out")) << option << " " << number;
        }
    }
}

TEST(Usage, QueriesAreNotLeftUnreadBesideLeaveOneOut) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 2);
    const std::string disks = (folder / "disks").string();
    const Outcome done = morphodesic({"classify", disks, "--templates", disks, "--leave-one-out"});
    EXPECT_EQ(done.code, 2);
    EXPECT_THAT(done.err, HasSubstr("--leave-one-out"));
    const Outcome few =
        morphodesic({"classify", "--templates", disks, "--leave-one-out", "--templates-per-class", "1"});
    EXPECT_EQ(few.code, 2);
    EXPECT_THAT(few.err, HasSubstr("--templates-per-class keeps a few of them"));
    EXPECT_FALSE(fs::exists(folder / "disks.classified"));
}

TEST(Usage, WhereNothingCouldBeUsedNothingElseIsPromised) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 2);
    const std::string disks = (folder / "disks").string(), out = (folder / "out").string();
    const Outcome occlude = morphodesic({"datasets", "occlude", disks, "--direction", "1,0,0", "--out", out});
    EXPECT_EQ(occlude.code, 2);
    EXPECT_THAT(occlude.out, testing::Not(HasSubstr("Classify them")));
    EXPECT_FALSE(fs::exists(folder / "out/truth.csv"));
    write_file(folder / "bad.png", "no picture");
    const Outcome query = morphodesic(quick({"classify", (folder / "bad.png").string(), "--templates", disks,
                                             "--labels", "name", "--no-calibrate", "--out", out}));
    EXPECT_EQ(query.code, 2);
    EXPECT_THAT(query.out, HasSubstr("No query could be used."));
    EXPECT_THAT(query.out, testing::Not(HasSubstr("a second")));
}

TEST(Usage, AFolderWithoutShapesIsNothingUsable) {
    const TemporaryFolder folder;
    write_file(folder / "texts/readme.txt", "no shapes here");
    const Outcome done = morphodesic({"run", (folder / "texts").string()});
    EXPECT_EQ(done.code, 2);
    EXPECT_THAT(done.err, HasSubstr("no shapes found"));
}

TEST(Usage, AStudyFolderThatCannotBeMadeIsTheEnvironment) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 2);
    write_file(folder / "file", "in the way");
    const Outcome done = morphodesic({"run", (folder / "disks").string(), "--out", (folder / "file/study").string()});
    EXPECT_EQ(done.code, 3);
    EXPECT_THAT(done.err, HasSubstr("--out"));
}

TEST(Usage, HelpTeachesEverySubcommand) {
    const auto commands_of = [](const std::string& help) {
        std::vector<std::string> names;
        std::istringstream lines(help.substr(help.find("Subcommands:\n")));
        std::string line;
        std::getline(lines, line);
        while (std::getline(lines, line) && line.starts_with("  ")) {
            const std::string name = line.substr(2, line.find(' ', 2) - 2);
            if (!name.empty()) names.push_back(name);
        }
        return names;
    };
    std::vector<std::vector<std::string>> all;
    for (const std::string& name : commands_of(morphodesic({"--help"}).out)) all.push_back({name});
    EXPECT_GE(all.size(), 13U);
    for (const std::string& kind : commands_of(morphodesic({"datasets", "--help"}).out))
        all.push_back({"datasets", kind});
    EXPECT_GE(all.size(), 21U);
    for (std::vector<std::string> words : all) {
        words.emplace_back("--help");
        const Outcome help = morphodesic(words);
        EXPECT_EQ(help.code, 0);
        EXPECT_THAT(help.out, HasSubstr("Examples:")) << words.front();
    }
}

TEST(Usage, ConfigurationFilesStandBelowTheCommandLineAndAbovePresets) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 2);
    write_file(folder / "study.toml",
               "level = 4\nsteps = 2\nlambda = 2.0\nalign = \"none\"\npreserve-volume = false\n");
    const Outcome done = morphodesic({"run", (folder / "disks").string(), "--config", (folder / "study.toml").string(),
                                      "--preset", "fine", "--lambda", "1.5", "--quiet"});
    ASSERT_EQ(done.code, 0) << done.err;
    const std::string report = read_file(folder / "disks.study/report.json");
    const json model = json::parse(report);
    std::map<std::string, std::string> settings;
    for (const auto& setting : model["settings"]) settings[setting["name"]] = setting["value"];
    EXPECT_EQ(settings["level"], "4");
    EXPECT_EQ(settings["lambda"], "1.5");
    EXPECT_EQ(settings["align"], "none");
    EXPECT_EQ(settings["tolerance"], "0.00025");  // of the preset
}

TEST(Usage, AConfigurationFileServesAlsoTheKindsOfDatasets) {
    const TemporaryFolder folder;
    write_file(folder / "c.toml", "size = 32\ncount = 3\n");
    const std::string file = (folder / "c.toml").string();
    const auto made = [&](const std::string& name, std::vector<std::string> words) {
        words.insert(words.end(), {"--out", (folder / name).string(), "--json"});
        const Outcome done = morphodesic(words);
        EXPECT_EQ(done.code, 0) << done.err;
        return done.code == 0 ? json::parse(done.out)["shapes"] : json();
    };
    EXPECT_EQ(made("behind", {"datasets", "bars", "--config", file}), 3);
    EXPECT_EQ(made("before", {"datasets", "--config", file, "disks"}), 3);
    EXPECT_EQ(made("overruled", {"datasets", "bars", "--count", "2", "--config=" + file}), 2);
}

TEST(Usage, AWrongConfigurationFileIsSaidWithFileAndLine) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 2);
    write_file(folder / "bad.toml", "level = 4\nlevel = [\n");
    const Outcome broken =
        morphodesic({"run", (folder / "disks").string(), "--config", (folder / "bad.toml").string()});
    EXPECT_EQ(broken.code, 2);
    EXPECT_THAT(broken.err, HasSubstr("bad.toml, line 2"));
    const Outcome no_file = morphodesic({"run", (folder / "disks").string(), "--config", folder.path().string()});
    EXPECT_EQ(no_file.code, 2);
    EXPECT_THAT(no_file.err, HasSubstr(folder.path().string() + ": is a folder"));
}

TEST(Usage, AWrongOptionInAConfigurationFileIsSaidWithFileAndLine) {
    const TemporaryFolder folder;
    const std::string file = (folder / "c.toml").string();
    const auto expect = [&](std::vector<std::string> command, const std::string& options, const std::string& said) {
        write_file(file, options);
        command.insert(command.end(), {"--config", file});
        const Outcome done = morphodesic(command);
        EXPECT_EQ(done.code, 2) << options;
        EXPECT_EQ(done.err, said) << options;
    };
    const std::string start = "morphodesic: " + file + ", line ", run = "; see morphodesic run --help\n";
    expect({"run", "x"}, "steps = 4\nlevle = 5\nangle = 1\n",
           start + "2: there is no option \"levle\"" + run + start + "3: there is no option \"angle\"" + run);
    expect({"run", "x"}, "level = 5.5\n", start + "1: \"level\" cannot be 5.5: it must be a whole number" + run);
    expect({"run", "x"}, "# mine\nlambda = \"much\"\n",
           start + "2: \"lambda\" cannot be much: it must be a number" + run);
    expect({"run", "x"}, "preserve-volume = \"often\"\n",
           start + "1: \"preserve-volume\" cannot be often: it must be true or false" + run);
    expect({"run", "x"}, "preset = \"nice\"\n",
           start + "1: \"preset\" cannot be nice: nice not in {fast,standard,fine}" + run);
    expect({"run", "x"}, "folder = \"y\"\n", start + "1: there is no option \"folder\"" + run);
    expect({"datasets", "bars"}, "wings = 2\n",
           start + "1: there is no option \"wings\"; see morphodesic datasets bars --help\n");
}

}  // namespace
}  // namespace morphodesic::tests

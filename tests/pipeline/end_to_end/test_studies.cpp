// Whole runs of the program on small generated collections.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "analysis/matrix_csv.h"
#include "datasets/drawing.h"
#include "program.h"
#include "tests/support/json_schema.h"

namespace morphodesic::tests {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

TEST(Study, ARunLeavesEverythingTheContractNames) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 5);
    const Outcome done = morphodesic(quick({"run", (folder / "disks").string(), "--paths", "2"}));
    ASSERT_EQ(done.code, 0) << done.err;
    for (const char* name : {"study.sqlite", "distances.csv", "distances.npy", "pairs.csv", "clusters.csv",
                             "linkage.csv", "embedding.csv", "report.html", "report.json", "paths"}) {
        EXPECT_TRUE(fs::exists(folder / "disks.study" / name)) << name;
    }
    EXPECT_THAT(done.out, HasSubstr("5 shapes, 10 pairs"));
    const auto distances = analysis::read_distance_csv(folder / "disks.study" / "distances.csv");
    ASSERT_EQ(distances.size(), 5u);
    EXPECT_EQ(distances.missing_count(), 0u);
    // Larger and larger disks: the distance grows with the difference of the radii.
    for (std::size_t i = 2; i < 5; ++i) EXPECT_GT(distances(0, i), distances(0, i - 1));
    const json report = json::parse(read_file(folder / "disks.study" / "report.json"));
    EXPECT_EQ(schema_errors(report, schema("report.schema.json")), "");
    EXPECT_EQ(report["shapes"].size(), 5u);
}

TEST(Study, TheSameCommandAgainComputesNothing) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 4);
    const auto command = quick({"run", (folder / "disks").string(), "--json", "--quiet"});
    const json first = json::parse(morphodesic(command).out);
    EXPECT_EQ(first["pairs_computed"], 6);
    EXPECT_EQ(first["seconds_of_all_runs"], first["seconds"]);
    const std::string bytes = read_file(folder / "disks.study/distances.csv");
    const json second = json::parse(morphodesic(command).out);
    EXPECT_EQ(second["pairs_computed"], 0);
    EXPECT_EQ(second["pairs_from_store"], 6);
    EXPECT_EQ(read_file(folder / "disks.study/distances.csv"), bytes);
}

TEST(Study, PathsAreDrawnOfTheseOrThesePairs) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 5);
    const fs::path study = folder / "disks.study";
    ASSERT_EQ(morphodesic(quick({"run", (folder / "disks").string(), "--quiet"})).code, 0);
    const auto drawn = [&](const char* choice) {
        const Outcome done = morphodesic({"report", study.string(), "--paths", choice, "--quiet"});
        EXPECT_EQ(done.code, 0) << choice << done.err;
        std::set<std::pair<std::size_t, std::size_t>> pairs;
        const json report = json::parse(read_file(study / "report.json"));
        for (const json& path : report["paths"]) {
            pairs.emplace(std::minmax(path["a"].get<std::size_t>(), path["b"].get<std::size_t>()));
        }
        return pairs;
    };
    EXPECT_EQ(drawn("none").size(), 0U);
    EXPECT_EQ(drawn("3").size(), 3U);
    EXPECT_EQ(drawn("all").size(), 10U);
    const auto distances = analysis::read_distance_csv(study / "distances.csv");
    std::set<std::pair<std::size_t, std::size_t>> nearest;
    for (std::size_t i = 0; i < 5; ++i) {
        std::size_t best = i == 0 ? 1 : 0;
        for (std::size_t j = 0; j < 5; ++j) {
            if (j != i && distances(i, j) < distances(i, best)) best = j;
        }
        nearest.emplace(std::minmax(i, best));
    }
    EXPECT_EQ(drawn("nearest"), nearest);
}

TEST(Study, TheTableWithoutEstimatesIsThereAlsoWhereThereAreNone) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 3);
    // On this level nothing is coarser that could estimate anything.
    ASSERT_EQ(morphodesic(quick({"run", (folder / "disks").string(), "--neighbors", "1", "--quiet"})).code, 0);
    EXPECT_EQ(read_file(folder / "disks.study/distances_refined.csv"), read_file(folder / "disks.study/distances.csv"));
    ASSERT_EQ(morphodesic(quick({"run", (folder / "disks").string(), "--quiet"})).code, 0);
    EXPECT_FALSE(fs::exists(folder / "disks.study/distances_refined.csv"));
}

TEST(Study, BytesDoNotDependOnThreads) {
    const TemporaryFolder folder;
    ASSERT_EQ(
        morphodesic({"datasets", "matchstick", "--out", (folder / "men").string(), "--count", "5", "--quiet"}).code, 0);
    for (const char* threads : {"1", "8"}) {
        const Outcome done = morphodesic({"run", (folder / "men").string(), "--level", "5", "--steps", "2", "--threads",
                                          threads, "--out", (folder / threads).string(), "--paths", "none"});
        ASSERT_EQ(done.code, 0) << done.err;
    }
    const std::string bytes = read_file(folder / "1/distances.csv");
    ASSERT_FALSE(bytes.empty());
    EXPECT_EQ(read_file(folder / "8/distances.csv"), bytes);
    EXPECT_EQ(read_file(folder / "8/linkage.csv"), read_file(folder / "1/linkage.csv"));
}

TEST(Study, PathsStartFromTheSameShapeHoweverThePicturesAreTurned) {
    const TemporaryFolder folder;
    const auto turned = [](const std::string& name, std::vector<datasets::Loop> polygons, double angle) {
        for (auto& polygon : polygons) {
            for (auto& p : polygon) {
                const double x = p[0] - 0.5, y = p[1] - 0.5;
                p = {0.5 + std::cos(angle) * x - std::sin(angle) * y, 0.5 + std::sin(angle) * x + std::cos(angle) * y};
            }
        }
        return datasets::Drawing{name, "", {}, std::move(polygons)};
    };
    const std::vector<datasets::Loop> corner{datasets::capsule_polygon({0.3, 0.3}, {0.7, 0.3}, 0.06),
                                             datasets::capsule_polygon({0.3, 0.3}, {0.3, 0.65}, 0.06)};
    const std::vector<datasets::Loop> bar{datasets::capsule_polygon({0.25, 0.5}, {0.75, 0.5}, 0.07)};
    for (const char* normalize : {"common", "each"}) {
        for (const double angle : {0.0, 0.7, 1.9, 3.1, 4.4}) {
            const fs::path shapes = folder / (std::string(normalize) + std::to_string(angle));
            datasets::write_collection(shapes, {turned("corner", corner, angle), turned("bar", bar, 2.0 * angle)}, 128);
            const Outcome done = morphodesic(quick({"run", shapes.string(), "--normalize", normalize, "--quiet"}));
            ASSERT_EQ(done.code, 0) << done.err;
            const std::string pairs = read_file(shapes.string() + ".study/pairs.csv");
            EXPECT_THAT(pairs, HasSubstr(",bar.png,4,2,")) << normalize << " " << angle;
            EXPECT_THAT(pairs, testing::Not(HasSubstr(",corner.png,4"))) << normalize << " " << angle;
        }
    }
}

TEST(Study, OneMoreImageComputesOnlyItsPairs) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 5);
    const fs::path last = folder / "disks/disk-03.png";
    fs::rename(last, folder / "aside.png");  // not the largest: the common scale stays
    const auto command = quick({"run", (folder / "disks").string(), "--json", "--quiet"});
    EXPECT_EQ(json::parse(morphodesic(command).out)["pairs_computed"], 6);
    fs::rename(folder / "aside.png", last);
    const json more = json::parse(morphodesic(command).out);
    EXPECT_EQ(more["pairs_computed"], 4);
    EXPECT_EQ(more["pairs_from_store"], 6);
    const auto other = quick({"run", (folder / "disks").string(), "--out", (folder / "fresh").string(), "--quiet"});
    ASSERT_EQ(morphodesic(other).code, 0);
    EXPECT_EQ(read_file(folder / "disks.study/distances.csv"), read_file(folder / "fresh/distances.csv"));
}

TEST(Study, AShapeThatDoesNotFitRescalesAllAndSaysSo) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 4);
    const fs::path largest = folder / "disks/disk-04.png";
    fs::rename(largest, folder / "aside.png");
    const auto command = quick({"run", (folder / "disks").string(), "--json"});
    ASSERT_EQ(morphodesic(command).code, 0);
    fs::rename(folder / "aside.png", largest);
    const Outcome again = morphodesic(command);
    EXPECT_EQ(json::parse(again.out)["pairs_computed"], 6);
    EXPECT_THAT(again.err, HasSubstr("does not fit"));
}

TEST(Study, AStrayFileThatIsGoneAgainDoesNotKeepTheOthersSmall) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 3);
    make_disks(folder / "stray", 1, 900);
    const fs::path stray = folder / "disks/stray.png";
    fs::copy_file(folder / "stray/disk-01.png", stray);
    const auto command = quick({"run", (folder / "disks").string(), "--json"});
    ASSERT_EQ(json::parse(morphodesic(command).out)["pairs_computed"], 6);
    const std::string with_stray = read_file(folder / "disks.study/distances.csv");
    fs::rename(stray, folder / "aside.png");
    const Outcome without = morphodesic(command);
    EXPECT_EQ(json::parse(without.out)["pairs_computed"], 3);
    EXPECT_THAT(without.err, HasSubstr("up to 3 pairs to compute"));
    const auto fresh = quick({"run", (folder / "disks").string(), "--out", (folder / "fresh").string(), "--quiet"});
    ASSERT_EQ(morphodesic(fresh).code, 0);
    EXPECT_EQ(read_file(folder / "disks.study/distances.csv"), read_file(folder / "fresh/distances.csv"));
    EXPECT_THAT(morphodesic(command).err, testing::Not(HasSubstr("scale")));
    fs::rename(folder / "aside.png", stray);  // its pairs, and those of the others at its scale, are still there
    EXPECT_EQ(json::parse(morphodesic(command).out)["pairs_computed"], 0);
    EXPECT_EQ(read_file(folder / "disks.study/distances.csv"), with_stray);
}

TEST(Study, MadeFromAnotherFolderIsNotTakenOverInSilence) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 3);
    make_disks(folder / "others", 2, 48);
    const std::string study = (folder / "study").string();
    ASSERT_EQ(morphodesic(quick({"run", (folder / "disks").string(), "--out", study, "--quiet"})).code, 0);
    const Outcome other = morphodesic(quick({"run", (folder / "others").string(), "--out", study}));
    EXPECT_EQ(other.code, 0);
    EXPECT_THAT(other.err, HasSubstr("This study was made from the folder " + (folder / "disks").string() + ", and "));
    ASSERT_EQ(morphodesic(quick({"run", (folder / "others").string(), "--quiet"})).code, 0);
    EXPECT_EQ(read_file(folder / "study/distances.csv"), read_file(folder / "others.study/distances.csv"));
    fs::rename(folder / "others", folder / "moved");
    const Outcome moved = morphodesic(quick({"run", (folder / "moved").string(), "--out", study}));
    EXPECT_THAT(moved.err, testing::Not(HasSubstr("This study was made from")));
}

TEST(Study, SettingsNeverMixAndOldResultsStay) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 3);
    const auto coarse = quick({"run", (folder / "disks").string(), "--json", "--quiet"});
    ASSERT_EQ(json::parse(morphodesic(coarse).out)["pairs_computed"], 3);
    const std::string bytes = read_file(folder / "disks.study/distances.csv");
    auto other = coarse;
    other.insert(other.end(), {"--lambda", "1"});
    EXPECT_EQ(json::parse(morphodesic(other).out)["pairs_computed"], 3);
    EXPECT_NE(read_file(folder / "disks.study/distances.csv"), bytes);
    EXPECT_EQ(json::parse(morphodesic(coarse).out)["pairs_computed"], 0);
    EXPECT_EQ(read_file(folder / "disks.study/distances.csv"), bytes);
}

TEST(Study, APresetChangesTheSolverAndNotHowTheFilesWereRead) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 3);
    const std::string disks = (folder / "disks").string(), study = (folder / "disks.study").string();
    ASSERT_EQ(morphodesic({"run", disks, "--preset", "standard", "--level", "4", "--steps", "2", "--normalize", "each",
                           "--foreground", "dark", "--both-directions", "--align", "none", "--quiet"})
                  .code,
              0);
    const Outcome other = morphodesic({"geodesics", study, "--preset", "fast", "--json", "--quiet"});
    ASSERT_EQ(other.code, 0) << other.err;
    EXPECT_EQ(json::parse(other.out)["geodesics"], 6);  // both directions of three pairs
    ASSERT_EQ(morphodesic({"report", study, "--quiet"}).code, 0);
    std::map<std::string, std::string> settings;
    const json report = json::parse(read_file(fs::path(study) / "report.json"));
    for (const auto& entry : report["settings"]) {
        settings[entry["name"]] =
            entry["value"].is_string() ? entry["value"].get<std::string>() : entry["value"].dump();
    }
    EXPECT_THAT(report["geodesic_options"], testing::Contains("--preset=fast"));
    EXPECT_EQ(settings["normalize"], "each");
    EXPECT_EQ(settings["foreground"], "dark");
    EXPECT_EQ(settings["align"], "none");
    EXPECT_EQ(settings["both-directions"], "true");
    EXPECT_NE(settings["level"], "4");
}

TEST(Study, NotesAreAboutTheGridOfTheLastRun) {
    const TemporaryFolder folder;
    std::string ring = "P5 200 200 255\n";
    for (int i = 0; i < 200 * 200; ++i) {
        const double r = std::hypot(i % 200 - 99.5, i / 200 - 99.5);
        ring += static_cast<char>(82 < r && r < 90 ? 0 : 255);
    }
    write_file(folder / "rings" / "ring.pgm", ring);
    const auto notes_on = [&](const std::string& level) {
        const Outcome done = morphodesic({"ingest", (folder / "rings").string(), "--level", level, "--json"});
        EXPECT_EQ(done.code, 0) << done.err;
        return json::parse(done.out)["notes"].dump();
    };
    const std::string torn = "On the grid of level 4 it has";  // half a cell wide there
    EXPECT_THAT(notes_on("4"), testing::AllOf(HasSubstr(torn), HasSubstr("instead of 1 part and 1 hole")));
    EXPECT_EQ(notes_on("6"), "[]");
    EXPECT_THAT(notes_on("4"), HasSubstr(torn));
}

TEST(Study, TheFourStepsGiveTheSameAsRun) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 3);
    const std::string study = (folder / "steps").string();
    ASSERT_EQ(morphodesic(quick({"run", (folder / "disks").string(), "--quiet"})).code, 0);
    ASSERT_EQ(morphodesic(quick({"ingest", (folder / "disks").string(), "--out", study, "--quiet"})).code, 0);
    EXPECT_EQ(stored_rows(study), 0);
    const Outcome too_early = morphodesic({"verify", study});
    EXPECT_EQ(too_early.code, 2);
    EXPECT_THAT(too_early.err,
                HasSubstr("no trustworthy distance to verify; compute them with: morphodesic geodesics"));
    ASSERT_EQ(morphodesic({"geodesics", study, "--quiet"}).code, 0);  // settings as ingested
    ASSERT_EQ(morphodesic({"analyze", study, "--quiet"}).code, 0);
    EXPECT_EQ(read_file(folder / "steps/distances.csv"), read_file(folder / "disks.study/distances.csv"));
    EXPECT_FALSE(fs::exists(folder / "steps/report.html"));
    ASSERT_EQ(morphodesic({"report", study, "--quiet"}).code, 0);
    EXPECT_TRUE(fs::exists(folder / "steps/report.html"));
    const Outcome verified = morphodesic({"verify", study, "--json"});
    EXPECT_EQ(verified.code, 0);
    EXPECT_EQ(json::parse(verified.out)["checked"], 3);
}

TEST(Study, PairsThatFailedAreTriedAgainWhenThatIsAskedFor) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 3);
    auto command = quick({"run", (folder / "disks").string(), "--json", "--quiet", "--max-iterations", "1"});
    const json first = json::parse(morphodesic(command).out);
    EXPECT_EQ(first["pairs_failed"], 3);
    const Outcome again = morphodesic(command);
    EXPECT_EQ(again.code, 1);
    EXPECT_EQ(json::parse(again.out)["pairs_computed"], 0);
    command.emplace_back("--retry-failed");
    EXPECT_EQ(json::parse(morphodesic(command).out)["pairs_computed"], 3);
}

TEST(Study, FilesOfEqualContentHaveDistanceZero) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 3);
    fs::copy_file(folder / "disks/disk-02.png", folder / "disks/twin.png");
    const Outcome done = morphodesic(quick({"run", (folder / "disks").string(), "--json", "--quiet"}));
    ASSERT_EQ(done.code, 0) << done.err;
    const auto distances = analysis::read_distance_csv(folder / "disks.study/distances.csv");
    ASSERT_EQ(distances.size(), 4u);
    EXPECT_EQ(distances(1, 3), 0.0);
    EXPECT_EQ(distances(0, 1), distances(0, 3));
    const json summary = json::parse(done.out);
    EXPECT_EQ(summary["pairs"], 6);
    EXPECT_EQ(summary["geodesics"], 3);
    EXPECT_EQ(summary["pairs_computed"], 3);
    EXPECT_THAT(summary["remarks"].dump(),
                HasSubstr("2 of the 4 shapes are equal to another one (such as disk-02.png and twin.png)"));
    EXPECT_EQ(json::parse(read_file(folder / "disks.study/report.json"))["pairs_total"], 6);
    const Outcome again = morphodesic(quick({"run", (folder / "disks").string()}));
    EXPECT_THAT(again.out, HasSubstr("4 shapes, 6 pairs; 3 geodesics (3 from the store, 0 computed)"));
    EXPECT_THAT(read_file(folder / "disks.study/report.html"), HasSubstr("4 shapes compared in 6 pairs;"));
}

TEST(Study, CopiesOfOneShapeAreOneCluster) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 1);
    for (const char* copy : {"a", "b", "c"}) {
        fs::copy_file(folder / "disks/disk-01.png", folder / "disks" / (std::string(copy) + ".png"));
    }
    const Outcome done = morphodesic(quick({"run", (folder / "disks").string(), "--json", "--quiet"}));
    ASSERT_EQ(done.code, 0) << done.err;
    EXPECT_EQ(json::parse(done.out)["clusters"], 1);
    const json report = json::parse(read_file(folder / "disks.study/report.json"));
    EXPECT_EQ(report["clusterings"][0]["cut"], "no cut has a silhouette above 0");
}

TEST(Study, BadFilesAreListedAndTheRestGoesOn) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 3);
    write_file(folder / "disks/broken.png", "\x89PNG\r\n\x1a\nnot really");
    write_file(folder / "disks/empty.png", "");
    fs::create_directories(folder / "disks/folder.png");
    const Outcome done = morphodesic(quick({"run", (folder / "disks").string(), "--json"}));
    EXPECT_EQ(done.code, 1);
    const json summary = json::parse(done.out);
    EXPECT_EQ(summary["shapes"], 3);
    EXPECT_EQ(summary["pairs_computed"], 3);
    EXPECT_EQ(summary["failures"].size(), 2u) << summary["failures"];
    EXPECT_THAT(done.err, HasSubstr("broken.png"));
    EXPECT_THAT(done.err, HasSubstr("empty.png"));
    EXPECT_EQ(analysis::read_distance_csv(folder / "disks.study/distances.csv").size(), 3u);
}

TEST(Study, PairsThatFailAreNamedAlsoWhereTheSummaryIsNotForPeople) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 3);
    for (const char* how : {"--quiet", "--json"}) {
        const Outcome done =
            morphodesic(quick({"run", (folder / "disks").string(), how, "--max-iterations", "1", "--paths", "none"}));
        EXPECT_EQ(done.code, 1);
        EXPECT_THAT(done.err, HasSubstr("morphodesic: disk-01.png - disk-03.png: not converged")) << how;
    }
    // None of the files failed: two shapes have no distance left that would join them to the first.
    const std::string page = read_file(folder / "disks.study/report.html");
    EXPECT_THAT(page, HasSubstr("(of 3); failed: 3 pairs; cut off from the others: 2 shapes."));
    const Outcome report = morphodesic({"report", (folder / "disks.study").string()});
    EXPECT_THAT(report.out, HasSubstr("Without a trustworthy distance: 3 pairs; cut off from the others: 2 shapes\n"));
}

TEST(Study, NamesMayHoldAnything) {
    const TemporaryFolder folder;
    make_disks(folder / "plain", 3);
    const std::vector<std::string> names{"a b,\"c\".png", "<b>%s.png", "-x\n\xc3\xa9.png"};
    for (std::size_t i = 0; i < names.size(); ++i) {
        fs::create_directories(folder / "odd");
        fs::copy_file(folder / ("plain/disk-0" + std::to_string(i + 1) + ".png"), folder / "odd" / names[i]);
    }
    const Outcome done = morphodesic(quick({"run", (folder / "odd").string(), "--quiet", "--paths", "all"}));
    ASSERT_EQ(done.code, 0) << done.err;
    const auto distances = analysis::read_distance_csv(folder / "odd.study/distances.csv");
    EXPECT_THAT(distances.labels(), testing::UnorderedElementsAreArray(names));
    EXPECT_EQ(distances.missing_count(), 0u);
}

TEST(Datasets, EveryKindIsMadeAndTheSameForTheSameSeed) {
    const TemporaryFolder folder;
    for (const std::string kind : {"letters", "bars", "dumbbells", "disks", "matchstick", "feet", "quadrupeds"}) {
        const bool solid = kind == "feet" || kind == "quadrupeds";
        for (const char* again : {"1", "2"}) {
            std::vector<std::string> words{"datasets", kind, "--out", (folder / (kind + again)).string(),
                                           "--count",  "4",  "--json"};
            if (!solid) words.insert(words.end(), {"--size", "48"});
            const Outcome done = morphodesic(words);
            ASSERT_EQ(done.code, 0) << done.err;
            EXPECT_EQ(json::parse(done.out)["shapes"], 4) << kind;
        }
        for (const auto& entry : fs::directory_iterator(folder / (kind + "1"))) {
            EXPECT_EQ(read_file(entry.path()), read_file(folder / (kind + "2") / entry.path().filename().string()));
        }
    }
}

}  // namespace
}  // namespace morphodesic::tests

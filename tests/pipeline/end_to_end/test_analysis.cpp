// analyze and report as people use them: on studies, and on tables of distances from anywhere.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "program.h"

namespace morphodesic::tests {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

/// Two groups of three points on a line, as R writes it: all names in quotes, NA where nothing is known.
constexpr const char* table =
    "\"\",\"a1\",\"a2\",\"a3\",\"b1\",\"b2\",\"b3\"\n"
    "\"a1\",0,1,2,10,11,12\n"
    "\"a2\",1,0,1,9,10,11\n"
    "\"a3\",2,1,0,8,9,NA\n"
    "\"b1\",10,9,8,0,1,2\n"
    "\"b2\",11,10,9,1,0,1\n"
    "\"b3\",12,11,NA,2,1,0\n";
constexpr const char* classes = "file,label\na1,a\na2,a\na3,a\nb1,b\nb2,b\nb3,b\n";

/// Value of a row "ranking,measure,value" of accuracy.csv; NaN if there is none.
double accuracy(const fs::path& file, const std::string& row) {
    std::istringstream lines(read_file(file));
    for (std::string line; std::getline(lines, line);) {
        if (line.rfind(row + ",", 0) == 0) return std::stod(line.substr(row.size() + 1));
    }
    return std::nan("");
}

TEST(AnalyzeTable, AnyDistanceTableBecomesTablesOfResults) {
    const TemporaryFolder folder;
    write_file(folder / "d.csv", table);
    write_file(folder / "labels.csv", classes);
    const Outcome done =
        morphodesic({"analyze", (folder / "d.csv").string(), "--labels", (folder / "labels.csv").string()});
    ASSERT_EQ(done.code, 0) << done.err;
    EXPECT_THAT(done.out, HasSubstr("1 pair has no distance"));
    const fs::path out = folder / "d.analysis";
    EXPECT_THAT(read_file(out / "clusters.csv"), HasSubstr("a1,a,1,"));
    EXPECT_THAT(read_file(out / "clusters.csv"), HasSubstr("b1,b,2,"));
    EXPECT_EQ(accuracy(out / "accuracy.csv", "distances,1-NN"), 1.0);
    EXPECT_EQ(accuracy(out / "accuracy.csv", "distances,bulls_eye"), 1.0);
    EXPECT_EQ(accuracy(out / "accuracy.csv", "distances,adjusted_rand"), 1.0);
    const json all = json::parse(read_file(out / "analysis.json"));
    EXPECT_EQ(all["given_matrix"], true);
    EXPECT_EQ(all["pairs_done"], 14);
    EXPECT_FALSE(fs::exists(out / "pairs.csv"));  // nothing is known of the geodesics
    for (const char* name : {"linkage.csv", "embedding.csv", "distances.csv", "distances.npy"}) {
        EXPECT_TRUE(fs::exists(out / name)) << name;
    }
}

TEST(AnalyzeTable, ErrorBarsDecideWhatIsSaidOfClusters) {
    const TemporaryFolder folder;
    write_file(folder / "d.csv", table);
    std::string errors = table;
    for (std::size_t at = 0; (at = errors.find("NA", at)) != std::string::npos;) errors.replace(at, 2, "12");
    write_file(folder / "errors.csv", errors);  // as large as the distances: nothing is certain
    const Outcome done = morphodesic({"analyze", (folder / "d.csv").string(), "--clusters", "3", "--errors",
                                      (folder / "errors.csv").string(), "--out", (folder / "out").string()});
    ASSERT_EQ(done.code, 0) << done.err;
    const json trust = json::parse(read_file(folder / "out" / "analysis.json"))["trust"];
    EXPECT_FALSE(trust["close_clusters"].empty());
    EXPECT_GT(trust["perturbations"], 0);
    EXPECT_LT(trust["stability_rand"], 0.99);
}

TEST(AnalyzeTable, TwoDirectionsMustBeAskedFor) {
    const TemporaryFolder folder;
    write_file(folder / "d.csv", ",a,b,c\na,0,1,2\nb,3,0,1\nc,2,1,0\n");
    const Outcome refused = morphodesic({"analyze", (folder / "d.csv").string()});
    EXPECT_EQ(refused.code, 2);
    EXPECT_THAT(refused.err, HasSubstr("d.csv"));
    EXPECT_THAT(refused.err, HasSubstr("not symmetric"));
    EXPECT_THAT(refused.err, HasSubstr("--asymmetric"));
    ASSERT_EQ(morphodesic({"analyze", (folder / "d.csv").string(), "--asymmetric"}).code, 0);
    const json asymmetries = json::parse(read_file(folder / "d.analysis" / "analysis.json"))["trust"]["asymmetries"];
    ASSERT_EQ(asymmetries.size(), 1u);
    EXPECT_EQ(asymmetries[0]["forward"], 1.0);
    EXPECT_EQ(asymmetries[0]["backward"], 3.0);
}

TEST(AnalyzeTable, QueriesArePlacedWhereTheyBelong) {
    const TemporaryFolder folder;
    write_file(folder / "d.csv", table);
    write_file(folder / "q.csv", ",b1,b2,b3,a1,a2,a3\nlike b2,1,0,1,11,10,9\n");  // columns in another order
    write_file(folder / "ranking.csv", "file,rank,template,class,distance\nq,1,a1,,1\nq,2,a3,,1\nq,3,b1,,9\n");
    for (const char* queries : {"q.csv", "ranking.csv"}) {
        const Outcome done =
            morphodesic({"analyze", (folder / "d.csv").string(), "--place", (folder / queries).string()});
        ASSERT_EQ(done.code, 0) << done.err;
        const std::string placed = read_file(folder / "d.analysis" / "placed.csv");
        std::istringstream lines(placed), places(read_file(folder / "d.analysis" / "embedding.csv"));
        std::string line, place;
        std::getline(lines, line);
        std::getline(lines, line);  // the first map: SMACOF in the plane
        const bool ranking = std::string(queries) == "ranking.csv";
        EXPECT_THAT(line, HasSubstr(ranking ? ",a1,1," : ",b2,0,")) << placed;
        const std::string item = ranking ? "a2,SMACOF,2," : "b2,SMACOF,2,";
        while (std::getline(places, place) && place.rfind(item, 0) != 0) continue;
        const double x = std::stod(line.substr(line.find("SMACOF,2,") + 9)), at = std::stod(place.substr(item.size()));
        EXPECT_NEAR(x, at, 0.05) << line << "\n" << place;
    }
    write_file(folder / "bad.csv", ",nobody\nq,1\n");
    const Outcome bad = morphodesic({"analyze", (folder / "d.csv").string(), "--place", (folder / "bad.csv").string()});
    EXPECT_EQ(bad.code, 2);
    EXPECT_THAT(bad.err, HasSubstr("no distance to any of the 6 shapes"));
}

TEST(ReportOfTable, IsAPageWithoutGeodesics) {
    const TemporaryFolder folder;
    write_file(folder / "d.csv", table);
    const Outcome done = morphodesic({"report", (folder / "d.csv").string(), "--out", (folder / "out").string()});
    ASSERT_EQ(done.code, 0) << done.err;
    const std::string page = read_file(folder / "out" / "report.html");
    EXPECT_THAT(page, HasSubstr("6 shapes with 14 given distances (of 15 pairs)."));
    EXPECT_THAT(page, Not(HasSubstr("study.sqlite\"")));
    for (const char* ending : {".svg", ".pdf", ".png"}) {
        EXPECT_TRUE(fs::exists(folder / "out" / "figures" / (std::string("heat_map") + ending))) << ending;
    }
}

TEST(ReportOfStudy, FiguresComeInThreeFormatsAndFollowTheReport) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 4);
    const std::string study = (folder / "disks.study").string();
    ASSERT_EQ(morphodesic(quick({"run", (folder / "disks").string(), "--paths", "1"})).code, 0);
    const fs::path figures = fs::path(study) / "figures";
    std::string path;
    for (const auto& entry : fs::directory_iterator(figures)) {
        const std::string name = entry.path().stem().string();
        for (const char* ending : {".svg", ".pdf", ".png"}) {
            EXPECT_GT(fs::file_size(figures / (name + ending)), 200u) << name << ending;
        }
        if (name.rfind("path_", 0) == 0) path = name;
    }
    ASSERT_FALSE(path.empty());
    EXPECT_TRUE(fs::exists(figures / "page.pdf"));
    write_file(figures / "mine.png", "kept");
    const auto before = fs::last_write_time(figures / "page.pdf");
    ASSERT_EQ(morphodesic({"report", study, "--paths", "none"}).code, 0);
    EXPECT_FALSE(fs::exists(figures / (path + ".svg")));  // no longer part of the report
    EXPECT_FALSE(fs::exists(figures / (path + ".pdf")));
    EXPECT_EQ(read_file(figures / "mine.png"), "kept");
    EXPECT_EQ(fs::last_write_time(figures / "page.pdf"), before);
}

TEST(ReportOfStudy, TwoStudiesSideBySide) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 5);
    const std::string collection = (folder / "disks").string(), here = (folder / "disks.study").string();
    ASSERT_EQ(morphodesic(quick({"run", collection, "--paths", "none"})).code, 0);
    ASSERT_EQ(morphodesic(quick({"run", collection, "--paths", "none", "--outside-stiffness", "0.02", "--out",
                                 (folder / "soft.study").string()}))
                  .code,
              0);
    const Outcome done =
        morphodesic({"report", here, "--paths", "none", "--compare", (folder / "soft.study").string()});
    ASSERT_EQ(done.code, 0) << done.err;
    const json compare = json::parse(read_file(fs::path(here) / "report.json"))["compare"];
    EXPECT_EQ(compare["other"], "soft.study");
    EXPECT_EQ(compare["common_pairs"], 10);
    EXPECT_GT(compare["spearman"], 0.9);
    ASSERT_EQ(compare["different_settings"].size(), 1u);
    EXPECT_EQ(compare["different_settings"][0]["name"], "outside-stiffness");
    EXPECT_TRUE(fs::exists(fs::path(here) / "figures" / "compare.svg"));
    // The same numbers as a table: everything agrees.
    const Outcome same = morphodesic({"analyze", here, "--compare", (fs::path(here) / "distances.csv").string()});
    ASSERT_EQ(same.code, 0) << same.err;
    EXPECT_THAT(same.out, HasSubstr("Spearman correlation 1.0000, 100.0 % of the neighbours agree"));
}

TEST(ReportOfStudy, RunTakesTheOptionsOfTheAnalysis) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 5);
    ASSERT_EQ(morphodesic(quick({"run", (folder / "disks").string(), "--paths", "none", "--linkage", "ward",
                                 "--clusters", "2", "--diffuse"}))
                  .code,
              0);
    const json report = json::parse(read_file(folder / "disks.study" / "report.json"));
    EXPECT_EQ(report["linkages"][0]["method"], "ward");
    EXPECT_EQ(report["clusterings"][0]["cut"], "2 clusters");
}

}  // namespace
}  // namespace morphodesic::tests

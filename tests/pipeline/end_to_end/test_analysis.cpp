// analyze and report as people use them: on studies, and on tables of distances from anywhere.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "pipeline/given_matrix.h"
#include "program.h"

namespace morphodesic::tests {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

/// Two groups of three points on a line, as R writes it: all names in quotes, NA where nothing is known.
constexpr const char* two_groups =
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
    write_file(folder / "d.csv", two_groups);
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

TEST(AnalyzeTable, TheShareOfRightNeighboursSaysOfWhichShapesItIs) {
    const TemporaryFolder folder;
    write_file(folder / "d.csv", two_groups);
    const auto sentence = [&](const std::string& labels) {
        write_file(folder / "labels.csv", "file,label\n" + labels);
        const Outcome done =
            morphodesic({"analyze", (folder / "d.csv").string(), "--labels", (folder / "labels.csv").string()});
        const auto begin = done.out.find("100.0 % of");
        return begin == std::string::npos ? done.out : done.out.substr(begin, done.out.find('\n', begin) - begin);
    };
    const std::string end = " have a nearest neighbour of their own class";
    EXPECT_EQ(sentence("a1,a\na2,a\na3,a\nb1,b\nb2,b\nb3,b\n"), "100.0 % of the shapes" + end);
    EXPECT_EQ(sentence("a1,a\na2,a\na3,c\nb1,b\nb2,d\nb3,e\n"),
              "100.0 % of the 2 shapes that are not alone in their class" + end + " (4 are alone)");
    EXPECT_EQ(sentence("a1,a\na2,a\nb1,b\nb2,b\nb3,c\n"),
              "100.0 % of the 4 shapes that are not alone in their class" + end + " (1 is alone, 1 has no class)");
    EXPECT_EQ(sentence("a1,a\na2,a\nb2,b\nb3,b\n"),
              "100.0 % of the 4 shapes with a class" + end + " (2 have no class)");
    EXPECT_EQ(accuracy(folder / "d.analysis/accuracy.csv", "distances,1-NN"), 1.0);
}

TEST(AnalyzeTable, ShapesWithoutDistancesAreSaid) {
    const TemporaryFolder folder;
    write_file(folder / "na.csv", ",a,b,c\na,0,NA,2\nb,NA,0,NaN\nc,2,NaN,0\n");
    for (const char* command : {"analyze", "report"}) {
        const Outcome done = morphodesic({command, (folder / "na.csv").string(), "--json"});
        EXPECT_EQ(done.code, 1) << command;
        const json summary = json::parse(done.out);
        EXPECT_EQ(summary["shapes_left_out"], 1);
        ASSERT_EQ(summary["failures"].size(), 1u);
        EXPECT_EQ(summary["failures"][0]["a"], "b");
        EXPECT_THAT(done.err, HasSubstr("b: no chain of trustworthy distances joins it to the others")) << command;
    }
    EXPECT_THAT(read_file(folder / "na.analysis/report.html"), HasSubstr("cut off from the others: 1 shape."));
}

TEST(AnalyzeTable, ErrorBarsDecideWhatIsSaidOfClusters) {
    const TemporaryFolder folder;
    write_file(folder / "d.csv", two_groups);
    std::string errors = two_groups;
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
    write_file(folder / "d.csv", two_groups);
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
    // Non-metric maps have places for disparities: a query that is a copy of a shape comes to lie on it there, too.
    std::ostringstream bent, copies;
    const auto point = [](int i) { return std::pair(std::cos(1.7 * i) + 0.1 * i, std::sin(2.3 * i) - 0.05 * i); };
    constexpr int points = 12;
    for (int i = 0; i < points; ++i) bent << ",s" << i;
    copies << bent.str() << "\n";
    bent << "\n";
    for (int i = 0; i < points; ++i) {
        bent << "s" << i;
        if (i % 4 == 0) copies << "copy of s" << i;
        for (int j = 0; j < points; ++j) {
            const double d = std::hypot(point(i).first - point(j).first, point(i).second - point(j).second);
            bent << "," << d * d * d;
            if (i % 4 == 0) copies << "," << d * d * d;
        }
        bent << "\n";
        if (i % 4 == 0) copies << "\n";
    }
    write_file(folder / "bent.csv", bent.str());
    write_file(folder / "copies.csv", copies.str());
    ASSERT_EQ(
        morphodesic({"analyze", (folder / "bent.csv").string(), "--place", (folder / "copies.csv").string(), "--quiet"})
            .code,
        0);
    const auto places_in = [&](const char* file) {
        std::map<std::string, std::pair<double, double>> places;
        std::istringstream in(read_file(folder / "bent.analysis" / file));
        for (std::string row; std::getline(in, row);) {
            const std::string method = ",non-metric SMACOF,2,";
            const std::size_t at = row.find(method);
            if (at == std::string::npos) continue;
            std::istringstream numbers(row.substr(at + method.size()));
            char comma = 0;
            auto& place = places[row.substr(0, at)];
            numbers >> place.first >> comma >> place.second;
        }
        return places;
    };
    const auto shapes = places_in("embedding.csv"), placed = places_in("placed.csv");
    ASSERT_EQ(placed.size(), 3u);
    for (const auto& [name, place] : placed) {
        const auto& original = shapes.at(name.substr(8));
        EXPECT_NEAR(place.first, original.first, 0.05) << name;
        EXPECT_NEAR(place.second, original.second, 0.05) << name;
    }
    write_file(folder / "bad.csv", ",nobody\nq,1\n");
    const Outcome bad = morphodesic({"analyze", (folder / "d.csv").string(), "--place", (folder / "bad.csv").string()});
    EXPECT_EQ(bad.code, 2);
    EXPECT_THAT(bad.err, HasSubstr("no distance to any of the 6 shapes"));
    // What the study does not have is said.
    write_file(folder / "more.csv", ",b1,nobody,nothing\nq,1,2,3\n");
    write_file(folder / "classes.csv", std::string(classes) + "b7,b\n");
    const Outcome more = morphodesic({"analyze", (folder / "d.csv").string(), "--place", (folder / "more.csv").string(),
                                      "--labels", (folder / "classes.csv").string()});
    EXPECT_EQ(more.code, 0);
    EXPECT_THAT(more.out, HasSubstr("more.csv has distances to nobody and 1 more, which are not among the shapes"));
    EXPECT_THAT(more.out, HasSubstr("classes.csv has a class for b7, which is not among the shapes"));
    // Two queries of one name must not become one.
    write_file(folder / "twice.csv", ",a1,b1\nq,1,9\nq,9,1\n");
    write_file(folder / "ranking.csv", "file,rank,template,class,distance\nq,1,a1,,1\nq,2,b1,,9\nq,1,b1,,1\n");
    for (const char* queries : {"twice.csv", "ranking.csv"}) {
        const Outcome twice =
            morphodesic({"analyze", (folder / "d.csv").string(), "--place", (folder / queries).string()});
        EXPECT_EQ(twice.code, 2) << queries;
        EXPECT_THAT(twice.err, HasSubstr("a second distance of 'q' to '")) << queries;
    }
}

/// Two thousand shapes have two million pairs: nothing of the size of a geodesic is kept for each.
TEST(AnalyzeTable, TablesKeepNoGeodesics) {
    const TemporaryFolder folder;
    write_file(folder / "d.csv", two_groups);
    const pipeline::StudyData data = pipeline::read_given_matrix(folder / "d.csv", {});
    EXPECT_EQ(data.distances.pair_count(), 15u);
    EXPECT_EQ(data.pairs.capacity() + data.backward.capacity(), 0u);
    EXPECT_EQ(data.geodesic(3), nullptr);
}

TEST(ReportOfTable, PlacedQueriesComeAndGo) {
    const TemporaryFolder folder;
    write_file(folder / "d.csv", two_groups);
    write_file(folder / "q.csv", ",a1,a2,a3,b1,b2,b3\n<i>like a2</i>,1,0,1,9,10,11\nunknown,,,,,,\n");
    const std::string distances = (folder / "d.csv").string();
    const fs::path out = folder / "d.analysis";
    ASSERT_EQ(morphodesic({"report", distances, "--place", (folder / "q.csv").string()}).code, 0);
    const json report = json::parse(read_file(out / "report.json"));
    ASSERT_EQ(report["placed"].size(), 2u);
    EXPECT_EQ(report["placed"][0]["nearest"], 1);
    ASSERT_EQ(report["placed"][0]["positions"].size(), report["embeddings"].size());
    for (std::size_t m = 0; m < report["embeddings"].size(); ++m) {  // exactly where a2 is, and at no misfit
        const json& map = report["embeddings"][m];
        const std::size_t dimension = map["dimension"];
        ASSERT_EQ(report["placed"][0]["positions"][m].size(), dimension) << map["method"];
        for (std::size_t axis = 0; axis < dimension; ++axis) {
            EXPECT_NEAR(report["placed"][0]["positions"][m][axis], map["coordinates"][dimension + axis], 0.05)
                << map["method"] << " " << dimension;
        }
    }
    EXPECT_TRUE(report["placed"][1]["nearest"].is_null());
    EXPECT_THAT(read_file(out / "report.html"), HasSubstr("\\u003ci\\u003elike a2"));
    EXPECT_THAT(read_file(out / "figures" / "embedding_2d.svg"), HasSubstr("&lt;i&gt;like a2"));
    EXPECT_TRUE(fs::exists(out / "placed.csv"));
    ASSERT_EQ(morphodesic({"report", distances}).code, 0);
    EXPECT_FALSE(fs::exists(out / "placed.csv"));
    EXPECT_EQ(json::parse(read_file(out / "report.json"))["placed"].size(), 0u);
}

/// A study whose files are named as unkindly as a file system allows, and the tables of its results.
class ForeignReaders : public testing::Test {
protected:
    void study_of_odd_names() {
        make_disks(folder_ / "disks", 5);
        const std::vector<std::string> names = {"a, b.png", "he said \"no\".png", "it's \\ #1.png", "<img src=x>.png",
                                                "gr\u00fc\u00df.png"};
        std::size_t k = 0;
        std::vector<fs::path> files;
        for (const auto& entry : fs::recursive_directory_iterator(folder_ / "disks")) {
            if (entry.is_regular_file()) files.push_back(entry.path());
        }
        std::sort(files.begin(), files.end());
        for (const fs::path& file : files) {
            if (k < names.size()) fs::rename(file, file.parent_path() / names[k++]);
        }
        ASSERT_EQ(k, names.size());
        ASSERT_EQ(morphodesic(quick({"run", (folder_ / "disks").string(), "--paths", "none"})).code, 0);
        const std::string study = (folder_ / "disks.study").string();
        write_file(folder_ / "q.csv", read_file(folder_ / "disks.study" / "distances.csv"));
        ASSERT_EQ(morphodesic({"report", study, "--paths", "none", "--place", (folder_ / "q.csv").string()}).code, 0);
    }
    /// Runs a script in the folder of the study.
    void run(const std::string& program, const std::string& name, const std::string& script) {
        write_file(folder_ / name, script);
        const Outcome done =
            shell("cd '" + (folder_ / "disks.study").string() + "' && " + program + " ../" + name + " 2>&1");
        EXPECT_EQ(done.code, 0) << done.out << done.err;
        EXPECT_THAT(done.out, HasSubstr("9 tables"));
    }
    TemporaryFolder folder_;
};

TEST_F(ForeignReaders, PandasReadsEveryTableWithoutOptions) {
    if (shell("/usr/bin/python3 -c 'import pandas'").code != 0) GTEST_SKIP() << "python3-pandas is not installed";
    ASSERT_NO_FATAL_FAILURE(study_of_odd_names());
    run("/usr/bin/python3", "read.py", R"(
import glob, json, numpy, pandas
tables = {f: pandas.read_csv(f) for f in sorted(glob.glob('*.csv'))}
report = json.load(open('report.json'))
names = [s['name'] for s in report['shapes']]
n = len(names)
assert '"' in ''.join(names) and ',' in ''.join(names)
d = tables['distances.csv']
assert list(d.columns[1:]) == names and list(d.iloc[:, 0]) == names
npy = numpy.load('distances.npy')
assert numpy.allclose(d.iloc[:, 1:].to_numpy(float), npy, rtol=1e-15, atol=0)  # its parser may miss the last bit
exact = pandas.read_csv('distances.csv', index_col=0, float_precision='round_trip')
assert (exact.to_numpy(float) == npy).all()
assert npy.shape == (n, n)
assert list(tables['shapes.csv']['name']) == names
pairs = tables['pairs.csv']
assert len(pairs) == n * (n - 1) // 2 and set(pairs['a']) | set(pairs['b']) == set(names)
assert numpy.allclose(pairs['distance'], report['distances'], rtol=1e-15)
for column in ['distance', 'error', 'path_length', 'min_det', 'seconds', 'level', 'refined']:
    assert pairs[column].dtype.kind in 'fi', column
assert sorted(tables['clusters.csv']['name']) == sorted(names)
assert tables['linkage.csv'][['first', 'second', 'height', 'size']].to_numpy(float).shape == (n - 1, 4)
assert len(tables['embedding.csv']) == n * len(report['embeddings'])
assert len(tables['placed.csv']) == n * len(report['embeddings'])
assert list(tables['accuracy.csv'].columns) == ['ranking', 'measure', 'value']
print(len(tables) + 1, 'tables')  # with distances.npy
)");
}

TEST_F(ForeignReaders, RReadsEveryTableWithoutOptions) {
    if (shell("Rscript --version").code != 0) GTEST_SKIP() << "r-base-core is not installed";
    ASSERT_NO_FATAL_FAILURE(study_of_odd_names());
    run("LC_ALL=C.UTF-8 Rscript --vanilla", "read.R", R"(
tables <- lapply(sort(Sys.glob("*.csv")), read.csv)
names(tables) <- sort(Sys.glob("*.csv"))
shapes <- tables[["shapes.csv"]]
d <- tables[["distances.csv"]]
n <- nrow(shapes)
m <- as.matrix(d[-1])
stopifnot(identical(d[[1]], shapes$name), is.numeric(m), all(dim(m) == n), all(m == t(m)), all(diag(m) == 0))
named <- read.csv("distances.csv", row.names = 1, check.names = FALSE)
stopifnot(identical(rownames(named), shapes$name), identical(colnames(named), shapes$name))
pairs <- tables[["pairs.csv"]]
stopifnot(nrow(pairs) == n * (n - 1) / 2, all(pairs$a %in% shapes$name), is.numeric(pairs$distance),
          is.numeric(pairs$error), is.numeric(pairs$min_det))
stopifnot(all(abs(mapply(function(a, b) named[a, b], pairs$a, pairs$b) - pairs$distance) == 0))
stopifnot(setequal(tables[["clusters.csv"]]$name, shapes$name), nrow(tables[["linkage.csv"]]) == n - 1)
stopifnot(nrow(tables[["embedding.csv"]]) == nrow(tables[["placed.csv"]]))
cat(length(tables) + 1, "tables\n")
)");
}

TEST(ReportOfTable, IsAPageWithoutGeodesics) {
    const TemporaryFolder folder;
    write_file(folder / "d.csv", two_groups);
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
    write_file(folder / "constant.csv", ",x,y,z\nx,0,1,1\ny,1,0,1\nz,1,1,0\n");
    const std::string constant = (folder / "constant.csv").string();
    EXPECT_THAT(morphodesic({"analyze", constant, "--compare", constant}).out,
                HasSubstr("Spearman correlation unknown"));
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

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "end_to_end/program.h"
#include "pipeline/database.h"
#include "pipeline/digest.h"
#include "pipeline/path_files.h"
#include "pipeline/result_store.h"

namespace morphodesic::pipeline {
namespace {

StoredGeodesic example(const std::string& a, const std::string& b) {
    StoredGeodesic g;
    g.a = a;
    g.b = b;
    g.settings_hash = "settings";
    g.path_length = 1.0 / 3.0;
    g.path_energy = 0.1;
    g.total_energy = std::nextafter(0.2, 1.0);
    g.error = std::numeric_limits<double>::quiet_NaN();
    g.extrapolated_length = 0.4;
    g.min_det = 0.5;
    g.seconds = 1.5;
    g.deformation_energy = {0.1, 1.0 / 7.0};
    g.mismatch_energy = {1e-300, 2.0};
    g.rotation = {1, 0, 0, 1};
    g.translation = {0.25, -0.125};
    LevelReport level;
    level.level = 5;
    level.iterations = 17;
    level.total_energy = std::numeric_limits<double>::infinity();
    level.termination = Termination::no_descent;
    g.levels = {level};
    return g;
}

class Store : public testing::Test {
protected:
    tests::TemporaryFolder folder_;
    std::filesystem::path file_ = folder_ / "study.sqlite";
};

TEST_F(Store, AGeodesicComesBackBitByBit) {
    const StoredGeodesic g = example("a", "b");
    ResultStore(file_, ResultStore::Access::write).put_geodesic(g);
    const ResultStore store(file_, ResultStore::Access::read);
    const auto back = store.geodesic("a", "b", "settings");
    ASSERT_TRUE(back);
    EXPECT_EQ(back->path_length, g.path_length);
    EXPECT_EQ(back->total_energy, g.total_energy);
    EXPECT_TRUE(std::isnan(back->error));
    EXPECT_EQ(back->deformation_energy, g.deformation_energy);
    EXPECT_EQ(back->mismatch_energy, g.mismatch_energy);
    EXPECT_EQ(back->translation, g.translation);
    ASSERT_EQ(back->levels.size(), 1u);
    EXPECT_EQ(back->levels[0].iterations, 17);
    EXPECT_EQ(back->levels[0].total_energy, std::numeric_limits<double>::infinity());
    EXPECT_EQ(back->levels[0].termination, Termination::no_descent);
    EXPECT_FALSE(store.geodesic("b", "a", "settings"));
    EXPECT_FALSE(store.geodesic("a", "b", "other"));
}

TEST_F(Store, OnlyFailuresAreForgottenOnRequest) {
    ResultStore store(file_, ResultStore::Access::write);
    store.put_geodesic(example("a", "b"));
    StoredGeodesic failed = example("a", "c");
    failed.failure = "the solver threw";
    store.put_geodesic(failed);
    StoredGeodesic unfinished = example("b", "c");
    unfinished.termination = Termination::max_steps;
    store.put_geodesic(unfinished);
    EXPECT_EQ(store.stored_pairs("settings").size(), 3u);
    EXPECT_EQ(store.remove_failures("settings"), 2);
    EXPECT_THAT(store.stored_pairs("settings"), testing::ElementsAre(std::pair<std::string, std::string>("a", "b")));
}

TEST_F(Store, LevelSetsAreKeptAsFloatsAndSweptWhenUnused) {
    ResultStore store(file_, ResultStore::Access::write);
    LevelSet<2> u{DyadicGrid<2>(3)};
    for (std::size_t i = 0; i < u.values.size(); ++i)
        u.values[i] = static_cast<float>(0.01 * static_cast<double>(i) - 0.3);
    ScalarField<2> mask{DyadicGrid<2>(3), 1.0};
    mask.values[5] = 0.25;
    store.put_level_set<2>("used", u, mask);
    store.put_level_set<2>("unused", u, {});
    StoredShape shape;
    shape.name = "x.png";
    shape.content_digest = "used";
    shape.notes = {"a note", "another"};
    store.put_shape(shape);
    store.remove_unused_level_sets();
    EXPECT_EQ(store.level_of("unused"), 0);
    ScalarField<2> back;
    EXPECT_EQ(store.level_set<2>("used", &back).values, u.values);
    EXPECT_EQ(back.values, mask.values);
    EXPECT_THROW((void)store.level_set<2>("unused"), StoreError);
    EXPECT_THROW((void)store.level_set<3>("used"), StoreError);
    ASSERT_EQ(store.shapes().size(), 1u);
    EXPECT_EQ(store.shapes()[0].notes, shape.notes);
}

TEST_F(Store, ADamagedShapeHasAProblemAndNothingElse) {
    StoredShape shape;
    shape.name = "x.png";
    shape.label = "letter";
    shape.reading = "reading";
    shape.placing = "placing";
    shape.content_digest = "content";
    shape.fullness = 0.25;
    ResultStore store(file_, ResultStore::Access::write);
    store.put_shape(shape);
    EXPECT_FALSE(store.shapes().front().damaged);
    EXPECT_EQ(store.shapes().front().placing, "placing");
    for (const char* change : {"label = 'other'", "name = 'y.png'", "volume = 2", "content_digest = 'other'",
                               "fullness = 2", "fullness = NULL"}) {
        store.put_shape(shape);
        Database(file_, true).execute(std::string("UPDATE shapes SET ") + change);
        const StoredShape row = store.shapes().front();
        EXPECT_TRUE(row.damaged) << change;
        EXPECT_EQ(row.reading + row.placing + row.content_digest, "") << change;
        EXPECT_THAT(row.problem, testing::HasSubstr(row.name + " is damaged")) << change;
        store.remove_shapes({row.name});
    }
}

TEST_F(Store, AShapeSealedWithoutItsClassAsInTheFirstStudiesIsSound) {
    StoredShape shape;
    shape.name = "x.png";
    shape.label = "letter";
    shape.placing = "placing";
    ResultStore store(file_, ResultStore::Access::write);
    store.put_shape(shape);
    const double numbers[] = {shape.extent_radius, shape.volume, shape.scale};
    const std::string seal = digest(std::string("x.png\n\n\nplacing\n\n[]\n\n") +
                                    std::string(reinterpret_cast<const char*>(numbers), sizeof numbers));
    Database(file_, true).execute("UPDATE shapes SET placing = 'placing " + seal + "'");
    EXPECT_FALSE(store.shapes().front().damaged);
    EXPECT_EQ(store.shapes().front().placing, "placing");
}

TEST_F(Store, FullnessIsAddedToStudiesThatDidNotMeasureIt) {
    StoredShape shape;
    shape.name = "old.png";
    ResultStore(file_, ResultStore::Access::write).put_shape(shape);
    Database(file_, true).execute("ALTER TABLE shapes DROP COLUMN fullness");
    for (const auto access : {ResultStore::Access::read, ResultStore::Access::write}) {
        const StoredShape old = ResultStore(file_, access).shapes().front();
        EXPECT_FALSE(old.damaged);
        EXPECT_EQ(old.fullness, 0.0);
    }
    shape.name = "younger.png";
    shape.fullness = 0.25;
    ResultStore store(file_, ResultStore::Access::write);
    store.put_shape(shape);
    EXPECT_EQ(store.shapes().back().fullness, 0.25);
}

TEST_F(Store, FactsAndSettingsAreKept) {
    ResultStore store(file_, ResultStore::Access::write);
    EXPECT_FALSE(store.fact("folder"));
    store.set_fact("folder", "one");
    store.set_fact("folder", "two");
    EXPECT_EQ(store.fact("folder"), "two");
    store.put_settings("hash", "level = 6\n");
    EXPECT_EQ(store.settings("hash"), "level = 6\n");
    EXPECT_FALSE(store.settings("other"));
}

TEST_F(Store, ACopyThatLostItsJournalModeHasItAgainWhenItIsWrittenTo) {
    const auto mode = [&] {
        const Database database(file_, false);
        Statement find = database.prepare("PRAGMA journal_mode");
        find.step();
        return find.text(0);
    };
    ResultStore(file_, ResultStore::Access::write).put_geodesic(example("a", "b"));
    EXPECT_EQ(mode(), "wal");
    ResultStore(file_, ResultStore::Access::write).finish_as_one_file();
    EXPECT_EQ(mode(), "delete");
    EXPECT_TRUE(ResultStore(file_, ResultStore::Access::write).geodesic("a", "b", "settings"));
    EXPECT_EQ(mode(), "wal");
}

TEST_F(Store, ReadingWhereThereIsNoStudySaysHowToMakeOne) {
    try {
        const ResultStore store(file_, ResultStore::Access::read);
        FAIL();
    } catch (const std::invalid_argument& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("morphodesic run"));
    }
    EXPECT_FALSE(std::filesystem::exists(file_));
}

TEST(StoredGeodesicAsJson, APairWithoutResultHasNoNumbers) {
    EXPECT_EQ(to_json(example("a", "b"))["path_length"], 1.0 / 3.0);
    EXPECT_EQ(to_json(example("a", "b"))["termination"], "converged");
    StoredGeodesic failed;
    failed.failure = "the energy is not finite";
    const nlohmann::ordered_json j = to_json(failed);
    for (const char* key : {"path_length", "error", "extrapolated_length", "path_energy", "total_energy", "min_det"}) {
        EXPECT_TRUE(j.at(key).is_null()) << key;
    }
    EXPECT_EQ(j.at("termination"), "failed");
    EXPECT_EQ(j.at("problem"), failed.failure);
}

TEST(StoredGeodesicProblem, EveryReasonNotToTrustADistanceIsNamed) {
    EXPECT_EQ(example("a", "b").problem(), "");
    StoredGeodesic g = example("a", "b");
    g.min_det = 0.0;
    EXPECT_THAT(g.problem(), testing::HasSubstr("one-to-one"));
    g = example("a", "b");
    g.min_det = std::numeric_limits<double>::quiet_NaN();
    EXPECT_NE(g.problem(), "");
    for (const Termination t : {Termination::max_steps, Termination::no_descent, Termination::cancelled}) {
        g = example("a", "b");
        g.termination = t;
        EXPECT_NE(g.problem(), "");
    }
    g = example("a", "b");
    g.path_length = std::numeric_limits<double>::infinity();
    EXPECT_NE(g.problem(), "");
}

}  // namespace
}  // namespace morphodesic::pipeline

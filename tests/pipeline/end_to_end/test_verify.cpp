// Results that are computed a second time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "pipeline/result_store.h"
#include "pipeline/run_settings.h"
#include "program.h"

namespace morphodesic::tests {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

/// Checksums cannot see a number that a program wrote wrong: for that `verify` computes it again.
TEST(Verify, FindsANumberThatIsNotWhatIsComputed) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 3);
    ASSERT_EQ(morphodesic(quick({"run", (folder / "disks").string(), "--quiet"})).code, 0);
    const fs::path study = folder / "disks.study";
    EXPECT_EQ(morphodesic({"verify", study.string(), "--quiet"}).code, 0);
    std::string changed;
    {
        pipeline::ResultStore store(study / "study.sqlite", pipeline::ResultStore::Access::write);
        const auto settings = pipeline::settings_from_text(store.fact("settings").value());
        auto row = store.geodesics(pipeline::settings_hash(settings.geodesic)).front();
        row.path_length *= 1.001;
        store.put_geodesic(row);
        for (const auto& shape : store.shapes()) {
            if (shape.content_digest == row.a) changed = shape.name;
        }
    }
    const Outcome found = morphodesic({"verify", study.string(), "--json"});
    EXPECT_EQ(found.code, 1);
    const json said = json::parse(found.out);
    EXPECT_EQ(said["checked"], 3);
    EXPECT_EQ(said["differing"], 1);
    ASSERT_EQ(said["failures"].size(), 1u);
    EXPECT_THAT(said["failures"][0].dump(), HasSubstr(changed));
    // Of one pair each, other seeds take other pairs.
    std::set<int> codes;
    for (const char* seed : {"1", "2", "3", "4", "5", "6", "7", "8"}) {
        codes.insert(morphodesic({"verify", study.string(), "--sample", "1", "--seed", seed, "--quiet"}).code);
    }
    EXPECT_EQ(codes, (std::set<int>{0, 1}));
}

}  // namespace
}  // namespace morphodesic::tests

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <type_traits>

#include "pipeline/run_settings.h"

namespace morphodesic::pipeline {
namespace {

TEST(RunSettings, TextReadsBackAsTheSameSettings) {
    RunSettings settings = settings_of_preset("fine");
    settings.geodesic.lambda = 0.1 + 0.2;
    settings.geodesic.tolerance = 1e-5;
    settings.geodesic.preserve_volume = true;
    settings.labels = "none";
    const RunSettings back = settings_from_text(canonical_text(settings));
    EXPECT_EQ(back.geodesic, settings.geodesic);
    EXPECT_EQ(back.import, settings.import);
    EXPECT_EQ(back.preset, "fine");
    EXPECT_EQ(back.labels, "none");
    EXPECT_EQ(canonical_text(back), canonical_text(settings));
}

TEST(RunSettings, AStrangeTextIsRefused) {
    EXPECT_THROW((void)settings_from_text("wings = 2\n"), std::invalid_argument);
    EXPECT_THROW((void)settings_from_text("level = \"six\"\n"), std::invalid_argument);
    EXPECT_THROW((void)settings_from_text("level = ["), std::invalid_argument);
}

TEST(RunSettings, EveryFieldChangesTheHash) {
    const GeodesicOptions standard;
    std::set<std::string> hashes{settings_hash(standard)};
    std::size_t fields = 0;
    GeodesicOptions::for_each_field(standard, [&](const char* name, const auto&, const char*) {
        GeodesicOptions changed;
        GeodesicOptions::for_each_field(changed, [&](const char* other, auto& value, const char*) {
            if (std::string(name) != other) return;
            using Value = std::decay_t<decltype(value)>;
            if constexpr (std::is_same_v<Value, std::string>)
                value += "x";
            else if constexpr (std::is_same_v<Value, bool>)
                value = !value;
            else
                value = static_cast<Value>(value * 2 + 1);
        });
        hashes.insert(settings_hash(changed));
        ++fields;
    });
    EXPECT_EQ(hashes.size(), fields + 1);
}

TEST(RunSettings, PresetsAreUsableAndInOrderOfCost) {
    int level = 0;
    for (const Preset& preset : presets()) {
        const RunSettings settings = settings_of_preset(preset.name);
        EXPECT_THAT(settings.problems(), testing::IsEmpty());
        EXPECT_GT(settings.geodesic.level, level);
        level = settings.geodesic.level;
    }
    const GeodesicOptions standard;
    EXPECT_EQ(settings_of_preset("standard").geodesic, standard);
    EXPECT_THROW((void)settings_of_preset("best"), std::invalid_argument);
}

}  // namespace
}  // namespace morphodesic::pipeline

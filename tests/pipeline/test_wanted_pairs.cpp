#include <gtest/gtest.h>

#include "pipeline/wanted_pairs.h"

namespace morphodesic::pipeline {
namespace {

using Shape = DifferentShapes::value_type;

TEST(WantedPairs, TheLargerShapeComesFirst) {
    const Shape small{"a", {false, 0.05, 0.2}}, large{"b", {false, 0.07, 0.2}};
    EXPECT_EQ(oriented_pair(small, large), GeodesicKey("b", "a"));
    EXPECT_EQ(oriented_pair(large, small), GeodesicKey("b", "a"));
}

TEST(WantedPairs, OfEqualVolumesTheMoreExtendedComesFirst) {
    // --normalize each: volumes are equal but for rounding, which is not to decide.
    const Shape round{"a", {false, 0.1 + 1e-12, 0.18}}, longish{"b", {false, 0.1, 0.36}};
    EXPECT_EQ(oriented_pair(round, longish), GeodesicKey("b", "a"));
    EXPECT_EQ(oriented_pair(longish, round), GeodesicKey("b", "a"));
}

StoredShape measured(double volume, double fullness) {
    StoredShape shape;
    shape.volume = volume;
    shape.fullness = fullness;
    return shape;
}

TEST(WantedPairs, TheFullerShapeComesFirst) {
    const Shape disk{"a", traits_of(measured(0.1, 1.0), false)}, ring{"b", traits_of(measured(0.2, 0.3), false)};
    EXPECT_EQ(oriented_pair(disk, ring), GeodesicKey("a", "b"));
    EXPECT_EQ(oriented_pair(ring, disk), GeodesicKey("a", "b"));
    const Shape larger{"c", traits_of(measured(0.11, 1.0 - 1e-3), false)};  // as full, but for what the grid sees
    EXPECT_EQ(oriented_pair(disk, larger), GeodesicKey("c", "a"));
}

TEST(WantedPairs, ShapesOfEarlierStudiesKeepTheirDirection) {
    const Shape unknown{"a", {false, 0.05, 0.2}}, full{"b", {false, 0.04, 0.2, 9.0}};
    EXPECT_EQ(oriented_pair(unknown, full), GeodesicKey("a", "b"));
    EXPECT_EQ(oriented_pair(full, unknown), GeodesicKey("a", "b"));
}

TEST(WantedPairs, WithoutExtentTheVolumeDecides) {
    const Shape unknown{"a", {false, 0.05, 0.0}}, small{"b", {false, 0.04, 0.9}}, large{"c", {false, 0.06, 0.1}};
    EXPECT_EQ(oriented_pair(unknown, small), GeodesicKey("a", "b"));
    EXPECT_EQ(oriented_pair(unknown, large), GeodesicKey("c", "a"));
}

TEST(WantedPairs, EqualSizesGoByContent) {
    const Shape x{"a", {false, 0.05, 0.2}}, y{"b", {false, 0.05, 0.2}};
    EXPECT_EQ(oriented_pair(x, y), GeodesicKey("a", "b"));
    EXPECT_EQ(oriented_pair(y, x), GeodesicKey("a", "b"));
}

TEST(WantedPairs, AnOccludedShapeComesFirstAndHasOneDirection) {
    const Shape occluded{"a", {true, 0.01, 0.1}}, whole{"b", {false, 0.09, 0.3}}, other{"c", {false, 0.08, 0.3}};
    EXPECT_EQ(geodesics_of_pair(whole, occluded, true), (std::vector<GeodesicKey>{{"a", "b"}}));
    EXPECT_EQ(geodesics_of_pair(other, whole, true), (std::vector<GeodesicKey>{{"b", "c"}, {"c", "b"}}));
}

TEST(WantedPairs, TheOrderOfEqualFilesDoesNotMatter) {
    const ShapeTraits one{false, 0.05, 0.2, 1.0}, other{false, 0.05 + 1e-15, 0.2 - 1e-15, 1.0 + 1e-15};
    DifferentShapes there, back;
    add_shape(there, "a", one);
    add_shape(there, "a", other);
    add_shape(back, "a", other);
    add_shape(back, "a", one);
    EXPECT_EQ(there.size(), 1u);
    EXPECT_EQ(there, back);
}

TEST(WantedPairs, EveryPairIsThereOnceOrTwice) {
    DifferentShapes shapes;
    for (int i = 0; i < 6; ++i) add_shape(shapes, std::string(1, static_cast<char>('a' + i)), {false, 0.01 * i, 0.2});
    EXPECT_EQ(wanted_geodesics(shapes, false).size(), 15u);
    EXPECT_EQ(wanted_geodesics(shapes, true).size(), 30u);
    for (const auto& [first, second] : wanted_geodesics(shapes, false)) EXPECT_GT(first, second);
}

}  // namespace
}  // namespace morphodesic::pipeline

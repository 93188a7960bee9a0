#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/result_store.h"

namespace morphodesic::pipeline {

/// A geodesic by the content digests of its two ends: from first to second.
using GeodesicKey = std::pair<std::string, std::string>;

/// What decides, beside its content, in which direction the geodesics of a shape are computed.
struct ShapeTraits {
    bool masked = false;         ///< has an occlusion mask
    double volume = 0.0;         ///< area (volume) in units of the cube
    double extent_radius = 0.0;  ///< in units of the cube; 0 if not measured
    double fullness = 0.0;       ///< times volume^(1/20), which tells copies of other size apart; 0 if not measured

    friend bool operator==(const ShapeTraits&, const ShapeTraits&) = default;
};

[[nodiscard]] ShapeTraits traits_of(const StoredShape& shape, bool masked);

/// The different shapes of a study by content digest. Files with equal content are one shape.
using DifferentShapes = std::map<std::string, ShapeTraits>;

/// Adds a shape; of files with equal content the order does not matter.
void add_shape(DifferentShapes& shapes, const std::string& content_digest, const ShapeTraits& traits);

/// Direction of a pair. An occluded shape comes first (its mask belongs to the first step), else the fuller one: the
/// stiffness of a step is that of the shape it begins with, so gaps that close cost too little in long steps, gaps that
/// open do not (geodesic/MEASUREMENTS.md, revision 20), and paths from large to small are nearer to the closed forms.
/// Shapes of studies that did not measure that go by volume times squared extent; else the order of the digests
/// decides. What the files are called and in what order they come does not matter.
[[nodiscard]] GeodesicKey oriented_pair(const DifferentShapes::value_type& a, const DifferentShapes::value_type& b);

/// The geodesics that make the distance of a pair: one, or both directions if that is asked for; a pair with one
/// occluded shape has one direction only.
[[nodiscard]] std::vector<GeodesicKey> geodesics_of_pair(const DifferentShapes::value_type& a,
                                                         const DifferentShapes::value_type& b, bool both_directions);

/// All geodesics of a study, in an order that is as good as random but always the same: the first ones are a fair
/// sample of all.
[[nodiscard]] std::vector<GeodesicKey> wanted_geodesics(const DifferentShapes& shapes, bool both_directions);

}  // namespace morphodesic::pipeline

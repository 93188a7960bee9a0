#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/run_settings.h"

namespace morphodesic::pipeline {

/// A geodesic by the content digests of its two ends: from first to second.
using GeodesicKey = std::pair<std::string, std::string>;

/// Direction of a pair: an occluded shape first (its mask belongs to the first step), else by content digest; so a pair
/// has the same result whatever its files are called and in whatever order they come.
[[nodiscard]] GeodesicKey oriented_pair(const std::string& a, bool a_has_mask, const std::string& b, bool b_has_mask);

/// The geodesics that make the distance of a pair: one, or both directions if that is asked for; a pair with one
/// occluded shape has one direction only.
[[nodiscard]] std::vector<GeodesicKey> geodesics_of_pair(const std::string& a, bool a_has_mask, const std::string& b,
                                                         bool b_has_mask, bool both_directions);

/// All geodesics of a study, in an order that is as good as random but always the same: the first ones are a fair
/// sample of all.
/// @param shapes  content digest -> whether the shape has an occlusion mask
[[nodiscard]] std::vector<GeodesicKey> wanted_geodesics(const std::map<std::string, bool>& shapes,
                                                        bool both_directions);

}  // namespace morphodesic::pipeline

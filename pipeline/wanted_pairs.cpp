#include "pipeline/wanted_pairs.h"

#include <algorithm>
#include <cmath>

#include "pipeline/digest.h"

namespace morphodesic::pipeline {

ShapeTraits traits_of(const StoredShape& shape, bool masked) {
    return {masked, shape.volume, shape.extent_radius * shape.scale, shape.fullness * std::pow(shape.volume, 0.05)};
}

void add_shape(DifferentShapes& shapes, const std::string& content_digest, const ShapeTraits& traits) {
    const auto [at, added] = shapes.emplace(content_digest, traits);
    if (added) return;
    at->second.volume = std::min(at->second.volume, traits.volume);
    at->second.extent_radius = std::min(at->second.extent_radius, traits.extent_radius);
    at->second.fullness = std::min(at->second.fullness, traits.fullness);
}

GeodesicKey oriented_pair(const DifferentShapes::value_type& a, const DifferentShapes::value_type& b) {
    const auto key = [](const auto& first, const auto& second) { return GeodesicKey(first.first, second.first); };
    const ShapeTraits &x = a.second, &y = b.second;
    if (x.masked != y.masked) return x.masked ? key(a, b) : key(b, a);
    const bool has_fullness = x.fullness > 0.0 && y.fullness > 0.0;
    const bool has_extent = x.extent_radius > 0.0 && y.extent_radius > 0.0;
    const auto rank = [&](const ShapeTraits& t) {
        if (has_fullness) return t.fullness;
        return t.volume * (has_extent ? t.extent_radius * t.extent_radius : 1.0);
    };
    if (rank(x) != rank(y)) return rank(x) > rank(y) ? key(a, b) : key(b, a);
    return a.first < b.first ? key(a, b) : key(b, a);
}

std::vector<GeodesicKey> geodesics_of_pair(const DifferentShapes::value_type& a, const DifferentShapes::value_type& b,
                                           bool both_directions) {
    std::vector<GeodesicKey> keys{oriented_pair(a, b)};
    if (both_directions && !a.second.masked && !b.second.masked) {
        keys.emplace_back(keys.front().second, keys.front().first);
    }
    return keys;
}

std::vector<GeodesicKey> wanted_geodesics(const DifferentShapes& shapes, bool both_directions) {
    std::vector<std::pair<std::string, GeodesicKey>> found;
    for (auto i = shapes.begin(); i != shapes.end(); ++i) {
        for (auto j = std::next(i); j != shapes.end(); ++j) {
            for (GeodesicKey& key : geodesics_of_pair(*i, *j, both_directions)) {
                std::string order = digest(key.first + key.second);
                found.emplace_back(std::move(order), std::move(key));
            }
        }
    }
    std::sort(found.begin(), found.end());
    std::vector<GeodesicKey> keys;
    keys.reserve(found.size());
    for (auto& [order, key] : found) keys.push_back(std::move(key));
    return keys;
}

}  // namespace morphodesic::pipeline

#include "pipeline/wanted_pairs.h"

#include <algorithm>

#include "pipeline/digest.h"

namespace morphodesic::pipeline {

ShapeTraits traits_of(const StoredShape& shape, bool masked) {
    return {masked, shape.volume, shape.extent_radius * shape.scale};
}

void add_shape(DifferentShapes& shapes, const std::string& content_digest, const ShapeTraits& traits) {
    const auto [at, added] = shapes.emplace(content_digest, traits);
    if (added) return;
    at->second.volume = std::min(at->second.volume, traits.volume);
    at->second.extent_radius = std::min(at->second.extent_radius, traits.extent_radius);
}

GeodesicKey oriented_pair(const DifferentShapes::value_type& a, const DifferentShapes::value_type& b) {
    const auto key = [](const auto& first, const auto& second) { return GeodesicKey(first.first, second.first); };
    const ShapeTraits &x = a.second, &y = b.second;
    if (x.masked != y.masked) return x.masked ? key(a, b) : key(b, a);
    const bool measured = x.extent_radius > 0.0 && y.extent_radius > 0.0;
    const auto size = [&](const ShapeTraits& t) {
        return t.volume * (measured ? t.extent_radius * t.extent_radius : 1.0);
    };
    if (size(x) != size(y)) return size(x) > size(y) ? key(a, b) : key(b, a);
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

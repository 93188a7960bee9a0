#include "pipeline/wanted_pairs.h"

#include <algorithm>

#include "pipeline/digest.h"

namespace morphodesic::pipeline {

GeodesicKey oriented_pair(const std::string& a, bool a_has_mask, const std::string& b, bool b_has_mask) {
    const bool keep = a_has_mask != b_has_mask ? a_has_mask : a < b;
    return keep ? GeodesicKey(a, b) : GeodesicKey(b, a);
}

std::vector<GeodesicKey> geodesics_of_pair(const std::string& a, bool a_has_mask, const std::string& b, bool b_has_mask,
                                           bool both_directions) {
    std::vector<GeodesicKey> keys{oriented_pair(a, a_has_mask, b, b_has_mask)};
    if (both_directions && !a_has_mask && !b_has_mask) keys.emplace_back(keys.front().second, keys.front().first);
    return keys;
}

std::vector<GeodesicKey> wanted_geodesics(const std::map<std::string, bool>& shapes, bool both_directions) {
    std::vector<std::pair<std::string, GeodesicKey>> found;
    for (auto i = shapes.begin(); i != shapes.end(); ++i) {
        for (auto j = std::next(i); j != shapes.end(); ++j) {
            for (GeodesicKey& key : geodesics_of_pair(i->first, i->second, j->first, j->second, both_directions)) {
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

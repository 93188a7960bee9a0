#include "pipeline/common_frame.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>

namespace morphodesic::pipeline {
namespace {

using datasets::Rotation;
using datasets::unturned;

constexpr double same_degrees = 30.0;

Rotation transposed(const Rotation& a) {
    Rotation t{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) t[3 * i + j] = a[3 * j + i];
    }
    return t;
}

/// Angle of the rotation that leads from a to b.
double angle_between(const Rotation& a, const Rotation& b) {
    return turn_angle(product(transposed(a), b));
}

/// The rotation nearest to all others (least sum of angles), the first of equally near ones.
std::size_t most_central(const std::vector<Rotation>& rotations) {
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < rotations.size(); ++i) {
        double sum = 0.0;
        for (const Rotation& other : rotations) sum += angle_between(rotations[i], other);
        if (sum < least - 1e-6) best = i, least = sum;
    }
    return best;
}

/// What most votes agree on.
std::optional<Rotation> agreed(const std::vector<Rotation>& votes) {
    if (votes.empty()) return std::nullopt;
    const Rotation& central = votes[most_central(votes)];
    const auto near = std::count_if(votes.begin(), votes.end(),
                                    [&](const Rotation& vote) { return angle_between(central, vote) <= same_degrees; });
    if (2 * static_cast<std::size_t>(near) <= votes.size()) return std::nullopt;
    return central;
}

}  // namespace

Rotation product(const Rotation& a, const Rotation& b) {
    Rotation c{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            for (std::size_t k = 0; k < 3; ++k) c[3 * i + j] += a[3 * i + k] * b[3 * k + j];
        }
    }
    return c;
}

double turn_angle(const Rotation& rotation) {
    const double trace = rotation[0] + rotation[4] + rotation[8];
    return std::acos(std::clamp((trace - 1.0) / 2.0, -1.0, 1.0)) * 180.0 / std::numbers::pi;
}

CommonFrames common_frames(const std::vector<std::string>& labels, std::vector<PairTurn> pairs) {
    constexpr std::size_t most_votes = 40, most_members = 200;  // bounds the work; the nearest count
    const std::size_t n = labels.size();
    const auto alike = [&](std::size_t i, std::size_t j) {
        return labels[i] == labels[j] || labels[i].empty() || labels[j].empty();
    };
    std::stable_sort(pairs.begin(), pairs.end(),
                     [](const PairTurn& a, const PairTurn& b) { return a.distance < b.distance; });
    std::vector<std::vector<std::size_t>> between(n);  // pairs of a solid, nearest first
    for (std::size_t p = 0; p < pairs.size(); ++p) {
        between[pairs[p].first].push_back(p);
        between[pairs[p].second].push_back(p);
    }
    std::vector<Rotation> turns(n, unturned);
    std::vector<std::size_t> group(n);
    std::iota(group.begin(), group.end(), std::size_t{0});
    std::vector<std::vector<std::size_t>> members(n);
    for (std::size_t i = 0; i < n; ++i) members[i] = {i};
    std::set<std::pair<std::size_t, std::size_t>> apart;  // groups that were looked at

    /// From the frame of one group to that of another, by the pairs between them.
    const auto lay_of = [&](std::size_t a, std::size_t b) {
        std::vector<std::size_t> voting;
        for (const std::size_t i : members[a]) {
            for (const std::size_t p : between[i]) {
                const std::size_t other = pairs[p].first == i ? pairs[p].second : pairs[p].first;
                if (group[other] == b && alike(i, other)) voting.push_back(p);
            }
        }
        std::sort(voting.begin(), voting.end());
        if (voting.size() > most_votes) voting.resize(most_votes);
        std::vector<Rotation> votes;
        for (const std::size_t p : voting) {
            const bool from_a = group[pairs[p].first] == a;
            const Rotation turn = from_a ? pairs[p].turn : transposed(pairs[p].turn);
            const std::size_t i = from_a ? pairs[p].first : pairs[p].second,
                              j = from_a ? pairs[p].second : pairs[p].first;
            votes.push_back(product(turns[j], product(turn, transposed(turns[i]))));
        }
        return agreed(votes);
    };
    for (const PairTurn& pair : pairs) {
        std::size_t a = group[pair.first], b = group[pair.second];
        if (a == b || !alike(pair.first, pair.second)) continue;
        if (members[a].size() > members[b].size()) std::swap(a, b);
        if (apart.count(std::minmax(a, b)) != 0) continue;
        const std::optional<Rotation> lay = lay_of(a, b);
        if (!lay) {
            apart.insert(std::minmax(a, b));
            continue;
        }
        for (const std::size_t i : members[a]) {
            turns[i] = product(*lay, turns[i]);
            group[i] = b;
            members[b].push_back(i);
        }
        members[a].clear();
        // Both are others now, and may be joined with what they were not joined with.
        std::erase_if(apart, [&](const auto& two) {
            return two.first == a || two.first == b || two.second == a || two.second == b;
        });
        // The frame of the group is that of the file which is nearest to all others.
        std::vector<std::size_t> looked_at = members[b];
        std::sort(looked_at.begin(), looked_at.end());
        if (looked_at.size() > most_members) looked_at.resize(most_members);
        std::vector<Rotation> frames;
        for (const std::size_t i : looked_at) frames.push_back(turns[i]);
        const Rotation back = transposed(frames[most_central(frames)]);
        for (const std::size_t i : members[b]) turns[i] = product(back, turns[i]);
    }
    CommonFrames result{std::move(turns), std::vector<std::size_t>(n)};
    std::map<std::size_t, std::size_t> numbers;
    for (std::size_t i = 0; i < n; ++i) {
        if (turn_angle(result.turns[i]) <= same_degrees) result.turns[i] = unturned;
        result.groups[i] = numbers.try_emplace(group[i], numbers.size()).first->second;
    }
    return result;
}

std::vector<PairTurn> pair_turns(const StudyData& data) {
    std::vector<PairTurn> turns;
    for (std::size_t i = 0; i < data.shapes.size(); ++i) {
        for (std::size_t j = i + 1; j < data.shapes.size(); ++j) {
            const std::size_t pair = data.index(i, j);
            const StoredGeodesic* const geodesic = data.geodesic(pair);
            if (geodesic != nullptr && geodesic->problem().empty() && geodesic->rotation.size() == 9) {
                PairTurn turn{data.first_is_a[pair] ? i : j, data.first_is_a[pair] ? j : i, geodesic->path_length, {}};
                std::copy(geodesic->rotation.begin(), geodesic->rotation.end(), turn.turn.begin());
                turns.push_back(turn);
            } else if (geodesic == nullptr && data.shapes[i].content_digest == data.shapes[j].content_digest) {
                turns.push_back({i, j, 0.0, unturned});
            }
        }
    }
    return turns;
}

}  // namespace morphodesic::pipeline

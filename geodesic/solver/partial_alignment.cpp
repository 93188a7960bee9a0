#include "geodesic/solver/partial_alignment.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "geodesic/grid/transfer.h"
#include "geodesic/solver/partial_mismatch.h"

namespace morphodesic {

using namespace partial;

namespace {

constexpr int fine_level(int dim) {
    return dim == 2 ? 5 : 4;
}

}  // namespace

template <int Dim>
struct PartialAligner<Dim>::Impl {
    Sampler<Dim> u;
    Samples<Dim> coarse, fine;
    std::vector<ContourPoint<Dim>> pins, probes;  ///< visible contour points: few for pairs, more for a first score
    Vector<Dim> centroid = Vector<Dim>::Zero();
    bool whole = true;  ///< nothing is hidden

    Impl(const LevelSet<Dim>& partial, const ScalarField<Dim>& mask)
        : u(restricted(partial, std::min(partial.grid.level(), 6))),
          coarse(u, mask, Dim == 2 ? 16 : 8),
          fine(u, mask, 1 << fine_level(Dim)) {
        const auto visible = [&](const Vector<Dim>& x) {
            if (mask.values.empty()) return true;
            Point<Dim> at{};
            for (int a = 0; a < Dim; ++a) at[static_cast<std::size_t>(a)] = x(a);
            return q1::value(mask.grid, mask.values.data(), at) > 0.95;
        };
        pins = contour_points(u.u, Dim == 2 ? 16 : 20, visible);
        probes = contour_points(u.u, Dim == 2 ? 32 : 40, visible);
        double volume = 0.0;
        for (const auto& s : fine.points) {
            if (s.value <= 0) continue;
            volume += s.chi;
            centroid += s.chi * s.x;
        }
        whole = std::all_of(mask.values.begin(), mask.values.end(), [](double chi) { return chi > 0.99; });
        if (pins.empty()) {
            throw std::invalid_argument("align: nothing of the shape's contour is visible on the grid");
        }
        if (volume > 0) {
            centroid /= volume;
        } else {  // it lies between the points of the lattice
            for (const auto& pin : pins) centroid += pin.x / static_cast<double>(pins.size());
        }
    }
};

template <int Dim>
struct AlignmentTarget<Dim>::Impl {
    /// Distances from the contour, as far as they matter to a first score; read at the nearest node.
    static constexpr float far = 0.1F;
    Sampler<Dim> u;
    std::vector<ContourPoint<Dim>> anchors;
    Vector<Dim> middle = Vector<Dim>::Zero();
    std::vector<float> distance;

    explicit Impl(const LevelSet<Dim>& whole)
        : u(restricted(whole, std::min(whole.grid.level(), 6))),
          anchors(contour_points(u.u, Dim == 2 ? 48 : 60, [](const Vector<Dim>&) { return true; })) {
        double volume = 0.0;
        for (std::size_t i = 0; i < u.u.values.size(); ++i) {
            distance.push_back(std::min(std::abs(static_cast<float>(u.u.values[i])), far));
            if (u.u.values[i] <= 0) continue;
            volume += 1.0;
            middle += as_vector<Dim>(u.u.grid.position(u.u.grid.node(i)));
        }
        if (!(volume > 0)) throw std::invalid_argument("align: a shape is empty on the grid");
        middle /= volume;
    }

    [[nodiscard]] float distance_near(const Vector<Dim>& x) const {
        const int n = u.u.grid.nodes_per_axis();
        std::array<int, Dim> node{};
        for (int a = 0; a < Dim; ++a) {
            const double at = x(a) * (n - 1) + 0.5;
            if (!(at >= 0.0 && at < n)) return far;
            node[static_cast<std::size_t>(a)] = static_cast<int>(at);
        }
        return distance[u.u.grid.index(node)];
    }
};

template <int Dim>
AlignmentTarget<Dim>::AlignmentTarget(const LevelSet<Dim>& whole) : impl_(std::make_unique<Impl>(whole)) {}
template <int Dim>
AlignmentTarget<Dim>::~AlignmentTarget() = default;
template <int Dim>
AlignmentTarget<Dim>::AlignmentTarget(AlignmentTarget&&) noexcept = default;

template <int Dim>
PartialAligner<Dim>::PartialAligner(const LevelSet<Dim>& partial, const ScalarField<Dim>& mask)
    : impl_(std::make_unique<Impl>(partial, mask)) {}
template <int Dim>
PartialAligner<Dim>::~PartialAligner() = default;
template <int Dim>
PartialAligner<Dim>::PartialAligner(PartialAligner&&) noexcept = default;

namespace {

template <int Dim>
struct Candidate {
    Motion<Dim> motion;
    double score;
};

template <int Dim>
void sort_by_score(std::vector<Candidate<Dim>>& candidates) {
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate<Dim>& a, const Candidate<Dim>& b) { return a.score < b.score; });
}

/// The best of each group of motions that are alike, at most `count`, from sorted candidates.
template <int Dim>
void keep_distinct(std::vector<Candidate<Dim>>& candidates, std::size_t count, double angle, double shift) {
    std::vector<Candidate<Dim>> kept;
    for (const auto& c : candidates) {
        const bool known = std::any_of(kept.begin(), kept.end(), [&](const Candidate<Dim>& k) {
            return (k.motion.rotation - c.motion.rotation).norm() < angle &&
                   (k.motion.translation - c.motion.translation).norm() < shift &&
                   std::abs(std::log(k.motion.scale / c.motion.scale)) < 0.08;
        });
        if (!known) kept.push_back(c);
        if (kept.size() == count) break;
    }
    candidates = std::move(kept);
}

template <int Dim>
std::vector<PartialAlignmentCandidate<Dim>> as_result(const std::vector<Candidate<Dim>>& candidates) {
    std::vector<PartialAlignmentCandidate<Dim>> result;
    for (const auto& c : candidates) result.push_back({c.motion.as_similarity(), c.score});
    return result;
}

std::vector<double> sizes_to_try(const PartialAlignmentOptions& options) {
    const double range = std::log(options.largest_scale / options.least_scale);
    if (range <= 0.1) return {std::sqrt(options.least_scale * options.largest_scale)};
    const int count = 1 + static_cast<int>(std::ceil(range / 0.12));
    std::vector<double> scales;
    for (int i = 0; i < count; ++i) scales.push_back(options.least_scale * std::exp(range * i / (count - 1)));
    return scales;
}

}  // namespace

template <int Dim>
std::vector<PartialAlignmentCandidate<Dim>> PartialAligner<Dim>::align(const LevelSet<Dim>& whole,
                                                                       const PartialAlignmentOptions& options) const {
    const AlignmentTarget<Dim> target(whole);
    return refine(target, search(target, options), options);
}

template <int Dim>
std::vector<PartialAlignmentCandidate<Dim>> PartialAligner<Dim>::search(const AlignmentTarget<Dim>& whole,
                                                                        const PartialAlignmentOptions& options) const {
    const auto& target = whole.impl();
    const MismatchProblem<Dim> coarse(impl_->coarse, target.u, options);
    if (!options.move) {
        const Motion<Dim> identity;
        return {{identity.as_similarity(), coarse.evaluate(identity, nullptr, nullptr)}};
    }
    // First score: how far the visible contour ends from that of the whole shape. Only the best are kept, so a sum that
    // is too large already need not be finished.
    constexpr std::size_t first = Dim == 2 ? 60 : 150;
    double limit = std::numeric_limits<double>::infinity();
    std::vector<Candidate<Dim>> found;
    const auto add = [&](const Motion<Dim>& m) {
        const double most = limit * m.scale;
        double sum = 0.0;
        for (std::size_t p = 0; p < impl_->probes.size() && sum <= most; ++p) {
            sum += target.distance_near(m(impl_->probes[p].x));
        }
        if (sum > most) return;
        found.push_back({m, sum / m.scale});
        if (found.size() < 4 * first) return;
        sort_by_score(found);
        found.resize(first);
        limit = found.back().score;
    };
    const std::vector<double> scales = sizes_to_try(options);
    for (const double scale : scales) {
        for (const auto& pin : impl_->pins) {
            for (const auto& anchor : target.anchors) {
                Motion<Dim> m;
                m.scale = scale;
                if (!options.rotate) {
                    if (pin.normal.dot(anchor.normal) < 0.8) continue;
                    m.pin(pin.x, anchor.x);
                    add(m);
                    continue;
                }
                for (const auto& rotation : turns<Dim>(pin.normal, anchor.normal)) {
                    m.rotation = rotation;
                    m.pin(pin.x, anchor.x);
                    add(m);
                }
            }
        }
    }
    sort_by_score(found);
    if (found.size() > first) found.resize(first);
    if (impl_->whole) {  // nothing is hidden: the centroids are a good guess as well
        const double scale = scales[scales.size() / 2];
        const int turns_all_around = options.rotate && Dim == 2 ? 24 : 1;
        for (int k = 0; k < turns_all_around; ++k) {
            Motion<Dim> m;
            m.scale = scale;
            if constexpr (Dim == 2) {
                m.rotation = Eigen::Rotation2D<double>(2 * std::numbers::pi * k / turns_all_around).toRotationMatrix();
            }
            m.pin(impl_->centroid, target.middle);
            found.push_back({m, 0.0});
        }
    }
    if (options.least_scale <= 1.0 && options.largest_scale >= 1.0) found.push_back({Motion<Dim>{}, 0.0});
    for (auto& c : found) c.score = coarse.evaluate(c.motion, nullptr, nullptr);
    sort_by_score(found);
    keep_distinct(found, static_cast<std::size_t>(std::max(8, 3 * options.count)), 0.3, 0.06);
    for (auto& c : found) c.score = coarse.refine(c.motion, 8);
    sort_by_score(found);
    keep_distinct(found, static_cast<std::size_t>(options.count), 0.2, 0.03);
    return as_result(found);
}

template <int Dim>
std::vector<PartialAlignmentCandidate<Dim>> PartialAligner<Dim>::refine(
    const AlignmentTarget<Dim>& whole, const std::vector<PartialAlignmentCandidate<Dim>>& candidates,
    const PartialAlignmentOptions& options) const {
    const MismatchProblem<Dim> fine(impl_->fine, whole.impl().u, options);
    std::vector<Candidate<Dim>> found;
    for (const auto& c : candidates) {
        Candidate<Dim> refined{Motion<Dim>(c.motion), 0.0};
        refined.score =
            options.move ? fine.refine(refined.motion, 10) : fine.evaluate(refined.motion, nullptr, nullptr);
        found.push_back(refined);
    }
    sort_by_score(found);
    return as_result(found);
}

template <int Dim>
LevelSet<Dim> carried(const LevelSet<Dim>& u, const Similarity<Dim>& motion, int level) {
    LevelSet<Dim> result{DyadicGrid<Dim>(level)};
    const Sampler<Dim> sampler(u);
    for (std::size_t i = 0; i < result.values.size(); ++i) {
        const Point<Dim> x = motion.back(result.grid.position(result.grid.node(i)));
        result.values[i] = motion.scale * sampler.value(as_vector<Dim>(x));
    }
    return result;
}

template <int Dim>
ScalarField<Dim> carried_mask(const ScalarField<Dim>& mask, const Similarity<Dim>& motion, int level) {
    ScalarField<Dim> result{DyadicGrid<Dim>(level)};
    for (std::size_t i = 0; i < result.values.size(); ++i) {
        const Point<Dim> x = motion.back(result.grid.position(result.grid.node(i)));
        result.values[i] = std::clamp(q1::value(mask.grid, mask.values.data(), x), 0.0, 1.0);
    }
    return result;
}

template class AlignmentTarget<2>;
template class AlignmentTarget<3>;
template class PartialAligner<2>;
template class PartialAligner<3>;
template LevelSet<2> carried<2>(const LevelSet<2>&, const Similarity<2>&, int);
template LevelSet<3> carried<3>(const LevelSet<3>&, const Similarity<3>&, int);
template ScalarField<2> carried_mask<2>(const ScalarField<2>&, const Similarity<2>&, int);
template ScalarField<3> carried_mask<3>(const ScalarField<3>&, const Similarity<3>&, int);

}  // namespace morphodesic

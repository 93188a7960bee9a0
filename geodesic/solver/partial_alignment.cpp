#include "geodesic/solver/partial_alignment.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "geodesic/grid/q1_element.h"
#include "geodesic/grid/transfer.h"
#include "geodesic/solver/small_rotation.h"

namespace morphodesic {

namespace {

template <int Dim>
using Vector = Eigen::Matrix<double, Dim, 1>;
template <int Dim>
using Matrix = Eigen::Matrix<double, Dim, Dim>;

/// A step of width w with tails that fall off like w^2 / u^2: far parts still attract each other, and it costs one
/// square root.
double soft_step(double u, double width) {
    return 0.5 + 0.5 * u / std::sqrt(u * u + width * width);
}
double soft_step_slope(double u, double width) {
    const double s = u * u + width * width;
    return 0.5 * width * width / (s * std::sqrt(s));
}

template <int Dim>
Vector<Dim> as_vector(const Point<Dim>& x) {
    return Eigen::Map<const Vector<Dim>>(x.data());
}

/// Level set with value and gradient anywhere.
template <int Dim>
struct Sampler {
    LevelSet<Dim> u;
    std::array<std::size_t, 1 << Dim> offsets;

    explicit Sampler(LevelSet<Dim> field) : u(std::move(field)), offsets(q1::corner_offsets(u.grid)) {}

    double value(const Vector<Dim>& y) const {
        Point<Dim> at{};
        double beyond = 0.0;
        for (int c = 0; c < Dim; ++c) {
            const double inside = std::clamp(y(c), 0.0, 1.0);
            beyond += (y(c) - inside) * (y(c) - inside);
            at[static_cast<std::size_t>(c)] = inside;
        }
        const auto where = q1::locate(u.grid, at);
        double result = beyond > 0 ? -std::sqrt(beyond) : 0.0;
        for (int c = 0; c < (1 << Dim); ++c) {
            result += q1::shape<Dim>(c, where.fraction) * u.values[where.node + offsets[static_cast<std::size_t>(c)]];
        }
        return result;
    }

    double value_and_slope(const Vector<Dim>& y, Vector<Dim>& slope) const {
        Point<Dim> at{};
        double beyond = 0.0;
        for (int c = 0; c < Dim; ++c) {
            const double inside = std::clamp(y(c), 0.0, 1.0);
            beyond += (y(c) - inside) * (y(c) - inside);
            at[static_cast<std::size_t>(c)] = inside;
        }
        const auto where = q1::locate(u.grid, at);
        double result = beyond > 0 ? -std::sqrt(beyond) : 0.0;
        slope.setZero();
        for (int c = 0; c < (1 << Dim); ++c) {
            const double v = u.values[where.node + offsets[static_cast<std::size_t>(c)]];
            result += q1::shape<Dim>(c, where.fraction) * v;
            for (int d = 0; d < Dim; ++d) slope(d) += q1::shape_slope<Dim>(c, where.fraction, d) * v;
        }
        slope *= u.grid.cells_per_axis();
        return result;
    }
};

template <int Dim>
struct ContourPoint {
    Vector<Dim> x, normal;  ///< normal points inwards, unit length
};

/// Crossings of the contour with grid lines, evenly thinned to at most `count`.
template <int Dim, class Keep>
std::vector<ContourPoint<Dim>> contour_points(const LevelSet<Dim>& u, std::size_t count, const Keep& keep) {
    std::vector<ContourPoint<Dim>> points;
    const Sampler<Dim> sampler(u);
    const int n = u.grid.nodes_per_axis();
    for (std::size_t i = 0; i < u.values.size(); ++i) {
        const auto node = u.grid.node(i);
        for (int a = 0; a < Dim; ++a) {
            auto next = node;
            if (++next[static_cast<std::size_t>(a)] == n) continue;
            const double v = u.values[i], w = u.values[u.grid.index(next)];
            if ((v > 0) == (w > 0)) continue;
            ContourPoint<Dim> p;
            p.x = as_vector<Dim>(u.grid.position(node));
            p.x(a) += u.grid.spacing() * v / (v - w);
            if (!keep(p.x)) continue;
            sampler.value_and_slope(p.x, p.normal);
            const double length = p.normal.norm();
            if (length < 0.3) continue;  // a medial axis, not a contour one can trust
            p.normal /= length;
            points.push_back(p);
        }
    }
    if (points.size() <= count) return points;
    // Farthest-point sampling spreads the few points over all parts of the contour.
    std::vector<ContourPoint<Dim>> chosen{points.front()};
    std::vector<double> distance(points.size(), 1e300);
    while (chosen.size() < count) {
        std::size_t farthest = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            distance[i] = std::min(distance[i], (points[i].x - chosen.back().x).squaredNorm());
            if (distance[i] > distance[farthest]) farthest = i;
        }
        chosen.push_back(points[farthest]);
    }
    return chosen;
}

template <int Dim>
struct Motion {
    Matrix<Dim> rotation = Matrix<Dim>::Identity();
    Vector<Dim> translation = Vector<Dim>::Zero();
    double scale = 1.0;

    Motion() = default;
    explicit Motion(const Similarity<Dim>& s) : scale(s.scale) {
        for (int i = 0; i < Dim; ++i) {
            for (int j = 0; j < Dim; ++j) rotation(i, j) = s.motion.rotation[static_cast<std::size_t>(i * Dim + j)];
            translation(i) = s.motion.translation[static_cast<std::size_t>(i)];
        }
    }

    Vector<Dim> operator()(const Vector<Dim>& x) const {
        const Vector<Dim> centre = Vector<Dim>::Constant(0.5);
        return scale * (rotation * (x - centre)) + centre + translation;
    }
    /// Lays x on y.
    void pin(const Vector<Dim>& x, const Vector<Dim>& y) {
        const Vector<Dim> centre = Vector<Dim>::Constant(0.5);
        translation = y - centre - scale * (rotation * (x - centre));
    }
    Similarity<Dim> as_similarity() const {
        Similarity<Dim> s;
        for (int i = 0; i < Dim; ++i) {
            for (int j = 0; j < Dim; ++j) s.motion.rotation[static_cast<std::size_t>(i * Dim + j)] = rotation(i, j);
            s.motion.translation[static_cast<std::size_t>(i)] = translation(i);
        }
        s.scale = scale;
        return s;
    }
};

/// Rotations that turn one unit vector to another: one in the plane; in space also turns about the vector.
template <int Dim>
std::vector<Matrix<Dim>> turns(const Vector<Dim>& from, const Vector<Dim>& to) {
    if constexpr (Dim == 2) {
        const double c = from.dot(to), s = from(0) * to(1) - from(1) * to(0);
        Matrix<2> r;
        r << c, -s, s, c;
        return {r};
    } else {
        constexpr int rolls = 12;
        const Matrix<3> base = Eigen::Quaterniond::FromTwoVectors(from, to).toRotationMatrix();
        std::vector<Matrix<3>> result;
        for (int k = 0; k < rolls; ++k) {
            result.push_back(Eigen::AngleAxisd(2 * std::numbers::pi * k / rolls, to).toRotationMatrix() * base);
        }
        return result;
    }
}

/// What is known of the partial shape at points of a lattice that reaches beyond its cube, where the whole shape may.
template <int Dim>
struct Samples {
    struct Sample {
        Vector<Dim> x;
        double value, chi;  ///< level set and mask
    };
    double spacing;
    std::vector<Sample> points;

    Samples(const Sampler<Dim>& u, const ScalarField<Dim>& mask, int cells) : spacing(1.0 / cells) {
        const int margin = cells / 4;
        std::array<int, Dim> i;
        i.fill(-margin);
        for (;;) {
            Point<Dim> x{};
            for (std::size_t a = 0; a < Dim; ++a) x[a] = i[a] * spacing;
            const double chi = mask.values.empty() ? 1.0 : q1::value(mask.grid, mask.values.data(), x);
            if (chi > 0.01) points.push_back({as_vector<Dim>(x), u.value(as_vector<Dim>(x)), chi});
            std::size_t a = 0;
            while (a < Dim && ++i[a] > cells + margin) i[a++] = -margin;
            if (a == Dim) break;
        }
    }
};

/// Weighted mismatch of the visible region and its Gauss-Newton system in (angles, translation, log of the size).
template <int Dim>
class MismatchProblem {
public:
    static constexpr int angles = Dim == 2 ? 1 : 3;
    static constexpr int unknowns = angles + Dim + 1;
    using Row = Eigen::Matrix<double, unknowns, 1>;
    using System = Eigen::Matrix<double, unknowns, unknowns>;

    MismatchProblem(const Samples<Dim>& samples, const Sampler<Dim>& whole, const PartialAlignmentOptions& options)
        : samples_(samples), whole_(whole), options_(options), width_(samples.spacing) {}

    double evaluate(const Motion<Dim>& m, Row* gradient, System* normal) const {
        const double volume = std::pow(samples_.spacing * m.scale, Dim);
        double sum = 0.0;
        if (gradient) {
            gradient->setZero();
            normal->setZero();
        }
        const Vector<Dim> centre = Vector<Dim>::Constant(0.5);
        for (const auto& sample : samples_.points) {
            const Vector<Dim> y = m(sample.x);
            Vector<Dim> slope;
            const double u = gradient ? whole_.value_and_slope(y, slope) : whole_.value(y);
            const double r = soft_step(u, width_) - soft_step(m.scale * sample.value, width_);
            const double w = sample.chi * (r > 0 ? options_.missing_weight : options_.added_weight);
            sum += w * r * r;
            if (!gradient) continue;
            const Vector<Dim> force = slope * soft_step_slope(u, width_);
            const Vector<Dim> z = y - centre - m.translation;
            Row row;
            if constexpr (Dim == 2) {
                row(0) = force(1) * z(0) - force(0) * z(1);
            } else {
                row.template head<3>() = Vector<3>(z.cross(force));
            }
            row.template segment<Dim>(angles) = force;
            const double own = m.scale * sample.value;
            row(unknowns - 1) = force.dot(z) - soft_step_slope(own, width_) * own;
            *gradient += w * r * row;
            *normal += w * row * row.transpose();
        }
        return volume * sum;
    }

    double refine(Motion<Dim>& m, int iterations) const {
        const bool resize = options_.largest_scale > options_.least_scale;
        Row gradient;
        System normal;
        double damping = 1e-2, value = evaluate(m, &gradient, &normal);
        for (int k = 0; k < iterations; ++k) {
            System system = normal;
            system.diagonal() += damping * normal.diagonal();
            system.diagonal().array() += 1e-12;
            if (!options_.rotate) fix(system, gradient, 0, angles);
            if (!resize) fix(system, gradient, unknowns - 1, 1);
            const Row change = system.ldlt().solve(-gradient);
            Motion<Dim> trial = m;
            if (options_.rotate) trial.rotation = small_rotation<Dim>(change) * m.rotation;
            trial.translation = m.translation + change.template segment<Dim>(angles);
            if (resize) {
                trial.scale = std::clamp(m.scale * std::exp(std::clamp(change(unknowns - 1), -0.5, 0.5)),
                                         options_.least_scale, options_.largest_scale);
            }
            const double next = evaluate(trial, nullptr, nullptr);
            if (next < value) {
                const bool small = value - next < 1e-5 * value || change.norm() < 1e-6;
                m = trial;
                if (small) return next;
                value = evaluate(m, &gradient, &normal);
                damping = std::max(damping * 0.2, 1e-9);
            } else {
                damping *= 8;
                if (damping > 1e5) break;
            }
        }
        return value;
    }

private:
    static void fix(System& system, Row& gradient, int first, int count) {
        for (int i = first; i < first + count; ++i) {
            system.row(i).setZero();
            system.col(i).setZero();
            system(i, i) = 1.0;
            gradient(i) = 0.0;
        }
    }
    const Samples<Dim>& samples_;
    const Sampler<Dim>& whole_;
    const PartialAlignmentOptions& options_;
    double width_;
};

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
        if (!(volume > 0) || pins.empty()) {
            throw std::invalid_argument("align: nothing of the shape's contour is visible on the grid");
        }
        centroid /= volume;
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

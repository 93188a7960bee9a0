#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "geodesic/grid/q1_element.h"
#include "geodesic/solver/partial_alignment.h"
#include "geodesic/solver/small_rotation.h"

/// What PartialAligner minimises: the mismatch of a visible region and a whole shape under a similarity, and how it
/// samples both. For .cpp files: brings Eigen.
namespace morphodesic::partial {

template <int Dim>
using Vector = Eigen::Matrix<double, Dim, 1>;
template <int Dim>
using Matrix = Eigen::Matrix<double, Dim, Dim>;

/// A step of width w with tails that fall off like w^2 / u^2: far parts still attract each other, and it costs one
/// square root.
inline double soft_step(double u, double width) {
    return 0.5 + 0.5 * u / std::sqrt(u * u + width * width);
}
inline double soft_step_slope(double u, double width) {
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
        const Place at = place_of(y);
        double result = at.beyond;
        for (int c = 0; c < (1 << Dim); ++c) result += q1::shape<Dim>(c, at.where.fraction) * corner(at, c);
        return result;
    }

    double value_and_slope(const Vector<Dim>& y, Vector<Dim>& slope) const {
        const Place at = place_of(y);
        double result = at.beyond;
        slope.setZero();
        for (int c = 0; c < (1 << Dim); ++c) {
            const double v = corner(at, c);
            result += q1::shape<Dim>(c, at.where.fraction) * v;
            for (int d = 0; d < Dim; ++d) slope(d) += q1::shape_slope<Dim>(c, at.where.fraction, d) * v;
        }
        slope *= u.grid.cells_per_axis();
        return result;
    }

private:
    struct Place {
        q1::Location<Dim> where;  // nearest point of the cube
        double beyond;            // minus the distance from it
    };
    Place place_of(const Vector<Dim>& y) const {
        Point<Dim> at{};
        double beyond = 0.0;
        for (int c = 0; c < Dim; ++c) {
            const double inside = std::clamp(y(c), 0.0, 1.0);
            beyond += (y(c) - inside) * (y(c) - inside);
            at[static_cast<std::size_t>(c)] = inside;
        }
        return {q1::locate(u.grid, at), beyond > 0 ? -std::sqrt(beyond) : 0.0};
    }
    double corner(const Place& at, int c) const {
        return u.values[at.where.node + offsets[static_cast<std::size_t>(c)]];
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

}  // namespace morphodesic::partial

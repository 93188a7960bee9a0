#include "datasets/mesh_smoothing.h"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>

#include "datasets/interruption.h"

namespace morphodesic::datasets {
namespace {

constexpr std::size_t most_neighbours = 400;  // more do not make a fit better
constexpr double widest = 0.07;               // neighbourhood, of the diagonal of the bounding box
constexpr double growth = 1.35;               // from one neighbourhood to the next
constexpr int normal_rounds = 3;              // of averaging normals: noise turns single ones by half a right angle
constexpr double same_side = 0.65;            // cosine between normals of points that a quadric may join
constexpr double excess = 4.0;  // deviations by which residuals may exceed the noise: one stops most of the growth

void normalise(std::vector<Vector3>& vectors) {
    for (auto& v : vectors) {
        const double length = norm(v);
        if (length > 0) v = (1.0 / length) * v;
    }
}

/// Unit normals at the points, averaged along the surface so that noise does not turn them.
std::vector<Vector3> point_normals(const TriangleMesh& mesh) {
    std::vector<Vector3> normals(mesh.points.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Vector3 n = area_vector(mesh.corners(t));
        for (const int c : mesh.triangles[t]) normals[c] = normals[c] + n;
    }
    normalise(normals);
    for (int round = 0; round < normal_rounds; ++round) {
        interruption_point();
        std::vector<Vector3> sums = normals;
        for (const auto& t : mesh.triangles) {
            const Vector3 sum = normals[t[0]] + normals[t[1]] + normals[t[2]];
            for (const int c : t) sums[c] = sums[c] + sum - normals[c];
        }
        normalise(sums);
        normals = std::move(sums);
    }
    return normals;
}

/// Points that share an edge with each point, ascending.
std::vector<std::vector<int>> neighbours_of(const TriangleMesh& mesh) {
    std::vector<std::vector<int>> neighbours(mesh.points.size());
    interruption_point();
    for (const auto& t : mesh.triangles) {
        for (int c = 0; c < 3; ++c) {
            const int a = t[c], b = t[(c + 1) % 3];
            neighbours[a].push_back(b);
            neighbours[b].push_back(a);
        }
    }
    for (auto& list : neighbours) {
        std::sort(list.begin(), list.end());
        list.erase(std::unique(list.begin(), list.end()), list.end());
    }
    return neighbours;
}

/// Some of the points of a mesh, sorted into boxes.
class NearPoints {
public:
    /// @param share  of the points that are taken, spread evenly by their numbers
    NearPoints(const std::vector<Vector3>& points, double radius, double share) : points_(points), side_(radius) {
        const Box3 box = bounding_box(points);
        low_ = box.low;
        for (int a = 0; a < 3; ++a) boxes_[a] = static_cast<int>(box.side()[a] / side_) + 1;
        const auto limit = static_cast<std::uint32_t>(std::min(1.0, share) * 4294967295.0);
        std::vector<std::pair<std::size_t, int>> order;
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (static_cast<std::uint32_t>(i) * 2654435769U <= limit) {
                order.emplace_back(box_of(points[i]), static_cast<int>(i));
            }
        }
        std::sort(order.begin(), order.end());
        first_.assign(static_cast<std::size_t>(boxes_[0]) * boxes_[1] * boxes_[2] + 1, 0);
        for (const auto& [b, i] : order) {
            ++first_[b + 1];
            sorted_.push_back(i);
        }
        for (std::size_t b = 1; b < first_.size(); ++b) first_[b] += first_[b - 1];
    }
    /// Calls visit(index) for the points within the radius.
    template <class Visit>
    void for_each(const Vector3& x, Visit&& visit) const {
        std::array<int, 3> b;
        for (int a = 0; a < 3; ++a) b[a] = static_cast<int>((x[a] - low_[a]) / side_);
        for (int k = std::max(0, b[2] - 1); k <= std::min(boxes_[2] - 1, b[2] + 1); ++k) {
            for (int j = std::max(0, b[1] - 1); j <= std::min(boxes_[1] - 1, b[1] + 1); ++j) {
                const int i0 = std::max(0, b[0] - 1), i1 = std::min(boxes_[0] - 1, b[0] + 1);
                for (std::size_t s = first_[number(i0, j, k)]; s < first_[number(i1, j, k) + 1]; ++s) {
                    const Vector3 r = points_[sorted_[s]] - x;
                    if (dot(r, r) < side_ * side_) visit(sorted_[s]);
                }
            }
        }
    }

private:
    [[nodiscard]] std::size_t number(int i, int j, int k) const {
        return i + static_cast<std::size_t>(boxes_[0]) * (j + static_cast<std::size_t>(boxes_[1]) * k);
    }
    [[nodiscard]] std::size_t box_of(const Vector3& x) const {
        std::array<int, 3> b;
        for (int a = 0; a < 3; ++a) b[a] = std::min(static_cast<int>((x[a] - low_[a]) / side_), boxes_[a] - 1);
        return number(b[0], b[1], b[2]);
    }
    const std::vector<Vector3>& points_;
    double side_;
    Vector3 low_{};
    std::array<int, 3> boxes_{};
    std::vector<std::size_t> first_;
    std::vector<int> sorted_;
};

/// A quadric as a height over a plane through the point.
struct Fit {
    Vector3 origin{}, u{}, v{}, normal{};  ///< the plane and its normal
    std::array<double, 6> c{};             ///< height: c0 + c1 a + c2 b + c3 a^2 + c4 a b + c5 b^2 at a u + b v
    [[nodiscard]] double height_below(const Vector3& x) const {  ///< from x to the quadric, along the normal
        const double a = dot(x - origin, u), b = dot(x - origin, v);
        return c[0] + a * (c[1] + c[3] * a + c[4] * b) + b * (c[2] + c[5] * b) - dot(x - origin, normal);
    }
    [[nodiscard]] double bending(const Vector3& edge) const {  ///< second derivative along an edge times its length^2
        const double a = dot(edge, u), b = dot(edge, v);
        return 2.0 * (c[3] * a * a + c[4] * a * b + c[5] * b * b);
    }
    double residual = 0.0;  ///< root mean square, corrected for the six coefficients
    double count = 0.0;     ///< points, as weighted
    double spread = 0.0;    ///< standard deviation of height, of points that deviate by 1
};

std::optional<Fit> fit(const std::vector<Vector3>& points, const std::vector<Vector3>& normals, std::size_t point,
                       const NearPoints& near, double radius) {
    const Vector3& x = points[point];
    thread_local std::vector<int> members;
    members.clear();
    Vector3 n{};
    near.for_each(x, [&](int i) {
        if (dot(normals[i], normals[point]) > same_side) members.push_back(i), n = n + normals[i];
    });
    const double length = norm(n);
    if (members.size() < 12 || !(length > 0)) return std::nullopt;
    n = (1.0 / length) * n;
    const int smallest = static_cast<int>(
        std::min_element(n.begin(), n.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }) - n.begin());
    Vector3 e{};
    e[smallest] = 1.0;
    Vector3 u = cross(n, e);
    u = (1.0 / norm(u)) * u;
    const Vector3 v = cross(n, u);
    Eigen::Matrix<double, 6, 6> system = Eigen::Matrix<double, 6, 6>::Zero(), twice = system;
    Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
    double weights = 0.0, squares = 0.0, heights2 = 0.0;
    for (const int i : members) {
        if (dot(normals[i], n) < same_side) continue;  // beyond an edge, or the far side of a thin part
        const Vector3 r = (1.0 / radius) * (points[i] - x);
        const double w = 1.0 - dot(r, r), a = dot(r, u), b = dot(r, v), z = dot(r, n);
        Eigen::Matrix<double, 6, 1> row;
        row << 1.0, a, b, a * a, a * b, b * b;
        system.noalias() += w * row * row.transpose();
        twice.noalias() += w * w * row * row.transpose();
        right += w * z * row;
        heights2 += w * z * z;
        weights += w;
        squares += w * w;
    }
    Fit result;
    result.count = squares > 0 ? weights * weights / squares : 0.0;
    if (result.count < 9.0) return std::nullopt;
    system.diagonal().array() += 1e-9 * weights;
    const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> solver(system);
    const Eigen::Matrix<double, 6, 1> c = solver.solve(right);
    const Eigen::Matrix<double, 6, 1> share = solver.solve(Eigen::Matrix<double, 6, 1>::Unit(0));
    result.spread = std::sqrt(std::max(0.0, share.dot(twice * share)));
    result.normal = n;
    result.origin = x, result.u = u, result.v = v;
    const double k = 1.0 / radius;
    result.c = {radius * c[0], c[1], c[2], k * c[3], k * c[4], k * c[5]};
    const double error = std::max(0.0, heights2 - c.dot(right)) / weights;
    result.residual = radius * std::sqrt(error * result.count / (result.count - 6.0));
    return result;
}

/// Radius of a disk that holds about so many points.
double radius_for(const TriangleMesh& mesh, double count) {
    return std::sqrt(count * surface_area(mesh) / (std::numbers::pi * static_cast<double>(mesh.points.size())));
}

}  // namespace

double roughness(const TriangleMesh& mesh) {
    if (mesh.points.size() < 200) return 0.0;  // a coarse model, not a scan
    const double radius = radius_for(mesh, 25);
    const NearPoints near(mesh.points, radius, 1.0);
    const std::vector<Vector3> normals = point_normals(mesh);
    const std::size_t stride = mesh.points.size() / 3000 + 1;
    std::vector<double> residuals((mesh.points.size() + stride - 1) / stride, -1.0);
    tbb::parallel_for(std::size_t{0}, residuals.size(), [&](std::size_t s) {
        interruption_point();
        if (const auto f = fit(mesh.points, normals, s * stride, near, radius)) residuals[s] = f->residual;
    });
    std::erase_if(residuals, [](double r) { return r < 0; });
    if (residuals.size() < 50) return 0.0;
    const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
    std::nth_element(residuals.begin(), middle, residuals.end());
    return *middle;
}

double bump_correlation(const TriangleMesh& mesh, double least) {
    const std::vector<Vector3> normals = point_normals(mesh);
    const std::vector<std::vector<int>> neighbours = neighbours_of(mesh);
    std::vector<double> bump(mesh.points.size(), 0.0), sizes;
    for (std::size_t i = 0; i < bump.size(); ++i) {
        if (neighbours[i].empty()) continue;
        Vector3 sum{};
        for (const int j : neighbours[i]) sum = sum + mesh.points[j];
        bump[i] = dot(normals[i], mesh.points[i] - (1.0 / static_cast<double>(neighbours[i].size())) * sum);
        sizes.push_back(std::abs(bump[i]));
    }
    if (sizes.empty()) return 1.0;
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    if (*middle < least) return 1.0;
    const double largest = 4.0 * *middle;  // what stands out more, as edges do, counts no more than this
    double products = 0.0, squares = 0.0;
    std::size_t pairs = 0, points = 0;
    for (std::size_t i = 0; i < bump.size(); ++i) {
        if (neighbours[i].empty()) continue;
        const double own = std::clamp(bump[i], -largest, largest);
        for (const int j : neighbours[i]) products += own * std::clamp(bump[j], -largest, largest);
        pairs += neighbours[i].size();
        squares += own * own;
        ++points;
    }
    if (!(squares > 0.0)) return 1.0;
    return products / static_cast<double>(pairs) / (squares / static_cast<double>(points));
}

void smooth_noise(TriangleMesh& mesh, double noise) {
    const std::vector<Vector3> normals = point_normals(mesh);
    const std::size_t count = mesh.points.size();
    const double last = widest * bounding_box(mesh.points).diagonal();
    struct Estimate {
        Fit fit;
        double low = -1e300, high = 1e300;  ///< common to the confidence intervals of all neighbourhoods so far
        int size = -1;                      ///< number of the neighbourhood; -1: none yet
        bool is_final = false;
    };
    std::vector<Estimate> estimates(count);
    const double first = radius_for(mesh, 16);
    std::vector<double> radii{first};
    while (radii.back() * growth < last) radii.push_back(radii.back() * growth);
    const auto near_points = [&](double radius) {
        const double held = 16.0 * (radius / first) * (radius / first);
        return NearPoints(mesh.points, radius, static_cast<double>(most_neighbours) / held);
    };
    for (std::size_t size = 0; size < radii.size(); ++size) {
        const NearPoints near = near_points(radii[size]);
        tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
            interruption_point(i, 64);
            Estimate& e = estimates[i];
            if (e.is_final) return;
            const auto f = fit(mesh.points, normals, i, near, radii[size]);
            if (!f) return;  // too few neighbours yet
            const double deviation = noise * f->spread;
            const double low = std::max(e.low, f->c[0] - deviation), high = std::min(e.high, f->c[0] + deviation);
            const bool fits = f->residual <= noise * (1.0 + excess / std::sqrt(2.0 * (f->count - 6.0)));
            if (e.size >= 0 && (low > high || !fits)) {
                e.is_final = true;
                return;
            }
            e.low = low, e.high = high, e.fit = *f, e.size = static_cast<int>(size);
        });
    }
    // Each point goes to the mean of what the quadrics around it say.
    std::vector<Vector3> moved = mesh.points;
    for (std::size_t size = 0; size < radii.size(); ++size) {
        const NearPoints near = near_points(radii[size]);
        tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
            interruption_point(i, 64);
            const Estimate& own = estimates[i];
            if (own.size != static_cast<int>(size)) return;
            const Vector3& x = mesh.points[i];
            Vector3 sum{};
            double weights = 0.0;
            near.for_each(x, [&](int j) {
                const Estimate& other = estimates[j];
                if (other.size < 0 || dot(other.fit.normal, own.fit.normal) < 0.5) return;
                const Vector3 r = x - mesh.points[j];
                const double radius = radii[other.size], closeness = 1.0 - dot(r, r) / (radius * radius);
                if (closeness <= 0.0) return;
                const double w = closeness * closeness / (other.fit.spread * other.fit.spread);
                sum = sum + (w * other.fit.height_below(x)) * other.fit.normal;
                weights += w;
            });
            if (weights > 0.0) moved[i] = x + (1.0 / weights) * sum;
        });
    }
    // Flat triangles between points of a bent surface cut corners: the points move out by what their triangles lack on
    // average, so that the volume is right (the mean of a quadric over a triangle against its plane).
    std::vector<double> lack(count, 0.0), area(count, 0.0);
    mesh.points = moved;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto c = mesh.corners(t);
        const double a = norm(area_vector(c));
        for (const int p : mesh.triangles[t]) {
            if (estimates[p].size < 0) continue;
            double bends = 0.0;
            for (int e = 0; e < 3; ++e) bends += estimates[p].fit.bending(c[(e + 1) % 3] - c[e]);
            lack[p] -= a * bends / 24.0;
            area[p] += a;
        }
    }
    for (std::size_t i = 0; i < count; ++i) {
        if (area[i] > 0.0) mesh.points[i] = mesh.points[i] + (lack[i] / area[i]) * estimates[i].fit.normal;
    }
}

namespace {

using Laplacian = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// Of each point that matters, its difference from the mean of its neighbours [points x points].
Laplacian equal_weights(const std::vector<std::vector<int>>& neighbours, const std::vector<char>& matters) {
    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i < static_cast<int>(neighbours.size()); ++i) {
        if (!matters[i]) continue;
        entries.emplace_back(i, i, 1.0);
        for (const int j : neighbours[i]) entries.emplace_back(i, j, -1.0 / static_cast<double>(neighbours[i].size()));
    }
    const auto size = static_cast<Eigen::Index>(neighbours.size());
    Laplacian result(size, size);
    result.setFromTriplets(entries.begin(), entries.end());
    return result;
}

/// The same with the weights that the triangles as they lie give: its squares add up to the square of the mean
/// curvature, integrated over the surface (Pinkall and Polthier 1993; Desbrun et al. 1999).
Laplacian cotangent_weights(const TriangleMesh& mesh, const std::vector<char>& matters) {
    constexpr double least_weight = 0.02, least_area = 0.05;  // thin triangles must not turn or outweigh the others
    std::vector<Eigen::Triplet<double>> entries;
    std::vector<double> area(mesh.points.size(), 0.0);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& corner = mesh.triangles[t];
        if (!matters[corner[0]] && !matters[corner[1]] && !matters[corner[2]]) continue;
        const auto c = mesh.corners(t);
        const double twice_area = norm(area_vector(c));
        for (int a = 0; a < 3; ++a) {
            const int i = corner[(a + 1) % 3], j = corner[(a + 2) % 3];
            const Vector3 u = c[(a + 1) % 3] - c[a], v = c[(a + 2) % 3] - c[a];
            const double weight = 0.5 * dot(u, v) / std::max(twice_area, 1e-3 * (dot(u, u) + dot(v, v)));
            entries.emplace_back(i, j, weight);
            entries.emplace_back(j, i, weight);
            area[corner[a]] += twice_area / 6.0;
        }
    }
    const auto size = static_cast<Eigen::Index>(mesh.points.size());
    Laplacian weights(size, size);
    weights.setFromTriplets(entries.begin(), entries.end());
    double mean_area = 0.0;
    for (std::size_t i = 0; i < area.size(); ++i) mean_area += matters[i] ? area[i] : 0.0;
    mean_area /= static_cast<double>(std::count(matters.begin(), matters.end(), 1));
    entries.clear();
    for (int i = 0; i < static_cast<int>(size); ++i) {
        if (!matters[i]) continue;
        const double scale = 1.0 / std::sqrt(std::max(area[i], least_area * mean_area));
        double sum = 0.0;
        for (Laplacian::InnerIterator entry(weights, i); entry; ++entry) {
            const double weight = scale * std::max(entry.value(), least_weight);
            entries.emplace_back(i, static_cast<int>(entry.col()), -weight);
            sum += weight;
        }
        entries.emplace_back(i, i, sum);
    }
    Laplacian result(size, size);
    result.setFromTriplets(entries.begin(), entries.end());
    return result;
}

/// Moves the unknown points to where the squares of the Laplacian are least.
/// @param unknown  their numbers, -1 for the others [points]
/// @return  false if that cannot be computed; then nothing has moved
bool minimise_bending(TriangleMesh& mesh, const Laplacian& laplacian, const std::vector<int>& unknown, int count) {
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(laplacian.rows(), 3);
    for (int i = 0; i < static_cast<int>(laplacian.rows()); ++i) {
        for (Laplacian::InnerIterator entry(laplacian, i); entry; ++entry) {
            const auto j = static_cast<std::size_t>(entry.col());
            if (unknown[j] >= 0) {
                entries.emplace_back(i, unknown[j], entry.value());
            } else {
                for (int a = 0; a < 3; ++a) right(i, a) -= entry.value() * mesh.points[j][a];
            }
        }
    }
    Eigen::SparseMatrix<double> differences(laplacian.rows(), count);
    differences.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(
        Eigen::SparseMatrix<double>(differences.transpose() * differences));
    if (solver.info() != Eigen::Success) return false;
    const Eigen::MatrixX3d moved = solver.solve(differences.transpose() * right);
    if (!moved.allFinite()) return false;
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        if (unknown[i] < 0) continue;
        for (int a = 0; a < 3; ++a) mesh.points[i][a] = moved(unknown[i], a);
    }
    return true;
}

}  // namespace

void fair(TriangleMesh& mesh, const std::vector<char>& is_free) {
    const std::vector<std::vector<int>> neighbours = neighbours_of(mesh);
    std::vector<int> unknown(mesh.points.size(), -1);
    int count = 0;
    // Free points that hang together with held ones; others have nothing that says where they belong.
    std::vector<int> queue;
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        if (!is_free[i]) queue.push_back(static_cast<int>(i));
    }
    for (std::size_t q = 0; q < queue.size(); ++q) {
        for (const int j : neighbours[queue[q]]) {
            if (is_free[j] && unknown[j] < 0) unknown[j] = count++, queue.push_back(j);
        }
    }
    if (count == 0) return;
    std::vector<char> matters(mesh.points.size(), 0);  // free points and those next to one
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        const auto& list = neighbours[i];
        matters[i] = unknown[i] >= 0 || std::any_of(list.begin(), list.end(), [&](int j) { return unknown[j] >= 0; });
    }
    // Equal weights take no account of the bulge that they make: on it the triangles are larger and the lid ends too
    // flat. Weights of the triangles as they now lie mend that. Done again and again they blow bubbles where the rim is
    // rough.
    if (minimise_bending(mesh, equal_weights(neighbours, matters), unknown, count)) {
        minimise_bending(mesh, cotangent_weights(mesh, matters), unknown, count);
    }
}

}  // namespace morphodesic::datasets

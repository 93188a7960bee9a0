#include "analysis/procrustes.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace morphodesic::analysis {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

RowMajor as_matrix(const Embedding& e) {
    return Eigen::Map<const RowMajor>(e.coordinates.data(), static_cast<Eigen::Index>(e.size()),
                                      static_cast<Eigen::Index>(e.dimensions));
}

double raw_stress(const RowMajor& points, const Eigen::VectorXd& d, const Eigen::RowVectorXd& x) {
    return ((points.rowwise() - x).rowwise().norm() - d).squaredNorm();
}

}  // namespace

Procrustes procrustes(const Embedding& reference, const Embedding& moved, bool allow_scaling) {
    if (reference.dimensions != moved.dimensions || reference.size() != moved.size()) {
        throw std::invalid_argument("Procrustes: the embeddings differ in points or dimensions");
    }
    Procrustes result{moved, 1.0, 0.0};
    if (reference.size() == 0) return result;
    RowMajor x = as_matrix(reference), y = as_matrix(moved);
    const Eigen::RowVectorXd x_mean = x.colwise().mean(), y_mean = y.colwise().mean();
    x.rowwise() -= x_mean;
    y.rowwise() -= y_mean;
    const Eigen::MatrixXd cross = y.transpose() * x;
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::MatrixXd turn = svd.matrixU() * svd.matrixV().transpose();
    if (allow_scaling && y.squaredNorm() > 0.0) result.scale = svd.singularValues().sum() / y.squaredNorm();
    const RowMajor fitted = result.scale * y * turn;
    result.rms_distance = std::sqrt((fitted - x).squaredNorm() / static_cast<double>(reference.size()));
    Eigen::Map<RowMajor>(result.aligned.coordinates.data(), fitted.rows(), fitted.cols()) = fitted.rowwise() + x_mean;
    return result;
}

Placement place_query(const Embedding& embedding, std::span<const double> query_distances) {
    if (query_distances.size() != embedding.size()) {
        throw std::invalid_argument("one distance per item of the embedding is needed");
    }
    const RowMajor all = as_matrix(embedding);
    std::vector<Eigen::Index> known;
    for (std::size_t j = 0; j < query_distances.size(); ++j) {
        if (!std::isnan(query_distances[j])) known.push_back(static_cast<Eigen::Index>(j));
    }
    if (known.empty()) throw std::invalid_argument("the query has no known distance");
    const auto n = static_cast<Eigen::Index>(known.size());
    RowMajor points(n, all.cols());
    Eigen::VectorXd d(n);
    for (Eigen::Index j = 0; j < n; ++j) {
        points.row(j) = all.row(known[static_cast<std::size_t>(j)]);
        d(j) = query_distances[static_cast<std::size_t>(known[static_cast<std::size_t>(j)])];
    }
    const Eigen::RowVectorXd centroid = points.colwise().mean();
    const RowMajor centred = points.rowwise() - centroid;
    const Eigen::VectorXd squares = centred.rowwise().squaredNorm();
    // Gower 1968: exact if the distances are Euclidean in these dimensions.
    const Eigen::VectorXd b =
        0.5 * (squares - d.cwiseAbs2() + Eigen::VectorXd::Constant(n, (d.cwiseAbs2() - squares).mean()));
    const Eigen::RowVectorXd gower =
        centroid +
        (centred.transpose() * centred).completeOrthogonalDecomposition().solve(centred.transpose() * b).transpose();
    std::vector<Eigen::RowVectorXd> starts{gower, centroid};
    std::vector<Eigen::Index> by_distance(static_cast<std::size_t>(n));
    std::iota(by_distance.begin(), by_distance.end(), Eigen::Index{0});
    std::sort(by_distance.begin(), by_distance.end(),
              [&](Eigen::Index i, Eigen::Index j) { return d(i) != d(j) ? d(i) < d(j) : i < j; });
    for (std::size_t k = 0; k < std::min<std::size_t>(5, by_distance.size()); ++k) {
        const Eigen::Index i = by_distance[k];
        starts.emplace_back(points.row(i));
        // and the mirror image on the far side, where a local minimum may hide a better one
        starts.emplace_back(2.0 * points.row(i) - gower);
    }
    Eigen::RowVectorXd best = starts.front();
    double best_stress = std::numeric_limits<double>::infinity();
    const double size = std::sqrt(squares.maxCoeff()) + d.maxCoeff();
    for (Eigen::RowVectorXd x : starts) {
        for (int iteration = 0; iteration < 500; ++iteration) {
            Eigen::RowVectorXd next = centroid;
            for (Eigen::Index j = 0; j < n; ++j) {
                const Eigen::RowVectorXd away = x - points.row(j);
                const double length = away.norm();
                if (length > 0.0) {
                    next += d(j) / length / static_cast<double>(n) * away;
                } else if (d(j) > 0.0) {
                    next(0) += d(j) / static_cast<double>(n);  // on top of an item: any direction will do
                }
            }
            const double step = (next - x).norm();
            x = next;
            if (step <= 1e-10 * size) break;
        }
        if (const double stress = raw_stress(points, d, x); stress < best_stress) {
            best_stress = stress;
            best = x;
        }
    }
    const double scale = d.squaredNorm();
    return {{best.data(), best.data() + best.size()}, scale > 0.0 ? std::sqrt(best_stress / scale) : 0.0};
}

}  // namespace morphodesic::analysis

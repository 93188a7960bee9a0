#include "analysis/mds.h"

#include <Spectra/SymEigsSolver.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "analysis/parallel.h"

namespace morphodesic::analysis {
namespace {

constexpr std::size_t dense_limit = 400, listed_eigenvalues = 10;

struct Spectrum {
    Eigen::VectorXd values;   // decreasing
    Eigen::MatrixXd vectors;  // columns
};

Spectrum dense_spectrum(const Eigen::MatrixXd& b, std::size_t count) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(b);
    const auto k = static_cast<Eigen::Index>(count);
    return {solver.eigenvalues().tail(k).reverse(), solver.eigenvectors().rightCols(k).rowwise().reverse()};
}

/// y = B x with rows shared among the threads; every entry is one dot product, so the bits stay the same.
class RowProduct {
public:
    using Scalar = double;
    explicit RowProduct(const Eigen::MatrixXd& b) : b_(b) {}
    [[nodiscard]] Eigen::Index rows() const { return b_.rows(); }
    [[nodiscard]] Eigen::Index cols() const { return b_.cols(); }
    void perform_op(const double* x_in, double* y_out) const {
        const Eigen::Map<const Eigen::VectorXd> x(x_in, b_.cols());
        parallel_for_each_index(static_cast<std::size_t>(b_.cols()), 64, [&](std::size_t i) {
            y_out[i] = b_.col(static_cast<Eigen::Index>(i)).dot(x);  // symmetric: columns are rows
        });
    }

private:
    const Eigen::MatrixXd& b_;
};

Spectrum partial_spectrum(const Eigen::MatrixXd& b, std::size_t count) {
    RowProduct product(b);
    const auto k = static_cast<Eigen::Index>(count);
    Spectra::SymEigsSolver<RowProduct> largest(product, k, 4 * k + 20);
    largest.init();
    largest.compute(Spectra::SortRule::LargestAlge, 300, 1e-10, Spectra::SortRule::LargestAlge);
    if (largest.info() != Spectra::CompInfo::Successful) return dense_spectrum(b, count);  // slower, the same numbers
    return {largest.eigenvalues(), largest.eigenvectors()};
}

void make_largest_entry_positive(Eigen::Ref<Eigen::VectorXd> column) {
    if (column.size() == 0) return;
    Eigen::Index at = 0;
    const double largest = column.cwiseAbs().maxCoeff();
    // The first of those that are equally large up to rounding, so that mirror images of a symmetric set agree.
    while (std::abs(column(at)) < largest * (1.0 - 1e-9)) ++at;
    if (column(at) < 0.0) column = -column;
}

}  // namespace

std::vector<double> embedded_distances(const Embedding& embedding) {
    const std::size_t n = embedding.size(), dim = embedding.dimensions;
    std::vector<double> result(n < 2 ? 0 : n * (n - 1) / 2);
    parallel_for_each_index(n, 16, [&](std::size_t i) {
        for (std::size_t j = i + 1; j < n; ++j) {
            double square = 0.0;
            for (std::size_t axis = 0; axis < dim; ++axis) {
                const double difference = embedding(i, axis) - embedding(j, axis);
                square += difference * difference;
            }
            result[DistanceMatrix::condensed_index(n, i, j)] = std::sqrt(square);
        }
    });
    return result;
}

void orient_to_principal_axes(Embedding& embedding) {
    const auto n = static_cast<Eigen::Index>(embedding.size()), dim = static_cast<Eigen::Index>(embedding.dimensions);
    if (n == 0) return;
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<RowMajor> points(embedding.coordinates.data(), n, dim);
    points.rowwise() -= points.colwise().mean().eval();
    const Eigen::MatrixXd covariance = points.transpose() * points;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
    Eigen::MatrixXd turned = points * solver.eigenvectors().rowwise().reverse();
    for (Eigen::Index axis = 0; axis < dim; ++axis) make_largest_entry_positive(turned.col(axis));
    points = turned;
}

ClassicalScaling classical_mds(const DistanceMatrix& distances, std::size_t dimensions) {
    if (dimensions == 0) throw std::invalid_argument("an embedding needs at least one dimension");
    if (distances.missing_count() > 0)
        throw std::invalid_argument("classical scaling needs all distances; fill the gaps first");
    const std::size_t items = distances.size();
    const auto n = static_cast<Eigen::Index>(items);
    ClassicalScaling result;
    result.embedding = {dimensions, std::vector<double>(items * dimensions, 0.0)};
    if (items < 2) return result;
    Eigen::MatrixXd b(n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
        for (Eigen::Index i = 0; i < n; ++i) {
            const double d = distances(static_cast<std::size_t>(i), static_cast<std::size_t>(j));
            b(i, j) = -0.5 * d * d;
        }
    }
    const Eigen::VectorXd row_mean = b.rowwise().mean();
    const double total_mean = row_mean.mean();
    for (Eigen::Index j = 0; j < n; ++j) b.col(j).array() -= row_mean.array() + row_mean(j) - total_mean;
    if (b.squaredNorm() == 0.0) return result;
    const std::size_t wanted = std::min(items, std::max(dimensions, listed_eigenvalues));
    const Spectrum spectrum = items <= dense_limit ? dense_spectrum(b, wanted) : partial_spectrum(b, wanted);
    result.eigenvalues.assign(spectrum.values.data(), spectrum.values.data() + spectrum.values.size());
    for (std::size_t axis = 0; axis < std::min(dimensions, wanted); ++axis) {
        const double value = result.eigenvalues[axis];
        // Below the rounding of B an eigenvalue is a zero.
        if (value <= 1e-12 * result.eigenvalues.front()) continue;
        Eigen::VectorXd column = spectrum.vectors.col(static_cast<Eigen::Index>(axis)) * std::sqrt(value);
        make_largest_entry_positive(column);
        for (std::size_t i = 0; i < items; ++i) {
            result.embedding.coordinates[i * dimensions + axis] = column(static_cast<Eigen::Index>(i));
        }
    }
    return result;
}

}  // namespace morphodesic::analysis

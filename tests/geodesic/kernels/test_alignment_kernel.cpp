#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "geodesic/energy/heaviside.h"
#include "geodesic/grid/q1_element.h"
#include "geodesic/kernels/alignment_kernel.h"
#include "tests/support/path_problems.h"

namespace morphodesic {
namespace {

template <class T>
class AlignmentKernelIn : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(AlignmentKernelIn, Dimensions);

/// A box laid on a turned one, so far out that a part of the places lies beyond the cube.
template <int Dim>
struct AlignmentProblem {
    using Vector = Eigen::Matrix<double, Dim, 1>;
    using Matrix = Eigen::Matrix<double, Dim, Dim>;
    static constexpr int unknowns = kernels::motion_unknowns<Dim>;

    static Point<Dim> cut(const Point<3>& x) {
        Point<Dim> y;
        std::copy_n(x.begin(), Dim, y.begin());
        return y;
    }
    LevelSet<Dim> a = tests::turned_box<Dim>(4, cut({0.25, 0.12, 0.1}), cut({0.7, 0.5, 0.5}), 0.1);
    LevelSet<Dim> b = tests::turned_box<Dim>(4, cut({0.2, 0.16, 0.14}), cut({0.5, 0.5, 0.5}), 0.4);
    double eps = a.grid.spacing();
    Matrix rotation = Matrix::Identity();
    Vector translation = Vector::Constant(0.03);

    AlignmentProblem() { rotation.template topLeftCorner<2, 2>() = Eigen::Rotation2D<double>(0.3).toRotationMatrix(); }

    /// Where x lies in the first shape after a further small motion: back (exp(-w) z - t), z = x - c - t0.
    [[nodiscard]] Vector place(const Vector& z, const Eigen::VectorXd& change) const {
        Vector turned;
        if constexpr (Dim == 2) {
            turned = Eigen::Rotation2D<double>(-change(0)) * z;
        } else {
            const Eigen::Vector3d w = change.head<3>();
            turned = w.norm() > 0 ? Vector(Eigen::AngleAxisd(-w.norm(), w.normalized()) * z) : z;
        }
        return rotation.transpose() * (turned - change.tail<Dim>()) + Vector::Constant(0.5);
    }
    [[nodiscard]] Vector from_centre(std::size_t node) const {
        const auto x = b.grid.position(b.grid.node(node));
        return Eigen::Map<const Vector>(x.data()) - Vector::Constant(0.5) - translation;
    }

    /// Sums of every `count` nodes in turn.
    [[nodiscard]] std::vector<kernels::AlignmentSums<Dim>> parts(std::size_t count, const Eigen::VectorXd& change,
                                                                 bool derivatives) const {
        std::vector<double> target(b.values.size());
        for (std::size_t i = 0; i < target.size(); ++i) target[i] = smooth_heaviside(b.values[i], eps);
        const Vector step = place(from_centre(1), change) - place(from_centre(0), change);
        kernels::AlignmentRow<Dim> row{};
        row.field = a.values.data();
        row.count = count;
        row.spacing = a.grid.spacing();
        row.eps = eps;
        row.rotate = true;
        std::vector<kernels::AlignmentSums<Dim>> result;
        for (std::size_t first = 0; first < target.size(); first += count) {
            const Vector z = from_centre(first), y = place(z, change);
            for (int c = 0; c < Dim; ++c) {
                row.cells[c] = a.grid.cells(c);
                row.first[c] = y(c) * a.grid.cells_per_unit();
                row.step[c] = step(c) * a.grid.cells_per_unit();
                row.from_centre[c] = z(c);
                for (int d = 0; d < Dim; ++d) row.rotation[c][d] = rotation(c, d);
            }
            row.target = target.data() + first;
            kernels::add_row<Dim>(row, derivatives, result.emplace_back());
        }
        return result;
    }
    [[nodiscard]] static kernels::AlignmentSums<Dim> sum_of(const std::vector<kernels::AlignmentSums<Dim>>& parts) {
        kernels::AlignmentSums<Dim> total;
        for (const auto& part : parts) {
            total.square += part.square;
            for (int i = 0; i < unknowns; ++i) {
                total.force[i] += part.force[i];
                for (int j = 0; j <= i; ++j) total.product[i][j] += part.product[i][j];
            }
        }
        return total;
    }
    [[nodiscard]] kernels::AlignmentSums<Dim> sums(const Eigen::VectorXd& change, bool derivatives) const {
        return sum_of(parts(static_cast<std::size_t>(a.grid.nodes(0)), change, derivatives));
    }
};

TYPED_TEST(AlignmentKernelIn, AgreesWithTheFormulas) {
    constexpr int dim = TypeParam::value;
    const AlignmentProblem<dim> problem;
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(AlignmentProblem<dim>::unknowns);
    double expected = 0.0;
    int beyond = 0;
    for (std::size_t i = 0; i < problem.b.values.size(); ++i) {
        const auto y = problem.place(problem.from_centre(i), none);
        Point<dim> at{};
        double outside = 0.0;
        for (int c = 0; c < dim; ++c) {
            at[static_cast<std::size_t>(c)] = y(c);
            outside = std::hypot(outside, y(c) - std::clamp(y(c), 0.0, 1.0));
        }
        beyond += outside > 0 ? 1 : 0;
        const double u = q1::value(problem.a.grid, problem.a.values.data(), at) - outside;
        expected += std::pow(smooth_heaviside(u, problem.eps) - smooth_heaviside(problem.b.values[i], problem.eps), 2);
    }
    EXPECT_GT(beyond, 10);
    EXPECT_NEAR(problem.sums(none, true).square, expected, 1e-11 * expected);
    EXPECT_EQ(problem.sums(none, true).square, problem.sums(none, false).square);
}

TYPED_TEST(AlignmentKernelIn, ForcesAreDifferencesOfTheMismatch) {
    // A Q1 field has kinks at the faces of cells, so a Taylor test has no order; central differences over a tenth of a
    // cell are good to a few percent.
    constexpr int dim = TypeParam::value, unknowns = AlignmentProblem<dim>::unknowns;
    const AlignmentProblem<dim> problem;
    const auto sums = problem.sums(Eigen::VectorXd::Zero(unknowns), true);
    const double scale = Eigen::Map<const Eigen::VectorXd>(sums.force, unknowns).norm();
    for (int i = 0; i < unknowns; ++i) {
        const Eigen::VectorXd step = 0.1 * problem.eps * Eigen::VectorXd::Unit(unknowns, i);
        const double difference = problem.sums(step, false).square - problem.sums(-step, false).square;
        EXPECT_NEAR(difference / (4 * step.norm()), sums.force[i], 0.04 * scale) << i;
    }
}

TYPED_TEST(AlignmentKernelIn, ProductsBoundTheForces) {
    constexpr int dim = TypeParam::value, unknowns = AlignmentProblem<dim>::unknowns;
    const auto sums = AlignmentProblem<dim>().sums(Eigen::VectorXd::Zero(unknowns), true);
    Eigen::MatrixXd product(unknowns, unknowns);
    Eigen::VectorXd force(unknowns);
    for (int i = 0; i < unknowns; ++i) {
        force(i) = sums.force[i];
        for (int j = 0; j <= i; ++j) product(i, j) = product(j, i) = sums.product[i][j];
    }
    // J J^T is positive, and (J^T r)^2 <= (J^T J) (r^T r) in every direction.
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(product);
    EXPECT_GT(solver.eigenvalues().minCoeff(), 0.0);
    for (int i = 0; i < unknowns; ++i) EXPECT_LE(force(i) * force(i), product(i, i) * sums.square) << i;
    EXPECT_LE(force.dot(product.ldlt().solve(force)), sums.square);
}

TYPED_TEST(AlignmentKernelIn, OneNodeHasTheProductOfItsDerivatives) {
    constexpr int dim = TypeParam::value, unknowns = AlignmentProblem<dim>::unknowns;
    const AlignmentProblem<dim> problem;
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(unknowns);
    const auto nodes = problem.parts(1, none, true);
    for (const auto& node : nodes) {  // r^2, r J and J J^T of one node
        for (int i = 0; i < unknowns; ++i) {
            for (int j = 0; j <= i; ++j) {
                const double expected = node.force[i] * node.force[j];
                ASSERT_NEAR(node.product[i][j] * node.square, expected, 1e-12 * std::abs(expected) + 1e-30);
            }
        }
    }
    // Rows are no whole number of vectors; what is beyond them does not count.
    const auto single = problem.sum_of(nodes), whole = problem.sums(none, true);
    EXPECT_NEAR(single.square, whole.square, 1e-12 * whole.square);
    for (int i = 0; i < unknowns; ++i) {
        EXPECT_NEAR(single.force[i], whole.force[i], 1e-10 * std::abs(whole.force[0])) << i;
        for (int j = 0; j <= i; ++j) {
            EXPECT_NEAR(single.product[i][j], whole.product[i][j], 1e-10 * whole.product[0][0]) << i << j;
        }
    }
}

}  // namespace
}  // namespace morphodesic

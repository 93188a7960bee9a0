#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "geodesic/energy/stored_energy_density.h"

namespace morphodesic {
namespace {

template <class T>
class StoredEnergyDensity : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(StoredEnergyDensity, Dimensions);

template <int Dim>
using Matrix = Eigen::Matrix<double, Dim, Dim, Eigen::RowMajor>;

template <int Dim>
double w_of(const Matrix<Dim>& a, double lambda, double mu) {
    const Matrix<Dim> b = a - Matrix<Dim>::Identity();
    std::array<double, Dim * Dim> entries;
    std::copy(b.data(), b.data() + Dim * Dim, entries.begin());
    return stored_energy_density<Dim>(entries, lambda, mu);
}

template <int Dim>
Matrix<Dim> random_matrix(std::mt19937& random) {
    std::normal_distribution<double> normal;
    Matrix<Dim> m;
    for (int i = 0; i < Dim * Dim; ++i) m.data()[i] = normal(random);
    return m;
}

template <int Dim>
Matrix<Dim> random_rotation(std::mt19937& random) {
    Matrix<Dim> q = Eigen::HouseholderQR<Matrix<Dim>>(random_matrix<Dim>(random)).householderQ();
    if (q.determinant() < 0) q.row(0) *= -1.0;
    return q;
}

TYPED_TEST(StoredEnergyDensity, VanishesAtRotations) {
    constexpr int dim = TypeParam::value;
    std::mt19937 random(1);
    for (int trial = 0; trial < 20; ++trial) EXPECT_NEAR(w_of<dim>(random_rotation<dim>(random), 3, 1), 0.0, 1e-14);
}

TYPED_TEST(StoredEnergyDensity, AgreesWithItsDefinition) {
    constexpr int dim = TypeParam::value;
    std::mt19937 random(2);
    for (int trial = 0; trial < 50; ++trial) {
        const Matrix<dim> a = Matrix<dim>::Identity() + 0.2 * random_matrix<dim>(random);
        const double det = a.determinant();
        if (det <= 0.05) continue;
        const double lambda = 3, mu = 1.5;
        const double expected = mu / 2 * a.squaredNorm() + lambda / 4 * det * det - (mu + lambda / 2) * std::log(det) -
                                dim * mu / 2 - lambda / 4;
        EXPECT_NEAR(w_of<dim>(a, lambda, mu), expected, 1e-12 * (1 + expected));
    }
}

TYPED_TEST(StoredEnergyDensity, IsInvariantAndIsotropic) {
    constexpr int dim = TypeParam::value;
    std::mt19937 random(3);
    for (int trial = 0; trial < 20; ++trial) {
        const Matrix<dim> a = Matrix<dim>::Identity() + 0.1 * random_matrix<dim>(random);
        const auto q = random_rotation<dim>(random), r = random_rotation<dim>(random);
        EXPECT_NEAR(w_of<dim>(q * a * r, 3, 1), w_of<dim>(a, 3, 1), 1e-12);
    }
}

TYPED_TEST(StoredEnergyDensity, SecondOrderPartIsTheDissipationRate) {
    constexpr int dim = TypeParam::value;
    std::mt19937 random(4);
    const double lambda = 3, mu = 1;
    for (int trial = 0; trial < 10; ++trial) {
        const Matrix<dim> b = random_matrix<dim>(random);
        const Matrix<dim> strain = 0.5 * (b + b.transpose());
        const double rate = lambda / 2 * strain.trace() * strain.trace() + mu * strain.squaredNorm();
        double last = 1e300;
        for (const double t : {1e-3, 1e-5, 1e-7}) {  // accurate far below the rounding of |A|^2
            const double error =
                std::abs(w_of<dim>(Matrix<dim>::Identity() + t * b, lambda, mu) / (t * t) - rate) / rate;
            EXPECT_LT(error, std::max(30 * t, 1e-8));
            EXPECT_LT(error, last);
            last = error + 1e-8;
        }
    }
}

TYPED_TEST(StoredEnergyDensity, InfiniteWhereItFolds) {
    constexpr int dim = TypeParam::value;
    Matrix<dim> a = Matrix<dim>::Identity();
    a(0, 0) = -0.5;
    EXPECT_EQ(w_of<dim>(a, 3, 1), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace morphodesic

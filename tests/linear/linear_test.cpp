// Decompositions against their own definitions, on matrices of every size that is compiled: what comes back multiplies
// to what went in.
#include <gtest/gtest.h>

#include "base/random.h"
#include "linear/positive.h"
#include "linear/qr.h"
#include "linear/solve.h"
#include "linear/svd.h"
#include "linear/symmetric_eigen.h"

namespace gonio::tests {
namespace {

using Matrix = Eigen::MatrixXd;

Matrix drawn(Eigen::Index rows, Eigen::Index columns, std::uint64_t seed) {
  Random random(seed, 1);
  Matrix m(rows, columns);
  for (double& x : m.reshaped()) x = random.normal();
  return m;
}
Matrix positive(Eigen::Index n, std::uint64_t seed) {
  const Matrix a = drawn(n + 3, n, seed);
  return a.transpose() * a;
}

template <int N>
void check_fixed_sizes() {
  using Fixed = Eigen::Matrix<double, N, N>;
  const Fixed a = positive(N, 10 + N);
  const linear::SymmetricEigen<Fixed> eigen(a);
  EXPECT_EQ(eigen.info(), Eigen::Success);
  EXPECT_LT((eigen.eigenvectors() * eigen.eigenvalues().asDiagonal() * eigen.eigenvectors().transpose() - a).norm(),
            1e-13 * a.norm())
      << N;
  EXPECT_LT((eigen.eigenvectors().transpose() * eigen.eigenvectors() - Fixed::Identity()).norm(), 1e-13) << N;
  for (int k = 1; k < N; ++k) EXPECT_LE(eigen.eigenvalues()[k - 1], eigen.eigenvalues()[k]) << N;
  const Eigen::Matrix<double, N, 1> b = drawn(N, 1, 50);
  EXPECT_LT((a * linear::solve_ldlt(a, b) - b).norm(), 1e-10 * b.norm()) << N;
}

TEST(Linear, FixedSizes) {
  check_fixed_sizes<2>();
  check_fixed_sizes<3>();
  check_fixed_sizes<4>();
  check_fixed_sizes<6>();
  check_fixed_sizes<8>();
  check_fixed_sizes<12>();
}

TEST(Linear, SymmetricMatricesOfAnySize) {
  for (const Eigen::Index n : {1, 2, 5, 17, 40}) {
    const Matrix a = positive(n, static_cast<std::uint64_t>(n));
    const linear::SymmetricEigen<Matrix> eigen(a), alone(a, Eigen::EigenvaluesOnly);
    EXPECT_LT((eigen.eigenvectors() * eigen.eigenvalues().asDiagonal() * eigen.eigenvectors().transpose() - a).norm(),
              1e-12 * a.norm());
    EXPECT_LT((alone.eigenvalues() - eigen.eigenvalues()).norm(), 1e-12 * a.norm());
    EXPECT_EQ(alone.eigenvectors().size(), 0);
    EXPECT_LT((linear::inverse(a) * a - Matrix::Identity(n, n)).norm(), 1e-8);
    const Matrix b = drawn(n, 3, 7);
    const linear::Ldlt ldlt(a);
    const linear::Llt llt(a);
    EXPECT_LT((a * ldlt.solve(b) - b).norm(), 1e-9 * b.norm());
    EXPECT_LT((a * llt.solve(b.col(0)) - b.col(0)).norm(), 1e-9 * b.norm());
    EXPECT_LT((llt.lower() * llt.lower().transpose() - a).norm(), 1e-12 * a.norm());
    EXPECT_LT((llt.lower() * llt.solve_lower(b) - b).norm(), 1e-10 * b.norm());
    EXPECT_LT((ldlt.root() * ldlt.root().transpose() - a).norm(), 1e-12 * a.norm());
    EXPECT_LT((llt.lower().diagonal() - llt.diagonal()).norm(), 1e-15);
  }
  EXPECT_EQ(linear::Llt(-Matrix::Identity(2, 2)).info(), Eigen::NumericalIssue);
}

TEST(Linear, SingularValuesByBothWays) {
  for (const auto& [rows, columns] : {std::pair<Eigen::Index, Eigen::Index>{3, 3}, {30, 7}, {7, 30}, {60, 40}}) {
    const Matrix a = drawn(rows, columns, static_cast<std::uint64_t>(rows));
    const unsigned thin = Eigen::ComputeThinU | Eigen::ComputeThinV;
    const linear::JacobiSvd<Matrix> jacobi(a, thin);
    const linear::DividedSvd divided(a, thin);
    EXPECT_LT((jacobi.matrixU() * jacobi.singularValues().asDiagonal() * jacobi.matrixV().transpose() - a).norm(),
              1e-12);
    EXPECT_LT((divided.matrixU() * divided.singularValues().asDiagonal() * divided.matrixV().transpose() - a).norm(),
              1e-12);
    EXPECT_LT((jacobi.singularValues() - divided.singularValues()).norm(), 1e-12);
    EXPECT_EQ(linear::DividedSvd(a).matrixU().size(), 0);
  }
}

TEST(Linear, LeastSquares) {
  const Matrix a = drawn(20, 4, 3), b = drawn(20, 2, 4);
  Matrix deficient(20, 5);
  deficient << a, a.col(0) + a.col(1);
  const linear::PivotedQr full(a), pivoted(deficient);
  EXPECT_EQ(full.rank(), 4);
  EXPECT_EQ(pivoted.rank(), 4);
  EXPECT_LT((a.transpose() * (b - a * full.solve(b))).norm(), 1e-12);
  EXPECT_LT((deficient.transpose() * (b - deficient * pivoted.solve(b))).norm(), 1e-12);
  const Matrix q = pivoted.orthonormal(4);
  EXPECT_LT((q.transpose() * q - Matrix::Identity(4, 4)).norm(), 1e-13);
  EXPECT_LT((deficient - q * (q.transpose() * deficient)).norm(), 1e-12);
  EXPECT_LT(pivoted.turned(deficient.col(2)).tail(16).norm(), 1e-12);
  const linear::LeastNorm shortest(deficient);
  const Eigen::VectorXd x = shortest.solve(b.col(0));
  EXPECT_EQ(shortest.rank(), 4);
  EXPECT_LT((deficient.transpose() * (b.col(0) - deficient * x)).norm(), 1e-12);
  Eigen::VectorXd open(5);  // what the columns cannot tell: no part of the shortest solution
  open << 1, 1, 0, 0, -1;
  EXPECT_LT(std::abs(open.dot(x)), 1e-13);
  EXPECT_LT((shortest.pseudo_inverse() * b.col(0) - x).norm(), 1e-12);
  const linear::HouseholderQr plain(a);
  EXPECT_LT((plain.thin_q() * plain.upper() - a).norm(), 1e-13 * a.norm());
}

TEST(Positive, InverseMultipliesToOneAndWhatIsSingularIsSaid) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Eigen::Matrix<double, 6, 6> a = positive(6, seed);
    std::array<double, 36> rows{}, inverse{};
    for (std::size_t k = 0; k < 36; ++k) rows[k] = a(static_cast<int>(k / 6), static_cast<int>(k % 6));
    ASSERT_TRUE(linear::positive_inverse<6>(rows, inverse));
    Eigen::Matrix<double, 6, 6> back;
    for (std::size_t k = 0; k < 36; ++k) back(static_cast<int>(k / 6), static_cast<int>(k % 6)) = inverse[k];
    EXPECT_LT((a * back - Matrix::Identity(6, 6)).norm(), 1e-9);
  }
  std::array<double, 9> flat{1, 1, 2, 1, 1, 2, 2, 2, 7}, none{};
  EXPECT_FALSE(linear::positive_inverse<3>(flat, none));
  EXPECT_FALSE(linear::positive_inverse<3>({-1, 0, 0, 0, 1, 0, 0, 0, 1}, none));
}

}  // namespace
}  // namespace gonio::tests

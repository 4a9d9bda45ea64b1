// Smooth robust polynomials through the cells of a class (contrast/cell_classes.h).
#include "contrast/cell_classes.h"

#include <Eigen/Dense>
#include <cmath>

#include "stats/intervals.h"

namespace gonio::contrast {
namespace {

constexpr double tukey = 4.685, huber = 1.345;

struct Rows {
  Eigen::MatrixXd terms;
  Eigen::VectorXd value, sigma;
};

double scatter_of(const Eigen::VectorXd& residual, double degrees) {
  std::vector<double> size(static_cast<std::size_t>(residual.size()));
  for (std::size_t i = 0; i < size.size(); ++i) size[i] = std::abs(residual(static_cast<Eigen::Index>(i)));
  const double n = static_cast<double>(size.size());
  return 1.4826 * stats::median(size) * std::sqrt(n / degrees);
}

Eigen::VectorXd weighted(const Rows& rows, const Eigen::VectorXd& weight, Eigen::MatrixXd* covariance) {
  const Eigen::MatrixXd normal = rows.terms.transpose() * weight.asDiagonal() * rows.terms;
  const auto solver = normal.ldlt();
  if (covariance != nullptr) *covariance = solver.solve(Eigen::MatrixXd::Identity(normal.rows(), normal.cols()));
  return solver.solve(rows.terms.transpose() * weight.asDiagonal() * rows.value);
}

struct Robust {
  Eigen::VectorXd coefficients;
  Eigen::MatrixXd covariance;
  double scatter = 0;
};

// Covariance: s^2 (X'WX)^-1 with the scatter s; weights of the biweight lie close to one where cells are alike.
Robust fit(const Rows& rows, double degrees) {
  Eigen::VectorXd weight = Eigen::VectorXd::Ones(rows.value.size());
  Robust robust;
  for (int round = 0; round < 30; ++round) {
    const Eigen::VectorXd before = robust.coefficients;
    robust.coefficients = weighted(rows, weight, &robust.covariance);
    const Eigen::VectorXd residual = rows.value - rows.terms * robust.coefficients;
    robust.scatter = scatter_of(residual, degrees);
    if (!(robust.scatter > 0)) break;  // the cells agree to the last digit
    if (round > 8 && (robust.coefficients - before).norm() < 1e-10 * robust.coefficients.norm()) break;
    for (Eigen::Index i = 0; i < residual.size(); ++i) {
      const double t = std::abs(residual(i)) / robust.scatter;
      weight(i) = round < 6   ? std::min(1.0, huber / std::max(t, 1e-300))
                  : t < tukey ? std::pow(1 - t * t / (tukey * tukey), 2)
                              : 0.0;
    }
  }
  robust.covariance *= robust.scatter * robust.scatter;
  return robust;
}

}  // namespace

int polynomial_order(std::size_t cells) {
  return cells >= 24 ? 2 : cells >= 9 ? 1 : 0;
}

std::vector<double> polynomial_terms(Vec2 place, int order) {
  std::vector<double> terms{1};
  if (order >= 1) terms.insert(terms.end(), {place.x, place.y});
  if (order >= 2) terms.insert(terms.end(), {place.x * place.x, place.x * place.y, place.y * place.y});
  return terms;
}

ClassFit fit_class(const CellPattern& pattern, const std::vector<std::size_t>& members,
                   const std::vector<double>& value, const std::vector<double>& sigma) {
  std::vector<std::size_t> used;
  for (const std::size_t cell : members)
    if (std::isfinite(value[cell])) used.push_back(cell);
  ClassFit result;
  result.cells = static_cast<int>(used.size());
  result.expected.assign(pattern.cells(), std::nan(""));
  if (used.empty()) return result;
  result.order = polynomial_order(used.size());
  const auto width = static_cast<Eigen::Index>(polynomial_terms({}, result.order).size());
  const auto row_of = [&](std::size_t cell) {
    const auto terms = polynomial_terms(pattern.place(cell), result.order);
    return Eigen::RowVectorXd(Eigen::Map<const Eigen::RowVectorXd>(terms.data(), width));
  };
  const auto n = static_cast<Eigen::Index>(used.size());
  Rows rows{Eigen::MatrixXd(n, width), Eigen::VectorXd(n), Eigen::VectorXd(n)};
  double stated = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::size_t cell = used[static_cast<std::size_t>(i)];
    rows.terms.row(i) = row_of(cell);
    rows.value(i) = value[cell];
    stated += sigma[cell] * sigma[cell] / static_cast<double>(n);
  }
  result.degrees = static_cast<double>(n - width);
  Robust robust = fit(rows, std::max(result.degrees, 1.0));
  if (result.degrees < 1) {
    weighted(rows, Eigen::VectorXd::Ones(n), &robust.covariance);
    robust.covariance *= stated;
    robust.scatter = std::sqrt(stated);
  }
  result.scatter = robust.scatter;
  Eigen::RowVectorXd mean = Eigen::RowVectorXd::Zero(width);
  for (std::size_t cell = 0; cell < pattern.cells(); ++cell) {
    const Eigen::RowVectorXd row = row_of(cell);
    result.expected[cell] = row * robust.coefficients;
    mean += row / static_cast<double>(pattern.cells());
  }
  result.mean = mean * robust.coefficients;
  result.sigma = std::sqrt((mean * robust.covariance * mean.transpose())(0, 0));
  return result;
}

}  // namespace gonio::contrast

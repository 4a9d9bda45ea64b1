// Smooth robust polynomials through the cells of a class (contrast/measure/cell_classes.h).
#include "contrast/measure/cell_classes.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "stats/intervals.h"

namespace gonio::contrast {
namespace {

constexpr double tukey = 4.685, huber = 1.345;

struct Rows {
  Eigen::MatrixXd terms;
  Eigen::VectorXd value;
};

Eigen::RowVectorXd row_of(const CellPattern& pattern, std::size_t cell, int order) {
  const auto terms = polynomial_terms(pattern.place(cell), order);
  return Eigen::Map<const Eigen::RowVectorXd>(terms.data(), static_cast<Eigen::Index>(terms.size()));
}
Eigen::MatrixXd terms_of(const CellPattern& pattern, const std::vector<std::size_t>& cells, int order) {
  Eigen::MatrixXd terms(static_cast<Eigen::Index>(cells.size()), row_of(pattern, 0, order).size());
  for (std::size_t i = 0; i < cells.size(); ++i)
    terms.row(static_cast<Eigen::Index>(i)) = row_of(pattern, cells[i], order);
  return terms;
}

double scatter_of(const Eigen::VectorXd& residual, double degrees) {
  const Eigen::VectorXd size = residual.cwiseAbs();
  const auto n = static_cast<std::size_t>(size.size());
  return stats::sigma_of_median * stats::median({size.data(), n}) * std::sqrt(static_cast<double>(n) / degrees);
}

using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;  // terms x terms
using Few = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 6, 1>;

struct Normal {
  Eigen::LDLT<Small> solver;
  Few right;
};
Normal normal_of(const Rows& rows, const Eigen::VectorXd& weight) {
  const auto width = rows.terms.cols();
  const Eigen::MatrixXd by_weight = weight.asDiagonal() * rows.terms;
  Small normal(width, width);
  for (Eigen::Index a = 0; a < width; ++a)
    for (Eigen::Index b = 0; b <= a; ++b) normal(a, b) = normal(b, a) = by_weight.col(a).dot(rows.terms.col(b));
  return {normal.ldlt(), by_weight.transpose() * rows.value};
}

struct Robust {
  Few coefficients;
  Eigen::VectorXd residual, weight;
  double scatter = 0;
  // s^2 (X'WX)^-1 with the scatter s; weights of the biweight lie close to one where cells are alike.
  Small covariance(const Rows& rows) const {
    const auto width = rows.terms.cols();
    return normal_of(rows, weight).solver.solve(Small::Identity(width, width)) * (scatter * scatter);
  }
};

// Until the coefficients change by less than `settled` of the scatter.
Robust fit(const Rows& rows, double degrees, double settled) {
  Robust robust;
  Eigen::VectorXd weight = Eigen::VectorXd::Ones(rows.value.size());
  for (int round = 0; round < 30; ++round) {
    const Few before = robust.coefficients;
    const Normal normal = normal_of(rows, weight);
    robust.weight = weight;
    robust.coefficients = normal.solver.solve(normal.right);
    robust.residual = rows.value - rows.terms * robust.coefficients;
    robust.scatter = scatter_of(robust.residual, degrees);
    if (!(robust.scatter > 0)) break;  // the cells agree to the last digit
    if (round > 8 && (robust.coefficients - before).norm() < settled * robust.scatter) break;
    for (Eigen::Index i = 0; i < robust.residual.size(); ++i) {
      const double t = std::abs(robust.residual(i)) / robust.scatter;
      weight(i) = round < 6   ? std::min(1.0, huber / std::max(t, 1e-300))
                  : t < tukey ? std::pow(1 - t * t / (tukey * tukey), 2)
                              : 0.0;
    }
  }
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
  const auto n = static_cast<Eigen::Index>(used.size());
  Rows rows{terms_of(pattern, used, result.order), Eigen::VectorXd(n)};
  const auto width = rows.terms.cols();
  double stated = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::size_t cell = used[static_cast<std::size_t>(i)];
    rows.value(i) = value[cell];
    stated += sigma[cell] * sigma[cell] / static_cast<double>(n);
  }
  result.degrees = static_cast<double>(n - width);
  Robust robust = fit(rows, std::max(result.degrees, 1.0), 1e-9);
  if (result.degrees < 1) {
    robust.weight.setOnes();
    robust.scatter = std::sqrt(stated);
  }
  const Small covariance = robust.covariance(rows);
  result.scatter = robust.scatter;
  Eigen::RowVectorXd mean = Eigen::RowVectorXd::Zero(width);
  for (std::size_t cell = 0; cell < pattern.cells(); ++cell) {
    const Eigen::RowVectorXd row = row_of(pattern, cell, result.order);
    result.expected[cell] = row * robust.coefficients;
    mean += row / static_cast<double>(pattern.cells());
  }
  result.mean = mean * robust.coefficients;
  result.sigma = std::sqrt((mean * covariance * mean.transpose())(0, 0));
  return result;
}

ClassShape::ClassShape(const CellPattern& pattern, const std::vector<std::size_t>& cells)
    : terms_(terms_of(pattern, cells, polynomial_order(cells.size()))) {}

Eigen::VectorXd ClassShape::deviations(const Eigen::VectorXd& values) const {
  constexpr double settled = 1e-3;  // of a scatter: finer than any draw of it
  const Robust robust = fit({terms_, values}, std::max(double(terms_.rows() - terms_.cols()), 1.0), settled);
  return robust.residual / std::max(robust.scatter, 1e-300);
}

}  // namespace gonio::contrast

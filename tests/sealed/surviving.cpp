#include "sealed/surviving.h"

#include <Eigen/Dense>
#include <cmath>

namespace gonio::sealed {
namespace {

constexpr double smallest = 1e-8;  // of a column's length that is a direction of its own

Eigen::Map<const Eigen::VectorXd> vector_of(const Numbers& v) {
  return {v.data(), static_cast<Eigen::Index>(v.size())};
}

// Orthonormal basis of the columns' span.
Eigen::MatrixXd basis_of(Eigen::MatrixXd columns) {
  for (Eigen::Index c = 0; c < columns.cols(); ++c)
    if (const double n = columns.col(c).norm(); n > 0) columns.col(c) /= n;
  if (columns.cols() == 0) return columns;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(columns);
  qr.setThreshold(smallest);
  Eigen::MatrixXd q = Eigen::MatrixXd::Identity(columns.rows(), qr.rank());
  q.applyOnTheLeft(qr.householderQ());
  return q;
}

}  // namespace

struct FreeParameters::Basis {
  Eigen::MatrixXd q;
  Eigen::VectorXd weight;
  std::vector<std::vector<Eigen::Index>> rows;  // of each stratum
  std::vector<Eigen::MatrixXd> own;             // orthonormal basis within it

  Eigen::VectorXd without_own(Eigen::VectorXd e) const {
    for (std::size_t s = 0; s < rows.size(); ++s) {
      const Eigen::VectorXd part = e(rows[s]);
      e(rows[s]) = part - own[s] * (own[s].transpose() * part);
    }
    return e;
  }
  void add_strata(const std::vector<std::size_t>& stratum, const std::vector<Numbers>& directions) {
    for (std::size_t i = 0; i < stratum.size(); ++i) {
      if (stratum[i] >= rows.size()) rows.resize(stratum[i] + 1);
      rows[stratum[i]].push_back(static_cast<Eigen::Index>(i));
    }
    for (const std::vector<Eigen::Index>& r : rows) {
      Eigen::MatrixXd d(static_cast<Eigen::Index>(r.size()), static_cast<Eigen::Index>(directions.size()));
      for (std::size_t k = 0; k < directions.size(); ++k)
        d.col(static_cast<Eigen::Index>(k)) = vector_of(directions[k])(r).cwiseProduct(weight(r));
      own.push_back(basis_of(std::move(d)));
    }
  }
};

FreeParameters::FreeParameters(const std::vector<Numbers>& columns, const Numbers& sigma,
                               const std::vector<std::size_t>& stratum, const std::vector<Numbers>& own)
    : basis_(std::make_unique<Basis>()) {
  basis_->weight = vector_of(sigma).cwiseInverse();
  basis_->add_strata(stratum, own);
  Eigen::MatrixXd all(static_cast<Eigen::Index>(sigma.size()), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t c = 0; c < columns.size(); ++c)
    all.col(static_cast<Eigen::Index>(c)) = basis_->without_own(vector_of(columns[c]).cwiseProduct(basis_->weight));
  basis_->q = basis_of(std::move(all));
}
FreeParameters::~FreeParameters() = default;
FreeParameters::FreeParameters(FreeParameters&&) noexcept = default;

Numbers FreeParameters::surviving(const Numbers& effect) const {
  Eigen::VectorXd e = basis_->without_own(vector_of(effect).cwiseProduct(basis_->weight));
  if (basis_->q.cols() > 0) e -= basis_->q * (basis_->q.transpose() * e);
  return {e.data(), e.data() + e.size()};
}

double length(const Numbers& v) {
  return vector_of(v).norm();
}

double left_beside(const Numbers& v, const std::vector<Numbers>& others) {
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(v.size()), static_cast<Eigen::Index>(others.size()));
  for (std::size_t c = 0; c < others.size(); ++c) columns.col(static_cast<Eigen::Index>(c)) = vector_of(others[c]);
  const Eigen::MatrixXd q = basis_of(std::move(columns));
  const Eigen::VectorXd e = vector_of(v);
  return (e - q * (q.transpose() * e)).norm();
}

}  // namespace gonio::sealed

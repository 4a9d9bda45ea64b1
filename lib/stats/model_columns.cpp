// See model_columns.h.
#include "stats/model_columns.h"

#include <cmath>

namespace gonio::stats {
namespace {

constexpr double tolerance = 1e-7;

double coded(int column, int level, int levels) {
  return level == column ? 1 : level == levels - 1 ? -1 : 0;
}

}  // namespace

ModelColumns::ModelColumns(const Design& design, const std::vector<Term>& terms) : terms_(terms) {
  for (const Factor& f : design.factors) levels_.push_back(static_cast<int>(f.levels.size()));
  for (const Term& t : terms) {
    int count = 1;
    for (const int f : t) count *= levels_[static_cast<std::size_t>(f)] - 1;
    blocks_.push_back({columns_, count});
    columns_ += count;
  }
}

Eigen::VectorXd ModelColumns::part(std::size_t term, std::span<const int> levels) const {
  Eigen::VectorXd row = Eigen::VectorXd::Ones(1);
  for (std::size_t i = 0; i < terms_[term].size(); ++i) {
    const int count = levels_[static_cast<std::size_t>(terms_[term][i])];
    Eigen::VectorXd longer(row.size() * (count - 1));
    for (Eigen::Index a = 0; a < row.size(); ++a)
      for (int c = 0; c + 1 < count; ++c) longer(a * (count - 1) + c) = row(a) * coded(c, levels[i], count);
    row = std::move(longer);
  }
  return row;
}

Eigen::MatrixXd ModelColumns::matrix(const Design& design) const {
  const auto n = static_cast<Eigen::Index>(design.y.size());
  Eigen::MatrixXd x(n, columns_);
  x.col(0).setOnes();
  std::vector<int> levels;
  for (std::size_t t = 0; t < terms_.size(); ++t)
    for (Eigen::Index i = 0; i < n; ++i) {
      levels.clear();
      for (const int f : terms_[t])
        levels.push_back(design.level[static_cast<std::size_t>(f)][static_cast<std::size_t>(i)]);
      x.row(i).segment(blocks_[t].first, blocks_[t].count) = part(t, levels).transpose();
    }
  return x;
}

Triangle triangle(Eigen::MatrixXd a) {
  const Eigen::Index n = a.rows(), p = a.cols();
  const Eigen::VectorXd norm = a.colwise().norm().transpose();
  Triangle result;
  std::vector<Eigen::VectorXd> reflectors;  // unit vectors v of 1 - 2 v v', from row k on
  Eigen::Index k = 0;
  for (Eigen::Index c = 0; c < p && k < n; ++c) {
    Eigen::VectorXd v = a.col(c).tail(n - k);
    const double length = v.norm();
    if (!(length > tolerance * norm(c))) continue;
    v(0) += v(0) < 0 ? -length : length;
    v.normalize();
    a.bottomRightCorner(n - k, p - c) -= 2 * v * (v.transpose() * a.bottomRightCorner(n - k, p - c)).eval();
    a.col(c).tail(n - k - 1).setZero();
    result.kept.push_back(static_cast<int>(c));
    reflectors.push_back(std::move(v));
    ++k;
  }
  result.r = a.topRows(k);
  result.q = Eigen::MatrixXd::Identity(n, k);
  for (Eigen::Index i = k; i-- > 0;) {
    const Eigen::VectorXd& v = reflectors[static_cast<std::size_t>(i)];
    auto rest = result.q.bottomRightCorner(n - i, k - i);
    rest -= 2 * v * (v.transpose() * rest).eval();
  }
  return result;
}

}  // namespace gonio::stats

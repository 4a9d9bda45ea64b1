// See law_data.h.
#include "inference/law_data.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "base/parallel.h"
#include "linear/qr.h"

namespace gonio::inference {

LawData::LawData(const System& system, const std::vector<double>& values, const std::vector<std::size_t>& active)
    : system_(system) {
  own_ = linearise(system, values, active);
  groups_.resize(system.groups.size());
  parallel_for(0, groups_.size(), [&](std::size_t k) {
    Group& g = groups_[k];
    g.number = system.groups[k];
    g.first = system.observations().first[g.number];
    g.whitened = group_columns(system, own_, {}, {}, g.number, g.places);
    std::map<std::uint32_t, std::size_t> places;
    for (std::size_t i = g.first; i < system.observations().first[g.number + 1]; ++i)
      g.block.push_back(places.try_emplace(system.observations().block[i], places.size()).first->second);
    g.blocks = places.size();
  });
  for (const std::uint32_t b : system.observations().block) blocks_ = std::max<std::size_t>(blocks_, b + 1);
  for (const std::size_t g : system.groups) rows_ += system.used_rows(g);
}

Eigen::MatrixXd LawData::whitened(const RawColumns& columns, const Group& group) const {
  Eigen::MatrixXd c(group.whitened.rows(), static_cast<Eigen::Index>(columns.size()));
  for (Eigen::Index k = 0; k < c.cols(); ++k)
    for (Eigen::Index i = 0; i < c.rows(); ++i) {
      const std::size_t row = group.first + static_cast<std::size_t>(i);
      c(i, k) = columns[static_cast<std::size_t>(k)][row] * system_.weight(row);
    }
  return c;
}

std::vector<std::size_t> LawData::all_columns(const Linearisation& l) const {
  std::vector<std::size_t> columns(l.columns.size());
  for (std::size_t c = 0; c < columns.size(); ++c) columns[c] = c;
  return columns;
}

Linearisation LawData::with(const RawColumns& columns, const Mask& mask) const {
  Linearisation l;
  l.values = own_.values;
  l.own = own_.own;
  l.columns = own_.columns;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    LinearColumn column;
    column.extra = k;
    l.columns.push_back(column);
  }
  l.grams.resize(groups_.size());
  parallel_for(0, groups_.size(), [&](std::size_t k) {
    const Group& g = groups_[k];
    GroupGram& gram = l.grams[k];
    gram.group = g.number;
    gram.columns = g.places;
    for (std::size_t c = 0; c < columns.size(); ++c) gram.columns.push_back(own_.columns.size() + c);
    const Eigen::Index own = g.whitened.cols() - 1, all = own + static_cast<Eigen::Index>(columns.size()) + 1;
    Eigen::MatrixXd joint(g.whitened.rows(), all);
    joint << g.whitened.leftCols(own), whitened(columns, g), g.whitened.col(own);
    std::vector<Eigen::Index> rows[2];
    for (Eigen::Index i = 0; i < joint.rows(); ++i) {
      const std::size_t row = g.first + static_cast<std::size_t>(i);
      if (mask.empty() || mask[row]) rows[system_.half(row)].push_back(i);
    }
    for (std::size_t h = 0; h < 2; ++h) {
      const Eigen::MatrixXd part = joint(rows[h], Eigen::all);
      gram.half[h] = part.transpose() * part;
    }
  });
  return l;
}

// Of each column the sum over blocks of the square of its squared length there.
Eigen::VectorXd LawData::squares_of_blocks(const Eigen::MatrixXd& columns, const Group& group) {
  Eigen::VectorXd sums(columns.cols());
  Eigen::VectorXd lengths(static_cast<Eigen::Index>(group.blocks));
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    lengths.setZero();
    for (Eigen::Index i = 0; i < columns.rows(); ++i)
      lengths[static_cast<Eigen::Index>(group.block[static_cast<std::size_t>(i)])] += columns(i, c) * columns(i, c);
    sums[c] = lengths.squaredNorm();
  }
  return sums;
}

std::vector<Score> LawData::scores(const RawColumns& candidates, const RawColumns& chosen, const Mask& mask) const {
  const Linearisation l = with(chosen, mask);
  const NormalEquations equations(l, all_columns(l));
  const Eigen::MatrixXd step = equations.solve(equations.gradient());
  const auto all = static_cast<Eigen::Index>(l.columns.size()), own = static_cast<Eigen::Index>(l.own);
  const auto count = static_cast<Eigen::Index>(candidates.size());
  struct Part {
    Eigen::MatrixXd cross;
    Eigen::VectorXd length, score, squares;
  };
  std::vector<Part> parts(groups_.size());
  parallel_for(0, groups_.size(), [&](std::size_t k) {
    const Group& g = groups_[k];
    std::vector<Eigen::Index> places(g.places.begin(), g.places.end());
    for (Eigen::Index c = own; c < all; ++c) places.push_back(c);
    Eigen::MatrixXd a(g.whitened.rows(), static_cast<Eigen::Index>(places.size()));
    a << g.whitened.leftCols(g.whitened.cols() - 1), whitened(chosen, g);
    const Eigen::VectorXd r = g.whitened.rightCols(1) - a * step(places, 0);
    Eigen::MatrixXd phi = whitened(candidates, g);
    for (Eigen::Index i = 0; i < phi.rows() && !mask.empty(); ++i)
      if (!mask[g.first + static_cast<std::size_t>(i)]) phi.row(i).setZero();
    parts[k].cross = Eigen::MatrixXd::Zero(all, count);
    parts[k].cross(places, Eigen::all) = a.transpose() * phi;
    parts[k].length = phi.colwise().squaredNorm().transpose();
    parts[k].squares = squares_of_blocks(phi, g);
    parts[k].score = phi.transpose() * r;
  });
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(count);
  Part sum{Eigen::MatrixXd::Zero(all, count), none, none, none};
  for (const Part& p : parts)
    sum.cross += p.cross, sum.length += p.length, sum.score += p.score, sum.squares += p.squares;
  const Eigen::MatrixXd solution = equations.solve(sum.cross);
  std::vector<Score> result(candidates.size());
  for (Eigen::Index c = 0; c < count; ++c) {
    const double surviving = sum.length[c] - sum.cross.col(c).dot(solution.col(c));
    Score& s = result[static_cast<std::size_t>(c)];
    if (!(sum.length[c] > 0) || !(surviving > 0)) continue;
    s.survives = std::sqrt(surviving / sum.length[c]);
    s.fall = sum.score[c] * sum.score[c] / surviving;
    s.blocks = sum.length[c] * sum.length[c] / sum.squares[c];
  }
  return result;
}

Eigen::VectorXd LawData::coefficients(const RawColumns& columns, const Mask& mask, Eigen::MatrixXd* variance) const {
  const Linearisation l = with(columns, mask);
  const NormalEquations equations(l, all_columns(l));
  const auto all = static_cast<Eigen::Index>(l.columns.size()), n = static_cast<Eigen::Index>(columns.size());
  if (variance != nullptr) {
    Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(all, n);
    unit.bottomRows(n).setIdentity();
    *variance = equations.solve(unit).bottomRows(n);
  }
  return equations.solve(equations.gradient()).col(0).tail(n);
}

Eigen::MatrixXd LawData::projected(const RawColumns& columns) const {
  const auto n = static_cast<Eigen::Index>(columns.size()), own = static_cast<Eigen::Index>(own_.columns.size());
  Eigen::MatrixXd cross = Eigen::MatrixXd::Zero(own, n + 1);
  const auto places_of = [](const Group& g) { return std::vector<Eigen::Index>(g.places.begin(), g.places.end()); };
  for (const Group& g : groups_) {
    const auto a = g.whitened.leftCols(g.whitened.cols() - 1);
    cross(places_of(g), Eigen::seq(0, n - 1)) += a.transpose() * whitened(columns, g);
  }
  const NormalEquations equations(own_, all_columns(own_));
  cross.col(n) = equations.gradient();
  const Eigen::MatrixXd solution = equations.solve(cross);
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(system_.observations().rows()), n + 1);
  for (const Group& g : groups_) {
    const auto a = g.whitened.leftCols(g.whitened.cols() - 1);
    auto part = result.middleRows(static_cast<Eigen::Index>(g.first), g.whitened.rows());
    part << whitened(columns, g), g.whitened.rightCols(1);
    part -= a * solution(places_of(g), Eigen::all);
  }
  return result;
}

Eigen::MatrixXd LawData::covariance(const RawColumns& columns, const Eigen::VectorXd& coefficients) const {
  const Eigen::MatrixXd all = projected(columns);
  const Eigen::Index n = coefficients.size();
  // Columns of unit length: terms in their own units differ by many powers of ten.
  const Eigen::VectorXd length = all.leftCols(n).colwise().norm().cwiseMax(1e-300).transpose();
  const Eigen::MatrixXd p = all.leftCols(n) * length.cwiseInverse().asDiagonal();
  const Eigen::VectorXd left = all.col(n) - all.leftCols(n) * coefficients;
  std::vector<Eigen::VectorXd> scores(blocks_, Eigen::VectorXd::Zero(n));
  for (Eigen::Index i = 0; i < p.rows(); ++i)
    scores[system_.observations().block[static_cast<std::size_t>(i)]] += p.row(i).transpose() * left[i];
  Eigen::MatrixXd meat = Eigen::MatrixXd::Zero(n, n);
  for (const Eigen::VectorXd& u : scores) meat += u * u.transpose();
  const double rows = static_cast<double>(rows_),
               spent = static_cast<double>(own_.columns.size()) + static_cast<double>(n);
  const Eigen::MatrixXd inverse =
      length.cwiseInverse().asDiagonal() * linear::LeastNorm(p.transpose() * p).pseudo_inverse();
  return inverse * meat * inverse.transpose() * (rows / std::max(1.0, rows - spent));
}

HeldOut LawData::held_out(const RawColumns& columns) const {
  const Linearisation l = with(columns, {});
  return held_out_linear(system_, l, all_columns(l));
}

}  // namespace gonio::inference

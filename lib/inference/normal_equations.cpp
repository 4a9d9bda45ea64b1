// See system.h. With H = [A B; B' C] for local and shared parameters, the shared ones solve (C - B' A^-1 B) s = c - B'
// A^-1 a, and l = A^-1 (a - B s) group by group, since groups share no local parameter (Triggs et al. 2000, "Bundle
// Adjustment", section 6.1).
#include <cmath>

#include "inference/scaling.h"
#include "inference/system.h"

namespace gonio::inference {
Eigen::VectorXd downhill(const Linearisation& l) {
  Eigen::VectorXd result(static_cast<Eigen::Index>(l.columns.size()));
  for (std::size_t c = 0; c < l.columns.size(); ++c) result[static_cast<Eigen::Index>(c)] = l.columns[c].prior_pull;
  for (const GroupGram& gram : l.grams) {
    const Eigen::MatrixXd &a = gram.half[0], &b = gram.half[1];
    for (std::size_t k = 0; k < gram.columns.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      result[static_cast<Eigen::Index>(gram.columns[k])] += a(i, a.cols() - 1) + b(i, b.cols() - 1);
    }
  }
  return result;
}

double promised_fall(const Linearisation& l, const std::vector<std::size_t>& columns, const Eigen::VectorXd& step) {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(l.columns.size()));
  all(columns) = step;
  double fall = 0;
  for (std::size_t c = 0; c < l.columns.size(); ++c) {
    const double s = all[static_cast<Eigen::Index>(c)];
    fall += s * (2 * l.columns[c].prior_pull - s * l.columns[c].prior_precision);
  }
  for (const GroupGram& gram : l.grams) {
    const Eigen::MatrixXd whole = gram.whole();
    const Eigen::Index n = whole.cols() - 1;
    const Eigen::VectorXd own = all(gram.columns);
    fall += own.dot(2 * whole.col(n).head(n) - whole.topLeftCorner(n, n) * own);
  }
  return fall;
}

NormalEquations::Part NormalEquations::part_of(const GroupGram& gram,
                                               const std::vector<Eigen::Index>& place_in_subset) {
  Part p;
  std::vector<Eigen::Index> chosen;
  for (std::size_t k = 0; k < gram.columns.size(); ++k) {
    const Eigen::Index place = place_in_subset[gram.columns[k]];
    if (place < 0) continue;
    chosen.push_back(static_cast<Eigen::Index>(k));
    p.places.push_back(place);
  }
  const Eigen::MatrixXd &a = gram.half[0], &b = gram.half[1];
  if (chosen.size() == gram.columns.size())
    p.gram = (a + b).topLeftCorner(a.rows() - 1, a.cols() - 1);
  else
    p.gram = a(chosen, chosen) + b(chosen, chosen);
  p.score = a(chosen, a.cols() - 1) + b(chosen, b.cols() - 1);
  return p;
}

NormalEquations::NormalEquations(const Linearisation& l, const std::vector<std::size_t>& columns, std::size_t without,
                                 double damping) {
  const auto n = static_cast<Eigen::Index>(columns.size());
  std::vector<Eigen::Index> place(l.columns.size(), -1), place_in_shared(columns.size(), -1);
  gradient_ = diagonal_ = Eigen::VectorXd::Zero(n);
  Eigen::VectorXd prior(n);
  for (Eigen::Index c = 0; c < n; ++c) {
    const std::size_t k = static_cast<std::size_t>(c);
    const LinearColumn& column = l.columns[columns[k]];
    place[columns[k]] = c;
    diagonal_[c] = prior[c] = column.prior_precision;
    gradient_[c] = column.prior_pull;
    if (column.local != LinearColumn::everywhere) continue;
    place_in_shared[k] = static_cast<Eigen::Index>(shared_.size());
    shared_.push_back(c);
  }
  std::vector<Part> parts;
  for (const GroupGram& gram : l.grams) {
    if (gram.group == without) continue;
    parts.push_back(part_of(gram, place));
    const Part& p = parts.back();
    for (std::size_t k = 0; k < p.places.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      diagonal_[p.places[k]] += p.gram(i, i);
      gradient_[p.places[k]] += p.score[i];
    }
  }
  scale_ = unit_scale(diagonal_);
  lift_ = prior.cwiseProduct(scale_).cwiseProduct(scale_).array() + damping + unit_ridge;
  Eigen::MatrixXd reduced = lift_(shared_).asDiagonal();
  for (const Part& p : parts) eliminate(p, place_in_shared, reduced);
  factor_ = linear::Ldlt(reduced);
}

void NormalEquations::eliminate(const Part& p, const std::vector<Eigen::Index>& place_in_shared,
                                Eigen::MatrixXd& reduced) {
  const Eigen::VectorXd scale = scale_(p.places);
  Eigen::MatrixXd h = p.gram;
  for (Eigen::Index k = 0; k < h.cols(); ++k) h.col(k).array() *= scale.array() * scale[k];
  std::vector<Eigen::Index> in_local, in_shared, shared_places;
  Local local;
  for (std::size_t k = 0; k < p.places.size(); ++k) {
    const Eigen::Index shared_place = place_in_shared[static_cast<std::size_t>(p.places[k])];
    (shared_place >= 0 ? in_shared : in_local).push_back(static_cast<Eigen::Index>(k));
    if (shared_place >= 0)
      shared_places.push_back(shared_place);
    else
      local.places.push_back(p.places[k]);
  }
  reduced(shared_places, shared_places) += h(in_shared, in_shared);
  if (in_local.empty()) return;
  Eigen::MatrixXd own = h(in_local, in_local);
  own.diagonal() += lift_(local.places);
  local.factor = linear::Ldlt(own);
  local.coupling = Eigen::MatrixXd::Zero(own.rows(), reduced.cols());
  local.coupling(Eigen::all, shared_places) = h(in_local, in_shared);
  reduced.triangularView<Eigen::Lower>() -= local.coupling.transpose() * local.factor.solve(local.coupling);
  locals_.push_back(std::move(local));
}

Eigen::MatrixXd NormalEquations::solve(const Eigen::MatrixXd& rhs) const {
  const Eigen::MatrixXd b = scale_.asDiagonal() * rhs;
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(b.rows(), b.cols());
  Eigen::MatrixXd shared = b(shared_, Eigen::all);
  std::vector<Eigen::MatrixXd> own;
  for (const Local& local : locals_) {
    own.push_back(local.factor.solve(Eigen::MatrixXd(b(local.places, Eigen::all))));
    shared.noalias() -= local.coupling.transpose() * own.back();
  }
  if (shared.rows() > 0) {
    shared = factor_.solve(shared).eval();
    x(shared_, Eigen::all) = shared;
  }
  for (std::size_t k = 0; k < locals_.size(); ++k)
    x(locals_[k].places, Eigen::all) =
        shared.rows() > 0 ? Eigen::MatrixXd(own[k] - locals_[k].factor.solve(locals_[k].coupling * shared)) : own[k];
  return scale_.asDiagonal() * x;
}

}  // namespace gonio::inference

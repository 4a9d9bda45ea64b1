// See system.h. With H = [A B; B' C] for local and shared parameters, the shared ones solve (C - B' A^-1 B) s = c - B' A^-1 a, and
// l = A^-1 (a - B s) group by group, since groups share no local parameter (Triggs et al. 2000, "Bundle Adjustment", section 6.1).
#include <algorithm>
#include <cmath>
#include <map>

#include "explain/system.h"

namespace gonio::explain {
namespace {

// Relative to the unit diagonal of the scaled matrix: below this a direction carries no information.
constexpr double ridge = 1e-13;

struct Places {
  std::vector<Eigen::Index> in_gram, in_subset;
};
// Which of the subset's columns a group has, and where.
Places places_of(const GroupGram& gram, const std::vector<Eigen::Index>& place_in_subset) {
  Places p;
  for (std::size_t k = 0; k < gram.columns.size(); ++k) {
    const Eigen::Index place = place_in_subset[gram.columns[k]];
    if (place < 0) continue;
    p.in_gram.push_back(static_cast<Eigen::Index>(k));
    p.in_subset.push_back(place);
  }
  return p;
}

}  // namespace

NormalEquations::NormalEquations(const Linearisation& l, std::vector<std::size_t> columns, std::size_t without,
                                 double damping) {
  const auto n = static_cast<Eigen::Index>(columns.size());
  std::vector<Eigen::Index> place(l.columns.size(), -1), place_in_shared(columns.size(), -1);
  std::map<std::size_t, std::vector<Eigen::Index>> local_places;
  gradient_ = diagonal_ = Eigen::VectorXd::Zero(n);
  for (Eigen::Index c = 0; c < n; ++c) {
    const LinearColumn& column = l.columns[columns[static_cast<std::size_t>(c)]];
    place[columns[static_cast<std::size_t>(c)]] = c;
    diagonal_[c] = column.prior_precision;
    gradient_[c] = column.prior_pull;
    if (column.local == LinearColumn::everywhere) {
      place_in_shared[static_cast<std::size_t>(c)] = static_cast<Eigen::Index>(shared_.size());
      shared_.push_back(c);
    } else {
      local_places[column.local].push_back(c);
    }
  }
  std::vector<std::pair<Places, Eigen::MatrixXd>> parts;
  for (const GroupGram& gram : l.grams) {
    if (gram.group == without) continue;
    Places p = places_of(gram, place);
    const Eigen::MatrixXd whole = gram.whole();
    const Eigen::Index last = whole.rows() - 1;
    for (std::size_t k = 0; k < p.in_gram.size(); ++k) {
      diagonal_[p.in_subset[k]] += whole(p.in_gram[k], p.in_gram[k]);
      gradient_[p.in_subset[k]] += whole(p.in_gram[k], last);
    }
    parts.emplace_back(std::move(p), whole);
  }
  scale_.resize(n);
  for (Eigen::Index c = 0; c < n; ++c) scale_[c] = diagonal_[c] > 0 ? 1 / std::sqrt(diagonal_[c]) : 0;

  const auto s = static_cast<Eigen::Index>(shared_.size());
  Eigen::MatrixXd reduced = Eigen::MatrixXd::Zero(s, s);
  for (Eigen::Index k = 0; k < s; ++k) {
    const double prior = l.columns[columns[static_cast<std::size_t>(shared_[static_cast<std::size_t>(k)])]].prior_precision;
    reduced(k, k) = prior * scale_[shared_[static_cast<std::size_t>(k)]] * scale_[shared_[static_cast<std::size_t>(k)]] +
                    damping + ridge;
  }
  std::size_t part_index = 0;
  for (const GroupGram& gram : l.grams) {
    if (gram.group == without) continue;
    const auto& [p, whole] = parts[part_index++];
    Eigen::MatrixXd h = whole(p.in_gram, p.in_gram);
    for (Eigen::Index a = 0; a < h.rows(); ++a)
      for (Eigen::Index b = 0; b < h.cols(); ++b)
        h(a, b) *= scale_[p.in_subset[static_cast<std::size_t>(a)]] * scale_[p.in_subset[static_cast<std::size_t>(b)]];
    std::vector<Eigen::Index> in_local, in_shared, shared_places;
    Local local;
    for (std::size_t k = 0; k < p.in_subset.size(); ++k) {
      const Eigen::Index shared_place = place_in_shared[static_cast<std::size_t>(p.in_subset[k])];
      if (shared_place >= 0) {
        in_shared.push_back(static_cast<Eigen::Index>(k));
        shared_places.push_back(shared_place);
      } else {
        in_local.push_back(static_cast<Eigen::Index>(k));
        local.places.push_back(p.in_subset[k]);
      }
    }
    for (std::size_t a = 0; a < in_shared.size(); ++a)
      for (std::size_t b = 0; b < in_shared.size(); ++b)
        reduced(shared_places[a], shared_places[b]) += h(in_shared[a], in_shared[b]);
    if (in_local.empty()) continue;
    Eigen::MatrixXd own = h(in_local, in_local);
    for (std::size_t a = 0; a < in_local.size(); ++a) {
      const Eigen::Index c = local.places[a];
      own(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(a)) +=
          l.columns[columns[static_cast<std::size_t>(c)]].prior_precision * scale_[c] * scale_[c] + damping + ridge;
    }
    local.factor.compute(own);
    local.coupling = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(in_local.size()), s);
    for (std::size_t a = 0; a < in_local.size(); ++a)
      for (std::size_t b = 0; b < in_shared.size(); ++b)
        local.coupling(static_cast<Eigen::Index>(a), shared_places[b]) = h(in_local[a], in_shared[b]);
    reduced.noalias() -= local.coupling.transpose() * local.factor.solve(local.coupling);
    locals_.push_back(std::move(local));
  }
  factor_.compute(reduced);
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

}  // namespace gonio::explain

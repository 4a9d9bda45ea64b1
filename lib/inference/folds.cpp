// See folds.h.
#include "inference/folds.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "inference/scaling.h"
#include "linear/solve.h"

namespace gonio::inference {
namespace {

// Relative to a column's squared length before projection: less than this is not information.
constexpr double ridge = 1e-10;
constexpr double own_ridge = 1e-9;  // of a group's own numbers, as in held_out.cpp

// On which side of neutral a parameter must stay.
int side_of(const System& system, const LinearColumn& column) {
  if (column.parameter == LinearColumn::everywhere) return 0;
  const Parameter& p = system.problem().parameters()[column.parameter];
  if (p.lower == p.neutral) return 1;
  return p.upper == p.neutral ? -1 : 0;
}

// (M + small) x = rhs with unit diagonal.
Eigen::MatrixXd scaled_solve(const Eigen::MatrixXd& m, const Eigen::MatrixXd& rhs, double small) {
  const Eigen::VectorXd scale = unit_scale(m.diagonal());
  Eigen::MatrixXd scaled = scale.asDiagonal() * m * scale.asDiagonal();
  scaled.diagonal().array() += small;
  return scale.asDiagonal() * linear::solve_ldlt(scaled, Eigen::MatrixXd(scale.asDiagonal() * rhs));
}

// Columns (t, 1) of one group in terms of its gram's columns: own shared ones have moved by u - U t.
Eigen::MatrixXd held_out_basis(const Linearisation& l, const GroupGram& gram, const Eigen::MatrixXd& moved) {
  const auto foreign = static_cast<Eigen::Index>(l.columns.size() - l.own);
  Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(gram.columns.size()) + 1, foreign + 1);
  for (std::size_t k = 0; k < gram.columns.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const std::size_t c = gram.columns[k];
    if (c >= l.own)
      basis(row, static_cast<Eigen::Index>(c - l.own)) = 1;
    else if (l.columns[c].local != gram.group)
      basis.row(row) = -moved.row(static_cast<Eigen::Index>(c));
  }
  basis(basis.rows() - 1, foreign) = 1;
  return basis;
}

// Eliminates the model's own numbers of the group, fitted on `half`, from the basis.
Eigen::MatrixXd without_own_numbers(const Linearisation& l, const GroupGram& gram, const Eigen::MatrixXd& basis,
                                    const std::vector<Eigen::Index>& places, std::size_t half) {
  const Eigen::MatrixXd& h = gram.half[half];
  Eigen::MatrixXd own = h(places, places), coupling = h(places, Eigen::all) * basis;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const LinearColumn& column = l.columns[gram.columns[static_cast<std::size_t>(places[k])]];
    own(i, i) += column.prior_precision;
    coupling(i, coupling.cols() - 1) += column.prior_pull;
  }
  Eigen::MatrixXd result = basis;
  result(places, Eigen::all) -= scaled_solve(own, coupling, own_ridge);
  return result;
}

// b' H b of a basis whose rows are unit vectors but for the few that belong to the model's own columns:
// with b = E + D, E the unit rows, it is E'HE + E'HD + (E'HD)' + D'HD, a sorting and products as thin as D.
Eigen::MatrixXd seen_along(const Eigen::MatrixXd& h, const Linearisation& l, const GroupGram& gram,
                           const Eigen::MatrixXd& basis) {
  std::vector<Eigen::Index> unit, place, dense;
  for (std::size_t k = 0; k < gram.columns.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    if (gram.columns[k] < l.own) {
      dense.push_back(row);
    } else {
      unit.push_back(row);
      place.push_back(static_cast<Eigen::Index>(gram.columns[k] - l.own));
    }
  }
  unit.push_back(h.rows() - 1);
  place.push_back(basis.cols() - 1);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(basis.cols(), basis.cols());
  sum(place, place) = h(unit, unit);
  if (dense.empty()) return sum;
  const Eigen::MatrixXd d = basis(dense, Eigen::all), coupling = h(unit, dense) * d, own = h(dense, dense) * d;
  sum(place, Eigen::all) += coupling;
  sum(Eigen::all, place) += coupling.transpose();
  sum.triangularView<Eigen::Lower>() += d.transpose() * own;  // which is symmetric, as is all of it
  sum.triangularView<Eigen::StrictlyUpper>() = sum.transpose();
  return sum;
}

}  // namespace

Folds::Fold Folds::everything(const Linearisation& l, const Eigen::MatrixXd& joint) {
  const auto own = static_cast<Eigen::Index>(l.own), all = static_cast<Eigen::Index>(l.columns.size());
  std::vector<std::size_t> columns(l.own);
  for (std::size_t c = 0; c < l.own; ++c) columns[c] = c;
  const NormalEquations equations(l, columns);
  const Eigen::MatrixXd cross = joint.block(0, own, own, all - own);
  Eigen::MatrixXd moved(own, all - own + 1);  // U and u
  moved << equations.solve(cross), equations.solve(equations.gradient());
  Fold fold;
  full_ = joint.diagonal().segment(own, all - own);
  fold.normal = joint.block(own, own, all - own, all - own + 1) - cross.transpose() * moved;
  add_priors(l, full_, fold);
  return fold;
}

void Folds::add_priors(const Linearisation& l, const Eigen::VectorXd& length, Fold& fold) const {
  const Eigen::Index last = fold.normal.cols() - 1;
  for (Eigen::Index f = 0; f < last; ++f) {
    const LinearColumn& column = l.columns[l.own + static_cast<std::size_t>(f)];
    fold.normal(f, f) += column.prior_precision + ridge * length[f];
    fold.normal(f, last) += column.prior_pull;
  }
}

// `moved`: rows for all own columns; those of single groups are zero.
Folds::Fold Folds::without(const System& system, const Linearisation& l, const GroupGram& left_out,
                           const Eigen::MatrixXd& normal, const Eigen::MatrixXd& moved) const {
  Fold fold;
  fold.normal = normal;
  Eigen::VectorXd length = full_;
  for (std::size_t k = 0; k < left_out.columns.size(); ++k) {
    if (left_out.columns[k] < l.own) continue;
    const auto f = static_cast<Eigen::Index>(left_out.columns[k] - l.own), i = static_cast<Eigen::Index>(k);
    length[f] -= left_out.half[0](i, i) + left_out.half[1](i, i);
    if (!(length[f] > 1e-12 * full_[f])) length[f] = 0;  // what the group alone has leaves rounding behind
  }
  add_priors(l, length, fold);
  fold.group = left_out.group;
  fold.rows = static_cast<double>(system.used_rows(fold.group));
  const Eigen::MatrixXd basis = held_out_basis(l, left_out, moved);
  std::vector<Eigen::Index> numbers;
  bool foreign_numbers = false;
  for (std::size_t k = 0; k < left_out.columns.size(); ++k) {
    if (l.columns[left_out.columns[k]].local != fold.group) continue;
    if (left_out.columns[k] < l.own)
      numbers.push_back(static_cast<Eigen::Index>(k));
    else
      foreign_numbers = true;
  }
  fold.halved = !numbers.empty();
  for (std::size_t half = 0; half < 2; ++half) {
    const Eigen::MatrixXd b = numbers.empty() ? basis : without_own_numbers(l, left_out, basis, numbers, half);
    fold.judged[half] = seen_along(left_out.half[1 - half], l, left_out, b);
    if (foreign_numbers) fold.fitted[half] = seen_along(left_out.half[half], l, left_out, b);
  }
  return fold;
}

Folds::Folds(const System& system, const Linearisation& l) {
  const auto all = static_cast<Eigen::Index>(l.columns.size());
  Eigen::MatrixXd joint = Eigen::MatrixXd::Zero(all + 1, all + 1);
  for (const GroupGram& gram : l.grams) {
    std::vector<Eigen::Index> places(gram.columns.begin(), gram.columns.end());
    places.push_back(all);
    joint(places, places) += gram.whole();
  }
  for (std::size_t c = l.own; c < l.columns.size(); ++c) {
    local_.push_back(l.columns[c].local);
    side_.push_back(side_of(system, l.columns[c]));
  }
  all_ = everything(l, joint);
  folds_.resize(l.grams.size());
  std::vector<std::size_t> own(l.own), foreign(l.columns.size() - l.own);
  for (std::size_t c = 0; c < l.columns.size(); ++c) (c < l.own ? own[c] : foreign[c - l.own]) = c;
  const LeaveOneOut others(l, own, foreign);
  others.each([&](std::size_t g, const WithoutGroup& w) {
    Eigen::MatrixXd moved = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(l.own), w.moved.cols());
    for (std::size_t k = 0; k < others.shared().size(); ++k)
      moved.row(static_cast<Eigen::Index>(others.shared()[k])) = w.moved.row(static_cast<Eigen::Index>(k));
    folds_[g] = without(system, l, l.grams[g], w.normal, moved);
  });
  for (const Fold& fold : folds_) rows_ += fold.rows;
  own_ = held_out({});
}

Eigen::VectorXd Folds::solved(const Fold& fold, const std::vector<Eigen::Index>& shared) const {
  std::vector<Eigen::Index> kept = shared, places;
  for (std::size_t k = 0; k < shared.size(); ++k) places.push_back(static_cast<Eigen::Index>(k));
  Eigen::VectorXd t = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(shared.size()));
  while (!kept.empty()) {
    const Eigen::VectorXd step = scaled_solve(fold.normal(kept, kept), fold.normal(kept, fold.normal.cols() - 1), 0);
    std::size_t wrong = kept.size();
    for (std::size_t k = 0; k < kept.size() && wrong == kept.size(); ++k)
      if (side_[static_cast<std::size_t>(kept[k])] * step[static_cast<Eigen::Index>(k)] < 0) wrong = k;
    if (wrong == kept.size()) {
      t(places) = step;
      return t;
    }
    kept.erase(kept.begin() + static_cast<std::ptrdiff_t>(wrong));
    places.erase(places.begin() + static_cast<std::ptrdiff_t>(wrong));
  }
  return t;
}

double Folds::squares(const Fold& fold, const std::vector<Eigen::Index>& foreign) const {
  std::vector<Eigen::Index> shared, numbers;
  for (const Eigen::Index f : foreign)
    (local_[static_cast<std::size_t>(f)] == fold.group ? numbers : shared).push_back(f);
  const Eigen::VectorXd t = solved(fold, shared);
  std::vector<Eigen::Index> places = shared;
  places.insert(places.end(), numbers.begin(), numbers.end());
  places.push_back(fold.normal.cols() - 1);
  double sum = 0;
  for (std::size_t half = 0; half < 2; ++half) {
    Eigen::VectorXd x(static_cast<Eigen::Index>(places.size()));
    x << -t, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(numbers.size())), 1;
    if (!numbers.empty()) {
      const Eigen::MatrixXd& h = fold.fitted[half];
      const Eigen::VectorXd rhs = h(numbers, places) * x;
      x.segment(t.size(), rhs.size()) = -scaled_solve(h(numbers, numbers), rhs, own_ridge);
    }
    sum += std::max(0.0, x.dot(fold.judged[half](places, places) * x));
  }
  return sum;
}

HeldOut Folds::held_out(const std::vector<Eigen::Index>& foreign) const {
  HeldOut result;
  for (const Fold& fold : folds_) {
    result.whitened.push_back(squares(fold, foreign));
    result.rows.push_back(fold.rows);
  }
  return result;
}

double Folds::gain(const std::vector<Eigen::Index>& foreign) const {
  double fall = 0;
  for (std::size_t k = 0; k < folds_.size(); ++k) fall += own_.whitened[k] - squares(folds_[k], foreign);
  return rows_ > 0 ? fall / rows_ : 0;
}

Eigen::VectorXd Folds::step(const std::vector<Eigen::Index>& foreign) const {
  return solved(all_, foreign);
}

double Folds::promise(const std::vector<Eigen::Index>& foreign) const {
  const Eigen::VectorXd t = solved(all_, foreign);  // a minimum within the signs allowed: the fall is b't
  return rows_ > 0 ? all_.normal(foreign, all_.normal.cols() - 1).dot(t) / rows_ : 0;
}

}  // namespace gonio::inference

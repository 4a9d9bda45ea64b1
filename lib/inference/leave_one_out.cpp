// See system.h. With H = [A B; B' C] of one group, its own numbers first and shared, foreign and residual columns
// together, C - B' A^-1 B is all that the others see of it.
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "inference/scaling.h"
#include "inference/system.h"
#include "linear/solve.h"

namespace gonio::inference {
namespace {

constexpr std::size_t groups_a_task = 5;    // whose sums of others are formed by one thread
constexpr Eigen::Index many_columns = 100;  // beyond: factored by blocks

Eigen::MatrixXd factored_solve(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right) {
  if (matrix.rows() > many_columns) {
    const linear::Llt factor(matrix);
    if (factor.info() == Eigen::Success) return factor.solve(right);
  }
  return linear::solve_ldlt(matrix, right);
}

}  // namespace

LeaveOneOut::LeaveOneOut(const Linearisation& l, const std::vector<std::size_t>& columns,
                         const std::vector<std::size_t>& foreign) {
  std::vector<Eigen::Index> place(l.columns.size(), -1);
  std::vector<char> own(l.columns.size(), 0);
  for (const std::size_t c : columns) {
    if (l.columns[c].local != LinearColumn::everywhere) {
      own[c] = 1;
      continue;
    }
    place[c] = static_cast<Eigen::Index>(shared_.size());
    shared_.push_back(c);
  }
  const auto shared = static_cast<Eigen::Index>(shared_.size());
  for (std::size_t k = 0; k < foreign.size(); ++k) place[foreign[k]] = shared + static_cast<Eigen::Index>(k);
  size_ = shared + static_cast<Eigen::Index>(foreign.size()) + 1;
  prior_.resize(shared), pull_.resize(shared);
  Eigen::VectorXd whole(shared);
  for (Eigen::Index k = 0; k < shared; ++k) {
    const LinearColumn& column = l.columns[shared_[static_cast<std::size_t>(k)]];
    whole[k] = prior_[k] = column.prior_precision, pull_[k] = column.prior_pull;
  }
  for (const GroupGram& gram : l.grams) {
    for (std::size_t k = 0; k < gram.columns.size(); ++k)
      if (const Eigen::Index at = place[gram.columns[k]]; at >= 0 && at < shared) {
        const auto i = static_cast<Eigen::Index>(k);
        whole[at] += gram.half[0](i, i) + gram.half[1](i, i);
      }
    eliminate(l, gram, place, own);
  }
  scale_ = unit_scale(whole);
}

void LeaveOneOut::eliminate(const Linearisation& l, const GroupGram& gram, const std::vector<Eigen::Index>& place,
                            const std::vector<char>& own) {
  std::vector<Eigen::Index> local, kept;
  Part part;
  for (std::size_t k = 0; k < gram.columns.size(); ++k) {
    const std::size_t c = gram.columns[k];
    if (own[c]) local.push_back(static_cast<Eigen::Index>(k));
    if (place[c] < 0) continue;
    kept.push_back(static_cast<Eigen::Index>(k));
    part.places.push_back(place[c]);
  }
  const Eigen::MatrixXd h = gram.whole();
  kept.push_back(h.rows() - 1);
  part.places.push_back(size_ - 1);
  part.matrix = h(kept, kept);
  if (!local.empty()) {
    Eigen::MatrixXd matrix = h(local, local), right = h(local, kept);
    const Eigen::MatrixXd coupling = right;
    Eigen::VectorXd lift(matrix.rows());
    for (Eigen::Index k = 0; k < lift.size(); ++k) {
      const LinearColumn& column =
          l.columns[gram.columns[static_cast<std::size_t>(local[static_cast<std::size_t>(k)])]];
      lift[k] = column.prior_precision;
      right(k, right.cols() - 1) += column.prior_pull;
    }
    const Eigen::VectorXd scale = unit_scale(matrix.diagonal() + lift);
    matrix = (scale.asDiagonal() * matrix * scale.asDiagonal()).eval();
    matrix.diagonal() += Eigen::VectorXd(lift.cwiseProduct(scale).cwiseProduct(scale).array() + unit_ridge);
    const Eigen::MatrixXd scaled = scale.asDiagonal() * right;
    right = scale.asDiagonal() * linear::solve_ldlt(matrix, scaled);
    part.matrix.noalias() -= coupling.transpose() * right;
  }
  parts_.push_back(std::move(part));
}

void LeaveOneOut::each(const std::function<void(std::size_t, const WithoutGroup&)>& visit) const {
  const std::size_t tasks = (parts_.size() + groups_a_task - 1) / groups_a_task;
  parallel_for(0, tasks, [&](std::size_t task) {
    const std::size_t first = task * groups_a_task, last = std::min(parts_.size(), first + groups_a_task);
    Eigen::MatrixXd others = Eigen::MatrixXd::Zero(size_, size_);
    for (std::size_t g = 0; g < parts_.size(); ++g)
      if (g < first || g >= last) others(parts_[g].places, parts_[g].places) += parts_[g].matrix;
    visit_within(first, last, std::move(others), visit);
  });
}

void LeaveOneOut::visit_within(std::size_t first, std::size_t last, Eigen::MatrixXd others,
                               const std::function<void(std::size_t, const WithoutGroup&)>& visit) const {
  if (last - first == 1) return visit(first, solved(std::move(others)));
  const std::size_t middle = (first + last) / 2;
  Eigen::MatrixXd more = others;
  for (std::size_t g = middle; g < last; ++g) more(parts_[g].places, parts_[g].places) += parts_[g].matrix;
  visit_within(first, middle, std::move(more), visit);
  for (std::size_t g = first; g < middle; ++g) others(parts_[g].places, parts_[g].places) += parts_[g].matrix;
  visit_within(middle, last, std::move(others), visit);
}

WithoutGroup LeaveOneOut::solved(Eigen::MatrixXd sums) const {
  const auto shared = static_cast<Eigen::Index>(shared_.size());
  const Eigen::Index rest = size_ - shared;
  WithoutGroup result;
  Eigen::MatrixXd matrix = scale_.asDiagonal() * sums.topLeftCorner(shared, shared) * scale_.asDiagonal();
  matrix.diagonal().array() += prior_.array() * scale_.array().square() + unit_ridge;
  Eigen::MatrixXd right = sums.topRightCorner(shared, rest);
  right.col(rest - 1) += pull_;
  right = (scale_.asDiagonal() * right).eval();
  if (shared > 0)
    result.moved = scale_.asDiagonal() * factored_solve(matrix, right);
  else
    result.moved = Eigen::MatrixXd::Zero(0, rest);
  result.normal = sums.block(shared, shared, rest - 1, rest);
  result.normal.noalias() -= sums.block(0, shared, shared, rest - 1).transpose() * result.moved;
  return result;
}

}  // namespace gonio::inference

// The engine's sparse linear algebra against the same in dense matrices: Gram matrices by group, elimination of groups'
// own numbers, and all left-out groups at once.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <mutex>
#include <numeric>

#include "inference/nonlinear_toy.h"
#include "inference/system.h"
#include "linear/solve.h"

namespace gonio::explain::tests {
namespace {

struct DenseTwin {
  NonlinearToy problem;
  System system;
  Linearisation l;
  std::vector<std::size_t> own, foreign;  // columns
  Eigen::MatrixXd columns;                // all rows: every column of l and, last, the residual
  std::vector<std::size_t> group;         // of each row

  DenseTwin()
      : problem(library(), std::vector<std::vector<double>>(7, {0.2}), {{}, 0.1, 0}, 11, {6, 12, 2}),
        system(problem, 1) {
    std::vector<double> values(problem.parameters().size());
    for (std::size_t p = 0; p < values.size(); ++p) values[p] = problem.parameters()[p].neutral;
    std::vector<std::size_t> parameters = problem.base();
    own.resize(parameters.size());
    std::iota(own.begin(), own.end(), std::size_t{0});
    for (const std::size_t c : {0U, 1U, 5U, 6U}) {  // those whose slope does not vanish at neutral
      foreign.push_back(parameters.size());
      parameters.push_back(problem.candidates()[c].parameters[0]);
    }
    l = linearise(system, values, parameters);
    const auto width = static_cast<Eigen::Index>(l.columns.size());
    columns = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(problem.observations().rows()), width + 1);
    for (const std::size_t g : system.groups) {
      std::vector<std::size_t> places;
      const Eigen::MatrixXd part = group_columns(system, l, {}, {}, g, places);
      const auto first = static_cast<Eigen::Index>(problem.observations().first[g]);
      for (std::size_t k = 0; k < places.size(); ++k)
        columns.block(first, static_cast<Eigen::Index>(places[k]), part.rows(), 1) =
            part.col(static_cast<Eigen::Index>(k));
      columns.block(first, width, part.rows(), 1) = part.col(part.cols() - 1);
      group.insert(group.end(), static_cast<std::size_t>(part.rows()), g);
    }
  }
  // Gram matrix of all columns and the residual, of all groups but `without`.
  Eigen::MatrixXd gram(std::size_t without = NormalEquations::none) const {
    Eigen::MatrixXd rows = columns;
    for (std::size_t i = 0; i < group.size(); ++i)
      if (group[i] == without) rows.row(static_cast<Eigen::Index>(i)).setZero();
    return rows.transpose() * rows;
  }
  Eigen::MatrixXd of(const Eigen::MatrixXd& m, const std::vector<std::size_t>& rows,
                     const std::vector<std::size_t>& cols) const {
    Eigen::MatrixXd result(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(cols.size()));
    for (std::size_t i = 0; i < rows.size(); ++i)
      for (std::size_t j = 0; j < cols.size(); ++j)
        result(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
            m(static_cast<Eigen::Index>(rows[i]), static_cast<Eigen::Index>(cols[j]));
    return result;
  }
};

double worst(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return (a - b).norm() / b.norm();
}

TEST(Linearise, GramsOfHalvesAddUpToThoseOfTheColumns) {
  const DenseTwin s;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(s.columns.cols(), s.columns.cols());
  for (const GroupGram& gram : s.l.grams) {
    std::vector<std::size_t> places = gram.columns;
    places.push_back(s.l.columns.size());
    const Eigen::MatrixXd whole = gram.whole();
    ASSERT_EQ(static_cast<std::size_t>(whole.rows()), places.size());
    for (std::size_t i = 0; i < places.size(); ++i)
      for (std::size_t j = 0; j < places.size(); ++j)
        sum(static_cast<Eigen::Index>(places[i]), static_cast<Eigen::Index>(places[j])) +=
            whole(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
  }
  EXPECT_LT(worst(sum, s.gram()), 1e-12);
}

TEST(NormalEquations, SolveAsOneDenseSystemDoes) {
  const DenseTwin s;
  std::vector<std::size_t> all = s.own;
  all.insert(all.end(), s.foreign.begin(), s.foreign.end());
  const Eigen::MatrixXd gram = s.gram(), rhs = s.of(gram, all, {s.l.columns.size()});
  const NormalEquations sparse(s.l, all);
  EXPECT_LT(worst(sparse.gradient(), rhs), 1e-10);
  EXPECT_LT(worst(sparse.solve(rhs), linear::Ldlt(s.of(gram, all, all)).solve(rhs)), 1e-7);
}

TEST(NormalEquations, DampingIsAShareOfTheDiagonal) {
  const DenseTwin s;
  Eigen::MatrixXd dense = s.of(s.gram(), s.own, s.own);
  const Eigen::MatrixXd rhs = s.of(s.gram(), s.own, {s.l.columns.size()});
  dense.diagonal() *= 1.5;
  EXPECT_LT(worst(NormalEquations(s.l, s.own, NormalEquations::none, 0.5).solve(rhs), linear::Ldlt(dense).solve(rhs)),
            1e-7);
}

TEST(NormalEquations, AGroupLeftOutMovesNothingOfItsOwn) {
  const DenseTwin s;
  const std::size_t without = 2;
  std::vector<std::size_t> known;  // the columns that the others tell
  std::size_t lost = s.own.size();
  for (const std::size_t c : s.own)
    if (s.l.columns[c].local == without)
      lost = c;
    else
      known.push_back(c);
  ASSERT_LT(lost, s.own.size());
  const Eigen::MatrixXd gram = s.gram(without);
  const Eigen::MatrixXd step = NormalEquations(s.l, s.own, without).solve(s.of(gram, s.own, {s.l.columns.size()}));
  EXPECT_NEAR(step(static_cast<Eigen::Index>(lost), 0), 0, 1e-9);
  const Eigen::MatrixXd dense =
      linear::Ldlt(s.of(gram, known, known)).solve(Eigen::MatrixXd(s.of(gram, known, {s.l.columns.size()})));
  for (std::size_t k = 0; k < known.size(); ++k)
    EXPECT_NEAR(step(static_cast<Eigen::Index>(known[k]), 0), dense(static_cast<Eigen::Index>(k), 0),
                1e-7 * dense.norm());
}

TEST(LeaveOneOut, IsEveryGroupLeftOutByItself) {
  const DenseTwin s;
  const LeaveOneOut all(s.l, s.own, s.foreign);
  std::vector<std::size_t> towards = s.foreign;
  towards.push_back(s.l.columns.size());
  std::mutex lock;
  std::size_t visited = 0;
  all.each([&](std::size_t place, const WithoutGroup& w) {
    const std::lock_guard<std::mutex> guard(lock);
    ++visited;
    const std::size_t without = s.l.grams[place].group;
    std::vector<std::size_t> known;
    for (const std::size_t c : s.own)
      if (s.l.columns[c].local != without) known.push_back(c);
    const Eigen::MatrixXd gram = s.gram(without);
    const Eigen::MatrixXd cross = s.of(gram, known, towards);
    const Eigen::MatrixXd step = linear::Ldlt(s.of(gram, known, known)).solve(cross);
    for (std::size_t i = 0; i < all.shared().size(); ++i) {
      const auto at = std::find(known.begin(), known.end(), all.shared()[i]) - known.begin();
      for (Eigen::Index k = 0; k < step.cols(); ++k)
        EXPECT_NEAR(w.moved(static_cast<Eigen::Index>(i), k), step(at, k), 1e-6 * (1 + std::abs(step(at, k))));
    }
    // What the model's columns leave of the foreign ones and the residual.
    const Eigen::MatrixXd left = s.of(gram, s.foreign, towards) - s.of(gram, s.foreign, known) * step;
    EXPECT_LT(worst(w.normal, left), 1e-6);
  });
  EXPECT_EQ(visited, s.system.groups.size());
}

TEST(CurveBasis, HatsAddUpToOne) {
  const DenseTwin s;
  const CurveBasis basis = curve_basis(s.problem.observations(), 0, 5);
  ASSERT_GE(basis.size(), 2U);
  for (std::size_t k = 1; k < basis.size(); ++k) EXPECT_LT(basis.knots[k - 1], basis.knots[k]);
  const ExtraColumn ones{{{&basis, std::vector<double>(basis.size(), 1.0)}}, {}};
  const ExtraColumn* const columns[] = {&ones};
  for (const std::size_t g : s.system.groups) {
    const Eigen::MatrixXd column = s.system.extra(columns, g);
    for (Eigen::Index i = 0; i < column.rows(); ++i)
      EXPECT_NEAR(column(i, 0), s.system.weight(s.problem.observations().first[g] + static_cast<std::size_t>(i)), 1e-9);
  }
}

}  // namespace
}  // namespace gonio::explain::tests

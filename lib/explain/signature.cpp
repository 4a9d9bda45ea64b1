// See signature.h. With A the free parameters' columns and S the foreign ones, both whitened, what survives is
// S_perp = S - A (A'A)^-1 A'S; its Gram matrix is the Schur complement of the joint one.
#include "explain/signature.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/parallel.h"
#include "base/random.h"

namespace gonio::explain {
namespace {

constexpr std::size_t knots_of_a_curve = 6;
constexpr double visible_share = 1e-3;

}  // namespace

const CurveBasis* Structures::basis(const System& system, std::size_t condition) {
  for (const CurveBasis& b : bases_)
    if (b.condition == condition) return &b;
  bases_.push_back(curve_basis(system.observations(), condition, knots_of_a_curve));
  return &bases_.back();
}

void Structures::add_mechanism(const System& system, const std::vector<double>& values, std::size_t candidate) {
  const Candidate& c = system.problem().candidates()[candidate];
  Signature signature{values, c.parameters};
  for (const std::size_t p : c.parameters) signature.values[p] = system.problem().parameters()[p].start;
  list.push_back({Structure::Kind::mechanism, candidate, c.id(), signature_columns, c.parameters.size(), 0});
  signature_columns += c.parameters.size();
  signatures.push_back(std::move(signature));
}

void Structures::add_curve(const System& system, std::size_t condition) {
  const CurveBasis* curve = basis(system, condition);
  if (curve->size() < 2) return;
  list.push_back({Structure::Kind::curve, condition, system.observations().conditions[condition].name, extras.size(),
                  curve->size(), 0});
  for (std::size_t k = 0; k < curve->size(); ++k) {
    std::vector<double> hat(curve->size(), 0.0);
    hat[k] = 1;
    extras.push_back({{{curve, std::move(hat)}}, {}});
  }
}

void Structures::add_dummy(const System& system, std::size_t candidate, std::size_t number, std::uint64_t seed) {
  const Problem& problem = system.problem();
  const auto conditions = static_cast<std::uint32_t>(system.observations().conditions.size());
  if (conditions == 0) return;
  Random random(seed, 0x64756d6d79u + number);
  const std::vector<std::size_t>& parameters = problem.candidates()[candidate].parameters;
  list.push_back({Structure::Kind::dummy, number, "dummy-" + std::to_string(number + 1), extras.size(),
                  parameters.size(), candidate});
  for (const std::size_t p : parameters) {
    ExtraColumn column;
    column.groups = problem.parameters()[p].groups;
    const std::uint32_t parts = 1 + random.below(2);
    for (std::uint32_t part = 0; part < parts; ++part) {
      const CurveBasis* curve = basis(system, random.below(conditions));
      if (curve->size() < 2) continue;
      std::vector<double> rough(curve->size() + 2), smooth(curve->size());
      for (double& v : rough) v = random.normal();
      for (std::size_t k = 0; k < smooth.size(); ++k) smooth[k] = (rough[k] + 2 * rough[k + 1] + rough[k + 2]) / 4;
      column.parts.push_back({curve, std::move(smooth)});
    }
    extras.push_back(std::move(column));
  }
}

std::vector<std::size_t> Projection::columns(const Structures& structures, std::size_t structure) const {
  const Structure& s = structures.list[structure];
  const std::size_t start =
      linearisation.own + s.first + (s.kind == Structure::Kind::mechanism ? 0 : structures.signature_columns);
  std::vector<std::size_t> result(s.count);
  for (std::size_t k = 0; k < s.count; ++k) result[k] = start + k;
  return result;
}

std::vector<Eigen::Index> Projection::foreign(const Structures& structures, std::size_t structure) const {
  std::vector<Eigen::Index> result;
  for (const std::size_t c : columns(structures, structure))
    result.push_back(static_cast<Eigen::Index>(c - linearisation.own));
  return result;
}

Projection project(const System& system, const Fit& fit, const Structures& structures) {
  Projection p;
  p.linearisation = linearise(system, fit.values, fit.inner, structures.extras, structures.signatures);
  const Linearisation& l = p.linearisation;
  for (std::size_t c = 0; c < l.own; ++c) p.own.push_back(c);
  const auto own = static_cast<Eigen::Index>(l.own), all = static_cast<Eigen::Index>(l.columns.size());
  Eigen::MatrixXd joint = Eigen::MatrixXd::Zero(all + 1, all + 1);
  for (const GroupGram& gram : l.grams) {
    std::vector<Eigen::Index> places(gram.columns.begin(), gram.columns.end());
    places.push_back(all);
    joint(places, places) += gram.whole();
    p.rows += static_cast<double>(system.used_rows(gram.group));
  }
  p.squares = joint(all, all);
  const Eigen::MatrixXd cross = joint.block(0, own, own, all - own);
  const NormalEquations equations(l, p.own);
  p.coefficients = equations.solve(cross);
  p.full = joint.block(own, own, all - own, all - own);
  p.surviving = p.full - cross.transpose() * p.coefficients;
  p.surviving = (0.5 * (p.surviving + p.surviving.transpose())).eval();
  p.score = joint.block(own, all, all - own, 1) - p.coefficients.transpose() * joint.block(0, all, own, 1);
  return p;
}

namespace {

// Scores of one group: block (as numbered in the data) -> sums of surviving columns times residual.
struct GroupScores {
  std::map<std::uint32_t, Eigen::VectorXd> blocks;
  Eigen::MatrixXd raw_surviving;
  double norm = 0;
};

GroupScores group_scores(const System& system, const Projection& p, const Structures& structures, std::size_t group) {
  const Linearisation& l = p.linearisation;
  const Observations& o = system.observations();
  std::vector<std::size_t> columns;
  const Eigen::MatrixXd a = group_columns(system, l, structures.extras, structures.signatures, group, columns);
  const auto foreign = static_cast<Eigen::Index>(l.columns.size() - l.own);
  Eigen::MatrixXd surviving = Eigen::MatrixXd::Zero(a.rows(), foreign);
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k), c = static_cast<Eigen::Index>(columns[k]);
    if (columns[k] < l.own)
      surviving.noalias() -= a.col(column) * p.coefficients.row(c);
    else
      surviving.col(c - static_cast<Eigen::Index>(l.own)) += a.col(column);
  }
  GroupScores scores;
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    const std::size_t row = o.first[group] + static_cast<std::size_t>(i);
    if (!(system.weight(row) > 0)) continue;
    auto& sum = scores.blocks.try_emplace(o.block[row], Eigen::VectorXd::Zero(foreign)).first->second;
    sum += surviving.row(i).transpose() * a(i, a.cols() - 1);
    surviving.row(i) /= system.weight(row);
    scores.norm += o.norm[row];
  }
  scores.raw_surviving = surviving.transpose() * surviving;
  return scores;
}

}  // namespace

BlockScores block_scores(const System& system, const Projection& p, const Structures& structures) {
  std::vector<GroupScores> by_group(system.groups.size());
  parallel_for(0, by_group.size(),
               [&](std::size_t k) { by_group[k] = group_scores(system, p, structures, system.groups[k]); });
  BlockScores result;
  const auto foreign = static_cast<Eigen::Index>(p.linearisation.columns.size() - p.linearisation.own);
  result.raw_surviving = Eigen::MatrixXd::Zero(foreign, foreign);
  for (const GroupScores& scores : by_group) {
    result.blocks += scores.blocks.size();
    result.raw_surviving += scores.raw_surviving;
    result.norm += scores.norm;
  }
  result.inflation = p.rows / std::max(1.0, p.rows - static_cast<double>(p.own.size()));
  for (std::size_t s = 0; s < structures.list.size(); ++s) {
    std::vector<Eigen::Index> kept;
    for (const Eigen::Index c : p.foreign(structures, s))
      if (p.surviving(c, c) > visible_share * visible_share * p.full(c, c)) kept.push_back(c);
    stats::ScoreFamily family{kept.size(), {}};
    for (const GroupScores& scores : by_group)
      for (const auto& [block, sum] : scores.blocks)
        for (const Eigen::Index c : kept) family.contributions.push_back(sum[c]);
    result.families.push_back(std::move(family));
  }
  return result;
}

}  // namespace gonio::explain

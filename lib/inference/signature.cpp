// See signature.h. With A the free parameters' columns and S the foreign ones, both whitened, what survives is
// S_perp = S - A (A'A)^-1 A'S; its Gram matrix is the Schur complement of the joint one.
#include "inference/signature.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "base/parallel.h"
#include "base/random.h"
#include "linear/blocks.h"
#include "stats/distributions.h"
#include "stats/intervals.h"

namespace gonio::inference {
namespace {

constexpr std::size_t knots_of_a_curve = 6;
constexpr std::size_t most_moved = 4;  // parameters of a mechanism that are tried elsewhere than at their start

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
  list.push_back({Structure::Kind::mechanism, candidate, c.id(), signature_columns, c.parameters.size(), 0, {}});
  signature_columns += c.parameters.size();
  signatures.push_back(std::move(signature));
}

namespace {

constexpr double spanned = 0.05;  // of a change's length may lie outside the slopes' span
constexpr std::size_t most_changes = 6;

// Other values of a parameter on either side of its start: in ratios where it is positive by nature, else in parts of
// the way to the bounds.
std::vector<double> other_values(const Parameter& p) {
  std::vector<double> values;
  const bool positive = p.lower >= 0 && p.start > 0;
  const double below[2] = {positive ? p.start / 3 : 0.4 * p.start + 0.6 * p.lower,
                           positive ? p.start / 1.7 : 0.7 * p.start + 0.3 * p.lower};
  const double above[2] = {positive ? p.start * 1.7 : 0.7 * p.start + 0.3 * p.upper,
                           positive ? p.start * 3 : 0.4 * p.start + 0.6 * p.upper};
  for (const double v : {std::max(below[0], p.lower), std::max(below[1], p.lower), std::min(above[0], p.upper),
                         std::min(above[1], p.upper)})
    if (std::isfinite(v) && v != p.start && (values.empty() || values.back() != v)) values.push_back(v);
  return values;
}

std::size_t largest_group(const System& system) {
  std::size_t best = system.groups[0];
  for (const std::size_t g : system.groups)
    if (system.used_rows(g) > system.used_rows(best)) best = g;
  return best;
}

}  // namespace

void Structures::add_changes(const System& system, const std::vector<double>& values, std::size_t candidate) {
  const Problem& problem = system.problem();
  const Candidate& c = problem.candidates()[candidate];
  if (c.gradual) return;
  std::vector<double> start;
  for (const std::size_t p : c.parameters) {
    if (!problem.parameters()[p].groups.empty()) return;
    start.push_back(problem.parameters()[p].start);
  }
  std::vector<std::vector<double>> points = {start};
  for (std::size_t k = 0; k < start.size() && start.size() <= most_moved; ++k)
    for (const double v : other_values(problem.parameters()[c.parameters[k]])) {
      points.push_back(start);
      points.back()[k] = v;
    }
  const std::size_t group = largest_group(system);
  const auto at = [&](const std::vector<double>& point) {
    std::vector<double> there = values;
    for (std::size_t k = 0; k < point.size(); ++k) there[c.parameters[k]] = point[k];
    return there;
  };
  const Eigen::VectorXd here = system.residual(values, group);
  Eigen::MatrixXd changes(here.size(), static_cast<Eigen::Index>(points.size()));
  for (std::size_t k = 0; k < points.size(); ++k)
    changes.col(static_cast<Eigen::Index>(k)) = here - system.residual(at(points[k]), group);
  const Eigen::VectorXd outside = linear::lengths_outside(system.jacobian(at(start), group, c.parameters), changes);
  std::vector<std::pair<double, std::size_t>> kept;  // part that the slopes do not span, the largest first
  for (Eigen::Index k = 0; k < outside.size(); ++k)
    if (outside[k] > spanned * changes.col(k).norm()) kept.emplace_back(-outside[k], static_cast<std::size_t>(k));
  std::sort(kept.begin(), kept.end());
  if (kept.size() > most_changes) kept.resize(most_changes);
  for (const auto& [length, k] : kept) {
    list.push_back({Structure::Kind::change, candidate, c.id(), signature_columns, 1, 0, points[k]});
    signature_columns += 1;
    signatures.push_back({at(points[k]), {}});
  }
}

void Structures::add_curve(const System& system, std::size_t condition) {
  const CurveBasis* curve = basis(system, condition);
  if (curve->size() < 2) return;
  list.push_back({Structure::Kind::curve,
                  condition,
                  system.observations().conditions[condition].name,
                  extras.size(),
                  curve->size(),
                  0,
                  {}});
  for (std::size_t k = 0; k < curve->size(); ++k) {
    std::vector<double> hat(curve->size(), 0.0);
    hat[k] = 1;
    extras.push_back({{{curve, std::move(hat)}}, {}});
  }
}

void Structures::add_wave(const System& system, std::size_t condition, double period) {
  constexpr double knots_of_a_period = 12;
  double lower = std::numeric_limits<double>::infinity(), upper = -lower;
  for (const double v : system.observations().conditions[condition].values)
    if (std::isfinite(v)) lower = std::min(lower, v), upper = std::max(upper, v);
  CurveBasis wave{condition, {}};
  for (double x = lower; x < upper + period / knots_of_a_period; x += period / knots_of_a_period)
    wave.knots.push_back(x);
  bases_of_waves_.push_back(std::move(wave));
  const CurveBasis& basis = bases_of_waves_.back();
  if (basis.size() < 2) return;
  Structure structure{Structure::Kind::curve,
                      condition,
                      system.observations().conditions[condition].name,
                      extras.size(),
                      0,
                      0,
                      {},
                      period};
  for (const std::size_t g : system.groups)
    for (const double ahead : {0.0, 0.25}) {
      std::vector<double> swing;
      for (const double x : basis.knots) swing.push_back(std::cos(2 * std::numbers::pi * (x / period - ahead)));
      extras.push_back({{{&basis, std::move(swing)}}, {g}});
      ++structure.count;
    }
  list.push_back(std::move(structure));
}

void Structures::add_negative_control(const System& system, std::size_t candidate, std::size_t number,
                                      std::uint64_t seed) {
  const Problem& problem = system.problem();
  const auto conditions = static_cast<std::uint32_t>(system.observations().conditions.size());
  if (conditions == 0) return;
  Random random(seed, 0x64756d6d79u + number);
  const std::vector<std::size_t>& parameters = problem.candidates()[candidate].parameters;
  list.push_back({Structure::Kind::negative_control,
                  number,
                  "negative-control-" + std::to_string(number + 1),
                  extras.size(),
                  parameters.size(),
                  candidate,
                  {}});
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
      linearisation.own + s.first +
      (s.kind == Structure::Kind::curve || s.kind == Structure::Kind::negative_control ? structures.signature_columns
                                                                                       : 0);
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
  p.linearisation =
      linearise(system, fit.values, fit.inner, structures.extras, structures.signatures, nullptr, &p.columns_of);
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
  std::map<std::uint32_t, Eigen::VectorXd> blocks, squares;  // squares: of the columns' length
  bool stated = false;                                       // priors: their noise is what a calibration states
  Eigen::MatrixXd raw_surviving;
  Eigen::VectorXd variance;
  double norm = 0;
};

GroupScores group_scores(const System& system, const Projection& p, const Structures& structures, std::size_t place) {
  const Linearisation& l = p.linearisation;
  const Observations& o = system.observations();
  const std::size_t group = system.groups[place];
  std::vector<std::size_t> columns = l.grams[place].columns;
  Eigen::MatrixXd anew;
  if (p.columns_of.empty()) anew = group_columns(system, l, structures.extras, structures.signatures, group, columns);
  const Eigen::MatrixXd& a = p.columns_of.empty() ? anew : p.columns_of[place];
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
    scores.squares.try_emplace(o.block[row], Eigen::VectorXd::Zero(foreign)).first->second +=
        surviving.row(i).transpose().cwiseAbs2();
    surviving.row(i) /= system.weight(row);
    scores.norm += o.norm[row];
  }
  scores.raw_surviving = linear::gram_of(surviving);
  scores.variance = Eigen::VectorXd::Zero(foreign);
  for (const auto& [block, sum] : scores.blocks) scores.variance += sum.cwiseAbs2();
  return scores;
}

}  // namespace

namespace {

// What the free parameters' priors say: with r - A x the data's part of the score is S'r + C'q, C the coefficients of
// the projection and q the pull of the priors at the optimum; the priors' part is -C'q, one block for each.
GroupScores prior_scores(const Projection& p) {
  GroupScores scores;
  scores.stated = true;
  const Eigen::Index foreign = p.surviving.cols();
  scores.raw_surviving = Eigen::MatrixXd::Zero(foreign, foreign);
  scores.variance = Eigen::VectorXd::Zero(foreign);
  for (std::size_t c = 0; c < p.own.size(); ++c) {
    const LinearColumn& column = p.linearisation.columns[p.own[c]];
    if (!(column.prior_precision > 0)) continue;
    const Eigen::VectorXd coefficients = p.coefficients.row(static_cast<Eigen::Index>(c)).transpose();
    const auto block = static_cast<std::uint32_t>(c);
    scores.blocks[block] = -column.prior_pull * coefficients;
    scores.squares[block] = column.prior_precision * coefficients.cwiseAbs2();
    scores.variance += scores.blocks[block].cwiseAbs2();
  }
  return scores;
}

constexpr std::size_t dust_blocks = 3;
constexpr double median_of_chi2 = 0.4549364231195724;  // one degree of freedom

double trimmed_score(const std::vector<GroupScores>& groups, Eigen::Index column) {
  std::vector<std::pair<double, double>> blocks;  // score, squared length
  std::vector<double> ratio;
  double largest = 0, stated = 0, stated_length = 0;
  for (const GroupScores& g : groups)
    for (const auto& [block, length] : g.squares) {
      if (g.stated) {
        stated += g.blocks.at(block)[column];
        stated_length += length[column];
        continue;
      }
      blocks.emplace_back(g.blocks.at(block)[column], length[column]);
      largest = std::max(largest, length[column]);
    }
  for (const auto& [u, length] : blocks)
    if (length > 1e-6 * largest) ratio.push_back(u * u / length);
  if (blocks.size() <= 4 * dust_blocks || ratio.size() <= 4 * dust_blocks) return 0;
  std::stable_sort(blocks.begin(), blocks.end(),
                   [](const auto& a, const auto& b) { return std::abs(a.first) > std::abs(b.first); });
  double score = stated, length = 0;
  for (std::size_t b = dust_blocks; b < blocks.size(); ++b) score += blocks[b].first, length += blocks[b].second;
  const double variance = std::max(1.0, stats::median(ratio) / median_of_chi2) * length + stated_length;
  return variance > 0 ? score * score / variance : 0;
}

}  // namespace

double concentrated_p(const Projection& p, const Structures& structures, const BlockScores& scores) {
  double largest = 0, looks = 0;
  for (std::size_t s = 0; s < structures.list.size(); ++s) {
    const Structure::Kind kind = structures.list[s].kind;
    if (kind == Structure::Kind::negative_control) continue;
    for (const Eigen::Index c : p.foreign(structures, s)) {
      if (!(p.surviving(c, c) > visible_share * visible_share * p.full(c, c))) continue;
      largest = std::max(largest, scores.trimmed[c]);
      looks += 1;
    }
  }
  return looks > 0 ? stats::sidak(stats::chi2_upper(largest, 1), looks) : 1;
}

BlockScores block_scores(const System& system, Projection& p, const Structures& structures) {
  std::vector<GroupScores> by_group(system.groups.size());
  parallel_for(0, by_group.size(), [&](std::size_t k) { by_group[k] = group_scores(system, p, structures, k); });
  p.columns_of = {};
  by_group.push_back(prior_scores(p));
  BlockScores result;
  const auto foreign = static_cast<Eigen::Index>(p.linearisation.columns.size() - p.linearisation.own);
  result.raw_surviving = Eigen::MatrixXd::Zero(foreign, foreign);
  result.variance = Eigen::VectorXd::Zero(foreign);
  for (const GroupScores& scores : by_group) {
    result.blocks += scores.blocks.size();
    result.raw_surviving += scores.raw_surviving;
    result.variance += scores.variance;
    result.norm += scores.norm;
  }
  result.trimmed = Eigen::VectorXd::Zero(foreign);
  parallel_for(0, static_cast<std::size_t>(foreign), [&](std::size_t c) {
    result.trimmed[static_cast<Eigen::Index>(c)] = trimmed_score(by_group, static_cast<Eigen::Index>(c));
  });
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

}  // namespace gonio::inference

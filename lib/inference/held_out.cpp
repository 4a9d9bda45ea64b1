// See fit.h: scores on groups that a fit has not seen.
//
// A held-out group's shared parameters come from the other groups alone. Its nuisance (a board's pose) cannot: it is
// fitted on one half of the group's blocks and judged on the other half, and the reverse, so that every row is judged
// once.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/parallel.h"
#include "inference/fit.h"
#include "inference/scaling.h"
#include "linear/solve.h"
#include "stats/distributions.h"

namespace gonio::inference {
namespace {

struct GroupScore {
  double whitened = 0, raw = 0, norm = 0, rows = 0;
};

// Adds the rows of `group` that belong to `half` (-1: both) under `values`. Blocks never straddle groups.
void judge(const System& system, const std::vector<double>& values, std::size_t group, int half, GroupScore& score,
           std::vector<double>& blocks) {
  const Observations& o = system.observations();
  const Eigen::VectorXd r = system.residual(values, group);
  for (std::size_t i = o.first[group]; i < o.first[group + 1]; ++i) {
    const double w = system.weight(i);
    if (!(w > 0) || (half >= 0 && system.half(i) != half)) continue;
    const double z = r[static_cast<Eigen::Index>(i - o.first[group])];
    score.whitened += z * z;
    score.raw += z * z / (w * w);
    score.norm += o.norm[i];
    score.rows += 1;
    blocks[o.block[i]] += z * z;
  }
}

std::vector<double> no_blocks(const System& system) {
  const std::vector<std::uint32_t>& block = system.observations().block;
  return std::vector<double>(block.empty() ? 0 : *std::max_element(block.begin(), block.end()) + 1, 0.0);
}

HeldOut gathered(const std::vector<GroupScore>& scores, std::vector<double> blocks = {}) {
  HeldOut result;
  result.blocks = std::move(blocks);
  for (const GroupScore& s : scores) {
    result.whitened.push_back(s.whitened);
    result.raw.push_back(s.raw);
    result.norm.push_back(s.norm);
    result.rows.push_back(s.rows);
  }
  return result;
}

// Step of the group's own columns on one half of its Gram matrix, the shared ones having moved by `shared`.
struct LocalStep {
  std::vector<Eigen::Index> places;  // in the gram
  std::vector<std::size_t> columns;  // in the linearisation
  Eigen::VectorXd step;
};
LocalStep local_step(const Linearisation& l, const GroupGram& gram, const std::vector<char>& in_play,
                     const Eigen::VectorXd& shared, int half) {
  LocalStep result;
  for (std::size_t k = 0; k < gram.columns.size(); ++k) {
    const std::size_t c = gram.columns[k];
    if (!in_play[c] || l.columns[c].local != gram.group) continue;
    result.places.push_back(static_cast<Eigen::Index>(k));
    result.columns.push_back(c);
  }
  if (result.places.empty()) return result;
  const Eigen::MatrixXd& h = gram.half[static_cast<std::size_t>(half)];
  const Eigen::Index last = h.rows() - 1;
  Eigen::MatrixXd own = h(result.places, result.places);
  Eigen::VectorXd rhs = h(result.places, last) - h(result.places, Eigen::seq(0, last - 1)) * shared;
  for (std::size_t k = 0; k < result.places.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    own(i, i) += l.columns[result.columns[k]].prior_precision;
    rhs[i] += l.columns[result.columns[k]].prior_pull;
  }
  const Eigen::VectorXd scale = unit_scale(own.diagonal());
  Eigen::MatrixXd scaled = scale.asDiagonal() * own * scale.asDiagonal();
  scaled.diagonal().array() += 1e-9;
  result.step = scale.asDiagonal() * linear::solve_ldlt(scaled, Eigen::VectorXd(scale.asDiagonal() * rhs));
  return result;
}

// What one fold found: the steps of the shared columns, by column, and by place in the held-out group's gram.
struct Fold {
  std::vector<char> in_play;
  Eigen::VectorXd step, in_gram;
};
Fold fold_of(const Linearisation& l, const std::vector<std::size_t>& columns, const LeaveOneOut& others,
             const WithoutGroup& without, const GroupGram& gram) {
  Fold fold{std::vector<char>(l.columns.size(), 0), Eigen::VectorXd::Zero(static_cast<Eigen::Index>(l.columns.size())),
            Eigen::VectorXd::Zero(static_cast<Eigen::Index>(gram.columns.size()))};
  for (const std::size_t c : columns) fold.in_play[c] = 1;
  for (std::size_t k = 0; k < others.shared().size(); ++k)
    fold.step[static_cast<Eigen::Index>(others.shared()[k])] = without.moved(static_cast<Eigen::Index>(k), 0);
  for (std::size_t k = 0; k < gram.columns.size(); ++k) {
    const std::size_t c = gram.columns[k];
    if (fold.in_play[c] && l.columns[c].local != gram.group)
      fold.in_gram[static_cast<Eigen::Index>(k)] = fold.step[static_cast<Eigen::Index>(c)];
  }
  return fold;
}

GroupScore unseen_group(const System& system, const Fit& fit, std::size_t group, std::vector<double>& blocks,
                        const Slopes* kept) {
  std::vector<std::size_t> own;
  for (const std::size_t p : fit.active) {
    const auto seen = [&](std::size_t g) { return g != group && system.touches(p, g); };
    if (system.touches(p, group) && std::none_of(system.groups.begin(), system.groups.end(), seen)) own.push_back(p);
  }
  GroupScore score;
  if (own.empty()) {
    judge(system, fit.values, group, -1, score, blocks);
    return score;
  }
  for (const int half : {0, 1}) {
    const Fit local = inference::fit(system.restricted(group, half), fit.values, own, 60, kept);
    judge(system, local.values, group, 1 - half, score, blocks);
  }
  return score;
}

}  // namespace

double HeldOut::score() const {
  double sum = 0, total = 0;
  for (std::size_t k = 0; k < raw.size(); ++k) sum += raw[k], total += norm[k];
  return total > 0 ? std::sqrt(sum / total) : 0;
}

HeldOut held_out_by_step(const System& system, const Fit& fit, const Slopes* kept) {
  const Linearisation l = linearise(system, fit.values, fit.inner, {}, {}, kept);
  std::vector<double> blocks = no_blocks(system);
  std::vector<std::size_t> columns(l.columns.size());
  for (std::size_t c = 0; c < columns.size(); ++c) columns[c] = c;
  std::vector<GroupScore> scores(l.grams.size());
  const LeaveOneOut others(l, columns);
  others.each([&](std::size_t g, const WithoutGroup& without) {
    const GroupGram& gram = l.grams[g];
    const Fold fold = fold_of(l, columns, others, without, gram);
    std::vector<double> values = fit.values;
    const auto move = [&](std::size_t c, double step) {
      const std::size_t p = l.columns[c].parameter;
      values[p] = system.clamped(p, fit.values[p] + step);
    };
    for (std::size_t c = 0; c < columns.size(); ++c)
      if (l.columns[c].local == LinearColumn::everywhere) move(c, fold.step[static_cast<Eigen::Index>(c)]);
    for (const int half : {0, 1}) {
      const LocalStep own = local_step(l, gram, fold.in_play, fold.in_gram, half);
      for (std::size_t k = 0; k < own.columns.size(); ++k) move(own.columns[k], own.step[static_cast<Eigen::Index>(k)]);
      judge(system, values, gram.group, own.columns.empty() ? -1 : 1 - half, scores[g], blocks);
      if (own.columns.empty()) break;
    }
  });
  return gathered(scores, std::move(blocks));
}

HeldOut held_out_linear(const System& system, const Linearisation& l, const std::vector<std::size_t>& columns) {
  std::vector<GroupScore> scores(l.grams.size());
  const LeaveOneOut others(l, columns);
  others.each([&](std::size_t g, const WithoutGroup& without) {
    const GroupGram& gram = l.grams[g];
    const Fold fold = fold_of(l, columns, others, without, gram);
    for (const int half : {0, 1}) {
      const LocalStep own = local_step(l, gram, fold.in_play, fold.in_gram, half);
      Eigen::VectorXd step(fold.in_gram.size() + 1);
      step << -fold.in_gram, 1;  // residual after the step: r - J step
      for (std::size_t k = 0; k < own.places.size(); ++k) step[own.places[k]] = -own.step[static_cast<Eigen::Index>(k)];
      const Eigen::MatrixXd judged = own.places.empty() ? gram.whole() : gram.half[static_cast<std::size_t>(1 - half)];
      scores[g].whitened += std::max(0.0, step.dot(judged * step));
      if (own.places.empty()) break;
    }
    scores[g].rows = static_cast<double>(system.used_rows(gram.group));
  });
  return gathered(scores);
}

HeldOut held_out_by_refit(const System& system, const Fit& fit) {
  const Slopes kept = slopes(system, fit.values, fit.active);
  std::vector<GroupScore> scores;
  std::vector<double> blocks = no_blocks(system);
  for (const std::size_t group : system.groups) {
    System others = system;
    std::erase(others.groups, group);
    const Fit fold = inference::fit(others, fit.values, fit.active, 60, &kept);
    scores.push_back(unseen_group(others, fold, group, blocks, &kept));
  }
  return gathered(scores, std::move(blocks));
}

HeldOut unseen_groups(const System& system, const Fit& fit, const std::vector<std::size_t>& unseen) {
  std::vector<GroupScore> scores;
  std::vector<double> blocks = no_blocks(system);
  for (const std::size_t group : unseen) scores.push_back(unseen_group(system, fit, group, blocks, nullptr));
  return gathered(scores, std::move(blocks));
}

Gain gain(const HeldOut& before, const HeldOut& after) {
  const std::size_t n = before.whitened.size();
  double rows = 0;
  for (const double r : before.rows) rows += r;
  Gain g;
  if (n == 0 || !(rows > 0)) return g;
  const double scale = static_cast<double>(n) / rows;
  std::vector<double> fall(n);
  for (std::size_t k = 0; k < n; ++k) {
    fall[k] = (before.whitened[k] - after.whitened[k]) * scale;
    g.mean += fall[k] / static_cast<double>(n);
  }
  double sum = 0;
  for (const double f : fall) sum += (f - g.mean) * (f - g.mean);
  if (!std::isfinite(g.mean)) return {std::numeric_limits<double>::lowest(), std::numeric_limits<double>::max()};
  g.sigma = n > 1 ? std::sqrt(sum / static_cast<double>(n * (n - 1))) : std::abs(g.mean);
  return g;
}

double block_z(const HeldOut& before, const HeldOut& after) {
  double sum = 0, squares = 0;
  for (std::size_t b = 0; b < std::min(before.blocks.size(), after.blocks.size()); ++b) {
    const double fall = before.blocks[b] - after.blocks[b];
    sum += fall;
    squares += fall * fall;
  }
  return squares > 0 ? sum / std::sqrt(squares) : 0;
}

double errors_between(const HeldOut& before, const HeldOut& after, double floor) {
  constexpr std::size_t enough_groups = 5;  // for a standard error over groups to mean something
  const Gain g = gain(before, after);
  const std::size_t groups = before.whitened.size();
  if (!(g.sigma < std::numeric_limits<double>::max())) return -at_most_errors;
  if (groups < enough_groups) {
    const double blocks = block_z(before, after);
    const double sigma = blocks != 0 ? std::abs(g.mean / blocks) : 0;
    const double all = std::hypot(sigma, floor);
    return all > 0 ? std::clamp(g.mean / all, -at_most_errors, at_most_errors) : 0;
  }
  const double sigma = std::hypot(g.sigma, floor);
  if (!(sigma > 0)) return g.mean > 0 ? at_most_errors : 0;
  const double t = g.mean / sigma;
  const double tail = stats::student_upper(std::abs(t), static_cast<double>(groups) - 1);
  return std::copysign(std::min(stats::normal_upper_quantile(tail), at_most_errors), t);
}

}  // namespace gonio::inference

// See plan.h.
#include "inference/plan.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "inference/fit.h"
#include "linear/blocks.h"
#include "linear/solve.h"

namespace gonio::inference {
namespace {

constexpr std::size_t most_of_a_pair = 3, most_unseen = 4, most_shown = 3;
constexpr double least_z = 1, clearly = 3;

// Derivatives of what a proposal would give, with respect to the shared parameters that are free.
struct Uncertain {
  std::vector<std::size_t> parameters;
  Eigen::MatrixXd covariance;
};
Uncertain uncertain_parameters(const Problem& problem, const Explanation& e) {
  Uncertain u;
  std::vector<std::size_t> places;
  for (std::size_t k = 0; k < e.active.size(); ++k) {
    if (!problem.parameters()[e.active[k]].groups.empty()) continue;
    u.parameters.push_back(e.active[k]);
    places.push_back(k);
  }
  const auto n = static_cast<Eigen::Index>(places.size());
  u.covariance.resize(n, n);
  for (Eigen::Index a = 0; a < n; ++a)
    for (Eigen::Index b = 0; b < n; ++b)
      u.covariance(a, b) =
          e.covariance[places[static_cast<std::size_t>(a)] * e.active.size() + places[static_cast<std::size_t>(b)]];
  return u;
}

// One proposal about the fit, whitened: its rows, what its own numbers can imitate, what the shared ones leave open.
class Prospect {
 public:
  Prospect(const Problem& problem, const Explanation& e, const Uncertain& uncertain, std::size_t proposal)
      : problem_(problem),
        proposal_(proposal),
        noise_factor_(e.noise_factor),
        at_(problem.propose(e.values, proposal)) {
    const auto rows = static_cast<Eigen::Index>(at_.prediction.size());
    Eigen::MatrixXd nuisance(rows, static_cast<Eigen::Index>(at_.nuisance.size()));
    for (Eigen::Index c = 0; c < nuisance.cols(); ++c)
      for (Eigen::Index i = 0; i < rows; ++i)
        nuisance(i, c) = at_.nuisance[static_cast<std::size_t>(c)][static_cast<std::size_t>(i)] / sigma(i);
    for (Eigen::Index c = 0; c < nuisance.cols(); ++c)
      if (const double length = nuisance.col(c).norm(); length > 0) nuisance.col(c) /= length;
    basis_ = linear::basis_of(nuisance);
    open_ = Eigen::MatrixXd(rows, 0);
    if (uncertain.parameters.empty() || rows == 0) return;
    // sqrt(C) folded into the derivatives: 1 + J C J' = 1 + K K'.
    Eigen::MatrixXd j(rows, static_cast<Eigen::Index>(uncertain.parameters.size()));
    for (std::size_t k = 0; k < uncertain.parameters.size(); ++k)
      j.col(static_cast<Eigen::Index>(k)) = derivative(e.values, uncertain.parameters[k]);
    const linear::EigenPairs eigen = linear::eigen_of(uncertain.covariance);
    const Eigen::VectorXd root = eigen.values.cwiseMax(0).cwiseSqrt();
    open_ = without_nuisance(j) * eigen.vectors * root.asDiagonal();
  }

  // By how many standard errors the measurement would part the fit from `other`.
  double z(const std::vector<double>& other) const {
    const ProposedRows there = problem_.propose(other, proposal_);
    if (there.prediction.size() != at_.prediction.size() || at_.prediction.empty()) return 0;
    Eigen::MatrixXd d(static_cast<Eigen::Index>(at_.prediction.size()), 1);
    for (Eigen::Index i = 0; i < d.rows(); ++i) {
      const auto row = static_cast<std::size_t>(i);
      d(i, 0) = (there.prediction[row] - at_.prediction[row]) / sigma(i);
    }
    d = without_nuisance(d);
    const Eigen::MatrixXd inner = Eigen::MatrixXd::Identity(open_.cols(), open_.cols()) + open_.transpose() * open_;
    const Eigen::VectorXd shared = open_.transpose() * d;
    const double squared = d.squaredNorm() - (shared.size() > 0 ? shared.dot(linear::solve_ldlt(inner, shared)) : 0);
    return std::isfinite(squared) ? std::sqrt(std::max(0.0, squared)) : 0;
  }

 private:
  double sigma(Eigen::Index row) const { return noise_factor_ * at_.sigma[static_cast<std::size_t>(row)]; }
  Eigen::MatrixXd without_nuisance(const Eigen::MatrixXd& m) const { return m - basis_ * (basis_.transpose() * m); }
  Eigen::VectorXd derivative(std::vector<double> values, std::size_t parameter) const {
    const Parameter& p = problem_.parameters()[parameter];
    const double centre = values[parameter], step = 1e-4 * p.size;
    const double upper = std::min(centre + step, std::max(p.upper, centre));
    const double lower = std::max(centre - step, std::min(p.lower, centre));
    values[parameter] = upper;
    const ProposedRows above = problem_.propose(values, proposal_);
    values[parameter] = lower;
    const ProposedRows below = problem_.propose(values, proposal_);
    Eigen::VectorXd d(static_cast<Eigen::Index>(at_.prediction.size()));
    for (Eigen::Index i = 0; i < d.size(); ++i) {
      const auto row = static_cast<std::size_t>(i);
      d[i] = (above.prediction[row] - below.prediction[row]) / ((upper - lower) * sigma(i));
    }
    return d.allFinite() ? d : Eigen::VectorXd::Zero(d.size());
  }

  const Problem& problem_;
  std::size_t proposal_;
  double noise_factor_;
  ProposedRows at_;
  Eigen::MatrixXd basis_, open_;
};

bool is_of(const Candidate& candidate, std::size_t parameter) {
  return std::find(candidate.parameters.begin(), candidate.parameters.end(), parameter) != candidate.parameters.end();
}

// The fit with `other` in the place of `named`.
std::vector<double> exchanged(const System& system, const Explanation& e, std::size_t named, std::size_t other) {
  const Problem& problem = system.problem();
  const Candidate &leaves = problem.candidates()[named], &joins = problem.candidates()[other];
  std::vector<double> start = e.values;
  std::vector<std::size_t> active;
  for (const std::size_t p : e.active)
    if (!is_of(leaves, p) && !is_of(joins, p)) active.push_back(p);
  for (const std::size_t p : leaves.parameters) start[p] = problem.parameters()[p].neutral;
  for (const std::size_t p : joins.parameters) {
    start[p] = problem.parameters()[p].start;
    active.push_back(p);
  }
  return fit(system, std::move(start), active).values;
}

// What a measurement sets: an exposure, a lamp.
std::vector<std::string> kind_of(const PlannedMeasurement& planned) {
  std::vector<std::string> keys;
  if (planned.setup.is_object())
    for (const auto& [key, value] : planned.setup.as_object()) keys.push_back(key);
  return keys;
}

// The most telling: first the best of each kind, since who cannot set one thing may set another, then what is left.
void keep_best(std::vector<PlannedMeasurement> found, double least, std::size_t most, Explanation& e) {
  std::erase_if(found, [&](const PlannedMeasurement& p) { return !(p.z >= least); });
  std::stable_sort(found.begin(), found.end(),
                   [](const PlannedMeasurement& a, const PlannedMeasurement& b) { return a.z > b.z; });
  std::vector<std::vector<std::string>> kinds;
  std::vector<PlannedMeasurement> kept, others;
  for (PlannedMeasurement& p : found) {
    const std::vector<std::string> kind = kind_of(p);
    const bool first = std::ranges::find(kinds, kind) == kinds.end();
    if (first) kinds.push_back(kind);
    (first ? kept : others).push_back(std::move(p));
  }
  std::ranges::move(others, std::back_inserter(kept));
  if (kept.size() > most) kept.resize(most);
  std::ranges::move(kept, std::back_inserter(e.plan));
}

}  // namespace

void make_plan(const System& system, Explanation& e) {
  const Problem& problem = system.problem();
  std::vector<std::size_t> unseen;
  for (const Isolability& i : e.isolability)
    if (!i.visible && unseen.size() < most_unseen) unseen.push_back(i.candidate);
  if (e.not_told_apart.empty() && unseen.empty()) return;
  const std::vector<Proposal> proposals = problem.proposals();
  if (proposals.empty()) return;
  const Uncertain uncertain = uncertain_parameters(problem, e);
  std::vector<Prospect> prospects;
  for (std::size_t k = 0; k < proposals.size(); ++k) prospects.emplace_back(problem, e, uncertain, k);
  const auto compared = [&](const std::vector<double>& other, const std::vector<std::size_t>& separates) {
    std::vector<PlannedMeasurement> list;
    for (std::size_t k = 0; k < proposals.size(); ++k)
      list.push_back(
          {proposals[k].sentence, proposals[k].setup, separates, prospects[k].z(other), proposals[k].floor_plan});
    return list;
  };
  for (const std::vector<std::size_t>& set : e.not_told_apart)
    for (std::size_t k = 1; k < set.size(); ++k)
      keep_best(compared(exchanged(system, e, set[0], set[k]), {set[0], set[k]}), least_z, most_of_a_pair, e);
  std::stable_sort(e.plan.begin(), e.plan.end(),
                   [](const PlannedMeasurement& a, const PlannedMeasurement& b) { return a.z > b.z; });
  std::size_t shown = 0;
  for (const std::size_t c : unseen) {
    std::vector<double> with = e.values;
    for (const std::size_t p : problem.candidates()[c].parameters) with[p] = problem.parameters()[p].start;
    const std::size_t before = e.plan.size();
    if (shown < most_shown) keep_best(compared(with, {c}), clearly, 1, e);
    shown += e.plan.size() - before;
  }
}

}  // namespace gonio::inference

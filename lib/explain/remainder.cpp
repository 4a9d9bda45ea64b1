// See race.h: what is left in the residuals of a model. The null test, location, free curves and dummies all share one
// projection.
#include <algorithm>
#include <cmath>

#include "explain/global_test.h"
#include "explain/race.h"
#include "stats/sign_flip.h"

namespace gonio::explain {
namespace {

// A structure as a hypothesis that enters linearly: held-out gain by Gauss-Newton folds on the Gram matrices.
Hypothesis linear_hypothesis(const Race& race, const Projection& p, const Structures& structures, std::size_t s,
                             const HeldOut& before, const BlockScores& scores) {
  Hypothesis h;
  h.kind = structures.list[s].kind == Structure::Kind::dummy ? Hypothesis::Kind::dummy : Hypothesis::Kind::free_curve;
  h.name = structures.list[s].name;
  if (h.kind == Hypothesis::Kind::dummy) h.candidates = {structures.list[s].shape};
  std::vector<std::size_t> columns = p.own;
  const std::vector<std::size_t> added = p.columns(structures, s);
  columns.insert(columns.end(), added.begin(), added.end());
  const HeldOut after = held_out_linear(race.system(), p.linearisation, columns);
  const Gain g = gain(before, after);
  h.gain = g.mean;
  h.gain_sigma = g.sigma;
  double squares_before = 0, squares_after = 0;
  for (std::size_t k = 0; k < before.whitened.size(); ++k)
    squares_before += before.whitened[k], squares_after += after.whitened[k];
  const double ratio = squares_before > 0 ? std::sqrt(squares_after / squares_before) : 1;
  h.held_out = ratio;
  if (race.system().problem().importance() == Importance::share_of_residual) {
    h.effect = 1 - ratio;
    return h;
  }
  const NormalEquations equations(p.linearisation, columns);
  const Eigen::MatrixXd solution = equations.solve(equations.gradient());
  const Eigen::VectorXd step = solution.col(0).tail(static_cast<Eigen::Index>(added.size()));
  const std::vector<Eigen::Index> places = p.foreign(structures, s);
  h.effect = std::sqrt(std::max(0.0, step.dot(scores.raw_surviving(places, places) * step)) / scores.norm);
  return h;
}

// Has the mechanism a number of its own for every group?
bool of_single_groups(const System& system, const Structure& structure) {
  if (structure.kind != Structure::Kind::mechanism) return false;
  const std::vector<Parameter>& all = system.problem().parameters();
  const std::vector<std::size_t>& own = system.problem().candidates()[structure.index].parameters;
  return std::all_of(own.begin(), own.end(), [&](std::size_t p) { return all[p].groups.size() == 1; }) &&
         own.size() >= system.groups.size();
}

void sort_by_gain(std::vector<Hypothesis>& list) {
  std::stable_sort(list.begin(), list.end(), [](const Hypothesis& a, const Hypothesis& b) { return a.gain > b.gain; });
}

}  // namespace

Remainder remainder(const Race& race, const Model& model, const Options& options) {
  const System& system = race.system();
  Structures structures;
  const std::vector<std::size_t> open = race.open_to(model);
  for (const std::size_t c : open) structures.add_mechanism(system, model.fit.values, c);
  for (std::size_t c = 0; c < system.observations().conditions.size(); ++c) structures.add_curve(system, c);
  const std::vector<std::size_t>& shapes = race.allowed();
  for (std::size_t d = 0; d < options.dummies && !shapes.empty(); ++d)
    structures.add_dummy(system, shapes[d % shapes.size()], d, options.seed);

  Remainder r;
  const Projection p = project(system, model.fit, structures);
  BlockScores scores = block_scores(system, p, structures);
  std::vector<Look> looks;
  std::vector<stats::ScoreFamily> dummy;
  for (std::size_t s = 0; s < structures.list.size(); ++s) {
    if (structures.list[s].kind == Structure::Kind::dummy)
      dummy.push_back(std::move(scores.families[s]));
    else
      looks.push_back({std::move(scores.families[s]), of_single_groups(system, structures.list[s])});
  }
  r.global_p = global_p(looks, scores.blocks, scores.inflation, options.draws, options.seed);
  const stats::SignFlipResult dummy_test =
      stats::sign_flip_test(dummy, scores.blocks, scores.inflation, 1, options.seed);

  r.isolability = isolability(system, p, structures, options.level);
  r.conditions = locate(system, p, structures);
  const HeldOut before = held_out_linear(system, p.linearisation, p.own);
  std::size_t passed = 0, number = 0;
  for (std::size_t s = 0; s < structures.list.size(); ++s) {
    const Structure::Kind kind = structures.list[s].kind;
    if (kind == Structure::Kind::mechanism) continue;
    Hypothesis h = linear_hypothesis(race, p, structures, s, before, scores);
    h.held_out *= model.held_out.score();
    if (kind == Structure::Kind::curve) {
      r.curves.push_back(std::move(h));
      continue;
    }
    h.wald_p = dummy_test.p[number++];
    passed += h.gain > h.gain_sigma && h.wald_p < options.level && h.effect >= options.matters;
    r.dummies.push_back(std::move(h));
  }
  sort_by_gain(r.curves);
  sort_by_gain(r.dummies);
  r.false_alarm = r.dummies.empty() ? 0 : static_cast<double>(passed) / static_cast<double>(r.dummies.size());
  return r;
}

}  // namespace gonio::explain

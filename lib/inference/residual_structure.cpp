// See race.h: what is left in the residuals of a model. The null test, location, free curves and negative controls all
// share one projection.
#include <algorithm>
#include <cmath>

#include "inference/global_test.h"
#include "inference/own_phase.h"
#include "inference/race.h"
#include "stats/sign_flip.h"

namespace gonio::inference {
namespace {

// Further looks at the same residuals cost a tenth of the level each.
constexpr double price_of_further_looks = 10;

// Of held-out errors.
double ratio_of(const HeldOut& before, const HeldOut& after) {
  double squares_before = 0, squares_after = 0;
  for (std::size_t k = 0; k < before.whitened.size(); ++k)
    squares_before += before.whitened[k], squares_after += after.whitened[k];
  return squares_before > 0 ? std::sqrt(squares_after / squares_before) : 1;
}

// A structure as a hypothesis that enters linearly.
Competitor linear_competitor(const Race& race, const Evidence& e, std::size_t s) {
  const Structure& structure = e.structures.list[s];
  Competitor result;
  Hypothesis& h = result.hypothesis;
  h.kind = structure.kind == Structure::Kind::negative_control ? Hypothesis::Kind::negative_control
                                                               : Hypothesis::Kind::free_curve;
  h.name = structure.name;
  if (h.kind == Hypothesis::Kind::negative_control) h.candidates = {structure.shape};
  result.condition = structure.index;
  const std::vector<Eigen::Index> places = e.projection.foreign(e.structures, s);
  const HeldOut& before = e.folds->own();
  result.held_out = e.folds->held_out(places);
  const Gain g = gain(before, result.held_out);
  h.gain = g.mean;
  h.gain_sigma = g.sigma;
  h.held_out = ratio_of(before, result.held_out);
  h.effect = linear_effect(race, e, places, result.held_out);
  return result;
}

// Has the mechanism a number of its own for every group?
bool of_single_groups(const System& system, const Structure& structure) {
  if (structure.kind != Structure::Kind::mechanism) return false;
  const std::vector<Parameter>& all = system.problem().parameters();
  const std::vector<std::size_t>& own = system.problem().candidates()[structure.index].parameters;
  return std::all_of(own.begin(), own.end(), [&](std::size_t p) { return all[p].groups.size() == 1; }) &&
         own.size() >= system.groups.size();
}

void gather(const Race& race, const Model& model, const Options& options, Looks looks, Structures& structures) {
  const System& system = race.system();
  if (looks == Looks::at_curves) {
    for (std::size_t c = 0; c < system.observations().conditions.size(); ++c) structures.add_curve(system, c);
    return;
  }
  for (const std::size_t c : race.open_to(model)) structures.add_mechanism(system, model.fit.values, c);
  for (const std::size_t c : race.open_to(model)) structures.add_changes(system, model.fit.values, c);
  for (std::size_t c = 0; c < system.observations().conditions.size(); ++c) structures.add_curve(system, c);
  for (const OwnPhase& wave : own_phases(system, model.fit.values))
    if (price_of_further_looks * wave.p <= options.level) structures.add_wave(system, wave.condition, wave.period);
  const std::vector<std::size_t>& shapes = race.allowed();
  for (std::size_t d = 0; d < options.negative_controls && !shapes.empty(); ++d)
    structures.add_negative_control(system, shapes[d % shapes.size()], d, options.seed);
}

void run_competitors(const Race& race, const Model& model, const Options& options,
                     const std::vector<double>& p_of_negative_controls, ResidualStructure& r) {
  const std::vector<Structure>& list = r.evidence->structures.list;
  std::size_t passed = 0, number = 0;
  for (std::size_t s = 0; s < list.size(); ++s) {
    if (list[s].kind != Structure::Kind::curve && list[s].kind != Structure::Kind::negative_control) continue;
    Competitor c = linear_competitor(race, *r.evidence, s);
    Hypothesis& h = c.hypothesis;
    h.held_out *= model.held_out.score();
    if (list[s].kind == Structure::Kind::curve) {
      r.curves.push_back(std::move(c));
      continue;
    }
    h.wald_p = p_of_negative_controls[number++];
    passed += h.gain > h.gain_sigma && h.wald_p < options.level && h.effect >= options.smallest_effect;
    r.negative_controls.push_back(std::move(h));
  }
  std::stable_sort(r.curves.begin(), r.curves.end(),
                   [](const Competitor& a, const Competitor& b) { return a.hypothesis.gain > b.hypothesis.gain; });
  std::stable_sort(r.negative_controls.begin(), r.negative_controls.end(),
                   [](const Hypothesis& a, const Hypothesis& b) { return a.gain > b.gain; });
  r.false_alarm =
      r.negative_controls.empty() ? 0 : static_cast<double>(passed) / static_cast<double>(r.negative_controls.size());
}

}  // namespace

double linear_effect(const Race& race, const Evidence& e, const std::vector<Eigen::Index>& places,
                     const HeldOut& with) {
  if (race.system().problem().importance() == Importance::share_of_residual) return 1 - ratio_of(e.folds->own(), with);
  const Eigen::VectorXd step = e.folds->step(places);
  const double moved = step.dot(e.scores.raw_surviving(places, places) * step);
  return e.scores.norm > 0 ? std::sqrt(std::max(0.0, moved) / e.scores.norm) : 0;
}

ResidualStructure residual_structure(const Race& race, const Model& model, const Options& options, Looks at) {
  const System& system = race.system();
  const auto evidence = std::make_shared<Evidence>();
  Structures& structures = evidence->structures;
  gather(race, model, options, at, structures);
  Projection& p = evidence->projection = project(system, model.fit, structures);
  evidence->scores = block_scores(system, p, structures);
  evidence->folds = std::make_unique<Folds>(system, p.linearisation);
  BlockScores& scores = evidence->scores;
  std::vector<Look> looks;
  std::vector<stats::ScoreFamily> negative_control;
  for (std::size_t s = 0; s < structures.list.size(); ++s) {
    const Structure::Kind kind = structures.list[s].kind;
    if (kind == Structure::Kind::negative_control) negative_control.push_back(std::move(scores.families[s]));
    if (kind != Structure::Kind::negative_control)
      looks.push_back({std::move(scores.families[s]), of_single_groups(system, structures.list[s])});
  }
  const double by_stated_noise = system.problem().noise_is_known() ? stated_noise_p(p, structures) : 1;
  scores.families.clear();
  ResidualStructure r;
  r.looks = at;
  r.global_p = global_p(looks, scores.blocks, scores.inflation, options.draws, options.seed);
  r.global_p = std::min(r.global_p, price_of_further_looks * concentrated_p(p, structures, scores));
  r.global_p = std::min(r.global_p, price_of_further_looks * by_stated_noise);
  r.serial_correlation = serial_correlation(system, model.fit.values);
  if (r.serial_correlation) r.global_p = std::min(r.global_p, price_of_further_looks * r.serial_correlation->p);
  if (r.global_p > options.level) r.interaction = interaction(system, model.fit);
  if (r.interaction) r.global_p = std::min(r.global_p, price_of_further_looks * r.interaction->p);
  const stats::SignFlipResult negative_control_test =
      stats::sign_flip_test(negative_control, scores.blocks, scores.inflation, 1, options.seed);
  r.inflation = inflation(system, p, structures, scores);
  if (at == Looks::at_everything) r.outliers = outliers(system, model.fit.values);
  r.isolability = isolability(system, p, structures, scores, r.inflation, options);
  r.conditions = locate(system, p, structures);
  r.evidence = evidence;
  run_competitors(race, model, options, negative_control_test.p, r);
  return r;
}

}  // namespace gonio::inference

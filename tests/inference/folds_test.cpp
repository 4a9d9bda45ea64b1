// The linear algebra under the race: folds of all hypotheses at once against one at a time, chords against tangents.
#include "inference/folds.h"

#include <gtest/gtest.h>

#include "explain/engine.h"
#include "inference/nonlinear_toy.h"
#include "inference/race.h"
#include "inference/screening.h"

namespace gonio::explain::tests {
namespace {

std::vector<double> starting_values(const Problem& problem) {
  std::vector<double> values;
  for (const Parameter& p : problem.parameters()) values.push_back(p.neutral);
  for (const std::size_t p : problem.base()) values[p] = problem.parameters()[p].start;
  return values;
}

struct Prepared {
  NonlinearToy problem;
  System system;
  Options options;
  Race race;
  Model base;
  explicit Prepared(std::vector<std::vector<double>> truth)
      : problem(library(), std::move(truth), {{}, 0.1, 0.03}, 21),
        system(problem, 1),
        options{.draws = 99, .negative_controls = 6},
        race(system, options),
        base(race.base(starting_values(problem))) {}
};

std::vector<std::vector<double>> square_and_tilt() {
  std::vector<std::vector<double>> truth(library().size());
  truth[0] = {0.3}, truth[5] = {-0.2};
  return truth;
}

TEST(Folds, AgreeWithOneHypothesisAtATime) {
  const Prepared p(square_and_tilt());
  const ResidualStructure r = residual_structure(p.race, p.base, p.options);
  const Evidence& e = *r.evidence;
  const Linearisation& l = e.projection.linearisation;
  int compared = 0;
  for (std::size_t s = 0; s < e.structures.list.size(); ++s) {
    if (e.structures.list[s].name == "toy.decay") continue;  // its amplitude has one side only, which folds keep
    std::vector<std::size_t> columns = e.projection.own;
    const std::vector<std::size_t> added = e.projection.columns(e.structures, s);
    columns.insert(columns.end(), added.begin(), added.end());
    const HeldOut one = held_out_linear(p.system, l, columns);
    const HeldOut many = e.folds->held_out(e.projection.foreign(e.structures, s));
    for (std::size_t g = 0; g < one.whitened.size(); ++g)
      EXPECT_NEAR(many.whitened[g], one.whitened[g], 1e-4 * one.whitened[g]) << e.structures.list[s].name;
    ++compared;
  }
  EXPECT_GT(compared, 10);
}

TEST(Folds, AStepAgainstABoundAtNeutralIsNotTaken) {
  const Prepared p(square_and_tilt());
  const ResidualStructure r = residual_structure(p.race, p.base, p.options);
  const Evidence& e = *r.evidence;
  for (std::size_t s = 0; s < e.structures.list.size(); ++s)
    if (e.structures.list[s].name == "toy.decay" && e.structures.list[s].kind == Structure::Kind::mechanism) {
      EXPECT_GE(e.folds->step(e.projection.foreign(e.structures, s))[0], 0);
    }
}

// Chords end where tangents end, to less than noise can show.
TEST(Folds, ChordsReachTheSameFit) {
  const Prepared p(square_and_tilt());
  const Slopes kept = p.race.slopes_at(p.base);
  for (std::size_t c = 0; c < p.problem.candidates().size(); ++c) {
    const Model chords = p.race.changed(p.base, {c}, &kept), tangents = p.race.changed(p.base, {c});
    EXPECT_LT(chords.fit.cost, tangents.fit.cost + 0.02 * (p.base.fit.cost - tangents.fit.cost) + 4)
        << p.problem.candidates()[c].id();
  }
}

TEST(Folds, PairsAreRankedByWhatTheyRepairTogether) {
  const Prepared p(square_and_tilt());
  const ResidualStructure r = residual_structure(p.race, p.base, p.options);
  const Screening screening(p.race, r);
  ASSERT_EQ(screening.singles().size(), library().size());
  const std::vector<Entrant> pairs = screening.pairs(10000, 1);
  ASSERT_EQ(pairs.size(), 1u);
  std::vector<std::size_t> best = pairs[0].candidates;
  std::sort(best.begin(), best.end());
  EXPECT_EQ(best, (std::vector<std::size_t>{0, 5}));
}

}  // namespace
}  // namespace gonio::explain::tests

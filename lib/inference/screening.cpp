// See screening.h.
#include "inference/screening.h"

#include <algorithm>
#include <numeric>

#include "base/parallel.h"

namespace gonio::inference {
namespace {

constexpr std::size_t most_columns = 48;  // of a pair

}  // namespace

Screening::Runner Screening::runner_of(std::size_t candidate) const {
  const Problem& problem = race_.system().problem();
  Runner runner{candidate, {}};
  double best = 0;
  for (std::size_t s = 0; s < evidence_.structures.list.size(); ++s) {
    const Structure& structure = evidence_.structures.list[s];
    if (structure.index != candidate) continue;
    if (structure.kind != Structure::Kind::mechanism && structure.kind != Structure::Kind::change) continue;
    Form form{evidence_.projection.foreign(evidence_.structures, s), structure.point};
    if (structure.kind == Structure::Kind::mechanism) {
      for (const std::size_t p : problem.candidates()[candidate].parameters)
        form.point.push_back(problem.parameters()[p].start);
      best = evidence_.folds->gain(form.columns);
      runner.forms.push_back(std::move(form));
      continue;
    }
    const double reach = evidence_.folds->gain(form.columns);
    if (!(reach > best)) continue;
    best = reach;
    runner.forms.resize(1);
    runner.forms.push_back(std::move(form));
  }
  return runner;
}

Screening::Screening(const Race& race, const ResidualStructure& residual_structure)
    : race_(race), evidence_(*residual_structure.evidence) {
  std::vector<std::size_t> visible;
  for (const Isolability& i : residual_structure.isolability)
    if (i.visible) visible.push_back(i.candidate);
  std::vector<Runner> runners(visible.size());
  std::vector<Entrant> entrants(visible.size());
  parallel_for(0, visible.size(), [&](std::size_t k) {
    runners[k] = runner_of(visible[k]);
    const Form& form = runners[k].forms.back();
    entrants[k] = {.candidates = {visible[k]},
                   .promise = evidence_.folds->promise(form.columns),
                   .held_out = evidence_.folds->held_out(form.columns),
                   .start = form.point};
    entrants[k].reach = gain(evidence_.folds->own(), entrants[k].held_out).mean;
    entrants[k].effect = linear_effect(race_, evidence_, form.columns, entrants[k].held_out);
  });
  std::vector<std::size_t> order(visible.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return entrants[a].reach > entrants[b].reach; });
  for (const std::size_t k : order) {
    runners_.push_back(std::move(runners[k]));
    singles_.push_back(std::move(entrants[k]));
  }
}

std::vector<Entrant> Screening::pairs(std::size_t most, std::size_t keep, std::optional<std::size_t> with) const {
  struct Pair {
    std::size_t a = 0, b = 0, form_a = 0, form_b = 0;
    double reach = 0;
  };
  std::vector<Pair> all;
  for (std::size_t sum = 1; sum + 1 < 2 * runners_.size(); ++sum)  // the best singles' pairs first
    for (std::size_t a = sum + 1 > runners_.size() ? sum + 1 - runners_.size() : 0; 2 * a < sum; ++a) {
      const std::size_t b = sum - a;
      if (with && runners_[a].candidate != *with && runners_[b].candidate != *with) continue;
      if (race_.never_together(runners_[a].candidate, runners_[b].candidate)) continue;
      if (runners_[a].forms[0].columns.size() + runners_[b].forms[0].columns.size() > most_columns) continue;
      if (all.size() < most) all.push_back({a, b, 0, 0, 0});
    }
  const auto joined = [&](const Pair& p, std::size_t form_a, std::size_t form_b) {
    std::vector<Eigen::Index> columns = runners_[p.a].forms[form_a].columns;
    const std::vector<Eigen::Index>& other = runners_[p.b].forms[form_b].columns;
    columns.insert(columns.end(), other.begin(), other.end());
    return columns;
  };
  parallel_for(
      0, all.size(),
      [&](std::size_t k) {
        Pair& p = all[k];
        for (std::size_t fa = 0; fa < runners_[p.a].forms.size(); ++fa)
          for (std::size_t fb = 0; fb < runners_[p.b].forms.size(); ++fb) {
            const double reach = evidence_.folds->gain(joined(p, fa, fb));
            if (reach > p.reach) p.reach = reach, p.form_a = fa, p.form_b = fb;
          }
      },
      16);
  std::stable_sort(all.begin(), all.end(), [](const Pair& x, const Pair& y) { return x.reach > y.reach; });
  std::vector<Entrant> result;
  for (std::size_t k = 0; k < std::min(keep, all.size()); ++k) {
    const Pair& p = all[k];
    Entrant e{.candidates = {runners_[p.a].candidate, runners_[p.b].candidate},
              .reach = p.reach,
              .held_out = evidence_.folds->held_out(joined(p, p.form_a, p.form_b)),
              .start = runners_[p.a].forms[p.form_a].point};
    const std::vector<double>& other = runners_[p.b].forms[p.form_b].point;
    e.start.insert(e.start.end(), other.begin(), other.end());
    e.effect = linear_effect(race_, evidence_, joined(p, p.form_a, p.form_b), e.held_out);
    result.push_back(std::move(e));
  }
  return result;
}

std::vector<std::vector<double>> Screening::points(std::size_t candidate) const {
  std::vector<std::vector<double>> result;
  for (const Structure& s : evidence_.structures.list)
    if (s.kind == Structure::Kind::change && s.index == candidate) result.push_back(s.point);
  return result;
}

}  // namespace gonio::inference

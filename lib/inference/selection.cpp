// See race.h: forward selection while effects pay, backward elimination, and the next choice where the last judgement
// refuses the first.
#include <algorithm>
#include <cmath>
#include <memory>

#include "inference/forward_step.h"
#include "inference/judgement.h"

namespace gonio::inference {
namespace {

constexpr double least_share = 0.5;   // of what the first choice repaired, for a runner-up to be worth a look
constexpr double clearly_less = 0.1;  // by which a runner-up may repair less, as a share, beside two standard errors

std::vector<std::size_t> smaller_set(std::vector<std::size_t> set, std::size_t c) {
  std::erase(set, c);
  return set;
}

// Effects that another one, found later, has made superfluous.
void eliminate(const Race& race, const Options& options, Model& model) {
  for (bool again = true; again && model.candidates.size() > 1;) {
    again = false;
    const Slopes kept = race.slopes_at(model);
    for (const std::size_t c : model.candidates) {
      Model smaller = race.changed(model, smaller_set(model.candidates, c), &kept);
      const Gain g = gain(smaller.held_out, model.held_out);
      if (g.mean > g.sigma && race.effect(smaller, model) >= options.smallest_effect) continue;
      model = race.changed(smaller, smaller.candidates);
      again = true;
      break;
    }
  }
}

// Significant beside all the looks of its round, better on unseen groups, and too small to matter.
bool is_minor(const Hypothesis& h) {
  return h.refused == "smaller than what matters" && h.gain > 2 * h.gain_sigma;
}

// A round with what it starts from; runners of the same round share it.
struct Level {
  Level(const Race& race, const Effort& effort, Model from, ResidualStructure left)
      : model(std::move(from)), after(std::move(left)), step(race, effort, model, after) {}
  Level(const Level&) = delete;
  Level& operator=(const Level&) = delete;
  Model model;
  ResidualStructure after;
  ForwardStep step;
};
// What forward selection has come to.
struct Path {
  std::vector<std::shared_ptr<Level>> levels;
  std::vector<Runner> joined;  // one for each level but the last, where nothing more joins
  Model model;
  ResidualStructure after;
};

class Search {
 public:
  Search(const Race& race, const Options& options, const Effort& effort, Selection& s)
      : race_(race), options_(options), effort_(effort), s_(s) {}

  void run() {
    Path first{{}, {}, s_.model, s_.after};
    climb(first);
    take(first);
    if (s_.model.candidates.empty()) return;
    std::string why = objection(race_.system().problem(), s_, options_);
    if (why.empty()) return;
    const Model refused = s_.model;
    s_.put_aside.push_back({refused.candidates, why});
    for (const Turn& turn : turns(first)) {
      if (taken(first, turn, false, refused)) return;
      if (grown_ && taken(first, turn, true, refused)) return;
    }
    s_.put_aside.erase(s_.put_aside.begin());
    take(first);
  }

 private:
  // Another choice at one level of the first path.
  struct Turn {
    std::size_t level = 0;
    Runner runner;
    double share = 0;  // of what was repaired when the first choice had joined there
  };

  // Is the selection content with what follows from this turn? `wary`: nothing joins that completes a set that was put
  // aside; asked after the free choice, which may have drawn it in again.
  bool taken(const Path& first, const Turn& turn, bool wary, const Model& refused) {
    const auto place = static_cast<std::ptrdiff_t>(turn.level);
    Path path{{first.levels.begin(), first.levels.begin() + place + 1},
              {first.joined.begin(), first.joined.begin() + place},
              turn.runner.model,
              {}};
    path.joined.push_back(turn.runner);
    path.after = residual_structure(race_, path.model, options_);
    climb(path, wary);
    take(path);
    grown_ = path.joined.size() > turn.level + 1;
    if (put_aside(s_.model.candidates, false)) return false;
    std::string why = objection(race_.system().problem(), s_, options_);
    if (why.empty() && falls_short(refused)) why = "another set, which only imitates, repairs more on unseen groups";
    if (!why.empty()) s_.put_aside.push_back({s_.model.candidates, why});
    return why.empty();
  }

  // Effects join while they pay; not to a set that was put aside before.
  void climb(Path& path, bool wary = false) const {
    while (path.after.global_p <= options_.level && path.model.candidates.size() < effort_.effects) {
      path.levels.push_back(std::make_shared<Level>(race_, effort_, path.model, path.after));
      std::optional<Runner> joined = path.levels.back()->step.next();
      while (joined && put_aside(joined->model.candidates, wary)) joined = path.levels.back()->step.next();
      if (!joined) return;
      path.model = joined->model;
      path.joined.push_back(std::move(*joined));
      path.after = residual_structure(race_, path.model, options_);
    }
  }

  // The selection as this path leaves it.
  void take(const Path& path) {
    s_.model = path.model;
    s_.after = path.after;
    s_.scoreboard.clear();
    s_.minor.clear();
    for (const std::shared_ptr<Level>& level : path.levels) enter_lines(*level);
    if (s_.model.candidates.size() < 2) return;
    const std::size_t size = s_.model.candidates.size();
    eliminate(race_, options_, s_.model);
    if (s_.model.candidates.size() != size) s_.after = residual_structure(race_, s_.model, options_);
  }

  void enter_lines(const Level& level) {
    s_.minor.clear();  // what is minor beside an effect that has since been found may be its imitation
    const auto enter = [&](Hypothesis h) {
      if (!level.model.candidates.empty()) h.name = race_.name_of(level.model.candidates) + " + " + h.name;
      if (is_minor(h)) s_.minor.push_back(s_.scoreboard.size());
      s_.scoreboard.push_back(std::move(h));
    };
    for (const Runner& r : level.step.runners()) enter(r.hypothesis);
    for (Hypothesis& h : level.step.screened_out()) enter(std::move(h));
  }

  // The furthest-reaching other choices of all levels.
  std::vector<Turn> turns(Path& path) const {
    std::vector<Turn> list;
    for (std::size_t k = 0; k < path.joined.size(); ++k) {
      Level& level = *path.levels[k];
      if (path.joined[k].hypothesis.candidates.size() == 1) level.step.admit_pairs();
      const double chosen = gain(s_.base.held_out, path.joined[k].model.held_out).mean;
      for (std::size_t n = 0; n < effort_.runners_up; ++n) {
        std::optional<Runner> r = level.step.next();
        if (!r) break;
        const double share = gain(s_.base.held_out, r->model.held_out).mean / chosen;
        if (share > least_share) list.push_back({k, std::move(*r), share});
      }
    }
    std::stable_sort(list.begin(), list.end(), [](const Turn& a, const Turn& b) { return a.share > b.share; });
    if (list.size() > effort_.runners_up) list.resize(effort_.runners_up);
    return list;
  }

  // Was this set put aside, whatever the order in which its effects joined? `parts`: or a part of it.
  bool put_aside(const std::vector<std::size_t>& candidates, bool parts) const {
    return std::any_of(s_.put_aside.begin(), s_.put_aside.end(), [&](const PutAside& p) {
      return (parts || p.candidates.size() == candidates.size()) &&
             std::all_of(p.candidates.begin(), p.candidates.end(), [&](std::size_t c) {
               return std::find(candidates.begin(), candidates.end(), c) != candidates.end();
             });
    });
  }

  bool falls_short(const Model& refused) const {
    const Gain apart = gain(s_.model.held_out, refused.held_out);
    return apart.mean > 2 * apart.sigma && apart.mean > clearly_less * gain(s_.base.held_out, refused.held_out).mean;
  }

  const Race& race_;
  const Options& options_;
  const Effort& effort_;
  Selection& s_;
  bool grown_ = false;  // further effects joined after the last turn
};

}  // namespace

Effort effort_for(const Race& race, const Options& options) {
  Effort effort;
  if (!(options.budget_s > 0)) return effort;
  // A million values of one prediction and some twenty predictions for a hypothesis take about a second each.
  double rows = 0;
  for (const std::size_t g : race.system().groups) rows += static_cast<double>(race.system().used_rows(g));
  const double fits = options.budget_s / (20 * rows * 1e-6 + 1e-3);
  const std::size_t most = effort.fits, pairs = effort.pairs;
  effort.fits = static_cast<std::size_t>(std::clamp(fits / 4, 2.0, static_cast<double>(most)));
  effort.least = std::min(effort.least, effort.fits);
  effort.pairs = static_cast<std::size_t>(std::clamp(100 * fits, 10.0, static_cast<double>(pairs)));
  if (fits < 20) effort.effects = 2, effort.runners_up = 1;
  if (effort.fits < most || effort.pairs < pairs || effort.effects < 5)
    effort.shortened = "The budget allowed " + std::to_string(effort.fits) + " fits and " +
                       std::to_string(effort.pairs) + " pairs a round, and at most " + std::to_string(effort.effects) +
                       " effects at once.";
  return effort;
}

Selection select(const Race& race, const Options& options, const std::vector<double>& start,
                 std::optional<double> mismatch_p) {
  const Effort effort = effort_for(race, options);
  Selection s;
  s.shortened = effort.shortened;
  s.base = s.model = race.base(start);
  s.before = s.after = residual_structure(race, s.base, options);
  if (mismatch_p) s.before.global_p = s.after.global_p = *mismatch_p;
  Search(race, options, effort, s).run();
  find_alternatives(race, options, effort, s);
  return s;
}

}  // namespace gonio::inference

// See race.h: forward selection while effects pay, backward elimination, and another choice where the first does not
// suffice.
#include <algorithm>
#include <cmath>
#include <memory>

#include "inference/finalists.h"
#include "inference/forward_step.h"

namespace gonio::inference {
namespace {

constexpr double least_share = 0.5;       // of what the first choice repaired, for a runner-up to be worth a look
constexpr double worth_a_turn = 0.02;     // of probability, that another choice brings
constexpr std::size_t most_idle = 1;      // turns in a row that bring less
constexpr double worth_exchanging = 0.1;  // of probability, for stand-ins of its members to be fitted
constexpr double near_finalists = 0.3;    // the same, for a place among the finalists as it stands
// Once something has joined, what is left is worth a round where a tenth of clean remainders would look like it: what
// joins has a test of its own, counted over all looks, and the null test sees but what is smooth over one condition.
constexpr double left_level = 0.1;

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
  return too_small(h) && h.gain > 2 * h.gain_sigma;
}

// A round with what it starts from; runners of the same round share it.
struct Level {
  Level(const Race& race, const Effort& effort, Model from, std::shared_ptr<const ResidualStructure> left)
      : model(std::move(from)), after(std::move(left)), step(race, effort, model, *after) {}
  Level(const Level&) = delete;
  Level& operator=(const Level&) = delete;
  Model model;
  std::shared_ptr<const ResidualStructure> after;
  ForwardStep step;
};
// What forward selection has come to.
struct Path {
  std::vector<std::shared_ptr<Level>> levels;
  std::vector<Runner> joined;  // one for each level but the last, where nothing more joins
  Model model;
  std::shared_ptr<const ResidualStructure> after;
};

class Search {
 public:
  Search(const Race& race, const Options& options, const Effort& effort, Selection& s, Finalists& finalists)
      : race_(race), options_(options), effort_(effort), s_(s), finalists_(finalists) {}

  void run() {
    paths_.push_back({{}, {}, s_.base, std::make_shared<const ResidualStructure>(s_.before)});
    climb(paths_[0], effort_.effects);
    enter(paths_[0]);
    finalists_.weigh(effort_.looks);
    if (paths_[0].joined.empty()) return tell(paths_[0]);
    if (finalists_.in_library() < options_.sure) explore();
    exchange();
    settle();
  }

 private:
  // Another choice at one level of the first path.
  struct Turn {
    std::size_t level = 0;
    Runner runner;
    double share = 0;  // of what was repaired when the first choice had joined there
  };

  // Effects join while they pay, `most` of them; no set that is among the finalists already, where `anew`.
  void climb(Path& path, std::size_t most, bool anew = false) const {
    while (is_worth_a_round(path) && path.model.candidates.size() < most) {
      path.levels.push_back(std::make_shared<Level>(race_, effort_, path.model, path.after));
      std::optional<Runner> joined = path.levels.back()->step.next();
      while (anew && joined && finalists_.knows(joined->model.candidates)) joined = path.levels.back()->step.next();
      if (!joined) return;
      join(path, std::move(*joined), most);
    }
  }
  bool is_worth_a_round(const Path& path) const {
    return path.after->global_p <= (path.joined.empty() ? options_.level : std::max(options_.level, left_level));
  }
  void join(Path& path, Runner runner, std::size_t most) const {
    path.model = runner.model;
    path.joined.push_back(std::move(runner));
    const Looks looks = path.model.candidates.size() < most ? Looks::at_everything : Looks::at_curves;
    path.after = std::make_shared<const ResidualStructure>(residual_structure(race_, path.model, options_, looks));
  }

  // All that the path met and that could be: what it chose, and the runners of its rounds.
  void enter(const Path& path) {
    for (std::size_t k = 0; k < path.joined.size(); ++k)
      finalists_.add(path.joined[k].model, k + 1 < path.levels.size() ? path.levels[k + 1]->after : path.after);
    for (const std::shared_ptr<Level>& level : path.levels) {
      double best = 0;
      for (const Runner& r : level->step.runners()) best = std::max(best, r.hypothesis.gain);
      for (const Runner& r : level->step.runners())
        if ((r.hypothesis.refused.empty() || is_minor(r.hypothesis)) && r.hypothesis.gain > near_finalists * best)
          finalists_.add(r.model);
    }
    if (path.model.candidates.size() < 2) return;
    Model smaller = path.model;
    eliminate(race_, options_, smaller);
    finalists_.add(std::move(smaller));
  }

  // Until it is sure enough, or turns have stopped to make anything surer.
  void explore() {
    // No more than two: where nothing in the library suffices, further ones only imitate what is not there, and each
    // costs a round.
    const std::size_t most = std::min<std::size_t>(effort_.effects, 2);
    std::size_t idle = 0;
    double surest = finalists_.in_library();
    for (const Turn& turn : turns(paths_[0])) {
      if (turn.level >= most) continue;
      const auto place = static_cast<std::ptrdiff_t>(turn.level);
      const Path& first = paths_[0];
      Path path{{first.levels.begin(), first.levels.begin() + place + 1},
                {first.joined.begin(), first.joined.begin() + place},
                {},
                {}};
      join(path, turn.runner, most);
      climb(path, most, true);
      enter(path);
      paths_.push_back(std::move(path));
      finalists_.weigh(effort_.looks);
      if (finalists_.in_library() >= options_.sure) return;
      idle = finalists_.in_library() > surest + worth_a_turn ? 0 : idle + 1;
      surest = std::max(surest, finalists_.in_library());
      if (idle == most_idle) return;
    }
  }

  // What could stand in for a member of the set that predicts best, where that is likely, and of the likeliest; and,
  // where that makes another the likeliest, of that one. A plain set may be the likeliest and still lack what the best
  // one has beside another form of it: a fisheye without the uneven print that was found beside radial terms.
  void exchange() {
    std::vector<std::vector<std::size_t>> done;
    const auto exchange_in = [&](const Finalist* f) {
      if (f == nullptr || std::ranges::find(done, f->model.candidates) != done.end()) return;
      done.push_back(f->model.candidates);
      add_alternatives(race_, effort_, s_, Model(f->model), finalists_);
      finalists_.weigh(effort_.looks);
    };
    exchange_in(best_of_the_likely());
    exchange_in(finalists_.likeliest());
    exchange_in(finalists_.likeliest());
  }
  const Finalist* best_of_the_likely() const {
    const Finalist* best = nullptr;
    for (const Finalist& f : finalists_.list())
      if (f.refused.empty() && f.probability > worth_exchanging && (best == nullptr || f.gained > best->gained))
        best = &f;
    return best;
  }

  // The selection as the likeliest set leaves it.
  void settle() {
    const Finalist* top = finalists_.likeliest();
    if (top == nullptr) return tell(paths_[0]);
    s_.model = top->model;
    const bool known = top->after != nullptr && top->after->looks == Looks::at_everything;
    s_.after = known ? *top->after : residual_structure(race_, s_.model, options_);
    const auto leads_there = [&](const Path& path) {
      return std::all_of(s_.model.candidates.begin(), s_.model.candidates.end(), [&](std::size_t c) {
        return std::find(path.model.candidates.begin(), path.model.candidates.end(), c) != path.model.candidates.end();
      });
    };
    const auto path = std::find_if(paths_.begin(), paths_.end(), leads_there);
    tell(path != paths_.end() ? *path : paths_[0]);
  }

  // The rounds of a path as lines of the scoreboard.
  void tell(const Path& path) {
    for (const std::shared_ptr<Level>& level : path.levels) {
      s_.minor.clear();  // what is minor beside an effect that has since been found may be its imitation
      const auto line = [&](Hypothesis h) {
        if (!level->model.candidates.empty()) h.name = race_.name_of(level->model.candidates) + " + " + h.name;
        if (is_minor(h)) s_.minor.push_back(s_.scoreboard.size());
        s_.scoreboard.push_back(std::move(h));
      };
      for (const Runner& r : level->step.runners()) line(r.hypothesis);
      for (Hypothesis& h : level->step.screened_out()) line(std::move(h));
    }
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

  const Race& race_;
  const Options& options_;
  const Effort& effort_;
  Selection& s_;
  Finalists& finalists_;
  std::vector<Path> paths_;
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
  if (fits < 20) effort.effects = 2, effort.runners_up = 1, effort.looks = 3;
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
  const auto finalists = std::make_shared<Finalists>(race, options, s.base, s.before);
  Search(race, options, effort, s, *finalists).run();
  s.finalists = finalists;
  return s;
}

}  // namespace gonio::inference

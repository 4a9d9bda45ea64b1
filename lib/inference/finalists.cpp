// See finalists.h.
#include "inference/finalists.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

namespace gonio::inference {
namespace {

constexpr double worth_a_look = 0.02;  // probability, before what it leaves is known
constexpr double last_digit = 0.0025;  // of what can be repaired: a difference that could be anyone's
constexpr double surely_helps = 2;     // standard errors, of what is said to matter beside something else
constexpr double a_square = 0.5;       // noise widths squared, over all rows: no test parts what differs by less

bool same_set(std::vector<std::size_t> a, std::vector<std::size_t> b) {
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  return a == b;
}

// May it be named, or, a single mechanism, be what is too small to matter? Several of which one is too small are none:
// the set without that one is weighed in their place.
bool is_answer(const Finalist& f) {
  return f.refused.empty() && (matters(f) || f.model.candidates.size() == 1);
}
bool is_too_small(const Finalist& f) {
  return f.refused.empty() && !matters(f) && f.model.candidates.size() == 1;
}
bool holds_more(const Finalist& more, const Finalist& f) {
  const std::vector<std::size_t>&all = more.model.candidates, &own = f.model.candidates;
  const auto holds = [&](std::size_t c) { return std::find(all.begin(), all.end(), c) != all.end(); };
  return all.size() > own.size() && std::all_of(own.begin(), own.end(), holds);
}

double part_of_all(double part, double of) {
  return of > 0 ? std::clamp(part / of, 0.0, 1.0) : 0;
}

// Mean square of the held-out residual above the noise, per row.
double excess_of(const HeldOut& h) {
  double squares = 0, rows = 0;
  for (std::size_t g = 0; g < h.whitened.size(); ++g) squares += h.whitened[g], rows += h.rows[g];
  return rows > 0 ? squares / rows - 1 : 0;
}

// The shares that depend on what a set leaves; `most`: what can be repaired.
void set_shares(const Finalist& f, double most, Statistics& s) {
  const double gained = std::max(0.0, f.gained);
  s.missed = 1 - part_of_all(f.gained, most);
  s.own = part_of_all(f.left.own, f.left.own + gained);
  s.clean = part_of_all(f.left.own, excess_of(f.model.held_out));
  s.any = part_of_all(f.left.any, f.left.any + gained);
}

// How clearly `after` helps: by groups or by blocks, whichever say it. Groups that an effect touches unequally disagree
// about its size, not about its being there.
double errors_of_help(const HeldOut& before, const HeldOut& after) {
  return std::max(errors_between(before, after, 0), std::min(block_z(before, after), at_most_errors));
}

}  // namespace

Finalists::Finalists(const Race& race, const Options& options, const Model& base, const ResidualStructure& before)
    : race_(race), options_(options), base_(base), before_(before) {
  for (const double r : base.held_out.rows) rows_ += r;
  if (before.global_p <= options.level)
    beyond_ = beyond_noise(race.system(), race.system().raw_residual(base.fit.values));
}

bool Finalists::knows(const std::vector<std::size_t>& candidates) const {
  return std::any_of(list_.begin(), list_.end(),
                     [&](const Finalist& f) { return same_set(f.model.candidates, candidates); });
}

void Finalists::add(Model model, std::shared_ptr<const ResidualStructure> after) {
  if (model.candidates.empty()) return;
  const auto known = std::find_if(list_.begin(), list_.end(),
                                  [&](const Finalist& f) { return same_set(f.model.candidates, model.candidates); });
  if (known != list_.end() && (known->looked_into || known->model.fit.cost <= model.fit.cost)) {
    if (after == nullptr || known->after != nullptr) return;
  }
  Finalist& f = known != list_.end() ? *known : list_.emplace_back();
  f = Finalist{};
  f.model = std::move(model);
  f.after = std::move(after);
  f.gained = gain(base_.held_out, f.model.held_out).mean;
  Statistics& s = f.statistics;
  for (const std::size_t c : f.model.candidates) {
    const Candidate& candidate = race_.system().problem().candidates()[c];
    for (const std::size_t p : candidate.parameters) {
      const std::size_t on = race_.system().problem().parameters()[p].groups.size();
      const double all = static_cast<double>(race_.system().observations().groups());
      s.numbers += (on == 0 || !(all > 0) ? 1 : static_cast<double>(on) / all) / candidate.things;
    }
    f.finer += candidate.finer;
  }
  s.more = static_cast<double>(f.model.candidates.size()) - 1;
  s.weakest = errors_of_help(base_.held_out, f.model.held_out);
  s.times = std::log(std::max(1e-3, race_.effect(base_, f.model) / std::max(1e-6, options_.smallest_effect)));
  s.size = sizes(f.model);
  s.controls = controls(f);
  refuse(f);
}

// Mean penalty of a half-Cauchy prior whose scale is the size that the mechanism declares as typical. What has no
// effect by itself is measured from where a fit begins.
double Finalists::sizes(const Model& model) const {
  const Problem& problem = race_.system().problem();
  double sum = 0, numbers = 0;
  for (const std::size_t c : model.candidates)
    for (const std::size_t p : problem.candidates()[c].parameters) {
      const Parameter& parameter = problem.parameters()[p];
      const double typical = typical_size(problem.candidates()[c], parameter);
      if (!(typical > 0)) continue;
      const double v = model.fit.values[p];
      const double away = std::min(std::abs(v - parameter.neutral), std::abs(v - parameter.start)) / typical;
      sum += std::log1p(away * away);
      numbers += 1;
    }
  return numbers > 0 ? sum / numbers : 0;
}

double Finalists::controls(const Finalist& f) const {
  if (f.model.candidates.size() > 1) return 0;
  const auto grouped = [&](std::size_t c) {
    const std::vector<std::size_t>& own = race_.system().problem().candidates()[c].parameters;
    return std::all_of(own.begin(), own.end(),
                       [&](std::size_t p) { return race_.system().problem().parameters()[p].groups.size() == 1; });
  };
  const Gain own = gain(base_.held_out, f.model.held_out);
  double peers = 0, better = 0;
  for (const Hypothesis& control : before_.negative_controls) {
    if (grouped(control.candidates.at(0)) != grouped(f.model.candidates[0])) continue;
    ++peers;
    better += control.gain > own.mean + own.sigma;
  }
  return part_of_all(better, peers);
}

void Finalists::refuse(Finalist& f) const {
  f.refused = at_a_limit(race_.system().problem(), f.model.fit, f.model.candidates);
  if (!f.refused.empty()) f.refused += " ends at the limit of what is plausible";
  if (!(f.statistics.weakest > 1)) f.refused = "does not lower the held-out score beyond its standard error";
}

// A member that turns out too small to matter leaves a smaller set, which is what may be named.
std::vector<Model> Finalists::weaken(Finalist& f) const {
  std::vector<Model> smaller;
  if (f.model.candidates.size() < 2) return smaller;
  std::optional<Slopes> kept;
  for (const std::size_t c : f.model.candidates) {
    std::vector<std::size_t> rest = f.model.candidates;
    std::erase(rest, c);
    const auto known =
        std::find_if(list_.begin(), list_.end(), [&](const Finalist& g) { return same_set(g.model.candidates, rest); });
    if (known == list_.end() && !kept) kept = race_.slopes_at(f.model);
    const Model without = known != list_.end() ? known->model : race_.changed(f.model, rest, &*kept);
    f.statistics.weakest = std::min(f.statistics.weakest, errors_of_help(without.held_out, f.model.held_out));
    const double effect = race_.effect(without, f.model);
    f.statistics.times =
        std::min(f.statistics.times, std::log(std::max(1e-3, effect / std::max(1e-6, options_.smallest_effect))));
    if (effect < options_.smallest_effect && known == list_.end()) smaller.push_back(without);
  }
  return smaller;
}

void Finalists::look_into(std::size_t place) {
  Finalist& f = list_[place];
  if (f.after == nullptr) {
    Model polished = race_.changed(f.model, f.model.candidates);
    if (polished.fit.cost < f.model.fit.cost) {
      f.model = std::move(polished);
      f.gained = gain(base_.held_out, f.model.held_out).mean;
      f.statistics.weakest = errors_of_help(base_.held_out, f.model.held_out);
      f.statistics.size = sizes(f.model);
    }
    f.left = left_over(race_.system().problem(), f.model.candidates,
                       residual_structure(race_, f.model, options_, Looks::at_curves), options_);
  } else {
    f.left = left_over(race_.system().problem(), f.model.candidates, *f.after, options_);
  }
  std::vector<Model> smaller = weaken(f);
  f.looked_into = true;
  refuse(f);
  for (Model& m : smaller) add(std::move(m));  // the last use of `f`: the list may move
}

// What is there beside a set and too small to matter is no objection to it: what the set leaves, and what it misses, is
// what is left beside them together.
void Finalists::look_at_minor(std::size_t place) {
  if (!(list_[place].left.any > 0)) return;
  std::optional<std::size_t> best;
  for (std::size_t k = 0; k < list_.size(); ++k) {
    const Finalist &more = list_[k], &f = list_[place];
    if (!more.refused.empty() || !holds_more(more, f) || !(more.gained > f.gained)) continue;
    if (race_.effect(f.model, more.model) >= options_.smallest_effect) continue;
    if (!best || more.gained > list_[*best].gained) best = k;
  }
  if (!best) return;
  if (!list_[*best].looked_into) look_into(*best);
  list_[place].with_minor = best;
}

bool is_within(const Candidate& part, const Candidate& whole) {
  if (part.id() != whole.id()) return false;
  if (part.on == whole.on) return true;
  const auto is_on = [&](const std::string& target) { return std::ranges::find(whole.on, target) != whole.on.end(); };
  return !part.on.empty() && part.family == whole.family && std::ranges::all_of(part.on, is_on);
}

// Of its mechanisms, those that are finer than need be. Where plainer forms of the very same one were refused, its
// being a finer form says nothing.
double Finalists::finer_ones(const Finalist& f) const {
  const std::vector<Candidate>& all = race_.system().problem().candidates();
  const bool plainer_stands = std::any_of(list_.begin(), list_.end(), [&](const Finalist& other) {
    return is_answer(other) && other.finer < f.finer && physics_of(other) == physics_of(f);
  });
  double count = 0;
  for (const std::size_t c : f.model.candidates) {
    if (!all[c].finer) continue;
    const bool has_forms = std::any_of(
        all.begin(), all.end(), [&](const Candidate& other) { return !other.finer && is_within(other, all[c]); });
    count += !has_forms || plainer_stands;
  }
  return count;
}

bool Finalists::adds_what_matters(const Finalist& part, const Finalist& more) const {
  return errors_of_help(part.model.held_out, more.model.held_out) > surely_helps &&
         race_.effect(part.model, more.model) >= options_.smallest_effect;
}

bool Finalists::matters_beside_small(const Finalist& f) const {
  for (const Finalist& more : list_) {
    if (!more.refused.empty() || !holds_more(more, f)) continue;
    for (const Finalist& small : list_)
      if (is_too_small(small) && holds_more(more, small) && !holds_more(f, small) && adds_what_matters(small, more))
        return true;
  }
  return false;
}

void Finalists::compare() {
  const Finalist *best = nullptr, *best_that_matters = nullptr;
  for (const Finalist& f : list_) {
    if (!is_answer(f)) continue;
    if (best == nullptr || f.gained > best->gained) best = &f;
    if (matters(f) && (best_that_matters == nullptr || f.gained > best_that_matters->gained)) best_that_matters = &f;
  }
  if (best == nullptr) return;
  const HeldOut& linear = before_.evidence->folds->own();
  for (Finalist& f : list_) {
    Statistics& s = f.statistics;
    // What is too small to matter, however much it gains, is no rival of what matters beside it.
    const bool beside = is_too_small(*best) && is_answer(f) && matters(f) && matters_beside_small(f);
    const Finalist* rival = beside ? best_that_matters : best;
    const double most = rival->gained + (rival->looked_into ? rival->left.any : 0);
    const double floor = std::hypot(last_digit * most, rows_ > 0 ? a_square / rows_ : 0);
    s.behind = &f == rival ? 0 : std::max(0.0, errors_between(f.model.held_out, rival->model.held_out, floor));
    // What a further mechanism adds that matters counts whole, however much the first has done.
    for (const Finalist& more : list_) {
      if (!more.refused.empty() || !holds_more(more, f)) continue;
      const bool whole = more.looked_into && !(more.statistics.times < 0);
      if (whole || (&f == best && is_too_small(f) && adds_what_matters(f, more)))
        s.behind = std::max(s.behind, errors_between(f.model.held_out, more.model.held_out, 0));
    }
    set_shares(f, most, s);
    if (f.with_minor && list_[*f.with_minor].looked_into && list_[*f.with_minor].refused.empty()) {
      Statistics both;
      set_shares(list_[*f.with_minor], most, both);
      for (const auto share : {&Statistics::missed, &Statistics::own, &Statistics::clean, &Statistics::any})
        s.*share = std::min(s.*share, both.*share);
    }
    s.finer = finer_ones(f);
    s.curve = 0;
    for (const Competitor& c : before_.curves) {
      if (!(c.hypothesis.gain > 2 * c.hypothesis.gain_sigma)) continue;
      // Curves are judged linearly: both as falls against the base model as it is judged in either way.
      HeldOut by_curve = base_.held_out;
      for (std::size_t g = 0; g < by_curve.whitened.size(); ++g)
        by_curve.whitened[g] -= linear.whitened[g] - c.held_out.whitened[g];
      const Gain apart = gain(f.model.held_out, by_curve);
      if (!(apart.mean > 2 * apart.sigma)) continue;
      const double better = part_of_all(apart.mean, c.hypothesis.gain);
      if (better > s.curve) s.curve = better, f.curve = c.hypothesis.name;
    }
  }
}

double Finalists::largest_effect() const {
  double largest = std::max(1e-3, beyond_);
  for (const Finalist& f : list_) largest = std::max(largest, std::exp(f.statistics.times) * options_.smallest_effect);
  for (const Competitor& c : before_.curves)
    if (c.hypothesis.gain > c.hypothesis.gain_sigma) largest = std::max(largest, c.hypothesis.effect);
  const auto take = [&](const auto& look) {
    if (look && look->p <= options_.level) largest = std::max(largest, look->effect);
  };
  take(before_.serial_correlation);
  take(before_.interaction);
  return largest;
}

std::vector<Member> Finalists::members(std::vector<std::size_t>* places) const {
  double largest = largest_effect();
  Member nothing{Member::Kind::nothing, {}}, outside{Member::Kind::outside, {}};
  if (before_.global_p <= options_.level && matter(before_.outliers, options_.smallest_effect)) {
    largest = std::max(largest, before_.outliers->effect);
    outside.statistics.outlying = std::log(before_.outliers->effect / std::max(1e-6, options_.smallest_effect));
  }
  if (beyond_ >= options_.smallest_effect)
    outside.statistics.outlying =
        std::max(outside.statistics.outlying, std::log(beyond_ / std::max(1e-6, options_.smallest_effect)));
  nothing.statistics.mismatch = -std::log10(std::max(before_.global_p, 1e-12));
  nothing.statistics.largest = std::log(largest / std::max(1e-6, options_.smallest_effect));
  const LeftOver all = left_over(race_.system().problem(), {}, before_, options_);
  outside.statistics.times =
      all.condition || outside.statistics.outlying > 0 ? std::max(0.0, nothing.statistics.largest) : -1;
  const Finalist* best = nullptr;
  for (const Finalist& f : list_)
    if (is_answer(f) && f.looked_into && (best == nullptr || f.gained > best->gained)) best = &f;
  const bool repairs_little = best == nullptr || (beyond_ >= options_.smallest_effect && !matters(*best));
  outside.statistics.any = repairs_little ? 1 : best->statistics.any;
  std::vector<Member> result = {nothing, outside};
  for (std::size_t k = 0; k < list_.size(); ++k) {
    if (!is_answer(list_[k])) continue;
    result.push_back({Member::Kind::set, list_[k].statistics});
    if (places != nullptr) places->push_back(k);
  }
  return result;
}

void Finalists::score() {
  compare();
  std::vector<std::size_t> places;
  const std::vector<Member> all = members(&places);
  const std::vector<double> p = probabilities(all, race_.system().problem().simulator());
  const Rest rest = rest_of(all, p);
  nothing_ = rest.nothing, outside_ = rest.outside;
  for (Finalist& f : list_) f.probability = 0;
  for (std::size_t k = 0; k < places.size(); ++k)
    if (Finalist& f = list_[places[k]]; matters(f)) f.probability = p[k + 2];
}

void Finalists::weigh(std::size_t most) {
  score();
  for (std::size_t n = 0; n < most; ++n) {
    std::optional<std::size_t> next;
    for (std::size_t k = 0; k < list_.size(); ++k) {
      if (list_[k].looked_into || !(list_[k].probability > worth_a_look)) continue;
      if (!next || list_[k].probability > list_[*next].probability) next = k;
    }
    if (!next) return;
    look_into(*next);
    look_at_minor(*next);
    score();
  }
}

std::set<std::string> Finalists::physics_of(const Finalist& f) const {
  std::set<std::string> physics;
  for (const std::size_t c : f.model.candidates) {
    const Candidate& candidate = race_.system().problem().candidates()[c];
    std::string name = candidate.id();
    for (const std::string& on : candidate.on) name += "/" + on;
    physics.insert(name);
  }
  return physics;
}

}  // namespace gonio::inference

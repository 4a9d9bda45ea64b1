// See law.h.
#include "inference/law.h"

#include <algorithm>
#include <cmath>

#include "inference/law_search.h"
#include "inference/law_wave.h"
#include "inference/signature.h"
#include "inference/wording.h"

namespace gonio::inference {
namespace {

constexpr std::size_t most_terms = 3, most_leaders = 3;
constexpr double level = 0.01;  // of a term, all looks counted
constexpr double clearly_more = 1.1;

std::size_t place_of(const Observations& o, const std::string& condition) {
  const auto found =
      std::find_if(o.conditions.begin(), o.conditions.end(), [&](const Condition& c) { return c.name == condition; });
  return static_cast<std::size_t>(found - o.conditions.begin());
}

// The condition that is known to carry the structure, and those that located most of it.
std::vector<std::size_t> leaders_of(const System& system, const Explanation& e) {
  std::vector<std::size_t> leaders;
  const auto add = [&](const std::string& name) {
    const std::size_t c = place_of(system.observations(), name);
    if (c == system.observations().conditions.size() || leaders.size() == most_leaders) return;
    if (std::find(leaders.begin(), leaders.end(), c) == leaders.end()) leaders.push_back(c);
  };
  add(e.outside->condition);
  for (const LocatedCondition& c : e.conditions) add(c.name);
  return leaders;
}

// Conditions on which the law depends, the one named in `outside` first.
std::vector<std::size_t> conditions_of(const std::vector<Term>& terms, std::size_t preferred) {
  std::vector<std::size_t> list;
  const auto add = [&](std::size_t c) {
    if (std::find(list.begin(), list.end(), c) == list.end()) list.push_back(c);
  };
  for (const Term& t : terms) {
    for (const auto& [c, power] : t.powers) add(c);
    if (!t.shape.empty()) add(t.shape_of);
    if (t.powers.empty() && t.shape.empty() && t.along != Term::absolute) add(t.along);
  }
  const auto found = std::find(list.begin(), list.end(), preferred);
  if (found != list.end()) std::rotate(list.begin(), found, found + 1);
  return list;
}

constexpr double least_of_curve = 0.5;  // of what free curves over its conditions repair on unseen groups

// Free curves over these conditions, all at once, on unseen groups: what a law over them could repair at best.
double gain_of_curves(const LawData& data, const std::vector<std::size_t>& conditions) {
  RawColumns columns;
  for (const std::size_t c : conditions)
    for (std::vector<double>& hat : free_curve(data.system(), c)) columns.push_back(std::move(hat));
  return gain(data.held_out({}), data.held_out(columns)).mean;
}

struct Judged {
  std::vector<Term> terms;
  Extrapolation leading;
  bool kept = false;
};
Judged judged(const LawData& data, const std::vector<Term>& terms, std::size_t preferred, const Tuned& tuned = {}) {
  Judged result{terms, {}, false};
  const std::vector<std::size_t> conditions = conditions_of(terms, preferred);
  result.leading = extrapolate(data, terms, conditions[0], tuned);
  if (!result.leading.passes) return result;
  for (std::size_t k = 1; k < conditions.size(); ++k) {
    const Extrapolation other = extrapolate(data, terms, conditions[k]);
    if ((other.outwards.tells() || other.inwards.tells()) && !other.passes) return result;
  }
  const Gain g = gain(data.held_out({}), data.held_out(columns_of(data, terms)));
  result.kept = data.system().groups.size() < 3 ||
                (g.mean > g.sigma && g.mean >= least_of_curve * gain_of_curves(data, conditions));
  return result;
}

// The most terms that extrapolate, each further one extrapolating better than without it.
Judged best_law(const LawData& data, const std::vector<Term>& possible, std::size_t preferred) {
  Judged best;
  std::vector<Term> first;
  for (const Term& single : good_singles(data, possible, level)) {
    Judged law = judged(data, {single}, preferred);
    if (first.empty()) first = law.terms;
    if (!law.kept) continue;
    best = std::move(law);
    break;
  }
  std::vector<Term> terms = best.kept ? best.terms : first;
  while (!terms.empty() && terms.size() < most_terms) {
    terms = with_one_more(data, possible, terms, level);
    if (terms.empty()) break;
    Judged law = judged(data, terms, preferred);
    if (!law.kept || (best.kept && law.leading.law < best.leading.law + law.leading.sigma)) continue;
    best = std::move(law);
  }
  return best;
}

// Fall of chi-square that a law brings on all rows.
double fall_of(const LawData& data, const std::vector<Term>& terms) {
  const RawColumns columns = columns_of(data, terms);
  const Eigen::MatrixXd all = data.projected(columns);
  const Eigen::VectorXd moved = all.leftCols(all.cols() - 1) * data.coefficients(columns, {});
  return 2 * all.rightCols(1).col(0).dot(moved) - moved.squaredNorm();
}

// A periodic law, where it says clearly more than `other` does.
Judged or_wave(const LawData& data, const std::vector<std::size_t>& leaders, Judged other) {
  const Wave wave = find_wave(data, leaders, level);
  if (wave.terms.empty()) return other;
  if (other.kept && wave.fall < clearly_more * fall_of(data, other.terms)) return other;
  Judged law = judged(data, wave.terms, leaders[0], wave.tuned);
  return law.kept ? law : other;
}

// d(term)/d(scale), for the scale's uncertainty.
std::vector<double> slope_of_scale(const System& system, const Term& term) {
  Term above = term, below = term;
  const double step = 1e-4 * std::abs(term.scale);
  above.scale += step, below.scale -= step;
  std::vector<double> slope = column_of(system, above);
  const std::vector<double> low = column_of(system, below);
  for (std::size_t i = 0; i < slope.size(); ++i) slope[i] = (slope[i] - low[i]) / (2 * step);
  return slope;
}

void tell_terms(const LawData& data, const std::vector<Term>& terms, Outside& outside) {
  const System& system = data.system();
  RawColumns columns = columns_of(data, terms);
  const Eigen::VectorXd c = data.coefficients(columns, {});
  outside.per_row = combined(columns, c);
  std::vector<Eigen::Index> scale_at(terms.size(), -1);
  Eigen::VectorXd all = c;
  for (std::size_t k = 0; k < terms.size(); ++k) {
    if (!terms[k].fitted_scale) continue;
    std::vector<double> slope = slope_of_scale(system, terms[k]);
    for (double& v : slope) v *= c[static_cast<Eigen::Index>(k)];
    if (k > 0 && shares_scale(terms[k - 1], terms[k])) {
      scale_at[k] = scale_at[k - 1];
      std::vector<double>& common = columns[static_cast<std::size_t>(scale_at[k])];
      for (std::size_t i = 0; i < slope.size(); ++i) common[i] += slope[i];
      continue;
    }
    scale_at[k] = static_cast<Eigen::Index>(columns.size());
    columns.push_back(std::move(slope));
    all.conservativeResize(all.size() + 1);
    all[all.size() - 1] = 0;
  }
  const Eigen::MatrixXd covariance = data.covariance(columns, all);
  const auto sigma = [&](Eigen::Index k) { return k < 0 ? 0.0 : std::sqrt(std::max(0.0, covariance(k, k))); };
  for (std::size_t k = 0; k < terms.size(); ++k) {
    const auto place = static_cast<Eigen::Index>(k);
    outside.terms.push_back(told(system, terms[k], c[place], sigma(place), sigma(scale_at[k])));
  }
  outside.law = in_words(system.problem(), outside.terms);
}

// Constants that a person can use: each known to a third, a scale to a half. A cosine and a sine are one amplitude.
bool has_sane_constants(const std::vector<LawTerm>& terms) {
  constexpr double of_coefficient = 1.0 / 3, of_scale = 0.5;
  for (std::size_t k = 0; k < terms.size(); ++k) {
    const LawTerm& t = terms[k];
    if (t.scale_sigma > of_scale * std::abs(t.scale)) return false;
    if (is_wave(terms, k)) {
      const LawTerm& s = terms[++k];
      if (std::hypot(t.sigma, s.sigma) > of_coefficient * std::hypot(t.coefficient, s.coefficient)) return false;
    } else if (t.sigma > of_coefficient * std::abs(t.coefficient)) {
      return false;
    }
  }
  return true;
}

void tell(const LawData& data, const Judged& law, Explanation& e) {
  const System& system = data.system();
  const Condition& leading = system.observations().conditions[law.leading.condition];
  Outside& outside = *e.outside;
  Outside told = outside;
  tell_terms(data, law.terms, told);
  if (!has_sane_constants(told.terms)) return;
  const Eigen::MatrixXd projected = data.projected({told.per_row});
  std::vector<double> before(told.per_row.size()), after(before.size());
  double squares = 0, fall = 0, rows = 0, moved = 0, mismatch = 0, left_over = 0, norm = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double w = system.weight(i);
    if (!(w > 0)) continue;
    const auto row = static_cast<Eigen::Index>(i);
    const double r = projected(row, 1), left = r - projected(row, 0);
    squares += r * r;
    fall += r * r - left * left;
    rows += 1;
    before[i] = r / w, after[i] = left / w;
    moved += std::pow(before[i] - after[i], 2), mismatch += before[i] * before[i], left_over += after[i] * after[i];
    norm += system.observations().norm[i];
  }
  // As of a mechanism (Race::effect): what is smaller than what matters is no law to report.
  const double effect = system.problem().importance() == Importance::share_of_residual
                            ? 1 - std::sqrt(left_over / std::max(mismatch, 1e-300))
                            : std::sqrt(moved / std::max(norm, 1e-300));
  const Way& way = law.leading.outwards.tells() ? law.leading.outwards : law.leading.inwards;
  if (effect < e.smallest_effect || way.after > (1 - e.smallest_effect) * way.before) return;
  outside = std::move(told);
  outside.condition = leading.name;
  outside.stage = leading.stage;
  outside.held_out_before = way.before;
  outside.held_out_after = way.after;
  outside.split = law.leading.split;
  outside.extrapolated = (law.leading.by_size ? "the size of " : "") + leading.name +
                         (law.leading.outwards.tells() ? " beyond " : " below ") +
                         quantity(law.leading.split, leading.unit);
  const double excess = squares - (rows - static_cast<double>(e.active.size()));
  outside.share = excess > 0 ? std::clamp(fall / excess, 0.0, 1.0) : 0;
  outside.curve = residual_curve(system, law.leading.condition, before, after, 16);
}

}  // namespace

void find_law(const System& system, Explanation& e) {
  if (!e.outside) return;
  const std::vector<std::size_t> leaders = leaders_of(system, e);
  if (leaders.empty()) return;
  const LawData data(system, e.values, e.active);
  e.outside->stage = system.observations().conditions[leaders[0]].stage;
  const Judged law = or_wave(data, leaders, best_law(data, possible_terms(system, leaders), leaders[0]));
  if (law.kept) tell(data, law, e);
}

}  // namespace gonio::inference

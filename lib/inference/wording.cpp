// See wording.h.
#include "inference/wording.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "inference/race.h"
#include "report/number_text.h"

namespace gonio::inference {
namespace {

constexpr std::size_t most_parameters = 2;
constexpr std::size_t most_targets = 6;        // listed by name
constexpr std::size_t numbers_of_a_list = 16;  // more are a list with no number that stands out

// "lights/lamp/radius_m" -> "radius"; the unit goes with the value.
std::string short_name(const std::string& full) {
  std::string name = full.substr(full.find_last_of("./") == std::string::npos ? 0 : full.find_last_of("./") + 1);
  for (const char* unit : {"_per_px", "_m", "_rad", "_px", "_s", "_K", "_1", "_per_m", "_m_per_s"})
    if (name.size() > std::string(unit).size() && name.ends_with(unit)) {
      name.resize(name.size() - std::string(unit).size());
      break;
    }
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::string joined(const std::string& number, const Shown& shown) {
  return shown.unit.empty() ? number : number + " " + shown.unit;
}

}  // namespace

std::string printed(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

std::string plain_number(double value, int digits) {
  return std::abs(value) >= 99.5 && std::abs(value) < 1e9 ? std::to_string(std::lround(value)) : printed(value, digits);
}

Shown shown_in(const std::string& unit, double size) {
  size = std::abs(size);
  if (unit == "rad") return {180 / std::numbers::pi, "degrees"};
  if (unit == "m" && size > 0 && size < 99.5e-9) return {1e9, "nm"};
  if (unit == "m" && size > 0 && size < 0.0995) return size < 99.5e-6 ? Shown{1e6, "µm"} : Shown{1e3, "mm"};
  if (unit == "s" && size > 0 && size < 0.0995) return {1e3, "ms"};
  if (unit.empty() || unit == "1") return {1, ""};
  if (unit.starts_with("half ")) return {1, "of the " + unit};
  return {1, unit};
}

std::string quantity(double value, const std::string& unit, int digits) {
  const Shown shown = shown_in(unit, value);
  return joined(printed(value * shown.factor, digits), shown);
}

std::string share_in_words(double share) {
  if (std::abs(share) < 1e-4) return share == 0 ? "0 %" : "< 0.01 %";
  return printed(100 * share, std::abs(share) >= 0.995 ? 3 : 2) + " %";
}

std::string probability_in_words(double probability) {
  if (probability > 0.995) return "over 99 %";
  if (probability < 0.005) return "under 1 %";
  return std::to_string(std::lround(100 * probability)) + " %";
}

std::string score_in_words(double score, const std::string& unit) {
  return unit.empty() || unit == "1" ? share_in_words(score) : quantity(score, unit, 3);
}

std::string estimate_in_words(double value, double sigma, const std::string& unit) {
  const Shown shown = shown_in(unit, std::max(std::abs(value), sigma));
  value *= shown.factor, sigma *= shown.factor;
  // Below its sigma a value has no digits of its own.
  if (std::abs(value) < sigma && sigma >= 1e-6 && sigma < 1e6) {
    const int decimals = std::max(0, 1 - static_cast<int>(std::floor(std::log10(sigma))));
    char text[96];
    std::snprintf(text, sizeof text, "%.*f ± %.*f", decimals, value, decimals, sigma);
    return joined(text, shown);
  }
  return joined(report::with_sigma(value, sigma), shown);
}

std::string condition_in_words(const std::string& name) {
  std::string words = name.substr(name.find('.') == std::string::npos ? 0 : name.find('.') + 1);
  for (const char* unit : {"_s", "_m", "_K", "_rad"})
    if (words.size() > 2 && words.ends_with(unit)) words.resize(words.size() - std::string(unit).size());
  std::replace(words.begin(), words.end(), '-', ' ');
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

std::string range_in_words(const LocatedCondition& c) {
  if (c.curve.centre.empty()) return "";
  const bool from_start = c.lower <= c.curve.centre.front(), to_end = c.upper >= c.curve.centre.back();
  if (from_start && to_end) return "";
  const auto end = [](double value, const Shown& shown) { return plain_number(value * shown.factor); };
  if (from_start) return "below " + joined(end(c.upper, shown_in(c.unit, c.upper)), shown_in(c.unit, c.upper));
  if (to_end) return "above " + joined(end(c.lower, shown_in(c.unit, c.lower)), shown_in(c.unit, c.lower));
  const Shown shown = shown_in(c.unit, std::max(std::abs(c.lower), std::abs(c.upper)));
  return "between " + end(c.lower, shown) + " and " + joined(end(c.upper, shown), shown);
}

std::string place_in_words(const Problem& problem, const LocatedCondition& c) {
  if (!(c.period > 0)) return "the " + condition_in_words(c.name);
  return "bands along the " + condition_in_words(c.name) + ", " + quantity(c.period, c.unit) +
         " from one to the next, begun anew in every " + problem.group_noun();
}

bool tells_where(const LocatedCondition& c) {
  return c.share >= telling_share || c.of_effect >= telling_share_of_effect;
}

std::string nowhere_in_words(const Problem& problem, const LocatedCondition& c) {
  return "no condition carries it: the most telling, " + place_in_words(problem, c) + ", holds " +
         share_in_words(c.share) + " of the excess";
}

std::string mechanism_in_words(const Problem& problem, std::size_t candidate) {
  const Candidate& c = problem.candidates()[candidate];
  std::string text = c.id();
  const std::size_t shown = c.on.size() > most_targets + 1 ? most_targets : c.on.size();
  for (std::size_t k = 0; k < shown; ++k) text += (k == 0 ? " on " : k + 1 == c.on.size() ? " and " : ", ") + c.on[k];
  if (shown < c.on.size()) text += " and " + std::to_string(c.on.size() - shown) + " more";
  return text;
}

std::vector<std::string> minor_mechanisms(const Problem& problem, const Explanation& e) {
  std::vector<std::string> ids;
  for (const std::size_t place : e.minor) {
    if (place >= e.scoreboard.size()) continue;
    for (const std::size_t c : e.scoreboard[place].candidates) {
      const std::string& id = problem.candidates()[c].id();
      const auto same = [&](std::size_t named) { return problem.candidates()[named].id() == id; };
      if (std::find(ids.begin(), ids.end(), id) == ids.end() && std::none_of(e.named.begin(), e.named.end(), same))
        ids.push_back(id);
    }
  }
  return ids;
}

namespace {

// What the mechanism says that its parameter means, up to the first aside; its short name where that is long.
std::string meaning_of(const Candidate& candidate, const Parameter& parameter) {
  constexpr std::size_t longest = 48;
  const mechanism::Parameter* own = declared(candidate, parameter);
  std::string words = own == nullptr ? "" : own->meaning.substr(0, own->meaning.find_first_of(";:,("));
  if (words.ends_with(' ')) words.pop_back();
  return words.empty() || words.size() > longest ? short_name(parameter.name) : words;
}

// A clear dielectric's reflectance at normal incidence is known better by its refractive index.
std::string index_in_words(const std::string& name, const Estimate& x) {
  if (short_name(name) != "f0" || !(x.value > 0) || x.value > 0.2) return "";
  const double root = std::sqrt(x.value), index = (1 + root) / (1 - root);
  return ", a refractive index of " + estimate_in_words(index, x.sigma / (root * (1 - root) * (1 - root)), "1");
}

}  // namespace

std::string physics_in_words(const Problem& problem, const Explanation& e, std::size_t candidate) {
  const std::string& sentence = problem.candidates()[candidate].mechanism->sentence;
  const std::string own = parameters_in_words(problem, e, candidate, Called::by_meaning);
  return sentence.substr(0, sentence.find_last_not_of('.') + 1) + " (" + mechanism_in_words(problem, candidate) +
         (own.empty() ? "" : ": ") + own + ").";
}

std::string parameters_in_words(const Problem& problem, const Explanation& e, std::size_t candidate, Called called) {
  const std::vector<std::size_t>& own = problem.candidates()[candidate].parameters;
  const auto of_all = [&](std::size_t p) { return problem.parameters()[p].groups.size() != 1; };
  if (static_cast<std::size_t>(std::ranges::count_if(own, of_all)) > numbers_of_a_list) return "";
  std::vector<const Estimate*> clear;  // of neutral, the clearest first
  const auto distance = [&](const Estimate* x) {
    return x->sigma > 0 ? std::abs(x->value - problem.parameters()[x->parameter].neutral) / x->sigma : 0;
  };
  for (const Estimate& x : e.estimates) {
    if (std::find(own.begin(), own.end(), x.parameter) == own.end()) continue;
    const Parameter& p = problem.parameters()[x.parameter];
    // A number for every group; of one or two groups that the mechanism names, it is what is to be told.
    const bool few = own.size() <= most_parameters && !problem.candidates()[candidate].on.empty();
    if (p.groups.size() == 1 && problem.observations().groups() > 1 && !few) continue;
    if (distance(&x) > 2) clear.push_back(&x);
  }
  std::stable_sort(clear.begin(), clear.end(),
                   [&](const Estimate* a, const Estimate* b) { return distance(a) > distance(b); });
  if (clear.size() > most_parameters) clear.resize(most_parameters);
  std::sort(clear.begin(), clear.end());  // in the order of the declaration
  std::string text;
  for (const Estimate* x : clear) {
    const Parameter& p = problem.parameters()[x->parameter];
    const bool meant = called == Called::by_meaning;
    const std::string name = meant ? meaning_of(problem.candidates()[candidate], p) : short_name(p.name);
    text += (text.empty() ? "" : ", ") + name + " " + estimate_in_words(x->value, x->sigma, p.unit);
    if (meant) text += index_in_words(p.name, *x);
  }
  return text;
}

}  // namespace gonio::inference

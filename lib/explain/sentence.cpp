// See sentence.h.
#include "explain/sentence.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace gonio::explain {
namespace {

std::string targets(const Candidate& c) {
  std::string text;
  for (std::size_t k = 0; k < c.on.size(); ++k)
    text += (k == 0 ? " on " : k + 1 == c.on.size() ? " and " : ", ") + c.on[k];
  return text;
}

std::string with_unit(double value, const std::string& unit) {
  return unit.empty() || unit == "1" ? printed(value) : printed(value) + " " + unit;
}

std::string located_in(const Explanation& e) {
  if (e.conditions.empty() || e.conditions[0].share < 0.05) return "";
  const LocatedCondition& c = e.conditions[0];
  return ", seen in " + c.name + " between " + printed(c.lower, 2) + " and " + with_unit(c.upper, c.unit);
}

std::string named_sentence(const Problem& problem, const Explanation& e) {
  std::string text = "The recordings show ";
  for (std::size_t k = 0; k < e.named.size(); ++k) {
    const Candidate& c = problem.candidates()[e.named[k]];
    text += (k == 0 ? "" : k + 1 == e.named.size() ? " and " : ", ") + c.id() + targets(c);
  }
  text += located_in(e) + ": with it the " + problem.score_name() + " on " +
          (e.test_groups.empty() ? "left-out " : "unseen ") + problem.group_noun() + "s falls from " +
          with_unit(e.held_out_before, problem.unit()) + " to " + with_unit(e.held_out_after, problem.unit()) + ".";
  for (const std::vector<std::size_t>& set : e.not_told_apart) {
    text += " As good an explanation as " + problem.candidates()[set[0]].id() + " is";
    for (std::size_t k = 1; k < set.size(); ++k) text += (k == 1 ? " " : " or ") + problem.candidates()[set[k]].id();
    text += ": these recordings cannot tell them apart.";
  }
  if (e.outside) text += " Structure over " + e.outside->condition + " remains that nothing in the library repairs.";
  return text;
}

std::string plain_sentence(const Problem& problem, const Explanation& e) {
  if (e.verdict == Verdict::unknown) {
    const std::string where = e.outside ? e.outside->condition : e.conditions.empty() ? "" : e.conditions[0].name;
    return "There is a mismatch that matters" + (where.empty() ? "" : ", structured over " + where) +
           ", and no physics in the library repairs it on unseen " + problem.group_noun() + "s (" +
           problem.score_name() + " " + with_unit(e.held_out_before, problem.unit()) + ").";
  }
  if (e.significant)
    return "A mismatch beyond noise is there, but nothing that would repair it matters (under " +
           printed(100 * e.matters) + " %); no physics is named (" + problem.score_name() + " " +
           with_unit(e.held_out_before, problem.unit()) + ").";
  return "No mismatch beyond noise (p = " + printed(e.global_p, 2) + "); no physics is named (" + problem.score_name() +
         " " + with_unit(e.held_out_before, problem.unit()) + ").";
}

// The measurement that tells two mechanisms apart, from either one's declaration.
std::string told_apart(const mechanism::Mechanism& a, const std::string& b) {
  for (const mechanism::Confusion& c : a.mistaken_for)
    if (c.with == b) return c.told_apart;
  return "";
}

std::string conditions_of(const mechanism::Mechanism& m) {
  return m.conditions.empty() ? "" : " (" + m.conditions[0] + ")";
}

std::string measurement(const Problem& problem, const Explanation& e) {
  for (const std::vector<std::size_t>& set : e.not_told_apart)
    for (std::size_t k = 1; k < set.size(); ++k) {
      const mechanism::Mechanism &a = *problem.candidates()[set[0]].mechanism,
                                 &b = *problem.candidates()[set[k]].mechanism;
      std::string how = told_apart(a, b.id);
      if (how.empty()) how = told_apart(b, a.id);
      if (how.empty() && !a.mistaken_for.empty()) how = a.mistaken_for[0].told_apart;
      return "To tell " + a.id + " from " + b.id + ": " + (how.empty() ? "record under other conditions" : how) + ".";
    }
  if (!e.named.empty()) {
    const mechanism::Mechanism& m = *problem.candidates()[e.named[0]].mechanism;
    if (!m.mistaken_for.empty())
      return "To confirm " + m.id + " against " + m.mistaken_for[0].with + ": " + m.mistaken_for[0].told_apart + ".";
  }
  for (const Isolability& i : e.isolability)
    if (!i.visible && e.verdict != Verdict::named)
      return "These recordings cannot show " + problem.candidates()[i.candidate].id() + "; vary its conditions" +
             conditions_of(*problem.candidates()[i.candidate].mechanism) + " to look for it.";
  if (e.verdict == Verdict::unknown && !e.conditions.empty())
    return "Record more " + problem.group_noun() + "s that vary " + e.conditions[0].name + ".";
  return "";
}

}  // namespace

std::string printed(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

Shown shown_in(const std::string& unit, double size) {
  size = std::abs(size);
  if (unit == "rad") return {180 / std::numbers::pi, "degrees"};
  if (unit == "m" && size > 0 && size < 0.0995) return size < 99.5e-6 ? Shown{1e6, "µm"} : Shown{1e3, "mm"};
  if (unit == "s" && size > 0 && size < 0.0995) return {1e3, "ms"};
  if (unit.empty() || unit == "1") return {1, ""};
  if (unit.starts_with("half ")) return {1, "of the " + unit};
  return {1, unit};
}

std::string quantity(double value, const std::string& unit, int digits) {
  const Shown shown = shown_in(unit, value);
  return printed(value * shown.factor, digits) + (shown.unit.empty() ? "" : " " + shown.unit);
}

void write_sentence(const Problem& problem, Explanation& e) {
  e.sentence = e.named.empty() ? plain_sentence(problem, e) : named_sentence(problem, e);
  if (const std::string remarks = problem.remarks(e); !remarks.empty()) e.sentence += " " + remarks;
  e.next_measurement = measurement(problem, e);
}

}  // namespace gonio::explain

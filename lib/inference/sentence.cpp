// See sentence.h.
#include "inference/sentence.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "inference/compensation.h"
#include "inference/stability.h"

namespace gonio::inference {
namespace {

constexpr double most_over_noise = 1.5;  // residuals over the stated noise that are called noise

// " It shows where the half angle is below 25 degrees."
std::string located_in(const Problem& problem, const Explanation& e) {
  if (e.conditions.empty()) return "";
  const LocatedCondition& c = e.conditions[0];
  if (c.name == "image.identity") return "";  // the mechanisms say which
  if (!tells_where(c)) return " N" + nowhere_in_words(problem, c).substr(1) + ".";
  const std::string shows = e.named.size() == 1 ? " It shows " : " They show ", range = range_in_words(c);
  if (c.period > 0) return shows + "as " + place_in_words(problem, c) + ".";
  if (range.empty()) return shows + "over the whole range of the " + condition_in_words(c.name) + ".";
  return shows + "where the " + condition_in_words(c.name) + " is " + range + ".";
}

std::string law_sentence(const Problem& problem, const Outside& o) {
  if (o.terms.empty()) return "";
  return " Outside the library, a law describes it: " + o.law + ". Fitted on the other side it lowers the " +
         problem.score_name() + " for " + o.extrapolated + " from " +
         score_in_words(o.held_out_before, problem.unit()) + " to " + score_in_words(o.held_out_after, problem.unit()) +
         ".";
}

std::string listed(const Problem& problem, const std::vector<std::size_t>& candidates, std::size_t first,
                   const char* last) {
  std::vector<std::string> ids;  // each once, whatever its forms and targets
  for (const std::size_t c : candidates)
    if (const std::string id = problem.candidates()[c].id(); std::ranges::find(ids, id) == ids.end()) ids.push_back(id);
  std::string text;
  for (std::size_t k = first; k < ids.size(); ++k)
    text += (k == first ? "" : k + 1 == ids.size() ? last : ", ") + ids[k];
  return text;
}

std::set<std::string> ids_of(const Problem& problem, const std::vector<std::size_t>& candidates) {
  std::set<std::string> ids;
  for (const std::size_t c : candidates) ids.insert(problem.candidates()[c].id());
  return ids;
}

// Do all that could be instead hold what is named, and more?
bool only_part(const Problem& problem, const Explanation& e) {
  const std::set<std::string> named = ids_of(problem, e.named);
  return e.verdict == Verdict::ambiguous && e.not_told_apart.empty() && !e.instead.empty() &&
         std::ranges::all_of(e.instead, [&](const std::vector<std::size_t>& set) {
           return std::ranges::includes(ids_of(problem, set), named);
         });
}

// Of every set of mechanisms that was weighed, whatever the forms: its words and its probability.
struct Share {
  std::string words;
  double probability = 0;
};
std::map<std::set<std::string>, Share> shares_of(const Problem& problem, const Explanation& e) {
  std::map<std::set<std::string>, Share> shares;
  for (const Explanation::Weighed& w : e.weighed) {
    if (w.kind != Explanation::Weighed::Kind::set) continue;
    Share& share = shares[ids_of(problem, w.candidates)];
    if (share.words.empty()) share.words = listed(problem, w.candidates, 0, " with ");
    share.probability += w.probability;
  }
  return shares;
}

// Those of what is named and of what it could be instead, the likeliest first.
std::vector<Share> shares_of_listed(const Problem& problem, const Explanation& e) {
  std::set<std::set<std::string>> sets{ids_of(problem, e.named)};
  for (const std::vector<std::size_t>& set : e.instead) sets.insert(ids_of(problem, set));
  if (e.named.size() == 1 && !e.not_told_apart.empty())
    for (const std::size_t c : e.not_told_apart[0]) sets.insert(ids_of(problem, {c}));
  std::vector<Share> result;
  for (const auto& [ids, share] : shares_of(problem, e))
    if (sets.contains(ids)) result.push_back(share);
  std::ranges::stable_sort(result, std::greater<>(), &Share::probability);
  return result;
}

// "94 % sure."; of several that could be, each one's own share.
std::string sure_sentence(const Problem& problem, const Explanation& e) {
  if (e.weighed.empty()) return "";
  const std::string it = e.named.size() == 1 ? "it is" : "they are", these = e.named.size() == 1 ? "this" : "these";
  std::string each;
  for (const Share& share : shares_of_listed(problem, e))
    if (share.probability >= 0.01)
      each += (each.empty() ? "" : ", ") + share.words + " " + probability_in_words(share.probability);
  if (only_part(problem, e)) {
    const std::set<std::string> named = ids_of(problem, e.named);
    double part = 0;
    for (const auto& [ids, share] : shares_of(problem, e))
      if (std::ranges::includes(ids, named)) part += share.probability;
    return " How sure: " + probability_in_words(part) + " that " + it +
           " among what was left out, and most likely not alone (" + each + ").";
  }
  const std::string text = " How sure: " + probability_in_words(e.probability) + " that it is ";
  if (e.verdict == Verdict::named) return text + these + (e.not_told_apart.empty() ? "." : ", or what says the same.");
  return text + "among what is listed (" + each + ").";
}

// What the library has that comes closest, where nothing is named.
std::string likeliest_sentence(const Problem& problem, const Explanation& e) {
  using Kind = Explanation::Weighed::Kind;
  for (const Explanation::Weighed& w : e.weighed) {
    if (w.kind != Kind::set || w.probability < 0.02) continue;
    return " How sure: " + probability_in_words(e.probability) +
           " that it is none of the library's; the likeliest is " + listed(problem, w.candidates, 0, " with ") +
           ", with " + probability_in_words(w.probability) + ".";
  }
  return "";
}

// Of several that it could be the first is the plainest, and mostly the likeliest.
std::string opening(const Problem& problem, const Explanation& e) {
  if (e.verdict != Verdict::ambiguous || only_part(problem, e)) return "";
  const std::vector<Share> shares = shares_of_listed(problem, e);
  const double named = shares_of(problem, e)[ids_of(problem, e.named)].probability;
  return shares.empty() || named >= shares[0].probability ? "Likeliest: " : "The plainest of what it may be: ";
}

// The physics in its own words, where it shows, and what it is worth.
std::string named_sentence(const Problem& problem, const Explanation& e) {
  std::string text = opening(problem, e);
  for (std::size_t k = 0; k < e.named.size(); ++k)
    text += (k == 0 ? "" : " ") + physics_in_words(problem, e, e.named[k]);
  text += located_in(problem, e) + " With " + (e.named.size() == 1 ? "it, " : "them, ") + problem.group_noun() +
          "s that the fit " + (e.test_groups.empty() ? "left out" : "never saw") + " are predicted to " +
          score_in_words(e.held_out_after, problem.unit()) + " instead of " +
          score_in_words(e.held_out_before, problem.unit()) + " (" + problem.score_name() + ").";
  text += sure_sentence(problem, e);
  for (const std::vector<std::size_t>& set : e.not_told_apart)
    if (const std::string others = listed(problem, set, 1, " or "); !others.empty())
      text += " In the place of " + problem.candidates()[set[0]].id() + " it could be " + others +
              ": these recordings cannot tell them apart.";
  std::set<std::string> told;
  for (const std::vector<std::size_t>& set : e.instead) {
    const std::string other = listed(problem, set, 0, " with ");
    if (only_part(problem, e)) break;  // they have been told with their shares
    if (told.insert(other).second && other != listed(problem, e.named, 0, " with "))
      text += " Instead of " + listed(problem, e.named, 0, " and ") + " it could be " + other + ".";
  }
  if (e.outside)
    text += " Structure over the " + condition_in_words(e.outside->condition) +
            " remains that nothing in the library repairs." + law_sentence(problem, *e.outside);
  else if (e.left_beyond_noise >= e.smallest_effect)
    text += " It is not all: what is left scatters by " + share_in_words(e.left_beyond_noise) +
            " of the signal, more than the noise, and nothing in the library repairs it.";
  return text;
}

// Residuals of the base model over the noise that they were weighed by, root mean square per degree of freedom. The
// null test asks blocks for structure, whatever they scatter by; this is the other question.
double misfit_over_noise(const Problem& problem, const Explanation& e) {
  const Observations& o = problem.observations();
  double squares = 0, rows = 0;
  for (std::size_t i = 0; i < std::min(o.rows(), e.residual_before.size()); ++i) {
    const double z = e.residual_before[i] / (o.sigma[i] * e.noise_factor);
    squares += z * z;
    rows += 1;
  }
  const double freedom = std::max(1.0, rows - static_cast<double>(problem.base().size()));
  return rows > 0 ? std::sqrt(squares / freedom) : 0;
}

// Where it is, by the condition `where`; that it is nowhere, where even the most telling one holds little of it.
std::string structured(const Problem& problem, const Explanation& e, const std::string& where) {
  const auto located = std::ranges::find(e.conditions, where, &LocatedCondition::name);
  if (located == e.conditions.end()) return ", structured over the " + condition_in_words(where);
  const LocatedCondition& most = *std::ranges::max_element(e.conditions, {}, &LocatedCondition::share);
  if (!tells_where(most)) return ", but " + nowhere_in_words(problem, most);
  if (located->period > 0) return ", in " + place_in_words(problem, *located);
  const std::string range = range_in_words(*located);
  return ", structured over the " + condition_in_words(where) + (range.empty() ? "" : " (most of it " + range + ")");
}

// "few readings (45 of 17904, at 18 places, most of them in p04, p05)"; empty where none stand out so that it matters.
std::string outlying_in_words(const Problem& problem, const Explanation& e) {
  constexpr std::size_t most_names = 3;
  if (!matter(e.outliers, e.smallest_effect)) return "";
  const Observations& o = problem.observations();
  std::string names;
  for (std::size_t k = 0; k < std::min(most_names, e.outliers->of_groups.size()); ++k)
    names += (k == 0 ? "" : ", ") + o.group[e.outliers->of_groups[k].first];
  return "few readings that stand out (" + std::to_string(e.outliers->readings) + " of " + std::to_string(o.rows()) +
         ", at " + std::to_string(e.outliers->places) + " places, most of them in " + names + ")";
}

std::string plain_sentence(const Problem& problem, const Explanation& e) {
  const std::string score = problem.score_name() + " " + score_in_words(e.held_out_before, problem.unit());
  if (e.verdict == Verdict::unknown) {
    const std::string where = e.outside ? e.outside->condition : e.conditions.empty() ? "" : e.conditions[0].name;
    const std::string few = outlying_in_words(problem, e);
    std::string text = "There is a mismatch that matters";
    text += !few.empty() && !e.outside ? ", in " + few : where.empty() ? "" : structured(problem, e, where);
    text += ", and no physics in the library repairs it on unseen " + problem.group_noun() + "s (" + score + ").";
    text += likeliest_sentence(problem, e);
    return e.outside ? text + law_sentence(problem, *e.outside) : text;
  }
  if (e.significant)
    return "A mismatch beyond noise is there, but nothing that would repair it matters (under " +
           printed(100 * e.smallest_effect) + " %); no physics is named (" + score + ").";
  const std::string p = "(p = " + printed(e.global_p, 2) + ")";
  const double times = misfit_over_noise(problem, e);
  if (times <= most_over_noise) return "No mismatch beyond noise " + p + "; no physics is named (" + score + ").";
  return "No structure is told from scatter " + p + ", so no physics is named; but the residuals scatter " +
         printed(times, 2) + " times as much as the noise that was taken for them: that may be larger, or these are " +
         "too few " + problem.group_noun() + "s to show more (" + score + ").";
}

// Said before any physics: the base model lies outside what is plausible for it.
std::string limits_sentence(const Problem& problem, const Explanation& e) {
  constexpr std::size_t most = 3;
  std::string text;
  for (std::size_t k = 0; k < std::min(most, e.at_limits.size()); ++k) {
    const Parameter& p = problem.parameters()[e.at_limits[k]];
    text += (k == 0 ? "" : ", ") + p.name + " (" + quantity(e.base_values[e.at_limits[k]], p.unit, 3) + ")";
  }
  if (e.at_limits.size() > most) text += " and " + std::to_string(e.at_limits.size() - most) + " more";
  if (text.empty()) return "";
  return std::string("The base model fits only at the limit of what is plausible for ") + text +
         ": look at units, files and the geometry first. ";
}

// Each of them was tried alone: several take up the same rest, so that none of them is said to be there.
std::string minor_sentence(const Problem& problem, const Explanation& e) {
  const std::vector<std::string> ids = minor_mechanisms(problem, e);
  if (ids.empty()) return "";
  std::string names;
  for (std::size_t k = 0; k < ids.size(); ++k) names += (k == 0 ? "" : k + 1 == ids.size() ? " or " : ", ") + ids[k];
  if (e.verdict == Verdict::null) return " What is there looks like " + names + ".";
  return " What else is left is smaller than what matters (" + printed(100 * e.smallest_effect) +
         " %) and looks like " + names + ".";
}

// Groups of which no observation counts took no part.
std::string unused_sentence(const Problem& problem) {
  constexpr std::size_t most_names = 4;
  const Observations& o = problem.observations();
  std::vector<std::string> names;
  for (std::size_t g = 0; g < o.groups(); ++g)
    if (o.first[g + 1] == o.first[g]) names.push_back(o.group[g]);
  if (names.empty()) return "";
  const std::size_t more = names.size() > most_names ? names.size() - most_names : 0;
  std::string text = " " + problem.group_noun() + (names.size() == 1 ? " " : "s ");
  for (std::size_t k = 0; k + more < names.size(); ++k)
    text += (k == 0 ? "" : more == 0 && k + 1 == names.size() ? " and " : ", ") + names[k];
  if (more > 0) text += " and " + std::to_string(more) + " more";
  text[1] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[1])));
  return text + (names.size() == 1 ? " takes no part: all that it shows" : " take no part: all that they show") +
         " is masked, clipped or missing.";
}

// The measurement that tells two mechanisms apart, from either one's declaration.
std::string told_apart(const mechanism::Mechanism& a, const std::string& b) {
  for (const mechanism::Confusion& c : a.mistaken_for)
    if (c.with == b) return c.told_apart;
  return "";
}

std::string from_declarations(const mechanism::Mechanism& a, const mechanism::Mechanism& b) {
  std::string how = told_apart(a, b.id);
  if (how.empty()) how = told_apart(b, a.id);
  if (how.empty() && !a.mistaken_for.empty()) how = a.mistaken_for[0].told_apart;
  return "To tell " + a.id + " from " + b.id + ": " + (how.empty() ? "record under other conditions" : how) + ".";
}

std::string planned(const Problem& problem, const PlannedMeasurement& p) {
  const std::string first = problem.candidates()[p.separates[0]].id();
  const std::string part = p.separates.size() > 1
                               ? "To tell " + first + " from " + problem.candidates()[p.separates[1]].id()
                               : "To see whether " + first + " is there";
  return part + ": " + p.sentence + " (expected: " + plain_number(p.z) + " standard errors).";
}

std::string unseen(const Problem& problem, const Explanation& e) {
  std::string ids;
  std::size_t count = 0;
  for (const Isolability& i : e.isolability) {
    if (i.visible) continue;
    const mechanism::Mechanism& m = *problem.candidates()[i.candidate].mechanism;
    if (++count > 4) continue;
    ids += (ids.empty() ? "" : ", ") + m.id;
    if (!m.conditions.empty()) ids += " (vary the " + condition_in_words(m.conditions[0]) + ")";
  }
  if (count == 0) return "";
  if (count > 4) ids += " and " + std::to_string(count - 4) + " more";
  return "These recordings cannot show " + ids + ".";
}

// A group that was set aside, and by how much what explains the others misses it.
std::string odd_sentence(const Problem& problem, const Explanation& e) {
  const Observations& o = problem.observations();
  std::string text;
  for (const std::size_t g : e.odd_groups) {
    const std::string name = o.group[g].starts_with(problem.group_noun()) ? "" : problem.group_noun() + " ";
    text += " " + name + o.group[g] + " is set aside: it alone fits nothing that explains the others (" +
            score_in_words(e.odd_score, problem.unit()) + " there).";
  }
  if (!text.empty()) text[1] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[1])));
  return text;
}

// Names that others know better; one stands nevertheless where nothing else was asked for.
std::string contradicted_sentence(const Problem& problem, const Explanation& e) {
  std::string text;
  for (const Explanation::Contradicted& c : e.contradicted) {
    const bool stands = std::ranges::any_of(
        e.named, [&](std::size_t candidate) { return problem.candidates()[candidate].id() == c.mechanism; });
    text += (stands ? " But " + c.by + " contradicts " + c.mechanism
                    : " " + c.mechanism + " is not named: " + c.by + " contradicts it") +
            " (" + c.quantity + ": " +
            (c.unit == "1"
                 ? share_in_words(c.after) + " instead of " + share_in_words(c.before)
                 : score_in_words(c.before, c.unit) + " without it, " + score_in_words(c.after, c.unit) + " with it") +
            ").";
  }
  return text;
}

// "The same answer came out in 14 of 20 draws of 6 of the 8 board views; otherwise lens.radial 4 times, nothing twice."
std::string stability_sentence(const Problem& problem, const Explanation& e) {
  if (!e.stability || e.stability->draws == 0) return "";
  const Stability& s = *e.stability;
  const std::size_t same = s.same(problem, e.verdict, e.named);
  std::string text = " The same answer came out in " + std::to_string(same) + " of " + std::to_string(s.draws) +
                     " draws of " + std::to_string(s.groups) + " of the " +
                     std::to_string(problem.observations().groups()) + " " + problem.group_noun() + "s";
  const std::vector<std::size_t> own = whatever_the_form(problem, e.named);
  std::string others;
  for (const Stability::Answer& a : s.answers) {
    if (a.named == own && (!own.empty() || a.verdict == e.verdict)) continue;
    const std::string what = !a.named.empty()                ? listed(problem, a.named, 0, " with ")
                             : a.verdict == Verdict::unknown ? std::string("nothing in the library")
                                                             : std::string("nothing left out");
    others += (others.empty() ? "; otherwise " : ", ") + what + " " + std::to_string(a.times) +
              (a.times == 1 ? " time" : " times");
  }
  return text + others + ".";
}

std::string measurement(const Problem& problem, const Explanation& e) {
  for (const std::vector<std::size_t>& set : e.not_told_apart)
    for (std::size_t k = 1; k < set.size(); ++k) {
      for (const PlannedMeasurement& p : e.plan)
        if (p.separates == std::vector<std::size_t>{set[0], set[k]}) return planned(problem, p);
      return from_declarations(*problem.candidates()[set[0]].mechanism, *problem.candidates()[set[k]].mechanism);
    }
  if (!e.named.empty()) {
    const mechanism::Mechanism& m = *problem.candidates()[e.named[0]].mechanism;
    if (!m.mistaken_for.empty())
      return "To confirm " + m.id + " against " + m.mistaken_for[0].with + ": " + m.mistaken_for[0].told_apart + ".";
  }
  if (const std::string few = outlying_in_words(problem, e);
      e.verdict == Verdict::unknown && !e.outside && !few.empty())
    return "Look at the places of the " + few + " first: an object that the manifest lacks, or light from elsewhere.";
  if (e.verdict == Verdict::unknown && !e.conditions.empty() && tells_where(e.conditions[0]))
    return "Record more " + problem.group_noun() + "s that vary the " +
           condition_in_words(e.outside ? e.outside->condition : e.conditions[0].name) + ".";
  if (!e.named.empty()) return "";
  const std::string blind = unseen(problem, e);
  for (const PlannedMeasurement& p : e.plan) return blind + " " + planned(problem, p);
  return blind;
}

}  // namespace

void write_sentence(const Problem& problem, Explanation& e) {
  if (!e.misplaced.files.empty()) {
    e.sentence = e.misplaced.sentence + " No physics is asked before that is settled (" + problem.score_name() + " " +
                 score_in_words(e.held_out_before, problem.unit()) + ").";
    e.next_measurement =
        "Put the files in their places, or look whether the manifest has the right pose, camera and "
        "light for these pictures; then explain again.";
    return;
  }
  e.sentence =
      limits_sentence(problem, e) + (e.named.empty() ? plain_sentence(problem, e) : named_sentence(problem, e));
  e.sentence += minor_sentence(problem, e) + unused_sentence(problem) + odd_sentence(problem, e) +
                contradicted_sentence(problem, e) + stability_sentence(problem, e);
  if (const std::string remarks = problem.remarks(e); !remarks.empty()) e.sentence += " " + remarks;
  if (!e.shortened.empty()) e.sentence += " " + e.shortened;
  e.next_measurement = measurement(problem, e);
}

}  // namespace gonio::inference

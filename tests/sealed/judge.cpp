#include "sealed/judge.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "base/text.h"

namespace gonio::sealed {
namespace {

constexpr double clearly = 3, matters = 0.01, margin = 1.3;  // cases within the margin are asked neither way

bool has(const std::vector<std::string>& list, const std::string& id) {
  return std::find(list.begin(), list.end(), id) != list.end();
}
// A lamp that is not where it was believed: one line of the list of mechanisms, two of its ids.
std::string physics_of(const std::string& id) {
  return id == "light.position" ? "light.direction" : id;
}
std::vector<std::string> physics_of(std::vector<std::string> ids) {
  for (std::string& id : ids) id = physics_of(id);
  return ids;
}
bool has_all(const std::vector<std::string>& list, const std::vector<std::string>& ids) {
  return std::all_of(ids.begin(), ids.end(), [&](const std::string& id) { return has(list, id); });
}
std::string joined(const std::vector<std::string>& ids) {
  std::string text;
  for (const std::string& id : ids) text += (text.empty() ? "" : " + ") + id;
  return text;
}

bool says_nothing(const Judged& j) {
  return j.truth.kind == Kind::null || j.truth.kind == Kind::distractor;
}
bool matter(const Judged& j) {
  return j.truth.share >= margin * matters;
}
bool too_small(const Judged& j) {
  return j.truth.share < matters / margin;
}
bool clear(const Judged& j) {
  return clearly_there(j);
}
bool all_clear(const Judged& j) {  // of a pair: neither is too weak to be seen
  const auto each = times_each_limit(j);
  return std::all_of(each.begin(), each.end(), [](const auto& t) { return t.second >= clearly; });
}
bool single(const Judged& j) {
  return j.truth.kind == Kind::single || j.truth.kind == Kind::alike;
}

bool wrongly_named(const Judged& j) {
  return !j.answer.named.empty() || !j.answer.elsewhere.empty();
}

std::vector<Asked> sealed_questions() {
  const auto apart = [](const Judged& j) { return single(j) && clear(j) && j.truth.apart == Apart::yes; };
  const auto alike = [](const Judged& j) { return single(j) && clear(j) && j.truth.apart == Apart::no; };
  const auto located = [](const Judged& j) {
    return single(j) && clear(j) && j.answer.verdict != "null" && !j.truth.conditions.empty();
  };
  return {
      {share_question("nothing left out (incl. distractors)", "wrongly named", "<= 2 %", 0.02, true), says_nothing,
       wrongly_named},
      {share_question("present at 3x the detection limit", "found", ">= 95 %", 0.95, false),
       [](const Judged& j) { return single(j) && clear(j); },
       [](const Judged& j) { return j.answer.verdict != "null"; }},
      {share_question("where", "right condition first", ">= 90 %", 0.9, false), located,
       [](const Judged& j) { return has(j.truth.conditions, j.answer.condition); }},
      {share_question("where", "AUC of the evidence >= 0.9", ">= 90 % of cases", 0.9, false),
       [](const Judged& j) { return single(j) && clear(j) && j.answer.auc.has_value(); },
       [](const Judged& j) { return *j.answer.auc >= 0.9; }},
      {share_question("where", "the same, all observations above one noise width", "", 0.9, false, false),
       [](const Judged& j) { return single(j) && clear(j) && j.answer.auc_any.has_value(); },
       [](const Judged& j) { return *j.answer.auc_any >= 0.9; }},
      {share_question("which, where it can be told apart", "named first", ">= 90 %", 0.9, false), apart,
       [](const Judged& j) { return !j.answer.named.empty() && j.answer.named[0] == j.truth.mechanisms[0]; }},
      {share_question("which, where it cannot", "truth in the reported set", ">= 95 %", 0.95, false), alike,
       [](const Judged& j) { return has_all(j.answer.reported, j.truth.mechanisms); }},
      {share_question("which, where it cannot", "set of at most 3", "all", 1, false), alike,
       [](const Judged& j) { return j.answer.set_size <= 3; }},
      {share_question("two at once", "both named", ">= 85 %", 0.85, false),
       [](const Judged& j) {
         return j.truth.kind == Kind::pair && j.truth.apart == Apart::yes && matter(j) && all_clear(j);
       },
       [](const Judged& j) { return has_all(j.answer.named, j.truth.mechanisms); }},
      {share_question("falsely certain", "named alone, without alternatives, and wrong", "<= 1 %", 0.01, true),
       [](const Judged& j) { return j.answer.ran; }, falsely_certain},
      {share_question("outside the library", "wrongly named as a known one", "<= 5 %", 0.05, true),
       [](const Judged& j) { return j.truth.kind == Kind::outside && j.truth.apart == Apart::yes; }, wrongly_named},
      {share_question("outside the library", "reported as a mismatch that nothing known repairs", "", 0, false, false),
       [](const Judged& j) { return j.truth.kind == Kind::outside && j.truth.apart == Apart::yes && clear(j); },
       [](const Judged& j) { return j.answer.verdict == "unknown"; }},
      {share_question("cannot be seen", "named nevertheless", "", 0.02, true, false),
       [](const Judged& j) { return j.truth.kind == Kind::invisible; }, wrongly_named},
      {share_question("present, too small to matter", "named nevertheless", "", 0, true, false),
       [](const Judged& j) { return single(j) && too_small(j); }, wrongly_named},
      {share_question("present, any size", "something named that is not there", "", 0, true, false),
       [](const Judged& j) { return (single(j) && j.truth.apart == Apart::yes) || j.truth.kind == Kind::pair; },
       [](const Judged& j) {
         return std::any_of(j.answer.named.begin(), j.answer.named.end(),
                            [&](const std::string& id) { return !has(j.truth.mechanisms, id); });
       }},
  };
}

// Relative errors and coverage of the numbers of rightly named mechanisms.
void ask_numbers(const std::vector<Judged>& cases, Question& error, Question& coverage) {
  for (const Judged& j : cases) {
    if (!has_all(j.truth.mechanisms, j.answer.named)) continue;
    for (const TrueValue& t : j.truth.values)
      for (const Fitted& f : j.answer.fitted) {
        if (f.mechanism != t.mechanism || f.parameter != t.parameter) continue;
        if (t.exact) {
          Tally& covered = coverage.domains[j.spec.domain];
          ++covered.asked;
          covered.right += f.lower <= t.value && t.value <= f.upper;
        }
        if (t.value == 0 || !clear(j)) continue;
        error.values.push_back(std::abs(f.value / t.value - 1));
        Tally& good = error.domains[j.spec.domain];
        ++good.asked;
        good.right += error.values.back() <= 0.1;
      }
  }
}

void ask_repair(const std::vector<Judged>& cases, Question& median, Question& negative) {
  for (const Judged& j : cases) {
    if (j.answer.named.empty() || j.truth.mechanisms.empty() || !j.truth.floor_known || !clear(j)) continue;
    if (!has_all(j.answer.named, j.truth.mechanisms)) continue;
    if (!(j.answer.before > 1.02 * j.truth.floor)) continue;  // nothing that could be repaired
    const double repaired = (j.answer.before - j.answer.after) / (j.answer.before - j.truth.floor);
    median.values.push_back(repaired);
    for (Question* q : {&median, &negative}) {
      Tally& t = q->domains[j.spec.domain];
      ++t.asked;
      t.right += q == &median ? repaired >= 0.9 : repaired < 0;
    }
  }
}

Question median_question(const char* question, const char* measure, const char* to_reach, double bound, bool at_most) {
  Question q = share_question(question, measure, to_reach, bound, at_most);
  q.is_median = true;
  return q;
}

std::string answer_text(const Judged& j) {
  if (!j.answer.ran) return "no answer: " + j.answer.error.substr(0, 200);
  return j.answer.verdict + (j.answer.named.empty() ? "" : ": " + joined(j.answer.named)) + " [first condition " +
         j.answer.condition + "]";
}

void add_failure(const Judged& j, const std::string& what, Judgement& into) {
  into.failures.push_back({j.id, j.spec.domain, std::string(kind_name(j.truth.kind)),
                           joined(j.truth.mechanisms) + (j.truth.world.empty() ? "" : " (" + j.truth.world + ")"), what,
                           answer_text(j)});
}

std::string first_answer(const Judged& j) {
  if (!j.answer.ran) return "(failed)";
  if (!j.answer.named.empty()) return joined(j.answer.named);
  return "(" + j.answer.verdict + ")";
}

// Where the effect can be told apart, or cannot, by the maker's own count: what is unclear is no one's to be sure of.
std::vector<Stated> stated_probabilities(const std::vector<Judged>& cases) {
  std::vector<Stated> stated;
  for (const Judged& j : cases)
    if (j.answer.ran && j.answer.probability && j.truth.apart != Apart::unclear)
      stated.push_back({*j.answer.probability, is_right(j)});
  return stated;
}

}  // namespace

Question share_question(const char* question, const char* measure, const char* to_reach, double bound, bool at_most,
                        bool required) {
  return {question, measure, to_reach, bound, at_most, required, {}, {}, false};
}
Asking sealed_asking() {
  return {sealed_questions(), 0.9};
}

bool is_right(const Judged& j) {
  const bool nothing = says_nothing(j) || j.truth.kind == Kind::invisible || j.truth.share < matters;
  if (j.answer.verdict == "null") return nothing || !clear(j);  // "as far as these recordings can show"
  if (j.answer.verdict == "unknown") return !nothing && j.truth.kind == Kind::outside;
  if (j.truth.mechanisms.empty()) return false;
  // What is there and does not matter may be named, and need not.
  if (nothing) return has_all(j.truth.mechanisms, j.answer.named);
  return has_all(j.answer.reported, j.truth.mechanisms);
}

bool falsely_certain(const Judged& j) {
  if (j.answer.verdict != "named") return false;
  // What a mechanism of the library imitates for the most part, by the maker's own count, is rightly called by its
  // name.
  if (j.truth.kind == Kind::outside && j.truth.apart == Apart::unclear) return false;
  // Forms that say the same are named with the one that stands for them.
  const bool stood_for = j.truth.mechanisms.size() == 1 && has_all(j.answer.reported, j.truth.mechanisms);
  if (!stood_for && !has_all(j.truth.mechanisms, j.answer.named)) return true;
  return j.truth.kind == Kind::pair && matter(j) && all_clear(j) && !has_all(j.answer.named, j.truth.mechanisms);
}

bool clearly_there(const Judged& j) {
  return matter(j) && times_the_limit(j) >= clearly;
}

std::map<std::string, double> times_each_limit(const Judged& judged) {
  std::map<std::string, double> times;
  for (const TrueValue& t : judged.truth.values) {
    const auto same = [&](const TrueValue& v) { return v.is_size && v.mechanism == t.mechanism; };
    const bool several = std::count_if(judged.truth.values.begin(), judged.truth.values.end(), same) > 1;
    const auto limit_in = [&](const auto& limits) {
      const auto of = limits.find(t.mechanism);
      if (of == limits.end()) return 0.0;
      const auto found = of->second.find(t.parameter);
      return found == of->second.end() ? 0.0 : found->second;
    };
    double limit = several ? limit_in(judged.answer.limit_with_others) : 0;
    if (!(limit > 0)) limit = limit_in(judged.answer.limit);
    if (!t.is_size || !(limit > 0)) continue;
    double& most = times[t.mechanism];
    most = std::max(most, std::abs(t.value) / limit);
  }
  return times;
}

double times_the_limit(const Judged& judged) {
  double times = 0;
  const std::map<std::string, double> each = times_each_limit(judged);
  for (const auto& [mechanism, its] : each) times = std::max(times, its);
  return each.empty() ? judged.truth.strength / judged.truth.limit : times;
}

Tally Question::all() const {
  Tally sum;
  for (const auto& [domain, tally] : domains) sum.right += tally.right, sum.asked += tally.asked;
  return sum;
}
double Question::figure() const {
  if (is_median) return stats::median(values);
  return all().asked > 0 ? all().share() : NAN;
}
bool Question::met() const {
  const double f = figure();
  return std::isnan(f) || (at_most ? f <= bound : f >= bound);
}
bool Question::surely_missed() const {
  if (met() || is_median) return !met();
  return at_most ? all().interval().lower > bound : all().interval().upper < bound;
}
std::string Question::measured() const {
  const Tally t = all();
  if (t.asked == 0 && !is_median) return "not asked";
  if (is_median) return values.empty() ? "not asked" : format("%.3g (%zu values)", figure(), values.size());
  return format("%d of %d (%.1f %%, %.1f to %.1f)", t.right, t.asked, 100 * t.share(), 100 * t.interval().lower,
                100 * t.interval().upper);
}

Judgement judge(const std::vector<Judged>& as_read, const Asking& asking) {
  std::vector<Judged> cases;
  std::copy_if(as_read.begin(), as_read.end(), std::back_inserter(cases),
               [](const Judged& j) { return j.answer.begun || j.answer.ran; });
  for (Judged& j : cases)
    for (std::vector<std::string>* ids : {&j.truth.mechanisms, &j.answer.named, &j.answer.reported})
      *ids = physics_of(*ids);
  Judgement result;
  result.cases = cases.size();
  result.not_begun = as_read.size() - cases.size();
  for (const Asked& a : asking.questions) {
    result.questions.push_back(a.question);
    Question& q = result.questions.back();
    for (const Judged& j : cases) {
      if (!j.answer.ran || !a.applies(j)) continue;
      const bool right = a.right(j);
      Tally& t = q.domains[j.spec.domain];
      ++t.asked;
      t.right += right;
      if (q.required && right == q.at_most) add_failure(j, q.question + ": " + q.measure, result);
    }
  }
  for (const Judged& j : cases) {
    ++result.confusion[j.truth.mechanisms.empty() ? "(" + std::string(kind_name(j.truth.kind)) + ")"
                                                  : joined(j.truth.mechanisms)][first_answer(j)];
    result.seconds[j.spec.domain].push_back(j.answer.processor_seconds);
    if (j.answer.ran) continue;
    ++result.unanswered;
    add_failure(j, "no answer", result);
  }
  result.effects = effect_rows(cases);
  result.stated = stated_probabilities(cases);
  Question error = median_question("how much", "parameter error (median)", "<= 10 %", 0.1, true);
  Question coverage = share_question("how much", "95 % interval covers", "90-98 %", 0.9, false);
  ask_numbers(cases, error, coverage);
  Question repaired = median_question("repaired", "(before - after) / (before - floor), held out (median)",
                                      asking.repaired < 0.9 ? ">= 0.85" : ">= 0.9", asking.repaired, false);
  Question negative = share_question("repaired", "negative", "never", 0, true);
  ask_repair(cases, repaired, negative);
  for (Question* q : {&error, &coverage, &repaired, &negative}) result.questions.push_back(*q);
  return result;
}

}  // namespace gonio::sealed

// Answers against truths: the table of the proof, per domain and over all, with exact intervals (Clopper & Pearson
// 1934), the confusion matrix, and the list of failures.
#pragma once
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "manifest/value.h"
#include "sealed/answer.h"
#include "sealed/reliability.h"
#include "stats/intervals.h"

namespace gonio::sealed {

struct Judged {
  Spec spec;
  Truth truth;
  std::string id;
  Answer answer;
};

struct Tally {  // of one question in one domain, or over all
  int right = 0, asked = 0;
  double share() const { return asked > 0 ? static_cast<double>(right) / asked : 0; }
  stats::Interval interval() const { return stats::share_interval(right, asked); }
};
struct Question {
  std::string question, measure, to_reach;
  double bound = 0;
  bool at_most = false;
  bool required = true;  // false: reported beside the questions of the proof
  std::map<std::string, Tally> domains;
  Numbers values;  // of medians
  bool is_median = false;
  Tally all() const;
  double figure() const;  // share, or median; NaN where nothing was asked
  bool met() const;
  bool surely_missed() const;    // the interval excludes what is to be reached
  std::string measured() const;  // "37 of 38 (97.4 %, 86.2 to 99.9)"
};
// A question of which cases, and when it is answered as it should be (or, with at_most, as it should not).
struct Asked {
  Question question;
  std::function<bool(const Judged&)> applies, right;
};
Question share_question(const char* question, const char* measure, const char* to_reach, double bound, bool at_most,
                        bool required = true);
struct Asking {
  std::vector<Asked> questions;
  double repaired = 0.9;  // median, at least
};
Asking sealed_asking();  // the table of the sealed cases

struct Failure {
  std::string id, domain, kind, world, what, answer;
};
// One mechanism in one domain: single effects that are clearly there.
struct EffectRow {
  std::string domain, mechanism;
  int cases = 0, found = 0, located = 0, first = 0;  // located: the right condition stands first
  Numbers area, error, before, after, floor;         // error: relative, of each number
};
struct Judgement {
  std::vector<Question> questions;
  std::map<std::string, std::map<std::string, int>> confusion;  // truth -> first answer -> cases
  std::vector<Failure> failures;
  std::vector<EffectRow> effects;
  std::size_t cases = 0, unanswered = 0, not_begun = 0;
  std::map<std::string, Numbers> seconds;  // domain -> of the processor for each case
  std::vector<Stated> stated;              // of cases where something was named with a probability
};

// How far the effect is above what explain says it can see: |true - neutral| over the printed limit; the maker's own
// count where the declaration's numbers are not the maker's.
double times_the_limit(const Judged& judged);
std::map<std::string, double> times_each_limit(const Judged& judged);  // of mechanisms whose limits are known
// Present, above what can be seen, and large enough to be worth a name.
bool clearly_there(const Judged& judged);
// Is the answer what was left out, or among the sets that it lists? Nothing: where nothing was that matters and is
// clearly there. Unknown:
// where no mechanism is it.
bool is_right(const Judged& judged);
// What is named alone is not what was left out, or not all of it that is clearly there.
bool falsely_certain(const Judged& judged);
std::vector<EffectRow> effect_rows(const std::vector<Judged>& cases);
Judgement judge(const std::vector<Judged>& cases, const Asking& asking = sealed_asking());
std::string table_text(const Judgement& judgement);
// `what`: the kind of cases, for the title and headline; `lead`: where they come from.
std::string page_html(const Judgement& judgement, const std::vector<Judged>& cases, const std::string& footer,
                      const std::string& what = "sealed cases", const std::string& lead = "");
manifest::Value truth_json(const std::vector<Judged>& cases);

}  // namespace gonio::sealed

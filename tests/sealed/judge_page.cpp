// The judgement as text for a terminal and as a page for a sceptic.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/text.h"
#include "report/number_text.h"
#include "report/page.h"
#include "sealed/judge.h"

namespace gonio::sealed {
namespace {

std::string verdict(const Question& q) {
  if (!q.required) return "";
  if (q.all().asked == 0 && q.values.empty()) return "not asked";
  return q.met() ? "met" : q.surely_missed() ? "MISSED" : "short, within the interval";
}

std::vector<std::string> domains_of(const Judgement& j) {
  std::vector<std::string> names;
  for (const auto& [domain, seconds] : j.seconds) names.push_back(domain);
  return names;
}

std::string cell(const Question& q, const std::string& domain) {
  const auto found = q.domains.find(domain);
  if (found == q.domains.end() || found->second.asked == 0) return "";
  return format("%d/%d", found->second.right, found->second.asked);
}

report::TableText question_table(const Judgement& j) {
  report::TableText table;
  table.caption = "What is to be reached, and what was measured. Shares with exact 95 % intervals (Clopper & Pearson).";
  table.columns = {{"question", "", false},
                   {"measure", "", false},
                   {"to reach", "", false},
                   {"measured", "", false},
                   {"", "", false}};
  for (const Question& q : j.questions)
    table.rows.push_back({q.question, q.measure, q.required ? q.to_reach : "(reported)", q.measured(), verdict(q)});
  return table;
}

report::TableText domain_table(const Judgement& j) {
  report::TableText table;
  table.caption =
      "The same for each domain: cases for which the measure holds, of those asked. Medians: values within the bound.";
  table.columns = {{"question", "", false}, {"measure", "", false}};
  for (const std::string& d : domains_of(j)) table.columns.push_back({d, "", true});
  for (const Question& q : j.questions) {
    std::vector<std::string> row{q.question, q.measure};
    for (const std::string& d : domains_of(j)) row.push_back(cell(q, d));
    table.rows.push_back(row);
  }
  return table;
}

std::string middle(const Numbers& values, const char* how) {
  return values.empty() ? "" : format(how, stats::median(values));
}
std::vector<std::string> effect_cells(const EffectRow& e) {
  const auto of = [&](int count) { return format("%d/%d", count, e.cases); };
  return {e.domain,
          e.mechanism,
          of(e.found),
          of(e.located),
          middle(e.area, "%.2f"),
          of(e.first),
          e.error.empty() ? "" : format("%.1f %%", 100 * stats::median(e.error)),
          middle(e.before, "%.3g"),
          middle(e.after, "%.3g"),
          middle(e.floor, "%.3g")};
}
constexpr const char* effect_heads[] = {"domain",      "left out",        "found",  "located", "AUC",
                                        "named first", "parameter error", "before", "after",   "true model"};

report::TableText effect_table(const Judgement& j) {
  report::TableText table;
  table.caption =
      "Each mechanism alone where it is clearly there: cases, medians, and the error on held-out groups before, after, "
      "and of the true model, in the domain's unit.";
  for (const char* head : effect_heads) table.columns.push_back({head, "", table.columns.size() > 1});
  for (const EffectRow& e : j.effects) table.rows.push_back(effect_cells(e));
  return table;
}

std::string effect_text(const Judgement& j) {
  static constexpr const char* widths = "  %-12s %-26s %6s %8s %5s %12s %16s %9s %9s %10s\n";
  const auto& h = effect_heads;
  std::string text = "\neach alone, where it is clearly there:\n";
  text += format(widths, h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], h[8], h[9]);
  for (const EffectRow& e : j.effects) {
    const std::vector<std::string> c = effect_cells(e);
    text += format(widths, c[0].c_str(), c[1].c_str(), c[2].c_str(), c[3].c_str(), c[4].c_str(), c[5].c_str(),
                   c[6].c_str(), c[7].c_str(), c[8].c_str(), c[9].c_str());
  }
  return text;
}

report::TableText confusion_table(const Judgement& j) {
  report::TableText table;
  table.caption = "What was left out, and what was named. In brackets: verdicts without a name.";
  table.columns = {{"left out", "", false}, {"named", "", false}, {"cases", "", true}};
  for (const auto& [truth, answers] : j.confusion)
    for (const auto& [answer, count] : answers) table.rows.push_back({truth, answer, std::to_string(count)});
  return table;
}

report::TableText failure_table(const Judgement& j) {
  report::TableText table;
  table.columns = {{"case", "", false},     {"domain", "", false}, {"kind", "", false},
                   {"left out", "", false}, {"failed", "", false}, {"answer", "", false}};
  for (const Failure& f : j.failures) table.rows.push_back({f.id, f.domain, f.kind, f.world, f.what, f.answer});
  return table;
}

report::TableText case_table(const std::vector<Judged>& cases) {
  report::TableText table;
  table.columns = {{"case", "", false},   {"domain", "", false}, {"kind", "", false},   {"left out", "", false},
                   {"x limit", "", true}, {"share", "", true},   {"answer", "", false}, {"before", "", true},
                   {"after", "", true},   {"floor", "", true},   {"AUC", "", true},     {"processor", "s", true}};
  for (const Judged& j : cases) {
    if (!j.answer.begun && !j.answer.ran) continue;
    table.rows.push_back({j.id, j.spec.domain, std::string(kind_name(j.truth.kind)), j.truth.world,
                          format("%.1f", times_the_limit(j)), format("%.2g", j.truth.share), j.answer.sentence,
                          format("%.4g", j.answer.before), format("%.4g", j.answer.after),
                          format("%.4g", j.truth.floor), j.answer.auc ? format("%.2f", *j.answer.auc) : "",
                          format("%.1f", j.answer.processor_seconds)});
  }
  return table;
}

std::string headline(const Judgement& j, const std::string& what) {
  int met = 0, asked = 0;
  for (const Question& q : j.questions) {
    if (!q.required || (q.all().asked == 0 && q.values.empty())) continue;
    ++asked;
    met += q.met();
  }
  std::string text = format("%d of %d figures of the proof are reached on %zu %s", met, asked, j.cases, what.c_str());
  if (j.not_begun > 0) text += format("; %zu more were not begun for want of time", j.not_begun);
  return text;
}

}  // namespace

std::string table_text(const Judgement& j) {
  std::string text = format("%-37s %-52s %-17s %s\n", "question", "measure", "to reach", "measured");
  for (const Question& q : j.questions)
    text += format("%-37s %-52s %-17s %s  %s\n", q.question.c_str(), q.measure.c_str(),
                   q.required ? q.to_reach.c_str() : "(reported)", q.measured().c_str(), verdict(q).c_str());
  text += "\nby domain:\n";
  for (const std::string& d : domains_of(j)) {
    const Numbers& s = j.seconds.at(d);
    text += format("  %s: %zu cases, processor: median %.1f s, longest %.1f s, in all %.0f s\n", d.c_str(), s.size(),
                   stats::median(s), *std::max_element(s.begin(), s.end()), std::accumulate(s.begin(), s.end(), 0.0));
    for (const Question& q : j.questions)
      if (!cell(q, d).empty())
        text += format("    %-37s %-52s %s\n", q.question.c_str(), q.measure.c_str(), cell(q, d).c_str());
  }
  text += effect_text(j);
  if (!j.stated.empty()) text += reliability_text(reliability_of(j.stated));
  text += "\nleft out -> named:\n";
  for (const auto& [truth, answers] : j.confusion)
    for (const auto& [answer, count] : answers)
      text += format("  %4d  %-60s %s\n", count, truth.c_str(), answer.c_str());
  text += format("\n%zu cases, %zu without an answer, %zu not begun; failures:\n", j.cases, j.unanswered, j.not_begun);
  for (const Failure& f : j.failures)
    text +=
        "  " + f.id + " " + f.domain + " " + f.kind + " " + f.world + "\n      " + f.what + " -> " + f.answer + "\n";
  return text;
}

std::string page_html(const Judgement& j, const std::vector<Judged>& cases, const std::string& footer,
                      const std::string& what, const std::string& lead) {
  const bool good =
      std::all_of(j.questions.begin(), j.questions.end(), [](const Question& q) { return !q.required || q.met(); });
  report::Page page(what, headline(j, what),
                    lead.empty() ? "Recordings made by code that shares nothing with the code that explains them; the "
                                   "truth of a case is computed again only after its answer has been written."
                                 : lead,
                    good ? report::Tone::good : report::Tone::neutral);
  page.section("The table");
  page.table(question_table(j));
  page.note(
      "An effect counts as present where its size is at least three times the detection limit that explain "
      "printed for it, and its share of the signal at least what --smallest-effect asks. Whether effects can be told "
      "apart is the maker's count: the best other mechanism, at its best size, must leave at least five standard "
      "deviations of the effect (yes) or at most three (no). A condition counts as right if the maker or the "
      "library's own declaration of the true mechanism lists it. An observation counts as affected where the effect, "
      "after the fair refit, is at least one noise width and at least its own root mean square.");
  page.table(domain_table(j));
  page.table(effect_table(j));
  if (!j.stated.empty()) {
    page.section("How sure");
    const Reliability reliability = reliability_of(j.stated);
    page.plot(reliability_plot(reliability));
    page.table(reliability_table(reliability));
  }
  page.section("Confusions");
  page.table(confusion_table(j));
  page.section("Failures");
  page.table(failure_table(j));
  page.section("All cases");
  page.open_details(format("%zu cases", cases.size()));
  page.table(case_table(cases));
  page.close_details();
  page.footer(footer);
  return page.html();
}

manifest::Value truth_json(const std::vector<Judged>& cases) {
  using manifest::Value;
  Value list = Value::object();
  static constexpr const char* apart[] = {"yes", "no", "unclear"};
  for (const Judged& j : cases) {
    Value parameters = Value::object();
    for (const TrueValue& v : j.truth.values) parameters[v.mechanism + "." + v.parameter] = v.value;
    list[j.id] = Value::object({{"domain", j.spec.domain},
                                {"kind", std::string(kind_name(j.truth.kind))},
                                {"mechanisms", j.truth.mechanisms},
                                {"parameters", parameters},
                                {"stages", j.truth.stages},
                                {"conditions", j.truth.conditions},
                                {"told_apart", apart[static_cast<int>(j.truth.apart)]},
                                {"strength_sigma", j.truth.strength},
                                {"share", j.truth.share},
                                {"floor", j.truth.floor},
                                {"made", j.truth.world}});
  }
  return list;
}

}  // namespace gonio::sealed

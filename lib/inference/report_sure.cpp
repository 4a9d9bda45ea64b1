// See report_parts.h: how sure, and what to measure next.
#include <algorithm>
#include <cmath>

#include "inference/report_parts.h"
#include "inference/wording.h"
#include "report/floor_plan.h"

namespace gonio::inference {
namespace {

using report::Tone;

std::string verdict_in_words(const Problem& problem, const Explanation& e) {
  if (!e.misplaced.files.empty())
    return "Verdict: unknown. Files do not show what the manifest takes them for, and no physics was asked of them.";
  const std::string sure = probability_in_words(e.probability);
  switch (e.verdict) {
    case Verdict::null:
      return e.significant
                 ? "Verdict: nothing that matters. A mismatch beyond noise is there, but too small for a name."
                 : "Verdict: nothing is left out, as far as these recordings can show.";
    case Verdict::named:
      return "Verdict: named. " + sure + " sure that it is this" +
             (e.not_told_apart.empty() ? "" : ", or what says the same,") + " and nothing else.";
    case Verdict::ambiguous:
      return "Verdict: ambiguous. " + sure + " sure that it is one of those listed below" +
             (e.probability < e.sure ? ", less than was asked for." : ".");
    case Verdict::unknown:
      return "Verdict: unknown. Something matters here, and nothing in the library repairs it on unseen " +
             problem.group_noun() + "s; " + sure + " sure that the library does not have it.";
  }
  return "";
}

void scores(report::Page& page, const Problem& problem, const Explanation& e) {
  const auto bar = [&](const std::string& label, double score, Tone tone) {
    return report::ScoreBar{label, score_in_words(score, problem.unit()), score, tone};
  };
  std::vector<report::ScoreBar> bars = {bar("base model", e.held_out_before, Tone::bad)};
  if (!e.named.empty()) bars.push_back(bar("with the named physics", e.held_out_after, Tone::good));
  const auto best_of = [&](Hypothesis::Kind kind) {
    return std::find_if(e.scoreboard.begin(), e.scoreboard.end(), [&](const Hypothesis& h) { return h.kind == kind; });
  };
  if (const auto h = best_of(Hypothesis::Kind::free_curve); h != e.scoreboard.end() && e.significant)
    bars.push_back(bar(h->name, h->held_out, Tone::neutral));
  if (const auto h = best_of(Hypothesis::Kind::negative_control); h != e.scoreboard.end() && e.significant)
    bars.push_back(bar("best of " + std::to_string(e.negative_controls) + " negative controls without physics",
                       h->held_out, Tone::neutral));
  page.score_bars(bars);
  page.note(problem.score_name() + " on " + problem.group_noun() + "s that the fit did not see (" +
            (e.test_groups.empty() ? "each left out in turn"
                                   : std::to_string(e.test_groups.size()) + " opened once at the end") +
            "). The chance of such residuals without a mismatch is " +
            (e.global_p < 1e-6 ? "below one in a million" : printed(e.global_p, 2)) + "; " +
            (e.false_alarm > 0
                 ? share_in_words(e.false_alarm) + " of the negative controls would have passed for physics."
                 : std::string("no negative control would have passed for physics.")));
}

void parameters(report::Page& page, const Problem& problem, const Explanation& e) {
  if (e.estimates.empty()) return;
  constexpr std::size_t most = 12;
  report::TableText table{"", {{"parameter", "", false}, {"value", "", false}, {"95 % interval", "", false}}, {}};
  for (std::size_t k = 0; k < std::min(most, e.estimates.size()); ++k) {
    const Estimate& x = e.estimates[k];
    const Parameter& p = problem.parameters()[x.parameter];
    const Shown shown = shown_in(p.unit, std::max(std::abs(x.value), x.sigma));
    table.rows.push_back({p.name, estimate_in_words(x.value, x.sigma, p.unit),
                          printed(x.lower_95 * shown.factor) + " to " + printed(x.upper_95 * shown.factor) +
                              (shown.unit.empty() ? "" : " " + shown.unit)});
  }
  if (e.estimates.size() > most)
    table.caption = "The first " + std::to_string(most) + " of " + std::to_string(e.estimates.size()) + " numbers.";
  page.table(table);
}

// The answers that were held against each other, and, folded, what speaks for and against each.
void weighed_answers(report::Page& page, const Problem& problem, const Explanation& e) {
  using Kind = Explanation::Weighed::Kind;
  constexpr std::size_t most = 8;
  constexpr double least = 0.001;
  if (!e.significant || e.weighed.empty()) return;
  report::TableText answers{"", {{"what it may be", "", false}, {"how sure", ""}}, {}},
      statistics{"Probabilities come from these statistics; how often they hold is measured by scripts/prove.",
                 {{"what it may be", "", false}, {"for and against", "", false}},
                 {}};
  std::vector<std::pair<std::string, double>> seen;
  for (const Explanation::Weighed& w : e.weighed) {
    if (statistics.rows.size() == most || (w.probability < least && !seen.empty())) break;
    std::string answer, why;
    for (const std::size_t c : w.candidates)
      answer += (answer.empty() ? "" : " with ") + mechanism_in_words(problem, c);
    if (w.kind == Kind::nothing) answer = "nothing that matters";
    if (w.kind == Kind::outside) answer = "none of these";
    for (const auto& [name, value] : w.statistics) why += (why.empty() ? "" : ", ") + name + " " + printed(value, 2);
    const auto told = std::ranges::find(seen, answer, &std::pair<std::string, double>::first);
    if (told == seen.end())
      seen.emplace_back(answer, w.probability);
    else
      told->second += w.probability;  // another form of it
    statistics.rows.push_back({answer, why});
  }
  for (const auto& [answer, probability] : seen) answers.rows.push_back({answer, probability_in_words(probability)});
  page.table(answers);
  page.open_details("What speaks for and against each");
  page.table(statistics);
  page.close_details();
}

// What the registry says of the named physics: the manual's entry, which needs no network.
void manual_entries(report::Page& page, const Problem& problem, const Explanation& e) {
  for (const std::size_t c : e.named) {
    const mechanism::Mechanism& m = *problem.candidates()[c].mechanism;
    page.open_details("The manual on " + m.id);
    page.paragraph(m.sentence + " Met in practice: " + m.typical + ".");
    page.paragraph(m.equation);
    std::vector<std::string> items;
    for (const mechanism::Confusion& x : m.mistaken_for)
      items.push_back("Mistaken for " + x.with + "; to tell them apart: " + x.told_apart + ".");
    page.list(items);
    page.note(m.source + ". All entries: man 7 gonio-mechanisms.");
    page.close_details();
  }
}

}  // namespace

void tell_sure(report::Page& page, const ReportPart& part) {
  const Problem& problem = *part.problem;
  const Explanation& e = *part.explanation;
  page.section("How sure");
  page.paragraph(verdict_in_words(problem, e));
  scores(page, problem, e);
  parameters(page, problem, e);
  const auto words = [&](const std::vector<std::size_t>& set, const char* between) {
    std::string ids;
    for (const std::size_t c : set) ids += (ids.empty() ? "" : between) + mechanism_in_words(problem, c);
    return ids;
  };
  std::vector<std::string> sets;
  for (const std::vector<std::size_t>& set : e.not_told_apart)
    sets.push_back("Not told apart: " + words(set, ", ") + ".");
  for (const std::vector<std::size_t>& set : e.instead) {
    const std::string told = "In the place of all that is named: " + words(set, " with ") + ".";
    if (std::ranges::find(sets, told) == sets.end()) sets.push_back(told);
  }
  if (!sets.empty()) page.list(sets);
  weighed_answers(page, problem, e);
  manual_entries(page, problem, e);
  if (!e.converged) page.note("The final fit did not converge: take the numbers with care.");
}

void tell_next(report::Page& page, const ReportPart& part) {
  const Problem& problem = *part.problem;
  const Explanation& e = *part.explanation;
  if (e.next_measurement.empty() && e.plan.empty()) return;
  page.section("What to measure next");
  if (!e.next_measurement.empty()) page.paragraph(e.next_measurement);
  if (e.plan.empty()) return;
  report::TableText table{
      "Measurements that were predicted under the hypotheses, each refitted: by how many standard errors they would "
      "part them.",
      {{"measurement", "", false}, {"separates", "", false}, {"standard errors", ""}},
      {}};
  for (const PlannedMeasurement& p : e.plan) {
    std::string ids = problem.candidates()[p.separates[0]].id();
    ids += p.separates.size() > 1 ? " from " + problem.candidates()[p.separates[1]].id() : " from nothing";
    table.rows.push_back({p.sentence, ids, plain_number(p.z)});
  }
  page.table(table);
  const auto drawn = std::ranges::find_if(e.plan, [](const PlannedMeasurement& p) { return p.floor_plan.has_value(); });
  if (drawn == e.plan.end()) return;
  page.figures({{.svg = report::svg(*drawn->floor_plan),
                 .title = "Where: " + drawn->sentence,
                 .caption = "Seen from above, as one stands behind the camera. The ring is where it stands today."}},
               560);
}

}  // namespace gonio::inference

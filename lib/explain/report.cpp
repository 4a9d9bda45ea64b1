// See report.h.
#include "explain/report.h"

#include <algorithm>
#include <cmath>

#include "explain/sentence.h"
#include "report/page.h"

namespace gonio::explain {
namespace {

using report::Page;

std::string spelled(const std::string& unit) {
  return unit == "1" ? "" : unit;
}
std::string percent(double share) {  // two digits, and no exponents
  if (std::abs(share) < 1e-4) return share == 0 ? "0 %" : "< 0.01 %";
  return printed(100 * share, std::abs(share) >= 0.995 ? 3 : 2) + " %";
}

report::Tone tone_of(Verdict verdict) {
  if (verdict == Verdict::unknown) return report::Tone::bad;
  return verdict == Verdict::named ? report::Tone::good : report::Tone::neutral;
}

std::string name_of(const Problem& problem, std::size_t candidate) {
  const Candidate& c = problem.candidates()[candidate];
  std::string name = c.id();
  for (std::size_t k = 0; k < c.on.size(); ++k) name += (k == 0 ? " on " : ", ") + c.on[k];
  return name;
}

void key_numbers(Page& page, const Problem& problem, const Explanation& e) {
  const std::string unit = spelled(problem.unit());
  const std::string how = e.test_groups.empty()
                              ? "each " + problem.group_noun() + " left out in turn"
                              : std::to_string(e.test_groups.size()) + " " + problem.group_noun() + "s opened once";
  std::vector<report::KeyNumber> numbers = {
      {problem.score_name() + ", base model", printed(e.held_out_before), unit, how, report::Tone::neutral}};
  if (!e.named.empty())
    numbers.push_back({"with the named physics", printed(e.held_out_after), unit, how, report::Tone::good});
  numbers.push_back({"chance of such residuals without a mismatch", printed(e.global_p, 2), "",
                     e.significant ? "a mismatch is there" : "no mismatch beyond noise", report::Tone::neutral});
  numbers.push_back({"dummies that passed for physics", percent(e.false_alarm), "", "of " + std::to_string(e.dummies),
                     report::Tone::neutral});
  page.key_numbers(numbers);
}

void parameters(Page& page, const Problem& problem, const Explanation& e) {
  if (e.estimates.empty()) return;
  report::TableText table{"What was fitted",
                          {{"parameter", "", false}, {"value", ""}, {"95 % interval", "", false}, {"unit", "", false}},
                          {}};
  for (const Estimate& x : e.estimates)
    table.rows.push_back({problem.parameters()[x.parameter].name, printed(x.value, 4),
                          printed(x.lower_95) + " to " + printed(x.upper_95), problem.parameters()[x.parameter].unit});
  page.table(table);
}

void where(Page& page, const Problem& problem, const Explanation& e, const Illustration& illustration) {
  page.section("Where");
  std::vector<report::Figure> figures;
  for (const Picture& p : illustration.pictures) figures.push_back({p.png, p.svg, p.title, "", 0});
  if (!figures.empty()) page.figures(figures);
  report::HeatStrip strip;
  strip.title = "Which " + problem.group_noun() + "s hold the excess over noise";
  strip.label = "share of the excess";
  strip.rows = {""};
  for (const std::string& name : problem.observations().group) {
    const auto g =
        std::find_if(e.groups.begin(), e.groups.end(), [&](const LocatedGroup& x) { return x.name == name; });
    strip.columns.push_back(name);
    strip.values.push_back(g == e.groups.end() ? 0 : g->share);
  }
  page.heat_strip(strip);
}

report::Plot curve_plot(const LocatedCondition& c, bool named) {
  report::Plot plot;
  plot.title = "Residual over " + c.name;
  plot.caption = "A free curve over it explains " + percent(c.share) + " of the excess; most of it between " +
                 printed(c.lower, 2) + " and " + printed(c.upper, 2) + " " + spelled(c.unit) + ".";
  plot.x_label = c.name + (spelled(c.unit).empty() ? "" : " / " + c.unit);
  plot.y_label = "mean residual" + (spelled(c.curve.value_unit).empty() ? "" : " / " + c.curve.value_unit);
  plot.zero_y = true;
  report::Series before{
      report::Series::Kind::points, "base model", c.curve.centre, c.curve.before, c.curve.sigma, {}, 0};
  report::Series line{report::Series::Kind::line, "", c.curve.centre, c.curve.before, {}, {}, 0};
  plot.series = {line, before};
  if (!named) return plot;
  plot.series.push_back({report::Series::Kind::line, "", c.curve.centre, c.curve.after, {}, {}, 1});
  plot.series.push_back(
      {report::Series::Kind::points, "with the named physics", c.curve.centre, c.curve.after, c.curve.sigma, {}, 1});
  return plot;
}

void which_curve(Page& page, const Explanation& e) {
  if (e.conditions.empty()) return;
  page.section("Which curve");
  page.paragraph("Residuals in bins of equal counts, with their standard errors, over the conditions that tell most.");
  std::vector<report::Plot> plots;
  for (std::size_t k = 0; k < std::min<std::size_t>(2, e.conditions.size()); ++k)
    plots.push_back(curve_plot(e.conditions[k], !e.named.empty()));
  page.plots(plots);
}

void scoreboard(Page& page, const Problem& problem, const Explanation& e) {
  const std::string unit = spelled(problem.unit());
  report::TableText table{"Hypotheses on held-out " + problem.group_noun() + "s, best first",
                          {{"hypothesis", "", false},
                           {"held-out score", unit},
                           {"gain", "noise variances"},
                           {"effect", ""},
                           {"named?", "", false}},
                          {}};
  for (const Hypothesis& h : e.scoreboard) {
    const bool mechanisms = h.kind == Hypothesis::Kind::mechanisms;
    const bool named =
        mechanisms && h.refused.empty() && std::all_of(h.candidates.begin(), h.candidates.end(), [&](std::size_t c) {
          return std::find(e.named.begin(), e.named.end(), c) != e.named.end();
        });
    const std::string answer = !mechanisms         ? "for comparison"
                               : named             ? "yes"
                               : h.refused.empty() ? "could be"
                                                   : "no: " + h.refused;
    const std::string gained = printed(h.gain) + " ± " + printed(h.gain_sigma, 2);
    table.rows.push_back({h.name, printed(h.held_out), gained, percent(h.effect), answer});
  }
  page.table(table);
}

void isolability(Page& page, const Problem& problem, const Explanation& e) {
  report::TableText table{"What these recordings could show at all",
                          {{"mechanism", "", false},
                           {"survives the free parameters", ""},
                           {"smallest amplitude seen", "", false},
                           {"looks like", "", false}},
                          {}};
  for (const Isolability& i : e.isolability) {
    std::string limits, alike;
    const std::vector<std::size_t>& own = problem.candidates()[i.candidate].parameters;
    for (std::size_t k = 0; k < std::min<std::size_t>(4, own.size()); ++k) {
      const Parameter& p = problem.parameters()[own[k]];
      limits += (k == 0 ? "" : ", ") + p.name.substr(p.name.find_last_of("./") + 1) + " " +
                (std::isfinite(i.detection_limit[k]) ? printed(i.detection_limit[k], 2) : "none");
    }
    for (const auto& [other, cosine] : i.look_alikes)
      alike += (alike.empty() ? "" : ", ") + problem.candidates()[other].id() + " (" + printed(cosine, 2) + ")";
    table.rows.push_back(
        {name_of(problem, i.candidate), percent(i.surviving_share), i.visible ? limits : "cannot be seen", alike});
  }
  page.table(table);
}

void compensation(Page& page, const Problem& problem, const Explanation& e) {
  if (e.compensation.empty()) return;
  page.section("What the missing physics had bent");
  page.paragraph("Free parameters of the base model before and after the named physics was put in.");
  report::TableText table{
      "", {{"parameter", "", false}, {"before", ""}, {"after", ""}, {"sigma", ""}, {"unit", "", false}}, {}};
  for (std::size_t k = 0; k < std::min<std::size_t>(12, e.compensation.size()); ++k) {
    const Compensation& c = e.compensation[k];
    table.rows.push_back({problem.parameters()[c.parameter].name, printed(c.before, 5), printed(c.after, 5),
                          printed(c.sigma, 2), problem.parameters()[c.parameter].unit});
  }
  page.table(table);
}

void part(Page& page, const ReportPart& p) {
  const Problem& problem = *p.problem;
  const Explanation& e = *p.explanation;
  page.section("What was found: " + problem.domain());
  key_numbers(page, problem, e);
  parameters(page, problem, e);
  where(page, problem, e, *p.illustration);
  which_curve(page, e);
  page.section("How sure");
  scoreboard(page, problem, e);
  isolability(page, problem, e);
  page.note("Noise: stated sigma times " + printed(e.noise_factor) + "; " + std::to_string(e.outlier_blocks) +
            " blocks set aside as no measurements. Effects below " + percent(e.matters) + " are not named.");
  compensation(page, problem, e);
  if (e.next_measurement.empty()) return;
  page.section("What to measure next");
  page.paragraph(e.next_measurement);
}

}  // namespace

std::string report_page(const std::string& name, const std::vector<ReportPart>& parts) {
  std::string headline, lead;
  Verdict worst = Verdict::null;
  for (const ReportPart& p : parts) {
    headline += (headline.empty() ? "" : " ") + p.explanation->sentence;
    lead += (lead.empty() ? "" : "; ") + std::to_string(p.problem->observations().groups()) + " " +
            p.problem->group_noun() + "s, " + std::to_string(p.problem->observations().rows()) + " observations";
    worst = std::max(worst, p.explanation->verdict);
  }
  Page page("explain: " + name, headline, name + ": " + lead, tone_of(worst));
  for (const ReportPart& p : parts) part(page, p);
  page.footer(
      "Written by gonio explain. Scores are of groups that the fit did not see; intervals hold under correlation "
      "inside blocks.");
  return page.html();
}

}  // namespace gonio::explain

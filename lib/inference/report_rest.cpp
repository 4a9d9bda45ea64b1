// See report_parts.h: what is folded away. Hypotheses, isolability, compensation, noise.
#include <algorithm>
#include <cmath>
#include <limits>

#include "inference/compensation.h"
#include "inference/report_parts.h"
#include "inference/wording.h"

namespace gonio::inference {
namespace {

bool is_screened(const Hypothesis& h) {
  return h.refused.find("screened, not fitted") != std::string::npos;
}

void scoreboard(report::Page& page, const Problem& problem, const Explanation& e) {
  if (e.scoreboard.empty()) return;
  page.open_details("All hypotheses (" + std::to_string(e.scoreboard.size()) + ")");
  report::TableText table{
      "Gain: fall of the held-out mean square, in squared noise, against the model it extends. "
      "Effect: what --smallest-effect is held against.",
      {{"hypothesis", "", false},
       {"held-out score", problem.unit() == "1" ? "" : problem.unit()},
       {"gain", "", false},
       {"effect", ""},
       {"could be named", "", false}},
      {}};
  std::string screened;
  for (const Hypothesis& h : e.scoreboard) {
    if (is_screened(h)) {
      screened += (screened.empty() ? "" : ", ") + h.name;
      continue;
    }
    const bool named = std::any_of(h.candidates.begin(), h.candidates.end(), [&](std::size_t c) {
      return h.kind == Hypothesis::Kind::mechanisms && std::find(e.named.begin(), e.named.end(), c) != e.named.end();
    });
    const std::string answer = h.kind != Hypothesis::Kind::mechanisms ? "for comparison"
                               : named                                ? "yes"
                               : h.refused.empty()                    ? "could be"
                                                                      : "no: " + h.refused;
    table.rows.push_back({h.name, printed(h.held_out), plain_number(h.gain, 3) + " ± " + plain_number(h.gain_sigma),
                          share_in_words(h.effect), answer});
  }
  page.table(table);
  if (!screened.empty()) page.note("By linear algebra out of reach of the best, and not fitted: " + screened + ".");
  page.close_details();
}

// The detection limit of each parameter over what a fit may reach: how much room there is to see it.
double blindness(const Problem& problem, const Isolability& i) {
  double least = std::numeric_limits<double>::infinity();
  const std::vector<std::size_t>& own = problem.candidates()[i.candidate].parameters;
  for (std::size_t k = 0; k < std::min(own.size(), i.detection_limit.size()); ++k) {
    const Parameter& p = problem.parameters()[own[k]];
    const double reach = std::max(p.upper - p.neutral, p.neutral - p.lower);
    if (reach > 0) least = std::min(least, i.detection_limit[k] / reach);
  }
  return least;
}

constexpr double told_beside = 1.5;  // limits that differ by less are told as one

std::vector<std::string> isolability_row(const Problem& problem, const Isolability& i) {
  std::string limits, alike;
  const std::vector<std::size_t>& own = problem.candidates()[i.candidate].parameters;
  for (std::size_t k = 0; k < std::min<std::size_t>(3, own.size()); ++k) {
    const Parameter& p = problem.parameters()[own[k]];
    limits += (k == 0 ? "" : ", ") + p.name.substr(p.name.find_last_of("./") + 1) + " " +
              (std::isfinite(i.detection_limit[k]) ? quantity(i.detection_limit[k], p.unit) : "none");
    const bool any = k < i.limit_with_others.size() && std::isfinite(i.limit_with_others[k]);
    if (any && i.limit_with_others[k] > told_beside * i.detection_limit[k])
      limits += " (beside others " + quantity(i.limit_with_others[k], p.unit) + ")";
  }
  if (own.size() > 3) limits += ", ...";
  for (const auto& [other, cosine] : i.look_alikes)
    alike += (alike.empty() ? "" : ", ") + problem.candidates()[other].id() + " (" + printed(cosine, 2) + ")";
  return {mechanism_in_words(problem, i.candidate), share_in_words(i.surviving_share), limits, alike};
}

void isolability(report::Page& page, const Problem& problem, const Explanation& e) {
  if (e.isolability.empty()) return;
  page.open_details("What these recordings could show at all");
  std::vector<Isolability> seen;
  std::string blind;
  for (const Isolability& i : e.isolability) {
    if (i.visible)
      seen.push_back(i);
    else
      blind += (blind.empty() ? "" : ", ") + mechanism_in_words(problem, i.candidate);
  }
  std::stable_sort(seen.begin(), seen.end(), [&](const Isolability& a, const Isolability& b) {
    return blindness(problem, a) < blindness(problem, b);
  });
  report::TableText table{
      "Before any residual is judged: how much of each signature the free parameters leave, and the "
      "smallest amplitude that would be seen, alone and, where that differs, whatever the mechanism's other numbers "
      "do. "
      "The easiest to see come first.",
      {{"mechanism", "", false},
       {"survives", ""},
       {"smallest amplitude seen", "", false},
       {"looks like (cosine)", "", false}},
      {}};
  for (const Isolability& i : seen) table.rows.push_back(isolability_row(problem, i));
  if (!table.rows.empty()) page.table(table);
  if (!blind.empty()) page.paragraph("Cannot be seen in these recordings: " + blind + ".");
  page.close_details();
}

void minor_effects(report::Page& page, const Explanation& e) {
  std::vector<std::string> items;
  for (const std::size_t place : e.minor) {
    if (place >= e.scoreboard.size()) continue;
    const Hypothesis& h = e.scoreboard[place];
    items.push_back(h.name + ": effect " + share_in_words(h.effect) + ", below " + share_in_words(e.smallest_effect));
  }
  if (items.empty()) return;
  page.open_details("Too small to matter (" + std::to_string(items.size()) + ")");
  page.paragraph("Each was tried alone on what is left; several may look like the same small rest.");
  page.list(items);
  page.close_details();
}

void compensation(report::Page& page, const Problem& problem, const Explanation& e) {
  if (e.compensation.empty()) return;
  page.open_details("What the missing physics had bent");
  page.paragraph("Free parameters of the base model before and after the named physics was put in. " +
                 compensation_in_words(problem, e));
  report::TableText table{"",
                          {{"parameter", "", false},
                           {"before", ""},
                           {"after", "", false},
                           {"moved by", "sigmas"},
                           {"calibrated", "", false}},
                          {}};
  for (std::size_t k = 0; k < std::min<std::size_t>(12, e.compensation.size()); ++k) {
    const Compensation& c = e.compensation[k];
    const Parameter& p = problem.parameters()[c.parameter];
    const Shown shown = shown_in(p.unit, std::max(std::abs(c.after), std::abs(c.before)));
    std::string calibrated;
    if (c.calibrated)
      calibrated = estimate_in_words(*c.calibrated, c.calibrated_sigma.value_or(0), p.unit) +
                   (c.towards ? ", towards" : ", away");
    table.rows.push_back({p.name, printed(c.before * shown.factor, 5), estimate_in_words(c.after, c.sigma, p.unit),
                          (c.after < c.before ? "−" : "") + plain_number(std::abs(c.after - c.before) / c.sigma),
                          calibrated});
  }
  page.table(table);
  page.close_details();
}

}  // namespace

void tell_rest(report::Page& page, const ReportPart& part) {
  const Problem& problem = *part.problem;
  const Explanation& e = *part.explanation;
  page.section("What was weighed");
  scoreboard(page, problem, e);
  isolability(page, problem, e);
  minor_effects(page, e);
  compensation(page, problem, e);
  page.note("Noise: stated sigma times " + printed(e.noise_factor) + "; " + std::to_string(e.outlier_blocks) +
            " blocks set aside as no measurements. Effects below " + share_in_words(e.smallest_effect) +
            " are not named." + (e.shortened.empty() ? "" : " " + e.shortened));
}

}  // namespace gonio::inference

// An analysis of results as sections of a page. See analysis.h.
#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "nrsfm/evaluate/analysis.h"
#include "report/number_text.h"
#include "report/page.h"

namespace gonio::nrsfm {
namespace {

using report::number_text;
using stats::MarginalMean;

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

const char* covariance_sentence(stats::Covariance covariance) {
  switch (covariance) {
    case stats::Covariance::classical: return "F tests of equal error variance.";
    case stats::Covariance::hc0: return "Wald tests with White's covariance (HC0): error variances may differ.";
    case stats::Covariance::hc1: return "Wald tests with robust covariance HC1: error variances may differ.";
    case stats::Covariance::hc2: return "Wald tests with robust covariance HC2: error variances may differ.";
    case stats::Covariance::hc3: return "Wald tests with robust covariance HC3: error variances may differ.";
  }
  return "";
}

report::TableText anova_table(const Analysis& analysis, const Part& part) {
  const char* types[] = {"I", "II", "III"};
  report::TableText table;
  table.caption = std::string("Sums of squares of type ") + types[static_cast<int>(analysis.options.type)] + ". " +
                  covariance_sentence(analysis.options.covariance) +
                  format(" Terms with p below %g are marked *.", analysis.options.significance);
  table.columns = {{"term", "", false}, {"sum of squares"}, {"degrees"}, {"mean square"}, {"F"}, {"p"},
                   {"", "", false}};
  for (const stats::TermRow& r : part.anova.rows)
    table.rows.push_back({stats::term_name(part.design, r.term), number_text(r.sum_of_squares, 4),
                          std::to_string(r.degrees), number_text(r.mean_square, 4), number_text(r.f, 4), p_text(r),
                          r.p < analysis.options.significance ? "*" : ""});
  const stats::Anova& fit = part.anova;
  table.rows.push_back({"error", number_text(fit.residual_sum_of_squares, 4), std::to_string(fit.residual_degrees),
                        number_text(fit.residual_sum_of_squares / fit.residual_degrees, 4), "", "", ""});
  table.rows.push_back(
      {"total", number_text(fit.total_sum_of_squares, 4), std::to_string(fit.total_degrees), "", "", "", ""});
  return table;
}

report::TableText single_table(const Analysis& analysis, const Part& part, const MeansTable& means) {
  const stats::Factor& f = part.design.factors[at(means.term[0])];
  report::TableText table;
  table.caption = "Expected error, " + means.formula + "; everything else averaged with equal weight.";
  table.columns = {
      {f.name, "", false}, {analysis.measure, analysis.unit}, {"standard error", analysis.unit}, {"results"}};
  for (const MarginalMean& m : means.means)
    table.rows.push_back({f.levels[at(m.levels[0])], report::value_for_sigma(m.value, m.sigma), number_text(m.sigma, 2),
                          std::to_string(m.observations)});
  return table;
}

report::HeatStrip pair_strip(const Analysis& analysis, const Part& part, const MeansTable& means) {
  const stats::Factor &a = part.design.factors[at(means.term[0])], &b = part.design.factors[at(means.term[1])];
  report::HeatStrip strip;
  strip.title = a.name + " and " + b.name;
  strip.caption = "Expected error, " + means.formula + ".";
  strip.label = analysis.measure + (analysis.unit.empty() ? "" : " / " + analysis.unit);
  for (std::size_t i = 0; i < means.means.size(); ++i) {
    const MarginalMean& m = means.means[i];
    if (i < b.levels.size()) strip.columns.push_back(b.levels[at(m.levels[1])]);
    if (i % b.levels.size() == 0) strip.rows.push_back(a.levels[at(m.levels[0])]);
    strip.values.push_back(m.value);
  }
  return strip;
}

void add_ranks(report::Page& page, const Analysis& analysis, const Part& part) {
  const stats::Factor& f = part.design.factors[at(part.ranked)];
  report::TableText table;
  table.caption = format(
      "Rank 1 has the least expected error. The interval holds all ranks that simultaneous %g %% intervals of "
      "differences "
      "leave open; results of one sequence were drawn together.",
      100 * analysis.options.confidence);
  table.columns = {{f.name, "", false}, {analysis.measure, analysis.unit}, {"rank"}, {"interval"}, {"first in draws"}};
  for (const stats::Rank& r : part.ranks)
    table.rows.push_back({f.levels[at(r.level)], number_text(r.mean, 4), format("%g", r.rank),
                          r.lower == r.upper ? format("%g", r.lower) : format("%g to %g", r.lower, r.upper),
                          report::percent_text(r.best_share, 0)});
  page.subsection("Ranks");
  page.table(table);
}

void add_empty_cells(report::Page& page, const Part& part) {
  if (part.empty_cells.empty()) return;
  constexpr std::size_t most = 200;
  page.open_details(format("%zu combinations without a result", part.empty_cells.size()));
  std::vector<std::string> items;
  for (std::size_t i = 0; i < std::min(most, part.empty_cells.size()); ++i) {
    std::string text;
    for (const auto& [name, level] : part.empty_cells[i]) text += (text.empty() ? "" : ", ") + name + " " + level;
    items.push_back(text);
  }
  if (part.empty_cells.size() > most) items.push_back(format("... and %zu more", part.empty_cells.size() - most));
  page.list(items);
  page.close_details();
}

void add_part(report::Page& page, const Analysis& analysis, const Part& part) {
  const std::string axis = analysis.measure + (analysis.unit.empty() ? "" : " / " + analysis.unit);
  page.section("Analysis of variance: " + part.title);
  page.paragraph(format("%zu results, %s.", part.design.y.size(),
                        part.anova.balanced ? "as many in every cell" : "not as many in every cell"));
  page.table(anova_table(analysis, part));
  if (!part.notes.empty()) page.list(part.notes);
  if (!part.ranks.empty()) add_ranks(page, analysis, part);
  page.subsection("Factors");
  std::vector<report::Figure> boxes, interactions;
  for (int f = 0; f < static_cast<int>(part.design.factors.size()); ++f) {
    report::Figure figure;
    figure.svg = box_plot(part.design, f, axis);
    figure.title = part.design.factors[at(f)].name;
    figure.caption = "Median, quartiles, whiskers to 1.5 times the box; all results.";
    boxes.push_back(std::move(figure));
  }
  page.figures(boxes, 520);
  for (const MeansTable& table : part.tables)
    if (table.term.size() == 1) page.table(single_table(analysis, part, table));
  for (const MeansTable& table : part.tables) {
    if (table.term.size() != 2) continue;
    report::Figure figure;
    figure.svg = interaction_plot(part.design, table, axis);
    figure.title = stats::term_name(part.design, table.term);
    figure.caption = "Expected error; parallel lines: no interaction.";
    if (!figure.svg.empty()) interactions.push_back(std::move(figure));
  }
  if (!interactions.empty()) {
    page.subsection("Interactions");
    page.figures(interactions, 520);
    for (const MeansTable& table : part.tables)
      if (table.term.size() == 2) page.heat_strip(pair_strip(analysis, part, table));
  }
  add_empty_cells(page, part);
}

}  // namespace

void add_analysis(report::Page& page, const Analysis& analysis) {
  for (const Part& part : analysis.parts) add_part(page, analysis, part);
}

}  // namespace gonio::nrsfm

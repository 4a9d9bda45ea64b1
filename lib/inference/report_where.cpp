// See report_parts.h: where the mismatch is, in pictures, groups and conditions, and the law beyond the library.
#include <algorithm>
#include <cmath>

#include "inference/report_parts.h"
#include "inference/wording.h"

namespace gonio::inference {
namespace {

using report::Series;
constexpr std::size_t most_columns = 24;
constexpr int large_px = 720, small_px = 400;

// One column of pictures that are large enough to see; the rest, folded, beside each other.
void pictures(report::Page& page, const Illustration& illustration) {
  const auto figure = [](const Picture& p) {
    return report::Figure{.png = p.png, .svg = p.svg, .title = p.title, .caption = p.caption};
  };
  const auto show = [&](const Picture& p, int width_px) {
    if (p.over_png.empty())
      page.figures({figure(p)}, width_px);
    else
      page.slider(figure(p), {.png = p.over_png, .title = p.over_title}, p.caption);
  };
  const std::vector<Picture>& all = illustration.pictures;
  const std::size_t first = std::min(illustration.seen_at_once, all.size());
  for (std::size_t k = 0; k < first; ++k) show(all[k], large_px);
  if (all.size() == first) return;
  page.open_details("More pictures (" + std::to_string(all.size() - first) + ")");
  std::vector<report::Figure> beside;
  for (std::size_t k = first; k < all.size(); ++k)
    if (all[k].over_png.empty()) beside.push_back(figure(all[k]));
  page.figures(beside, small_px);
  for (std::size_t k = first; k < all.size(); ++k)
    if (!all[k].over_png.empty()) show(all[k], large_px);
  page.close_details();
}

void shares(report::Page& page, const Problem& problem, const Explanation& e) {
  report::HeatStrip strip;
  strip.title = "Which " + problem.group_noun() + "s hold the excess over noise";
  strip.label = "share of the excess";
  strip.rows = {""};
  std::vector<std::string> shown;
  for (std::size_t k = 0; k < std::min(most_columns, e.groups.size()); ++k) shown.push_back(e.groups[k].name);
  if (e.groups.size() > most_columns)
    strip.caption = "The " + std::to_string(most_columns) + " largest of " + std::to_string(e.groups.size());
  for (const std::string& name : problem.observations().group) {
    if (std::find(shown.begin(), shown.end(), name) == shown.end()) continue;
    const auto g =
        std::find_if(e.groups.begin(), e.groups.end(), [&](const LocatedGroup& x) { return x.name == name; });
    strip.columns.push_back(name);
    strip.values.push_back(g->share);
  }
  if (strip.columns.size() > 1) page.heat_strip(strip);
}

std::string effect_in_words(const LocatedCondition& c) {
  if (!(c.effect > 0)) return "";
  const std::string& unit = c.curve.value_unit;
  return unit.empty() || unit == "1" ? share_in_words(c.effect) : quantity(c.effect, unit);
}

// "half angle below 18 degrees: 64 % of the excess, 0.8 px rms there; 90 % of what the named physics does".
std::string ranked(const Problem& problem, const LocatedCondition& c) {
  if (c.period > 0)
    return place_in_words(problem, c) + " (" + c.name + "): " + share_in_words(c.share) + " of the excess";
  std::string range = range_in_words(c);
  if (range.empty()) range = "over its whole range";
  const std::string effect = effect_in_words(c);
  return condition_in_words(c.name) + " (" + c.name + ") " + range + ": " + share_in_words(c.share) + " of the excess" +
         (effect.empty() ? "" : ", " + effect + " rms there") +
         (c.of_effect < 0.01 ? "" : "; " + share_in_words(c.of_effect) + " of what the named physics does");
}

// Values, scaled to the unit that people use.
std::vector<double> scaled(std::vector<double> values, double factor) {
  for (double& v : values) v *= factor;
  return values;
}

double largest(const std::vector<double>& values) {
  double size = 0;
  for (const double v : values) size = std::max(size, std::abs(v));
  return size;
}

std::string axis(const std::string& name, const std::string& unit) {
  return name + (unit.empty() ? "" : " / " + unit);
}

report::Plot curve_plot(const Curve& curve, const std::string& after_name) {
  const Shown x = shown_in(curve.unit, largest(curve.centre)), y = shown_in(curve.value_unit, largest(curve.before));
  const std::vector<double> centre = scaled(curve.centre, x.factor), sigma = scaled(curve.sigma, y.factor);
  const std::vector<double> before = scaled(curve.before, y.factor), after = scaled(curve.after, y.factor);
  report::Plot plot;
  plot.title = "Mean residual over the " + condition_in_words(curve.condition);
  plot.x_label = axis(condition_in_words(curve.condition), x.unit);
  plot.y_label = axis("mean residual", y.unit);
  plot.zero_y = true;
  plot.series = {
      {.kind = Series::Kind::line, .x = centre, .y = before, .style = 0},
      {.kind = Series::Kind::points, .name = "base model", .x = centre, .y = before, .sigma = sigma, .style = 0}};
  if (after_name.empty() || after.empty()) return plot;
  plot.series.push_back({.kind = Series::Kind::line, .x = centre, .y = after, .style = 1});
  plot.series.push_back(
      {.kind = Series::Kind::points, .name = after_name, .x = centre, .y = after, .sigma = sigma, .style = 1});
  return plot;
}

}  // namespace

void tell_misplaced(report::Page& page, const ReportPart& part) {
  const Misplaced& m = part.explanation->misplaced;
  if (m.files.empty()) return;
  page.section("Which files belong elsewhere");
  report::TableText table{
      "Root mean square difference of the logarithms after one factor for exposure and each surface; a pixel counts "
      "100 % at most.",
      {{"file of", "", false}, {"fits what should show", "", false}, {"error there", ""}, {"in its own place", ""}},
      {}};
  for (const Misplaced::File& f : m.files)
    table.rows.push_back({f.group, f.shows, share_in_words(f.other), share_in_words(f.own)});
  page.table(table);
}

void tell_where(report::Page& page, const ReportPart& part) {
  page.section("Where");
  const Explanation& e = *part.explanation;
  pictures(page, *part.illustration);
  if (!part.illustration->boxes.empty()) {
    std::vector<std::string> items;
    for (std::size_t k = 0; k < std::min<std::size_t>(6, part.illustration->boxes.size()); ++k) {
      const Box& b = part.illustration->boxes[k];
      items.push_back(b.group + ": " + std::to_string(b.width) + " x " + std::to_string(b.height) +
                      " pixels from column " + std::to_string(b.x) + ", row " + std::to_string(b.y));
    }
    page.open_details("The boxes, in pixels");
    page.list(items);
    page.close_details();
  }
  shares(page, *part.problem, e);
}

void tell_curve(report::Page& page, const ReportPart& part) {
  const Explanation& e = *part.explanation;
  if (e.conditions.empty()) return;
  page.section("Which curve");
  std::vector<report::Plot> plots;
  for (std::size_t k = 0; k < std::min<std::size_t>(2, e.conditions.size()); ++k) {
    const LocatedCondition& c = e.conditions[k];
    if (c.curve.centre.empty()) continue;
    plots.push_back(curve_plot(c.curve, e.named.empty() ? "" : "with the named physics"));
    const double factor = shown_in(c.unit, largest(c.curve.centre)).factor;
    if (!range_in_words(c).empty() && e.significant)
      plots.back().shades = {{c.lower * factor, c.upper * factor, "most of it"}};
    plots.back().caption = "Bins of equal counts, one standard error.";
  }
  page.plots(plots);
  if (!e.significant) return;
  if (!tells_where(e.conditions[0])) {
    std::string nowhere = nowhere_in_words(*part.problem, e.conditions[0]);
    nowhere[0] = 'N';
    page.paragraph(nowhere + ".");
  }
  std::vector<std::string> items;
  for (std::size_t k = 0; k < std::min<std::size_t>(4, e.conditions.size()); ++k)
    if (k == 0 || e.conditions[k].share > 0.05) items.push_back(ranked(*part.problem, e.conditions[k]));
  page.list(items);
}

void tell_law(report::Page& page, const ReportPart& part) {
  const Explanation& e = *part.explanation;
  if (!e.outside) return;
  const Outside& o = *e.outside;
  page.section("Outside the library");
  if (o.terms.empty()) {
    page.paragraph("Structure over the " + condition_in_words(o.condition) +
                   " remains, and no law over it was found that extrapolates.");
    return;
  }
  page.paragraph(o.law + ".");
  page.paragraph("No known effect, but a description that holds where it was not fitted: for " + o.extrapolated +
                 " the " + part.problem->score_name() + " falls from " +
                 score_in_words(o.held_out_before, part.problem->unit()) + " to " +
                 score_in_words(o.held_out_after, part.problem->unit()) + ". It takes " + share_in_words(o.share) +
                 " of the excess over noise.");
  report::Plot plot = curve_plot(o.curve, "less the law");
  const double factor = shown_in(o.curve.unit, largest(o.curve.centre)).factor;
  plot.marks = {{report::Mark::Axis::x, o.split * factor, "fitted | judged"}};
  plot.caption = "Fitted on one side of the line and judged on the other, both ways.";
  page.plot(plot);
}

}  // namespace gonio::inference

// The page of `contrast predict --optimize` (optimize_page.h).
#include "tools/contrast/optimize_page.h"

#include "report/number_text.h"
#include "tools/contrast/predict_page.h"

namespace gonio::tools::contrast {

using namespace gonio::contrast;

namespace {

using report::number_text;

struct Shown {  // a parameter in the unit that people read
  std::string name, unit;
  double per_si = 1;
};
Shown shown(const std::string& parameter) {
  if (parameter.ends_with("_rad")) return {parameter.substr(0, parameter.size() - 4), "deg", 1 / degree};
  if (parameter.ends_with("_m")) return {parameter.substr(0, parameter.size() - 2), "um", 1e6};
  return {parameter, "", 1};
}

report::TableText sensitivity(const Optimum& o) {
  report::TableText table{.caption = "What the optimum is, and how much each number matters there",
                          .columns = {{"Parameter", "", false},
                                      {"Optimum", ""},
                                      {"Bounds", "", false},
                                      {"Held by", "", false},
                                      {"Keeps 95 % of the contrast", "", false},
                                      {"10 % less", "% of contrast"},
                                      {"10 % more", "% of contrast"}},
                          .rows = {}};
  for (const auto& n : o.numbers) {
    const Shown s = shown(n.parameter);
    const auto text = [&s](double v) { return number_text(v * s.per_si, 4); };
    const auto range = [&](double a, double b) { return text(a) + " to " + text(b); };
    table.rows.push_back({s.name + (s.unit.empty() ? "" : " / " + s.unit), text(n.value),
                          range(n.bound.lower, n.bound.upper),
                          n.at_bound < 0   ? "lower bound"
                          : n.at_bound > 0 ? "upper bound"
                                           : "\u2013",
                          range(n.keeps_from, n.keeps_to), number_text(100 * n.less, 4), number_text(100 * n.more, 4)});
  }
  return table;
}

std::vector<report::Plot> scans(const Optimum& o, Definition definition) {
  std::vector<report::Plot> plots;
  for (const auto& n : o.numbers) {
    const Shown s = shown(n.parameter);
    report::Plot plot{.title = s.name,
                      .x_label = s.name + (s.unit.empty() ? "" : " / " + s.unit),
                      .y_label = std::string("contrast / ") + (definition == Definition::difference ? "1/sr" : "1")};
    report::Series line;
    for (std::size_t i = 0; i < n.at.size(); ++i) {
      line.x.push_back(n.at[i] * s.per_si);
      line.y.push_back(n.contrast[i]);
    }
    plot.series = {line};
    plot.marks = {{.axis = report::Mark::Axis::x, .at = n.value * s.per_si, .name = "optimum"}};
    plot.zero_y = true;
    plots.push_back(std::move(plot));
  }
  return plots;
}

void add_limits(report::Page& page, const Optimum& o, const Wish& wish) {
  std::vector<std::string> lines;
  for (const auto& n : o.numbers) {
    const Shown s = shown(n.parameter);
    if (n.at_bound != 0)
      lines.push_back(s.name + " is held by its " + (n.at_bound < 0 ? "lower" : "upper") +
                      " bound: beyond it the contrast would still grow. The bound, not the surface, decides here.");
    if (n.parameter == pitch_name)
      lines.push_back(
          "The reflectance itself does not depend on the pitch. Its upper bound is what must not be seen one by one; "
          "below, facets of a small pitch spread light by diffraction at " +
          number_text(wish.wavelength_m * 1e9, 4) +
          " nm, taken as roughness across the ridges. Orders of a grating, which coherent lamps show, are left out.");
  }
  if (!lines.empty()) page.list(lines);
}

}  // namespace

std::string optimize_page(const Optimum& o, const Wish& wish, const Prediction& p) {
  report::Page page(
      "Greatest contrast of " + p.surface, optimum_sentence(o, wish),
      "Found among " + std::to_string(o.evaluations) + " surfaces of model " + p.model + " within the bounds.");
  page.section("The optimum");
  page.table(sensitivity(o));
  add_limits(page, o, wish);
  page.section("Along each parameter");
  page.paragraph("The contrast across the bounds of one parameter, the others kept at the optimum.");
  page.plots(scans(o, wish.experiment.definition));
  add_prediction(page, p);
  return page.html();
}

}  // namespace gonio::tools::contrast

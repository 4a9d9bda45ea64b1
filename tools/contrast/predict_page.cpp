// The page of `contrast predict` (predict_page.h).
#include "tools/contrast/predict_page.h"

#include <algorithm>
#include <cmath>

#include "report/number_text.h"

namespace gonio::tools::contrast {

using namespace gonio::contrast;

namespace {

using report::Page;
using report::Plot;
using report::Series;
using report::TableText;

std::string unit_of(Definition d) {
  return d == Definition::difference ? "1/sr" : "1";
}
std::string name_of(Definition d) {
  return d == Definition::difference ? "difference" : "Michelson";
}

std::string text_of(const Estimate& e) {
  return e.sigma > 0 ? report::with_sigma(e.value, e.sigma) : report::number_text(e.value, 4);
}

std::string title_of(const Means& m) {
  return m.over == "tilt" ? "Camera tilt" : m.over == "rotation" ? "Rotation" : m.over;
}
std::string axis_of(const Means& m) {
  if (m.over == "tilt") return "camera tilt / degrees";
  if (m.over == "rotation") return "pair of rotations, in the table\u2019s order";
  return m.over.ends_with("_rad") ? m.over.substr(0, m.over.size() - 4) + " / degrees" : m.over;
}

Plot plot_of(const Means& m, Definition definition, double top) {
  Plot plot{.title = title_of(m), .x_label = axis_of(m), .y_label = "mean contrast / " + unit_of(definition)};
  if (m.over == "rotation") {
    plot.caption = "Pairs:";
    for (std::size_t i = 0; i < m.label.size(); ++i)
      plot.caption += (i > 0 ? ", " : " ") + std::to_string(i + 1) + ": " + m.label[i] + " degrees";
    plot.caption += ".";
  }
  Series line{.kind = Series::Kind::line, .style = 0}, points{.kind = Series::Kind::points, .style = 0};
  for (std::size_t i = 0; i < m.mean.size(); ++i) {
    const double x = m.over == "rotation"                           ? m.at[i] + 1
                     : m.over.ends_with("_rad") || m.over == "tilt" ? m.at[i] / degree
                                                                    : m.at[i];
    points.x.push_back(x);
    points.y.push_back(m.mean[i].value);
    points.sigma.push_back(m.mean[i].sigma);
  }
  line.x = points.x;
  line.y = points.y;
  if (m.over != "rotation") plot.series.push_back(line);
  plot.series.push_back(points);
  plot.zero_y = true;
  plot.y_range = {0, top};
  if (m.over == "rotation") plot.x_range = {0.5, static_cast<double>(m.mean.size()) + 0.5};
  return plot;
}

TableText table_of(const Means& m, const Prediction& p) {
  double most = 0;
  for (const Estimate& e : m.mean) most = std::max(most, e.value);
  TableText table{.caption = "Mean contrast by " + title_of(m),
                  .columns = {{m.over == "rotation" ? "pair of rotations / degrees" : axis_of(m), "", false},
                              {"Mean contrast", unit_of(p.experiment.definition)},
                              {"Over the largest", ""}}};
  for (std::size_t i = 0; i < m.mean.size(); ++i)
    table.rows.push_back(
        {m.label[i], text_of(m.mean[i]), most > 0 ? report::number_text(m.mean[i].value / most, 3) : "\u2013"});
  return table;
}

void add_combinations(Page& page, const Prediction& p) {
  page.open_details("Every combination");
  TableText table;
  for (const Varied& v : p.varied) table.columns.push_back({v.parameter, ""});
  for (const char* name :
       {"Tilt / deg", "Rotations / deg", "First / (1/sr)", "Second / (1/sr)", "Difference / (1/sr)", "Michelson"})
    table.columns.push_back({name, ""});
  for (const Combination& c : p.combinations) {
    std::vector<std::string> row;
    for (std::size_t i = 0; i < p.varied.size(); ++i)
      row.push_back(p.varied[i].parameter.ends_with("_rad") ? degrees_text(c.varied[i]) + " deg"
                                                            : report::number_text(c.varied[i], 4));
    row.insert(row.end(), {degrees_text(c.tilt_rad), pair_name(c.pair_rad), text_of(c.first), text_of(c.second),
                           text_of(c.difference), text_of(c.michelson)});
    table.rows.push_back(std::move(row));
  }
  page.table(table);
  page.close_details();
}

std::string headline(const Prediction& p) {
  std::string text = "The mean contrast is greatest";
  for (std::size_t i = 0; i < p.means.size(); ++i) {
    const Means& m = p.means[i];
    const std::string degrees = m.over == "tilt" || m.over == "rotation" || m.over.ends_with("_rad") ? " degrees" : "";
    text += (i == 0 ? " at " : i + 1 == p.means.size() ? " and for " : ", ");
    text += (m.over == "tilt" ? "a tilt of " : m.over == "rotation" ? "the rotations " : m.over + " = ");
    text += m.label[largest(m)] + degrees;
  }
  return text + ".";
}

void add_surface(Page& page, const Prediction& p) {
  if (p.stated.empty()) return;
  page.open_details("The surface");
  TableText table{.caption = "Numbers of the model " + p.model + (p.varied.empty() ? "" : " that are not varied"),
                  .columns = {{"Parameter", "", false}, {"Value", ""}, {"Meaning", "", false}},
                  .rows = {}};
  for (const Stated& s : p.stated)
    table.rows.push_back({s.parameter,
                          s.unit == "rad" ? degrees_text(s.value) + " deg"
                                          : report::number_text(s.value, 4) + (s.unit == "1" ? "" : " " + s.unit),
                          s.meaning});
  page.table(table);
  page.close_details();
}

void add_definitions(Page& page, const Prediction& p) {
  const Experiment& e = p.experiment;
  page.section("How it was found");
  page.list(
      {"The camera tilts over the sample; the lamp is fixed " + degrees_text(e.light_rad) + " degrees from it, " +
           (e.plane == LightPlane::across ? "out of the plane of tilt." : "ahead of it in the plane of tilt."),
       "Signal: radiance over the lamp\u2019s irradiance, f cos \u03b8i in 1/sr, mean of the bands: the exposure of a "
       "sensor up to a constant.",
       "Contrast of two rotations of the sample about its normal with the signals a and b: difference |a \u2212 b| as "
       "published (Luongo et al. 2017); Michelson |a \u2212 b| / (a + b). The means are of the " +
           name_of(e.definition) + ".",
       "Means: one condition is kept, all contrasts of the others are averaged, as in figure 8 of that paper.",
       p.uncertain.empty() ? "Nothing was stated to be uncertain: no error bars."
                           : "\u00b1 and bars: one standard deviation over " + std::to_string(p.draws) +
                                 " draws of what is uncertain."});
  if (!p.uncertain.empty()) page.list(p.uncertain);
}

}  // namespace

std::vector<Plot> mean_plots(const Prediction& p) {
  double top = 0;  // one scale for all, as in the paper's figure
  for (const Means& m : p.means)
    for (const Estimate& e : m.mean) top = std::max(top, e.value + e.sigma);
  std::vector<Plot> plots;
  for (const Means& m : p.means) plots.push_back(plot_of(m, p.experiment.definition, top > 0 ? 1.08 * top : 1));
  return plots;
}

void add_prediction(Page& page, const Prediction& p) {
  page.section("Mean contrasts");
  page.plots(mean_plots(p));
  for (const Means& m : p.means) page.table(table_of(m, p));
  add_combinations(page, p);
  add_surface(page, p);
  add_definitions(page, p);
}

std::string predict_page(const Prediction& p) {
  Page page("Predicted contrast of " + p.surface, headline(p),
            "Contrast of the surface \u201c" + p.surface + "\u201d (model " + p.model +
                ") before and after a rotation about its normal, " + std::to_string(p.combinations.size()) +
                " combinations.");
  add_prediction(page, p);
  return page.html();
}

}  // namespace gonio::tools::contrast

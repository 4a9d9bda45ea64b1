// See sensor_page.h.
#include "tools/develop/sensor_page.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "report/number_text.h"
#include "report/page.h"

namespace gonio::tools::develop {
namespace {

using photograph::LevelFigures;
using photograph::PlaneFigures;
using photograph::SensorFigure;
using photograph::SensorFigures;
using report::number_text;
using report::Series;

std::string text_of(const SensorFigure* f) {
  return f != nullptr ? report::with_sigma(f->value, f->sigma) + (f->unit == "1" ? "" : " " + f->unit) : "not known";
}
std::string decibels(const SensorFigure& f) {
  return number_text(20 * std::log10(f.value), 3) + " dB";
}

report::Plot transfer_plot(const PlaneFigures& p) {
  Series points{.kind = Series::Kind::points, .name = "exposures"}, line{.name = "K (mean)"};
  for (const LevelFigures& level : p.lit) points.x.push_back(level.mean), points.y.push_back(level.temporal);
  const double k = p.find("system gain")->value;
  line.x = {0, 0.7 * p.saturation}, line.y = {0, k * 0.7 * p.saturation};
  return {.title = "Photon transfer",
          .caption =
              "Temporal variance less that of dark frames. The line ends at 70 % of saturation, which is as far "
              "as it is fitted.",
          .x_label = "mean above dark / code",
          .y_label = "temporal variance above dark / code^2",
          .series = {points, line},
          .marks = {{report::Mark::Axis::x, p.saturation, "saturation"}}};
}

report::Plot linearity_plot(const PlaneFigures& p) {
  Series points{.kind = Series::Kind::points};
  for (const LevelFigures& level : p.lit)
    if (level.off_line != 0) points.x.push_back(level.mean), points.y.push_back(100 * level.off_line);
  return {.title = "Linearity",
          .caption = "From 5 to 95 % of saturation, against the line of least relative deviations.",
          .x_label = "mean above dark / code",
          .y_label = "off the line / %",
          .series = {points},
          .marks = {{report::Mark::Axis::y, 0, "line"}}};
}

// Root of the mean power over periods per sample, 0 to 1/2.
report::Plot spectrogram(const char* title, const char* unit, const photograph::Spectrum& rows,
                         const photograph::Spectrum& columns, double white) {
  const auto series = [](const char* name, const photograph::Spectrum& s) {
    Series line{.name = name};
    for (std::size_t k = 0; k < s.size(); ++k) {
      line.x.push_back(0.5 * static_cast<double>(k + 1) / static_cast<double>(s.size()));
      line.y.push_back(s[k]);
    }
    return line;
  };
  double least = white, most = white;
  for (const auto* spectrum : {&rows, &columns})
    for (const double v : *spectrum) least = std::min(least, v), most = std::max(most, v);
  const bool decades = most > 20 * least;
  return {.title = title,
          .caption = "Root of the mean power; noise without correlation is flat.",
          .x_label = "frequency / (periods per sample)",
          .y_label = std::string("amplitude / ") + unit,
          .series = {series("along rows", rows), series("along columns", columns)},
          .marks = {{report::Mark::Axis::y, white, "temporal noise"}},
          .log_y = decades,
          .zero_y = !decades};
}

void add_plane(report::Page& page, const PlaneFigures& p) {
  report::TableText table;
  table.columns = {{"Figure", "", false}, {"Value"}, {"95 % from"}, {"to"}, {"Unit", "", false},
                   {"Meaning", "", false}};
  for (const SensorFigure& f : p.figures) {
    const bool ratio = f.name == "SNR max" || f.name == "dynamic range";
    table.rows.push_back({f.name, report::with_sigma(f.value, f.sigma), report::value_for_sigma(f.lower, f.sigma),
                          report::value_for_sigma(f.upper, f.sigma), f.unit == "1" ? "" : f.unit,
                          f.meaning + (ratio ? "; " + decibels(f) : "")});
  }
  table.caption = format(
      "Sigmas by a jackknife over %d tiles. Of the dark variance of %.4g code^2, rounding to codes is "
      "%.4g, and is taken off. PRNU is of the exposure at %.0f %% of saturation.",
      photograph::tiles_across * photograph::tiles_across, p.dark_temporal, p.rounding, 100 * p.half / p.saturation);
  page.table(table);
  if (!p.left_out.empty()) page.note("Not told by this series:"), page.list(p.left_out);
  std::vector<report::Plot> plots{transfer_plot(p)};
  if (p.find("linearity error") != nullptr) plots.push_back(linearity_plot(p));
  page.plots(plots);
  page.plots({spectrogram("Pattern without light", "e", p.dark_rows, p.dark_columns, p.dark_white),
              spectrogram("Pattern in light", "% of the mean", p.lit_rows, p.lit_columns, p.lit_white)});
  page.open_details("Exposures of " + p.name);
  report::TableText levels;
  levels.columns = {{"Frames", "", false},
                    {"Exposure", "s"},
                    {"Mean", "code"},
                    {"Temporal variance", "code^2"},
                    {"Spatial variance", "code^2"}};
  for (const auto* list : {&p.dark, &p.lit})
    for (const LevelFigures& level : *list)
      levels.rows.push_back({list == &p.dark ? "dark" : "lit, above dark", number_text(level.exposure_s, 5),
                             number_text(level.mean, 6), number_text(level.temporal, 5),
                             number_text(level.spatial, 5)});
  page.table(levels);
  page.close_details();
}

}  // namespace

std::string sensor_page(const SensorFigures& figures) {
  const PlaneFigures& first = figures.planes.front();
  report::Page page(
      "Sensor",
      "K is " + text_of(first.find("system gain")) + ", read noise " + text_of(first.find("read noise")) +
          ", full well " + text_of(first.find("full well")) + ".",
      format("%d x %d samples after EMVA Standard 1288, release 4.0, linear model%s.", figures.width, figures.height,
             figures.planes.size() > 1 ? "; the headline is that of the first colour" : ""));
  for (const PlaneFigures& p : figures.planes) {
    page.section(p.name == "Y" ? "All samples" : "Samples " + p.name);
    add_plane(page, p);
  }
  page.section("Remarks");
  page.list(
      {"Figures are in electrons. Photons need the quantum efficiency, which frames alone do not tell.",
       "In light, what is coarser than an eighth of the picture is taken for the lamp, not for the sensor's "
       "pattern.",
       "The linearity error of a linear sensor is not 0: it is a mean of absolute deviations, to which noise adds.",
       "The full well is where the variance is largest. Samples differ in sensitivity, so that it lies a little "
       "below the clipping level."});
  page.footer(
      format("For develop --merge: --noise-gain %.5g --read-noise %.5g.", figures.codes.gain, figures.codes.read));
  return page.html();
}

std::string sensor_csv(const SensorFigures& figures) {
  std::string csv = "plane,figure,unit,value,sigma,lower,upper\n";
  for (const PlaneFigures& p : figures.planes)
    for (const SensorFigure& f : p.figures) {
      csv += p.name + "," + f.name + "," + f.unit;
      for (const double v : {f.value, f.sigma, f.lower, f.upper}) csv += "," + shortest_text(v);
      csv += "\n";
    }
  return csv;
}

}  // namespace gonio::tools::develop

#include "tools/compare/page.h"

#include <algorithm>
#include <cmath>

#include "io/picture.h"
#include "metric/difference_pictures.h"
#include "report/colour_map.h"
#include "report/number_text.h"
#include "report/page.h"

namespace gonio::tools::compare {

using namespace gonio::metric;

namespace {

using report::Figure;
using report::hex;
using report::KeyNumber;
using report::magnitude_colour;
using report::Mark;
using report::number_text;
using report::Page;
using report::percent_text;
using report::Plot;
using report::Series;
using report::sigma_text;
using report::signed_colour;
using report::TableText;
using report::Tone;
using report::value_for_sigma;
using report::with_sigma;

std::string text_of(const std::optional<Estimate>& e) {
  return e ? with_sigma(e->value, e->sigma) : "\u2013";
}

KeyNumber key(const std::string& label, const std::optional<Estimate>& e, const std::string& note) {
  if (!e) return {label, "\u2013", "", "not defined for this image"};
  return {label, value_for_sigma(e->value, e->sigma), sigma_text(e->value, e->sigma), note};
}

std::vector<KeyNumber> key_numbers(const Measures& m, const Limits& limits) {
  const auto judged = [](KeyNumber number, const std::optional<Estimate>& e, const std::optional<double>& limit,
                         bool upper) {
    if (!limit) return number;
    const bool passed = e && (upper ? e->value <= *limit : e->value >= *limit);
    number.tone = passed ? Tone::good : Tone::bad;
    number.note = std::string(upper ? "limit: at most " : "limit: at least ") + number_text(*limit, 4);
    return number;
  };
  std::vector<KeyNumber> numbers{
      judged(key("RMSE", m.rmse, "in the photograph\u2019s unit"), m.rmse, limits.max_rmse, true),
      judged(key("Relative RMSE", m.relative_rmse, "over the photograph\u2019s rms"), m.relative_rmse,
             limits.max_relative_rmse, true),
      judged(key("log10 error", m.log10_error, "mean of log10 |difference|"), m.log10_error, limits.max_log10_error,
             true),
      judged(key("SSIM", m.ssim, "data range " + number_text(m.data_range, 4)), m.ssim, limits.min_ssim, false)};
  if (m.z_rms) {
    numbers.push_back(judged(key("rms z", m.z_rms, "1 where only noise differs"), m.z_rms, limits.max_z_rms, true));
    numbers.push_back({"Share |z| > 3", percent_text(m.z_above_3->value, 2), "", "0.27 % where only noise differs"});
  }
  numbers.push_back(m.exposure_fitted ? key("Exposure scale", m.exposure_scale, "fitted, on the rendering")
                                      : KeyNumber{"Exposure scale", number_text(m.exposure_scale.value, 5), "",
                                                  "given, on the rendering"});
  numbers.push_back(
      {"Pixels", std::to_string(m.pixels), "", m.clipped > 0 ? std::to_string(m.clipped) + " clipped" : "that count"});
  return numbers;
}

// Counts in equal bins from -limit to limit; what lies beyond goes into the end bins.
Series histogram(const std::vector<float>& values, double limit, int bins) {
  Series series{.kind = Series::Kind::bars};
  series.y.assign(static_cast<std::size_t>(bins), 0);
  for (int i = 0; i <= bins; ++i) series.edges.push_back(-limit + 2 * limit * i / bins);
  double total = 0;
  for (const float v : values) {
    if (!std::isfinite(v)) continue;
    const int bin = std::clamp(static_cast<int>(std::floor((v + limit) / (2 * limit) * bins)), 0, bins - 1);
    series.y[static_cast<std::size_t>(bin)] += 1;
    total += 1;
  }
  for (double& n : series.y) n /= std::max(total, 1.0);
  return series;
}

Plot difference_histogram(const Differences& d, double limit) {
  Plot plot;
  plot.title = "Signed difference";
  plot.caption =
      "Share of samples per bin; the end bins hold what lies beyond. Logarithmic, so that few bad samples show.";
  plot.x_label = "rendering \u2212 photograph / photograph\u2019s unit";
  plot.y_label = "share of samples";
  plot.log_y = true;
  plot.series = {histogram(d.signed_difference, limit, 61)};
  plot.marks = {{Mark::Axis::x, 0, ""}};
  plot.x_range = {-limit, limit};
  return plot;
}

Plot z_histogram(const Differences& d) {
  constexpr double limit = 6;
  constexpr int bins = 48;
  Plot plot;
  plot.title = "z-scores";
  plot.caption = "Against the normal law that holds where rendering and photograph differ by noise alone.";
  plot.x_label = "difference / its standard deviation";
  plot.y_label = "share of samples";
  plot.log_y = true;
  plot.series = {histogram(d.z, limit, bins), {.kind = Series::Kind::line, .name = "normal law"}};
  plot.series[0].name = "samples";
  for (int i = 0; i <= 120; ++i) {
    const double z = -limit + 2 * limit * i / 120;
    const double share = std::exp(-z * z / 2) / std::sqrt(2 * 3.14159265358979323846) * 2 * limit / bins;
    plot.series[1].x.push_back(z);
    plot.series[1].y.push_back(share < 1e-6 ? std::nan("") : share);
  }
  plot.x_range = {-limit, limit};
  return plot;
}

std::vector<std::string> ramp(bool diverging) {
  std::vector<std::string> colours;
  for (int i = 0; i <= 10; ++i)
    colours.push_back(hex(diverging ? signed_colour(i / 5.0 - 1) : magnitude_colour(i / 10.0)));
  return colours;
}

void add_difference_pictures(Page& page, const Overlay& o, const Differences& d, const DisplayTone& tone,
                             const Measures& m) {
  const std::string white = number_text(tone.difference, 3);
  page.subsection("Where they differ, and which way");
  std::vector<Figure> figures{
      {.png = io::encode_png(signed_map(o, d, tone.difference)),
       .title = "Signed difference",
       .caption = "Red: rendering too bright. Blue: too dark. Full colour at \u00b1" + white + "."},
      {.png = io::encode_png(log_map(o, d, tone, m.log_floor)),
       .title = "log10 error",
       .caption = "From " + number_text(tone.log_range[0], 3) + " (dark) to " + number_text(tone.log_range[1], 3) +
                  " (bright)."}};
  if (!d.z.empty())
    figures.push_back({.png = io::encode_png(z_map(o, d)),
                       .title = "z-score",
                       .caption = "Difference over its noise, channels joined. Full colour at \u00b14."});
  page.figures(figures);
  page.colour_scale({"Signed difference, mean of the channels",
                     "photograph\u2019s unit",
                     ramp(true),
                     {"\u2212" + white, "0", "+" + white}});
  page.colour_scale({"log10 of the mean |difference|",
                     "",
                     ramp(false),
                     {number_text(tone.log_range[0], 3), number_text((tone.log_range[0] + tone.log_range[1]) / 2, 3),
                      number_text(tone.log_range[1], 3)}});
  page.open_details("Positive and negative parts, in colour");
  page.figures({{.png = io::encode_png(positive_part(o, d, tone.difference)),
                 .title = "Rendering too bright",
                 .caption = "Positive part, gamma 2.2, white at " + white + "."},
                {.png = io::encode_png(negative_part(o, d, tone.difference)),
                 .title = "Rendering too dark",
                 .caption = "Negative part, gamma 2.2, white at " + white + "."}});
  page.close_details();
}

void add_image(Page& page, const Compared& image, const Limits& limits) {
  const Overlay& o = image.overlay;
  const Measures& m = image.measures;
  const Differences d = differences(o, m.exposure_scale.value);
  const DisplayTone tone = display_tone(o, d, m);
  page.section(o.name);
  if (!image.violations.empty()) page.list(image.violations);
  page.key_numbers(key_numbers(m, limits));
  page.slider(
      {.png = io::encode_png(display(o, Which::photograph, m.exposure_scale.value, tone.white)), .title = "Photograph"},
      {.png = io::encode_png(display(o, Which::rendering, m.exposure_scale.value, tone.white)), .title = "Rendering"},
      "Drag, or use the arrow keys. Both with the same tone: a linear value of " + number_text(tone.white, 3) +
          " is shown as white, sRGB curve, clipped above.");
  add_difference_pictures(page, o, d, tone, m);
  page.subsection("How the differences are distributed");
  std::vector<Plot> plots{difference_histogram(d, tone.difference)};
  if (m.z_rms) plots.push_back(z_histogram(d));
  page.plots(plots);
}

void add_overview(Page& page, const std::vector<Compared>& images) {
  page.section("All images");
  TableText table;
  table.columns = {{"Image", "", false},  {"Exposure scale", ""}, {"RMSE", ""},
                   {"Relative RMSE", ""}, {"log10 error", ""},    {"SSIM", ""},
                   {"rms z", ""},         {"|z| > 3", ""},        {"Pixels", ""}};
  Plot plot;
  plot.title = "Relative RMSE by image";
  plot.x_label = "image, in the order of the table";
  plot.y_label = "relative RMSE";
  plot.zero_y = true;
  Series series{.kind = Series::Kind::points};
  for (std::size_t i = 0; i < images.size(); ++i) {
    const Measures& m = images[i].measures;
    table.rows.push_back({images[i].overlay.name,
                          m.exposure_fitted ? with_sigma(m.exposure_scale.value, m.exposure_scale.sigma)
                                            : number_text(m.exposure_scale.value, 5),
                          text_of(m.rmse), text_of(m.relative_rmse), text_of(m.log10_error), text_of(m.ssim),
                          text_of(m.z_rms), m.z_above_3 ? percent_text(m.z_above_3->value, 2) : "\u2013",
                          std::to_string(m.pixels)});
    if (!m.relative_rmse) continue;
    series.x.push_back(static_cast<double>(i + 1));
    series.y.push_back(m.relative_rmse->value);
    series.sigma.push_back(m.relative_rmse->sigma);
  }
  page.table(table);
  if (series.x.size() > 1) {
    plot.series = {series};
    plot.caption = "Bars: one standard error.";
    page.plot(plot);
  }
}

void add_definitions(Page& page, const std::vector<Compared>& images) {
  page.section("What the numbers mean");
  const Measures& m = images.front().measures;
  page.list(
      {"Difference d = scale \u00d7 rendering \u2212 photograph, both linear, over the channels of all pixels that "
       "count.",
       "RMSE: square root of the mean of d\u00b2, in the photograph\u2019s unit. Relative RMSE: RMSE over the root "
       "mean square of the photograph.",
       "log10 error: mean of log10 max(|d|, floor); the floor is 1e-4 of the photograph\u2019s root mean square (" +
           number_text(m.log_floor, 3) + " in " + images.front().overlay.name + ").",
       "SSIM: Wang et al. 2004, 11 \u00d7 11 Gaussian window of 1.5 px, complete windows only, on linear values with "
       "the stated data range.",
       "z: d over its standard deviation, from the rendering\u2019s variance and the photograph\u2019s noise at the "
       "predicted value.",
       "\u00b1: one standard error, delete-one-block jackknife over blocks of " + std::to_string(m.block_px) +
           " px: how far another picture of a like scene might be off; for the exposure scale the sandwich estimate "
           "over the same blocks."});
}

std::string headline(const std::vector<Compared>& images, std::size_t failed) {
  const bool one = images.size() == 1;
  if (failed > 0) {
    if (one) return "The rendering fails: " + images[0].violations[0] + ".";
    return std::to_string(failed) + " of " + std::to_string(images.size()) +
           " renderings fail what was demanded of them.";
  }
  double lower = 1e300, upper = 0;
  for (const auto& image : images) {
    if (!image.measures.relative_rmse) return "Rendering and photograph were compared; the photograph is black.";
    lower = std::min(lower, image.measures.relative_rmse->value);
    upper = std::max(upper, image.measures.relative_rmse->value);
  }
  if (one) return "Rendering and photograph differ by " + percent_text(upper, 1) + " of the photograph\u2019s rms.";
  return std::to_string(images.size()) + " renderings differ from their photographs by " + percent_text(lower, 1) +
         " to " + percent_text(upper, 1) + " of the photograph\u2019s rms.";
}

}  // namespace

std::string comparison_page(const std::vector<Compared>& images, const Limits& limits) {
  const auto failed =
      static_cast<std::size_t>(std::ranges::count_if(images, [](const Compared& c) { return !c.violations.empty(); }));
  const bool limited =
      limits.max_rmse || limits.max_relative_rmse || limits.max_log10_error || limits.max_z_rms || limits.min_ssim;
  Page page("Comparison of rendering and photograph", headline(images, failed),
            limited ? "The limits that were set stand beside the numbers they hold for." : "No limits were set.",
            failed > 0 ? Tone::bad
            : limited  ? Tone::good
                       : Tone::neutral);
  if (images.size() > 1) add_overview(page, images);
  for (const auto& image : images) add_image(page, image, limits);
  add_definitions(page, images);
  page.footer("compare, gonio " GONIO_VERSION ". This page is one file and loads nothing.");
  return page.html();
}

}  // namespace gonio::tools::compare

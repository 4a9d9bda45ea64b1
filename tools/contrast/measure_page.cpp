// The page of `contrast measure` (contrast/measure_page.h).
#include "tools/contrast/measure_page.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "contrast/measure/measure_maps.h"
#include "io/picture.h"
#include "report/colour_map.h"
#include "report/number_text.h"
#include "report/page.h"

namespace gonio::tools::contrast {

using namespace gonio::contrast;

namespace {

using report::Figure;
using report::KeyNumber;
using report::number_text;
using report::Page;
using report::percent_text;
using report::Plot;
using report::Series;
using report::TableText;
using report::Tone;
using report::with_sigma;

constexpr double deg = 180 / pi, mm = 1e3;

std::string signed_text(metric::Estimate e) {
  return (e.value > 0 ? "+" : "") + with_sigma(e.value, e.sigma);
}

// Pairs of the same view whose contrast has either sign, both clearly.
std::size_t inverted_views(const Measured& m) {
  std::size_t count = 0;
  for (const Turn& turn : m.turns) {
    const auto a = m.views[turn.before].michelson, b = m.views[turn.after].michelson;
    count += a.value * b.value < 0 && std::abs(a.value) > 2 * a.sigma && std::abs(b.value) > 2 * b.sigma;
  }
  return count;
}

bool inverts(const Measured& m) {
  return !m.turns.empty() && inverted_views(m) == m.turns.size();
}

std::string cell_name(const CellPattern& pattern, std::size_t cell) {
  const auto wide = static_cast<std::size_t>(pattern.columns);
  return "row " + std::to_string(cell / wide) + ", column " + std::to_string(cell % wide);
}

std::vector<KeyNumber> key_numbers(const Measured& m) {
  std::vector<KeyNumber> numbers;
  for (int k = 0; k < 2; ++k) {
    const auto mean = m.mean_michelson(k);
    const auto views = std::ranges::count(m.views, k, &MeasuredView::placement);
    numbers.push_back({"Contrast, " + m.placement[static_cast<std::size_t>(k)],
                       report::value_for_sigma(mean.value, mean.sigma), report::sigma_text(mean.value, mean.sigma),
                       "Michelson, mean of " + std::to_string(views) + " views"});
  }
  double worst = 1, best = 0;
  for (const MeasuredView& view : m.views) {
    worst = std::min(worst, view.right);
    best = std::max(best, view.right);
  }
  numbers.push_back({"Cells told apart", percent_text(best, 1), "",
                     "in the best view, by a threshold half way; " + percent_text(worst, 1) + " in the worst"});
  const std::size_t bad = m.defects.found.size();
  numbers.push_back({"Defective cells", std::to_string(bad), "of " + std::to_string(m.pattern.cells()),
                     "any false alarm: " + percent_text(m.defects.alarm_rate, 0), bad == 0 ? Tone::good : Tone::bad});
  if (m.code)
    numbers.push_back({"Data matrix", "\u201c" + m.code->text + "\u201d", "",
                       std::to_string(m.code->wrong_modules) + " modules wrong; read alone in " +
                           std::to_string(m.code->views_read) + " of " + std::to_string(m.views.size()) + " views",
                       Tone::good});
  if (m.turn_rad)
    numbers.push_back({"Turn", number_text(*m.turn_rad * deg, 4), "deg", "clockwise as seen, between the two poses"});
  return numbers;
}

// Views without a pose stand at their number.
double x_of(const Measured& m, std::size_t v, bool angles) {
  if (angles) return m.views[v].along_rad * deg;
  std::size_t before = 0;
  for (std::size_t k = 0; k < v; ++k) before += m.views[k].placement == m.views[v].placement;
  return static_cast<double>(before + 1);
}

void order(Series& s) {
  std::vector<std::size_t> by(s.x.size());
  for (std::size_t i = 0; i < by.size(); ++i) by[i] = i;
  std::ranges::sort(by, {}, [&](std::size_t i) { return s.x[i]; });
  Series sorted = s;
  for (std::size_t i = 0; i < by.size(); ++i) {
    sorted.x[i] = s.x[by[i]];
    sorted.y[i] = s.y[by[i]];
    if (!s.sigma.empty()) sorted.sigma[i] = s.sigma[by[i]];
  }
  s = sorted;
}

void add_series(Plot& plot, Series points, int style) {
  points.style = style;
  order(points);
  Series line = points;
  line.kind = Series::Kind::line;
  line.name.clear();
  line.sigma.clear();
  plot.series.push_back(line);
  plot.series.push_back(std::move(points));
}

std::vector<Plot> curves(const Measured& m) {
  const bool angles = std::ranges::none_of(m.views, [](const MeasuredView& v) { return std::isnan(v.along_rad); });
  const std::string axis = angles ? "camera angle / degrees" : "view, in the order of the table";
  Plot contrast{.title = "Contrast of the pattern",
                .caption = "(s1 \u2212 s2) / (s1 + s2): s1 of cells of bit 1, s2 of bit 0. Bars: one sigma.",
                .x_label = axis,
                .y_label = "Michelson contrast"};
  for (int k = 0; k < 2; ++k) {
    Series points{.kind = Series::Kind::points, .name = m.placement[static_cast<std::size_t>(k)]};
    for (std::size_t v = 0; v < m.views.size(); ++v) {
      if (m.views[v].placement != k) continue;
      points.x.push_back(x_of(m, v, angles));
      points.y.push_back(m.views[v].michelson.value);
      points.sigma.push_back(m.views[v].michelson.sigma);
    }
    add_series(contrast, points, k);
  }
  contrast.marks = {{report::Mark::Axis::y, 0, ""}};
  if (m.turns.empty()) return {contrast};
  Plot turn{.title = "The same cells before and after the turn",
            .caption = "(before \u2212 after) / (before + after), in the same view. Bars: one sigma.",
            .x_label = axis,
            .y_label = "contrast of the turn"};
  for (std::size_t bit = 0; bit < 2; ++bit) {
    Series points{.kind = Series::Kind::points, .name = "cells of bit " + std::to_string(bit)};
    for (const Turn& t : m.turns) {
      points.x.push_back(x_of(m, t.before, angles));
      points.y.push_back(t.michelson[bit].value);
      points.sigma.push_back(t.michelson[bit].sigma);
    }
    add_series(turn, points, 2 + static_cast<int>(bit));
  }
  turn.marks = contrast.marks;
  return {contrast, turn};
}

std::vector<std::string> ramp(bool diverging) {
  std::vector<std::string> colours;
  for (int i = 0; i <= 10; ++i)
    colours.push_back(report::hex(diverging ? report::signed_colour(i / 5.0 - 1) : report::magnitude_colour(i / 10.0)));
  return colours;
}

void add_maps(Page& page, const Measured& m) {
  page.section("Cells");
  std::vector<Figure> figures{{.png = io::encode_png(pattern_map(m)),
                               .title = "Pattern",
                               .caption = std::string(m.bits_found ? "Found in the pictures" : "As stated") +
                                          "; white: bit 1. Upright in the sample\u2019s own frame."}};
  if (!m.turns.empty())
    figures.push_back({.png = io::encode_png(turn_map(m)),
                       .title = "Contrast of the turn",
                       .caption = "Mean over the views; red: brighter before, blue: after. Defects are framed."});
  figures.push_back({.png = io::encode_png(distance_map(m)),
                     .title = "Distance from the class",
                     .caption = "Over all views together, in root mean square scatters. Defects are framed."});
  page.figures(figures, 300);
  page.colour_scale({"contrast of the turn",
                     "",
                     ramp(true),
                     {"\u2212" + number_text(turn_limit(m), 2), "0", "+" + number_text(turn_limit(m), 2)}});
  page.colour_scale({"distance",
                     "",
                     ramp(false),
                     {"0", number_text(m.defects.limit, 3) + " (limit)", number_text(2 * m.defects.limit, 3)}});
}

void add_defects(Page& page, const Measured& m) {
  page.section("Defects");
  const Defects& d = m.defects;
  if (d.found.empty()) {
    page.paragraph("No cell behaves unlike its class.");
  } else {
    TableText table{.columns = {{"Cell", "", false},
                                {"Bit"},
                                {"Distance"},
                                {"p"},
                                {"Brighter in", "views"},
                                {"Darker in", "views"},
                                {"Most in", "", false},
                                {"by", "scatters"}}};
    for (const CellDefect& f : d.found)
      table.rows.push_back(
          {cell_name(m.pattern, f.cell), std::to_string(m.pattern.bits[f.cell]), number_text(f.distance, 3),
           (f.p <= 2.5 / (d.draws + 1) ? "\u2264 " : "") + number_text(f.p, 2), std::to_string(f.brighter),
           std::to_string(f.darker), m.views[f.view].image, number_text(f.deviation, 3)});
    table.caption = "p: how often a sample without defects has any cell as far, by " + std::to_string(d.draws) +
                    " simulated samples. Brighter, darker: by more than three scatters of its class.";
    page.table(table);
  }
  page.note("Cells from a distance of " + number_text(d.limit, 3) +
            " on are called defects: on a sample without any, this " + "finds one or more in " +
            percent_text(d.alarm_rate, 0) + " of all measurements, where sound cells scatter " +
            "normally. Widening of that scatter for the bulk of the cells: " + number_text(d.widening[0], 3) +
            " (bit 0), " + number_text(d.widening[1], 3) + " (bit 1).");
}

void add_views(Page& page, const Measured& m) {
  page.section("Views");
  for (int k = 0; k < 2; ++k) {
    page.subsection(m.placement[static_cast<std::size_t>(k)]);
    std::vector<Figure> figures;
    for (std::size_t v = 0; v < m.views.size(); ++v)
      if (m.views[v].placement == k)
        figures.push_back({.png = io::encode_png(view_map(m, v)),
                           .title = m.views[v].image,
                           .caption = signed_text(m.views[v].michelson)});
    page.figures(figures, 110);
  }
  page.open_details("Numbers of every view");
  TableText table{.columns = {{"Image", "", false},
                              {"Placement", "", false},
                              {"Tilt", "deg"},
                              {"Azimuth", "deg"},
                              {"s1"},
                              {"s2"},
                              {"Difference"},
                              {"Michelson"},
                              {"Right cells"},
                              {"Place", "px"},
                              {"Cell", "px"}}};
  for (const MeasuredView& v : m.views)
    table.rows.push_back({v.image, m.placement[static_cast<std::size_t>(v.placement)], number_text(v.tilt_rad * deg, 3),
                          number_text(v.azimuth_rad * deg, 3), with_sigma(v.bright.value, v.bright.sigma),
                          with_sigma(v.dark.value, v.dark.sigma), with_sigma(v.difference.value, v.difference.sigma),
                          signed_text(v.michelson), percent_text(v.right, 1), "\u00b1 " + number_text(v.place_px, 2),
                          number_text(v.means.cell_px, 3)});
  table.caption =
      "s1, s2: mean radiance of the cells of bit 1 and 0, of smooth functions through each class over the whole "
      "pattern, in the pictures\u2019 unit. Tilt and azimuth of the camera, azimuth from the pattern\u2019s "
      "columns, anticlockwise as seen.";
  page.table(table);
  page.close_details();
}

void add_places(Page& page, const Measured& m) {
  if (!m.pose[0] && !m.pose[1]) return;
  page.section("Where the sample lay");
  TableText table{.columns = {{"Placement", "", false},
                              {"x", "mm"},
                              {"y", "mm"},
                              {"z", "mm"},
                              {"Largest angle sigma", "deg"},
                              {"Marks"},
                              {"Images"},
                              {"rms", "px"},
                              {"chi\u00b2 / degrees"}}};
  for (std::size_t k = 0; k < 2; ++k) {
    if (!m.pose[k]) continue;
    const SamplePose& p = *m.pose[k];
    const Vec2 size = m.pattern.size_m();
    const Vec3 t = p.world_from_pattern * Vec3{size.x / 2, size.y / 2, 0};
    const auto sigma = [&](std::size_t i) { return std::sqrt(p.covariance[7 * i]); };
    table.rows.push_back({m.placement[k], with_sigma(t.x * mm, sigma(3) * mm), with_sigma(t.y * mm, sigma(4) * mm),
                          with_sigma(t.z * mm, sigma(5) * mm),
                          number_text(std::max({sigma(0), sigma(1), sigma(2)}) * deg, 2),
                          p.stated ? "stated" : std::to_string(p.marks), p.stated ? "" : std::to_string(p.images),
                          p.stated ? "" : number_text(p.rms_px, 2),
                          p.stated ? "" : number_text(p.chi2, 3) + " / " + std::to_string(p.degrees)});
  }
  table.caption =
      "Of the pattern\u2019s middle, in the world, from the marked corners and the cameras\u2019 stated poses, "
      "whose repeatability counts.";
  page.table(table);
}

}  // namespace

std::string measure_headline(const Measured& m) {
  const auto a = m.mean_michelson(0), b = m.mean_michelson(1);
  const std::size_t count = inverted_views(m);
  std::string text = "The contrast before and after the turn: ";
  if (inverts(m))
    text = "The turn inverts the contrast in every view: on the mean ";
  else if (count > 0)
    text = "The turn inverts the contrast in " + std::to_string(count) + " of " + std::to_string(m.turns.size()) +
           " views: on the mean ";
  else if (!m.turns.empty())
    text = "The turn inverts the contrast in no view: on the mean ";
  text += signed_text(a) + " " + m.placement[0] + ", " + signed_text(b) + " " + m.placement[1] + "; ";
  const std::size_t bad = m.defects.found.size();
  text += bad == 0 ? "no cell of " + std::to_string(m.pattern.cells()) + " is defective"
                   : std::to_string(bad) + " of " + std::to_string(m.pattern.cells()) +
                         (bad == 1 ? " cells is defective" : " cells are defective");
  if (m.code) text += "; the code says \u201c" + m.code->text + "\u201d";
  return text + ".";
}

std::string measure_page(const Measured& m, const MeasureOptions& options) {
  Page page("Measured contrast of " + m.pattern_name, measure_headline(m),
            "Pattern \u201c" + m.pattern_name + "\u201d, " + std::to_string(m.pattern.rows) + " rows of " +
                std::to_string(m.pattern.columns) + " cells, in " + std::to_string(m.views.size()) + " views.",
            inverts(m) && m.defects.found.empty() ? Tone::good : Tone::neutral);
  page.section("Contrast");
  page.key_numbers(key_numbers(m));
  page.plots(curves(m));
  add_maps(page, m);
  add_defects(page, m);
  add_views(page, m);
  add_places(page, m);
  if (!m.notes.empty() || !m.dropped.empty()) {
    page.section("Remarks");
    std::vector<std::string> lines = m.notes;
    for (const std::string& image : m.dropped) lines.push_back("Left out: " + image);
    page.list(lines);
  }
  page.section("What the numbers mean");
  page.list(
      {"A cell\u2019s mean is over the pixels in its inner " + percent_text(options.inner, 0) +
           " of width and height, or less where the uncertainty of the place asks for it.",
       "\u00b1: one standard deviation, from the scatter of the cells of a class about a smooth function of their "
       "place, and from laying the pattern one sigma of its place aside in the picture.",
       "A pattern of orientations changes its sign when it is turned by a quarter; paint keeps its sign."});
  page.footer("contrast measure, gonio " GONIO_VERSION ". This page is one file and loads nothing.");
  return page.html();
}

}  // namespace gonio::tools::contrast

// See page.h.
#include "tools/roughness/page.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "geom/angle.h"
#include "io/picture.h"
#include "relief/pictures.h"
#include "report/colour_map.h"
#include "report/number_text.h"
#include "report/page.h"

namespace gonio::tools::roughness {

using namespace gonio::relief;

namespace {

using report::number_text;
using report::Series;

constexpr double micro = 1e6;

void paint(io::Image& image, int x, int y, report::Colour colour) {
  for (int c = 0; c < 3; ++c) image.at(x, y, c) = colour[static_cast<std::size_t>(c)];
}

std::string figure_text(const Figure& f) {
  const double scale = f.unit == "m" ? micro : 1;
  return f.sigma ? report::with_sigma(f.value * scale, *f.sigma * scale) : number_text(f.value * scale, 4);
}

report::Plot heights_plot(const Measured& m) {
  constexpr int cells = 80;
  const auto [low, high] = range_of(m.surface.map);
  const double step = std::max(1e-15, (high - low) / cells), sq = m.roughness["Sq"].value;
  Series bars{.kind = Series::Kind::bars, .name = "measured"}, normal{.name = "normal distribution of the same Sq"};
  bars.y.resize(cells);
  double n = 0;
  for (const double z : m.surface.map.z_m)
    if (std::isfinite(z)) {
      bars.y[static_cast<std::size_t>(std::clamp(static_cast<int>((z - low) / step), 0, cells - 1))] += 1;
      n += 1;
    }
  for (double& y : bars.y) y /= n * step * micro;
  for (int i = 0; i <= cells; ++i) {
    const double z = low + i * step;
    bars.edges.push_back(z * micro);
    normal.x.push_back(z * micro);
    normal.y.push_back(std::exp(-0.5 * z * z / (sq * sq)) / (sq * micro * std::sqrt(2 * pi)));
  }
  return {.title = "Heights", .x_label = "height / um", .y_label = "density / (1/um)", .series = {bars, normal}};
}

// Density of slopes along one axis: the histogram's sums, and each fit's density summed over the same cells.
report::Plot slopes_plot(const Normals& n, bool along_x) {
  const double step = 2 * n.reach / n.side;
  const auto side = static_cast<std::size_t>(n.side);
  Series bars{.kind = Series::Kind::bars, .name = "measured"};
  bars.y.resize(side);
  for (std::size_t v = 0; v < side; ++v)
    for (std::size_t u = 0; u < side; ++u) bars.y[along_x ? u : v] += n.share[v * side + u] / step;
  for (int i = 0; i <= n.side; ++i) bars.edges.push_back(-n.reach + i * step);
  std::vector<Series> all{bars};
  for (const SlopeFit& fit : n.fits) {
    Series line{.name = fit.distribution == "ggx" ? "GGX" : "Beckmann"};
    for (int i = 0; i < n.side; ++i) {
      const double s = -n.reach + (i + 0.5) * step;
      double sum = 0;
      for (int j = 0; j < n.side; ++j) {
        const double t = -n.reach + (j + 0.5) * step;
        sum += step * (along_x ? fit.density(s, t) : fit.density(t, s));
      }
      line.x.push_back(s), line.y.push_back(sum);
    }
    all.push_back(line);
  }
  return {.title = along_x ? "Slopes along x" : "Slopes along y",
          .x_label = "slope / 1",
          .y_label = "density / 1",
          .series = all};
}

io::Image slopes_picture(const Normals& n) {
  io::Image image(n.side, n.side, {"R", "G", "B"});
  const double most = *std::max_element(n.share.begin(), n.share.end());
  for (int y = 0; y < n.side; ++y)
    for (int x = 0; x < n.side; ++x) {
      const double share = n.share[static_cast<std::size_t>((n.side - 1 - y) * n.side + x)];
      paint(image, x, y, report::magnitude_colour(share > 0 ? 1 + std::log10(share / most) / 3 : 0));
    }
  return image;
}

// "levelled by a plane; no filter; 12 of 4096 points missing, left out"
std::string treatment_text(const Measured& m) {
  const Treatment& t = m.treatment;
  std::string text = t.levelling == Levelling::none    ? "not levelled"
                     : t.levelling == Levelling::plane ? "levelled by a plane"
                                                       : "levelled by a polynomial of second order";
  if (t.s_filter_m > 0) text += "; S-filter " + number_text(t.s_filter_m * micro, 4) + " um";
  if (t.l_filter_m > 0) text += "; L-filter " + number_text(t.l_filter_m * micro, 4) + " um";
  if (t.s_filter_m <= 0 && t.l_filter_m <= 0) text += "; no filter";
  return text + "; " + std::to_string(m.surface.missing) + " of " + std::to_string(m.surface.map.z_m.size()) +
         " points missing, left out";
}

void add_figures(report::Page& page, const Measured& m) {
  report::TableText table;
  table.columns = {{"Parameter", "", false}, {"Value", "", true}, {"Unit", "", false}, {"Meaning", "", false}};
  for (const Figure& f : m.roughness.figures)
    table.rows.push_back({f.name, figure_text(f), f.unit == "m" ? "um" : "", f.meaning});
  table.caption = treatment_text(m) + ". Sigmas rest on " + number_text(m.roughness.independent_areas, 3) +
                  " independent areas" +
                  (m.roughness.long_waves ? ", and are too small: the surface has structure as long as the map."
                                          : ". Sz, Sp and Sv are extremes of this map.");
  page.table(table);
  report::TableText normals;
  normals.columns = {{"Distribution of normals", "", false},
                     {"alpha_u", ""},
                     {"alpha_v", ""},
                     {"azimuth of u", "deg"},
                     {"log-likelihood", "per slope"}};
  for (const SlopeFit& f : m.normals.fits)
    normals.rows.push_back(
        {f.distribution, report::with_sigma(f.alpha_u, f.sigma_alpha_u), report::with_sigma(f.alpha_v, f.sigma_alpha_v),
         report::with_sigma(f.azimuth_rad / degree, f.sigma_azimuth_rad / degree), number_text(f.log_likelihood, 4)});
  normals.caption = "The likelier first. Azimuths run counter-clockwise from the rows\u2019 direction.";
  page.table(normals);
}

}  // namespace

std::string roughness_page(const std::vector<Measured>& all) {
  const Measured& first = all.front();
  report::Page page("Roughness",
                    all.size() == 1 ? "Sq is " + figure_text(first.roughness["Sq"]) + " um, Sa " +
                                          figure_text(first.roughness["Sa"]) + " um."
                                    : std::to_string(all.size()) + " height maps",
                    "Areal parameters after ISO 25178-2, and the distribution of normals.");
  for (const Measured& m : all) {
    page.section(m.name);
    add_figures(page, m);
    const auto [low, high] = range_of(m.surface.map);
    page.figures(
        {{.png = io::encode_png(picture_of(m.surface.map)),
          .title = "Heights",
          .caption = number_text(low * micro, 3) + " (dark) to " + number_text(high * micro, 3) + " um; " +
                     number_text(micro * m.surface.map.step_x_m * static_cast<double>(m.surface.map.width), 4) +
                     " um wide"},
         {.png = io::encode_png(slopes_picture(m.normals)),
          .title = "Normals",
          .caption =
              "Share of the slopes, x to the right, y up, to " + number_text(m.normals.reach, 3) + "; three decades"}});
    page.plots({heights_plot(m), slopes_plot(m.normals, true), slopes_plot(m.normals, false)});
  }
  return page.html();
}

}  // namespace gonio::tools::roughness

// See plots.h.
#include "goniometry/plots.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/text.h"

namespace gonio::goniometry {
namespace {

constexpr double plane_sine = 0.0523;  // of 3 degrees
constexpr std::size_t fewest_in_a_scan = 5, most_scans = 5;
constexpr double most_zenith = 85 * pi / 180;

double degrees(double rad) {
  return rad * 180 / pi;
}

struct Scan {
  double theta_i = 0, phi_i = 0;
  std::vector<std::pair<double, std::size_t>> points;  // signed zenith, row
};

// Signed zenith in the plane of incidence of `theta_i`, `phi_i`: positive at the mirror direction.
Vec3 in_plane(double signed_zenith, double phi_i) {
  return {-std::sin(signed_zenith) * std::cos(phi_i), -std::sin(signed_zenith) * std::sin(phi_i),
          std::cos(signed_zenith)};
}

// Those with the most samples, spread over the incidences.
std::vector<Scan> scans_of(const Samples& s) {
  std::map<std::pair<long, long>, Scan> all;
  for (std::size_t r = 0; r < s.rows(); ++r) {
    const Vec3 wi = s.wi[r], wo = s.wo[r];
    const double across = std::hypot(wi.x, wi.y);
    const Vec3 t = across > 1e-6 ? Vec3{wi.x / across, wi.y / across, 0} : Vec3{1, 0, 0};
    const double along = wo.x * t.x + wo.y * t.y, off = wo.x * t.y - wo.y * t.x;
    if (std::abs(off) > plane_sine) continue;
    Scan& scan = all[{std::lround(wi.x * 500), std::lround(wi.y * 500)}];
    scan.theta_i = std::atan2(across, wi.z), scan.phi_i = std::atan2(t.y, t.x);
    scan.points.emplace_back(std::atan2(-along, wo.z), r);
  }
  std::map<long, Scan> by_incidence;  // one azimuth each
  for (auto& [key, scan] : all)
    if (Scan& best = by_incidence[std::lround(degrees(scan.theta_i))]; scan.points.size() > best.points.size())
      best = std::move(scan);
  std::vector<Scan> scans;
  for (auto& [key, scan] : by_incidence)
    if (scan.points.size() >= fewest_in_a_scan) scans.push_back(std::move(scan));
  std::vector<Scan> spread;
  const std::size_t n = std::min(most_scans, scans.size());
  for (std::size_t k = 0; k < n; ++k) spread.push_back(std::move(scans[n == 1 ? 0 : k * (scans.size() - 1) / (n - 1)]));
  for (Scan& scan : spread) std::ranges::sort(scan.points);
  return spread;
}

std::string incidence_text(double theta_i) {
  return format("%.3g\u00b0", degrees(theta_i));
}

report::Series fitted_line(const Outcome& outcome, const Scan& scan, std::size_t band, int style) {
  report::Series line{.kind = report::Series::Kind::line};
  line.style = style;
  const Vec3 wi = in_plane(-scan.theta_i, scan.phi_i);
  for (double zenith = -most_zenith; zenith <= most_zenith + 1e-9; zenith += pi / 360) {
    line.x.push_back(degrees(zenith));
    line.y.push_back(predicted(outcome, wi, in_plane(zenith, scan.phi_i), band));
  }
  return line;
}

report::Series measured_points(const Samples& s, const Scan& scan, std::size_t band, int style) {
  report::Series points{.kind = report::Series::Kind::points};
  points.style = style;
  for (const auto& [zenith, row] : scan.points) {
    points.x.push_back(degrees(zenith));
    points.y.push_back(s.f[row * s.bands() + band]);
    if (!s.sigma.empty()) points.sigma.push_back(s.sigma[row * s.bands() + band]);
  }
  return points;
}

// From f over the zenith to log10(1 + 100 f) around the normal; the largest distance.
double around_the_normal(report::Series& series) {
  double largest = 0;
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    const double zenith = series.x[i] * pi / 180, r = std::log10(1 + 100 * std::max(0.0, series.y[i]));
    series.x[i] = r * std::sin(zenith), series.y[i] = r * std::cos(zenith);
    if (std::isfinite(r)) largest = std::max(largest, r);
  }
  return largest;
}

std::string band_words(const Samples& s, std::size_t band) {
  return s.band_name[band].empty() ? "" : ", " + s.band_name[band];
}

}  // namespace

std::optional<report::Plot> scan_plot(const Outcome& outcome, std::size_t band) {
  const Samples& s = outcome.read.samples;
  const std::vector<Scan> scans = scans_of(s);
  if (scans.empty()) return {};
  report::Plot plot;
  plot.title = "Scans in the plane of incidence" + band_words(s, band);
  plot.caption = "Points: measured; lines: the surface. Positive zeniths lie on the side of the mirror direction.";
  plot.x_label = "zenith of the eye / deg", plot.y_label = "f / (1/sr)";
  plot.log_y = true;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    report::Series points = measured_points(s, scans[k], band, static_cast<int>(k));
    points.name = "light at " + incidence_text(scans[k].theta_i);
    plot.series.push_back(std::move(points));
    plot.series.push_back(fitted_line(outcome, scans[k], band, static_cast<int>(k)));
  }
  return plot;
}

report::Plot lobe_plot(const Outcome& outcome, std::size_t band) {
  const Samples& s = outcome.read.samples;
  std::vector<Scan> scans = scans_of(s);
  if (scans.empty())
    for (const double theta : {15.0, 45.0, 70.0}) scans.push_back({theta * pi / 180, 0, {}});
  report::Plot plot;
  plot.title = "Lobes around the normal" + band_words(s, band);
  plot.caption =
      "In the plane of incidence, points measured, lines the surface: distance from the origin is log10(1 + 100 f); "
      "the normal points up, the mirror direction lies to the right.";
  plot.x_label = "log10(1 + 100 f sr) along the plane", plot.y_label = "along the normal";
  double radius = 0.01;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    report::Series line = fitted_line(outcome, scans[k], band, static_cast<int>(k));
    line.name = "light at " + incidence_text(scans[k].theta_i);
    radius = std::max(radius, around_the_normal(line));
    plot.series.push_back(std::move(line));
    report::Series points = measured_points(s, scans[k], band, static_cast<int>(k));
    points.sigma.clear();
    radius = std::max(radius, around_the_normal(points));
    if (!points.x.empty()) plot.series.push_back(std::move(points));
  }
  plot.x_range = {-1.1 * radius, 1.1 * radius};
  plot.y_range = {0, 1.03 * radius};
  return plot;
}

report::HeatStrip residual_map(const Outcome& outcome) {
  const std::vector<double> half = {0, 2, 5, 10, 15, 20, 30, 40, 50, 60, 90};
  constexpr std::size_t rings = 9;  // of theta_d
  const std::size_t columns = half.size() - 1;
  std::vector<double> sum(rings * columns, 0), count(rings * columns, 0);
  const Samples& s = outcome.read.samples;
  for (std::size_t r = 0; r < s.rows(); ++r) {
    const Vec3 h = normalized(s.wi[r] + s.wo[r]);
    const double theta_h = degrees(std::acos(std::min(1.0, h.z)));
    const double theta_d = degrees(std::acos(std::clamp(dot(h, s.wi[r]), 0.0, 1.0)));
    const auto column = static_cast<std::size_t>(std::ranges::upper_bound(half, theta_h) - half.begin()) - 1;
    const auto row = std::min(rings - 1, static_cast<std::size_t>(theta_d / 10));
    if (column >= columns) continue;
    for (std::size_t b = 0; b < s.bands(); ++b) {
      const double f = s.f[r * s.bands() + b], model = predicted(outcome, s.wi[r], s.wo[r], b);
      if (!std::isfinite(f) || !std::isfinite(model)) continue;
      sum[row * columns + column] += compared(f, s.wi[r], s.wo[r]) - compared(model, s.wi[r], s.wo[r]);
      count[row * columns + column] += 1;
    }
  }
  report::HeatStrip map;
  map.title = "Where the surface errs";
  map.caption =
      "Mean of measured minus predicted, over cells of half angle (columns) and difference angle (rows). Blue: "
      "the sample is darker than the surface says; red: brighter. No number: no sample there.";
  map.label = "log(1 + 100 f cos cos), measured minus predicted";
  map.diverging = true;
  for (std::size_t c = 0; c < columns; ++c)
    map.columns.push_back("\u03b8h " + format("%g\u2013%g\u00b0", half[c], half[c + 1]));
  for (std::size_t row = 0; row < rings; ++row)
    map.rows.push_back("\u03b8d " + format("%zu\u2013%zu\u00b0", 10 * row, 10 * row + 10));
  for (std::size_t i = 0; i < sum.size(); ++i) map.values.push_back(count[i] > 0 ? sum[i] / count[i] : std::nan(""));
  return map;
}

std::string standalone_svg(const report::Plot& plot) {
  const std::vector<std::string> colours = {"#1f6fb4", "#c8322b", "#2b8a3e", "#8456b0", "#94602d", "#c2528b"};
  std::string head =
      "<style>text{font:12px sans-serif;fill:#222}.grid{stroke:#ddd;fill:none}.axis{stroke:#444;fill:none}";
  for (std::size_t i = 0; i < colours.size(); ++i)
    head += ".c" + std::to_string(i) + "{stroke:" + colours[i] + ";fill:" + colours[i] + "}";
  head += ".line,.error{fill:none;stroke-width:1.6}.band{opacity:.18;stroke:none}g{stroke:none}</style>";
  // The names of series stand in the line of the y axis's label, beside it.
  const auto names = std::ranges::count_if(plot.series, [](const auto& series) { return !series.name.empty(); });
  const double from = 64 + 6.5 * static_cast<double>(plot.y_label.size()),
               step = std::min(100.0, (560 - from) / std::max(1.0, static_cast<double>(names)));
  int named = 0;
  for (std::size_t k = 0; k < plot.series.size(); ++k) {
    const report::Series& series = plot.series[k];
    if (series.name.empty()) continue;
    const std::size_t colour = series.style < 0 ? k : static_cast<std::size_t>(series.style);
    head += format("<text x=\"%.0f\" y=\"14\" style=\"fill:%s\">", from + step * named++,
                   colours[colour % colours.size()].c_str()) +
            series.name + "</text>";
  }
  std::string drawing = report::svg(plot);
  drawing.insert(drawing.find('>') + 1, head);
  drawing.insert(4, " xmlns=\"http://www.w3.org/2000/svg\"");
  return drawing + "\n";
}

}  // namespace gonio::goniometry

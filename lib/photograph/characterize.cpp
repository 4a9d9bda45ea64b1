// See characterize.h.
#include "photograph/characterize.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "base/error.h"
#include "base/text.h"
#include "stats/distributions.h"

namespace gonio::photograph {
namespace {

constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
constexpr double transfer_to = 0.7;                     // of saturation (EMVA 1288, 6.6)
constexpr double linear_from = 0.05, linear_to = 0.95;  // of saturation (EMVA 1288, 6.7)
constexpr double beyond_noise = 5;                      // standard deviations of the mean that light is told by
constexpr double steadiest = 0.02;                      // frames of one exposure may differ by this much
constexpr double rounded_away = 0.24;                   // steps^2 of dark variance: below, rounding hides the noise
constexpr double noise_is_gone = 0.02;                  // of the largest variance
constexpr double no_noise = 1e-9;                       // codes^2
constexpr double cut_off = 0.005;                       // share of dark samples at the lowest code

// Of an exposure, over all tiles or all but one.
struct Moments {
  double t = 0, frames = 0, mean = 0, temporal = 0, fine = 0, total = 0;  // spatial: in tiles, over the picture
};
Moments moments(const SeriesLevel& level, std::size_t without) {
  TileSums all;
  for (std::size_t k = 0; k < level.tiles.size(); ++k) {
    if (k == without) continue;
    const TileSums& t = level.tiles[k];
    all.samples += t.samples, all.sum += t.sum, all.squares += t.squares, all.temporal += t.temporal;
    all.temporal_freedom += t.temporal_freedom, all.structure += t.structure;
    all.structure_freedom += t.structure_freedom;
  }
  Moments m{level.exposure_s, static_cast<double>(level.frames), all.sum / all.samples,
            all.temporal / all.temporal_freedom};
  m.fine = all.structure / all.structure_freedom - m.temporal / m.frames;
  m.total = (all.squares - all.sum * m.mean) / (all.samples - 1) - m.temporal / m.frames;
  return m;
}
std::vector<Moments> moments(const std::vector<SeriesLevel>& levels, std::size_t without) {
  std::vector<Moments> all;
  for (const SeriesLevel& level : levels) all.push_back(moments(level, without));
  return all;
}

// y = a + b x with weights.
struct Line {
  double a = 0, b = 0;
  double operator()(double x) const { return a + b * x; }
};
Line line(const std::vector<std::array<double, 3>>& x_y_weight) {
  double w = 0, wx = 0, wy = 0, wxx = 0, wxy = 0;
  for (const auto& [x, y, weight] : x_y_weight)
    w += weight, wx += weight * x, wy += weight * y, wxx += weight * x * x, wxy += weight * x * y;
  const double determinant = w * wxx - wx * wx;
  if (!(determinant > 1e-12 * w * wxx)) return {wy / w, 0};
  const double b = (w * wxy - wx * wy) / determinant;
  return {(wy - b * wx) / w, b};
}

// Numbers that the jackknife goes over; those that are roots as their squares.
enum Number : std::size_t {
  gain,
  read2_codes,
  read2,
  dark_by_mean,
  dark_by_variance,
  full_well,
  clip,
  snr,
  threshold,
  range,
  linearity,
  dsnu2,
  prnu2,
  numbers
};
using Numbers = std::array<double, numbers>;

// What is chosen from all tiles, and kept where one is left out.
struct Choice {
  std::vector<std::size_t> dark_of;           // for each lit exposure the dark one of the same time, or none
  std::vector<std::size_t> transfer, line;    // lit exposures of the photon transfer, of the linearity
  std::size_t brightest = none, full = none;  // at the largest variance; none: the series ends before
  std::size_t half = none;
  double gap = 0;  // codes: of one standard deviation by the exposures' distance there
  bool dark_line = false, light_line = false;
};

class Plane {
 public:
  explicit Plane(const SeriesPlane& plane) : p_(plane) {
    check();
    choose();
  }

  PlaneFigures run() {
    out_.name = p_.name;
    const Numbers all = numbers_without(none);
    if (!(all[gain] > 0))
      throw Error(Exit::data, p_.lit.front().name, "belongs to a series whose noise does not grow with the light",
                  "lit and dark frames of the same gain, and codes that are linear");
    std::vector<Numbers> parts;
    for (std::size_t k = 0; k < p_.lit.front().tiles.size(); ++k) parts.push_back(numbers_without(k));
    levels();
    tell(all, parts);
    spectra(all);
    return std::move(out_);
  }

 private:
  void check() const {
    if (p_.dark.empty())
      throw Error(Exit::data, p_.lit.empty() ? "series" : p_.lit.front().name, "has no dark frames beside it",
                  "two or more of one exposure at least (--dark)");
    if (p_.lit.empty()) throw Error(Exit::data, p_.dark.front().name, "has no lit frames beside it", "name them");
    // Full samples have no noise, be it below the full scale; what is darker than noisy ones has.
    const std::vector<Moments> lit = moments(p_.lit, none);
    double noisy = 0;
    for (const Moments& m : lit)
      if (m.temporal > no_noise) noisy = std::max(noisy, m.mean);
    for (std::size_t k = 0; k < lit.size(); ++k)
      if (p_.lit[k].share_full < 0.01 && !(lit[k].temporal > no_noise) && !(noisy > 0 && lit[k].mean > noisy))
        throw Error(Exit::data, p_.lit[k].name,
                    format("and the other frames of %g s have no noise", p_.lit[k].exposure_s),
                    "frames that are not copies of each other");
  }

  // Means and variances in time of dark frames at time t.
  struct Dark {
    double mean = 0, temporal = 0, fine = 0;
  };
  Dark dark_at(const std::vector<Moments>& dark, std::size_t of, double t) const {
    if (of != none) return {dark[of].mean, dark[of].temporal, dark[of].fine};
    if (!choice_.dark_line) return {dark[0].mean, dark[0].temporal, dark[0].fine};
    std::vector<std::array<double, 3>> mean, temporal, fine;
    for (const Moments& m : dark) {
      mean.push_back({m.t, m.mean, m.frames}), temporal.push_back({m.t, m.temporal, m.frames});
      fine.push_back({m.t, m.fine, m.frames});
    }
    return {line(mean)(t), line(temporal)(t), line(fine)(t)};
  }
  // Lit exposures above the dark.
  std::vector<Moments> above_dark(const std::vector<Moments>& dark, std::size_t without) const {
    std::vector<Moments> lit = moments(p_.lit, without);
    for (std::size_t k = 0; k < lit.size(); ++k) {
      const Dark d = dark_at(dark, choice_.dark_of[k], lit[k].t);
      lit[k].mean -= d.mean, lit[k].temporal -= d.temporal, lit[k].fine -= d.fine;
    }
    return lit;
  }

  void choose() {
    for (const SeriesLevel& level : p_.lit) {
      const auto same = std::ranges::find_if(p_.dark, [&](const SeriesLevel& d) {
        return std::abs(d.exposure_s - level.exposure_s) <= 1e-4 * level.exposure_s;
      });
      choice_.dark_of.push_back(same == p_.dark.end() ? none : static_cast<std::size_t>(same - p_.dark.begin()));
    }
    choice_.dark_line = p_.dark.size() > 1;
    const std::vector<Moments> dark = moments(p_.dark, none), lit = above_dark(dark, none);
    for (std::size_t k = 0; k < lit.size(); ++k) check_light(p_.lit[k], lit[k], dark[0]);
    choose_brightest(lit);
    out_.saturation = choice_.brightest != none      ? lit[choice_.brightest].mean
                      : std::isfinite(p_.full_scale) ? p_.full_scale - dark[0].mean
                                                     : lit.back().mean;
    for (std::size_t k = 0; k < lit.size(); ++k) {
      const double share = lit[k].mean / out_.saturation;
      if (p_.lit[k].share_full > 0.01) continue;
      if (share <= transfer_to) choice_.transfer.push_back(k);
      if (share >= linear_from && share <= linear_to) choice_.line.push_back(k);
      if (choice_.half == none || std::abs(share - 0.5) < std::abs(lit[choice_.half].mean / out_.saturation - 0.5))
        choice_.half = k;
    }
    if (choice_.transfer.size() < 2)
      throw Error(Exit::data, p_.lit.front().name,
                  format("belongs to a series with %zu exposures up to 70 %% of saturation", choice_.transfer.size()),
                  "two at least, shorter ones");
    choice_.light_line = choice_.line.size() > 2;
    out_.half = lit[choice_.half].mean;
  }

  static void check_light(const SeriesLevel& level, const Moments& lit, const Moments& dark) {
    double samples = 0;
    for (const TileSums& t : level.tiles) samples += t.samples;
    // lit.temporal is above the dark.
    const double noise = std::sqrt((std::max(0.0, lit.temporal) + 2 * dark.temporal) / samples);
    if (!(lit.mean > beyond_noise * noise))
      throw Error(Exit::data, level.name,
                  format("is no brighter than dark frames: %.3g codes above them, with noise of %.2g", lit.mean, noise),
                  "light, and the same black for all frames");
    if (level.drift > steadiest * lit.mean)
      throw Error(Exit::data, level.name,
                  format("and the other frames of %g s differ in brightness by %.3g %%, more than %g %%",
                         level.exposure_s, 100 * level.drift / lit.mean, 100 * steadiest),
                  "a steady lamp, or the exposure's true time");
  }

  // The last exposure whose variance is the largest but for its own noise: beyond, it falls steeply.
  void choose_brightest(const std::vector<Moments>& lit) {
    const auto most = static_cast<std::size_t>(std::ranges::max_element(lit, {}, &Moments::temporal) - lit.begin());
    double freedom = 0;
    for (const TileSums& t : p_.lit[most].tiles) freedom += t.temporal_freedom;
    const double allowed = lit[most].temporal * (1 - 2 * std::sqrt(2 / freedom));
    std::size_t last = most;
    for (std::size_t k = most; k < lit.size(); ++k)
      if (lit[k].temporal >= allowed) last = k;
    if (last + 1 == lit.size() || last == 0) return;
    choice_.brightest = last;
    if (lit.back().temporal < noise_is_gone * lit[most].temporal) choice_.full = lit.size() - 1;
    // The true place lies between the exposures beside it, as likely anywhere in the half nearer to this one.
    choice_.gap = (lit[last + 1].mean - lit[last - 1].mean) / 2 / std::sqrt(12.0);
  }

  Numbers numbers_without(std::size_t tile) const {
    Numbers n{};
    const std::vector<Moments> dark = moments(p_.dark, tile), lit = above_dark(dark, tile);
    n[gain] = transfer_gain(lit, dark[0].temporal);
    const double k = n[gain];
    std::vector<std::array<double, 3>> mean, temporal;
    for (const Moments& m : dark)
      mean.push_back({m.t, m.mean, m.frames}), temporal.push_back({m.t, m.temporal, m.frames});
    n[dark_by_mean] = line(mean).b / k;
    n[dark_by_variance] = line(temporal).b / (k * k);
    // Dark current's own shot noise in the shortest exposure is no read noise.
    const double rounding = p_.step * p_.step / 12, shot = std::max(0.0, k * line(mean).b * dark[0].t);
    n[read2_codes] = dark[0].temporal - rounding - (choice_.dark_line ? shot : 0);
    n[read2] = n[read2_codes] / (k * k);
    n[threshold] = std::sqrt(std::max(0.0, n[read2]) + rounding / (k * k) + 0.25) + 0.5;
    if (choice_.brightest != none) {
      n[full_well] = lit[choice_.brightest].mean / k;
      n[snr] = std::sqrt(n[full_well]);
      n[range] = n[full_well] / n[threshold];
    }
    if (choice_.full != none) n[clip] = lit[choice_.full].mean / k;
    if (choice_.light_line) n[linearity] = 100 * mean_off(lit, light_line(lit));
    n[dsnu2] = dark[0].total / (k * k);
    n[prnu2] = 1e4 * lit[choice_.half].fine / (lit[choice_.half].mean * lit[choice_.half].mean);
    return n;
  }

  // Weighted by what the line says of the variance of a variance, not by what was measured: that would favour
  // exposures whose noise happened to be small.
  double transfer_gain(const std::vector<Moments>& lit, double dark) const {
    double k = 0;
    for (int round = 0; round < 3; ++round) {
      double above = 0, below = 0;
      for (const std::size_t i : choice_.transfer) {
        const double expected = round == 0 ? 1 : std::max(1e-12, k * lit[i].mean + dark),
                     weight = (lit[i].frames - 1) / (expected * expected);
        above += weight * lit[i].mean * lit[i].temporal, below += weight * lit[i].mean * lit[i].mean;
      }
      k = above / below;
    }
    return k;
  }

  // Least squares of relative deviations (EMVA 1288, 6.7).
  Line light_line(const std::vector<Moments>& lit) const {
    std::vector<std::array<double, 3>> points;
    for (const std::size_t i : choice_.line) points.push_back({lit[i].t, lit[i].mean, 1 / (lit[i].mean * lit[i].mean)});
    return line(points);
  }
  double mean_off(const std::vector<Moments>& lit, const Line& line) const {
    double sum = 0;
    for (const std::size_t i : choice_.line) sum += std::abs(lit[i].mean / line(lit[i].t) - 1);
    return sum / static_cast<double>(choice_.line.size());
  }

  void levels() {
    const std::vector<Moments> dark = moments(p_.dark, none), lit = above_dark(dark, none);
    const Line fitted = choice_.light_line ? light_line(lit) : Line{};
    for (std::size_t i = 0; i < lit.size(); ++i) {
      const bool on = choice_.light_line && std::ranges::find(choice_.line, i) != choice_.line.end();
      out_.lit.push_back(
          {lit[i].t, lit[i].mean, lit[i].temporal, lit[i].fine, on ? lit[i].mean / fitted(lit[i].t) - 1 : 0});
    }
    for (const Moments& m : dark) out_.dark.push_back({m.t, m.mean, m.temporal, m.total, 0});
    out_.dark_temporal = dark[0].temporal, out_.rounding = p_.step * p_.step / 12;
  }

  // `scale`: of value and sigma; `root`: the number is the figure's square; `more`: a standard deviation beside the
  // jackknife's.
  struct Asked {
    const char *name, *unit, *meaning;
    Number number;
    bool root = false;
    double more = 0;
  };
  void tell(const Numbers& all, const std::vector<Numbers>& parts) {
    const double gap = choice_.brightest != none ? choice_.gap / out_.saturation : 0;  // relative
    const bool bounded = p_.step > 0 && out_.dark_temporal < rounded_away * p_.step * p_.step;
    const bool cut = p_.dark.front().share_lowest > cut_off;
    const std::string no_read = bounded ? format("dark noise of %.3g codes is hidden by rounding",
                                                 std::sqrt(out_.dark_temporal))
                                        : format("%.3g %% of dark samples are cut off at the lowest code: raise black",
                                                 100 * p_.dark.front().share_lowest),
                      no_well = "the variance grows to the longest exposure: expose beyond saturation",
                      no_current = "dark frames of one exposure time";
    const auto add = [&](const Asked& a, const std::string& but = "") {
      if (but.empty())
        out_.figures.push_back(figure(a, all, parts));
      else
        out_.left_out.push_back(std::string(a.name) + ": " + but);
    };
    const std::string of_read = bounded || cut ? no_read : "", of_well = choice_.brightest == none ? no_well : "";
    const double e = all[full_well];
    add({"system gain", "code/e", "K, slope of the photon transfer to 70 % of saturation", gain});
    add({"read noise", "e", "temporal noise without light, rounding taken off", read2, true}, of_read);
    add({"read noise in codes", "code", "the same, rounding taken off", read2_codes, true}, of_read);
    add({"dark current", "e/s", "growth of the mean of dark frames", dark_by_mean},
        choice_.dark_line ? "" : no_current);
    add({"dark current by variance", "e/s", "growth of their temporal variance; sees what a black clamp hides",
         dark_by_variance},
        choice_.dark_line ? "" : no_current);
    add({"full well", "e", "where the temporal variance is largest", full_well, false, gap * e}, of_well);
    add({"clipping level", "e", "mean of the longest exposure, whose noise is gone: what a full sample holds", clip},
        choice_.full == none ? "the longest exposure still has noise: expose longer" : "");
    add({"SNR max", "1", "root of the full well", snr, false, gap * all[snr] / 2}, of_well);
    add({"sensitivity threshold", "e", "electrons whose signal to noise is 1; photons need the quantum efficiency",
         threshold},
        of_read);
    add({"dynamic range", "1", "full well over threshold", range, false, gap * all[range]},
        of_well.empty() ? of_read : of_well);
    add({"linearity error", "%", "mean deviation from a line over exposure time, 5 to 95 % of saturation", linearity},
        choice_.light_line ? "" : "fewer than three exposure times from 5 to 95 % of saturation");
    add({"DSNU", "e", "spread of samples without light", dsnu2, true}, cut ? no_read : "");
    add({"PRNU", "%", "spread of samples' sensitivity, near half of saturation", prnu2, true});
  }

  // Jackknife over tiles (Efron & Stein 1981); the interval by Student's law with one freedom less than tiles.
  static SensorFigure figure(const Asked& a, const Numbers& all, const std::vector<Numbers>& parts) {
    const auto n = static_cast<double>(parts.size());
    double mean = 0, squares = 0;
    for (const Numbers& part : parts) mean += part[a.number] / n;
    for (const Numbers& part : parts) squares += std::pow(part[a.number] - mean, 2);
    const double sigma = std::hypot(std::sqrt((n - 1) / n * squares), a.more), v = all[a.number],
                 reach = stats::student_quantile(0.975, n - 1) * sigma;
    if (!a.root) return {a.name, a.unit, v, sigma, v - reach, v + reach, a.meaning};
    const auto root = [](double square) { return std::sqrt(std::max(0.0, square)); };
    const double lower = root(v - reach), upper = root(v + reach);
    // Where the square is no larger than its own uncertainty the derivative of the root says nothing.
    const double slope = v > sigma ? sigma / (2 * std::sqrt(v)) : upper / 2;
    return {a.name, a.unit, root(v), slope, lower, upper, a.meaning};
  }

  void spectra(const Numbers& all) {
    const SeriesLevel &dark = p_.dark.front(), &lit = p_.lit[choice_.half];
    const auto scaled = [](const Spectrum& s, double scale) {
      Spectrum roots;
      for (const double power : s) roots.push_back(scale * std::sqrt(power));
      return roots;
    };
    const double electrons = 1 / all[gain], share = 100 / out_.half;
    out_.dark_rows = scaled(dark.rows, electrons), out_.dark_columns = scaled(dark.columns, electrons);
    out_.lit_rows = scaled(lit.rows, share), out_.lit_columns = scaled(lit.columns, share);
    const auto white = [](const SeriesLevel& level) {
      return std::sqrt(moments(level, none).temporal / static_cast<double>(level.frames));
    };
    out_.dark_white = electrons * white(dark), out_.lit_white = share * white(lit);
  }

  const SeriesPlane& p_;
  Choice choice_;
  PlaneFigures out_;
};

}  // namespace

const SensorFigure* PlaneFigures::find(const std::string& wanted) const {
  const auto found = std::ranges::find(figures, wanted, &SensorFigure::name);
  return found == figures.end() ? nullptr : &*found;
}

SensorFigures characterize(const SeriesSums& sums) {
  SensorFigures f;
  f.width = sums.width, f.height = sums.height, f.full_code = sums.full_code;
  double electrons = 0, read2 = 0;
  for (const SeriesPlane& plane : sums.planes) {
    f.planes.push_back(Plane(plane).run());
    const PlaneFigures& p = f.planes.back();
    electrons += 1 / p.find("system gain")->value;
    const SensorFigure* read = p.find("read noise in codes");
    read2 += read != nullptr ? read->value * read->value + p.rounding : p.dark_temporal;
  }
  const auto n = static_cast<double>(sums.planes.size());
  f.codes = {electrons / n, std::sqrt(read2 / n)};
  f.unit = {f.codes.gain * sums.full_code, f.codes.read / sums.full_code};
  return f;
}

}  // namespace gonio::photograph

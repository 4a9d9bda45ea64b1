#include "report/plot_axis.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace gonio::report {
namespace {

struct Extent {
  double lower = std::numeric_limits<double>::infinity(), upper = -std::numeric_limits<double>::infinity();
  bool logarithmic = false;
  void add(double v) {
    if (!std::isfinite(v) || (logarithmic && v <= 0)) return;
    lower = std::min(lower, v);
    upper = std::max(upper, v);
  }
};

std::pair<double, double> padded(Extent e, double share, bool keep_lower) {
  if (e.lower > e.upper) return e.logarithmic ? std::pair{0.1, 1.0} : std::pair{0.0, 1.0};
  if (e.logarithmic) {
    const double factor = e.lower == e.upper ? 2.0 : std::pow(e.upper / e.lower, share);
    return {e.lower / factor, e.upper * factor};
  }
  const double width = e.upper - e.lower;
  const double pad = width > 0 ? share * width : std::max(0.5 * std::abs(e.upper), 0.5);
  return {keep_lower ? e.lower : e.lower - pad, e.upper + pad};
}

void add_series(const Series& series, Extent& x, Extent& y) {
  for (const double edge : series.edges) x.add(edge);
  for (const double v : series.x) x.add(v);
  for (std::size_t i = 0; i < series.y.size(); ++i) {
    const double s = i < series.sigma.size() && std::isfinite(series.sigma[i]) ? series.sigma[i] : 0.0;
    y.add(series.y[i] - s);
    y.add(series.y[i] + s);
  }
  if (series.kind == Series::Kind::bars && !y.logarithmic) y.add(0);
}

std::string with_minus(std::string text) {  // U+2212, as wide as a digit
  for (std::size_t at = text.find('-'); at != std::string::npos; at = text.find('-', at + 3))
    text.replace(at, 1, "\u2212");
  return text;
}

}  // namespace

std::vector<double> tick_positions(double lower, double upper, int most) {
  if (!(upper > lower) || most < 1) return {};
  const double rough = (upper - lower) / most, power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10 * power;
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= rough * (1 - 1e-9)) {
      step = factor * power;
      break;
    }
  std::vector<double> ticks;
  const double first = std::ceil(lower / step - 1e-9), last = std::floor(upper / step + 1e-9);
  for (double i = first; i <= last; ++i) ticks.push_back(i == 0 ? 0.0 : i * step);
  return ticks;
}

std::vector<double> log_tick_positions(double lower, double upper, int most) {
  if (!(upper > lower) || lower <= 0) return {};
  const double decades = std::log10(upper / lower);
  std::vector<double> ticks;
  const double stride = std::max(1.0, std::ceil(decades / most));
  const std::vector<double> factors = decades < 1.2   ? std::vector{1.0, 2.0, 3.0, 5.0}
                                      : decades < 2.5 ? std::vector{1.0, 3.0}
                                                      : std::vector{1.0};
  for (double e = std::floor(std::log10(lower)); e <= std::ceil(std::log10(upper)); ++e) {
    if (std::fmod(std::abs(e), stride) != 0) continue;
    for (const double factor : factors) {
      const double v = factor * std::pow(10.0, e);
      if (v >= lower * (1 - 1e-9) && v <= upper * (1 + 1e-9)) ticks.push_back(v);
    }
  }
  return ticks;
}

PlotAxis::PlotAxis(std::pair<double, double> range, bool logarithmic, double begin, double end)
    : range_(range), logarithmic_(logarithmic), begin_(begin), end_(end) {
  const auto positions = ticks(6);
  if (positions.size() > 1) step_ = positions[1] - positions[0];
}

bool PlotAxis::shows(double v) const {
  return std::isfinite(v) && (!logarithmic_ || v > 0);
}

double PlotAxis::place(double v) const {
  const double share = logarithmic_ ? std::log(v / range_.first) / std::log(range_.second / range_.first)
                                    : (v - range_.first) / (range_.second - range_.first);
  return begin_ + share * (end_ - begin_);
}

std::vector<double> PlotAxis::ticks(int most) const {
  return logarithmic_ ? log_tick_positions(range_.first, range_.second, most)
                      : tick_positions(range_.first, range_.second, most);
}

std::string PlotAxis::label(double tick) const {
  const double exponent = std::log10(std::abs(tick));
  char text[96];
  if (logarithmic_ && std::abs(exponent) > 3.5 && std::abs(exponent - std::round(exponent)) < 1e-6) {
    std::snprintf(text, sizeof text, "10<tspan dy=\"-5\" font-size=\"9\">%s%.0f</tspan>", exponent < 0 ? "\u2212" : "",
                  std::abs(exponent));
    return text;
  }
  const double size = std::max(std::abs(range_.first), std::abs(range_.second));
  if (logarithmic_ || step_ <= 0 || size >= 1e5 || size < 1e-3) {
    std::snprintf(text, sizeof text, "%.4g", tick);
  } else {
    const int digits = std::clamp(static_cast<int>(-std::floor(std::log10(step_) + 1e-9)), 0, 8);
    std::snprintf(text, sizeof text, "%.*f", digits, tick);
  }
  return with_minus(text);
}

PlotRanges ranges(const Plot& plot) {
  Extent x, y;
  x.logarithmic = plot.log_x;
  y.logarithmic = plot.log_y;
  bool bars = false;
  for (const auto& series : plot.series) {
    add_series(series, x, y);
    bars = bars || series.kind == Series::Kind::bars;
  }
  for (const auto& mark : plot.marks) (mark.axis == Mark::Axis::x ? x : y).add(mark.at);
  if (plot.zero_y) y.add(0);
  PlotRanges result;
  const bool stands_on_zero = !plot.log_y && y.lower == 0;
  const bool given_x = plot.x_range.second > plot.x_range.first, given_y = plot.y_range.second > plot.y_range.first;
  result.x = given_x ? plot.x_range : padded(x, bars ? 0.0 : 0.03, false);
  result.y = given_y ? plot.y_range : padded(y, 0.06, stands_on_zero);
  return result;
}

}  // namespace gonio::report

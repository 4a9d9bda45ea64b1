// The displacements that lay a pattern onto its picture (contrast/measure/view_shift.h).
#include "contrast/measure/view_shift.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "linear/solve.h"
#include "stats/distributions.h"

namespace gonio::contrast {
namespace {

using Vector8 = Eigen::Matrix<double, 8, 1>;
using Matrix8 = Eigen::Matrix<double, 8, 8>;
using RowMajor8 = Eigen::Matrix<double, 8, 8, Eigen::RowMajor>;

constexpr double exact_px = 1e-3;  // no prior is narrower
constexpr double doubtful = 1e-4;  // chance of a displacement so large under the prior

// The picture after n passes of [1 2 1] / 4 along both axes; NaN where a pixel that does not count is within reach.
std::vector<float> softened(const GreyView& view, int passes) {
  std::vector<float> value = view.value;
  for (std::size_t i = 0; i < value.size(); ++i)
    if (view.saturated[i] || (!view.counts.empty() && !view.counts[i])) value[i] = std::nanf("");
  const auto wide = static_cast<std::size_t>(view.width), high = static_cast<std::size_t>(view.height);
  const auto pass = [&](std::size_t lines, std::size_t line_step, std::size_t length, std::size_t step) {
    parallel_for(
        0, lines,
        [&](std::size_t line) {
          float* v = value.data() + line * line_step;
          float before = v[0];
          for (std::size_t i = 0; i < length; ++i) {
            const float here = v[i * step], after = v[std::min(i + 1, length - 1) * step];
            v[i * step] = (before + 2 * here + after) / 4;
            before = here;
          }
        },
        64);
  };
  for (int k = 0; k < passes; ++k) {
    pass(high, wide, wide, 1);
    pass(wide, 1, high, wide);
  }
  return value;
}

// Pixels that share one error after n passes: 1 over the sum of the kernel's squares, binomial(4n, 2n) / 16^n, twice.
double shared_pixels(int passes) {
  double squares = 1;
  for (int i = 1; i <= 2 * passes; ++i) squares *= (2 * passes + i) / (4.0 * i);
  return 1 / (squares * squares);
}

struct Softened {
  std::vector<float> value;
  double width_px = 1;  // of the border's ramp that has the variance of pixel and kernel, 1 / 12 + n / 2
  double shared = 1;
};
Softened softened_for(const GreyView& view, double sigma_px, double side_px) {
  const double wanted = std::clamp(4 * sigma_px, 1.0, std::max(1.0, side_px));
  const int passes = std::clamp(static_cast<int>(std::lround((wanted * wanted - 1) / 6)), 1, 50);
  return {softened(view, passes), std::sqrt(1.0 + 6 * passes), shared_pixels(passes)};
}

struct Place {  // of one pixel, where the map has it
  std::size_t pixel = 0;
  Vec2 at, by_u, by_v;  // in cells, and its change by a pixel to the right, and down
};

std::vector<Place> places_of(const GreyView& view, const CellPattern& pattern, const ViewMap& map) {
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
  for (int k = 0; k < 4; ++k) {
    const auto corner = map.pixel(pattern.corner_m(k));
    if (!corner) return {};
    left = std::min(left, corner->x), right = std::max(right, corner->x);
    top = std::min(top, corner->y), bottom = std::max(bottom, corner->y);
  }
  const int x0 = static_cast<int>(std::clamp(std::ceil(left), 0.0, double(view.width)));
  const int x1 = static_cast<int>(std::clamp(std::floor(right), -1.0, view.width - 1.0));
  const int y0 = static_cast<int>(std::clamp(std::ceil(top), 0.0, double(view.height)));
  const int y1 = static_cast<int>(std::clamp(std::floor(bottom), -1.0, view.height - 1.0));
  std::vector<std::vector<Place>> lines(static_cast<std::size_t>(std::max(0, y1 - y0 + 1)));
  parallel_for(
      0, lines.size(),
      [&](std::size_t line) {
        const int y = y0 + static_cast<int>(line);
        for (int x = x0; x <= x1; ++x) {
          const Vec2 pixel{double(x), double(y)};
          const auto at = map.plane(pixel), u = map.plane(pixel + Vec2{1, 0}), v = map.plane(pixel + Vec2{0, 1});
          if (!at || !u || !v) continue;
          const auto cells = [&](Vec2 p) { return Vec2{p.x / pattern.cell_m.x, p.y / pattern.cell_m.y}; };
          lines[line].push_back(
              {static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) + static_cast<std::size_t>(x),
               cells(*at), cells(*u - *at), cells(*v - *at)});
        }
      },
      8);
  std::vector<Place> all;
  for (const auto& line : lines) all.insert(all.end(), line.begin(), line.end());
  return all;
}

// Along one coordinate: the cells to both sides of the nearest border, and how far the footprint reaches over it.
struct Between {
  int low = 0, high = 0;
  double share = 0, slope = 0;  // of `high`, and its change with the coordinate
};
std::optional<Between> between(double x, double width, int cells) {
  if (x < width / 2 || x > cells - width / 2) return std::nullopt;  // what lies beside the pattern is not known
  const double border = std::round(x), beyond = (x - border) / width + 0.5;
  const int above = static_cast<int>(border);
  if (beyond <= 0) return Between{above - 1, above - 1, 0, 0};
  if (beyond >= 1) return Between{above, above, 0, 0};
  return Between{above - 1, above, beyond, 1 / width};
}

struct Drawn {
  double value = 0;
  Vec2 slope;  // per cell
};
std::optional<Drawn> drawn(const CellPattern& pattern, const std::vector<double>& brightness, const Place& place,
                           double width_px, Vec2 at) {
  const auto width = [&](double u, double v) { return std::min(1.0, width_px * std::hypot(u, v)); };
  const auto x = between(at.x, width(place.by_u.x, place.by_v.x), pattern.columns);
  const auto y = between(at.y, width(place.by_u.y, place.by_v.y), pattern.rows);
  if (!x || !y) return std::nullopt;
  const auto m = [&](int column, int row) {
    return brightness[static_cast<std::size_t>(row) * static_cast<std::size_t>(pattern.columns) +
                      static_cast<std::size_t>(column)];
  };
  const double a = m(x->low, y->low), b = m(x->high, y->low), c = m(x->low, y->high), d = m(x->high, y->high);
  const double s = x->share, t = y->share;
  const Drawn result{(1 - t) * ((1 - s) * a + s * b) + t * ((1 - s) * c + s * d),
                     {((1 - t) * (b - a) + t * (d - c)) * x->slope, ((1 - s) * (c - a) + s * (d - b)) * y->slope}};
  if (!std::isfinite(result.value)) return std::nullopt;
  return result;
}

struct Sums {
  Matrix8 normal = Matrix8::Zero();
  Vector8 slope = Vector8::Zero();
  double squares = 0, weight = 0;  // r^2 over the squared slopes
};

Sums sums_at(const Softened& view, const CellPattern& pattern, const std::vector<double>& brightness,
             const std::vector<Place>& places, const Vector8& moved) {
  Sums sums;
  for (const Place& place : places) {
    const auto weights = corner_weights({place.at.x / pattern.columns, place.at.y / pattern.rows});
    Vec2 by;
    for (int k = 0; k < 4; ++k) by = by + Vec2{moved(2 * k), moved(2 * k + 1)} * weights[static_cast<std::size_t>(k)];
    const auto model =
        drawn(pattern, brightness, place, view.width_px, place.at - place.by_u * by.x - place.by_v * by.y);
    if (!model || !std::isfinite(view.value[place.pixel])) continue;
    const double r = double{view.value[place.pixel]} - model->value;
    const double gu = dot(model->slope, place.by_u), gv = dot(model->slope, place.by_v);  // d r / d (u, v)
    const double g2 = gu * gu + gv * gv;
    if (!(g2 > 0)) continue;
    Vector8 g;
    for (int k = 0; k < 4; ++k) {
      g(2 * k) = gu * weights[static_cast<std::size_t>(k)];
      g(2 * k + 1) = gv * weights[static_cast<std::size_t>(k)];
    }
    sums.normal.selfadjointView<Eigen::Lower>().rankUpdate(g);
    sums.slope += g * r;
    sums.squares += g2 * r * r;
    sums.weight += g2;
  }
  sums.normal = sums.normal.selfadjointView<Eigen::Lower>();
  return sums;
}

}  // namespace

ViewShift lay_onto(const GreyView& view, const CellPattern& pattern, const ViewMap& map,
                   const std::vector<double>& brightness, const CornerCovariance& prior, double sigma_px,
                   const CornerShifts& start) {
  ViewShift result{start, prior, 0, false};
  const Matrix8 wide = Eigen::Map<const RowMajor8>(prior.data()) + exact_px * exact_px * Matrix8::Identity();
  const Matrix8 stiff = linear::inverse(wide);
  Vector8 first;
  for (int k = 0; k < 4; ++k) {
    first(2 * k) = start[static_cast<std::size_t>(k)].x;
    first(2 * k + 1) = start[static_cast<std::size_t>(k)].y;
  }
  const std::vector<Place> places = places_of(view, pattern, map.moved(start, pattern.size_m()));
  const Softened soft = softened_for(view, sigma_px, shortest_side_px(pattern, map).value_or(1));
  Vector8 d = first;
  for (int round = 0; round < 50; ++round) {
    const Sums sums = sums_at(soft, pattern, brightness, places, d - first);
    if (!(sums.squares > 0)) return result;  // no border shows
    const double weight = sums.weight / (sums.squares * soft.shared);
    const Matrix8 normal = sums.normal * weight + stiff;
    const Vector8 step = -linear::solve_ldlt(normal, sums.slope * weight + stiff * d);
    const double length = step.cwiseAbs().maxCoeff(), most = 0.5;
    d += step * (length > most ? most / length : 1.0);
    if (length > 1e-3) continue;
    result.distance2 = d.dot(stiff * d);
    result.credible = result.distance2 <= stats::chi2_quantile(1 - doubtful, 8);
    if (!result.credible) return result;
    for (int k = 0; k < 4; ++k) result.by_px[static_cast<std::size_t>(k)] = {d(2 * k), d(2 * k + 1)};
    Eigen::Map<RowMajor8>(result.covariance.data()) = linear::inverse(normal);
    return result;
  }
  return result;
}

}  // namespace gonio::contrast

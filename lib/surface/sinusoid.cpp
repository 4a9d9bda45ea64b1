#include "surface/sinusoid.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace gonio::surface {
namespace {

constexpr double flattest_pattern = 1e-4;

// Cubic of t in [0, 1] by values and derivatives at its ends.
double hermite(Vec2 low, Vec2 high, double t) {
  const double u = 1 - t;
  return u * u * ((1 + 2 * t) * low.x + t * low.y) + t * t * ((1 + 2 * u) * high.x - u * high.y);
}

// The share of a period of cos that a direction of relative cotangent m sees. Heading to larger xi, its tangent touches
// the near side of the crest at 0; backwards from there it meets the far side of the crest at -2 pi. It lies below that
// crest, and highest above the profile at the other point of the same slope.
double share_seen(double m) {
  if (m >= 1) return 1;
  if (m <= 0) return 0;
  const double xi0 = -std::asin(m);
  double low = -2 * pi, high = -pi - xi0;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (std::cos(xi0) + m * (middle - xi0) < std::cos(middle) ? low : high) = middle;
  }
  return std::clamp(1 - (xi0 - low) / (2 * pi), 0.0, 1.0);
}

// By sqrt(m).
struct Shares {
  static constexpr std::size_t steps = 512;
  std::array<double, steps + 1> value{};
  Shares() {
    for (std::size_t i = 0; i <= steps; ++i) {
      const double root = static_cast<double>(i) / steps;
      value[i] = share_seen(root * root);
    }
  }
  double at(double m) const {
    if (!(m < 1)) return 1;
    const double x = std::sqrt(m) * steps;
    const auto i = std::min(static_cast<std::size_t>(x), steps - 1);
    return value[i] + (value[i + 1] - value[i]) * (x - static_cast<double>(i));
  }
};

// E[(x + N)^+] of a normal N: value and derivative at sixteenths, cubic between; error below 2e-8.
class PositivePart {
 public:
  PositivePart() {
    for (int i = 0; i <= 2 * reach * per_unit; ++i) {
      const double x = static_cast<double>(i) / per_unit - reach, below = std::erfc(-x / std::sqrt(2.0)) / 2;
      knots_.push_back({x * below + std::exp(-x * x / 2) / std::sqrt(2 * pi), below / per_unit});
    }
  }
  double at(double x) const {
    if (x >= reach) return x;
    if (!(x > -reach)) return 0;
    const double place = (x + reach) * per_unit;
    const auto i = static_cast<std::size_t>(place);
    return hermite(knots_[i], knots_[i + 1], place - static_cast<double>(i));
  }

 private:
  static constexpr int reach = 6, per_unit = 16;
  std::vector<Vec2> knots_;
};

double midpoint_sine(int i, int count) {
  return std::sin(((i + 0.5) / count - 0.5) * pi);
}

// The first of `count` midpoints of half a period whose sine may be as large as x.
int first_above(double x, int count) {
  if (x <= -1) return 0;
  if (x >= 1) return count;
  return std::clamp(static_cast<int>(std::floor((std::asin(x) / pi + 0.5) * count)), 0, count);
}

// As many as the narrowest scale needs.
int steps_for(double width) {
  return static_cast<int>(std::ceil(std::max(8.0, 2.2 / width)));
}

// mean of exp(-((x - sin t) / width)^2 / 2) over t, and its derivative by x.
Vec2 blurred_sine(double x, double width) {
  const int count = steps_for(width), end = std::min(first_above(x + 5 * width, count) + 1, count);
  Vec2 sum;
  for (int i = first_above(x - 5 * width, count); i < end; ++i) {
    const double d = (x - midpoint_sine(i, count)) / width, e = std::exp(-d * d / 2);
    sum = sum + Vec2{e, -e * d / width};
  }
  return {sum.x / count, sum.y / count};
}

// For area_seen(): steps by the amplitude over the roughness. Errors jump by less than 1e-7 where the number changes.
struct Midpoints {
  explicit Midpoints(int count) {
    for (int i = 0; i < count; ++i) sine.push_back(midpoint_sine(i, count));
  }
  static const Midpoints& of(double amplitude, double spread) {
    static const Midpoints few(5), some(8), many(16);
    return amplitude < 0.6 * spread ? few : amplitude < 2 * spread ? some : many;
  }
  std::vector<double> sine;
};

}  // namespace

BlurredSine::BlurredSine(double width) : width_(width), steps_per_unit_(4 / width) {
  const auto count = static_cast<std::size_t>(std::ceil((1 + 5 * width) * steps_per_unit_)) + 2;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2 at = blurred_sine(static_cast<double>(i) / steps_per_unit_, width);
    knots_.push_back({at.x, at.y / steps_per_unit_});
  }
  for (int i = 0; i < steps_for(width); ++i) sines_.push_back(midpoint_sine(i, steps_for(width)));
}

double BlurredSine::at(double x) const {
  const double place = std::abs(x) * steps_per_unit_;
  const auto i = static_cast<std::size_t>(place);
  if (!(place < static_cast<double>(knots_.size() - 1))) return 0;
  return hermite(knots_[i], knots_[i + 1], place - static_cast<double>(i));
}

Sinusoid::Sinusoid(double slope_u, double slope_v, double alpha, double azimuth_rad, const BlurredSine* table)
    : a_(std::clamp(slope_u, flattest_pattern, steepest_pattern)),
      b_(std::clamp(slope_v, flattest_pattern, steepest_pattern)),
      alpha_(alpha),
      cos_(std::cos(azimuth_rad)),
      sin_(std::sin(azimuth_rad)),
      table_(table && table->width() == least_width() ? table : nullptr) {}

double Sinusoid::least_width() const {
  return alpha_ * std::sqrt(2 / (a_ * a_ + b_ * b_));
}

// In X = p/a + q/b and Y = q/b - p/a the roughness has equal variances and a correlation; dp dq = (a b / 2) dX dY.
// Given X, Y is normal with the mean r dX and the variance (1 - r^2) times the other: 2 alpha^2 / (a^2 + b^2).
double Sinusoid::density_of_slopes(double p, double q) const {
  const double x = p / a_ + q / b_, y = q / b_ - p / a_, rest = least_width();
  const double ia = 1 / (a_ * a_), ib = 1 / (b_ * b_), sigma = alpha_ * std::sqrt((ia + ib) / 2);
  const double scale = 1 / (pi * sigma * rest * a_ * b_);
  const auto blurred = [&](double centre) { return table_ ? table_->at(centre) : blurred_sine(centre, rest).x; };
  if (a_ == b_) return scale * blurred(x) * blurred(y);
  const double r = (ib - ia) / (ia + ib);
  const int count = steps_for(rest), end = std::min(first_above(x + 5 * sigma, count) + 1, count);
  double sum = 0;
  for (int i = first_above(x - 5 * sigma, count); i < end; ++i) {
    const double sine = table_ ? table_->sines()[static_cast<std::size_t>(i)] : midpoint_sine(i, count), dx = x - sine;
    sum += std::exp(-dx * dx / (2 * sigma * sigma)) * blurred(y - r * dx);
  }
  return scale * sum / count;
}

double Sinusoid::density_of_normals(Vec3 h) const {
  if (h.z <= 0) return 0;
  const Vec3 t = turned(h);
  const double p = -t.x / h.z, q = -t.y / h.z;
  // Beyond the steepest slope by six standard deviations nothing is left.
  const double reach = 4.3 * alpha_;
  if (std::abs(p) > a_ + reach || std::abs(q) > b_ + reach) return 0;
  return density_of_slopes(p, q) / (h.z * h.z * h.z * h.z);
}

double Sinusoid::published_masking(Vec3 w) const {
  static const Shares shares;
  const Vec3 t = turned(w);
  const auto along = [&](double across, double slope) {
    return across == 0 ? 1.0 : shares.at(std::abs(w.z / across) / slope);
  };
  return along(t.x, a_) * along(t.y, b_);
}

double Sinusoid::area_seen(Vec3 w) const {
  static const PositivePart positive;
  const Vec3 t = turned(w);
  const double of_s = (b_ * t.y + a_ * t.x) / 2, of_t = (b_ * t.y - a_ * t.x) / 2;
  const double spread = alpha_ * std::sqrt((t.x * t.x + t.y * t.y) / 2);
  if (w.z - std::abs(of_s) - std::abs(of_t) >= 6 * spread) return w.z;
  const auto& over_s = Midpoints::of(std::abs(of_s), spread).sine;
  const auto& over_t = Midpoints::of(std::abs(of_t), spread).sine;
  const double z = w.z / spread, s = of_s / spread, u = of_t / spread;
  double sum = 0;
  for (const double a : over_s)
    for (const double b : over_t) sum += positive.at(z - s * a - u * b);
  return spread * sum / static_cast<double>(over_s.size() * over_t.size());
}

double Sinusoid::masking(Vec3 wo, Vec3 wi, double projections) const {
  const double seen_o = area_seen(wo), seen_i = area_seen(wi);
  const double smith = 1 / (wi.z * seen_o + wo.z * seen_i - wi.z * wo.z);
  if (projections <= 0) return smith;
  const auto bounded = [&](Vec3 w, double area) {
    const double share = published_masking(w);
    return share * area <= w.z ? share / w.z : 1 / area;
  };
  return smith + (bounded(wo, seen_o) * bounded(wi, seen_i) - smith) * projections;
}

Vec3 Sinusoid::normal(double s, double t, Vec2 roughness) const {
  const double x = std::sin(2 * pi * s), y = std::sin(2 * pi * t);
  const double radius = alpha_ * std::sqrt(-std::log1p(-std::min(roughness.x, 1 - 0x1p-53)));
  const double p = a_ * (x - y) / 2 + radius * std::cos(2 * pi * roughness.y);
  const double q = b_ * (x + y) / 2 + radius * std::sin(2 * pi * roughness.y);
  return normalized(Vec3{-(cos_ * p - sin_ * q), -(sin_ * p + cos_ * q), 1});
}

}  // namespace gonio::surface

// See edge_spread.h.
#include "alignment/edge_spread.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "base/parallel.h"

namespace gonio::alignment {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr int samples = 33;           // across an edge
constexpr double narrowest_px = 4;    // half of the window, to begin with
constexpr double widest_px = 48;      // and at most
constexpr double most_misfit = 0.05;  // root mean square over the step
constexpr double whole_edge = 1.5;    // of the window over w, for an edge to be in it with both of its levels
constexpr std::size_t one_in = 3;     // points

double disc_share(double u) {
  if (u <= -1) return 0;
  if (u >= 1) return 1;
  return 0.5 + (u * std::sqrt(1 - u * u) + std::asin(u)) / pi;
}

struct Profile {
  double half_px = 0;
  std::array<double, samples> value{};
  double place(int k) const { return half_px * (2.0 * k / (samples - 1) - 1); }
};

struct Edge {
  double centre = 0, w = 0, squares = std::numeric_limits<double>::infinity(), step = 0;
};

// The best levels and slope for an edge there: normal equations of three unknowns.
Edge edge_at(const Profile& profile, double centre, double w) {
  double a[3][3] = {}, b[3] = {}, yy = 0;
  for (int k = 0; k < samples; ++k) {
    const double t = profile.place(k), y = profile.value[static_cast<std::size_t>(k)];
    const double base[3] = {1, t / profile.half_px, disc_share((t - centre) / w)};
    for (int i = 0; i < 3; ++i) {
      b[i] += base[i] * y;
      for (int j = 0; j <= i; ++j) a[i][j] += base[i] * base[j];
    }
    yy += y * y;
  }
  // Cholesky; edges that leave the window make it singular.
  double x[3] = {b[0], b[1], b[2]};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j <= i; ++j) {
      for (int k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[j][k];
      if (j < i)
        a[i][j] /= a[j][j];
      else if (a[i][i] < 1e-6)
        return {};
      else
        a[i][i] = std::sqrt(a[i][i]);
    }
    for (int k = 0; k < i; ++k) x[i] -= a[i][k] * x[k];
    x[i] /= a[i][i];
  }
  const double squares = std::max(0.0, yy - x[0] * x[0] - x[1] * x[1] - x[2] * x[2]);
  return {centre, w, squares, x[2] / a[2][2]};
}

Edge best_edge(const Profile& profile) {
  Edge best;
  const auto ask = [&](double centre, double w) {
    const Edge e = edge_at(profile, centre, w);
    if (e.squares < best.squares) return best = e, true;
    return false;
  };
  for (double w = 0.7; w < profile.half_px; w *= 1.5)
    for (int k = -3; k <= 3; ++k) ask(k * std::max(0.5, 0.25 * w), w);
  if (best.w == 0) return best;
  double shift = std::max(0.25, 0.125 * best.w), factor = 1.2;
  for (int round = 0; round < 40 && shift > 0.005; ++round) {
    const Edge from = best;
    const bool better = ask(from.centre + shift, from.w) | ask(from.centre - shift, from.w) |
                        ask(from.centre, from.w * factor) | ask(from.centre, std::max(0.3, from.w / factor));
    if (!better) shift *= 0.5, factor = std::sqrt(factor);
  }
  return best;
}

std::optional<Profile> profile_of(const Luminance& picture, const RimPoint& point, double half_px,
                                  const std::function<bool(Vec2)>& hidden) {
  Profile profile{half_px};
  for (int k = 0; k < samples; ++k) {
    const Vec2 pixel = point.pixel + point.outward * profile.place(k);
    const double v = picture.at(pixel);
    if (!std::isfinite(v) || hidden(pixel)) return {};
    profile.value[static_cast<std::size_t>(k)] = v;
  }
  return profile;
}

double spread_at(const Luminance& picture, const RimPoint& point, const std::function<bool(Vec2)>& hidden) {
  double half = narrowest_px;
  while (half <= widest_px) {
    const auto profile = profile_of(picture, point, half, hidden);
    if (!profile) return nothing;
    const Edge e = best_edge(*profile);
    if (!(e.step > 0) || std::abs(e.centre) > 1 + 0.5 * e.w) return nothing;
    if (e.w * whole_edge > half - std::abs(e.centre)) {
      half *= 1.4;
      continue;
    }
    return std::sqrt(e.squares / samples) < most_misfit * e.step ? 0.5 * e.w : nothing;
  }
  return nothing;
}

}  // namespace

Luminance::Luminance(const io::Image& picture)
    : width_(picture.width), height_(picture.height), value_(picture.pixels()) {
  const int channels = std::min(3, static_cast<int>(picture.channels.size()));
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      float sum = 0;
      for (int c = 0; c < channels; ++c) sum += picture.at(x, y, c);
      value_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)] =
          sum / static_cast<float>(std::max(1, channels));
    }
}

double Luminance::at(Vec2 pixel) const {
  if (!(pixel.x >= 1 && pixel.y >= 1 && pixel.x < width_ - 2 && pixel.y < height_ - 2)) return nothing;
  const auto x = static_cast<std::size_t>(pixel.x), y = static_cast<std::size_t>(pixel.y);
  const double u = pixel.x - static_cast<double>(x), v = pixel.y - static_cast<double>(y);
  const auto w = static_cast<std::size_t>(width_);
  const float* row = &value_[y * w + x];
  return (1 - v) * ((1 - u) * static_cast<double>(row[0]) + u * static_cast<double>(row[1])) +
         v * ((1 - u) * static_cast<double>(row[w]) + u * static_cast<double>(row[w + 1]));
}

std::vector<double> edge_spreads(const Luminance& picture, std::span<const RimPoint> points,
                                 const std::function<bool(Vec2)>& hidden) {
  std::vector<double> spread(points.size(), nothing);
  parallel_for(0, (points.size() + one_in - 1) / one_in, [&](std::size_t k) {
    const RimPoint& point = points[k * one_in];
    if (point.counts) spread[k * one_in] = spread_at(picture, point, hidden);
  });
  return spread;
}

}  // namespace gonio::alignment

// See observed_rim.h.
#include "alignment/observed_rim.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace gonio::alignment {
namespace {

std::vector<float> smoothed(const Region& region, double sigma) {
  if (!(sigma > 0)) return region.share;
  const int reach = static_cast<int>(std::ceil(4 * sigma));
  std::vector<float> weight(2 * reach + 1);
  float sum = 0;
  for (int i = -reach; i <= reach; ++i)
    sum += weight[i + reach] = static_cast<float>(std::exp(-0.5 * i * i / (sigma * sigma)));
  for (float& w : weight) w /= sum;
  const int width = region.width, height = region.height;
  std::vector<float> along(region.share.size()), out(region.share.size());
  // Beyond the border the picture goes on as it ends.
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      float v = 0;
      for (int i = -reach; i <= reach; ++i)
        v += weight[i + reach] * region.share[static_cast<std::size_t>(y) * width + std::clamp(x + i, 0, width - 1)];
      along[static_cast<std::size_t>(y) * width + x] = v;
    }
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      float v = 0;
      for (int i = -reach; i <= reach; ++i)
        v += weight[i + reach] * along[static_cast<std::size_t>(std::clamp(y + i, 0, height - 1)) * width + x];
      out[static_cast<std::size_t>(y) * width + x] = v;
    }
  return out;
}

// Curves of the level a half, by marching squares: each crossed side of the grid is a node, in each square one or two
// links lead from node to node with what is above the level to the left (in axes right and down: cross product
// positive).
class Level {
 public:
  Level(const std::vector<float>& value, int width, int height) : value_(value), width_(width), height_(height) {
    next_.assign(2 * static_cast<std::size_t>(width) * height, none);
    for (int y = 0; y + 1 < height; ++y)
      for (int x = 0; x + 1 < width; ++x) link(x, y);
  }
  std::vector<std::vector<Vec2>> loops() {
    std::vector<std::uint8_t> entered(next_.size(), 0), seen(next_.size(), 0);
    for (const std::uint32_t n : next_)
      if (n != none) entered[n] = 1;
    std::vector<std::vector<Vec2>> all;
    const auto follow = [&](std::uint32_t start) {
      std::vector<Vec2> loop;
      std::uint32_t n = start;
      while (n != none && !seen[n]) seen[n] = 1, loop.push_back(place(n)), n = next_[n];
      if (n == start) loop.push_back(place(start));  // closed
      all.push_back(std::move(loop));
    };
    for (std::uint32_t n = 0; n < next_.size(); ++n)  // open ones begin where nothing leads
      if (next_[n] != none && !entered[n]) follow(n);
    for (std::uint32_t n = 0; n < next_.size(); ++n)
      if (next_[n] != none && !seen[n]) follow(n);
    return all;
  }

 private:
  static constexpr std::uint32_t none = ~0U;
  float at(int x, int y) const { return value_[static_cast<std::size_t>(y) * width_ + x] - 0.5F; }
  bool above(int x, int y) const { return at(x, y) > 0; }
  std::uint32_t side(int x, int y, int down) const {  // from (x, y) to the right, or down
    return 2 * (static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(width_) + static_cast<std::uint32_t>(x)) +
           static_cast<std::uint32_t>(down);
  }
  Vec2 place(std::uint32_t n) const {
    const int cell = static_cast<int>(n / 2), x = cell % width_, y = cell / width_;
    const double a = at(x, y), b = n % 2 == 0 ? at(x + 1, y) : at(x, y + 1), share = a / (a - b);
    return n % 2 == 0 ? Vec2{x + share, static_cast<double>(y)} : Vec2{static_cast<double>(x), y + share};
  }
  void link(int x, int y) {
    // Corners in order 0 (x, y), 1 (x+1, y), 2 (x+1, y+1), 3 (x, y+1), and the sides that follow each.
    const std::array<bool, 4> in{above(x, y), above(x + 1, y), above(x + 1, y + 1), above(x, y + 1)};
    const std::array<std::uint32_t, 4> sides{side(x, y, 0), side(x + 1, y, 1), side(x, y + 1, 0), side(x, y, 1)};
    const auto crossed = [&](std::size_t k) { return in[k] != in[(k + 1) % 4]; };
    const int count = crossed(0) + crossed(1) + crossed(2) + crossed(3);
    if (count == 0) return;
    // Going round in this order, the inside of a curve lies to its left if it comes in where corners change from out to
    // in and leaves where they change back: next, or, where the middle joins two such parts, before.
    const bool joined = count == 4 && at(x, y) + at(x + 1, y) + at(x, y + 1) + at(x + 1, y + 1) > 0;
    for (std::size_t k = 0; k < 4; ++k) {
      if (!crossed(k) || in[k]) continue;
      std::size_t j = joined ? (k + 3) % 4 : (k + 1) % 4;
      while (!(crossed(j) && in[j])) j = joined ? (j + 3) % 4 : (j + 1) % 4;
      next_[sides[j]] = sides[k];
    }
  }

  const std::vector<float>& value_;
  int width_, height_;
  std::vector<std::uint32_t> next_;
};

// About a pixel apart, normals from what lies a pixel and a half to either side.
void sample(const std::vector<Vec2>& loop, std::uint32_t number, std::vector<RimPoint>& out) {
  std::vector<double> arc{0};
  for (std::size_t i = 1; i < loop.size(); ++i) arc.push_back(arc.back() + norm(loop[i] - loop[i - 1]));
  const double length = arc.back();
  const bool closed = loop.front() == loop.back();
  const auto at = [&](double s) {
    if (closed)
      s = std::fmod(s + length, length);
    else
      s = std::clamp(s, 0.0, length);
    const auto i = static_cast<std::size_t>(std::upper_bound(arc.begin(), arc.end() - 1, s) - arc.begin());
    const double step = arc[i] - arc[i - 1];
    return loop[i - 1] + (loop[i] - loop[i - 1]) * (step > 0 ? (s - arc[i - 1]) / step : 0);
  };
  const auto count = static_cast<int>(std::lround(length));
  for (int k = 0; k < count; ++k) {
    const double s = (k + 0.5) * length / count;
    const Vec2 way = at(s + 1.5) - at(s - 1.5);
    const double size = norm(way);
    if (!(size > 0)) continue;
    out.push_back({at(s), {way.y / size, -way.x / size}, 0.3, number, s, true});
  }
}

// The half level of what a Gaussian smoothed runs sigma^2 kappa / 2 towards the middle of the bend (Marr & Hildreth
// 1980's displacement of edges; Lindeberg 1994): undone with the bend between some points before and behind.
void unbend(std::vector<RimPoint>& points, double sigma_px) {
  const auto reach = static_cast<std::size_t>(std::lround(2 + 2 * sigma_px));
  const double blur = sigma_px * sigma_px + 1.0 / 12;  // with the pixel's own square
  std::vector<Vec2> at(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    at[i] = points[i].pixel;
    if (i < reach || i + reach >= points.size()) continue;
    const RimPoint &before = points[i - reach], &after = points[i + reach];
    const double length = after.arc_px - before.arc_px;
    if (before.loop != after.loop || !(length > 0)) continue;
    // The region lies to the left of the way: where the normal turns left (positive), it is convex.
    const double turn = std::atan2(before.outward.x * after.outward.y - before.outward.y * after.outward.x,
                                   dot(before.outward, after.outward));
    const double kappa = std::clamp(turn / length, -0.5 / sigma_px, 0.5 / sigma_px);
    at[i] = points[i].pixel + points[i].outward * (0.5 * blur * kappa);
  }
  for (std::size_t i = 0; i < points.size(); ++i) points[i].pixel = at[i];
}

}  // namespace

std::vector<RimPoint> rim_points(const Region& region, double smooth_px, double least_px) {
  const std::vector<float> value = smoothed(region, smooth_px);
  std::vector<RimPoint> points;
  std::uint32_t number = 0;
  for (const auto& loop : Level(value, region.width, region.height).loops()) {
    double length = 0;
    for (std::size_t i = 1; i < loop.size(); ++i) length += norm(loop[i] - loop[i - 1]);
    if (length >= least_px && loop.size() >= 4) sample(loop, number++, points);
  }
  if (smooth_px > 0) unbend(points, smooth_px);
  const int reach = static_cast<int>(std::ceil(region.margin_px));
  for (RimPoint& p : points) {
    if (p.pixel.x < 2 || p.pixel.y < 2 || p.pixel.x > region.width - 3 || p.pixel.y > region.height - 3)
      p.counts = false;
    if (region.no_rim.empty()) continue;
    const int cx = static_cast<int>(std::lround(p.pixel.x)), cy = static_cast<int>(std::lround(p.pixel.y));
    for (int y = std::max(0, cy - reach); y <= std::min(region.height - 1, cy + reach); ++y)
      for (int x = std::max(0, cx - reach); x <= std::min(region.width - 1, cx + reach); ++x)
        if (region.no_rim[static_cast<std::size_t>(y) * region.width + x] &&
            std::hypot(x - p.pixel.x, y - p.pixel.y) <= region.margin_px)
          p.counts = false;
  }
  return points;
}

void straighten(std::vector<RimPoint>& points, const std::function<Vec2(Vec2)>& straight) {
  std::uint32_t loop = ~0U;
  double arc = 0;
  Vec2 last;
  for (RimPoint& p : points) {
    const Vec2 tangent{-p.outward.y, p.outward.x};
    const Vec2 at = straight(p.pixel), way = straight(p.pixel + tangent * 0.5) - straight(p.pixel - tangent * 0.5);
    const double size = norm(way);
    p.pixel = at, p.outward = {way.y / size, -way.x / size}, p.sigma_px *= size;
    arc = p.loop == loop ? arc + norm(at - last) : 0;
    p.arc_px = arc, loop = p.loop, last = at;
  }
}

}  // namespace gonio::alignment

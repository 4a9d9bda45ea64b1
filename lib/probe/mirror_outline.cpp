// See mirror_outline.h. Angles about the start's axis are small numbers; distances in pixels are angles times the
// pixels per radian that the lens has at each edge.
#include "probe/mirror_outline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "linear/positive.h"
#include "stats/intervals.h"

namespace gonio::probe {
namespace {

using reassembly::Outline;

struct Edge {
  Vec3 ray;
  std::size_t turn = 0;
  double strength = 0, px_per_rad = 0;
};
struct Frame {
  explicit Frame(Vec3 unit) : axis(unit), across(reassembly::across_of(unit)), down(cross(unit, across)) {}
  Vec3 ray(double turn, double angle) const {
    return axis * std::cos(angle) + (across * std::cos(turn) + down * std::sin(turn)) * std::sin(angle);
  }
  Vec3 axis, across, down;
};
struct Cone {
  Vec3 axis;
  double half_angle = 0;
};
Cone moved(const Cone& cone, const std::array<double, 3>& by) {
  const Frame f(cone.axis);
  return {normalized(f.axis + f.across * by[0] + f.down * by[1]), cone.half_angle + by[2]};
}

// Bilinear; nothing at the border and where a pixel does not count.
std::optional<double> grey_at(const io::GreyImage& grey, const std::vector<unsigned char>& counts, Vec2 p) {
  const int x = static_cast<int>(std::floor(p.x)), y = static_cast<int>(std::floor(p.y));
  if (x < 0 || y < 0 || x + 1 >= grey.width || y + 1 >= grey.height) return {};
  double sum = 0;
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const auto k =
          static_cast<std::size_t>(y + j) * static_cast<std::size_t>(grey.width) + static_cast<std::size_t>(x + i);
      if (!counts.empty() && counts[k] == 0) return {};
      sum += double{grey.values[k]} * (i == 1 ? p.x - x : 1 - (p.x - x)) * (j == 1 ? p.y - y : 1 - (p.y - y));
    }
  return sum;
}

constexpr double step_px = 0.5;
// Bilinear profiles and the parabola through three of their slopes: what edges of known place are off by, as a whole.
constexpr Doubt interpolation{0.01, 0.003};

// Derivative of a Gaussian of one pixel, at steps of half a pixel.
std::vector<double> gradient_of(const std::vector<std::optional<double>>& profile) {
  constexpr int reach = 6;
  std::vector<double> slope(profile.size(), 0);
  for (std::size_t k = reach; k + reach < profile.size(); ++k) {
    double sum = 0;
    bool whole = true;
    for (int j = -reach; j <= reach && whole; ++j) {
      const auto& v = profile[static_cast<std::size_t>(static_cast<int>(k) + j)];
      whole = v.has_value();
      const double t = j * step_px;
      if (whole) sum += *v * t * std::exp(-t * t / 2) * step_px;
    }
    slope[k] = whole ? sum / std::sqrt(2 * pi) : 0;
  }
  return slope;
}

// Edges along the normals of a cone, within `range_px` of it; `turns` normals.
std::vector<Edge> edges_about(const io::GreyImage& grey, const camera::CameraModel& camera,
                              const std::vector<unsigned char>& counts, const Cone& cone, double range_px,
                              std::size_t turns) {
  const Frame frame(cone.axis);
  std::vector<Edge> edges;
  std::vector<double> sizes;
  const int reach = static_cast<int>(std::ceil(range_px / step_px)) + 6;
  for (std::size_t t = 0; t < turns; ++t) {
    const double turn = 2 * pi * static_cast<double>(t) / static_cast<double>(turns);
    const auto rim = camera.project(frame.ray(turn, cone.half_angle)),
               beside = camera.project(frame.ray(turn, cone.half_angle * 1.001));
    if (!rim || !beside) continue;
    const double px_per_rad = norm(*beside - *rim) / (cone.half_angle * 0.001);
    const auto angle_at = [&](double k) { return cone.half_angle + k * step_px / px_per_rad; };
    std::vector<std::optional<double>> profile;
    for (int k = -reach; k <= reach; ++k) {
      const auto p = angle_at(k) > 0 ? camera.project(frame.ray(turn, angle_at(k))) : std::nullopt;
      profile.push_back(p ? grey_at(grey, counts, *p) : std::nullopt);
    }
    const std::vector<double> slope = gradient_of(profile);
    for (std::size_t k = 1; k + 1 < slope.size(); ++k) {
      const double before = std::abs(slope[k - 1]), here = std::abs(slope[k]), after = std::abs(slope[k + 1]);
      sizes.push_back(here);
      if (!(here > 0 && here >= before && here > after && before > 0 && after > 0)) continue;
      const double shift = 0.5 * (before - after) / (before - 2 * here + after);
      edges.push_back({frame.ray(turn, angle_at(static_cast<double>(k) - reach + shift)), t, here, px_per_rad});
    }
  }
  const double typical = sizes.empty() ? 1 : std::max(3 * stats::median(sizes), 1e-9);
  for (Edge& e : edges) e.strength = e.strength / (e.strength + typical);
  return edges;
}

double distance_px(const Edge& e, const Cone& cone) {
  return (std::atan2(norm(cross(cone.axis, e.ray)), dot(cone.axis, e.ray)) - cone.half_angle) * e.px_per_rad;
}

double score(const std::vector<Edge>& edges, const Cone& cone, double width_px) {
  double sum = 0;
  for (const Edge& e : edges) {
    const double r = distance_px(e, cone) / width_px;
    if (std::abs(r) < 4) sum += e.strength * std::exp(-r * r / 2);
  }
  return sum;
}

// The best cone of each radius on a grid about `middle`, from the smallest radius to the largest.
struct OfRadius {
  Cone cone;
  double score = -1;
};
std::vector<OfRadius> best_of_radii(const std::vector<Edge>& edges, const Cone& middle, double range_px,
                                    double spacing_px, double px_per_rad) {
  const int n = static_cast<int>(std::ceil(range_px / spacing_px));
  const double step = spacing_px / px_per_rad, width_px = std::max(0.7 * spacing_px, 1.0);
  std::vector<OfRadius> best;
  for (int k = -n; k <= n; ++k) {
    OfRadius here;
    for (int i = -n; i <= n; ++i)
      for (int j = -n; j <= n; ++j) {
        const Cone cone = moved(middle, {i * step, j * step, k * step});
        if (cone.half_angle <= 0) continue;
        const double found = score(edges, cone, width_px);
        if (found > here.score) here = {cone, found};
      }
    best.push_back(here);
  }
  return best;
}

// The outermost of the cones that edges support nearly as well as the best: streaks of what the ball shows run along
// the outline too, but within it.
OfRadius outermost(const std::vector<OfRadius>& by_radius) {
  constexpr double nearly = 0.7;
  double most = 0;
  for (const OfRadius& r : by_radius) most = std::max(most, r.score);
  for (std::size_t k = by_radius.size(); k-- > 0;) {
    const bool peak = (k == 0 || by_radius[k].score >= by_radius[k - 1].score) &&
                      (k + 1 == by_radius.size() || by_radius[k].score >= by_radius[k + 1].score);
    if (peak && by_radius[k].score >= nearly * most) return by_radius[k];
  }
  return by_radius.back();
}

// Grids whose spacing falls to 1.5 pixels.
Cone best_on_grid(const std::vector<Edge>& edges, Cone cone, double range_px, double px_per_rad) {
  for (double spacing = std::max(1.0, range_px / 6), range = range_px;; range = 1.5 * spacing, spacing /= 2) {
    cone = outermost(best_of_radii(edges, cone, range, spacing, px_per_rad)).cone;
    if (spacing <= 1.5) return cone;
  }
}

struct Refined {
  Cone cone;
  Mat3 covariance;
  double cover = 0, rms_px = 0;
};

using Normal = std::array<double, 9>;

// d distance_px / d (axis across, axis down, half angle) of one edge.
std::array<double, 3> slopes_of(const Edge& e, const Frame& f) {
  const double turn = std::atan2(dot(e.ray, f.down), dot(e.ray, f.across));
  return {-std::cos(turn) * e.px_per_rad, -std::sin(turn) * e.px_per_rad, -e.px_per_rad};
}

// Reweighted least squares with falling width.
std::optional<Refined> refined(const std::vector<Edge>& edges, Cone cone, std::size_t turns) {
  constexpr std::array<double, 12> widths{2, 2, 1.5, 1.5, 1, 1, 0.8, 0.8, 0.7, 0.7, 0.7, 0.7};
  Normal inverse{};
  for (const double width : widths) {
    const Frame frame(cone.axis);
    Normal h{};
    std::array<double, 3> downhill{}, change{};
    for (const Edge& e : edges) {
      const double r = distance_px(e, cone), w = e.strength * std::exp(-r * r / (2 * width * width));
      const auto j = slopes_of(e, frame);
      for (std::size_t a = 0; a < 3; ++a) {
        downhill[a] -= w * r * j[a];
        for (std::size_t b = 0; b < 3; ++b) h[3 * a + b] += w * j[a] * j[b];
      }
    }
    if (!linear::positive_inverse<3>(h, inverse)) return {};
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) change[a] += inverse[3 * a + b] * downhill[b];
    cone = moved(cone, change);
  }
  // Sandwich over sectors; the curvature is that of the score, of edges near the outline.
  constexpr std::size_t sectors = 36;
  std::array<std::array<double, 3>, sectors> pulls{};
  Normal curvature{}, meat{};
  std::vector<bool> covered(turns);
  double squares = 0, count = 0;
  const double width = widths.back();
  const Frame frame(cone.axis);
  for (const Edge& e : edges) {
    const double r = distance_px(e, cone), q = r * r / (width * width), w = e.strength * std::exp(-q / 2);
    const auto j = slopes_of(e, frame);
    for (std::size_t a = 0; a < 3; ++a) {
      pulls[e.turn * sectors / turns][a] += w * r * j[a];
      for (std::size_t b = 0; b < 3; ++b) curvature[3 * a + b] += w * std::max(0.0, 1 - q) * j[a] * j[b];
    }
    if (std::abs(r) < 1 && e.strength > 0.4) covered[e.turn] = true, squares += r * r, ++count;
  }
  for (const auto& pull : pulls)
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) meat[3 * a + b] += pull[a] * pull[b];
  if (!linear::positive_inverse<3>(curvature, inverse, 1e-6)) return {};
  const Mat3 bread{inverse};
  Refined result{cone, bread * Mat3{meat} * bread, 0, count > 0 ? std::sqrt(squares / count) : 0};
  result.cover = static_cast<double>(std::ranges::count(covered, true)) / static_cast<double>(turns);
  return result;
}

}  // namespace

void add_doubt(Outline& o, Doubt doubt) {
  const double rad_per_px = o.half_angle_rad / o.radius_px;
  for (int k = 0; k < 3; ++k)
    o.covariance_rad2(k, k) += std::pow(rad_per_px * (k == 2 ? doubt.radius_px : doubt.centre_px), 2);
}

std::optional<Outline> mirror_outline(const io::GreyImage& grey, const camera::CameraModel& camera,
                                      const OutlineSearch& start, const std::vector<unsigned char>& counts) {
  Cone cone{start.axis, start.half_angle_rad};
  const auto centre = camera.project(cone.axis), rim = camera.project(Frame(cone.axis).ray(0, cone.half_angle));
  if (!centre || !rim) return {};
  const double radius_px = norm(*rim - *centre), px_per_rad = radius_px / cone.half_angle;
  const double range_px = std::clamp(start.range, 0.0, 0.25) * radius_px;
  constexpr std::size_t coarse_turns = 120;
  const auto wide = edges_about(grey, camera, counts, cone, 2 * range_px + 2, coarse_turns);
  if (wide.empty()) return {};
  cone = best_on_grid(wide, cone, range_px, px_per_rad);
  const auto turns = static_cast<std::size_t>(std::clamp(2 * pi * radius_px / 1.5, 72.0, 1440.0));
  std::optional<Refined> fit;
  for (const double near_px : {5.0, 3.0}) {
    fit = refined(edges_about(grey, camera, counts, cone, near_px, turns), cone, turns);
    if (!fit) return {};
    cone = fit->cone;
  }
  const auto middle = camera.project(cone.axis);
  if (!middle) return {};
  double sum = 0;
  for (int k = 0; k < 8; ++k) {
    const auto p = camera.project(Frame(cone.axis).ray(k * pi / 4, cone.half_angle));
    if (!p) return {};
    sum += norm(*p - *middle) / 8;
  }
  Outline outline{cone.axis, cone.half_angle, fit->covariance, *middle, sum, fit->cover, fit->rms_px, 0};
  add_doubt(outline, interpolation);
  return outline;
}

}  // namespace gonio::probe

// A candidate followed from its level of the pyramid down to where its edge is sharp: the strongest edge of its sign
// along every normal, and the cone through them, robustly.
#include <algorithm>
#include <array>
#include <cmath>

#include "linear/positive.h"
#include "reassembly/detect_parts.h"
#include "stats/intervals.h"

namespace gonio::reassembly {

namespace {

// Linear between pixels; the nearest beyond the border. Nothing where a pixel does not count.
std::optional<double> grey_at(const PictureLevel& level, Vec2 p) {
  if (!(p.x >= -0.5 && p.y >= -0.5 && p.x <= level.bytes.cols - 0.5 && p.y <= level.bytes.rows - 0.5))
    return std::nullopt;
  const double u = std::clamp(p.x, 0.0, level.bytes.cols - 1.001), v = std::clamp(p.y, 0.0, level.bytes.rows - 1.001);
  const int x = static_cast<int>(u), y = static_cast<int>(v);
  if (!level.usable.empty() && level.usable.at<unsigned char>(y, x) == 0) return std::nullopt;
  const unsigned char *top = level.bytes.ptr<unsigned char>(y) + x, *bottom = level.bytes.ptr<unsigned char>(y + 1) + x;
  const double a = u - x, b = v - y;
  return (top[0] * (1 - a) + top[1] * a) * (1 - b) + (bottom[0] * (1 - a) + bottom[1] * a) * b;
}

struct ProfileEdge {
  double out_px = 0, slope = 0;  // of the level; slope: grey levels a pixel, positive: of the right sign
};

// Where the profile along the normal falls (sign 1) or rises most. The slope is a difference over two pixels.
std::optional<ProfileEdge> profile_edge(const PictureLevel& level, Vec2 at, Vec2 normal, double reach, int sign) {
  constexpr double step = 0.5;
  constexpr int most = 80;
  const int half = std::min(most, static_cast<int>(std::ceil(reach / step)));
  std::array<double, 2 * most + 5> grey{}, slope{};
  const int count = 2 * half + 1;
  for (int i = -2; i < count + 2; ++i) {
    const auto g = grey_at(level, at + normal * ((i - half) * step));
    if (!g) return std::nullopt;
    grey[i + 2] = *g;
  }
  int best = -1;
  double most_weighed = 0;
  for (int i = 0; i < count; ++i) {
    slope[i] = sign * (grey[i] - grey[i + 4]) / 2;
    const double far = double(i - half) / half, weighed = slope[i] * (1 - 0.5 * far * far);  // nearer ones first
    if (best < 0 || weighed > most_weighed) best = i, most_weighed = weighed;
  }
  if (best <= 0 || best >= count - 1 || !(slope[best] > 0)) return std::nullopt;
  if (slope[best] < slope[best - 1] || slope[best] < slope[best + 1]) return std::nullopt;  // still rising outwards
  const double bend = slope[best - 1] - 2 * slope[best] + slope[best + 1];
  const double by = bend < 0 ? 0.5 * (slope[best - 1] - slope[best + 1]) / bend : 0;
  return ProfileEdge{(best - half + by) * step, slope[best]};
}

class CoarseFit {
 public:
  CoarseFit(const Pyramid& pyramid, const camera::CameraModel& camera, const OutlineCandidate& candidate)
      : pyramid_(pyramid), camera_(camera), sign_(candidate.sign), cone_(candidate.cone), level_(candidate.level) {}
  std::optional<CoarseOutline> run();

 private:
  bool search(double reach_px);
  bool fit();
  void judge_roundness(CoarseOutline& out) const;
  double blur_px() const;
  bool stands_out(double blur) const;
  const PictureLevel& picture() const { return pyramid_.levels[static_cast<std::size_t>(level_)]; }

  const Pyramid& pyramid_;
  const camera::CameraModel& camera_;
  int sign_;
  Cone cone_;
  int level_;
  double radius_px_ = 0, spread_ = 0;  // full pixels
  std::vector<EdgePoint> points_;      // out_px: full pixels from cone_
};

bool CoarseFit::search(double reach_px) {
  const ConeFrame frame(cone_.axis);
  const PictureLevel& level = picture();
  radius_px_ = outline_radius_px(camera_, cone_);
  if (!(radius_px_ > 1)) return false;
  const int count = std::clamp(static_cast<int>(2 * pi * radius_px_ / level.scale / 1.5), 20, 160);
  points_.assign(static_cast<std::size_t>(count), {});
  for (int i = 0; i < count; ++i) {
    EdgePoint& point = points_[static_cast<std::size_t>(i)];
    point.turn = 2 * pi * i / count;
    const auto place = outline_point(camera_, frame, cone_.half_angle_rad, point.turn);
    if (!place) continue;
    point.px_per_rad = place->px_per_rad;
    const double reach = std::min(reach_px, 0.75 * radius_px_ / level.scale);
    const auto edge = profile_edge(level, level.from_full(place->pixel), place->normal, reach, sign_);
    if (!edge || edge->slope < 0.5 * pyramid_.noise) continue;
    const Vec2 full = place->pixel + place->normal * (edge->out_px * level.scale);
    point.out_px = (frame.angle(camera_.ray(full).direction) - cone_.half_angle_rad) * place->px_per_rad;
    point.seen = true;
  }
  return true;
}

// Tukey's biweight about the cone, its scale by the median absolute deviation of what is seen.
bool CoarseFit::fit() {
  std::array<double, 3> total{};
  std::vector<double> left;
  for (int round = 0; round < 8; ++round) {
    left.clear();
    const auto residual = [&](const EdgePoint& p) {
      return p.out_px - p.px_per_rad * (std::cos(p.turn) * total[0] + std::sin(p.turn) * total[1] + total[2]);
    };
    for (const EdgePoint& p : points_)
      if (p.seen) left.push_back(std::abs(residual(p)));
    if (left.size() < 6) return false;
    spread_ = std::max(stats::sigma_of_median * stats::median(left), 0.08 * picture().scale);
    std::array<double, 9> h{}, inverse{};
    std::array<double, 3> g{};
    for (const EdgePoint& p : points_) {
      if (!p.seen) continue;
      const double r = residual(p), x = r / (4 * spread_);
      if (std::abs(x) >= 1) continue;
      const double w = (1 - x * x) * (1 - x * x);
      const std::array<double, 3> row{p.px_per_rad * std::cos(p.turn), p.px_per_rad * std::sin(p.turn), p.px_per_rad};
      for (std::size_t i = 0; i < 3; ++i) {
        g[i] += w * row[i] * r;
        for (std::size_t j = 0; j < 3; ++j) h[3 * i + j] += w * row[i] * row[j];
      }
    }
    if (!linear::positive_inverse<3>(h, inverse, 1e-6)) return false;
    double largest = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double change = inverse[3 * i] * g[0] + inverse[3 * i + 1] * g[1] + inverse[3 * i + 2] * g[2];
      total[i] += change;
      largest = std::max(largest, std::abs(change));
    }
    if (largest < 1e-3 * cone_.half_angle_rad && round > 1) break;
  }
  for (EdgePoint& p : points_)
    p.out_px -= p.px_per_rad * (std::cos(p.turn) * total[0] + std::sin(p.turn) * total[1] + total[2]);
  const double size = cone_.half_angle_rad;
  if (std::hypot(total[0], total[1]) > 0.8 * size || std::abs(total[2]) > 0.6 * size) return false;
  cone_ = moved(cone_, total[0], total[1], total[2]);
  return true;
}

// Of an edge C Phi(x / s) the steepest slope is C / (s sqrt(2 pi)); C by what lies well to both sides.
double CoarseFit::blur_px() const {
  const ConeFrame frame(cone_.axis);
  std::vector<double> widths;
  const PictureLevel& level = picture();
  const double apart = std::min(5.0, 0.6 * radius_px_ / level.scale);
  for (const EdgePoint& p : points_) {
    if (!p.seen || std::abs(p.out_px) > 3 * spread_) continue;
    const auto place = outline_point(camera_, frame, cone_.half_angle_rad, p.turn);
    if (!place) continue;
    const Vec2 at = level.from_full(place->pixel + place->normal * p.out_px), n = place->normal;
    const auto in = grey_at(level, at - n * apart), out = grey_at(level, at + n * apart);
    const auto before = grey_at(level, at - n), after = grey_at(level, at + n);
    if (!in || !out || !before || !after) continue;
    const double step = sign_ * (*in - *out), slope = sign_ * (*before - *after) / 2;
    if (slope > 0 && step > 0) widths.push_back(step / (slope * std::sqrt(2 * pi)));
  }
  return widths.empty() ? 1 : std::max(0.4, stats::median(widths));
}

// A second harmonic of the distance from the cone: of an ellipse with semi-axes a > b it is (a - b) / 2. Fitted to all
// that is seen within reach and not only to what agrees, since of an oval half would seem hidden.
void CoarseFit::judge_roundness(CoarseOutline& out) const {
  double limit = std::max(6 * spread_, 0.1 * radius_px_);
  std::array<double, 5> s{};
  std::array<double, 25> inverse{};
  double variance = 0;
  for (int round = 0; round < 4; ++round) {
    std::array<double, 25> h{};
    std::array<double, 5> g{};
    std::vector<double> left;
    const auto row_of = [](double turn) {
      return std::array<double, 5>{1, std::cos(turn), std::sin(turn), std::cos(2 * turn), std::sin(2 * turn)};
    };
    const auto residual = [&](const EdgePoint& p) {
      double r = p.out_px;
      const auto row = row_of(p.turn);
      for (std::size_t i = 0; i < 5; ++i) r -= s[i] * row[i];
      return r;
    };
    for (const EdgePoint& p : points_) {
      if (!p.seen || std::abs(residual(p)) > limit) continue;
      const auto row = row_of(p.turn);
      for (std::size_t i = 0; i < 5; ++i) {
        g[i] += row[i] * p.out_px;
        for (std::size_t j = 0; j < 5; ++j) h[5 * i + j] += row[i] * row[j];
      }
      left.push_back(std::abs(residual(p)));
    }
    if (left.size() < 10 || !linear::positive_inverse<5>(h, inverse, 1e-3)) return;
    s.fill(0);
    for (std::size_t i = 0; i < 5; ++i)
      for (std::size_t j = 0; j < 5; ++j) s[i] += inverse[5 * i + j] * g[j];
    left.clear();
    for (const EdgePoint& p : points_)
      if (p.seen) left.push_back(std::abs(residual(p)));
    const double scale = std::max(stats::sigma_of_median * stats::median(left), 0.08 * picture().scale);
    limit = 4 * scale;
    variance = scale * scale;
  }
  out.oval_px = std::hypot(s[3], s[4]);
  constexpr double correlated = 2;  // neighbouring edge points share pixels
  out.oval_sigma = std::sqrt(correlated * variance * std::max(inverse[18], inverse[24]));
  // A bar across a sphere bends the ellipse as well, but only an oval explains more of the outline than the cone does.
  const double near = std::max(2 * std::sqrt(variance), 0.15 * picture().scale);
  int gained = 0;
  for (const EdgePoint& p : points_) {
    double r = p.out_px;
    for (std::size_t i = 0; i < 5; ++i)
      r -= s[i] * std::array{1.0, std::cos(p.turn), std::sin(p.turn), std::cos(2 * p.turn), std::sin(2 * p.turn)}[i];
    gained += p.seen * ((std::abs(r) < near) - (std::abs(p.out_px) < near));
  }
  out.oval_gain = double(gained) / double(points_.size());
}

// The step across the outline against the noise about it: two circles, just inside and outside, and how neighbours on
// each of them differ. The picture's quietest parts say nothing about noise that grows with the light, nor of texture.
bool CoarseFit::stands_out(double blur) const {
  const ConeFrame frame(cone_.axis);
  const PictureLevel& level = picture();
  const double apart = std::min(1.2 * blur + 1, 0.5 * radius_px_ / level.scale);
  std::vector<double> steps, differences;
  std::optional<double> last_in, last_out;
  for (const EdgePoint& p : points_) {
    const auto place = outline_point(camera_, frame, cone_.half_angle_rad, p.turn);
    if (!place) continue;
    const Vec2 at = level.from_full(place->pixel), n = place->normal;
    const auto in = grey_at(level, at - n * apart), out = grey_at(level, at + n * apart);
    if (in && out) steps.push_back(std::abs(*in - *out));
    if (in && last_in) differences.push_back(std::abs(*in - *last_in));
    if (out && last_out) differences.push_back(std::abs(*out - *last_out));
    last_in = in, last_out = out;
  }
  constexpr double times = 3;
  return steps.size() > 8 && stats::median(steps) > times * stats::sigma_of_median / std::sqrt(2.0) *
                                                        std::max(stats::median(differences), 0.2);
}

std::optional<CoarseOutline> CoarseFit::run() {
  const double start = outline_radius_px(camera_, cone_) / picture().scale;
  if (!search(std::clamp(0.3 * start, 2.0, 4.0)) || !fit() || !search(2.5) || !fit()) return std::nullopt;
  constexpr double sharp = 2.5;
  double blur = blur_px();
  while (level_ > 0 && blur < sharp) {
    const Cone before = cone_;
    --level_;
    const double reach = std::max(3.0, 3 * blur + 1);
    if (!search(reach) || !fit() || !search(reach) || !fit()) {
      cone_ = before, ++level_;
      if (!search(3) || !fit()) return std::nullopt;
      break;
    }
    blur = blur_px();
  }
  if (!stands_out(blur)) return std::nullopt;
  CoarseOutline out;
  // Once more with a reach in which an oval shows.
  if (!search(std::clamp(0.2 * radius_px_ / picture().scale, std::max(3.0, 3 * blur), 12.0)) || !fit())
    return std::nullopt;
  judge_roundness(out);
  const double agreement = std::min(std::max({3 * spread_, 0.5 * picture().scale, 0.03 * radius_px_}),
                                    std::max(0.8 * picture().scale, 0.04 * radius_px_));
  std::size_t agreeing = 0;
  for (EdgePoint& p : points_) agreeing += p.agrees = p.seen && std::abs(p.out_px) < agreement;
  out.cone = cone_, out.level = level_, out.spread_px = spread_, out.blur_px = blur;
  out.radius_px = outline_radius_px(camera_, cone_);
  out.cover = double(agreeing) / double(points_.size());
  out.points = points_;
  return out.radius_px > 1 ? std::optional(out) : std::nullopt;
}

}  // namespace

std::optional<CoarseOutline> coarse_outline(const Pyramid& pyramid, const camera::CameraModel& camera,
                                            const OutlineCandidate& candidate) {
  return CoarseFit(pyramid, camera, candidate).run();
}

}  // namespace gonio::reassembly

// See projector_corners.h.
#include "scan/projector_corners.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "base/text.h"
#include "linear/solve.h"
#include "stats/intervals.h"

namespace gonio::scan {
namespace {

using Terms = Eigen::Matrix<double, 6, 1>;
using Normal = Eigen::Matrix<double, 6, 6>;

constexpr double reach = 0.9;     // squares from the corner: the board goes one square beyond its inner corners
constexpr double blurred_px = 2;  // from an edge
constexpr std::size_t fewest_pixels = 30;
constexpr double most_sigma_px = 1;  // of a place that is still worth having
constexpr int rounds = 12, first_rounds = 5;
constexpr double tukey = 4.685;  // 95 % efficient for normal errors
constexpr double usual_noise_px = 0.1;
constexpr double contradicting = 25;  // chi-square of two coordinates
constexpr std::size_t fewest_corners = 6;

struct Sample {
  Terms terms;           // of the pixel, in units of the window
  double place[2] = {};  // of the projector
  double sigma[2] = {};
};

std::vector<Sample> samples_about(const Codes& codes, Vec2 corner, Vec2 a, Vec2 b, double unit_px) {
  std::vector<Sample> samples;
  const double determinant = a.x * b.y - a.y * b.x;
  if (!(std::abs(determinant) > 1)) return {};  // seen from the side
  const double from_a = std::abs(determinant) / norm(a), from_b = std::abs(determinant) / norm(b);
  const double wide = reach * (std::abs(a.x) + std::abs(b.x)), high = reach * (std::abs(a.y) + std::abs(b.y));
  const int x0 = std::max(0, static_cast<int>(corner.x - wide)),
            x1 = std::min(codes.width - 1, static_cast<int>(corner.x + wide) + 1),
            y0 = std::max(0, static_cast<int>(corner.y - high)),
            y1 = std::min(codes.height - 1, static_cast<int>(corner.y + high) + 1);
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const std::size_t i =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(codes.width) + static_cast<std::size_t>(x);
      if (!codes.told(i)) continue;
      const Vec2 off = Vec2{static_cast<double>(x), static_cast<double>(y)} - corner;
      const double s = (off.x * b.y - off.y * b.x) / determinant, t = (a.x * off.y - a.y * off.x) / determinant;
      if (std::abs(s) > reach || std::abs(t) > reach || std::abs(s) * from_b < blurred_px ||
          std::abs(t) * from_a < blurred_px)
        continue;
      const double u = off.x / unit_px, v = off.y / unit_px;
      Sample sample;
      sample.terms << 1, u, v, u * u, u * v, v * v;
      for (std::size_t axis = 0; axis < 2; ++axis)
        sample.place[axis] = codes.place[axis][i], sample.sigma[axis] = codes.sigma[axis][i];
      samples.push_back(sample);
    }
  return samples;
}

struct Polynomial {
  Terms coefficients;
  double variance = 0;  // at the corner
  std::vector<double> weights;
  bool known = false;
};

// First for the least sum of absolute values, which a minority of gross errors does not move, then under Tukey's loss.
Polynomial fitted(const std::vector<Sample>& samples, std::size_t axis) {
  Polynomial fit;
  fit.weights.assign(samples.size(), 1);
  std::vector<double> off(samples.size());
  double scale = 1;
  Normal normal;
  for (int round = 0; round < rounds; ++round) {
    normal.setZero();
    Terms right = Terms::Zero();
    for (std::size_t k = 0; k < samples.size(); ++k) {
      const double w = fit.weights[k] / (samples[k].sigma[axis] * samples[k].sigma[axis]);
      normal += w * samples[k].terms * samples[k].terms.transpose();
      right += w * samples[k].place[axis] * samples[k].terms;
    }
    fit.coefficients = linear::solve_ldlt(normal, right);
    if (!fit.coefficients.allFinite()) return fit;
    for (std::size_t k = 0; k < samples.size(); ++k)
      off[k] = std::abs(samples[k].place[axis] - fit.coefficients.dot(samples[k].terms)) / samples[k].sigma[axis];
    scale = std::max(1.0, stats::sigma_of_median * stats::median(off));
    for (std::size_t k = 0; k < samples.size(); ++k) {
      const double z = off[k] / (tukey * scale);
      fit.weights[k] = round < first_rounds ? 1 / std::max(off[k] / scale, 0.1) : z < 1 ? std::pow(1 - z * z, 2) : 0;
    }
  }
  double squares = 0, count = 0;
  for (std::size_t k = 0; k < samples.size(); ++k) squares += fit.weights[k] * off[k] * off[k], count += fit.weights[k];
  if (count < 0.5 * static_cast<double>(samples.size()) || count < static_cast<double>(fewest_pixels)) return fit;
  const Normal inverse = linear::inverse(normal);
  fit.variance = inverse(0, 0) * std::max(1.0, squares / (count - 6));
  fit.known = std::isfinite(fit.variance) && fit.variance > 0;
  return fit;
}

// Pixels of the camera that one stripe of the projector covers: their rounding is one and the same.
double pixels_of_a_stripe(const std::vector<Sample>& samples) {
  std::set<std::pair<double, double>> stripes;
  for (const Sample& s : samples) stripes.emplace(s.place[0], s.place[1]);
  return static_cast<double>(samples.size()) / static_cast<double>(stripes.size());
}

// A square's sides in the picture about a place of the board: the slopes of a plane through the corners found, by how
// near they are.
struct Sides {
  Vec2 along_columns, along_rows;
};
Sides sides_at(const camera::Detection& detection, const camera::Board& board, Vec2 at) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
  for (const camera::Corner& c : detection.corners) {
    const Vec2 off = (board.corner_m(c.id) - at) * (1 / board.square_m);
    const double near = 1 / (1 + std::pow(dot(off, off), 2));
    const Eigen::Vector3d terms(1, off.x, off.y);
    normal += near * terms * terms.transpose();
    right += near * terms * Eigen::RowVector2d(c.pixel.x, c.pixel.y);
  }
  const Eigen::Matrix<double, 3, 2> plane = linear::solve_ldlt(normal, right);
  return {{plane(1, 0), plane(1, 1)}, {plane(2, 0), plane(2, 1)}};
}

struct Told {  // by one camera
  std::size_t camera = 0;
  LitCorner lit;
  Eigen::Matrix2d slope, own, whole;  // covariances: at a given pixel, and with the camera's error
};

Told told_by(std::size_t camera, const LitCorner& lit, double sigma_px) {
  Told t{camera, lit, {}, {}, {}};
  t.slope << lit.slope[0], lit.slope[1], lit.slope[2], lit.slope[3];
  t.own << lit.own[0], lit.own[1], lit.own[1], lit.own[2];
  t.whole = t.own + sigma_px * sigma_px * t.slope * t.slope.transpose();
  return t;
}

// Nothing where cameras contradict each other.
std::optional<camera::Corner> joined(int id, const std::vector<Told>& told) {
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right(0, 0);
  for (const Told& t : told) {
    const Eigen::Matrix2d weight = linear::inverse(t.whole);
    information += weight, right += weight * Eigen::Vector2d(t.lit.place.x, t.lit.place.y);
  }
  const Eigen::Matrix2d covariance = linear::inverse(information);
  const Eigen::Vector2d place = covariance * right;
  auto looked_up = std::make_shared<camera::LookedUp>();
  Eigen::Matrix2d own = Eigen::Matrix2d::Zero();
  for (const Told& t : told) {
    const Eigen::Matrix2d weight = covariance * linear::inverse(t.whole), slope = weight * t.slope;
    const Eigen::Vector2d off = Eigen::Vector2d(t.lit.place.x, t.lit.place.y) - place;
    if (off.dot(linear::inverse(t.whole) * off) > contradicting) return std::nullopt;
    own += weight * t.own * weight.transpose();
    looked_up->at.push_back({t.camera, {slope(0, 0), slope(0, 1), slope(1, 0), slope(1, 1)}});
  }
  looked_up->own = {own(0, 0), own(0, 1), own(1, 1)};
  return camera::Corner{id, {place(0), place(1)}, std::sqrt(0.5 * covariance.trace()), std::move(looked_up)};
}

// What most of the pixels about the corners that were not told are.
std::string reason_of(const Codes& codes, const camera::Detection& detection) {
  std::array<std::size_t, refusal_names.size()> count{};
  for (const camera::Corner& c : detection.corners)
    for (int dy = -8; dy <= 8; ++dy)
      for (int dx = -8; dx <= 8; ++dx) {
        const int x = static_cast<int>(c.pixel.x) + dx, y = static_cast<int>(c.pixel.y) + dy;
        if (x < 0 || y < 0 || x >= codes.width || y >= codes.height) continue;
        ++count[static_cast<std::size_t>(codes.refusal[static_cast<std::size_t>(y * codes.width + x)])];
      }
  const std::size_t all = std::accumulate(count.begin(), count.end(), std::size_t{0});
  const auto most = std::max_element(count.begin() + 1, count.end());
  return format("%.0f %% of the pixels about them are %s",
                100.0 * static_cast<double>(*most) / std::max<double>(1, static_cast<double>(all)),
                std::string(refusal_names[static_cast<std::size_t>(most - count.begin())]).c_str());
}

}  // namespace

std::optional<LitCorner> lit_corner(const Codes& codes, Vec2 corner, Vec2 along_columns, Vec2 along_rows) {
  if (codes.place[0].empty() || codes.place[1].empty()) return std::nullopt;
  const double unit_px = reach * std::max(norm(along_columns), norm(along_rows));
  const std::vector<Sample> samples = samples_about(codes, corner, along_columns, along_rows, unit_px);
  if (samples.size() < fewest_pixels) return std::nullopt;
  const Polynomial x = fitted(samples, 0), y = fitted(samples, 1);
  if (!x.known || !y.known) return std::nullopt;
  const double shared = codes.whole ? pixels_of_a_stripe(samples) : 1;
  LitCorner lit;
  lit.place = {x.coefficients(0), y.coefficients(0)};
  lit.slope = {x.coefficients(1) / unit_px, x.coefficients(2) / unit_px, y.coefficients(1) / unit_px,
               y.coefficients(2) / unit_px};
  lit.own = {shared * x.variance, 0, shared * y.variance};
  lit.pixels = samples.size();
  if (lit.own[0] + lit.own[2] > 2 * most_sigma_px * most_sigma_px) return std::nullopt;
  return lit;
}

ProjectorCorners projector_corners(const std::vector<CameraCorners>& cameras, const camera::Board& board) {
  std::map<int, std::vector<Told>> told;
  std::size_t seen = 0;
  double straight = 0, across = 0;
  ProjectorCorners found;
  for (const CameraCorners& c : cameras) {
    seen = std::max(seen, c.detection->corners.size());
    if (c.detection->corners.size() < fewest_corners) continue;
    for (const camera::Corner& corner : c.detection->corners) {
      const Sides sides = sides_at(*c.detection, board, board.corner_m(corner.id));
      const auto lit = lit_corner(*c.codes, corner.pixel, sides.along_columns, sides.along_rows);
      if (!lit) continue;
      const double sigma = corner.sigma_px > 0         ? corner.sigma_px
                           : c.detection->noise_px > 0 ? c.detection->noise_px
                                                       : usual_noise_px;
      told[corner.id].push_back(told_by(c.camera, *lit, sigma));
      const auto& s = lit->slope;
      found.turned_over += s[0] * s[3] < s[1] * s[2] ? 1 : -1;
      straight += std::abs(s[0] * s[3]), across += std::abs(s[1] * s[2]);
    }
  }
  found.exchanged = across > straight;
  std::vector<double> sigmas;
  for (const auto& [id, by] : told)
    if (auto corner = joined(id, by)) {
      sigmas.push_back(corner->sigma_px);
      found.detection.corners.push_back(std::move(*corner));
    }
  if (!sigmas.empty()) found.detection.noise_px = stats::median(sigmas);
  if (found.detection.corners.size() < fewest_corners)
    found.detection.problem =
        cameras.empty() || seen == 0
            ? "no camera finds the board in its plain picture"
            : format("of %zu corners of the board the codes tell %zu: ", seen, found.detection.corners.size()) +
                  reason_of(*cameras[0].codes, *cameras[0].detection);
  return found;
}

}  // namespace gonio::scan

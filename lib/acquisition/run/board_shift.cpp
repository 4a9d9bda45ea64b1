// See board_shift.h.
#include "acquisition/run/board_shift.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/quantity.h"
#include "camera/calibration.h"
#include "camera/quality/alignment.h"
#include "linear/geom_matrices.h"
#include "linear/solve.h"
#include "linear/symmetric_eigen.h"
#include "robot/chain/chain.h"
#include "stats/distributions.h"
#include "stats/intervals.h"

namespace gonio::acquisition {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

struct CommonCorner {
  int id = 0;
  Vec2 before, now;
  double sigma_before = 0, sigma_now = 0;
  Vec2 moved() const { return now - before; }
};

std::vector<CommonCorner> common_corners(std::span<const camera::Corner> before, std::span<const camera::Corner> now) {
  const auto stated = [](const camera::Corner& c) { return c.sigma_px > 0 ? c.sigma_px : usual_sigma_px; };
  std::vector<CommonCorner> both;
  for (const camera::Corner& b : before) {
    const auto n = std::ranges::find(now, b.id, &camera::Corner::id);
    if (n != now.end()) both.push_back({b.id, b.pixel, n->pixel, stated(b), stated(*n)});
  }
  return both;
}

// Of one coordinate of the difference.
double sigma_of(const CommonCorner& c) {
  return std::hypot(c.sigma_before, c.sigma_now);
}

Mat3 symmetric(const Eigen::Matrix3d& m) {
  return linear::mat3_of(0.5 * (m + m.transpose()));
}

camera::BoardPose pose_seen(std::span<const camera::Corner> corners, const camera::Board& board,
                            const camera::Intrinsics& lens) {
  camera::View view;
  view.corners.assign(corners.begin(), corners.end());
  constexpr double loss_px = 1;  // corners that miss by more pull with less than their square
  return camera::pose_under(view, board, lens, {}, camera::start_pose(view, board, lens), loss_px);
}

struct PoseFit {
  robot::MeasuredPose pose;
  std::vector<double> residuals;  // of each corner, in its sigmas
};

// Least squares over corners whose differences stand on what the lens predicts of `from`.
PoseFit fit_change(const std::vector<CommonCorner>& corners, const camera::Board& board, const camera::Intrinsics& lens,
                   const camera::BoardPose& from) {
  robot::ChainInput input;
  input.extent = board.extent();
  robot::ChainState state;
  state.intrinsics = lens;
  robot::ChainInput::View view;
  for (const CommonCorner& c : corners) {
    Vec2 there;
    if (camera::predict(lens, from, input.extent, {}, board.corner_m(c.id), there))
      view.corners.push_back({board.corner_m(c.id), there + c.moved(), sigma_of(c)});
  }
  constexpr int steps = 20;
  PoseFit fit{robot::measured_pose(view, input, state, from, steps), {}};
  for (const auto& c : view.corners) {
    Vec2 there;
    camera::predict(lens, fit.pose.camera_from_board, input.extent, {}, c.board_m, there);
    fit.residuals.push_back(norm(c.pixel - there) / c.sigma_px);
  }
  return fit;
}

// Corners that miss by far more than most do: a reflex, a finger before the board.
std::vector<CommonCorner> without_strays(const std::vector<CommonCorner>& corners,
                                         const std::vector<double>& residuals) {
  if (residuals.size() != corners.size()) return corners;
  // Of normal noise in two coordinates the median length is sqrt(2 ln 2) sigma.
  const double usual = stats::median(residuals) / std::sqrt(2 * std::log(2.0));
  std::vector<CommonCorner> kept;
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (residuals[i] <= 6 * std::max(usual, 1.0)) kept.push_back(corners[i]);
  return kept.size() >= least_check_corners ? kept : corners;
}

// The board's middle m in the camera's axes, p = R m + t, moves by d + w x (R m) for R <- exp(w) R, t <- t + d: it is
// known far better than the camera's own place, which a turn of the camera nearly makes up for.
void place_change(const camera::BoardPose& from, const robot::MeasuredPose& to, Vec2 middle_m, double scale,
                  BoardShift& shift) {
  const camera::BoardPose& now = to.camera_from_board;
  const Vec3 middle{middle_m.x, middle_m.y, 0};
  const Matrix6 covariance = scale * Eigen::Map<const Matrix6>(to.covariance.data());
  Eigen::Matrix<double, 3, 6> place;
  place << -linear::cross_matrix(linear::as_eigen(now.rotate(middle))), Eigen::Matrix3d::Identity();
  shift.position_m = Moved{now * middle - from * middle, symmetric(place * covariance * place.transpose())};
  shift.rotation_rad =
      Moved{rotation_vector_of(now.rotation * conjugate(from.rotation)), symmetric(covariance.topLeftCorner<3, 3>())};
}

// The mean corner's way; what is left of the corners' differences about it is no noise where the camera has turned.
Moved picture_change(const std::vector<CommonCorner>& corners, double scale) {
  Moved mean{{}, {}};
  double variance = 0;
  const auto n = static_cast<double>(corners.size());
  for (const CommonCorner& c : corners) {
    mean.by = mean.by + Vec3{c.moved().x, c.moved().y, 0} * (1 / n);
    variance += scale * sigma_of(c) * sigma_of(c) / (n * n);
  }
  mean.covariance = {{variance, 0, 0, 0, variance, 0, 0, 0, 0}};
  return mean;
}

}  // namespace

std::optional<BoardShift> shift_between(std::span<const camera::Corner> before, std::span<const camera::Corner> now,
                                        const camera::Board& board, const std::optional<camera::Intrinsics>& lens) {
  std::vector<CommonCorner> corners = common_corners(before, now);
  if (corners.size() < least_check_corners) return std::nullopt;
  BoardShift shift;
  double scale = 1;
  shift.freedom = std::numeric_limits<double>::infinity();
  if (lens) {
    const camera::BoardPose from = pose_seen(before, board, *lens);
    PoseFit fit = fit_change(corners, board, *lens, from);
    if (auto kept = without_strays(corners, fit.residuals); kept.size() < corners.size()) {
      corners = std::move(kept);
      fit = fit_change(corners, board, *lens, from);
    }
    scale = std::max(1.0, fit.pose.squares / std::max(1.0, fit.pose.freedom));
    shift.freedom = fit.pose.freedom;
    place_change(from, fit.pose, board.extent().middle_m, scale, shift);
  }
  shift.picture_px = picture_change(corners, scale);
  double own = 0, all = 0;
  for (const CommonCorner& c : corners)
    own += c.sigma_now * c.sigma_now, all += c.sigma_now * c.sigma_now + c.sigma_before * c.sigma_before;
  shift.own_share = own / all;
  return shift;
}

DriftLimit parse_drift_limit(const std::string& text, const std::string& place) {
  const auto value = [&](Dimension dimension) {
    const double v = parse_quantity(text, dimension, place);
    if (!(v > 0)) throw Error(Exit::usage, place, "\"" + text + "\" is not above zero", "0.3mm, 0.1deg or 0.5px");
    return v;
  };
  if (text.ends_with("px")) return {value(Dimension::pixel), DriftUnit::pixels};
  if (text.ends_with("deg") || text.ends_with("rad")) return {value(Dimension::angle), DriftUnit::radians};
  return {value(Dimension::length), DriftUnit::metres};
}

std::string unit_name(DriftUnit unit) {
  return unit == DriftUnit::metres ? "m" : unit == DriftUnit::radians ? "rad" : "px";
}

DriftVerdict judge_drift(const BoardShift& shift, const DriftLimit& limit, double level) {
  const std::optional<Moved> pixels = shift.picture_px;
  const auto& moved = limit.unit == DriftUnit::metres    ? shift.position_m
                      : limit.unit == DriftUnit::radians ? shift.rotation_rad
                                                         : pixels;
  if (!moved)
    throw Error(Exit::data, "--drift-limit", "is one of the camera's pose, and the lens is not known",
                "give a limit in px, or a calibrated camera");
  const linear::SymmetricEigen<Eigen::Matrix3d> eigen(linear::as_eigen(moved->covariance));
  const Eigen::Vector3d y = eigen.eigenvectors().transpose() * linear::as_eigen(moved->by);
  const Eigen::Vector3d c = eigen.eigenvalues().cwiseMax(0.0);
  DriftVerdict verdict;
  verdict.value = y.norm();
  verdict.sigma = verdict.value > 0 ? std::sqrt(y.dot(c.cwiseProduct(y))) / verdict.value : std::sqrt(c.sum());
  if (verdict.value <= limit.value) return verdict;
  // The nearest change within the limit: x_i = y_i / (1 + m c_i) with |x| the limit; |x| falls with m.
  const auto x = [&](double m) { return Eigen::Vector3d(y.array() / (1 + m * c.array())); };
  double low = 0, high = 1 / std::max(c.maxCoeff(), 1e-300);
  while (x(high).norm() > limit.value && high < 1e300) high *= 4;
  for (int k = 0; k < 200; ++k) (x(0.5 * (low + high)).norm() > limit.value ? low : high) = 0.5 * (low + high);
  const Eigen::Vector3d off = y - x(high);
  double statistic = 0, dimension = 0;
  for (int i = 0; i < 3; ++i)
    if (c[i] > 0) statistic += off[i] * off[i] / c[i], dimension += 1;
  // Hotelling's T^2 / d is F of d and `freedom` degrees: P(F > f) = I_{v / (v + d f)}(v / 2, d / 2).
  const double p = std::isinf(shift.freedom) ? stats::chi2_upper(statistic, dimension)
                                             : stats::beta_regularised(shift.freedom / (shift.freedom + statistic),
                                                                       0.5 * shift.freedom, 0.5 * dimension);
  verdict.beyond = p < level;
  return verdict;
}

namespace {

struct Take {
  Eigen::Vector3d y;
  Eigen::Matrix3d c;
};

// T(r) of board_shift.h.
double weighted_squares(const std::vector<std::vector<Take>>& views, double r) {
  double sum = 0;
  for (const std::vector<Take>& takes : views) {
    Eigen::Matrix3d all = Eigen::Matrix3d::Zero();
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    std::vector<Eigen::Matrix3d> weights;
    for (const Take& t : takes) {
      weights.push_back(linear::inverse(Eigen::Matrix3d(t.c + r * r * Eigen::Matrix3d::Identity())));
      all += weights.back();
      mean += weights.back() * t.y;
    }
    mean = linear::solve_ldlt(all, mean);
    for (std::size_t k = 0; k < takes.size(); ++k) sum += (takes[k].y - mean).dot(weights[k] * (takes[k].y - mean));
  }
  return sum;
}

// r with T(r) = `wanted`; 0 where no scatter is needed for it.
double root_of_scatter(const std::vector<std::vector<Take>>& views, double wanted, double scale) {
  if (weighted_squares(views, 0) <= wanted) return 0;
  double low = 0, high = scale;
  while (weighted_squares(views, high) > wanted && high < 1e12 * scale) high *= 2;
  for (int k = 0; k < 80; ++k) (weighted_squares(views, 0.5 * (low + high)) > wanted ? low : high) = 0.5 * (low + high);
  return 0.5 * (low + high);
}

}  // namespace

std::optional<Scatter> scatter_of(std::span<const std::vector<Moved>> views) {
  std::vector<std::vector<Take>> takes;
  double degrees = 0, noise = 0, count = 0;
  for (const std::vector<Moved>& view : views) {
    if (view.size() < 2) continue;
    auto& list = takes.emplace_back();
    for (const Moved& m : view) {
      list.push_back({linear::as_eigen(m.by), linear::as_eigen(m.covariance)});
      noise += list.back().c.trace() / 3, count += 1;
    }
    degrees += 3 * (static_cast<double>(view.size()) - 1);
  }
  if (takes.empty()) return std::nullopt;
  const double scale = std::sqrt(noise / count);
  return Scatter{root_of_scatter(takes, degrees, scale),
                 root_of_scatter(takes, stats::chi2_quantile(0.975, degrees), scale),
                 root_of_scatter(takes, stats::chi2_quantile(0.025, degrees), scale), scale};
}

}  // namespace gonio::acquisition

// See halves.h.
#include "camera/quality/halves.h"

#include <Eigen/Core>
#include <cmath>
#include <map>

#include "base/random.h"
#include "camera/camera_model.h"
#include "camera/quality/alignment.h"
#include "camera/quality/linear_law.h"
#include "linear/solve.h"
#include "linear/symmetric_eigen.h"
#include "stats/distributions.h"

namespace gonio::camera {
namespace {

constexpr std::size_t least_views = 3;  // of a half
constexpr int grid_side = 24;
constexpr std::size_t draws = 20000;

Eigen::MatrixXd covariance_of(const Calibration& c) {
  const auto k = static_cast<Eigen::Index>(c.shared.size());
  return Eigen::Map<const Eigen::MatrixXd>(c.covariance.data(), k, k);
}

double value_of(const Calibration& c, const SharedParameter& p) {
  const Intrinsics& lens = c.cameras[0].lens;
  if (p.kind == SharedParameter::Kind::board)
    return p.name == "sag_x_m" ? c.boards[p.of].warp.sag_x_m : c.boards[p.of].warp.sag_y_m;
  if (p.name == "fx_px") return lens.fx_px;
  if (p.name == "fy_px") return lens.fy_px;
  if (p.name == "cx_px") return lens.cx_px;
  if (p.name == "cy_px") return lens.cy_px;
  return lens.distortion[distortion_index(p.name, "calibration")];
}

// The camera by itself: its views, and a setup without the others that starts at what the whole found.
struct Alone {
  std::vector<View> views;
  CalibrationSetup setup;
  explicit Alone(const CameraResult& camera) : setup{{camera.setup.cameras[camera.camera]}, camera.setup.boards} {
    setup.cameras[0].start = camera.lens();
    for (std::size_t i = 0; i < camera.views.size(); ++i) {
      if (!camera.uses(i)) continue;
      views.push_back(camera.views[i]);
      views.back().camera = 0;
    }
  }
};

// All views' points in the frame of one half's camera.
std::vector<Vec3> points_under(const Calibration& half, const CameraResult& whole) {
  std::vector<Vec3> points;
  const double loss_px = 3 * std::max(whole.noise_px(), 1e-3);
  for (std::size_t i = 0; i < whole.views.size(); ++i) {
    if (!whole.uses(i)) continue;
    const BoardWarp& warp = half.boards[whole.views[i].board].warp;
    const BoardPose pose = pose_under(whole.views[i], whole.board(i), half.cameras[0].lens, warp,
                                      whole.calibration.views[i].camera_from_board, loss_px);
    append_points(whole.views[i], whole.board(i), warp, pose, points);
  }
  return points;
}

// The chance of numbers so far apart, each measured against its uncertainty (chi-square).
double chance_of_numbers(const Calibration& a, const Calibration& b, const Eigen::MatrixXd& covariance) {
  Eigen::VectorXd d(static_cast<Eigen::Index>(a.shared.size()));
  for (std::size_t k = 0; k < a.shared.size(); ++k)
    d[static_cast<Eigen::Index>(k)] = value_of(a, a.shared[k]) - value_of(b, b.shared[k]);
  const Eigen::VectorXd unit = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlation = unit.asDiagonal() * covariance * unit.asDiagonal();
  const Eigen::VectorXd z = unit.asDiagonal() * d;
  return stats::chi2_upper(z.dot(linear::solve_ldlt(correlation, z)), static_cast<double>(a.shared.size()));
}

// The chance of a mean square this large under N(0, sum of both covariances), where it is d' W d.
double chance_of_pixels(double mean_square, const Eigen::MatrixXd& covariance, const Eigen::MatrixXd& w) {
  const Eigen::VectorXd unit = covariance.diagonal().cwiseSqrt();
  const Eigen::MatrixXd correlation = unit.cwiseInverse().asDiagonal() * covariance * unit.cwiseInverse().asDiagonal();
  const linear::SymmetricEigen<Eigen::MatrixXd> eigen(correlation);
  const Eigen::MatrixXd root =
      unit.asDiagonal() * eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
  const Eigen::VectorXd weights =
      linear::SymmetricEigen<Eigen::MatrixXd>(root.transpose() * w * root).eigenvalues();
  Random random(1, 0x68616c66u);
  std::size_t above = 0;
  for (std::size_t n = 0; n < draws; ++n) {
    double sum = 0;
    for (Eigen::Index k = 0; k < weights.size(); ++k) {
      const double z = random.normal();
      sum += weights[k] * z * z;
    }
    above += sum >= mean_square;
  }
  return static_cast<double>(above + 1) / static_cast<double>(draws + 1);
}

// The difference of both halves' predictions over the image, and W: the mean of G'G there.
struct Difference {
  double mean_square = 0;
  Eigen::MatrixXd w;
};
Difference difference_of(const Calibration& a, const Calibration& b, const CameraResult& whole,
                         const std::vector<double>& distances_m, Halves& result) {
  const auto motion = aligned(points_under(a, whole), points_under(b, whole));
  const ProjectionLaw law(whole);
  const CameraModel camera(a.cameras[0].lens, whole.width_px(), whole.height_px());
  result.grid = image_grid(whole.width_px(), whole.height_px(), grid_side);
  const auto k = static_cast<Eigen::Index>(whole.calibration.shared.size());
  Difference sum{0, Eigen::MatrixXd::Zero(k, k)};
  double count = 0;
  for (std::size_t n = 0; n < distances_m.size(); ++n) {
    const bool far = !std::isfinite(distances_m[n]);
    for (int j = 0; j < result.grid.rows; ++j)
      for (int i = 0; i < result.grid.columns; ++i) {
        const Vec2 pixel = result.grid.pixel(i, j);
        const Vec3 direction = camera.ray(pixel).direction, point = far ? direction : direction * distances_m[n];
        const auto seen = project(b.cameras[0].lens, far ? motion.rotate(point) : motion * point);
        const auto own = project(a.cameras[0].lens, direction);
        PixelDerivatives d;
        const bool known =
            seen && own && norm(*own - pixel) < 0.01 && pixel_derivatives(whole.lens(), law.linear(), point, far, d);
        if (n == 0) result.difference_px.push_back(known ? *seen - pixel : Vec2{std::nan(""), std::nan("")});
        if (!known) continue;
        sum.mean_square += dot(*seen - pixel, *seen - pixel);
        sum.w += d.by_shared.transpose() * d.by_shared;
        count += 1;
      }
  }
  sum.mean_square /= std::max(count, 1.0);
  sum.w /= std::max(count, 1.0);
  return sum;
}

}  // namespace

Halves compare_halves(const CameraResult& camera, const std::vector<double>& distances_m, double level) {
  Halves result;
  const Alone alone(camera);
  std::map<std::size_t, std::size_t> shots;  // in the order of the views
  std::vector<View> views[2];
  for (const View& view : alone.views)
    views[shots.try_emplace(view.shot, shots.size()).first->second % 2].push_back(view);
  if (shots.size() < 2 * least_views) {
    result.refused =
        std::to_string(shots.size()) + " views are too few to halve (at least " + std::to_string(2 * least_views) + ")";
    return result;
  }
  const bool single = camera.setup.cameras.size() == 1;
  const Calibration by_itself = single ? Calibration{} : calibrate(alone.views, alone.setup);
  const CameraResult whole = single ? camera : CameraResult{alone.views, alone.setup, by_itself, 0};
  const Calibration a = calibrate(views[0], alone.setup), b = calibrate(views[1], alone.setup);
  for (const Calibration* c : {&whole.calibration, &a, &b}) {
    if (!c->covariance.empty() && c->converged && c->shared == whole.calibration.shared) continue;
    result.refused = "half of the views does not determine the camera";
    return result;
  }
  const Difference difference = difference_of(a, b, whole, distances_m, result);
  const Eigen::MatrixXd covariance = covariance_of(a) + covariance_of(b);
  result.differ_px = std::sqrt(difference.mean_square);
  result.expected_px = std::sqrt((difference.w * covariance).trace());
  const double of_pixels = chance_of_pixels(difference.mean_square, covariance, difference.w);
  result.p = std::min(1.0, 2 * std::min(of_pixels, chance_of_numbers(a, b, covariance)));
  result.agree = result.p > level;
  return result;
}

}  // namespace gonio::camera

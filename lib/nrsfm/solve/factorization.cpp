// Centred tracks, truncated factors, trajectory bases, nearest rotations and single cameras.
#include "nrsfm/solve/factorization.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "linear/solve.h"
#include "linear/svd.h"
#include "linear/symmetric_eigen.h"
#include "nrsfm/solve/solver.h"
#include "stats/intervals.h"

namespace gonio::nrsfm {
namespace {

Eigen::Matrix3d turned_by(const Eigen::Vector3d& rotation_rad) {
  const double angle = rotation_rad.norm();
  if (angle < 1e-300) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, rotation_rad / angle).toRotationMatrix();
}

// Visible points less their mean, and three more at the roots of the spread, seen at 0.
struct Seen {
  Eigen::Matrix2Xd tracks;
  Eigen::Matrix3Xd shape;
  Eigen::Vector2d track_mean;
  Eigen::Vector3d shape_mean;
};

Seen seen_of(const Eigen::Matrix2Xd& tracks, const Eigen::Array<bool, 1, Eigen::Dynamic>& visible,
             const Eigen::Matrix3Xd& shape, const Eigen::Matrix3d& spread) {
  Seen seen;
  const Eigen::Index count = visible.count();
  seen.tracks = Eigen::Matrix2Xd::Zero(2, count + 3);
  seen.shape.resize(3, count + 3);
  for (Eigen::Index p = 0, at = 0; p < visible.size(); ++p) {
    if (!visible(p)) continue;
    seen.tracks.col(at) = tracks.col(p);
    seen.shape.col(at++) = shape.col(p);
  }
  auto tracks_seen = seen.tracks.leftCols(count);
  auto shape_seen = seen.shape.leftCols(count);
  seen.track_mean = count > 0 ? Eigen::Vector2d(tracks_seen.rowwise().mean()) : Eigen::Vector2d::Zero();
  seen.shape_mean = count > 0 ? Eigen::Vector3d(shape_seen.rowwise().mean()) : Eigen::Vector3d::Zero();
  tracks_seen.colwise() -= seen.track_mean;
  shape_seen.colwise() -= seen.shape_mean;
  const linear::SymmetricEigen<Eigen::Matrix3d> root(spread);
  seen.shape.rightCols<3>() = root.eigenvectors() * root.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
  return seen;
}

// Of min_s |W - s R X|^2.
double best_scale(const Seen& seen, const CameraRows& rotation, double otherwise) {
  const Eigen::Matrix2Xd at = rotation * seen.shape;
  const double energy = at.squaredNorm();
  const double scale = energy > 0 ? seen.tracks.cwiseProduct(at).sum() / energy : otherwise;
  return scale > 0 ? scale : otherwise;
}

}  // namespace

Centred centred(const Sequence& sequence) {
  const Eigen::Index frames = sequence.frames(), points = sequence.points();
  Centred result{Eigen::MatrixXd::Zero(2 * frames, points), Eigen::VectorXd::Zero(2 * frames)};
  for (Eigen::Index row = 0; row < 2 * frames; ++row) {
    const auto visible = sequence.visible.row(row / 2);
    const Eigen::Index count = visible.count();
    if (count == 0) continue;
    const auto tracks = sequence.tracks.row(row).array();
    const double mean = visible.select(tracks, 0.0).sum() / static_cast<double>(count);
    result.translation(row) = mean;
    result.w.row(row) = visible.select(tracks - mean, 0.0);
  }
  return result;
}

Eigen::MatrixXd motion_rows(const Eigen::MatrixXd& w, Eigen::Index terms) {
  const linear::DividedSvd svd(w, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::Index columns = 3 * terms, there = std::min(columns, svd.singularValues().size());
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(w.rows(), columns);
  rows.leftCols(there) = svd.matrixU().leftCols(there) * svd.singularValues().head(there).cwiseSqrt().asDiagonal();
  return rows;
}

double noise_of(const Eigen::MatrixXd& w) {
  std::vector<double> thirds;
  for (Eigen::Index f = 3; f < w.rows() / 2; ++f) {
    const auto third = w.middleRows<2>(2 * f) - 3 * w.middleRows<2>(2 * f - 2) + 3 * w.middleRows<2>(2 * f - 4) -
                       w.middleRows<2>(2 * f - 6);
    for (const double x : third.reshaped()) thirds.push_back(std::abs(x));
  }
  if (thirds.empty()) return 0;
  return stats::sigma_of_median * stats::median(thirds) / std::sqrt(20);
}

Eigen::Index rank_of(const Eigen::MatrixXd& w, double share, Eigen::Index most) {
  const linear::DividedSvd svd(w);
  const Eigen::VectorXd energy = svd.singularValues().array().square();
  const Eigen::Index limit = std::max<Eigen::Index>(1, std::min(most, energy.size() / 3));
  const double noise = std::pow(noise_of(w), 2) * static_cast<double>(w.size());
  const double left_over = std::max(share * share * energy.sum(), noise);
  for (Eigen::Index terms = 1; terms < limit; ++terms) {
    if (energy.tail(energy.size() - 3 * terms).sum() <= left_over) return terms;
  }
  return limit;
}

Eigen::MatrixXd dct_basis(Eigen::Index frames, Eigen::Index terms) {
  Eigen::MatrixXd basis(frames, terms);
  const double n = static_cast<double>(frames);
  for (Eigen::Index k = 0; k < terms; ++k) {
    const double norm = std::sqrt((k == 0 ? 1 : 2) / n);
    for (Eigen::Index f = 0; f < frames; ++f) {
      const double phase = std::numbers::pi * (static_cast<double>(f) + 0.5) * static_cast<double>(k) / n;
      basis(f, k) = norm * std::cos(phase);
    }
  }
  return basis;
}

CameraRows nearest_rows(const CameraRows& a) {
  const linear::JacobiSvd<Eigen::MatrixXd> svd(a, Eigen::ComputeThinU | Eigen::ComputeThinV);
  return svd.matrixU() * svd.matrixV().transpose();
}

Eigen::Matrix3d completed(const CameraRows& rows) {
  Eigen::Matrix3d rotation;
  rotation.topRows<2>() = rows;
  rotation.row(2) = rows.row(0).cross(rows.row(1));
  return rotation;
}

// Gauss-Newton on the rotation: R <- R exp([v]x), d(s R x)/dv = -s R [x]x; the translation follows from the means.
WeakCamera fit_camera(const Eigen::Matrix2Xd& tracks, const Eigen::Array<bool, 1, Eigen::Dynamic>& visible,
                      const Eigen::Matrix3Xd& shape, const WeakCamera& start, bool free_scale,
                      const Eigen::Matrix3d& spread) {
  const Seen seen = seen_of(tracks, visible, shape, spread);
  WeakCamera camera = start;
  if (visible.count() >= 3) {
    const auto cost_of = [&](const WeakCamera& c) {
      return (seen.tracks - c.scale * c.rotation * seen.shape).squaredNorm();
    };
    if (free_scale) camera.scale = best_scale(seen, camera.rotation, camera.scale);
    double cost = cost_of(camera), damping = 1e-6;
    for (int iteration = 0; iteration < 30; ++iteration) {
      Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
      Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
      for (Eigen::Index p = 0; p < seen.tracks.cols(); ++p) {
        const Eigen::Vector3d x = seen.shape.col(p);
        Eigen::Matrix3d cross;
        cross << 0, -x(2), x(1), x(2), 0, -x(0), -x(1), x(0), 0;
        const Eigen::Matrix<double, 2, 3> slope = -camera.scale * camera.rotation * cross;
        normal += slope.transpose() * slope;
        gradient += slope.transpose() * (seen.tracks.col(p) - camera.scale * camera.rotation * x);
      }
      normal.diagonal().array() += damping * normal.trace() + 1e-300;
      WeakCamera tried = camera;
      tried.rotation = nearest_rows(camera.rotation * turned_by(linear::solve_ldlt(normal, gradient)));
      if (free_scale) tried.scale = best_scale(seen, tried.rotation, camera.scale);
      const double tried_cost = cost_of(tried);
      if (!(tried_cost < cost)) {
        if (damping > 1) break;
        damping *= 30;
        continue;
      }
      const bool done = cost - tried_cost < 1e-14 * cost;
      camera = tried;
      cost = tried_cost;
      damping = std::max(damping / 10, 1e-12);
      if (done) break;
    }
  }
  camera.translation = seen.track_mean - camera.scale * camera.rotation * seen.shape_mean;
  return camera;
}

Shapes shapes_of(const Eigen::MatrixXd& coefficients, const Eigen::MatrixXd& basis) {
  Shapes shapes = Shapes::Zero(3 * coefficients.rows(), basis.cols());
  for (Eigen::Index f = 0; f < coefficients.rows(); ++f) {
    for (Eigen::Index k = 0; k < coefficients.cols(); ++k) {
      shape_of(shapes, f) += coefficients(f, k) * basis.middleRows<3>(3 * k);
    }
  }
  return shapes;
}

Start centred_start(const Sequence& sequence, Eigen::Index terms) {
  Start start;
  if (sequence.complete()) {
    Centred plain = centred(sequence);
    start.w = std::move(plain.w);
    start.translation = std::move(plain.translation);
  } else {
    Completion filled = complete(sequence, 3 * terms);
    start.w = std::move(filled.w);
    start.translation = std::move(filled.translation);
  }
  return start;
}

void take_cameras(Start& start, const Upgrade& upgrade) {
  start.upgrade = upgrade;
  start.rows.resize(start.w.rows(), 3);
  for (Eigen::Index f = 0; f < upgrade.scales.size(); ++f) {
    start.rows.middleRows<2>(2 * f) = upgrade.scales(f) * upgrade.rotations[static_cast<std::size_t>(f)];
  }
}

Start start_from(const Sequence& sequence, Eigen::Index terms, const UpgradeOptions& options) {
  Start start = centred_start(sequence, terms);
  take_cameras(start, metric_upgrade(motion_rows(start.w, terms), options));
  return start;
}

void turn_to_first_camera(Reconstruction& reconstruction) {
  if (reconstruction.rotations.empty() || reconstruction.frame != ShapeFrame::object) return;
  const Eigen::Matrix3d first = completed(reconstruction.rotations.front());
  for (Eigen::Index f = 0; f < reconstruction.frames(); ++f) {
    shape_of(reconstruction.shapes, f) = (first * shape_of(reconstruction.shapes, f)).eval();
    CameraRows& rotation = reconstruction.rotations[static_cast<std::size_t>(f)];
    rotation = (rotation * first.transpose()).eval();
  }
}

}  // namespace gonio::nrsfm

// See deforming_model.h. Derivatives of u: with n = 1 / (1 + kappa s q_z)
//   du/dq_xy = n s I,   du/dq_z = -U n^2 kappa s,   du/dt = n I,   du/dkappa = -U n^2 s q_z,
//   du/dl = n s q_xy - U n^2 kappa s q_z,   dq/dw = -[q]x J(w),  J the left Jacobian of the rotation vector.
#include "nrsfm/solve/deforming_model.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace gonio::nrsfm {
namespace {

constexpr double nearest = 1e-2;  // of 1 + kappa s z: points do not pass behind the camera

Eigen::Matrix3d crossed(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Eigen::Matrix3d turned_by(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  if (angle < 1e-300) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
}

// I + (1 - cos a) / a^2 [w]x + (a - sin a) / a^3 [w]x^2
Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& w) {
  const double a2 = w.squaredNorm(), a = std::sqrt(a2);
  const double first = a < 1e-4 ? 0.5 - a2 / 24 : (1 - std::cos(a)) / a2;
  const double second = a < 1e-4 ? 1.0 / 6 - a2 / 120 : (a - std::sin(a)) / (a2 * a);
  const Eigen::Matrix3d c = crossed(w);
  return Eigen::Matrix3d::Identity() + first * c + second * c * c;
}

}  // namespace

Layout layout_of(const SolvedModel& m) {
  Layout l;
  const auto frames = static_cast<std::size_t>(m.frame_count());
  l.rotation = 0;
  l.shift = l.rotation + 3 * frames;
  l.scale = l.shift + 2 * frames;
  l.weight = l.scale + frames - 1;
  l.basis = l.weight + static_cast<std::size_t>(m.held.size() - m.held.count());
  l.perspective = l.basis + static_cast<std::size_t>(3 * m.terms() * m.point_count());
  l.count = l.perspective + 1;
  return l;
}

DeformingModel::DeformingModel(SolvedModel start) : start_(std::move(start)), layout_(layout_of(start_)) {
  for (Eigen::Index k = 0; k < start_.x.cols(); ++k)
    for (Eigen::Index j = 0; j < start_.x.rows(); ++j)
      if (!start_.held(j, k)) free_weights_.emplace_back(j, k);
}

std::vector<double> DeformingModel::values() const {
  std::vector<double> v(layout_.count, 0.0);
  for (Eigen::Index f = 0; f < start_.frame_count(); ++f)
    for (Eigen::Index i = 0; i < 2; ++i)
      v[layout_.shift + static_cast<std::size_t>(2 * f + i)] = start_.translation(i, f);
  for (Eigen::Index f = 1; f < start_.frame_count(); ++f)
    v[layout_.scale + static_cast<std::size_t>(f - 1)] = start_.log_scale(f);
  for (std::size_t k = 0; k < free_weights_.size(); ++k)
    v[layout_.weight + k] = start_.x(free_weights_[k].first, free_weights_[k].second);
  std::size_t at = layout_.basis;
  for (const Eigen::MatrixXd& b : start_.basis)
    for (Eigen::Index i = 0; i < b.size(); ++i) v[at++] = b.data()[i];
  return v;
}

Eigen::MatrixXd DeformingModel::weights(std::span<const double> values) const {
  Eigen::MatrixXd x = start_.x;
  for (std::size_t k = 0; k < free_weights_.size(); ++k)
    x(free_weights_[k].first, free_weights_[k].second) = values[layout_.weight + k];
  return start_.omega * x;
}

std::vector<DeformingModel::Frame> DeformingModel::frames(std::span<const double> values) const {
  const Eigen::MatrixXd c = weights(values);
  const auto count = static_cast<std::size_t>(start_.frame_count());
  std::vector<Frame> result(count);
  double others = 0;
  for (std::size_t f = 1; f < count; ++f) others += values[layout_.scale + f - 1];
  for (std::size_t f = 0; f < count; ++f) {
    const double* w = &values[layout_.rotation + 3 * f];
    const Eigen::Vector3d turn(w[0], w[1], w[2]);
    Frame& frame = result[f];
    frame.rotation = turned_by(turn) * start_.rotation[f];
    frame.turned = left_jacobian(turn);
    frame.shift << values[layout_.shift + 2 * f], values[layout_.shift + 2 * f + 1];
    frame.scale = std::exp(f == 0 ? -others : values[layout_.scale + f - 1]);
    frame.weights = c.row(static_cast<Eigen::Index>(f)).transpose();
  }
  return result;
}

Eigen::Map<const Eigen::Matrix3Xd> DeformingModel::shapes(std::span<const double> values, std::size_t point) const {
  const Eigen::Index terms = start_.terms();
  return {&values[layout_.basis + point * static_cast<std::size_t>(3 * terms)], 3, terms};
}

Eigen::Vector3d DeformingModel::in_camera(std::span<const double> values, const Frame& frame, std::size_t point) const {
  return frame.scale * (frame.rotation * (shapes(values, point) * frame.weights));
}

void DeformingModel::predict(std::span<const double> values, std::size_t point, std::span<const Eigen::Index> seen,
                             std::span<double> prediction) const {
  const std::vector<Frame> all = frames(values);
  const double kappa = values[layout_.perspective];
  for (std::size_t r = 0; r < seen.size(); ++r) {
    const Frame& frame = all[static_cast<std::size_t>(seen[r])];
    const Eigen::Vector3d q = in_camera(values, frame, point);
    const double near = 1 / std::max(nearest, 1 + kappa * q.z());
    const Eigen::Vector2d u = start_.centre + near * (q.head<2>() + frame.shift - start_.centre);
    prediction[2 * r] = u.x();
    prediction[2 * r + 1] = u.y();
  }
}

struct DeformingModel::Slopes {
  Eigen::Matrix<double, 2, 3> by_place;  // du/dq
  Eigen::Vector3d place;                 // q, without the scale
  Eigen::Vector2d by_scale, by_perspective;
  double by_shift = 1;
};

void DeformingModel::fill_column(std::span<const double> values, std::size_t column, std::size_t point,
                                 std::span<const Eigen::Index> seen, const std::vector<Frame>& frames,
                                 const std::vector<Slopes>& slopes, std::span<double> d) const {
  const Layout& l = layout_;
  const auto put = [&](std::size_t r, const Eigen::Vector2d& v) { d[2 * r] = v.x(), d[2 * r + 1] = v.y(); };
  const auto terms = static_cast<std::size_t>(start_.terms());
  const auto frame_of = [&](std::size_t r) { return static_cast<std::size_t>(seen[r]); };
  std::fill(d.begin(), d.end(), 0.0);
  if (column < l.scale) {
    const bool turn = column < l.shift;
    const std::size_t within = turn ? column - l.rotation : column - l.shift, f = within / (turn ? 3 : 2);
    const auto axis = static_cast<Eigen::Index>(within % (turn ? 3 : 2));
    for (std::size_t r = 0; r < seen.size(); ++r) {
      if (frame_of(r) != f) continue;
      if (turn)
        put(r, -slopes[r].by_place * crossed(slopes[r].place) * frames[f].turned.col(axis));
      else
        put(r, slopes[r].by_shift * Eigen::Vector2d::Unit(axis));
    }
  } else if (column < l.weight) {
    const std::size_t f = column - l.scale + 1;
    for (std::size_t r = 0; r < seen.size(); ++r)
      if (frame_of(r) == f || frame_of(r) == 0) put(r, (frame_of(r) == f ? 1 : -1) * slopes[r].by_scale);
  } else if (column < l.basis) {
    const auto [j, k] = free_weights_[column - l.weight];
    for (std::size_t r = 0; r < seen.size(); ++r)
      if (const double share = start_.omega(seen[r], j); share != 0)
        put(r, share * slopes[r].by_place * frames[frame_of(r)].rotation * shapes(values, point).col(k));
  } else if (column < l.perspective) {
    const std::size_t within = column - l.basis;
    if (within / (3 * terms) != point) return;
    const auto axis = static_cast<Eigen::Index>(within % 3), k = static_cast<Eigen::Index>(within % (3 * terms) / 3);
    for (std::size_t r = 0; r < seen.size(); ++r)
      put(r, frames[frame_of(r)].weights(k) * slopes[r].by_place * frames[frame_of(r)].rotation.col(axis));
  } else if (column == l.perspective) {
    for (std::size_t r = 0; r < seen.size(); ++r) put(r, slopes[r].by_perspective);
  }
}

void DeformingModel::jacobian(std::span<const double> values, std::size_t point, std::span<const Eigen::Index> seen,
                              std::span<const std::size_t> columns, std::span<double> derivatives) const {
  const std::vector<Frame> all = frames(values);
  const double kappa = values[layout_.perspective];
  std::vector<Slopes> slopes(seen.size());
  for (std::size_t r = 0; r < seen.size(); ++r) {
    const Frame& frame = all[static_cast<std::size_t>(seen[r])];
    const Eigen::Vector3d q = in_camera(values, frame, point);
    const double near = 1 / std::max(nearest, 1 + kappa * q.z());
    const Eigen::Vector2d about = q.head<2>() + frame.shift - start_.centre;
    Slopes& s = slopes[r];
    s.place = q / frame.scale;
    s.by_place.leftCols<2>() = near * frame.scale * Eigen::Matrix2d::Identity();
    s.by_place.col(2) = -about * near * near * kappa * frame.scale;
    s.by_perspective = -about * near * near * q.z();
    s.by_scale = near * q.head<2>() + kappa * s.by_perspective;
    s.by_shift = near;
  }
  const std::size_t rows = 2 * seen.size();
  for (std::size_t c = 0; c < columns.size(); ++c)
    fill_column(values, columns[c], point, seen, all, slopes, derivatives.subspan(c * rows, rows));
}

}  // namespace gonio::nrsfm

// Bundle adjustment of one shape. With H_a, H_b the blocks of cameras and of points, damped, and L L' = H their
// factors, the step (x_a, x_b), x = L'^-1 y, obeys
//   [I E; E' I] (y_a, y_b) = (L_a^-1 g_a, L_b^-1 g_b),   E = L_a^-1 H_ab L_b'^-1
// of which the smaller half is solved: (I - E'E) y_b = c_b - E' c_a,  y_a = c_a - E y_b, or the other way about.
// A camera's parameters: turn v (R exp([v]x)), translation, logarithm of the scale (left alone where scales are held).
#include "nrsfm/solve/rigid_motion.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/atomic_file.h"
#include "linear/solve.h"
#include "linear/symmetric_eigen.h"

namespace gonio::nrsfm {
namespace {

constexpr Eigen::Index kOfCamera = 6, kOfPoint = 3;

struct Equations {
  Eigen::MatrixXd coupling;  // 6F x 3P: H_ab
  std::vector<Eigen::Matrix<double, 6, 6>> cameras;
  std::vector<Eigen::Matrix3d> points;
  Eigen::VectorXd of_cameras, of_points;  // gradients
};

Eigen::Vector2d residual(const Sequence& sequence, const RigidMotion& at, Eigen::Index f, Eigen::Index p) {
  const WeakCamera& camera = at.cameras[static_cast<std::size_t>(f)];
  return sequence.tracks.block<2, 1>(2 * f, p) - camera.translation - camera.scale * camera.rotation * at.shape.col(p);
}

double cost_of(const Sequence& sequence, const RigidMotion& at) {
  double cost = 0;
  for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
    for (Eigen::Index p = 0; p < sequence.points(); ++p) {
      if (sequence.visible(f, p)) cost += residual(sequence, at, f, p).squaredNorm();
    }
  }
  return cost;
}

Equations equations_of(const Sequence& sequence, const RigidMotion& at, bool free_scales) {
  const Eigen::Index frames = sequence.frames(), points = sequence.points();
  Equations e;
  e.coupling = Eigen::MatrixXd::Zero(kOfCamera * frames, kOfPoint * points);
  e.cameras.assign(static_cast<std::size_t>(frames), Eigen::Matrix<double, 6, 6>::Zero());
  e.points.assign(static_cast<std::size_t>(points), Eigen::Matrix3d::Zero());
  e.of_cameras = Eigen::VectorXd::Zero(kOfCamera * frames);
  e.of_points = Eigen::VectorXd::Zero(kOfPoint * points);
  for (Eigen::Index f = 0; f < frames; ++f) {
    const WeakCamera& camera = at.cameras[static_cast<std::size_t>(f)];
    const CameraRows rows = camera.scale * camera.rotation;
    for (Eigen::Index p = 0; p < points; ++p) {
      if (!sequence.visible(f, p)) continue;
      const Eigen::Vector3d x = at.shape.col(p);
      Eigen::Matrix3d cross;
      cross << 0, -x(2), x(1), x(2), 0, -x(0), -x(1), x(0), 0;
      Eigen::Matrix<double, 2, 6> slope;
      slope.leftCols<3>() = -rows * cross;
      slope.middleCols<2>(3).setIdentity();
      slope.col(5) = free_scales ? Eigen::Vector2d(rows * x) : Eigen::Vector2d::Zero();
      const Eigen::Vector2d r = residual(sequence, at, f, p);
      e.cameras[static_cast<std::size_t>(f)] += slope.transpose() * slope;
      e.points[static_cast<std::size_t>(p)] += rows.transpose() * rows;
      e.coupling.block<6, 3>(kOfCamera * f, kOfPoint * p) = slope.transpose() * rows;
      e.of_cameras.segment<6>(kOfCamera * f) += slope.transpose() * r;
      e.of_points.segment<3>(kOfPoint * p) += rows.transpose() * r;
    }
  }
  return e;
}

// Factors of damped blocks; c <- L^-1 g.
template <class Block>
std::vector<Eigen::LLT<Block>> factors_of(const std::vector<Block>& blocks, double damping, Eigen::VectorXd& c) {
  std::vector<Eigen::LLT<Block>> factors;
  const Eigen::Index n = Block::RowsAtCompileTime;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    Block block = blocks[i];
    block.diagonal() *= 1 + damping;
    block.diagonal().array() += 1e-12 * block.trace() + 1e-300;
    factors.emplace_back(block);
    auto part = c.segment(static_cast<Eigen::Index>(i) * n, n);
    part = factors.back().matrixL().solve(part).eval();
  }
  return factors;
}

template <class Block>
void undo_factors(const std::vector<Eigen::LLT<Block>>& factors, Eigen::VectorXd& y) {
  const Eigen::Index n = Block::RowsAtCompileTime;
  for (std::size_t i = 0; i < factors.size(); ++i) {
    auto part = y.segment(static_cast<Eigen::Index>(i) * n, n);
    part = factors[i].matrixU().solve(part).eval();
  }
}

struct Step {
  Eigen::VectorXd cameras, points;
};

Step step_of(const Equations& e, double damping) {
  Step step{e.of_cameras, e.of_points};
  const auto cameras = factors_of(e.cameras, damping, step.cameras);
  const auto points = factors_of(e.points, damping, step.points);
  Eigen::MatrixXd coupling = e.coupling;
  for (std::size_t f = 0; f < cameras.size(); ++f) {
    auto rows = coupling.middleRows<6>(kOfCamera * static_cast<Eigen::Index>(f));
    rows = cameras[f].matrixL().solve(rows).eval();
  }
  for (std::size_t p = 0; p < points.size(); ++p) {
    auto columns = coupling.middleCols<3>(kOfPoint * static_cast<Eigen::Index>(p));
    columns = points[p].matrixL().solve(columns.transpose()).transpose().eval();
  }
  const bool few_points = coupling.cols() <= coupling.rows();
  Eigen::VectorXd& kept = few_points ? step.points : step.cameras;
  Eigen::VectorXd& gone = few_points ? step.cameras : step.points;
  const Eigen::MatrixXd link = few_points ? coupling : Eigen::MatrixXd(coupling.transpose());  // gone x kept
  Eigen::MatrixXd reduced = Eigen::MatrixXd::Identity(kept.size(), kept.size());
  reduced.selfadjointView<Eigen::Lower>().rankUpdate(link.transpose(), -1);
  reduced.diagonal().array() += 1e-13;
  kept = linear::solve_ldlt(reduced, kept - link.transpose() * gone).eval();
  gone -= link * kept;
  undo_factors(cameras, step.cameras);
  undo_factors(points, step.points);
  return step;
}

RigidMotion moved(const RigidMotion& at, const Step& step) {
  RigidMotion next = at;
  for (std::size_t f = 0; f < next.cameras.size(); ++f) {
    WeakCamera& camera = next.cameras[f];
    const auto part = step.cameras.segment<6>(kOfCamera * static_cast<Eigen::Index>(f));
    const Eigen::Vector3d turn = part.head<3>();
    const double angle = turn.norm();
    if (angle > 0) camera.rotation *= Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
    camera.translation += part.segment<2>(3);
    camera.scale *= std::exp(std::clamp(part(5), -1.0, 1.0));
  }
  next.shape += step.points.reshaped(3, next.shape.cols());
  return next;
}

void descend(const Sequence& sequence, const RigidOptions& options, RigidMotion& at) {
  const double floor = 1e-26 * static_cast<double>(sequence.frames()) * at.shape.squaredNorm();
  double damping = 1e-3;
  at.converged = at.cost <= floor;
  while (!at.converged && at.iterations < options.most_iterations) {
    throw_if_interrupted();
    ++at.iterations;
    const Equations equations = equations_of(sequence, at, options.free_scales);
    bool better = false;
    for (int tries = 0; tries < 12 && !better; ++tries) {
      RigidMotion next = moved(at, step_of(equations, damping));
      next.cost = cost_of(sequence, next);
      better = next.cost < at.cost;
      if (!better) {
        damping *= 5;
        continue;
      }
      const double fall = (at.cost - next.cost) / at.cost;
      at = std::move(next);
      at.converged = at.cost <= floor || fall < options.tolerance;
      damping = std::max(damping / 8, 1e-12);
    }
    at.converged = at.converged || !better;
  }
}

// Poses mirrored in depth about the shape's plane, where they fit better.
bool turn_flat_frames(const Sequence& sequence, bool free_scales, RigidMotion& at) {
  const Eigen::Vector3d middle = at.shape.rowwise().mean();
  const Eigen::Matrix3Xd less = at.shape.colwise() - middle;
  const linear::SymmetricEigen<Eigen::Matrix3d> axes(Eigen::Matrix3d(less * less.transpose()));
  const Eigen::Vector3d normal = axes.eigenvectors().col(0);
  const auto cost = [&](Eigen::Index f) {
    double sum = 0;
    for (Eigen::Index p = 0; p < sequence.points(); ++p) {
      if (sequence.visible(f, p)) sum += residual(sequence, at, f, p).squaredNorm();
    }
    return sum;
  };
  bool turned = false;
  for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
    WeakCamera& camera = at.cameras[static_cast<std::size_t>(f)];
    const WeakCamera before = camera;
    const double cost_before = cost(f);
    WeakCamera other = camera;
    other.rotation -= 2 * (other.rotation * normal) * normal.transpose();
    camera = fit_camera(sequence.tracks.middleRows<2>(2 * f), sequence.visible.row(f), at.shape, other, free_scales);
    const double gain = cost_before - cost(f);
    if (gain > 1e-6 * cost_before) {
      turned = true;
      at.cost -= gain;
    } else {
      camera = before;
    }
  }
  return turned;
}

}  // namespace

Eigen::Matrix3Xd rigid_shape(const Sequence& sequence, const std::vector<WeakCamera>& cameras) {
  Eigen::Matrix3Xd shape(3, sequence.points());
  for (Eigen::Index p = 0; p < sequence.points(); ++p) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
      if (!sequence.visible(f, p)) continue;
      const WeakCamera& camera = cameras[static_cast<std::size_t>(f)];
      const CameraRows rows = camera.scale * camera.rotation;
      normal += rows.transpose() * rows;
      right += rows.transpose() * (sequence.tracks.block<2, 1>(2 * f, p) - camera.translation);
    }
    shape.col(p) = linear::solve_ldlt(normal, right);
  }
  return shape;
}

RigidMotion refine_rigid(const Sequence& sequence, std::vector<WeakCamera> start, const RigidOptions& options) {
  RigidMotion at;
  at.cameras = std::move(start);
  at.shape = rigid_shape(sequence, at.cameras);
  at.cost = cost_of(sequence, at);
  descend(sequence, options, at);
  for (int round = 0; round < 5 && turn_flat_frames(sequence, options.free_scales, at); ++round) {
    descend(sequence, options, at);
  }
  double scale = 0;
  for (const WeakCamera& camera : at.cameras) scale += camera.scale / static_cast<double>(at.cameras.size());
  const Eigen::Vector3d middle = at.shape.rowwise().mean();
  for (WeakCamera& camera : at.cameras) {
    camera.translation += camera.scale * camera.rotation * middle;
    camera.scale /= scale;
  }
  at.shape = scale * (at.shape.colwise() - middle).eval();
  return at;
}

}  // namespace gonio::nrsfm

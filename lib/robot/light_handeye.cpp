#include "robot/light_handeye.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "linear/svd.h"
#include "linear/symmetric_eigen.h"
#include "robot/handeye/matrices.h"
#include "robot/handeye/observability.h"
#include "stats/distributions.h"

namespace gonio::robot {
namespace {

using handeye::cross_matrix;
using handeye::eigen_of;
using handeye::Matrix3;
using handeye::nearest_rotation;
using handeye::quaternion_from;
using handeye::vec_of;
using handeye::Vector3;
using Matrix9 = Eigen::Matrix<double, 9, 9>;
using Vector9 = Eigen::Matrix<double, 9, 1>;
using Matrix3x9 = Eigen::Matrix<double, 3, 9>;

constexpr int alternations = 200, most_steps = 100, disturbances = 24;
constexpr double rounding_share = 1e-10, feigned_limit = 0.25, part_of_direction = 0.2, least_m = 1e-12;

struct State {
  Matrix3 rotation = Matrix3::Identity();
  Vector3 shift = Vector3::Zero(), light = Vector3::Zero();
};
struct Row {
  Vector3 e;  // predicted minus found
  Matrix3x9 j;
  Matrix3 variance;
  Matrix3 weight(double robot_m) const { return (variance + robot_m * robot_m * Matrix3::Identity()).inverse(); }
};

Vector3 at_base(const LightSample& s, const Vector3& light) {
  return eigen_of(s.base_from_tool.rotation) * light + eigen_of(s.base_from_tool.translation_m);
}

double weight_of(const LightSample& s) {
  return 3 / dot(s.sigma_m, s.sigma_m);
}

// W for a given l.
void fit_base(const std::vector<LightSample>& samples, State& state) {
  Vector3 from = Vector3::Zero(), to = Vector3::Zero();
  double sum = 0;
  for (const LightSample& s : samples) {
    from += weight_of(s) * at_base(s, state.light);
    to += weight_of(s) * eigen_of(s.position_m);
    sum += weight_of(s);
  }
  from /= sum;
  to /= sum;
  Matrix3 cross = Matrix3::Zero();
  for (const LightSample& s : samples) {
    cross += weight_of(s) / sum * (eigen_of(s.position_m) - to) * (at_base(s, state.light) - from).transpose();
  }
  state.rotation = nearest_rotation(cross);
  state.shift = to - state.rotation * from;
}

// l, and the shift of W with it, for a given rotation of W; what is open stays zero.
void fit_light(const std::vector<LightSample>& samples, State& state) {
  Eigen::MatrixXd n = Eigen::MatrixXd::Zero(6, 6);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(6);
  for (const LightSample& s : samples) {
    Eigen::Matrix<double, 3, 6> k;
    k << eigen_of(s.base_from_tool.rotation), state.rotation.transpose();
    const Vector3 rest = state.rotation.transpose() * eigen_of(s.position_m) - eigen_of(s.base_from_tool.translation_m);
    n.noalias() += weight_of(s) * k.transpose() * k;
    b.noalias() += weight_of(s) * k.transpose() * rest;
  }
  const Eigen::VectorXd x = handeye::solve_semidefinite(n, b, 1e-9);
  state.light = x.head<3>();
  state.shift = x.tail<3>();
}

double misfit(const std::vector<LightSample>& samples, const State& state) {
  double sum = 0;
  for (const LightSample& s : samples) {
    sum +=
        weight_of(s) * (state.rotation * at_base(s, state.light) + state.shift - eigen_of(s.position_m)).squaredNorm();
  }
  return sum;
}

// Lights near the tool's origin and to its sides, at the size of the motions: an alternation from each.
State start_of(const std::vector<LightSample>& samples) {
  double size = 0;
  for (const LightSample& s : samples)
    size += norm(s.position_m - samples[0].position_m) / static_cast<double>(samples.size());
  State best;
  double least = HUGE_VAL;
  for (int k = 0; k < 7; ++k) {
    State state;
    if (k > 0) state.light((k - 1) % 3) = (k > 3 ? -1 : 1) * 0.5 * size;
    double before = HUGE_VAL;
    for (int step = 0; step < alternations; ++step) {
      fit_base(samples, state);
      fit_light(samples, state);
      const double now = misfit(samples, state);
      if (before - now < 1e-9 * now) break;
      before = now;
    }
    if (misfit(samples, state) < least) {
      least = misfit(samples, state);
      best = state;
    }
  }
  return best;
}

Matrix3x9 slope(const Vector3& in_base, const Matrix3& tool_rotation, const State& state) {
  Matrix3x9 j;
  j << -cross_matrix(state.rotation * in_base), Matrix3::Identity(), state.rotation * tool_rotation;
  return j;
}

std::vector<Row> rows_of(const std::vector<LightSample>& samples, const State& state) {
  std::vector<Row> rows;
  for (const LightSample& s : samples) {
    const Vector3 p = at_base(s, state.light);
    const Vector3 sigma = eigen_of(s.sigma_m);
    const Matrix3 variance =
        s.covariance_m2 ? linear::as_eigen(*s.covariance_m2) : Matrix3(sigma.cwiseProduct(sigma).asDiagonal());
    rows.push_back({state.rotation * p + state.shift - eigen_of(s.position_m),
                    slope(p, eigen_of(s.base_from_tool.rotation), state), variance});
  }
  return rows;
}

Matrix9 information(const std::vector<Row>& rows, double robot_m) {
  Matrix9 n = Matrix9::Zero();
  for (const Row& row : rows) {
    n.noalias() += row.j.transpose() * row.weight(robot_m) * row.j;
  }
  return n;
}

Matrix9 pseudo_inverse(const Matrix9& n) {
  const Vector9 scale = n.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const linear::SymmetricEigen<Matrix9> e(scale.asDiagonal() * n * scale.asDiagonal());
  Vector9 inverse = Vector9::Zero();
  for (int i = 0; i < 9; ++i) inverse(i) = e.eigenvalues()(i) > 1e-12 ? 1 / e.eigenvalues()(i) : 0;
  const Matrix9 root = scale.asDiagonal() * e.eigenvectors();
  return root * inverse.asDiagonal() * root.transpose();
}

// Gauss-Newton with the robot's noise estimated between the steps (Fellner, Biometrics 42, 1986).
void refine(const std::vector<LightSample>& samples, State& state, double& robot_m) {
  robot_m = std::max(
      1e-9, std::sqrt(misfit(samples, state) / (9 * static_cast<double>(samples.size()))) * norm(samples[0].sigma_m));
  for (int step = 0; step < most_steps; ++step) {
    const std::vector<Row> rows = rows_of(samples, state);
    const Matrix9 n = information(rows, robot_m), inverse = pseudo_inverse(n);
    Vector9 gradient = Vector9::Zero();
    for (const Row& row : rows) {
      gradient += row.j.transpose() * row.weight(robot_m) * row.e;
    }
    const Vector9 change = -inverse * gradient;
    double squares = 0, trace = 0;
    for (const Row& row : rows) {
      const Matrix3 w = row.weight(robot_m);
      squares += (w * (row.e + row.j * change)).squaredNorm();
      trace += w.trace() - (w * row.j * inverse * row.j.transpose() * w).trace();
    }
    const double before = robot_m;
    if (trace > 0) robot_m = std::max(least_m, robot_m * std::sqrt(std::clamp(squares / trace, 1e-4, 1e4)));
    state.rotation = eigen_of(quaternion_of_rotation_vector(vec_of(change.head<3>()))) * state.rotation;
    state.rotation = nearest_rotation(state.rotation);
    state.shift += change.segment<3>(3);
    state.light += change.tail<3>();
    const bool still = std::abs(robot_m - before) < 1e-6 * (before + norm(samples[0].sigma_m));
    if (still && change.dot(n * change) < 1e-16) break;
  }
}

// What the poses leave open: by their geometry, or because only noise tells (handeye/observability.h).
Eigen::MatrixXd free_directions(const std::vector<LightSample>& samples, const State& state, double robot_m) {
  const std::vector<Row> rows = rows_of(samples, state);
  double reach = 0;
  for (const LightSample& s : samples) reach += at_base(s, state.light).norm() / static_cast<double>(samples.size());
  Vector9 unit;
  unit << Vector3::Constant(1 / std::max(reach, 1e-6)), Vector3::Ones(), Vector3::Ones();
  const auto at = [&](const std::vector<Row>& r) -> Matrix9 {
    return unit.asDiagonal() * information(r, robot_m) * unit.asDiagonal();
  };
  const Matrix9 n = at(rows);
  Matrix9 more = Matrix9::Zero();
  Random random(9091);
  for (int k = 0; k < disturbances; ++k) {
    std::vector<Row> other = rows;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const linear::SymmetricEigen<Matrix3> spread(rows[i].variance + robot_m * robot_m * Matrix3::Identity());
      Vector3 shift;
      for (int c = 0; c < 3; ++c) shift(c) = random.normal() * std::sqrt(std::max(0.0, spread.eigenvalues()(c)));
      shift = spread.eigenvectors() * shift;
      other[i].j = slope(at_base(samples[i], state.light) + state.rotation.transpose() * shift,
                         eigen_of(samples[i].base_from_tool.rotation), state);
    }
    more += at(other) / disturbances;
  }
  const linear::SymmetricEigen<Matrix9> e(n);
  Eigen::MatrixXd free(9, 0);
  for (int k = 0; k < 9; ++k) {
    const Vector9 v = e.eigenvectors().col(k);
    const double there = v.dot(n * v), then = v.dot(more * v);
    if (there > rounding_share * e.eigenvalues()(8) && then - there <= feigned_limit * there) continue;
    free.conservativeResize(9, free.cols() + 1);
    free.rightCols(1) = v;
  }
  return free;
}

void say(const std::string& what, const Eigen::MatrixXd& block, const std::string& joint, const std::string& frame,
         std::vector<std::string>& words) {
  if (block.cols() == 0) return;
  const linear::JacobiSvd<Eigen::MatrixXd> svd(block, Eigen::ComputeThinU);
  std::vector<Vector3> reached;
  for (Eigen::Index k = 0; k < svd.singularValues().size(); ++k) {
    if (svd.singularValues()(k) > part_of_direction) reached.push_back(svd.matrixU().col(k));
  }
  if (reached.size() == 3) {
    words.push_back(what + " in " + frame + "'s frame, in every direction");
    return;
  }
  for (const Vector3& d : reached)
    words.push_back(what + " " + joint + " " + handeye::direction_words(vec_of(d), frame));
}

}  // namespace

double LightMounting::sigma(std::size_t parameter) const {
  return std::sqrt(std::max(0.0, covariance[10 * parameter]));
}

LightMounting calibrate_light(const std::vector<LightSample>& samples) {
  State state = start_of(samples);
  LightMounting m;
  refine(samples, state, m.robot_m);
  m.world_from_base = {quaternion_from(state.rotation), vec_of(state.shift)};
  m.light_in_tool_m = vec_of(state.light);
  const std::vector<Row> rows = rows_of(samples, state);
  for (const Row& row : rows) {
    m.residual_m.push_back(vec_of(-row.e));
    m.scatter_m += row.e.squaredNorm() / static_cast<double>(rows.size());
  }
  m.scatter_m = std::sqrt(m.scatter_m);
  const Eigen::MatrixXd free = free_directions(samples, state, m.robot_m);
  say("rotation of the base", free.topRows<3>(), "about", "the world", m.unobservable);
  say("translation of the light", free.bottomRows<3>(), "along", "the tool", m.unobservable);
  say("translation of the base", free.middleRows<3>(3), "along", "the world", m.unobservable);
  m.base_known = free.cols() == 0 || free.topRows<6>().norm() < part_of_direction;
  m.light_known = free.cols() == 0 || free.bottomRows<3>().norm() < part_of_direction;
  const double freedom = std::max(1.0, 3.0 * static_cast<double>(samples.size()) - 9);
  const double widening = stats::student_quantile(0.975, freedom) / stats::normal_quantile(0.975);
  Eigen::Map<Eigen::Matrix<double, 9, 9, Eigen::RowMajor>>(m.covariance.data()) =
      widening * widening * pseudo_inverse(information(rows, m.robot_m));
  return m;
}

}  // namespace gonio::robot

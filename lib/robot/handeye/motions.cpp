#include "robot/handeye/motions.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "linear/symmetric_eigen.h"

namespace gonio::robot::handeye {
namespace {

constexpr double sure_sign = 0.3;  // |w| of a quaternion above which its sign is that with w > 0

Eigen::Vector4d vector_of(const Quaternion& q) {
  return {q.w, q.x, q.y, q.z};
}

std::array<double, 14> content(const PoseSample& s) {
  const auto canonical = [](Quaternion q) {
    for (const double c : {q.w, q.x, q.y, q.z}) {
      if (c == 0) continue;
      return c < 0 ? Quaternion{-q.w, -q.x, -q.y, -q.z} : q;
    }
    return q;
  };
  const Quaternion p = canonical(s.stand_from_mount.rotation), q = canonical(s.camera_from_board.rotation);
  const Vec3 t = s.stand_from_mount.translation_m, u = s.camera_from_board.translation_m;
  return {t.x, t.y, t.z, p.w, p.x, p.y, p.z, u.x, u.y, u.z, q.w, q.x, q.y, q.z};
}

// Rotation of X without any signs: the null vector of R_A R - R R_B over all pairs (Andreff, Horaud & Espiau, IJRR
// 20(3), 2001, section 4).
Matrix3 signless_rotation(const std::vector<Motion>& pairs) {
  Eigen::Matrix<double, 9, 9> n = Eigen::Matrix<double, 9, 9>::Zero();
  for (const Motion& m : pairs) {
    Eigen::Matrix<double, 9, 9> k = Eigen::Matrix<double, 9, 9>::Zero();
    for (int c = 0; c < 3; ++c) {
      k.block<3, 3>(3 * c, 3 * c) += m.rotation_a;
      for (int d = 0; d < 3; ++d) k.block<3, 3>(3 * c, 3 * d) -= m.rotation_b(d, c) * Matrix3::Identity();
    }
    n.noalias() += k.transpose() * k;
  }
  const linear::SymmetricEigen<Eigen::Matrix<double, 9, 9>> e(n);
  const Eigen::Matrix<double, 9, 1> v = e.eigenvectors().col(0);
  return rotation_in_multiple(Eigen::Map<const Matrix3>(v.data()));
}

void align_signs(std::vector<Motion>& pairs) {
  const bool doubtful = std::ranges::any_of(
      pairs, [](const Motion& m) { return std::abs(m.a(0)) < sure_sign || std::abs(m.b(0)) < sure_sign; });
  for (Motion& m : pairs) {
    if (m.a(0) < 0) m.a = -m.a;
    if (m.b(0) < 0) m.b = -m.b;
  }
  if (!doubtful) return;
  const Matrix3 x = signless_rotation(pairs);
  for (Motion& m : pairs) {
    if (std::abs(m.a(0)) > sure_sign && std::abs(m.b(0)) > sure_sign) continue;
    const Vector3 turned = x * m.b.tail<3>();
    if (m.a(0) * m.b(0) + m.a.tail<3>().dot(turned) < 0) m.b = -m.b;
  }
}

}  // namespace

Motions motions_of(std::span<const PoseSample> samples) {
  Motions all{{samples.begin(), samples.end()}, {}, 1};
  std::ranges::sort(all.samples, {}, content);
  double squares = 0;
  for (std::size_t i = 0; i < all.samples.size(); ++i) {
    for (std::size_t j = i + 1; j < all.samples.size(); ++j) {
      const auto a = inverse(all.samples[j].stand_from_mount) * all.samples[i].stand_from_mount;
      const auto b = all.samples[j].camera_from_board * inverse(all.samples[i].camera_from_board);
      Motion m{vector_of(a.rotation), vector_of(b.rotation),     eigen_of(a.rotation),
               eigen_of(b.rotation),  eigen_of(a.translation_m), eigen_of(b.translation_m)};
      squares += m.shift_a.squaredNorm() + m.shift_b.squaredNorm();
      all.pairs.push_back(m);
    }
  }
  all.length_m = std::sqrt(squares / std::max<double>(1, 2 * static_cast<double>(all.pairs.size())));
  if (!(all.length_m > 0)) all.length_m = 1;
  for (Motion& m : all.pairs) {
    m.shift_a /= all.length_m;
    m.shift_b /= all.length_m;
  }
  align_signs(all.pairs);
  return all;
}

Rigid<Mount, frame::Camera> with_translation(const Motions& motions, const Matrix3& rotation_x) {
  Matrix3 n = Matrix3::Zero();
  Vector3 b = Vector3::Zero();
  for (const Motion& m : motions.pairs) {
    const Matrix3 k = m.rotation_a - Matrix3::Identity();
    n.noalias() += k.transpose() * k;
    b.noalias() += k.transpose() * (rotation_x * m.shift_b - m.shift_a);
  }
  return {quaternion_from(rotation_x), vec_of(Vector3(solve_semidefinite(n, b) * motions.length_m))};
}

Solution with_board(const Motions& motions, const Rigid<Mount, frame::Camera>& x) {
  Eigen::Matrix4d squares = Eigen::Matrix4d::Zero();
  Vec3 sum;
  for (const PoseSample& s : motions.samples) {
    const auto z = board_seen(s, x);
    const Eigen::Vector4d q = vector_of(z.rotation);
    squares.noalias() += q * q.transpose();
    sum += z.translation_m;
  }
  const linear::SymmetricEigen<Eigen::Matrix4d> e(squares);
  return {x,
          {quaternion_from(rotation_of(e.eigenvectors().col(3))),
           sum / static_cast<double>(std::max<std::size_t>(1, motions.samples.size()))}};
}

Solution with_translations(const Motions& motions, const Matrix3& rotation_x, const Matrix3& rotation_z) {
  Eigen::MatrixXd n = Eigen::MatrixXd::Zero(6, 6);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(6);
  Eigen::Matrix<double, 3, 6> k;
  for (const PoseSample& s : motions.samples) {
    k << Matrix3::Identity(), -eigen_of(s.stand_from_mount.rotation);
    const Vector3 board = eigen_of(inverse(s.camera_from_board).translation_m);
    n.noalias() += k.transpose() * k;
    b.noalias() += k.transpose() * (eigen_of(s.stand_from_mount.translation_m) - rotation_z * board);
  }
  const Eigen::VectorXd t = solve_semidefinite(n, b);
  return {{quaternion_from(rotation_x), vec_of(t.tail<3>())}, {quaternion_from(rotation_z), vec_of(t.head<3>())}};
}

Eigen::Matrix4d left_product(const Eigen::Vector4d& p) {
  Eigen::Matrix4d m = p(0) * Eigen::Matrix4d::Identity();
  m.block<1, 3>(0, 1) = -p.tail<3>().transpose();
  m.block<3, 1>(1, 0) = p.tail<3>();
  m.block<3, 3>(1, 1) += cross_matrix(p.tail<3>());
  return m;
}

Eigen::Matrix4d right_product(const Eigen::Vector4d& q) {
  Eigen::Matrix4d m = q(0) * Eigen::Matrix4d::Identity();
  m.block<1, 3>(0, 1) = -q.tail<3>().transpose();
  m.block<3, 1>(1, 0) = q.tail<3>();
  m.block<3, 3>(1, 1) -= cross_matrix(q.tail<3>());
  return m;
}

Matrix3 rotation_of(const Eigen::Vector4d& q) {
  return eigen_of(normalized(Quaternion{q(0), q(1), q(2), q(3)}));
}

}  // namespace gonio::robot::handeye

// Shapes that deform, made of a seed: a cloud of points that bends and twists smoothly over time, and reconstructions
// of it with known faults.
#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "base/random.h"
#include "nrsfm/sequence.h"

namespace gonio::nrsfm::tests {

inline Eigen::Matrix3d any_rotation(Random& random) {
  Eigen::Vector4d q;
  for (int i = 0; i < 4; ++i) q(i) = random.normal();
  return Eigen::Quaterniond(q.normalized()).toRotationMatrix();
}

inline Shapes deforming(Eigen::Index frames, Eigen::Index points, std::uint64_t seed) {
  Random random(seed, 17);
  Eigen::Matrix3Xd rest(3, points);
  for (Eigen::Index p = 0; p < points; ++p)
    rest.col(p) << 0.1 * random.normal(), 0.07 * random.normal(), 0.04 * random.normal();
  Shapes s(3 * frames, points);
  for (Eigen::Index f = 0; f < frames; ++f) {
    const double t = 2 * 3.141592653589793 * static_cast<double>(f) / static_cast<double>(frames);
    for (Eigen::Index p = 0; p < points; ++p) {
      const Eigen::Vector3d r = rest.col(p);
      shape_of(s, f).col(p) << r.x() * (1 + 0.2 * std::sin(t)), r.y() + 1.5 * r.x() * r.x() * std::cos(t),
          r.z() + 2 * r.x() * r.y() * std::sin(2 * t) + 0.3 * std::cos(t) * r.x();
    }
  }
  return s;
}

// Every point off by noise of `sigma` a coordinate; a share of them by ten times that.
inline Shapes noisy(const Shapes& s, double sigma, double outliers, std::uint64_t seed) {
  Random random(seed, 23);
  Shapes out = s;
  for (Eigen::Index f = 0; f < s.rows() / 3; ++f)
    for (Eigen::Index p = 0; p < s.cols(); ++p) {
      const double factor = random.uniform() < outliers ? 10 : 1;
      for (int i = 0; i < 3; ++i) out(3 * f + i, p) += factor * sigma * random.normal();
    }
  return out;
}

inline Shapes moved_all(const Shapes& s, double scale, const Eigen::Matrix3d& rotation, const Eigen::Vector3d& shift) {
  Shapes out(s.rows(), s.cols());
  for (Eigen::Index f = 0; f < s.rows() / 3; ++f)
    shape_of(out, f) = ((scale * rotation) * shape_of(s, f)).colwise() + shift;
  return out;
}

}  // namespace gonio::nrsfm::tests

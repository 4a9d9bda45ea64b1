// Energies of shells and their first derivatives (shell.h).
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "nrsfm/make/shell.h"

namespace gonio::nrsfm {

double hinge_angle(const std::array<Eigen::Vector3d, 4>& x, std::array<Eigen::Vector3d, 4>* gradient) {
  const Eigen::Vector3d e = x[1] - x[0];
  const Eigen::Vector3d n1 = e.cross(x[2] - x[0]), n2 = (x[3] - x[0]).cross(e);
  const double length = e.norm();
  if (gradient) {
    // Each corner moves the angle by its height above its triangle; the ends of the edge balance forces and moments.
    const Eigen::Vector3d g2 = -length / n1.squaredNorm() * n1, g3 = -length / n2.squaredNorm() * n2;
    const double t2 = (x[2] - x[0]).dot(e) / (length * length), t3 = (x[3] - x[0]).dot(e) / (length * length);
    *gradient = {-(1 - t2) * g2 - (1 - t3) * g3, -t2 * g2 - t3 * g3, g2, g3};
  }
  return std::atan2(n1.cross(n2).dot(e) / length, n1.dot(n2));
}

Shell::Shell(const Eigen::Matrix3Xd& rest, const Triangles& triangles, const ShellMaterial& material,
             std::vector<Bond> bonds_given)
    : fixed(static_cast<std::size_t>(rest.cols()), 0),
      bonds(std::move(bonds_given)),
      triangles_(triangles),
      material_(material),
      mass_(Eigen::VectorXd::Zero(rest.cols())) {
  if (material_.bending_n_m == 0)
    material_.bending_n_m =
        material.young_pa * std::pow(material.thickness_m, 3) / (12 * (1 - material.poisson * material.poisson));
  for (const auto& t : triangles_) {
    const Eigen::Vector3d a = rest.col(t[1]) - rest.col(t[0]), b = rest.col(t[2]) - rest.col(t[0]);
    const Eigen::Vector3d u = a.normalized(), n = a.cross(b).normalized(), v = n.cross(u);
    Eigen::Matrix2d edges;
    edges << a.dot(u), b.dot(u), a.dot(v), b.dot(v);
    const Eigen::Matrix2d inverse = edges.inverse();
    Element element;
    element.slope = {-(inverse.row(0) + inverse.row(1)).transpose(), inverse.row(0).transpose(),
                     inverse.row(1).transpose()};
    element.area = a.cross(b).norm() / 2;
    for (const std::uint32_t i : t) mass_(i) += material.density_kg_m3 * material.thickness_m * element.area / 3;
    triangle_.push_back(element);
  }
  find_hinges(rest);
}

void Shell::find_hinges(const Eigen::Matrix3Xd& rest) {
  struct Side {
    std::size_t triangle = 0;
    std::uint32_t opposite = 0;
  };
  std::map<std::uint32_t, std::pair<std::uint32_t, int>> sewn;  // b of a bond -> its a, its number
  for (std::size_t k = 0; k < bonds.size(); ++k) sewn[bonds[k].b] = {bonds[k].a, static_cast<int>(k)};
  const auto one = [&sewn](std::uint32_t v) { return sewn.contains(v) ? sewn.at(v).first : v; };
  const auto bond_of = [&](std::uint32_t v) {
    for (const auto& [b, bond] : sewn)
      if (b == v || bond.first == v) return bond.second;
    return -1;
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, Side> seen;  // directed edges
  for (std::size_t k = 0; k < triangles_.size(); ++k) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = triangles_[k][i], b = triangles_[k][(i + 1) % 3], c = triangles_[k][(i + 2) % 3];
      const auto other = seen.find({one(b), one(a)});
      if (other == seen.end()) {
        seen[{one(a), one(b)}] = {k, c};
        continue;
      }
      Hinge hinge;
      hinge.v = {a, b, c, other->second.opposite};
      const auto& across = triangles_[other->second.triangle];
      if (std::find(across.begin(), across.end(), a) == across.end() ||
          std::find(across.begin(), across.end(), b) == across.end())
        hinge.bonds[0] = bond_of(a), hinge.bonds[1] = bond_of(b);
      const double length2 = (rest.col(a) - rest.col(b)).squaredNorm();
      hinge.stiffness = material_.bending_n_m * length2 / (triangle_[k].area + triangle_[other->second.triangle].area);
      hinge.rest =
          hinge_angle({rest.col(hinge.v[0]), rest.col(hinge.v[1]), rest.col(hinge.v[2]), rest.col(hinge.v[3])});
      hinges_.push_back(hinge);
    }
  }
}

Eigen::Matrix<double, 3, 2> Shell::deformation(std::size_t k, const Eigen::Matrix3Xd& x) const {
  Eigen::Matrix<double, 3, 2> f = Eigen::Matrix<double, 3, 2>::Zero();
  for (std::size_t i = 0; i < 3; ++i) f += x.col(triangles_[k][i]) * triangle_[k].slope[i].transpose();
  return f;
}

Eigen::Matrix2d Shell::stress(const Eigen::Matrix<double, 3, 2>& f) const {
  const Eigen::Matrix2d strain = (f.transpose() * f - Eigen::Matrix2d::Identity()) / 2;
  const double nu = material_.poisson;
  const double stiffness = material_.young_pa * material_.thickness_m / (1 - nu * nu);
  return stiffness * ((1 - nu) * strain + nu * strain.trace() * Eigen::Matrix2d::Identity());
}

double Shell::energy(const Eigen::Matrix3Xd& x) const {
  double sum = 0;
  for (std::size_t k = 0; k < triangles_.size(); ++k) {
    const Eigen::Matrix<double, 3, 2> f = deformation(k, x);
    const Eigen::Matrix2d strain = (f.transpose() * f - Eigen::Matrix2d::Identity()) / 2;
    sum += triangle_[k].area / 2 * (stress(f).array() * strain.array()).sum();
  }
  for (const Hinge& h : hinges_) {
    if (!holds(h)) continue;
    const double angle = hinge_angle({x.col(h.v[0]), x.col(h.v[1]), x.col(h.v[2]), x.col(h.v[3])}) - h.rest;
    sum += h.stiffness / 2 * angle * angle;
  }
  for (Eigen::Index i = 0; i < x.cols(); ++i) sum -= mass_(i) * gravity_m_s2.dot(x.col(i));
  for (const Bond& bond : bonds)
    if (!bond.broken) sum += bond.stiffness_n_m / 2 * (x.col(bond.a) - x.col(bond.b)).squaredNorm();
  if (gas_nm > 0) {
    const double v = volume(x);
    if (!(v > 0)) return std::numeric_limits<double>::infinity();
    const double above = outside_pa * v / gas_nm - 1;
    sum += gas_nm * (above - std::log1p(above));
  }
  return sum;
}

Eigen::Matrix3Xd Shell::gradient(const Eigen::Matrix3Xd& x, Eigen::VectorXd* magnitude) const {
  Eigen::Matrix3Xd g = Eigen::Matrix3Xd::Zero(3, x.cols());
  if (magnitude) magnitude->setZero(x.cols());
  const auto add_force = [&](std::uint32_t i, const Eigen::Vector3d& force) {
    g.col(i) += force;
    if (magnitude) (*magnitude)(i) += force.norm();
  };
  for (std::size_t k = 0; k < triangles_.size(); ++k) {
    const Element& e = triangle_[k];
    const Eigen::Matrix<double, 3, 2> f = deformation(k, x);
    const Eigen::Matrix<double, 3, 2> p = e.area * (f * stress(f));
    for (std::size_t i = 0; i < 3; ++i) add_force(triangles_[k][i], p * e.slope[i]);
  }
  std::array<Eigen::Vector3d, 4> turn;
  for (const Hinge& h : hinges_) {
    if (!holds(h)) continue;
    const double angle = hinge_angle({x.col(h.v[0]), x.col(h.v[1]), x.col(h.v[2]), x.col(h.v[3])}, &turn) - h.rest;
    for (std::size_t i = 0; i < 4; ++i) add_force(h.v[i], h.stiffness * angle * turn[i]);
  }
  for (Eigen::Index i = 0; i < x.cols(); ++i) add_force(static_cast<std::uint32_t>(i), -mass_(i) * gravity_m_s2);
  for (const Bond& bond : bonds) {
    if (bond.broken) continue;
    const Eigen::Vector3d force = bond.stiffness_n_m * (x.col(bond.a) - x.col(bond.b));
    add_force(bond.a, force);
    add_force(bond.b, -force);
  }
  if (gas_nm > 0) {
    const Eigen::Matrix3Xd push = (outside_pa - gas_nm / volume(x)) * volume_gradient(x);
    for (Eigen::Index i = 0; i < x.cols(); ++i) add_force(static_cast<std::uint32_t>(i), push.col(i));
  }
  return g;
}

double Shell::volume(const Eigen::Matrix3Xd& x) const {
  double sum = 0;
  for (const auto& t : triangles_) {
    const Eigen::Vector3d a = x.col(t[0]), b = x.col(t[1]), c = x.col(t[2]);
    sum += a.dot(b.cross(c));
  }
  return sum / 6;
}

Eigen::Matrix3Xd Shell::volume_gradient(const Eigen::Matrix3Xd& x) const {
  Eigen::Matrix3Xd g = Eigen::Matrix3Xd::Zero(3, x.cols());
  for (const auto& t : triangles_) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3d b = x.col(t[(i + 1) % 3]), c = x.col(t[(i + 2) % 3]);
      g.col(t[i]) += b.cross(c) / 6;
    }
  }
  return g;
}

double Shell::area(const Eigen::Matrix3Xd& x) const {
  double sum = 0;
  for (const auto& t : triangles_) {
    const Eigen::Vector3d a = x.col(t[1]) - x.col(t[0]), b = x.col(t[2]) - x.col(t[0]);
    sum += a.cross(b).norm() / 2;
  }
  return sum;
}

}  // namespace gonio::nrsfm

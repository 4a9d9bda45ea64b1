// See symmetry.h.
#include "alignment/symmetry.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/text.h"
#include "linear/geom_matrices.h"
#include "linear/symmetric_eigen.h"

namespace gonio::alignment {
Setting turned_about(const Setting& setting, std::size_t body, Vec3 middle, Vec3 axis, double angle) {
  Setting out = setting;
  auto& pose = out.bodies[body].world_from_object;
  const Vec3 before = pose * middle;
  pose.rotation = normalized(pose.rotation * quaternion_of_rotation_vector(axis * angle));
  pose.translation_m += before - pose * middle;
  return out;
}

std::string axis_words(Vec3 v) {
  // An axis has no sign: the largest component counts upwards.
  const double sign = std::abs(v.x) > std::abs(v.y) && std::abs(v.x) > std::abs(v.z) ? v.x
                      : std::abs(v.y) > std::abs(v.z)                                ? v.y
                                                                                     : v.z;
  if (sign < 0) v = -v;
  const auto round = [](double x) { return std::round(100 * x) / 100 + 0.0; };  // no -0.00
  return format("(%.2f, %.2f, %.2f)", round(v.x), round(v.y), round(v.z));
}

Axes principal_axes(const Shape& shape) {
  double area = 0;
  Vec3 sum;
  const auto& p = shape.positions_m();
  for (std::size_t t = 0; t < shape.triangles(); ++t) {
    const auto& c = shape.triangle(t);
    const double a = norm(cross(p[c[1]] - p[c[0]], p[c[2]] - p[c[0]])) / 2;
    area += a, sum += (p[c[0]] + p[c[1]] + p[c[2]]) * (a / 3);
  }
  Axes axes;
  axes.middle_m = sum / area;
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (std::size_t t = 0; t < shape.triangles(); ++t) {
    const auto& c = shape.triangle(t);
    const double a = norm(cross(p[c[1]] - p[c[0]], p[c[2]] - p[c[0]])) / 2;
    // Over a triangle: a/12 (sum of v v' + (sum of v)(sum of v)').
    Eigen::Vector3d all = Eigen::Vector3d::Zero();
    for (const std::uint32_t v : c) {
      const Eigen::Vector3d d = linear::as_eigen(p[v] - axes.middle_m);
      second += d * d.transpose() * (a / 12), all += d;
    }
    second += all * all.transpose() * (a / 12);
  }
  const linear::SymmetricEigen<Eigen::Matrix3d> eigen(second / area);
  for (std::size_t k = 0; k < 3; ++k) {
    const auto column = static_cast<Eigen::Index>(2 - k);
    const Eigen::Vector3d v = eigen.eigenvectors().col(column);
    axes.axis[k] = {v.x(), v.y(), v.z()}, axes.spread[k] = eigen.eigenvalues()(column);
  }
  return axes;
}

std::vector<Turned> turned_alike(const Fitted& fitted, const Question& question, std::size_t body) {
  const Shape& fine = *fitted.setting.bodies[body].shape;
  const Axes axes = principal_axes(fine);
  const Shape rough = fine.triangles() > 6000 ? fine.rough(24) : fine;
  Setting base = fitted.setting;
  base.bodies[body].shape = &rough;
  std::vector<Turned> all;
  for (const Vec3 axis : axes.axis)
    for (const double degrees : {180.0, 120.0, 240.0, 90.0, 270.0, 72.0, 288.0, 60.0, 300.0, 45.0, 315.0, 20.0, 340.0})
      all.push_back({turned_about(base, body, axes.middle_m, axis, degrees * pi / 180), axis, degrees * pi / 180});
  // Far apart, all that is beyond reach costs the same: what looks alike costs about what the found pose does.
  const Stage judge{.reach_px = 12, .width_px = 3, .both_ways = true, .every = 4};
  const RimCost judged(question);
  const double best = judged.of(base, judge);
  double most = 0;
  for (const Sighting& s : question.sightings) most += static_cast<double>(s.points.size());
  most *= 2 * 9 * std::log1p(16.0);
  std::vector<double> cost(all.size());
  parallel_for(0, all.size(), [&](std::size_t i) { cost[i] = judged.of(all[i].setting, judge); });
  std::vector<Turned> alike;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!(cost[i] < 3 * best + 0.1 * most)) continue;
    alike.push_back(all[i]);
    alike.back().setting.bodies[body].shape = &fine;
  }
  return alike;
}

std::vector<std::string> open_directions(const Fitted& fitted, const Question& question, std::size_t body,
                                         double share) {
  // Numbers of the body, each in the motion that it makes of its surface (m).
  const double radius = fitted.setting.bodies[body].shape->radius_m();
  struct Number {
    Eigen::Index at;
    Block block;
    double unit;
    std::size_t axis;
    bool uniform;
  };
  std::vector<Number> numbers;
  Eigen::Index at = 0;
  for (const Freedom& f : question.freedoms) {
    const bool own = f.which == body &&
                     (f.block == Block::body_turn || f.block == Block::body_shift || f.block == Block::body_scale);
    const bool station = f.block == Block::station_turn || f.block == Block::station_shift;
    for (std::size_t i = 0; i < f.size(); ++i, ++at)
      if (own)
        numbers.push_back({at, f.block, f.block == Block::body_shift ? 1 : radius, i, f.uniform});
      else if (station && f.which == 0)
        numbers.push_back({at, f.block, f.block == Block::station_shift ? 1 : radius, i, false});
  }
  const auto n = static_cast<Eigen::Index>(numbers.size());
  Eigen::MatrixXd of_motion(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index k = 0; k < n; ++k) {
      const Number &a = numbers[static_cast<std::size_t>(i)], &b = numbers[static_cast<std::size_t>(k)];
      of_motion(i, k) = fitted.covariance(a.at, b.at) * a.unit * b.unit;
    }
  std::vector<std::string> open;
  if (n == 0) return open;
  const linear::SymmetricEigen<Eigen::MatrixXd> eigen(of_motion);
  for (Eigen::Index k = n - 1; k >= 0 && eigen.eigenvalues()(k) > share * share * radius * radius; --k) {
    Vec3 turn, shift, size;
    bool one_size = false;
    double turning = 0, shifting = 0, sizing = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
      const Number& number = numbers[static_cast<std::size_t>(i)];
      const double v = eigen.eigenvectors()(i, k);
      Vec3 unit{number.axis == 0 ? v : 0, number.axis == 1 ? v : 0, number.axis == 2 ? v : 0};
      if (number.block == Block::body_turn || number.block == Block::station_turn) turn += unit, turning += v * v;
      if (number.block == Block::body_shift || number.block == Block::station_shift) shift += unit, shifting += v * v;
      if (number.block == Block::body_scale) size += unit, sizing += v * v, one_size = number.uniform;
    }
    const Mat3 mesh_from_world = transposed(matrix_of(fitted.setting.bodies[body].world_from_object.rotation));
    std::string what;
    const auto add = [&](const std::string& part) { what += (what.empty() ? "" : " with ") + part; };
    if (turning > 0.2) add("turning about " + axis_words(normalized(mesh_from_world * turn)) + " of the mesh");
    if (shifting > 0.2) add("moving along " + axis_words(normalized(shift)) + " of the world");
    if (sizing > 0.2)
      add(one_size ? std::string("its size") : "its size along " + axis_words(normalized(size)) + " of the mesh");
    open.push_back(what);
  }
  return open;
}

}  // namespace gonio::alignment

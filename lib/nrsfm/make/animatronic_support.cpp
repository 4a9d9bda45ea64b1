// See animatronic_support.h.
#include "nrsfm/make/animatronic_support.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text.h"

namespace gonio::nrsfm {

Sheet flat_sheet(double length_x_m, double length_y_m, int cells) {
  Sheet sheet;
  const double cell = sheet.cell_m = length_x_m / cells;
  const int rows = 2 * std::max(1, static_cast<int>(std::lround(length_y_m / (std::sqrt(3.0) * cell))));
  std::vector<std::vector<std::uint32_t>> row(static_cast<std::size_t>(rows) + 1);
  std::vector<Eigen::Vector3d> at;
  for (std::size_t j = 0; j < row.size(); ++j) {
    const double y = std::sqrt(0.75) * cell * (static_cast<double>(j) - 0.5 * rows);
    const auto put = [&](double x) {
      row[j].push_back(static_cast<std::uint32_t>(at.size()));
      at.emplace_back(x - length_x_m / 2, y, 0);
    };
    put(0);
    for (int i = 1; i < cells; ++i) put(cell * (i - 0.5 * static_cast<double>(j % 2)));
    if (j % 2 == 1) put(length_x_m - cell / 2);
    put(length_x_m);
  }
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if ((at[b] - at[a]).cross(at[c] - at[a]).z() < 0) std::swap(b, c);
    sheet.triangles.push_back({a, b, c});
  };
  for (std::size_t j = 0; j + 1 < row.size(); ++j) {
    const auto& even = row[j + j % 2];
    const auto& odd = row[j + 1 - j % 2];
    const std::size_t last = even.size() - 1;
    add(even[0], odd[0], odd[1]);
    for (std::size_t i = 0; i < last; ++i) add(even[i], even[i + 1], odd[i + 1]);
    for (std::size_t i = 1; i < last; ++i) add(odd[i], odd[i + 1], even[i]);
    add(even[last], odd[last], odd[last + 1]);
  }
  sheet.rest.resize(3, static_cast<Eigen::Index>(at.size()));
  for (std::size_t v = 0; v < at.size(); ++v) sheet.rest.col(static_cast<Eigen::Index>(v)) = at[v];
  return sheet;
}

double eased(double s) {
  s = std::clamp(s, 0.0, 1.0);
  return s * s * s * (10 + s * (6 * s - 15));
}

Play::Play(Shell& shell, const Eigen::Matrix3Xd& start, const AnimatronicOptions& options)
    : shell_(shell), x_(start), before_(start), options_(options) {
  if (options.frames < 2)
    throw Error(Exit::usage, "--frames", "is " + std::to_string(options.frames), "2 is the least");
  if (options.points < 4)
    throw Error(Exit::usage, "--points", "is " + std::to_string(options.points), "4 is the least");
}

void Play::step(double s, const std::function<void(double, Eigen::Matrix3Xd&)>& lead,
                const std::function<bool(const Eigen::Matrix3Xd&)>& after) {
  throw_if_interrupted();
  Eigen::Matrix3Xd held = x_, onward = 2 * x_ - before_;
  lead(s, held), lead(s, onward);
  before_ = x_;
  x_ = shell_.energy(onward) < shell_.energy(held) ? onward : held;
  Equilibrium at;
  do {
    at = shell_.settle(x_);
    if (!at.converged)
      throw Error(Exit::internal, "animatronic at " + shortest_text(s),
                  "finds no equilibrium: a force of " + shortest_text(at.residual_n) + " N is left of " +
                      shortest_text(at.scale_n) + " N",
                  "take another --seed");
  } while (after && after(x_));
  residual_ = std::max(residual_, at.residual_n / at.scale_n);
}

DeformingSurface Play::run(const std::function<void(double, Eigen::Matrix3Xd&)>& lead,
                           const std::function<Rig(double)>& rig,
                           const std::function<bool(const Eigen::Matrix3Xd&)>& after) {
  constexpr Eigen::Index least_steps = 40;
  DeformingSurface out;
  out.triangles = shell_.triangles();
  const Eigen::Index gaps = options_.frames - 1, parts = (least_steps + gaps - 1) / gaps;
  out.vertices_m.resize(3 * options_.frames, x_.cols());
  step(0, lead, after);
  before_ = x_;
  shape_of(out.vertices_m, 0) = x_;
  for (Eigen::Index f = 0; f <= gaps; ++f) out.rig.push_back(rig(static_cast<double>(f) / static_cast<double>(gaps)));
  out.anchors = spread_anchors(out.triangles, x_, out.rig.front(), options_.points, options_.seed);
  for (Eigen::Index f = 1; f <= gaps; ++f) {
    for (Eigen::Index k = 1; k <= parts; ++k)
      step(static_cast<double>((f - 1) * parts + k) / static_cast<double>(gaps * parts), lead, after);
    shape_of(out.vertices_m, f) = x_;
  }
  out.points_m = anchored(out);
  out.residual = residual_;
  return out;
}

std::vector<Anchor> spread_anchors(const Triangles& triangles, const Eigen::Matrix3Xd& x, const Rig& rig,
                                   Eigen::Index count, std::uint64_t seed) {
  constexpr double clear_m = 1e-3;  // of the rig
  std::vector<double> until;
  double total = 0;
  for (const auto& t : triangles) {
    const Eigen::Vector3d a = x.col(t[1]) - x.col(t[0]), b = x.col(t[2]) - x.col(t[0]);
    until.push_back(total += a.cross(b).norm() / 2);
  }
  Random random(seed, 0xa0c4);
  std::vector<Anchor> anchors;
  Eigen::Matrix3Xd taken(3, count);
  constexpr int candidates = 12;
  for (Eigen::Index p = 0; p < count; ++p) {
    double farthest = -1;
    anchors.emplace_back();
    for (int c = 0; c < candidates || farthest < 0; ++c) {
      const auto place = std::upper_bound(until.begin(), until.end(), random.uniform() * total) - until.begin();
      const auto k = std::min(static_cast<std::size_t>(place), triangles.size() - 1);
      const double root = std::sqrt(random.uniform()), v = random.uniform();
      const Anchor anchor{static_cast<std::uint32_t>(k), root * (1 - v), root * v};
      const Eigen::Vector3d q =
          (1 - root) * x.col(triangles[k][0]) + anchor.b1 * x.col(triangles[k][1]) + anchor.b2 * x.col(triangles[k][2]);
      if (std::ranges::any_of(rig, [&q](const RigBox& box) { return inside(box, q, clear_m); })) continue;
      const double distance = p == 0 ? 0 : (taken.leftCols(p).colwise() - q).colwise().squaredNorm().minCoeff();
      if (distance <= farthest) continue;
      farthest = distance;
      anchors.back() = anchor;
      taken.col(p) = q;
    }
  }
  return anchors;
}

}  // namespace gonio::nrsfm

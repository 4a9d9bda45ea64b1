// Soft sheets and hard bodies: cloths that are bumpy, folded, dense or coarse, under balls, pots, boxes.
#pragma once
#include <cmath>
#include <cstdint>
#include <string>

#include "base/random.h"
#include "geom/rigid.h"
#include "mesh/shapes.h"
#include "mesh/verdict.h"

namespace gonio::reassembly::sheets {

using mesh::shapes::grid;

struct Bumps {
  double height_m = 0, length_m = 0.05;
  double phase = 0;
  double at(double x, double y) const {
    return height_m * std::sin(2 * pi * x / length_m + phase) * std::cos(2 * pi * y / length_m + 2 * phase);
  }
};

// side x side about the origin, facing +z.
inline io::TriangleMesh flat(double side_m, std::uint32_t cells, const Bumps& bumps = {}) {
  io::TriangleMesh sheet = grid(cells, cells, false, [&](double s, double t) {
    const double x = (s - 0.5) * side_m, y = (t - 0.5) * side_m;
    return Vec3{x, y, bumps.at(x, y)};
  });
  return sheet;
}

// Three layers, each `gap` above the last, over |x| < side / 4: the cloth runs to the right, turns back over itself,
// and on. Turns are half circles of radius gap / 2; the lowest layer lies at z = -2 gap, the uppermost at 0.
inline io::TriangleMesh folded(double side_m, std::uint32_t cells, double gap_m, const Bumps& bumps = {}) {
  const double half = side_m / 2, fold = side_m / 4, turn = pi * gap_m / 2;
  const double length = (half + fold) + turn + 2 * fold + turn + (half + fold);
  const auto along = [&](double s) -> Vec2 {
    double at = s * length;
    if (at < half + fold) return {-half + at, -2 * gap_m};
    at -= half + fold;
    if (at < turn)
      return {fold + gap_m / 2 * std::sin(2 * at / gap_m), -1.5 * gap_m - gap_m / 2 * std::cos(2 * at / gap_m)};
    at -= turn;
    if (at < 2 * fold) return {fold - at, -gap_m};
    at -= 2 * fold;
    if (at < turn)
      return {-fold - gap_m / 2 * std::sin(2 * at / gap_m), -0.5 * gap_m - gap_m / 2 * std::cos(2 * at / gap_m)};
    return {-fold + (at - turn), 0};
  };
  return grid(2 * cells, cells, false, [&](double s, double t) {
    const Vec2 p = along(s);
    const double y = (t - 0.5) * side_m;
    return Vec3{p.x, y, p.y + bumps.at(p.x, y)};
  });
}

// A turned body about z from its profile (r, z), from the axis below round the outside to the axis above: closed,
// facing outwards where the profile runs counter-clockwise seen with r to the right and z up.
template <class Profile>
io::TriangleMesh turned(std::uint32_t rows, std::uint32_t around, const Profile& profile) {
  io::TriangleMesh body;
  for (std::uint32_t i = 1; i < rows; ++i)
    for (std::uint32_t j = 0; j < around; ++j) {
      const Vec2 p = profile(static_cast<double>(i) / rows);
      const double angle = 2 * pi * j / around;
      body.positions_m.push_back({p.x * std::cos(angle), p.x * std::sin(angle), p.y});
    }
  const auto bottom = static_cast<std::uint32_t>(body.positions_m.size()), top = bottom + 1;
  body.positions_m.push_back({0, 0, profile(0.0).y});
  body.positions_m.push_back({0, 0, profile(1.0).y});
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return i * around + j % around; };
  for (std::uint32_t j = 0; j < around; ++j) {
    body.triangles.push_back({bottom, at(0, j + 1), at(0, j)});
    body.triangles.push_back({top, at(rows - 2, j), at(rows - 2, j + 1)});
    for (std::uint32_t i = 0; i + 2 < rows; ++i) {
      body.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1)});
      body.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i + 1, j)});
    }
  }
  return body;
}

// Points on a polyline at shares of its length.
inline Vec2 on_way(const std::vector<Vec2>& way, double share) {
  double length = 0;
  for (std::size_t k = 1; k < way.size(); ++k) length += norm(way[k] - way[k - 1]);
  double at = share * length;
  for (std::size_t k = 1; k < way.size(); ++k) {
    const double piece = norm(way[k] - way[k - 1]);
    if (at <= piece || k + 1 == way.size()) return way[k - 1] + (way[k] - way[k - 1]) * std::min(1.0, at / piece);
    at -= piece;
  }
  return way.back();
}

// A thin-walled bowl on a foot ring, the ring's lowest place at z = 0.
inline io::TriangleMesh bowl(double radius_m, double wall_m, std::uint32_t rows, std::uint32_t around) {
  const double r = radius_m, w = wall_m;
  const std::vector<Vec2> way{{0, 0.08 * r},           {0.40 * r, 0.08 * r}, {0.43 * r, 0},    {0.52 * r, 0},
                              {0.58 * r, 0.10 * r},    {r, 0.7 * r},         {r - w, 0.7 * r}, {0.55 * r, 0.10 * r + w},
                              {0.4 * r, 0.08 * r + w}, {0, 0.08 * r + w}};
  return turned(rows, around, [&](double s) { return on_way(way, s); });
}

// A lump whose radius varies, its lowest vertex at z = 0.
inline io::TriangleMesh lump(double radius_m, int levels, double bumpy, Random& random) {
  io::TriangleMesh body = mesh::shapes::ball(1, levels);
  const Vec3 a{random.normal(), random.normal(), random.normal()}, b{random.normal(), random.normal(), random.normal()};
  double lowest = 0;
  for (Vec3& p : body.positions_m) {
    p *= radius_m * (1 + bumpy * (std::sin(3 * dot(a, p)) + std::cos(2 * dot(b, p))) / 2);
    lowest = std::min(lowest, p.z);
  }
  for (Vec3& p : body.positions_m) p.z -= lowest;
  return body;
}

inline io::TriangleMesh moved(io::TriangleMesh mesh, Quaternion turn, Vec3 by) {
  for (Vec3& p : mesh.positions_m) p = matrix_of(turn) * p + by;
  return mesh;
}

inline double lowest_z(const io::TriangleMesh& mesh) {
  double z = mesh.positions_m.at(0).z;
  for (const Vec3& p : mesh.positions_m) z = std::min(z, p.z);
  return z;
}

struct Pressed {
  io::TriangleMesh soft, hard;
  std::string what;
};
// Any of the above, turned by up to ten degrees, let down until it touches, and 0.3 to 3 mm farther.
inline Pressed random_pair(std::uint64_t seed, std::uint32_t densest = 90) {
  Random random(seed, 22);
  Pressed p;
  const auto cells = static_cast<std::uint32_t>(random.uniform(6, densest));
  const Bumps bumps{random.uniform(0, 0.004), random.uniform(0.03, 0.1), random.uniform(0, 6)};
  const bool fold = random.uniform() < 0.5;
  p.soft = fold ? folded(0.24, cells / 2 + 3, random.uniform(0.0006, 0.004), bumps) : flat(0.24, cells, bumps);
  const std::uint32_t kind = random.below(4);
  const auto fine = static_cast<std::uint32_t>(random.uniform(12, 90));
  switch (kind) {
    case 0: p.hard = lump(random.uniform(0.02, 0.06), 2 + static_cast<int>(random.below(4)), 0.15, random); break;
    case 1: p.hard = bowl(random.uniform(0.04, 0.07), 0.002, fine, fine); break;
    case 2: p.hard = mesh::shapes::box({0.06, 0.05, 0.08}, 1 + random.below(9)); break;
    default: p.hard = mesh::shapes::torus(0.04, 0.01, fine, 8 + fine / 3); break;
  }
  const Quaternion turn =
      quaternion_of_rotation_vector({random.uniform(-0.12, 0.12), random.uniform(-0.12, 0.12), random.uniform(-3, 3)});
  p.hard = moved(p.hard, turn, {});
  const double sink = random.uniform(0.0003, 0.003);
  p.hard = moved(p.hard, {}, {random.uniform(-0.01, 0.01), random.uniform(-0.01, 0.01), 0});
  p.hard = moved(p.hard, {}, {0, 0, bumps.height_m - lowest_z(p.hard)});
  while (mesh::intersections(p.soft, p.hard, 1).empty()) p.hard = moved(p.hard, {}, {0, 0, -0.0002});
  p.hard = moved(p.hard, {}, {0, 0, -sink});
  p.what = (fold ? "folded " : "flat ") + std::to_string(cells) + " under " +
           std::array{"lump", "bowl", "box", "torus"}[kind] + " sunk " + std::to_string(1e3 * sink) + " mm";
  return p;
}

}  // namespace gonio::reassembly::sheets

// Closed surfaces whose every answer is known, as meshes, and what noise makes of them.
#pragma once
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "base/random.h"
#include "io/ply.h"
#include "mesh/mesh.h"

namespace gonio::mesh::shapes {

// A grid of rows x columns over [0, 1]^2, closed along the second direction where `around`, along both where `twice`.
template <class Position>
io::TriangleMesh grid(std::uint32_t rows, std::uint32_t columns, bool around, const Position& position,
                      bool twice = false) {
  io::TriangleMesh mesh;
  const std::uint32_t across = around ? columns : columns + 1, down = twice ? rows : rows + 1;
  for (std::uint32_t i = 0; i < down; ++i)
    for (std::uint32_t j = 0; j < across; ++j)
      mesh.positions_m.push_back(position(static_cast<double>(i) / rows, static_cast<double>(j) / columns));
  for (std::uint32_t i = 0; i < rows; ++i)
    for (std::uint32_t j = 0; j < columns; ++j) {
      const std::uint32_t next = (i + 1) % down, right = (j + 1) % across;
      const std::uint32_t a = i * across + j, b = i * across + right, c = next * across + j, d = next * across + right;
      mesh.triangles.push_back({a, d, b});
      mesh.triangles.push_back({a, c, d});
    }
  return mesh;
}

// An octahedron whose faces were cut into four `levels` times, on a sphere.
inline io::TriangleMesh ball(double radius_m, int levels) {
  io::TriangleMesh mesh;
  mesh.positions_m = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> known;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, fresh] = known.try_emplace(std::minmax(a, b), mesh.positions_m.size());
      if (fresh) mesh.positions_m.push_back(normalized(mesh.positions_m[a] + mesh.positions_m[b]));
      return at->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const auto& t :
           {std::array{a, ab, ca}, std::array{ab, b, bc}, std::array{ca, bc, c}, std::array{ab, bc, ca}})
        finer.push_back(t);
    }
    mesh.triangles = finer;
  }
  for (Vec3& p : mesh.positions_m) p *= radius_m;
  return mesh;
}

// Counter-clockwise seen from outside.
inline io::TriangleMesh torus(double ring_m, double tube_m, std::uint32_t around, std::uint32_t across) {
  return grid(
      around, across, true,
      [&](double u, double v) {
        const double r = ring_m + tube_m * std::cos(2 * pi * v);
        return Vec3{r * std::cos(2 * pi * u), r * std::sin(2 * pi * u), tube_m * std::sin(2 * pi * v)};
      },
      true);
}

// A box of n x n x n squares a side (sharp edges), its corner at the origin.
inline io::TriangleMesh box(Vec3 size_m, std::uint32_t n) {
  io::TriangleMesh mesh;
  std::map<std::array<std::uint32_t, 3>, std::uint32_t> known;
  const auto vertex = [&](std::array<std::uint32_t, 3> at) {
    const auto [entry, fresh] = known.try_emplace(at, mesh.positions_m.size());
    if (fresh) mesh.positions_m.push_back(Vec3{at[0] / double(n), at[1] / double(n), at[2] / double(n)} * size_m);
    return entry->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const std::uint32_t side : {0u, n})
      for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t j = 0; j < n; ++j) {
          const auto at = [&](std::uint32_t u, std::uint32_t v) {
            std::array<std::uint32_t, 3> p{};
            p[axis] = side;
            p[(axis + 1) % 3] = u;
            p[(axis + 2) % 3] = v;
            return vertex(p);
          };
          const std::uint32_t a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
          mesh.triangles.push_back(side > 0 ? std::array{a, b, c} : std::array{a, c, b});
          mesh.triangles.push_back(side > 0 ? std::array{a, c, d} : std::array{a, d, c});
        }
  return mesh;
}

// Two meshes as one.
inline io::TriangleMesh together(io::TriangleMesh a, const io::TriangleMesh& b) {
  const auto first = static_cast<std::uint32_t>(a.positions_m.size());
  a.positions_m.insert(a.positions_m.end(), b.positions_m.begin(), b.positions_m.end());
  for (const auto& t : b.triangles) a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return a;
}
inline io::TriangleMesh moved(io::TriangleMesh mesh, Vec3 by) {
  for (Vec3& p : mesh.positions_m) p += by;
  return mesh;
}
inline io::TriangleMesh inside_out(io::TriangleMesh mesh) {
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

// Every triangle with corners and normals of its own: flat to the eye, sharp at every edge.
inline io::TriangleMesh faceted(const io::TriangleMesh& mesh) {
  io::TriangleMesh all;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 p = mesh.positions_m[a], q = mesh.positions_m[b], r = mesh.positions_m[c];
    const auto first = static_cast<std::uint32_t>(all.positions_m.size());
    all.positions_m.insert(all.positions_m.end(), {p, q, r});
    all.normals.insert(all.normals.end(), 3, normalized(cross(q - p, r - p)));
    all.triangles.push_back({first, first + 1, first + 2});
  }
  return all;
}

// Every vertex along its normal by independent normal noise.
inline io::TriangleMesh noisy(io::TriangleMesh mesh, double sd_m, std::uint64_t seed) {
  const auto normals = averaged_normals(mesh.positions_m, mesh.triangles);
  for (std::size_t v = 0; v < mesh.positions_m.size(); ++v) {
    Random random(seed, v);
    mesh.positions_m[v] += normals[v] * (sd_m * random.normal());
  }
  return mesh;
}

// A ball with bumps: r = radius (1 + depth sum of a few random harmonics), star-shaped while depth < 0.2.
inline io::TriangleMesh bumpy(double radius_m, double depth, int levels, std::uint64_t seed) {
  io::TriangleMesh mesh = ball(1, levels);
  Random random(seed);
  struct Wave {
    Vec3 along;
    double phase;
  };
  std::vector<Wave> waves(5);
  for (Wave& w : waves) w = {Vec3{random.normal(), random.normal(), random.normal()} * 2.0, random.uniform(0, 2 * pi)};
  for (Vec3& p : mesh.positions_m) {
    double r = 1;
    for (const Wave& w : waves) r += depth / 5 * std::sin(dot(w.along, p) + w.phase);
    p *= r * radius_m;
  }
  return mesh;
}

inline double volume_of(const io::TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += dot(mesh.positions_m[a], cross(mesh.positions_m[b], mesh.positions_m[c])) / 6;
  return sum;
}

}  // namespace gonio::mesh::shapes

// Sound meshes, and ways to break them.
#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <random>
#include <vector>

#include "io/ply.h"

namespace gonio::tests {

using Corners = std::array<std::uint32_t, 3>;

inline io::TriangleMesh box(Vec3 low, Vec3 size, int n) {
  io::TriangleMesh mesh;
  std::map<std::array<int, 3>, std::uint32_t> number;
  const auto vertex = [&](std::array<int, 3> at) {
    const auto [found, fresh] = number.try_emplace(at, static_cast<std::uint32_t>(mesh.positions_m.size()));
    if (fresh)
      mesh.positions_m.push_back({low.x + size.x * at[0] / n, low.y + size.y * at[1] / n, low.z + size.z * at[2] / n});
    return found->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, n})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const auto at = [&](int u, int v) {
            std::array<int, 3> p{};
            p[axis] = side, p[(axis + 1) % 3] = i + u, p[(axis + 2) % 3] = j + v;
            return vertex(p);
          };
          Corners a{at(0, 0), at(1, 0), at(1, 1)}, b{at(0, 0), at(1, 1), at(0, 1)};
          if (side == 0) std::swap(a[1], a[2]), std::swap(b[1], b[2]);
          mesh.triangles.push_back(a), mesh.triangles.push_back(b);
        }
  return mesh;
}

// A body of revolution about z that has been bent: no symmetry is left.
inline io::TriangleMesh ring(double large, double small, int n, int m) {
  io::TriangleMesh mesh;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      const double u = 2 * pi * i / n, v = 2 * pi * j / m,
                   r = large + small * (1 + 0.2 * std::sin(2 * u)) * std::cos(v);
      mesh.positions_m.push_back({r * std::cos(u), r * std::sin(u), small * std::sin(v) + 0.3 * std::cos(u)});
      const auto at = [&](int a, int b) { return static_cast<std::uint32_t>((i + a) % n * m + (j + b) % m); };
      mesh.triangles.push_back({at(0, 0), at(1, 0), at(1, 1)});
      mesh.triangles.push_back({at(0, 0), at(1, 1), at(0, 1)});
    }
  return mesh;
}

// A tube along an eight, through itself.
inline io::TriangleMesh crossed_tube(double radius, int n, int m) {
  io::TriangleMesh mesh;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      const double u = 2 * pi * (i + 0.3) / n, v = 2 * pi * j / m;
      const Vec3 along = normalized(Vec3{std::cos(u), std::cos(2 * u), 0.05 * std::cos(u)}), up{0, 0, 1};
      const Vec3 side = normalized(cross(up, along)), over = cross(along, side);
      const Vec3 middle{std::sin(u), std::sin(2 * u) / 2, 0.05 * std::sin(u)};
      mesh.positions_m.push_back(middle + side * (radius * std::cos(v)) + over * (radius * std::sin(v)));
      const auto at = [&](int a, int b) { return static_cast<std::uint32_t>((i + a) % n * m + (j + b) % m); };
      mesh.triangles.push_back({at(0, 0), at(1, 1), at(1, 0)});
      mesh.triangles.push_back({at(0, 0), at(0, 1), at(1, 1)});
    }
  return mesh;
}

inline void append(io::TriangleMesh& mesh, const io::TriangleMesh& other) {
  const auto first = static_cast<std::uint32_t>(mesh.positions_m.size());
  mesh.positions_m.insert(mesh.positions_m.end(), other.positions_m.begin(), other.positions_m.end());
  for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({a + first, b + first, c + first});
}
inline void turn_all(io::TriangleMesh& mesh) {
  for (Corners& t : mesh.triangles) std::swap(t[1], t[2]);
}
inline double volume_of(const io::TriangleMesh& mesh) {
  double six = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    six += dot(mesh.positions_m[a], cross(mesh.positions_m[b], mesh.positions_m[c]));
  return six / 6;
}
inline double diagonal_of(const io::TriangleMesh& mesh) {
  Vec3 low = mesh.positions_m[0], high = low;
  for (const Vec3 p : mesh.positions_m) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return norm(high - low);
}

// By a rotation of random axis and angle, and a shift.
inline void place(io::TriangleMesh& mesh, std::mt19937_64& random) {
  std::uniform_real_distribution<double> even(-1, 1);
  const Basis frame(normalized(Vec3{even(random), even(random), even(random) + 2}));
  const double angle = 3 * even(random);
  const Vec3 shift{even(random), even(random), even(random)};
  for (Vec3& p : mesh.positions_m)
    p = frame.to_world(
            {std::cos(angle) * p.x - std::sin(angle) * p.y, std::sin(angle) * p.x + std::cos(angle) * p.y, p.z}) +
        shift;
}

inline std::vector<std::size_t> some_of(std::size_t count, std::size_t wanted, std::mt19937_64& random) {
  std::vector<std::size_t> all(count);
  std::iota(all.begin(), all.end(), 0u);
  std::shuffle(all.begin(), all.end(), random);
  all.resize(std::min(wanted, count));
  return all;
}

// Every triangle with corners of its own.
inline void unweld(io::TriangleMesh& mesh) {
  io::TriangleMesh loose;
  for (const Corners& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(loose.positions_m.size());
    for (const std::uint32_t v : t) loose.positions_m.push_back(mesh.positions_m[v]);
    loose.triangles.push_back({first, first + 1, first + 2});
  }
  mesh = std::move(loose);
}

// A fifth of the triangles face the other way.
inline void flip_some(io::TriangleMesh& mesh, std::mt19937_64& random) {
  for (const std::size_t f : some_of(mesh.triangles.size(), mesh.triangles.size() / 5, random))
    std::swap(mesh.triangles[f][1], mesh.triangles[f][2]);
}
// Triangles that share no corner go.
inline void remove_some(io::TriangleMesh& mesh, std::size_t wanted, std::mt19937_64& random) {
  std::vector<char> near(mesh.positions_m.size(), 0), gone(mesh.triangles.size(), 0);
  for (const std::size_t f : some_of(mesh.triangles.size(), mesh.triangles.size(), random)) {
    const Corners& t = mesh.triangles[f];
    if (wanted == 0 || near[t[0]] + near[t[1]] + near[t[2]] > 0) continue;
    for (const std::uint32_t v : t) near[v] = 1;
    gone[f] = 1;
    --wanted;
  }
  std::vector<Corners> left;
  for (std::size_t f = 0; f < gone.size(); ++f)
    if (!gone[f]) left.push_back(mesh.triangles[f]);
  mesh.triangles = left;
}
// Copies of triangles, as they are and turned, and once more.
inline void double_some(io::TriangleMesh& mesh, std::mt19937_64& random) {
  int kind = 0;
  for (const std::size_t f : some_of(mesh.triangles.size(), 12, random)) {
    Corners t = mesh.triangles[f];
    std::rotate(t.begin(), t.begin() + 1, t.end());
    if (++kind % 2 == 0) std::swap(t[0], t[1]);
    for (int copies = 0; copies < 1 + kind % 3; ++copies) mesh.triangles.push_back(t);
  }
}
// Collapsed triangles; edges with a corner in their middle that one side alone knows; needles that fill the gap or do
// not.
inline void add_slivers(io::TriangleMesh& mesh, std::mt19937_64& random) {
  std::vector<char> touched(mesh.positions_m.size(), 0);
  int made = 0;
  for (const std::size_t f : some_of(mesh.triangles.size(), mesh.triangles.size(), random)) {
    const Corners t = mesh.triangles[f];
    if (made == 8 || touched[t[0]] + touched[t[1]] + touched[t[2]] > 0) continue;
    for (const std::uint32_t v : t) touched[v] = 1;
    const auto middle = static_cast<std::uint32_t>(mesh.positions_m.size());
    mesh.positions_m.push_back((mesh.positions_m[t[0]] + mesh.positions_m[t[1]]) / 2);
    mesh.triangles[f] = {t[0], middle, t[2]};
    mesh.triangles.push_back({middle, t[1], t[2]});
    if (++made % 2 == 0) mesh.triangles.push_back({t[0], t[1], middle});
    mesh.triangles.push_back({t[2], t[2], t[0]});
  }
}

}  // namespace gonio::tests

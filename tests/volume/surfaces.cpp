#include "volume/surfaces.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

namespace gonio::volume::tests {

MemoryVolume::MemoryVolume(std::array<std::size_t, 3> size, std::vector<float> values) : values_(std::move(values)) {
  head_.size = size;
  head_.type = io::VoxelType::f32;
  head_.files = {"memory"};
}

MemoryVolume::MemoryVolume(std::array<std::size_t, 3> size, const std::function<double(double, double, double)>& value)
    : MemoryVolume(size, std::vector<float>(size[0] * size[1] * size[2])) {
  std::size_t n = 0;
  for (std::size_t k = 0; k < size[2]; ++k)
    for (std::size_t j = 0; j < size[1]; ++j)
      for (std::size_t i = 0; i < size[0]; ++i) values_[n++] = static_cast<float>(value(i, j, k));
}

void MemoryVolume::read(std::size_t first, std::size_t count, std::span<float> to) {
  const std::size_t slice = head_.size[0] * head_.size[1];
  std::copy_n(values_.begin() + first * slice, count * slice, to.begin());
}

bool Soundness::sound() const {
  return open_edges + crowded_edges + disagreeing_edges + pinched_vertices + unused_vertices + collapsed_triangles == 0;
}

std::string Soundness::text() const {
  std::ostringstream text;
  text << open_edges << " open, " << crowded_edges << " crowded, " << disagreeing_edges << " disagreeing edges, "
       << pinched_vertices << " pinched, " << unused_vertices << " unused vertices, " << collapsed_triangles
       << " collapsed triangles, Euler number " << euler;
  return text.str();
}

namespace {

bool has_area(const std::vector<std::array<float, 3>>& positions, const std::array<std::uint32_t, 3>& t) {
  const auto at = [&](std::size_t n) {
    const auto& p = positions[t[n]];
    return Vec3{p[0], p[1], p[2]};
  };
  return t[0] != t[1] && t[1] != t[2] && t[2] != t[0] && norm(cross(at(1) - at(0), at(2) - at(0))) > 0;
}

// The edges opposite to a vertex, head to tail: one closed round, if the vertex is one of a manifold.
bool one_round(const std::vector<std::array<std::uint32_t, 2>>& opposite) {
  std::map<std::uint32_t, std::uint32_t> next;
  for (const auto& edge : opposite)
    if (!next.emplace(edge[0], edge[1]).second) return false;
  std::size_t steps = 0;
  std::uint32_t at = opposite.front()[0];
  do {
    const auto found = next.find(at);
    if (found == next.end()) return false;
    at = found->second;
    ++steps;
  } while (at != opposite.front()[0] && steps <= opposite.size());
  return steps == opposite.size();
}

}  // namespace

Soundness soundness(const std::vector<std::array<float, 3>>& positions, const Triangles& triangles) {
  Soundness found;
  std::map<std::array<std::uint32_t, 2>, std::array<int, 2>> edges;  // passed upwards, downwards
  std::vector<std::vector<std::array<std::uint32_t, 2>>> opposite(positions.size());
  for (const auto& t : triangles) {
    if (!has_area(positions, t)) ++found.collapsed_triangles;
    for (std::size_t n = 0; n < 3; ++n) {
      const std::uint32_t a = t[n], b = t[(n + 1) % 3];
      ++edges[{std::min(a, b), std::max(a, b)}][a < b ? 0 : 1];
      opposite[t[n]].push_back({b, t[(n + 2) % 3]});
    }
  }
  for (const auto& [edge, passed] : edges) {
    const int count = passed[0] + passed[1];
    if (count == 1) ++found.open_edges;
    if (count > 2) ++found.crowded_edges;
    if (count == 2 && passed[0] != 1) ++found.disagreeing_edges;
  }
  for (const auto& round : opposite) {
    if (round.empty())
      ++found.unused_vertices;
    else if (!one_round(round))
      ++found.pinched_vertices;
  }
  found.euler = static_cast<std::int64_t>(positions.size()) - static_cast<std::int64_t>(edges.size()) +
                static_cast<std::int64_t>(triangles.size());
  return found;
}

double area(const Contour& surface) {
  double sum = 0;
  for (const auto& t : surface.triangles) {
    std::array<Vec3, 3> p;
    for (std::size_t n = 0; n < 3; ++n) {
      const auto& at = surface.positions[t[n]];
      p[n] = {at[0], at[1], at[2]};
    }
    sum += norm(cross(p[1] - p[0], p[2] - p[0])) / 2;
  }
  return sum;
}

double enclosed_volume(const Contour& surface) {
  double sum = 0;
  for (const auto& t : surface.triangles) {
    std::array<Vec3, 3> p;
    for (std::size_t n = 0; n < 3; ++n) {
      const auto& at = surface.positions[t[n]];
      p[n] = {at[0], at[1], at[2]};
    }
    sum += dot(p[0], cross(p[1], p[2])) / 6;
  }
  return sum;
}

MemoryVolume random_labels(std::uint64_t seed) {
  Random random(seed, 1);
  std::array<std::size_t, 3> size{};
  for (auto& n : size) n = 3 + random.below(7);
  const double share = random.uniform(0.1, 0.9), faults = random.uniform(0, 0.3);
  const bool checkered = seed % 10 == 9;
  return MemoryVolume(size, [&](double i, double j, double k) {
    if (checkered) return static_cast<double>((static_cast<int>(i + j + k) + (random.uniform() < faults ? 1 : 0)) % 2);
    return random.uniform() < share ? 1.0 : 0.0;
  });
}

MemoryVolume random_field(std::uint64_t seed) {
  Random random(seed, 2);
  std::array<std::size_t, 3> size{};
  for (auto& n : size) n = 8 + random.below(9);
  struct Wave {
    Vec3 k{};
    double phase = 0, amplitude = 0;
  };
  std::vector<Wave> waves(8);
  const double shortest = random.uniform(2.2, 8);
  for (Wave& wave : waves) {
    const double length = shortest * random.uniform(1, 2);
    wave.k = normalized(Vec3{random.normal(), random.normal(), random.normal()}) * (2 * pi / length);
    wave.phase = random.uniform(0, 2 * pi);
    wave.amplitude = random.uniform(0.2, 1);
  }
  const Vec3 sheet_normal = normalized(Vec3{random.normal(), random.normal(), random.normal()});
  const double sheet_at = random.uniform(2, 7), thickness = random.uniform(0.6, 2);
  const double noise = seed % 2 == 0 ? 0 : random.uniform(0.05, 1);
  const std::uint64_t kind = seed % 4;
  const Vec3 corner{std::floor(size[0] / 2.0), std::floor(size[1] / 2.0), std::floor(size[2] / 2.0)};
  return MemoryVolume(size, [&](double i, double j, double k) {
    const Vec3 p{i, j, k};
    double value = 0;
    for (const Wave& wave : waves) value += wave.amplitude * std::cos(dot(wave.k, p) + wave.phase);
    if (kind == 1) value = 0.3 * value + thickness - 2 * std::abs(dot(sheet_normal, p) - sheet_at);
    if (kind == 2) {  // two cubes of samples that share one corner, softened by the waves
      const Vec3 d = p - corner;
      const auto cube = [](Vec3 q) { return std::max({std::abs(q.x), std::abs(q.y), std::abs(q.z)}); };
      value = 0.02 * value + 1.5 - std::min(cube(d - Vec3{1, 1, 1}), cube(d + Vec3{2, 2, 2}));
    }
    if (noise > 0) value += noise * random.normal();
    return value;
  });
}

}  // namespace gonio::volume::tests

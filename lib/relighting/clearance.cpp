#include "relighting/clearance.h"

#include <algorithm>
#include <cmath>

namespace gonio::relighting {
namespace {

constexpr double cells = 1 << 20;  // about

struct Box3 {
  Vec3 lower{1e30, 1e30, 1e30}, upper{-1e30, -1e30, -1e30};
  void add(Vec3 p) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
  }
};

// Boxes of the pieces of a shape's surface: triangles, patches of a sphere.
std::vector<Box3> pieces_of(const scene::Instance& instance) {
  std::vector<Box3> boxes;
  if (const auto* sphere = std::get_if<scene::Sphere>(&instance.shape)) {
    constexpr int across = 64;
    const double r = sphere->radius_m;
    for (int i = 0; i < across; ++i)
      for (int j = 0; j < 2 * across; ++j) {
        Box3 box;
        for (const double u : {i - 0.1, i + 0.5, i + 1.1})
          for (const double v : {j - 0.1, j + 0.5, j + 1.1}) {
            const double theta = pi * u / across, phi = pi * v / across;
            box.add(instance.world_from_object *
                    (Vec3{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)} * r));
          }
        boxes.push_back(box);
      }
  } else if (const auto* mesh = std::get_if<std::shared_ptr<const mesh::Mesh>>(&instance.shape)) {
    for (const auto& t : (*mesh)->triangles) {
      boxes.emplace_back();
      for (const std::uint32_t v : t) boxes.back().add(instance.world_from_object * (*mesh)->positions_m[v]);
    }
  }
  return boxes;
}

}  // namespace

Clearance::Clearance(std::span<const scene::Instance> instances) {
  std::vector<Box3> pieces;
  Box3 all;
  for (const scene::Instance& instance : instances)
    for (const Box3& box : pieces_of(instance)) pieces.push_back(box), all.add(box.lower), all.add(box.upper);
  if (pieces.empty()) return;
  const Vec3 extent = all.upper - all.lower;
  const double volume = std::max({extent.x, 1e-6}) * std::max(extent.y, 1e-6) * std::max(extent.z, 1e-6);
  cell_m_ = std::max(std::cbrt(volume / cells), std::max({extent.x, extent.y, extent.z}) / 256);
  lower_m_ = all.lower;
  for (int k = 0; k < 3; ++k) size_[k] = static_cast<int>(extent[k] / cell_m_) + 1;
  const auto place = [&](int x, int y, int z) {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(size_[1]) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(size_[0]) +
           static_cast<std::size_t>(x);
  };
  constexpr std::uint8_t most = 100;
  steps_.assign(place(0, 0, size_[2]), most);
  for (const Box3& box : pieces) {
    int from[3], to[3];
    for (int k = 0; k < 3; ++k) {
      from[k] = std::clamp(static_cast<int>((box.lower[k] - lower_m_[k]) / cell_m_), 0, size_[k] - 1);
      to[k] = std::clamp(static_cast<int>((box.upper[k] - lower_m_[k]) / cell_m_), 0, size_[k] - 1);
    }
    for (int z = from[2]; z <= to[2]; ++z)
      for (int y = from[1]; y <= to[1]; ++y)
        for (int x = from[0]; x <= to[0]; ++x) steps_[place(x, y, z)] = 0;
  }
  // The steps of a king in space: along one axis after another, forwards and backwards, is not enough; two sweeps over
  // all neighbours that come before are (Rosenfeld & Pfaltz 1966).
  const auto sweep = [&](int x, int y, int z, int sign) {
    std::uint8_t& here = steps_[place(x, y, z)];
    for (int dz = -1; dz <= 0; ++dz)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          if (dz == 0 && (dy > 0 || (dy == 0 && dx >= 0))) continue;
          const int u = x + sign * dx, v = y + sign * dy, w = z + sign * dz;
          if (u < 0 || v < 0 || w < 0 || u >= size_[0] || v >= size_[1] || w >= size_[2]) continue;
          here = std::min<std::uint8_t>(here, static_cast<std::uint8_t>(steps_[place(u, v, w)] + 1));
        }
  };
  for (int z = 0; z < size_[2]; ++z)
    for (int y = 0; y < size_[1]; ++y)
      for (int x = 0; x < size_[0]; ++x) sweep(x, y, z, 1);
  for (int z = size_[2]; z-- > 0;)
    for (int y = size_[1]; y-- > 0;)
      for (int x = size_[0]; x-- > 0;) sweep(x, y, z, -1);
}

double Clearance::at(Vec3 p) const {
  if (steps_.empty()) return 0;
  std::size_t place = 0;
  for (int k = 3; k-- > 0;) {
    const double cell = (p[k] - lower_m_[k]) / cell_m_;
    if (!(cell >= 0) || cell >= size_[k]) return 0;
    place = place * static_cast<std::size_t>(size_[k]) + static_cast<std::size_t>(cell);
  }
  return std::max(0, steps_[place] - 1) * cell_m_;
}

}  // namespace gonio::relighting

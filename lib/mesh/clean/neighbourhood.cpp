#include "mesh/clean/neighbourhood.h"

#include <cmath>

namespace gonio::mesh {

namespace {

constexpr double least_agreement = 0.4;  // cosine

}  // namespace

NoisySurface surface_of(const std::vector<Vec3>& positions_m, const std::vector<Corners>& triangles) {
  NoisySurface surface{positions_m, triangles, neighbours_of_faces(triangles, positions_m.size()), {}, {}, {}};
  const std::size_t count = triangles.size();
  surface.centroids.resize(count);
  surface.guide.resize(count);
  surface.sharp.assign(count, 0);
  double sum = 0;
  for (std::size_t t = 0; t < count; ++t) {
    const Vec3 a = positions_m[triangles[t][0]], b = positions_m[triangles[t][1]], c = positions_m[triangles[t][2]];
    surface.centroids[t] = (a + b + c) / 3;
    const Vec3 n = cross(b - a, c - a);
    surface.guide[t] = norm(n) > 0 ? normalized(n) : Vec3{0, 0, 1};
    sum += norm(b - a) + norm(c - b) + norm(a - c);
  }
  surface.edge_m = count > 0 ? sum / (3 * static_cast<double>(count)) : 0;
  return surface;
}

std::size_t mark_sharp(NoisySurface& surface, double angle_rad) {
  std::size_t sharp = 0;
  const double cosine = std::cos(angle_rad);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    surface.sharp[t] = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t other = surface.behind[t][c];
      if (other == nobody || dot(surface.guide[t], surface.guide[other]) >= cosine) continue;
      surface.sharp[t] = static_cast<std::uint8_t>(surface.sharp[t] | 1u << c);
      ++sharp;
    }
  }
  return sharp / 2;
}

void SeenNumbers::clear() {
  ++stamp_;
  count_ = 0;
}

bool SeenNumbers::insert(std::uint32_t number) {
  if (2 * count_ > slots_.size()) grow();
  const std::size_t mask = slots_.size() - 1;
  for (std::size_t i = (number * 0x9e3779b1u) & mask;; i = (i + 1) & mask) {
    Slot& slot = slots_[i];
    if (slot.stamp != stamp_) {
      slot = {number, stamp_};
      ++count_;
      return true;
    }
    if (slot.number == number) return false;
  }
}

void SeenNumbers::grow() {
  std::vector<Slot> old(2 * slots_.size());
  old.swap(slots_);
  count_ = 0;
  for (const Slot& slot : old)
    if (slot.stamp == stamp_) insert(slot.number);
}

void Neighbourhood::start(std::uint32_t face) {
  face_ = face;
  seen_faces_.clear();
  seen_vertices_.clear();
  vertices_.clear();
  beyond_.assign(1, face);
  seen_faces_.insert(face);
}

void Neighbourhood::grow(double radius_m) {
  const Vec3 centre = surface_.centroids[face_], normal = surface_.guide[face_];
  queue_.clear();
  later_.clear();
  const auto sort_in = [&](std::uint32_t f) {
    const Vec3 gap = surface_.centroids[f] - centre;
    (dot(gap, gap) <= radius_m * radius_m ? queue_ : later_).push_back(f);
  };
  for (const std::uint32_t f : beyond_) sort_in(f);
  for (std::size_t i = 0; i < queue_.size(); ++i) {
    const std::uint32_t f = queue_[i];
    for (const std::uint32_t v : surface_.triangles[f])
      if (seen_vertices_.insert(v)) vertices_.push_back(v);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t other = surface_.behind[f][c];
      if (other == nobody || (surface_.sharp[f] >> c & 1) != 0) continue;
      if (dot(surface_.guide[other], normal) < least_agreement || !seen_faces_.insert(other)) continue;
      sort_in(other);
    }
  }
  beyond_.swap(later_);
}

}  // namespace gonio::mesh

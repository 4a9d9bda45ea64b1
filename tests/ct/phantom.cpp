#include "ct/phantom.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace gonio::ct {
namespace {

bool is_missed(const Ray& ray, const Ball& bound) {
  const Vec3 to = bound.centre - ray.origin;
  const double along = dot(to, ray.direction);
  return dot(to, to) - along * along > bound.radius * bound.radius;
}

}  // namespace

void Phantom::lengths(const Ray& ray, std::span<double> of_parts) const {
  Spans taken, spans;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    of_parts[k] = 0;
    if (is_missed(ray, parts[k].shape->bound())) continue;
    spans.clear();
    parts[k].shape->cut(ray, spans);
    if (spans.count() == 0) continue;
    if (taken.count() == 0) {
      of_parts[k] = spans.length();
      taken = spans;
      continue;
    }
    of_parts[k] = combined(spans, taken, Combine::subtract).length();
    if (k + 1 < parts.size()) taken = combined(taken, spans, Combine::unite);
  }
}

double Phantom::distance_m(Vec3 p, std::size_t part) const {
  double d = parts.at(part).shape->distance(p);
  for (std::size_t k = 0; k < part; ++k) d = std::max(d, -parts[k].shape->distance(p));
  return d;
}

double Phantom::distance_m(Vec3 p) const {
  double d = HUGE_VAL;
  for (const Part& part : parts) d = std::min(d, part.shape->distance(p));
  return d;
}

std::size_t Phantom::part_at(Vec3 p) const {
  for (std::size_t k = 0; k < parts.size(); ++k)
    if (parts[k].shape->distance(p) <= 0) return k;
  return parts.size();
}

std::size_t Phantom::part_named(const std::string& part) const {
  for (std::size_t k = 0; k < parts.size(); ++k)
    if (parts[k].name == part) return k;
  throw std::out_of_range("no part " + part);
}

}  // namespace gonio::ct

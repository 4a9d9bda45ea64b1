#include "volume/contour_shape.h"

namespace gonio::volume {
namespace {

constexpr int rounds = 8;  // of averaging over neighbours: the root of twice as many edges far

template <class Body>
void for_each_side(const Contour& contour, const Body& body) {
  for (const auto& t : contour.triangles)
    for (std::size_t i = 0; i < 3; ++i) body(t[i], t[(i + 1) % 3]);
}

}  // namespace

double area_of(const Contour& contour, Vec3 scale) {
  double area = 0;
  for (const auto& t : contour.triangles) {
    const Vec3 a = vector_of(contour.positions[t[0]]), b = vector_of(contour.positions[t[1]]),
               c = vector_of(contour.positions[t[2]]);
    area += norm(cross((b - a) * scale, (c - a) * scale)) / 2;
  }
  return area;
}

std::vector<float> mean_curvature(const Contour& contour, Vec3 scale) {
  const std::size_t n = contour.positions.size();
  std::vector<float> turn(n), length(n), sides(n), next(n);
  for_each_side(contour, [&](std::uint32_t a, std::uint32_t b) {
    const Vec3 d = (vector_of(contour.positions[b]) - vector_of(contour.positions[a])) * scale;
    const auto t = static_cast<float>(dot(normal_of(contour, b, scale) - normal_of(contour, a, scale), d));
    const auto l = static_cast<float>(dot(d, d));
    for (const std::uint32_t v : {a, b}) turn[v] += t, length[v] += l, sides[v] += 1;
  });
  for (int round = 0; round < rounds; ++round)
    for (std::vector<float>* sums : {&turn, &length}) {
      next = *sums;
      for_each_side(contour, [&](std::uint32_t a, std::uint32_t b) {
        next[a] += (*sums)[b];
        next[b] += (*sums)[a];
      });
      for (std::size_t v = 0; v < n; ++v) (*sums)[v] = next[v] / (1 + sides[v]);
    }
  for (std::size_t v = 0; v < n; ++v) turn[v] = length[v] > 0 ? turn[v] / length[v] : 0;
  return turn;
}

}  // namespace gonio::volume

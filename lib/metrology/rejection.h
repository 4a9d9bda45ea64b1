// Which points the guideline lets go, and which cell of the cloud a point belongs to. Private to this folder.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "metrology/fitted_surface.h"

namespace gonio::metrology {

// Places of the points to leave out, ascending.
std::vector<std::size_t> rejected_points(std::span<const double> deviations_m);

Deviations sorted_out(std::span<const double> deviations_m, std::span<const std::size_t> rejected);

// A number per point: equal for points in the same cube of 1/8 of the cloud's largest extent.
std::vector<std::uint32_t> cells_of(std::span<const Vec3> points_m);

// `fit` takes a mask of the points that count and returns the deviations of all; run until the same points stay out.
template <class Fit>
std::vector<std::size_t> reject_until_stable(std::size_t points, const Fit& fit) {
  std::vector<char> counts(points, 1);
  std::vector<std::size_t> out;
  for (int round = 0; round < 10; ++round) {
    std::vector<std::size_t> next = rejected_points(fit(counts));
    if (next == out) break;
    for (const std::size_t i : out) counts[i] = 1;
    for (const std::size_t i : next) counts[i] = 0;
    out = std::move(next);
  }
  fit(counts);
  return out;
}

}  // namespace gonio::metrology

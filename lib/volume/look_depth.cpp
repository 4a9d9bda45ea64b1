// The volume on a coarse grid, and how deep below the object's surface a cell lies: exact Euclidean distances, one axis
// after the other, as lower envelopes of parabolas (Felzenszwalb & Huttenlocher 2012).
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "volume/look_parts.h"

namespace gonio::volume {
namespace {

constexpr double most_cells = 4e6, unreached = 1e12;

// Squared distances along a line of n numbers, `stride` apart.
void sweep(float* values, std::size_t stride, std::size_t n) {
  thread_local std::vector<double> f, border;
  thread_local std::vector<std::size_t> seat;
  f.resize(n), border.resize(n + 1), seat.resize(n);
  for (std::size_t k = 0; k < n; ++k) f[k] = values[k * stride];
  std::size_t last = 0;
  seat[0] = 0, border[0] = -HUGE_VAL, border[1] = HUGE_VAL;
  const auto meet = [&](std::size_t p, std::size_t q) {  // where the parabolas of p < q cross
    const double a = static_cast<double>(p), b = static_cast<double>(q);
    return (f[q] + b * b - f[p] - a * a) / (2 * (b - a));
  };
  for (std::size_t q = 1; q < n; ++q) {
    double at = meet(seat[last], q);
    while (last > 0 && at <= border[last]) at = meet(seat[--last], q);
    seat[++last] = q, border[last] = at, border[last + 1] = HUGE_VAL;
  }
  std::size_t here = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const double x = static_cast<double>(k);
    while (border[here + 1] < x) ++here;
    const double d = x - static_cast<double>(seat[here]);
    values[k * stride] = static_cast<float>(std::min(unreached, d * d + f[seat[here]]));
  }
}

}  // namespace

Vec3 CoarseField::centre_index(std::size_t cell) const {
  const std::size_t i = cell % cells[0], j = cell / cells[0] % cells[1], k = cell / (cells[0] * cells[1]);
  const double half = (static_cast<double>(f) - 1) / 2, wide = static_cast<double>(f);
  return {wide * static_cast<double>(i) + half, wide * static_cast<double>(j) + half,
          wide * static_cast<double>(k) + half};
}

CoarseField coarse_field(io::VolumeSource& source, const Sides& sides) {
  const auto& size = source.head().size;
  CoarseField field;
  while (static_cast<double>(source.head().voxels()) / std::pow(static_cast<double>(field.f), 3) > most_cells)
    ++field.f;
  const std::size_t f = field.f;
  for (std::size_t a = 0; a < 3; ++a) field.cells[a] = size[a] / f;  // an incomplete cell at the end is left out
  const auto& n = field.cells;
  field.mean.assign(n[0] * n[1] * n[2], 0);
  field.depth.assign(field.mean.size(), static_cast<float>(unreached));
  for_each_slab(source, {8 * f, 1, static_cast<float>(sides.air)}, [&](const Slab& slab) {
    const std::vector<float> means = box_means(slab);
    const std::size_t slice = slab.width * slab.height;
    parallel_for(0, slab.count / f, [&](std::size_t layer) {
      const std::size_t ck = slab.first / f + layer;
      if (ck >= n[2]) return;
      for (std::size_t cj = 0; cj < n[1]; ++cj)
        for (std::size_t ci = 0; ci < n[0]; ++ci) {
          double sum = 0;
          bool full = true;
          for (std::size_t k = 0; k < f; ++k)
            for (std::size_t j = 0; j < f; ++j) {
              const std::size_t at = (slab.margin + layer * f + k) * slice + (cj * f + j) * slab.width + ci * f;
              for (std::size_t i = 0; i < f; ++i)
                sum += slab.values[at + i], full = full && sides.surely_object(means[at + i]);
            }
          const std::size_t cell = (ck * n[1] + cj) * n[0] + ci;
          field.mean[cell] = static_cast<float>(sum / std::pow(static_cast<double>(f), 3));
          if (!full) field.depth[cell] = 0;
        }
    });
  });
  const std::size_t slice = n[0] * n[1];
  parallel_for(
      0, n[1] * n[2], [&](std::size_t l) { sweep(field.depth.data() + l * n[0], 1, n[0]); }, 64);
  parallel_for(0, n[2], [&](std::size_t k) {
    for (std::size_t i = 0; i < n[0]; ++i) sweep(field.depth.data() + k * slice + i, n[0], n[1]);
  });
  parallel_for(0, n[1], [&](std::size_t j) {
    for (std::size_t i = 0; i < n[0]; ++i) sweep(field.depth.data() + j * n[0] + i, slice, n[2]);
  });
  // From cell centres to the face between them; a mean falls below its bar three quarters of a voxel within the wall.
  for (float& d : field.depth)
    d = d > 0 ? static_cast<float>((std::sqrt(static_cast<double>(d)) - 0.5) * static_cast<double>(f) + 0.75) : 0;
  return field;
}

std::size_t voxels_at_the_border(io::VolumeSource& source, const Sides& sides) {
  const auto& size = source.head().size;
  const double radius = static_cast<double>(std::min(size[0], size[1])) / 2;
  std::vector<double> radii;
  std::vector<std::size_t> face(size[2], 0), rim(size[2], 0);
  bool constant_outside = true;
  float outside = 0;
  for_each_slab(source, {32, 1, static_cast<float>(sides.air)}, [&](const Slab& slab) {
    const std::vector<float> means = box_means(slab);
    const std::size_t slice = slab.width * slab.height;
    if (radii.empty()) radii = radii_of_slice(slab);
    if (slab.first == 0) outside = slab.values[slab.margin * slice];
    std::vector<std::uint8_t> same(slab.count, 1);
    parallel_for(0, slab.count, [&](std::size_t k) {
      const std::size_t global = slab.first + k, base = (slab.margin + k) * slice;
      const bool end = global == 0 || global + 1 == size[2];
      for (std::size_t j = 0; j < slab.height; ++j)
        for (std::size_t i = 0; i < slab.width; ++i) {
          const std::size_t at = base + j * slab.width + i;
          const double r = radii[j * slab.width + i];
          if (r > radius + 1 && slab.values[at] != outside) same[k] = 0;
          // A mean over neighbours as well as the voxel: single noisy ones are no object.
          if (!(slab.values[at] > sides.half()) || !(means[at] > sides.half())) continue;
          if (end || i == 0 || j == 0 || i + 1 == slab.width || j + 1 == slab.height) ++face[global];
          if (r > radius - 2.5 && r < radius + 0.5) ++rim[global];
        }
    });
    for (const std::uint8_t s : same) constant_outside = constant_outside && s;
  });
  std::size_t sum = 0;
  for (std::size_t k = 0; k < size[2]; ++k) sum += face[k] + (constant_outside ? rim[k] : 0);
  return sum;
}

}  // namespace gonio::volume

// See sample_kinds.h.
#include "photograph/sample_kinds.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace gonio::photograph {
namespace {

constexpr std::size_t rows_of_a_task = 16;

}  // namespace

std::vector<SampleKind> kinds_of(const RawPlane& plane, int width, int height, double full_scale, int blooming_px) {
  const auto columns = static_cast<std::size_t>(width), rows = static_cast<std::size_t>(height),
             reach = static_cast<std::size_t>(blooming_px);
  std::vector<SampleKind> kinds(plane.codes.size());
  auto limit = static_cast<float>(full_scale);  // the least float that is not below it
  if (limit < full_scale) limit = std::nextafter(limit, std::numeric_limits<float>::infinity());
  std::vector<std::uint8_t> spread(plane.codes.size()), row_has_full(rows);  // spread: full, or so beside it in its row
  parallel_for(
      0, rows,
      [&](std::size_t y) {  // without branches
        const float* codes = &plane.codes[y * columns];
        SampleKind* kind = &kinds[y * columns];
        std::uint8_t *wide = &spread[y * columns], any = 0;
        for (std::size_t x = 0; x < columns; ++x) {
          const bool full = codes[x] >= limit, number = codes[x] > -std::numeric_limits<float>::infinity();
          kind[x] = full ? SampleKind::full : number ? SampleKind::read : SampleKind::unusable;
          any |= static_cast<std::uint8_t>(full);
        }
        row_has_full[y] = any;
        if (!plane.unusable.empty())
          for (std::size_t x = 0; x < columns; ++x)
            if (plane.unusable[y * columns + x] != 0 && kind[x] == SampleKind::read) kind[x] = SampleKind::unusable;
        if (any == 0 || reach == 0) return;
        for (std::size_t x = 0; x < columns; ++x) wide[x] = kind[x] == SampleKind::full;
        for (std::size_t by = 1; by <= reach; ++by) {
          for (std::size_t x = 0; x + by < columns; ++x) wide[x] |= kind[x + by] == SampleKind::full;
          for (std::size_t x = by; x < columns; ++x) wide[x] |= kind[x - by] == SampleKind::full;
        }
      },
      rows_of_a_task);
  if (reach == 0) return kinds;
  parallel_for(
      0, rows,
      [&](std::size_t y) {
        SampleKind* kind = &kinds[y * columns];
        for (std::size_t v = y - std::min(y, reach); v <= std::min(rows - 1, y + reach); ++v) {
          if (row_has_full[v] == 0) continue;
          const std::uint8_t* wide = &spread[v * columns];
          for (std::size_t x = 0; x < columns; ++x)
            kind[x] = wide[x] != 0 && kind[x] == SampleKind::read ? SampleKind::unusable : kind[x];
        }
      },
      rows_of_a_task);
  return kinds;
}

}  // namespace gonio::photograph

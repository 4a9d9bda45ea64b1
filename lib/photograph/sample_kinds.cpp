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
  std::vector<SampleKind> kinds(plane.codes.size(), SampleKind::read);
  auto limit = static_cast<float>(full_scale);  // the least float that is not below it
  if (limit < full_scale) limit = std::nextafter(limit, std::numeric_limits<float>::infinity());
  std::vector<std::uint8_t> full(plane.codes.size()), row_has_full(rows);
  parallel_for(
      0, rows,
      [&](std::size_t y) {
        const float* codes = &plane.codes[y * columns];
        SampleKind* kind = &kinds[y * columns];
        std::uint8_t *is_full = &full[y * columns], any = 0;
        for (std::size_t x = 0; x < columns; ++x) {  // without branches
          is_full[x] = codes[x] >= limit;
          const bool number = codes[x] > -std::numeric_limits<float>::infinity();
          kind[x] = is_full[x] != 0 ? SampleKind::full : number ? SampleKind::read : SampleKind::unusable;
          any |= is_full[x];
        }
        row_has_full[y] = any;
        if (plane.unusable.empty()) return;
        for (std::size_t x = 0; x < columns; ++x)
          if (plane.unusable[y * columns + x] != 0 && is_full[x] == 0) kind[x] = SampleKind::unusable;
      },
      rows_of_a_task);
  if (reach == 0) return kinds;
  const auto spread = [&](std::size_t y, std::size_t from) {  // a row's full samples into row y, run by run
    for (std::size_t x = 0; x < columns; ++x) {
      if (full[from * columns + x] == 0) continue;
      std::size_t end = x;
      while (end < columns && full[from * columns + end] != 0) ++end;
      for (std::size_t u = x - std::min(x, reach); u < std::min(columns, end + reach); ++u)
        if (kinds[y * columns + u] == SampleKind::read) kinds[y * columns + u] = SampleKind::unusable;
      x = end;
    }
  };
  parallel_for(
      0, rows,
      [&](std::size_t y) {
        for (std::size_t v = y - std::min(y, reach); v <= std::min(rows - 1, y + reach); ++v)
          if (row_has_full[v] != 0) spread(y, v);
      },
      rows_of_a_task);
  return kinds;
}

}  // namespace gonio::photograph

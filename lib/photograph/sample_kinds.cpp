// See sample_kinds.h.
#include "photograph/sample_kinds.h"

#include <algorithm>
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
  std::vector<std::uint8_t> full(plane.codes.size()), row_has_full(rows);
  parallel_for(
      0, rows,
      [&](std::size_t y) {
        for (std::size_t i = y * columns; i < (y + 1) * columns; ++i) {
          if (plane.codes[i] >= full_scale)
            kinds[i] = SampleKind::full, full[i] = row_has_full[y] = 1;
          else if ((!plane.unusable.empty() && plane.unusable[i] != 0) ||
                   !(plane.codes[i] > -std::numeric_limits<float>::infinity()))
            kinds[i] = SampleKind::unusable;
        }
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

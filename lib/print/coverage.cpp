// See coverage.h.
#include "print/coverage.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/parallel.h"

namespace gonio::print {
namespace {

struct Corner {
  double x = 0, y = 0, z = 0;  // pixels from the grid's corner; metres
};

// Convex. A triangle cut by two heights, two rows and two columns has nine corners at most.
struct Polygon {
  std::array<Corner, 10> corners;
  std::size_t size = 0;
  void add(const Corner& c) { corners[size++] = c; }
};

// Where an edge passes a limit; the same bits from both ends, so that neighbours meet.
template <double Corner::*axis>
Corner crossing(const Corner& a, const Corner& b, double limit) {
  const Corner &low = a.*axis <= b.*axis ? a : b, &high = a.*axis <= b.*axis ? b : a;
  const double t = (limit - low.*axis) / (high.*axis - low.*axis);
  Corner c{low.x + t * (high.x - low.x), low.y + t * (high.y - low.y), low.z + t * (high.z - low.z)};
  c.*axis = limit;
  return c;
}

// Sutherland & Hodgman 1974, both sides at once: what lies at most at the limit, and what lies at least there.
template <double Corner::*axis>
void cut(const Polygon& whole, double limit, Polygon& low, Polygon& high) {
  low.size = high.size = 0;
  for (std::size_t i = 0; i < whole.size; ++i) {
    const Corner &a = whole.corners[i], &b = whole.corners[i + 1 == whole.size ? 0 : i + 1];
    if (a.*axis <= limit) low.add(a);
    if (a.*axis >= limit) high.add(a);
    if ((a.*axis < limit && b.*axis > limit) || (a.*axis > limit && b.*axis < limit)) {
      const Corner c = crossing<axis>(a, b, limit);
      low.add(c);
      high.add(c);
    }
  }
}

template <double Corner::*axis>
std::array<double, 2> extent(const Polygon& p) {
  double low = p.corners[0].*axis, high = low;
  for (std::size_t i = 1; i < p.size; ++i)
    low = std::min(low, p.corners[i].*axis), high = std::max(high, p.corners[i].*axis);
  return {low, high};
}

// Pixels or rows that lie between two coordinates, within the grid.
std::array<int, 2> covered(std::array<double, 2> range, int size) {
  const auto within = [&](double v) { return static_cast<int>(std::clamp(v, 0.0, static_cast<double>(size))); };
  return {within(std::floor(range[0])), within(std::ceil(range[1]))};
}

struct Integral {
  double area = 0, height = 0;  // signed; of the pixel, and of z over it
};
Integral integral(const Polygon& p, double from_m) {
  Integral sum;
  const Corner& o = p.corners[0];
  for (std::size_t i = 1; i + 1 < p.size; ++i) {
    const Corner &a = p.corners[i], &b = p.corners[i + 1];
    const double area = 0.5 * ((a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x));
    sum.area += area;
    sum.height += area * (((o.z - from_m) + (a.z - from_m) + (b.z - from_m)) / 3);
  }
  return sum;
}

void include(PixelBox& box, std::array<int, 2> x, std::array<int, 2> y) {
  if (x[0] >= x[1] || y[0] >= y[1]) return;
  if (box.empty()) {
    box = {x[0], y[0], x[1], y[1]};
    return;
  }
  box.x_begin = std::min(box.x_begin, x[0]), box.x_end = std::max(box.x_end, x[1]);
  box.y_begin = std::min(box.y_begin, y[0]), box.y_end = std::max(box.y_end, y[1]);
}

// `most`: the largest area of one triangle in the pixel so far.
void add_facing(LayerCoverage::Facing& facing, std::size_t pixel, std::uint32_t triangle, double area, double depth,
                float& most) {
  facing.area[pixel] += static_cast<float>(area), facing.depth[pixel] += static_cast<float>(depth);
  if (static_cast<float>(area) <= most) return;
  most = static_cast<float>(area);
  facing.triangle[pixel] = triangle;
}

}  // namespace

struct CoverageSweep::Slice {
  Polygon polygon;
  std::uint32_t triangle = 0;
  std::array<int, 2> columns{}, rows{};
};

CoverageSweep::CoverageSweep(std::span<const Vec3> positions_m, std::span<const std::array<std::uint32_t, 3>> triangles,
                             const PixelGrid& grid, double bottom_m)
    : positions_m_(positions_m), triangles_(triangles), grid_(grid), by_height_(triangles.size()) {
  std::iota(by_height_.begin(), by_height_.end(), 0u);
  const auto lowest = [&](std::uint32_t t) {
    const auto& [a, b, c] = triangles_[t];
    return std::min({positions_m_[a].z, positions_m_[b].z, positions_m_[c].z});
  };
  std::ranges::stable_sort(by_height_, {}, lowest);
  layer_.top_m = bottom_m;
  layer_.share.resize(grid_.pixels());
  for (auto* facing : {&layer_.up, &layer_.down})
    facing->area.resize(grid_.pixels()), facing->depth.resize(grid_.pixels()), facing->triangle.resize(grid_.pixels());
  below_.resize(grid_.pixels());
  if (by_height_.empty()) return;
  if (const double from = lowest(by_height_[0]); from < bottom_m) {
    fill(from, bottom_m);
    layer_.excess = 0;
  }
}

// Triangles that reach into the layer. One that is flat belongs to the layer that it ends; at the very bottom to the
// first.
void CoverageSweep::admit(double bottom_m, double top_m) {
  const auto heights = [&](std::uint32_t t) {
    const auto& [a, b, c] = triangles_[t];
    return std::ranges::minmax({positions_m_[a].z, positions_m_[b].z, positions_m_[c].z});
  };
  std::erase_if(active_, [&](std::uint32_t t) { return heights(t).max <= bottom_m; });
  const std::size_t known = active_.size();
  for (; admitted_ < by_height_.size() && heights(by_height_[admitted_]).min <= top_m; ++admitted_)
    active_.push_back(by_height_[admitted_]);
  std::sort(active_.begin() + static_cast<std::ptrdiff_t>(known), active_.end());
  std::inplace_merge(active_.begin(), active_.begin() + static_cast<std::ptrdiff_t>(known), active_.end());
}

std::vector<CoverageSweep::Slice> CoverageSweep::slices(double bottom_m, double top_m) const {
  std::vector<Slice> all(active_.size());
  parallel_for(
      0, active_.size(),
      [&](std::size_t k) {
        Polygon triangle, above, unused;
        for (const std::uint32_t v : triangles_[active_[k]])
          triangle.add({(positions_m_[v].x - grid_.corner_m.x) / grid_.pixel_m.x,
                        (positions_m_[v].y - grid_.corner_m.y) / grid_.pixel_m.y, positions_m_[v].z});
        cut<&Corner::z>(triangle, bottom_m, unused, above);
        Slice& slice = all[k];
        cut<&Corner::z>(above, top_m, slice.polygon, unused);
        slice.triangle = active_[k];
        if (slice.polygon.size < 3) return;
        slice.columns = covered(extent<&Corner::x>(slice.polygon), grid_.width_px);
        slice.rows = covered(extent<&Corner::y>(slice.polygon), grid_.height_px);
      },
      256);
  return all;
}

const LayerCoverage& CoverageSweep::next(double top_m) {
  fill(layer_.top_m, top_m);
  return layer_;
}

void CoverageSweep::fill(double bottom_m, double top_m) {
  admit(bottom_m, top_m);
  layer_.bottom_m = bottom_m, layer_.top_m = top_m;
  const std::vector<Slice> cuts = slices(bottom_m, top_m);
  std::vector<std::vector<std::uint32_t>> of_row(static_cast<std::size_t>(grid_.height_px));
  for (std::uint32_t k = 0; k < cuts.size(); ++k) {
    const auto [columns, rows] = std::pair{cuts[k].columns, cuts[k].rows};
    if (columns[0] >= columns[1]) continue;
    include(layer_.box, columns, rows);
    for (int row = rows[0]; row < rows[1]; ++row) of_row[static_cast<std::size_t>(row)].push_back(k);
  }
  std::vector<double> excess(of_row.size());
  if (!layer_.box.empty())
    parallel_for(
        static_cast<std::size_t>(layer_.box.y_begin), static_cast<std::size_t>(layer_.box.y_end),
        [&](std::size_t row) { excess[row] = fill_row(cuts, of_row[row], static_cast<int>(row)); }, 8);
  layer_.excess = excess.empty() ? 0 : std::ranges::max(excess);
}

// Returns the row's largest excess.
double CoverageSweep::fill_row(std::span<const Slice> slices, std::span<const std::uint32_t> mine, int row) {
  const std::size_t first = static_cast<std::size_t>(row) * static_cast<std::size_t>(grid_.width_px);
  double* const share = layer_.share.data() + first;
  double* const below = below_.data() + first;
  const double thickness = layer_.top_m - layer_.bottom_m;
  for (int i = layer_.box.x_begin; i < layer_.box.x_end; ++i) share[i] = -thickness * below[i];
  std::vector<float> most_up(static_cast<std::size_t>(grid_.width_px)), most_down(most_up);
  for (auto* facing : {&layer_.up, &layer_.down})
    for (int i = layer_.box.x_begin; i < layer_.box.x_end; ++i)
      facing->area[first + static_cast<std::size_t>(i)] = facing->depth[first + static_cast<std::size_t>(i)] = 0;
  Polygon rest, part, unused;
  for (const std::uint32_t k : mine) {
    const Slice& slice = slices[k];
    cut<&Corner::y>(slice.polygon, row, unused, rest);
    cut<&Corner::y>(rest, row + 1, part, unused);
    if (part.size < 3) continue;
    cut<&Corner::x>(part, slice.columns[0], unused, rest);
    for (int i = slice.columns[0]; i < slice.columns[1] && rest.size >= 3; ++i) {
      const Polygon whole = rest;
      cut<&Corner::x>(whole, i + 1, part, rest);
      if (part.size < 3) continue;
      const auto [area, height] = integral(part, layer_.bottom_m);
      share[i] += height - thickness * area;
      below[i] += area;
      const std::size_t pixel = first + static_cast<std::size_t>(i);
      if (area > 0)
        add_facing(layer_.up, pixel, slice.triangle, area, height / thickness, most_up[static_cast<std::size_t>(i)]);
      else if (area < 0)
        add_facing(layer_.down, pixel, slice.triangle, -area, height / thickness - area,
                   most_down[static_cast<std::size_t>(i)]);
    }
  }
  double excess = 0;
  for (int i = layer_.box.x_begin; i < layer_.box.x_end; ++i) {
    share[i] /= thickness;
    excess = std::max({excess, share[i] - 1, -share[i]});
    share[i] = std::clamp(share[i], 0.0, 1.0);
  }
  return excess;
}

}  // namespace gonio::print

// See code_places.h.
#include "scan/code_places.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace gonio::scan {
namespace {

constexpr double least_spread = 0.02;  // px^2 of the projector, in each axis: codes that span a plane
constexpr double rounding = 1.0 / 12;  // variance of what is rounded to whole numbers
constexpr double enough = 12;          // pixels that need no neighbours
constexpr int widest_gap = 4;          // pixels between those of one code: borders of stripes are refused
constexpr int neighbours = 3;          // pixels to each side
constexpr float near_code = 6;         // pixels of the projector
constexpr std::size_t most_compared = 50000, least_compared = 500;
constexpr std::int64_t least_apart = 3, most_apart = 12;  // cells
constexpr double torn = 100;                              // of a squared difference, over its variance
constexpr double bent = 3;  // times a cell's own variance: a plane over its neighbours does not fit

// Sums, with weights, over pixels (x, y) at distances (u, v) of their codes from a pixel of the projector.
struct PixelSums {
  double pixels = 0, squared_weights = 0;
  double n = 0, u = 0, v = 0, x = 0, y = 0, uu = 0, uv = 0, vv = 0, ux = 0, vx = 0, uy = 0, vy = 0, xx = 0, yy = 0;

  void add(double du, double dv, double px, double py) {
    ++pixels, ++squared_weights;
    ++n, u += du, v += dv, x += px, y += py, uu += du * du, uv += du * dv, vv += dv * dv;
    ux += du * px, vx += dv * px, uy += du * py, vy += dv * py, xx += px * px, yy += py * py;
  }
  // Those of another pixel of the projector, which lies (du, dv) from this one.
  void add(const PixelSums& o, double du, double dv, double weight) {
    pixels += o.pixels, squared_weights += weight * weight * o.squared_weights;
    n += weight * o.n, u += weight * (o.u + o.n * du), v += weight * (o.v + o.n * dv);
    x += weight * o.x, y += weight * o.y;
    uu += weight * (o.uu + 2 * du * o.u + o.n * du * du), vv += weight * (o.vv + 2 * dv * o.v + o.n * dv * dv);
    uv += weight * (o.uv + du * o.v + dv * o.u + o.n * du * dv);
    ux += weight * (o.ux + du * o.x), vx += weight * (o.vx + dv * o.x);
    uy += weight * (o.uy + du * o.y), vy += weight * (o.vy + dv * o.y);
    xx += weight * o.xx, yy += weight * o.yy;
  }
  double variance() const { return 0.5 * (xx - x * x / n + yy - y * y / n) / n; }
};

struct Cell {
  std::int64_t code = 0;
  PixelSums sums;
  double reflected = 0;
};

// The centroid; its variance that of the pixels, over their number.
CodePlace centroid(const PixelSums& s) {
  CodePlace p;
  p.pixel = {s.x / s.n, s.y / s.n};
  const double xx = (s.xx - s.x * s.x / s.n) / s.n, yy = (s.yy - s.y * s.y / s.n) / s.n;
  p.variance_px2 = Vec2{std::max(rounding, xx), std::max(rounding, yy)} * (1 / s.n);
  return p;
}

// x and y as planes over (u, v), at (0, 0). `left`: of a pixel, the mean of both coordinates; of whole codes neither
// has less than their rounding, whatever a regular grid of them hides. False where codes do not span a plane.
bool on_plane(const PixelSums& s, bool whole, CodePlace& p, double& left) {
  const double cuu = s.uu - s.u * s.u / s.n, cuv = s.uv - s.u * s.v / s.n, cvv = s.vv - s.v * s.v / s.n,
               determinant = cuu * cvv - cuv * cuv;
  if (s.pixels < 4 || cuu < least_spread * s.n || cvv < least_spread * s.n || determinant < 0.2 * cuu * cvv)
    return false;
  const double free_share = (s.pixels - 3) / s.pixels;
  const auto at_zero = [&](double sx, double su, double sv, double square, double& own) {
    const double cu = su - s.u * sx / s.n, cv = sv - s.v * sx / s.n, a = (cvv * cu - cuv * cv) / determinant,
                 b = (cuu * cv - cuv * cu) / determinant;
    const double squares = std::max(0.0, square - sx * sx / s.n - a * cu - b * cv);
    own = std::max({squares / (s.n * free_share), whole ? (a * a + b * b) * rounding : 0, 1e-6});
    return (sx - a * s.u - b * s.v) / s.n;
  };
  Vec2 own;
  p.pixel.x = at_zero(s.x, s.ux, s.vx, s.xx, own.x), p.pixel.y = at_zero(s.y, s.uy, s.vy, s.yy, own.y);
  left = 0.5 * (own.x + own.y);
  const double lever = 1 / s.n + (cvv * s.u * s.u - 2 * cuv * s.u * s.v + cuu * s.v * s.v) / (s.n * s.n * determinant);
  p.variance_px2 = own * (lever * s.squared_weights / s.n);
  return true;
}

// The projector's pixel that lit a pixel of the camera; -1: none.
std::int64_t code_of(const Codes& codes, std::size_t i, int projector_width_px) {
  if (!codes.told(i)) return -1;
  const auto column = static_cast<std::int64_t>(std::lround(codes.place[0][i])),
             row = static_cast<std::int64_t>(std::lround(codes.place[1][i]));
  return column >= 0 && row >= 0 && column < projector_width_px ? row * projector_width_px + column : -1;
}

// Pixels in the order of their codes: counted first, then put in their places.
struct ByCode {
  std::vector<std::uint32_t> first;  // of each code, in `pixels`, and the end
  std::vector<std::uint32_t> pixels;
};
ByCode by_code(const Codes& codes, int projector_width_px) {
  ByCode sorted;
  for (std::size_t i = 0; i < codes.refusal.size(); ++i) {
    const std::int64_t code = code_of(codes, i, projector_width_px);
    if (code < 0) continue;
    if (static_cast<std::size_t>(code) + 2 > sorted.first.size())
      sorted.first.resize(static_cast<std::size_t>(code) + 2);
    ++sorted.first[static_cast<std::size_t>(code) + 1];
  }
  for (std::size_t c = 1; c < sorted.first.size(); ++c) sorted.first[c] += sorted.first[c - 1];
  sorted.pixels.resize(sorted.first.empty() ? 0 : sorted.first.back());
  std::vector<std::uint32_t> next = sorted.first;
  for (std::size_t i = 0; i < codes.refusal.size(); ++i) {
    const std::int64_t code = code_of(codes, i, projector_width_px);
    if (code >= 0) sorted.pixels[next[static_cast<std::size_t>(code)]++] = static_cast<std::uint32_t>(i);
  }
  return sorted;
}

// How many pixels about one tell a pixel of the projector next to its own.
int support(const Codes& codes, std::uint32_t pixel) {
  const auto width = static_cast<std::uint32_t>(codes.width);
  const int x = static_cast<int>(pixel % width), y = static_cast<int>(pixel / width);
  int count = 0;
  for (int v = std::max(0, y - neighbours); v <= std::min(codes.height - 1, y + neighbours); ++v)
    for (int u = std::max(0, x - neighbours); u <= std::min(codes.width - 1, x + neighbours); ++u) {
      const auto i = static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u);
      count += codes.told(i) && std::abs(codes.place[0][i] - codes.place[0][pixel]) < near_code &&
               std::abs(codes.place[1][i] - codes.place[1][pixel]) < near_code;
    }
  return count;
}

// A box about pixels of one code that touch, but for gaps.
struct Cluster {
  int left = 0, right = 0, top = 0, bottom = 0, support = 0;
  bool near(const Cluster& o) const {
    return o.left - right <= widest_gap && left - o.right <= widest_gap && o.top - bottom <= widest_gap &&
           top - o.bottom <= widest_gap;
  }
  void join(const Cluster& o) {
    left = std::min(left, o.left), right = std::max(right, o.right);
    top = std::min(top, o.top), bottom = std::max(bottom, o.bottom);
  }
};

// Of the pixels of one code those that are ambiguous are moved to the end; how many are left.
std::size_t unambiguous(const Codes& codes, std::span<std::uint32_t> pixels) {
  const auto width = static_cast<std::uint32_t>(codes.width);
  const auto point = [width](std::uint32_t p) {
    const int x = static_cast<int>(p % width), y = static_cast<int>(p / width);
    return Cluster{x, x, y, y};
  };
  std::vector<Cluster> clusters{point(pixels[0])};
  for (const std::uint32_t p : pixels.subspan(1)) {
    Cluster own = point(p);
    if (clusters.size() == 1 && clusters[0].near(own)) {
      clusters[0].join(own);
      continue;
    }
    while (std::erase_if(clusters, [&own](const Cluster& c) { return own.near(c) && (own.join(c), true); }) > 0) {
    }
    clusters.push_back(own);
  }
  if (clusters.size() == 1) return pixels.size();
  const auto of = [&](std::uint32_t p) -> Cluster& {
    const Cluster own = point(p);
    return *std::ranges::find_if(clusters, [&own](const Cluster& c) {
      return c.left <= own.left && own.left <= c.right && c.top <= own.top && own.top <= c.bottom;
    });
  };
  for (const std::uint32_t p : pixels) of(p).support = std::max(of(p).support, support(codes, p));
  const Cluster& best = *std::ranges::max_element(clusters, {}, &Cluster::support);
  const bool clear =
      std::ranges::all_of(clusters, [&](const Cluster& c) { return &c == &best || best.support >= 2 * c.support; });
  const auto end = std::ranges::stable_partition(pixels, [&](std::uint32_t p) { return clear && &of(p) == &best; });
  return pixels.size() - end.size();
}

std::vector<Cell> cells_of(const Codes& codes, int projector_width_px, std::size_t* ambiguous) {
  const std::vector<float>&columns = codes.place[0], &rows = codes.place[1];
  ByCode sorted = by_code(codes, projector_width_px);
  std::vector<Cell> cells;
  const auto width = static_cast<std::uint32_t>(codes.width);
  for (std::size_t code = 0; code + 1 < sorted.first.size(); ++code) {
    const std::span<std::uint32_t> all(&sorted.pixels[0] + sorted.first[code],
                                       &sorted.pixels[0] + sorted.first[code + 1]);
    const std::size_t kept = all.empty() ? 0 : unambiguous(codes, all);
    if (ambiguous != nullptr) *ambiguous += all.size() - kept;
    if (kept == 0) continue;
    Cell& cell = cells.emplace_back();
    cell.code = static_cast<std::int64_t>(code);
    for (const std::uint32_t i : all.first(kept)) {
      cell.sums.add(columns[i] - std::round(columns[i]), rows[i] - std::round(rows[i]), i % width, i / width);
      cell.reflected += codes.reflected[i];
    }
  }
  return cells;
}

}  // namespace

double saw_factor(std::span<const CodePlace> places, int projector_width_px) {
  const std::size_t stride = 1 + places.size() / most_compared;
  const auto find = [&places](std::int64_t code) {
    const auto at = std::ranges::lower_bound(places, code, {}, &CodePlace::code);
    return at != places.end() && at->code == code ? &*at : nullptr;
  };
  Vec2 factor{1, 1};
  for (const std::int64_t along : {std::int64_t{1}, static_cast<std::int64_t>(projector_width_px)}) {
    double x = 0, y = 0, count = 0;
    for (std::size_t i = 0; i < places.size(); i += stride) {
      const std::int64_t n =
          along * (least_apart + static_cast<std::int64_t>(i / stride) % (most_apart - least_apart + 1));
      const CodePlace &a = places[i], *b = find(a.code + n), *c = find(a.code + 2 * n), *d = find(a.code + 3 * n);
      if (b == nullptr || c == nullptr || d == nullptr) continue;
      const Vec2 off = a.pixel - b->pixel * 3 + c->pixel * 3 - d->pixel,
                 v = a.variance_px2 + b->variance_px2 * 9 + c->variance_px2 * 9 + d->variance_px2;
      const double qx = off.x * off.x / v.x, qy = off.y * off.y / v.y;
      if (qx > torn || qy > torn) continue;  // an edge of the scene
      x += qx, y += qy, ++count;
    }
    if (count < least_compared) continue;
    factor.x = std::max(factor.x, x / count), factor.y = std::max(factor.y, y / count);
  }
  return 0.5 * (factor.x + factor.y);
}

std::vector<std::uint32_t> ambiguous_pixels(const Codes& codes, int projector_width_px) {
  std::vector<std::uint32_t> all;
  if (codes.place[0].empty() || codes.place[1].empty()) return all;
  ByCode sorted = by_code(codes, projector_width_px);
  for (std::size_t code = 0; code + 1 < sorted.first.size(); ++code) {
    if (sorted.first[code] == sorted.first[code + 1]) continue;
    const std::span<std::uint32_t> own(&sorted.pixels[0] + sorted.first[code],
                                       &sorted.pixels[0] + sorted.first[code + 1]);
    const auto wrong = own.subspan(unambiguous(codes, own));
    all.insert(all.end(), wrong.begin(), wrong.end());
  }
  return all;
}

std::vector<CodePlace> places_of(const Codes& codes, int projector_width_px, std::size_t* ambiguous) {
  const std::vector<Cell> cells = cells_of(codes, projector_width_px, ambiguous);
  std::vector<CodePlace> places;
  std::array<std::size_t, 3> first{};  // of the rows above, here and below: the cell at or beyond the column before
  for (const Cell& cell : cells) {
    CodePlace place = centroid(cell.sums);
    double left = 0;
    if (codes.whole || cell.sums.n < enough || !on_plane(cell.sums, false, place, left)) {
      PixelSums all;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int64_t row = cell.code + (static_cast<std::int64_t>(k) - 1) * projector_width_px;
        while (first[k] < cells.size() && cells[first[k]].code < row - 1) ++first[k];
        for (std::size_t c = first[k]; c < cells.size() && cells[c].code <= row + 1; ++c)
          all.add(cells[c].sums, static_cast<double>(cells[c].code - row), static_cast<double>(k) - 1,
                  (cells[c].code == row ? 1 : 0.5) * (k == 1 ? 1 : 0.5));
      }
      CodePlace wider;
      if (on_plane(all, codes.whole, wider, left) && left < bent * std::max(rounding, cell.sums.variance()))
        place = wider;
    }
    place.code = cell.code, place.reflected = static_cast<float>(cell.reflected / cell.sums.n);
    places.push_back(place);
  }
  return places;
}

}  // namespace gonio::scan

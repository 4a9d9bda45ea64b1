// See areal.h.
#include "relief/areal.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace gonio::relief {
namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

struct Moments {
  double n = 0, mean = 0, sa = 0, m2 = 0, m3 = 0, m4 = 0, sign = 0, high = -1e300, low = 1e300;
};
Moments moments_of(const std::vector<double>& z) {
  Moments m;
  for (const double v : z)
    if (std::isfinite(v)) m.n += 1, m.mean += v;
  m.mean /= m.n;
  for (const double v : z) {
    if (!std::isfinite(v)) continue;
    const double d = v - m.mean;
    m.sa += std::abs(d), m.m2 += d * d, m.m3 += d * d * d, m.m4 += d * d * d * d, m.sign += d > 0 ? 1 : -1;
    m.high = std::max(m.high, d), m.low = std::min(m.low, d);
  }
  m.sa /= m.n, m.m2 /= m.n, m.m3 /= m.n, m.m4 /= m.n, m.sign /= m.n;
  return m;
}

struct Cell {
  double slope2 = missing, area = missing;
};
double triangle(double ax, double ay, double az, double bx, double by, double bz) {
  return 0.5 * std::hypot(ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx);
}
Cell cell_of(const io::HeightMap& map, std::size_t x, std::size_t y) {
  const double a = map.at(x, y), b = map.at(x + 1, y), c = map.at(x, y + 1), d = map.at(x + 1, y + 1);
  if (!std::isfinite(a + b + c + d)) return {};
  const double dx = map.step_x_m, dy = map.step_y_m;
  const double gx = (b + d - a - c) / (2 * dx), gy = (c + d - a - b) / (2 * dy);
  const double one = triangle(dx, 0, b - a, 0, dy, c - a) + triangle(-dx, 0, c - d, 0, -dy, b - d),
               two = triangle(-dx, 0, a - b, 0, dy, d - b) + triangle(dx, 0, d - c, 0, -dy, a - c);
  return {gx * gx + gy * gy, 0.5 * (one + two) / (dx * dy)};
}

// Of one grid of tiles, tile for tile: sums of the fields' deviations from their means.
struct Tiles {
  std::vector<double> sums;
  double points = 0;
};
Tiles tiles_of(const std::vector<std::vector<double>>& fields, std::size_t width, std::size_t height,
               std::size_t grid) {
  const std::size_t f = fields.size();
  Tiles tiles{std::vector<double>(grid * grid * f), 0};
  std::vector<double> counts(grid * grid), total(f);
  for (std::size_t y = 0; y < height; ++y)
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t i = y * width + x, t = y * grid / height * grid + x * grid / width;
      if (!std::isfinite(fields[0][i])) continue;
      counts[t] += 1, tiles.points += 1;
      for (std::size_t k = 0; k < f; ++k) tiles.sums[t * f + k] += fields[k][i], total[k] += fields[k][i];
    }
  for (std::size_t t = 0; t < counts.size(); ++t)
    for (std::size_t k = 0; k < f; ++k) tiles.sums[t * f + k] -= counts[t] * total[k] / tiles.points;
  return tiles;
}

// Covariance of the fields' means: products of each tile with itself and its eight neighbours. Deviations from the
// common mean take the share (pairs / tiles^2) of it away, which is given back.
std::vector<double> of_grid(const std::vector<std::vector<double>>& fields, std::size_t width, std::size_t height,
                            std::size_t grid) {
  const std::size_t f = fields.size();
  const Tiles tiles = tiles_of(fields, width, height, grid);
  std::vector<double> covariance(f * f);
  const auto n = static_cast<std::ptrdiff_t>(grid);
  double pairs = 0;
  for (std::ptrdiff_t y = 0; y < n; ++y)
    for (std::ptrdiff_t x = 0; x < n; ++x)
      for (std::ptrdiff_t v = std::max<std::ptrdiff_t>(0, y - 1); v <= std::min(n - 1, y + 1); ++v)
        for (std::ptrdiff_t u = std::max<std::ptrdiff_t>(0, x - 1); u <= std::min(n - 1, x + 1); ++u) {
          pairs += 1;
          const double *one = &tiles.sums[static_cast<std::size_t>(y * n + x) * f],
                       *other = &tiles.sums[static_cast<std::size_t>(v * n + u) * f];
          for (std::size_t a = 0; a < f; ++a)
            for (std::size_t b = 0; b < f; ++b) covariance[a * f + b] += one[a] * other[b];
        }
  const double all = static_cast<double>(grid * grid);
  for (double& c : covariance) c /= tiles.points * tiles.points * (1 - pairs / (all * all));
  return covariance;
}

}  // namespace

MeanVariance variance_of_means(const std::vector<std::vector<double>>& fields, std::size_t width, std::size_t height) {
  const std::size_t f = fields.size();
  MeanVariance best;
  double largest = -1, coarse[2] = {0, 0};
  for (const std::size_t grid : {6u, 8u, 12u, 16u, 24u, 32u}) {
    if (grid > 6 && (width < 3 * grid || height < 3 * grid)) break;
    std::vector<double> c = of_grid(fields, width, height, grid);
    double trace = 0;  // relative to the first grid's, field by field
    for (std::size_t k = 0; k < f; ++k)
      trace += best.covariance.empty() ? 1 : c[k * f + k] / std::max(1e-300, best.covariance[k * f + k]);
    if (grid == 6) coarse[0] = c[0];
    if (grid == 12) coarse[1] = c[0];
    if (largest < 0 || (c[0] > 0 && trace > static_cast<double>(f))) best.covariance = std::move(c), largest = trace;
  }
  double n = 0, mean = 0, squares = 0;
  for (const double v : fields[0])
    if (std::isfinite(v)) n += 1, mean += v, squares += v * v;
  mean /= n;
  const double variance = squares / n - mean * mean;
  best.independent = best.covariance[0] > 0 ? std::min(n, variance / best.covariance[0]) : n;
  best.rising = coarse[1] > 0 && coarse[0] > 2.5 * coarse[1];
  return best;
}

const Figure& Roughness::operator[](const std::string& name) const {
  for (const Figure& f : figures)
    if (f.name == name) return f;
  throw std::out_of_range(name);
}

Roughness roughness(const io::HeightMap& map) {
  const Moments m = moments_of(map.z_m);
  const double sq = std::sqrt(m.m2), ssk = sq > 0 ? m.m3 / (sq * m.m2) : 0, sku = sq > 0 ? m.m4 / (m.m2 * m.m2) : 0;
  const std::size_t n = map.z_m.size();
  std::vector<std::vector<double>> heights(4, std::vector<double>(n, missing)),
      cells(2, std::vector<double>(n, missing));
  for (std::size_t i = 0; i < n && sq > 0; ++i) {
    if (!std::isfinite(map.z_m[i])) continue;
    const double d = map.z_m[i] - m.mean, t = d / sq;
    heights[0][i] = (d * d - m.m2) / (2 * sq);
    heights[1][i] = std::abs(d) - m.sa - m.sign * d;
    heights[2][i] = t * t * t - ssk - 1.5 * ssk * (t * t - 1) - 3 * t;
    heights[3][i] = t * t * t * t - sku - 2 * sku * (t * t - 1) - 4 * ssk * t;
  }
  double count = 0, slope2 = 0, area = 0;
  for (std::size_t y = 0; y + 1 < map.height; ++y)
    for (std::size_t x = 0; x + 1 < map.width; ++x) {
      const Cell c = cell_of(map, x, y);
      if (!std::isfinite(c.area)) continue;
      cells[0][y * map.width + x] = c.slope2, cells[1][y * map.width + x] = c.area - 1;
      count += 1, slope2 += c.slope2, area += c.area - 1;
    }
  const double sdq = count > 0 ? std::sqrt(slope2 / count) : 0, sdr = count > 0 ? area / count : 0;
  Roughness r;
  std::vector<double> s(6, 0.0);
  if (sq > 0 && count > 0) {
    const MeanVariance h = variance_of_means(heights, map.width, map.height),
                       c = variance_of_means(cells, map.width, map.height);
    for (std::size_t k = 0; k < 4; ++k) s[k] = std::sqrt(std::max(0.0, h.covariance[k * 5]));
    s[4] = std::sqrt(std::max(0.0, c.covariance[0])) / (2 * sdq), s[5] = std::sqrt(std::max(0.0, c.covariance[3]));
    r.independent_areas = h.independent, r.long_waves = h.rising;
  }
  r.figures = {{"Sa", "m", "mean height", m.sa, s[1]},
               {"Sq", "m", "root mean square height", sq, s[0]},
               {"Sz", "m", "from the lowest point to the highest", m.high - m.low, {}},
               {"Sp", "m", "highest point above the mean", m.high, {}},
               {"Sv", "m", "lowest point below the mean", -m.low, {}},
               {"Ssk", "1", "skewness: negative where pits prevail", ssk, s[2]},
               {"Sku", "1", "kurtosis: 3 for heights of a normal distribution", sku, s[3]},
               {"Sdq", "1", "root mean square gradient", sdq, s[4]},
               {"Sdr", "1", "area over projected area, less one", sdr, s[5]}};
  return r;
}

}  // namespace gonio::relief

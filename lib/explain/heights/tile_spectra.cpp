// See tile_spectra.h.
#include "explain/heights/tile_spectra.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/parallel.h"
#include "geom/vector.h"
#include "relief/fft.h"

namespace gonio::explain::heights {
namespace {

constexpr std::size_t fewest_tiles = 8, smallest_tile = 32, largest_tile = 256;
constexpr int lowest_cycles = 2, highest_cycles = 40, block_side = 4;

using relief::Complex, relief::hann, relief::transform_square;

// Least squares z = a + b u + c v over the finite points, u and v from the middle; missing points become the plane.
bool level(std::vector<double>& z, std::size_t n) {
  const double middle = 0.5 * (static_cast<double>(n) - 1);
  std::size_t missing = 0;
  double sums[3] = {0, 0, 0}, uu = 0, uv = 0, vv = 0, su = 0, sv = 0, count = 0;
  for (std::size_t i = 0; i < z.size(); ++i) {
    if (!std::isfinite(z[i])) {
      ++missing;
      continue;
    }
    const double u = static_cast<double>(i % n) - middle, v = static_cast<double>(i / n) - middle;
    count += 1, su += u, sv += v, uu += u * u, uv += u * v, vv += v * v;
    sums[0] += z[i], sums[1] += z[i] * u, sums[2] += z[i] * v;
  }
  if (50 * missing > z.size()) return false;
  const double mu = su / count, mv = sv / count, mz = sums[0] / count;
  const double a = uu - count * mu * mu, b = uv - count * mu * mv, c = vv - count * mv * mv, d = a * c - b * b;
  const double zu = sums[1] - mz * su, zv = sums[2] - mz * sv;
  const double slope_u = (c * zu - b * zv) / d, slope_v = (a * zv - b * zu) / d;
  for (std::size_t i = 0; i < z.size(); ++i) {
    const double u = static_cast<double>(i % n) - middle, v = static_cast<double>(i / n) - middle;
    z[i] = std::isfinite(z[i]) ? z[i] - mz - slope_u * (u - mu) - slope_v * (v - mv) : 0;
  }
  return true;
}

void list_ordinates(TileSpectra& spectra) {
  const int n = static_cast<int>(spectra.n);
  const double length_x = spectra.step_x_m * n, length_y = spectra.step_y_m * n;
  // A quarter of a cycle per point, or as many cycles as finer tiles would show better.
  const double highest = std::min(0.25 * n, double{highest_cycles}) / std::max(length_x, length_y);
  std::map<std::pair<int, int>, std::uint32_t> blocks;
  for (int ky = -n / 2 + 1; ky < n / 2; ++ky)
    for (int kx = 0; kx < n / 2; ++kx) {
      if (kx == 0 && ky <= 0) continue;
      if (kx * kx + ky * ky < lowest_cycles * lowest_cycles) continue;
      const double fx = kx / length_x, fy = ky / length_y;
      if (std::hypot(fx, fy) > highest) continue;
      const std::pair<int, int> cell{kx / block_side, (ky + n) / block_side};
      const auto block = blocks.try_emplace(cell, static_cast<std::uint32_t>(blocks.size())).first->second;
      spectra.ordinates.push_back({kx, ky, fx, fy, block});
    }
  spectra.blocks = static_cast<std::uint32_t>(blocks.size());
}

std::vector<double> log_power(std::vector<double> z, const TileSpectra& spectra) {
  const std::size_t n = spectra.n;
  std::vector<Complex> data(n * n);
  double squares = 0;
  for (std::size_t i = 0; i < data.size(); ++i) {
    const double w = hann(i % n, n) * hann(i / n, n);
    squares += w * w;
    data[i] = w * z[i];
  }
  transform_square(data, n);
  const double scale = spectra.step_x_m * spectra.step_y_m / squares;
  std::vector<double> result;
  for (const Ordinate& o : spectra.ordinates) {
    const std::size_t row = static_cast<std::size_t>(o.ky < 0 ? o.ky + static_cast<int>(n) : o.ky);
    result.push_back(std::log(std::norm(data[row * n + static_cast<std::size_t>(o.kx)]) * scale + 1e-60));
  }
  return result;
}

// Tiles along one side: each begins in the middle of the one before.
std::size_t along(std::size_t points, std::size_t n) {
  return points < n ? 0 : 2 * points / n - 1;
}

std::size_t tile_side(const io::HeightMap& map, const std::string& place) {
  for (std::size_t n = largest_tile; n >= smallest_tile; n /= 2)
    if (along(map.width, n) * along(map.height, n) >= fewest_tiles) return n;
  throw Error(Exit::data, place,
              "has " + std::to_string(map.width) + " x " + std::to_string(map.height) +
                  " points, and explain leaves tiles out to judge (64 x 96 at least)",
              "measure a larger field");
}

}  // namespace

double hann_response(double bins) {
  const double x = std::abs(bins);
  if (x < 1e-9) return 1;
  if (std::abs(x - 1) < 1e-9) return 0.5;
  return std::sin(pi * x) / (pi * x * (1 - x * x));
}

// |sum w A/2|^2 dx dy / sum w^2, with sum w = (n / 2)^2 and sum w^2 = (3 n / 8)^2 of Hann's window in two dimensions.
double TileSpectra::line_gain() const {
  const double points = static_cast<double>(n);
  const double sum = 0.25 * points * points, squares = 0.140625 * points * points;
  return 0.25 * sum * sum / squares * step_x_m * step_y_m;
}

TileSpectra tile_spectra(const io::HeightMap& map, const std::string& place) {
  TileSpectra spectra;
  spectra.n = tile_side(map, place);
  spectra.step_x_m = map.step_x_m, spectra.step_y_m = map.step_y_m;
  list_ordinates(spectra);
  const std::size_t n = spectra.n, columns = along(map.width, n), rows = along(map.height, n);
  // In the middle of the map.
  const std::size_t left = (map.width - (columns + 1) * n / 2) / 2, top = (map.height - (rows + 1) * n / 2) / 2;
  std::vector<Tile> tiles(columns * rows);
  std::vector<char> sound(tiles.size());
  parallel_for(0, tiles.size(), [&](std::size_t t) {
    tiles[t].x = left + t % columns * n / 2, tiles[t].y = top + t / columns * n / 2;
    std::vector<double> z(n * n);
    for (std::size_t i = 0; i < z.size(); ++i) z[i] = map.at(tiles[t].x + i % n, tiles[t].y + i / n);
    sound[t] = level(z, n);
    if (sound[t]) tiles[t].log_power = log_power(std::move(z), spectra);
  });
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    if (!sound[t])
      ++spectra.left_out;
    else
      ((t % columns + 2 * (t / columns)) % 4 == 1 ? spectra.searched : spectra.judged).push_back(std::move(tiles[t]));
  }
  if (spectra.judged.size() < 6 || spectra.searched.empty())
    throw Error(Exit::data, place, "has too few tiles without gaps: " + std::to_string(spectra.judged.size()),
                "measure a larger field, or one with fewer points missing");
  return spectra;
}

}  // namespace gonio::explain::heights

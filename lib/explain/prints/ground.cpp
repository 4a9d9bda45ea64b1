// See ground.h.
#include "explain/prints/ground.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "linear/blocks.h"
#include "linear/solve.h"
#include "print/mechanisms/print_ground_noise.h"
#include "stats/distributions.h"

namespace gonio::explain::prints {
namespace {

constexpr int tile_px = 8, margin_px = 3, most_tiles = 64, fewest_tiles = 4, fewest_pixels = 24;
constexpr double gentle = 0.25;  // of a layer, from pixel to pixel
constexpr double shortest_px = 0.7, longest_px = 6;
constexpr int lengths = 9;

struct Pixel {
  double x = 0, y = 0, z_um = 0;
};
using Tile = std::vector<Pixel>;
using At = std::tuple<int, int>;  // x, y

bool is_gentle(const Reading& r, double layer_um) {
  return std::max({std::abs(r.slope_x), std::abs(r.slope_y), std::abs(r.bend)}) < gentle * layer_um;
}

bool same_history(const Sent& sent, std::size_t a, std::size_t b) {
  return std::ranges::all_of(sent.layers, [&](const std::vector<float>& layer) { return layer[a] == layer[b]; });
}

bool is_even_about(const Sent& sent, const Reading& r) {
  const auto pixel = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(sent.wide()) + static_cast<std::size_t>(x);
  };
  for (int dy = -margin_px; dy <= margin_px; ++dy)
    for (int dx = -margin_px; dx <= margin_px; ++dx) {
      const int x = r.x_px + dx, y = r.y_px + dy;
      if (x < 0 || y < 0 || x >= sent.wide() || y >= sent.high()) return false;
      if (!same_history(sent, pixel(x, y), pixel(r.x_px, r.y_px))) return false;
    }
  return true;
}

void add(std::map<std::tuple<std::size_t, int, int>, Tile>& tiles, std::size_t map, const Reading& r, double z_um) {
  tiles[{map, r.x_px / tile_px, r.y_px / tile_px}].push_back(
      {static_cast<double>(r.x_px), static_cast<double>(r.y_px), z_um});
}

using Pair = std::pair<const Reading*, const Reading*>;

// Differences of heights, less what another plane and place of either map make of the simulated surface.
Eigen::VectorXd differences(const std::vector<Pair>& pairs) {
  const auto n = static_cast<Eigen::Index>(pairs.size());
  Eigen::MatrixXd columns(n, 5);
  Eigen::VectorXd z(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& [a, b] = pairs[static_cast<std::size_t>(i)];
    columns.row(i) << 1, 1e-2 * a->x_px, 1e-2 * a->y_px, a->slope_x, a->slope_y;
    z[i] = a->z_um - b->z_um;
  }
  const Eigen::MatrixXd normal = columns.transpose() * columns;
  return z - columns * linear::Ldlt(normal).solve(Eigen::VectorXd(columns.transpose() * z));
}

// Of two maps after each other, over the root of two: as large as what either map has of its own.
std::vector<Tile> between_maps(const Readings& readings, double layer_um) {
  std::vector<std::map<At, const Reading*>> maps;
  for (const Reading& r : readings.rows) {
    if (r.map >= maps.size()) maps.resize(r.map + 1);
    if (is_gentle(r, layer_um)) maps[r.map][{r.x_px, r.y_px}] = &r;
  }
  std::map<std::tuple<std::size_t, int, int>, Tile> tiles;
  for (std::size_t m = 0; m + 1 < maps.size(); m += 2) {
    std::vector<Pair> pairs;
    for (const auto& [at, r] : maps[m])
      if (const auto other = maps[m + 1].find(at); other != maps[m + 1].end()) pairs.emplace_back(r, other->second);
    if (pairs.size() < fewest_tiles * fewest_pixels) continue;
    const Eigen::VectorXd z_um = differences(pairs) / std::sqrt(2.0);
    for (std::size_t i = 0; i < pairs.size(); ++i) add(tiles, m, *pairs[i].first, z_um[static_cast<Eigen::Index>(i)]);
  }
  std::vector<Tile> result;
  for (auto& [at, tile] : tiles) result.push_back(std::move(tile));
  return result;
}

std::vector<Tile> within_maps(const Sent& sent, const Readings& readings) {
  std::map<std::tuple<std::size_t, int, int>, Tile> tiles;
  for (const Reading& r : readings.rows)
    if (is_even_about(sent, r)) add(tiles, r.map, r, r.z_um - r.height_um);
  std::vector<Tile> result;
  for (auto& [at, tile] : tiles) result.push_back(std::move(tile));
  return result;
}

void keep_enough(std::vector<Tile>& tiles) {
  std::erase_if(tiles, [](const Tile& t) { return t.size() < fewest_pixels; });
  if (tiles.size() <= most_tiles) return;
  std::vector<Tile> some;  // evenly
  for (std::size_t k = 0; k < most_tiles; ++k) some.push_back(std::move(tiles[k * tiles.size() / most_tiles]));
  tiles = std::move(some);
}

constexpr Eigen::Index of_a_plane = 3;

// Of one length: eigenvalues of the correlation without planes, and the squared heights along their vectors.
struct Spectrum {
  std::vector<double> eigenvalue, squared;
  double planes = 0;  // directions among them that planes take
  double size() const { return static_cast<double>(eigenvalue.size()) - planes; }
};

Spectrum spectrum_of(const std::vector<Tile>& tiles, double length_px) {
  Spectrum s;
  for (const Tile& tile : tiles) {
    const auto n = static_cast<Eigen::Index>(tile.size());
    Eigen::MatrixXd correlation(n, n), plane(n, of_a_plane);
    Eigen::VectorXd z(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Pixel& p = tile[static_cast<std::size_t>(i)];
      plane.row(i) << 1, p.x - tile[0].x, p.y - tile[0].y;
      z[i] = p.z_um;
      for (Eigen::Index j = 0; j <= i; ++j) {
        const Pixel& q = tile[static_cast<std::size_t>(j)];
        correlation(i, j) = correlation(j, i) =
            equation::print_ground_noise(std::hypot(p.x - q.x, p.y - q.y), 1, length_px);
      }
    }
    const Eigen::MatrixXd normal = plane.transpose() * plane;
    const auto freed = [&](const Eigen::MatrixXd& of) {
      return Eigen::MatrixXd(of - plane * linear::Ldlt(normal).solve(Eigen::MatrixXd(plane.transpose() * of)));
    };
    const Eigen::MatrixXd once = freed(correlation), both = freed(once.transpose());
    const linear::EigenPairs pairs = linear::eigen_of(Eigen::MatrixXd(0.5 * (both + both.transpose())));
    const Eigen::VectorXd along = pairs.vectors.transpose() * freed(z).col(0);
    for (Eigen::Index k = 0; k < n; ++k)
      s.eigenvalue.push_back(std::max(0.0, pairs.values[k])), s.squared.push_back(along[k] * along[k]);
    s.planes += of_a_plane;
  }
  return s;
}

// Twice the logarithm of the restricted likelihood, but for a constant.
double likelihood(const Spectrum& s, double noise_2, double rms_2) {
  double sum = s.planes * std::log(noise_2);
  for (std::size_t k = 0; k < s.eigenvalue.size(); ++k) {
    const double v = noise_2 + rms_2 * s.eigenvalue[k];
    sum -= std::log(v) + s.squared[k] / v;
  }
  return sum;
}

struct Best {
  double noise_2 = 0, rms_2 = 0, twice = -1e300, length_px = 0;
};

// The likeliest noise for a ratio of variances is known; the ratio is searched, on its logarithm.
Best best_of(const Spectrum& s, double length_px) {
  const auto at = [&](double log_ratio) {
    const double ratio = std::exp(log_ratio);
    double sum = 0;
    for (std::size_t k = 0; k < s.eigenvalue.size(); ++k) sum += s.squared[k] / (1 + ratio * s.eigenvalue[k]);
    const double noise_2 = std::max(1e-300, sum / s.size());
    return Best{noise_2, ratio * noise_2, likelihood(s, noise_2, ratio * noise_2), length_px};
  };
  constexpr double golden = 0.6180339887498949;
  double low = std::log(1e-4), high = std::log(1e4);
  Best a = at(high - golden * (high - low)), b = at(low + golden * (high - low));
  while (high - low > 1e-4) {
    if (a.twice > b.twice)
      high = low + golden * (high - low), b = a, a = at(high - golden * (high - low));
    else
      low = high - golden * (high - low), a = b, b = at(low + golden * (high - low));
  }
  return a.twice > b.twice ? a : b;
}

double length_of(double k) {  // evenly on a logarithmic scale
  return shortest_px * std::pow(longest_px / shortest_px, k / (lengths - 1));
}

// Standard deviations of log rms and log length, by the curvature of the likelihood in these and log noise.
std::pair<double, double> sigmas_of(const std::vector<Tile>& tiles, const Best& best) {
  constexpr double step = 0.03;
  const std::array<Spectrum, 3> at{spectrum_of(tiles, best.length_px * std::exp(-step)),
                                   spectrum_of(tiles, best.length_px),
                                   spectrum_of(tiles, best.length_px * std::exp(step))};
  const auto value = [&](const std::array<int, 3>& moved) {  // noise, rms, length
    return likelihood(at[static_cast<std::size_t>(1 + moved[2])], best.noise_2 * std::exp(2 * step * moved[0]),
                      best.rms_2 * std::exp(2 * step * moved[1]));
  };
  Eigen::Matrix3d information;
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b <= a; ++b) {
      const auto both = [&](int of_a, int of_b) {
        std::array<int, 3> moved{};
        moved[a] += of_a, moved[b] += of_b;
        return value(moved);
      };
      const double second = a == b ? both(1, 0) - 2 * value({}) + both(-1, 0)
                                   : (both(1, 1) - both(1, -1) - both(-1, 1) + both(-1, -1)) / 4;
      information(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) =
          information(static_cast<Eigen::Index>(b), static_cast<Eigen::Index>(a)) = -0.5 * second / (step * step);
    }
  const Eigen::Matrix3d covariance = linear::inverse(information);
  return {std::sqrt(std::max(0.0, covariance(1, 1))), std::sqrt(std::max(0.0, covariance(2, 2)))};
}

}  // namespace

std::optional<Ground> ground_of(const Sent& sent, const Readings& readings, double resolution_px) {
  const double layer_um = 1e6 * sent.printer.layer_m;
  std::vector<Tile> tiles = between_maps(readings, layer_um);
  keep_enough(tiles);
  Ground ground;
  ground.between_maps = tiles.size() >= fewest_tiles;
  if (!ground.between_maps) {
    tiles = within_maps(sent, readings);
    keep_enough(tiles);
  }
  if (tiles.size() < fewest_tiles) return std::nullopt;
  ground.tiles = tiles.size();
  Best best;
  double place = 0;
  for (int k = 0; k < lengths; ++k)
    if (const Best b = best_of(spectrum_of(tiles, length_of(k)), length_of(k)); b.twice > best.twice)
      best = b, place = k;
  for (double step = 0.5; step > 0.02; step /= 2)  // between the lengths
    for (const double beside : {place - step, place + step}) {
      if (beside < 0 || beside > lengths - 1) continue;
      if (const Best b = best_of(spectrum_of(tiles, length_of(beside)), length_of(beside)); b.twice > best.twice)
        best = b, place = beside;
    }
  const Spectrum none = spectrum_of(tiles, best.length_px);
  double sum = 0;
  for (const double squared : none.squared) sum += squared;
  const double ratio = best.twice - likelihood(none, std::max(1e-300, sum / none.size()), 0);
  ground.p = std::min(1.0, lengths * 0.5 * stats::chi2_upper(std::max(0.0, ratio), 1));
  // A pixel's mean and the instrument blur what is there: its covariance has been spread by twice their variance.
  const double spread = 1.0 / 6 + 2 * resolution_px * resolution_px, seen = best.length_px * best.length_px;
  const double length_2 = std::max(seen - spread, 0.25 * seen);
  ground.length_px = std::sqrt(length_2);
  ground.seen_rms_um = std::sqrt(best.rms_2), ground.noise_um = std::sqrt(best.noise_2);
  ground.rms_um = std::sqrt(best.rms_2 * seen / length_2);
  std::tie(ground.log_rms_sigma, ground.log_length_sigma) = sigmas_of(tiles, best);
  ground.log_length_sigma *= seen / length_2;
  return ground;
}

}  // namespace gonio::explain::prints

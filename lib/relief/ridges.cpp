// See ridges.h.
#include "relief/ridges.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/random.h"

namespace gonio::relief {
namespace {

[[noreturn]] void refuse(const std::string& problem, const std::string& remedy) {
  throw Error(Exit::usage, "ridges", problem, remedy);
}

struct Burr {
  int ridge;
  double x, height;
};

std::vector<Burr> thrown(const RidgeShape& s, double length) {
  std::vector<Burr> burrs;
  if (!(s.burr_share > 0)) return burrs;
  const double density = -std::log1p(-s.burr_share) / s.burr_length_m;
  for (int ridge = 0; ridge < s.ridges; ++ridge) {
    Random random(s.seed, static_cast<std::uint64_t>(ridge));
    for (double x = -std::log(random.uniform()) / density; x < length; x -= std::log(random.uniform()) / density)
      burrs.push_back({ridge, x, s.burr_height_m * random.uniform(0.5, 1.5)});
  }
  return burrs;
}

int points(double length, double finest, int given) {
  return given > 0 ? std::max(2, given) : std::clamp(static_cast<int>(std::ceil(length / finest)), 16, 4096);
}

double bump(double t) {
  return std::abs(t) < 1 ? (1 - t * t) * (1 - t * t) : 0;
}

}  // namespace

void check_ridges(const RidgeShape& s) {
  if (!(s.ridge_rad > 0 && s.ridge_rad <= pi / 4 + 1e-12))
    refuse("the ridge angle is " + std::to_string(s.ridge_rad * 180 / pi) + " degrees",
           "facets are the longer flanks: above 0, at most 45 degrees");
  if (!(s.pitch_m > 0 && std::isfinite(s.pitch_m))) refuse("the pitch is no length", "state it");
  const double wall = s.pitch_m * std::sin(s.ridge_rad);
  if (!(s.crest_radius_m >= 0 && s.trough_radius_m >= 0 && s.crest_radius_m + s.trough_radius_m <= wall))
    refuse("the edges' radii add up to more than the walls, " + std::to_string(wall * 1e6) + " um",
           "round them less, or make the pitch longer");
  if (!(s.burr_share >= 0 && s.burr_share < 1)) refuse("the share of burrs is not in [0, 1)", "state a share");
  if (s.burr_share > 0 && !(s.burr_height_m > 0 && s.burr_width_m > 0 && s.burr_length_m > 0))
    refuse("burrs have no height, width or length", "state all three");
  if (s.burr_share > 0 && s.burr_width_m > s.pitch_m) refuse("burrs are wider than the pitch", "make them smaller");
  if (s.ridges < 1 || s.length_m < 0) refuse("there is no ridge in the period", "one at least");
}

double ridge_profile_m(const RidgeShape& s, double y_m) {
  const double c = std::cos(s.ridge_rad), n = std::sin(s.ridge_rad), period = s.pitch_m;
  const double facet = period * c * c, depth = period * c * n;
  // From the crest: y in [facet - period, facet).
  double y = y_m - period * std::floor(y_m / period);
  if (y >= facet) y -= period;
  const double sharp = y < 0 ? y * c / n : -y * n / c;
  // Crest: the circle's centre lies r along either flank, (c, -n) and (-n, -c).
  const double r = s.crest_radius_m;
  if (y < r * c && y > -r * n) {
    const double from = y - r * (c - n);
    return -r * (n + c) + std::sqrt(std::max(0.0, r * r - from * from));
  }
  // Trough at (facet, -depth) and, a period before, at (facet - period, -depth).
  const double q = s.trough_radius_m, left = y - facet, right = y - (facet - period);
  const double off = left > -q * c ? left : right < q * n ? right : INFINITY;
  if (std::isfinite(off)) {
    const double from = off - q * (n - c);
    return -depth + q * (n + c) - std::sqrt(std::max(0.0, q * q - from * from));
  }
  return sharp;
}

Relief ridges(const RidgeShape& s, const RidgeSampling& sampling) {
  check_ridges(s);
  const double n = std::sin(s.ridge_rad);
  double finest = s.pitch_m * n * n / 6;
  for (const double r : {s.crest_radius_m, s.trough_radius_m})
    if (r > 0) finest = std::min(finest, r / 6);
  if (s.burr_share > 0) finest = std::min(finest, s.burr_width_m / 12);
  const int across = points(s.pitch_m, finest, sampling.across);
  const double length = s.length_m > 0 ? s.length_m : s.burr_share > 0 ? 32 * s.burr_length_m : s.pitch_m;
  const int along = s.burr_share > 0 ? points(length, s.burr_length_m / 12, sampling.along) : 2;
  const double step_x = length / along, step_y = s.pitch_m / across;
  const int ny = across * s.ridges;
  std::vector<double> z(static_cast<std::size_t>(along) * static_cast<std::size_t>(ny)), burr(z.size());
  const auto at = [&](int i, int j) {
    return static_cast<std::size_t>((j + ny) % ny) * static_cast<std::size_t>(along) +
           static_cast<std::size_t>((i % along + along) % along);
  };
  for (const Burr& b : thrown(s, length)) {
    const int reach_x = std::min(static_cast<int>(0.5 * s.burr_length_m / step_x) + 1, (along - 1) / 2),
              reach_y = static_cast<int>(0.5 * s.burr_width_m / step_y) + 1, middle = static_cast<int>(b.x / step_x);
    for (int j = -reach_y; j <= reach_y; ++j)
      for (int i = middle - reach_x; i <= middle + reach_x; ++i) {
        double& most = burr[at(i, b.ridge * across + j)];
        most = std::max(most, b.height * bump((i * step_x - b.x) / (0.5 * s.burr_length_m)) *
                                  bump(j * step_y / (0.5 * s.burr_width_m)));
      }
  }
  for (int j = 0; j < ny; ++j) {
    const double profile = ridge_profile_m(s, (j % across) * step_y);
    for (int i = 0; i < along; ++i) z[at(i, j)] = profile + burr[at(i, j)];
  }
  return {along, ny, step_x, step_y, std::move(z), true, "ridges"};
}

Relief sinusoid(double amplitude_m, double wave_x_m, double wave_y_m, int points_per_wave) {
  const bool x_too = wave_x_m > 0, y_too = wave_y_m > 0;
  if (!x_too && !y_too) throw Error(Exit::usage, "sinusoid", "has no wavelength", "state one along x or y");
  const int nx = x_too ? points_per_wave : 2, ny = y_too ? points_per_wave : 2;
  const double step_x = (x_too ? wave_x_m : wave_y_m) / nx, step_y = (y_too ? wave_y_m : wave_x_m) / ny;
  std::vector<double> z;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i)
      z.push_back(amplitude_m * (x_too ? std::sin(2 * pi * i / nx) : 1) * (y_too ? std::sin(2 * pi * j / ny) : 1));
  return {nx, ny, step_x, step_y, std::move(z), true, "sinusoid"};
}

}  // namespace gonio::relief

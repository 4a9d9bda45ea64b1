// surface.micro-ridges in tables of reflectance: lobes have many local minima, and a sector of azimuths holds one.
#include <algorithm>
#include <array>
#include <cmath>

#include "explain/tables/reflectance_binding.h"

namespace gonio::mechanism {
const Mechanism& surface_micro_ridges();
}

namespace gonio::explain::tables::reflectance {
namespace {

constexpr std::size_t ridge_sectors = 4;
constexpr double overlap = 1.5;  // of sectors: no azimuth lies at the limit of all that hold it

// Only a sample that was rotated shows what is its own direction and what is the instrument's.
bool shows_directions(const ReflectanceRows& rows, const SurfacePlaces& places) {
  if (!places.ridges()) return false;
  std::array<std::size_t, ridge_sectors> seen{};
  for (const Vec3& w : rows.wi) {
    if (std::hypot(w.x, w.y) < 0.05) continue;
    const double turns = std::atan2(w.y, w.x) / pi;
    ++seen[static_cast<std::size_t>(std::floor((turns - std::floor(turns)) * ridge_sectors + 0.5)) % ridge_sectors];
  }
  return std::count_if(seen.begin(), seen.end(), [&](std::size_t n) { return 50 * n > rows.rows(); }) >= 2;
}

std::vector<std::vector<Parameter>> sectors(const std::vector<Parameter>& declared, bool given) {
  const double half = 0.5 * pi / ridge_sectors;
  std::vector<std::vector<Parameter>> all;
  for (std::size_t k = 0; k < ridge_sectors; ++k) {
    Parameter share = declared[0], tilt = declared[1], azimuth = declared[2];
    azimuth.start = azimuth.neutral = 2 * half * static_cast<double>(k);
    azimuth.lower = azimuth.start - overlap * half, azimuth.upper = azimuth.start + overlap * half;
    azimuth.size = 0.1, tilt.size = 0.05, tilt.neutral = tilt.start;
    if (given) {
      azimuth.lower = -half, azimuth.upper = pi - half;
      return {{share, tilt, azimuth}};
    }
    all.push_back({share, tilt, azimuth});
  }
  return all;
}

}  // namespace

const ReflectanceBinding& surface_micro_ridges() {
  static const ReflectanceBinding binding{.mechanism = mechanism::surface_micro_ridges,
                                          .order = 90,
                                          .kind = ReflectanceSlot::Kind::ridges,
                                          .shows = shows_directions,
                                          .ranges = sectors};
  return binding;
}

}  // namespace gonio::explain::tables::reflectance

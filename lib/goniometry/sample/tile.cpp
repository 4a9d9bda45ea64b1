// Scales of lights (goniometry/sample/tile.h).
#include "goniometry/sample/tile.h"

#include <algorithm>
#include <cmath>

namespace gonio::goniometry {
namespace {

Rgb per_band(const auto& of) {
  return {of(0), of(1), of(2)};
}

TileScale mean_of(const std::vector<const TileReading*>& readings) {
  TileScale result;
  double widest = 1;
  const auto weight = [](const TileReading& r, int band) { return 1 / (r.sigma[band] * r.sigma[band]); };
  const Rgb total = per_band([&](int b) {
    double sum = 0;
    for (const TileReading* r : readings) sum += weight(*r, b);
    return sum;
  });
  result.value = per_band([&](int b) {
    double sum = 0;
    for (const TileReading* r : readings) sum += weight(*r, b) * r->scale[b];
    return sum / total[b];
  });
  const double degrees = static_cast<double>(readings.size()) - 1;
  for (int b = 0; b < 3 && degrees > 0; ++b) {
    double chi2 = 0;
    for (const TileReading* r : readings) {
      const double off = r->scale[b] - result.value[b];
      chi2 += off * off * weight(*r, b);
    }
    widest = std::max(widest, chi2 / degrees);
  }
  // Birge's ratio counts where chance would pass it in less than 1 of 1000.
  if (degrees > 0 && widest < 1 + 3.09 * std::sqrt(2 / degrees)) widest = 1;
  result.sigma = per_band([&](int b) { return std::sqrt(widest / total[b]); });
  for (const TileReading* r : readings) result.views.push_back(r->view);
  return result;
}

TileScale between(const TileReading& before, const TileReading& after, double time_s) {
  const double span = *after.time_s - *before.time_s, t = span > 0 ? (time_s - *before.time_s) / span : 0.5;
  TileScale result;
  result.value = before.scale * (1 - t) + after.scale * t;
  result.sigma = per_band([&](int b) { return std::hypot((1 - t) * before.sigma[b], t * after.sigma[b]); });
  result.views = {before.view, after.view};
  return result;
}

}  // namespace

std::optional<TileScale> Scales::at(std::size_t view, std::size_t light, std::optional<double> time_s) const {
  std::vector<const TileReading*> same;
  for (const TileReading& reading : readings_) {
    if (reading.light != light) continue;
    if (reading.view == view) return TileScale{reading.scale, reading.sigma, {view}};
    same.push_back(&reading);
  }
  if (same.empty()) return std::nullopt;
  const bool timed = time_s && std::ranges::all_of(same, [](const TileReading* r) { return r->time_s.has_value(); });
  if (timed && same.size() > 1) {
    std::ranges::sort(same, {}, [](const TileReading* r) { return *r->time_s; });
    const auto after = std::ranges::lower_bound(same, *time_s, {}, [](const TileReading* r) { return *r->time_s; });
    if (after != same.begin() && after != same.end()) return between(**(after - 1), **after, *time_s);
  }
  return mean_of(same);
}

std::optional<Scales::Wander> Scales::wander(std::size_t light) const {
  std::vector<const TileReading*> same;
  for (const TileReading& reading : readings_)
    if (reading.light == light) same.push_back(&reading);
  if (same.size() < 2) return std::nullopt;
  const auto count = static_cast<double>(same.size());
  Rgb middle, squares, expected;
  for (const TileReading* r : same) middle += r->scale / count;
  for (const TileReading* r : same) {
    const Rgb off = r->scale - middle;
    squares += off * off / (count - 1);
    expected += r->sigma * r->sigma / count;
  }
  Wander result;
  for (int b = 0; b < 3; ++b)
    if (const double relative = std::sqrt(squares[b]) / std::abs(middle[b]); relative >= result.relative)
      result = {relative, std::sqrt(expected[b]) / std::abs(middle[b])};
  return result;
}

}  // namespace gonio::goniometry

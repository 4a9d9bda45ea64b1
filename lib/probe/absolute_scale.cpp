// See absolute_scale.h.
#include "probe/absolute_scale.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/text.h"
#include "probe/projection.h"
#include "probe/remap.h"
#include "stats/intervals.h"

namespace gonio::probe {
namespace {

constexpr std::size_t fewest_pixels = 16;
// What unwrapping itself is off by, relative: in simulated round trips up to 0.1 % with balls of 110 px radius and 1.4
// % with 56 px.
constexpr double unwrapping = 0.01;
constexpr double most_unseen = 0.5;  // of the light on the tile

double sum(Rgb v) {
  return v.x + v.y + v.z;
}
Rgb texel(const io::Image& picture, std::size_t i) {
  return {picture.data[3 * i], picture.data[3 * i + 1], picture.data[3 * i + 2]};
}
double share(const Unwrapped& map, std::size_t i) {
  return double{map.weight.data[2 * i]};
}

struct Shown {
  Rgb radiance{};
  double relative_error = 0;
};
// Mean over the tile's area. Its error: blocks of four by four pixels, so that neighbours may have theirs in common.
Shown shown_by(const Tile& tile, const ReferenceView& view) {
  const std::string what = "the tile \"" + tile.name + "\"";
  const auto seen = footprint(tile.patch, view.camera, inverse(view.world_from_camera) * tile.world_from_tile);
  if (!seen.refusal.empty() || seen.pixels.empty())
    throw Error(Exit::data, view.place,
                what + " is not to be seen: " + (seen.refusal.empty() ? "no pixel lies wholly on it" : seen.refusal),
                "name a photograph that shows it");
  std::size_t clipped = 0, masked = 0, used = 0;
  double area = 0;
  Rgb total{};
  std::map<std::pair<int, int>, std::pair<double, double>> blocks;
  const std::size_t channels = view.picture.channels.size();
  for (const goniometry::PatchPixel& p : seen.pixels) {
    const auto i =
        static_cast<std::size_t>(p.y) * static_cast<std::size_t>(view.picture.width) + static_cast<std::size_t>(p.x);
    if (!view.counts.empty() && view.counts[i] == 0) {
      ++masked;
      continue;
    }
    if (!view.clipped.empty() && view.clipped[i] != 0) ++clipped;
    const float* v = &view.picture.data[i * channels];
    const Rgb light = channels >= 3 ? Rgb{v[0], v[1], v[2]} : Rgb{v[0], v[0], v[0]};
    ++used, area += p.area_m2, total += light * p.area_m2;
    auto& [light_in, area_in] = blocks[{p.x / 4, p.y / 4}];
    light_in += sum(light) * p.area_m2, area_in += p.area_m2;
  }
  if (clipped > 0)
    throw Error(Exit::data, view.place, what + format(" is saturated in %zu of its %zu pixels", clipped, used),
                "expose it for less time");
  if (used < fewest_pixels)
    throw Error(Exit::data, view.place,
                what + format(" has %zu pixels that count (limit %zu; %zu are masked)", used, fewest_pixels, masked),
                "come nearer, or mend the mask");
  const Rgb radiance = total / area;
  if (!(sum(radiance) > 0)) throw Error(Exit::data, view.place, what + " is dark", "light it as the ball was lit");
  double squares = 0;
  for (const auto& [at, block] : blocks)
    squares += std::pow((block.first - sum(radiance) * block.second) / (area * sum(radiance)), 2);
  const auto n = static_cast<double>(blocks.size());
  return {radiance, std::sqrt(squares * n / std::max(1.0, n - 1))};
}

}  // namespace

Arriving arriving_at(const Unwrapped& map, const std::vector<Lamp>& lamps, Vec3 unit) {
  const SphereMap sphere{Projection::lat_long, map.radiance.width, map.radiance.height};
  const std::vector<double> sr = solid_angles(sphere);
  Arriving all;
  double unseen = 0, variance = 0;
  for (int y = 0; y < sphere.height; ++y)
    for (int x = 0; x < sphere.width; ++x) {
      const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(sphere.width) + static_cast<std::size_t>(x);
      const double cosine = dot(unit, direction_at(sphere, {x + 0.5, y + 0.5})->unit);
      if (!(cosine > 0)) continue;
      const Rgb light = texel(map.radiance, i) * (cosine * sr[i]);
      all.irradiance += light, unseen += (1 - share(map, i)) * sum(light);
    }
  for (const Lamp& lamp : lamps) {
    const double cosine = std::max(0.0, dot(unit, lamp.towards));
    all.irradiance += lamp.irradiance * cosine, variance += std::pow(cosine * sum(lamp.sigma), 2);
  }
  const double whole = sum(all.irradiance);
  if (!(whole > 0)) return all;
  all.unseen = unseen / whole, all.sigma = std::sqrt(variance + unseen * unseen) / whole;
  return all;
}

Scale scale_by_tile(const Unwrapped& map, const std::vector<Lamp>& lamps, const Tile& tile, const ReferenceView& view) {
  const Shown shown = shown_by(tile, view);
  const Arriving light = arriving_at(map, lamps, tile.world_from_tile.rotate({0, 0, 1}));
  const double expected = sum(tile.reflectance * light.irradiance) / pi;
  if (!(expected > 0))
    throw Error(Exit::data, view.place, "the tile \"" + tile.name + "\" is lit by nothing that the ball shows",
                "turn it to the light, or photograph the ball from other sides");
  if (light.unseen > most_unseen)
    throw Error(Exit::data, view.place,
                format("of the light on the tile \"%s\" no photograph of the ball shows %.0f %% (limit %.0f %%)",
                       tile.name.c_str(), 100 * light.unseen, 100 * most_unseen),
                "photograph the ball from other sides");
  const double value = sum(shown.radiance) / expected;
  return {value, value * std::hypot(std::hypot(shown.relative_error, light.sigma),
                                    std::hypot(tile.relative_sigma, unwrapping))};
}

Scale scale_by_ball(const Unwrapped& map, const Unwrapped& reference, const std::string& place) {
  const SphereMap sphere{Projection::lat_long, map.radiance.width, map.radiance.height};
  const std::vector<double> sr = solid_angles(sphere);
  constexpr std::size_t columns = 4, rows = 3;
  std::vector<double> known(columns * rows), seen(columns * rows);
  for (std::size_t i = 0; i < sr.size(); ++i) {
    const double w = sr[i] * std::floor(share(map, i)) * std::floor(share(reference, i));  // shown whole by both
    const std::size_t row = i / static_cast<std::size_t>(sphere.width),
                      column = i % static_cast<std::size_t>(sphere.width);
    const std::size_t part = row * rows / static_cast<std::size_t>(sphere.height) * columns +
                             column * columns / static_cast<std::size_t>(sphere.width);
    known[part] += w * sum(texel(map.radiance, i)), seen[part] += w * sum(texel(reference.radiance, i));
  }
  double all = 0, lit = 0, squares = 0, parts = 0;
  for (std::size_t k = 0; k < known.size(); ++k) all += known[k], lit += seen[k], parts += known[k] > 0 ? 1 : 0;
  if (!(lit > 0) || parts < 3)
    throw Error(Exit::data, place, "and the photographs of the ball show too little in common",
                "name a photograph of the same ball under the same light");
  const double value = lit / all;
  for (std::size_t k = 0; k < known.size(); ++k) squares += std::pow((seen[k] - value * known[k]) / all, 2);
  return {value, std::sqrt(squares * parts / (parts - 1))};
}

}  // namespace gonio::probe

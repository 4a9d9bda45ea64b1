// See map_readings.h.
#include "explain/prints/map_readings.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "base/error.h"
#include "base/text.h"
#include "explain/prints/sight.h"
#include "stats/intervals.h"

namespace gonio::explain::prints {
namespace {

constexpr double um = 1e6, fewest_points = 2.0 / 3, wall_place_px = 0.02, usual_resolution_cells = 0.4, even = 0.02;
constexpr std::size_t fewest_readings = 400, fewest_triples = 30;
constexpr int patches = 4, tile_px = 4;
constexpr double stands_out = 6;  // of the points of one pixel

struct Pile {
  std::vector<double> z, x, y;
};

// Points that stand out of those of their pixel are none of its surface.
void drop_spikes(Pile& pile) {
  if (pile.z.size() < 5) return;
  const double middle = stats::median(pile.z);
  std::vector<double> away;
  for (const double z : pile.z) away.push_back(std::abs(z - middle));
  const double limit = stands_out * 1.4826 * stats::median(away);
  Pile kept;
  for (std::size_t i = 0; i < pile.z.size(); ++i)
    if (!(std::abs(pile.z[i] - middle) > limit) || !(limit > 0))
      kept.z.push_back(pile.z[i]), kept.x.push_back(pile.x[i]), kept.y.push_back(pile.y[i]);
  pile = std::move(kept);
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

void gather(const PrintsInput& input, std::size_t which, Readings& readings) {
  const PrintedMap& map = input.maps[which];
  const Sent& sent = input.sent;
  const Vec2 pixel = sent.printer.pixel_m;
  std::map<std::pair<int, int>, Pile> piles;
  std::map<std::pair<int, int>, std::size_t> points;
  for (std::size_t row = 0; row < map.map.height; ++row)
    for (std::size_t column = 0; column < map.map.width; ++column) {
      const Vec2 p = map.at(column, row);
      const std::pair<int, int> at{static_cast<int>(std::floor((p.y - sent.corner_m.y) / pixel.y)),
                                   static_cast<int>(std::floor((p.x - sent.corner_m.x) / pixel.x))};
      if (at.first < 0 || at.second < 0 || at.first >= sent.high() || at.second >= sent.wide()) continue;
      ++points[at];
      const double z = map.map.at(column, row);
      if (!std::isfinite(z)) continue;
      Pile& pile = piles[at];
      pile.z.push_back(z), pile.x.push_back(p.x), pile.y.push_back(p.y);
    }
  const double whole = pixel.x * pixel.y / (map.map.step_x_m * map.map.step_y_m);
  for (auto& [at, pile] : piles) {
    if (static_cast<double>(points.at(at)) < fewest_points * whole) continue;  // the map's rim
    drop_spikes(pile);
    if (static_cast<double>(pile.z.size()) < fewest_points * std::max(1.0, std::floor(whole))) {
      ++readings.without_points;
      continue;
    }
    const auto first = static_cast<std::uint32_t>(readings.points.size());
    for (std::size_t i = 0; i < pile.z.size(); ++i) readings.points.push_back({pile.x[i], pile.y[i]});
    readings.rows.push_back({.map = which,
                             .at_m = {mean(pile.x), mean(pile.y)},
                             .first = first,
                             .points = static_cast<std::uint32_t>(pile.z.size()),
                             .x_px = at.second,
                             .y_px = at.first,
                             .z_um = um * mean(pile.z)});
  }
}

void look_up(const Sent& sent, const Field& field, Readings& readings) {
  const Seen top(field, Vec2{1, 1} * cells_per_pixel, usual_resolution_cells);  // means over pixels
  std::vector<double> bottoms{0};
  for (std::size_t k = 0; k < sent.layers.size(); ++k) bottoms.push_back(bottoms.back() + sent.printer.thickness_m(k));
  std::erase_if(readings.rows, [&](Reading& r) {
    const double x = (r.at_m.x - sent.corner_m.x) / field.cell_m.x, y = (r.at_m.y - sent.corner_m.y) / field.cell_m.y;
    constexpr double c = cells_per_pixel;
    const double here = top.at(x, y), left = top.at(x - c, y), right = top.at(x + c, y), down = top.at(x, y - c),
                 up = top.at(x, y + c);
    const auto cell = [&](int dx, int dy) {
      const int i = r.x_px * cells_per_pixel + dx, j = r.y_px * cells_per_pixel + dy;
      return static_cast<std::size_t>(j) * static_cast<std::size_t>(field.width) + static_cast<std::size_t>(i);
    };
    const double ceiling = field.ceiling_m[cell(0, 0)];
    if (!(ceiling > 0)) return true;  // nothing was printed there
    r.slope_x = um * (right - left) / 2, r.slope_y = um * (up - down) / 2;
    r.bend = um * (left + right + up + down - 4 * here);
    r.height_um = um * here, r.below_top_um = um * (ceiling - here);
    const auto layer = std::ranges::lower_bound(bottoms, ceiling - 1e-3 * sent.printer.layer_m);
    r.layer = static_cast<int>(layer - bottoms.begin());
    const std::size_t pixel =
        static_cast<std::size_t>(r.y_px) * static_cast<std::size_t>(sent.wide()) + static_cast<std::size_t>(r.x_px);
    r.grey = static_cast<double>(sent.layers[static_cast<std::size_t>(r.layer - 1)][pixel]);
    return false;
  });
}

// Second differences of three neighbours that the simulation has level: noise alone, from pixel to pixel.
double noise_of(const Readings& readings, double layer_um) {
  std::map<std::tuple<std::size_t, int, int>, const Reading*> at;
  for (const Reading& r : readings.rows) at[{r.map, r.x_px, r.y_px}] = &r;
  std::vector<double> level, all;
  for (const Reading& r : readings.rows)
    for (const auto& [dx, dy] : {std::pair{1, 0}, std::pair{0, 1}}) {
      const auto before = at.find({r.map, r.x_px - dx, r.y_px - dy}),
                 after = at.find({r.map, r.x_px + dx, r.y_px + dy});
      if (before == at.end() || after == at.end()) continue;
      const Reading &a = *before->second, &b = *after->second;
      const double d =
          std::abs((a.z_um - a.height_um) - 2 * (r.z_um - r.height_um) + (b.z_um - b.height_um)) / std::sqrt(6.0);
      all.push_back(d);
      const auto is_level = [&](const Reading& q) {
        return std::max({std::abs(q.slope_x), std::abs(q.slope_y), std::abs(q.bend)}) < even * layer_um;
      };
      if (is_level(a) && is_level(r) && is_level(b)) level.push_back(d);
    }
  const std::vector<double>& of = level.size() >= fewest_triples ? level : all;
  return of.empty() ? 0 : 1.4826 * stats::median(of);
}

// Patches and tiles of `tile` x `tile` pixels, and the order of readings that they give.
void divide(int tile, Readings& readings) {
  std::size_t maps = 0;
  for (const Reading& r : readings.rows) maps = std::max(maps, r.map + 1);
  for (std::size_t m = 0; m < maps; ++m) {
    int x0 = 1 << 30, y0 = 1 << 30, x1 = 0, y1 = 0;
    for (const Reading& r : readings.rows)
      if (r.map == m)
        x0 = std::min(x0, r.x_px), y0 = std::min(y0, r.y_px), x1 = std::max(x1, r.x_px), y1 = std::max(y1, r.y_px);
    for (Reading& r : readings.rows) {
      if (r.map != m) continue;
      const int px = (r.x_px - x0) * patches / (x1 - x0 + 1), py = (r.y_px - y0) * patches / (y1 - y0 + 1);
      r.patch = static_cast<std::uint32_t>(py * patches + px);
      r.tile = static_cast<std::uint32_t>((r.y_px - y0) / tile * 4096 + (r.x_px - x0) / tile);
    }
  }
  std::ranges::stable_sort(readings.rows, {}, [](const Reading& r) { return std::tuple(r.map, r.patch, r.tile); });
}

}  // namespace

Readings readings_of(const PrintsInput& input) {
  Readings readings;
  for (std::size_t m = 0; m < input.maps.size(); ++m) gather(input, m, readings);
  look_up(input.sent, printed_field(input.sent, stated(input.sent)), readings);
  if (readings.rows.size() < fewest_readings)
    throw Error(Exit::data, input.maps.front().place,
                format("shows %zu pixels of the print, and explain needs 400", readings.rows.size()),
                "measure a larger field, with several points for each pixel");
  const double layer_um = um * input.sent.printer.layer_m;
  readings.noise_um = std::max(noise_of(readings, layer_um), 1e-4 * layer_um);
  for (Reading& r : readings.rows)
    r.sigma_um = std::hypot(readings.noise_um, wall_place_px * std::hypot(r.slope_x, r.slope_y),
                            wall_place_px * 0.5 * std::abs(r.bend));
  divide(tile_px, readings);
  return readings;
}

void add_noise(double rms_um, int tile, Readings& readings) {
  for (Reading& r : readings.rows) r.sigma_um = std::hypot(r.sigma_um, rms_um);
  divide(std::max(tile, tile_px), readings);
}

}  // namespace gonio::explain::prints

// See remap.h. Overlaps are a sparse matrix by rows: one row for each new pixel.
#include "probe/remap.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "base/parallel.h"
#include "stats/intervals.h"

namespace gonio::probe {
namespace {

struct Overlap {
  std::uint32_t from;
  float sr;
};
using Rows = std::vector<std::vector<Overlap>>;

std::size_t pixel_of(const SphereMap& map, Vec3 direction) {
  const Vec2 at = place_of(map, direction);
  const auto within = [](double v, int count) { return std::clamp(static_cast<int>(std::floor(v)), 0, count - 1); };
  return static_cast<std::size_t>(within(at.y, map.height)) * static_cast<std::size_t>(map.width) +
         static_cast<std::size_t>(within(at.x, map.width));
}

// Samples a side of one new pixel: three to the smaller of the two pixels there.
int samples_of(double new_sr, double old_sr) {
  constexpr double most = 48;
  return static_cast<int>(std::clamp(std::ceil(3 * std::sqrt(new_sr / std::max(old_sr, 1e-12))), 4.0, most));
}

// Where a pixel of `from` that has a little solid angle, a sliver at a rim, lies in the other picture.
std::optional<std::size_t> place_of_sliver(const SphereMap& from, const SphereMap& to, std::size_t pixel) {
  constexpr int fine = 16;
  const int x = static_cast<int>(pixel) % from.width, y = static_cast<int>(pixel) / from.width;
  for (int j = 0; j < fine; ++j)
    for (int i = 0; i < fine; ++i)
      if (const auto d = direction_at(from, {x + (i + 0.5) / fine, y + (j + 0.5) / fine})) return pixel_of(to, d->unit);
  return {};
}

std::vector<Overlap> overlaps_of(const SphereMap& from, const SphereMap& to, int x, int y) {
  std::vector<Overlap> found;
  const auto middle = direction_at(to, {x + 0.5, y + 0.5});
  double old_sr = HUGE_VAL;
  if (middle)
    if (const auto old = direction_at(from, place_of(from, middle->unit))) old_sr = old->sr_per_px;
  const int n = samples_of(middle ? middle->sr_per_px : 0, std::isfinite(old_sr) ? old_sr : 1);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const auto d = direction_at(to, {x + (i + 0.5) / n, y + (j + 0.5) / n});
      if (!d) continue;
      const auto pixel = static_cast<std::uint32_t>(pixel_of(from, d->unit));
      const auto sr = static_cast<float>(d->sr_per_px / (n * n));
      const auto at = std::ranges::find(found, pixel, &Overlap::from);
      if (at != found.end())
        at->sr += sr;
      else
        found.push_back({pixel, sr});
    }
  if (found.empty())
    if (const auto old = place_of_sliver(
            to, from, static_cast<std::size_t>(y) * static_cast<std::size_t>(to.width) + static_cast<std::size_t>(x)))
      found.push_back({static_cast<std::uint32_t>(*old), 1});
  return found;
}

// Rows made to sum to the new pixels' solid angles; returns what the old pixels then have.
std::vector<double> normalise(Rows& rows, const std::vector<double>& target, std::size_t old_pixels) {
  std::vector<double> counted(old_pixels);
  for (std::size_t t = 0; t < rows.size(); ++t) {
    double sum = 0;
    for (const Overlap& o : rows[t]) sum += double{o.sr};
    for (Overlap& o : rows[t]) {
      o.sr = static_cast<float>(double{o.sr} * target[t] / sum);
      counted[o.from] += double{o.sr};
    }
  }
  return counted;
}

// One channel: means, then the light of bright pixels set right.
class Channel {
 public:
  Channel(const io::Image& picture, std::size_t channel) : picture_(picture), channel_(channel) {
    std::vector<double> all;
    for (std::size_t i = 0; i < picture.pixels(); ++i) all.push_back(radiance(i));
    level_ = stats::median(all);
  }
  double radiance(std::size_t pixel) const {
    return double{picture_.data[pixel * picture_.channels.size() + channel_]};
  }
  double above(std::size_t pixel) const { return std::max(0.0, radiance(pixel) - level_); }

 private:
  const io::Image& picture_;
  std::size_t channel_;
  double level_ = 0;
};

}  // namespace

std::vector<double> solid_angles(const SphereMap& map) {
  std::vector<double> sr(static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height));
  const bool smooth = map.projection == Projection::lat_long;
  constexpr int fine = 16;
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      double& sum = sr[static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width) + static_cast<std::size_t>(x)];
      if (smooth) {
        sum = 2 * pi / map.width * (std::cos(pi * y / map.height) - std::cos(pi * (y + 1) / map.height));
        continue;
      }
      for (int j = 0; j < fine; ++j)
        for (int i = 0; i < fine; ++i)
          if (const auto d = direction_at(map, {x + (i + 0.5) / fine, y + (j + 0.5) / fine}))
            sum += d->sr_per_px / (fine * fine);
    }
  const double all = std::accumulate(sr.begin(), sr.end(), 0.0);
  for (double& s : sr) s *= 4 * pi / all;
  return sr;
}

io::Image remapped(const io::Image& picture, const SphereMap& from, const SphereMap& to) {
  const std::vector<double> source = solid_angles(from), target = solid_angles(to);
  Rows rows(target.size());
  parallel_for(0, static_cast<std::size_t>(to.height), [&](std::size_t y) {
    for (int x = 0; x < to.width; ++x)
      rows[y * static_cast<std::size_t>(to.width) + static_cast<std::size_t>(x)] =
          overlaps_of(from, to, x, static_cast<int>(y));
  });
  const std::vector<double> counted = normalise(rows, target, source.size());
  std::vector<std::pair<std::size_t, std::size_t>> slivers;  // old pixel, new pixel
  for (std::size_t i = 0; i < source.size(); ++i)
    if (source[i] > 0 && !(counted[i] > 0))
      if (const auto t = place_of_sliver(from, to, i); t && target[*t] > 0) slivers.emplace_back(i, *t);
  io::Image out(to.width, to.height, picture.channels);
  for (std::size_t c = 0; c < picture.channels.size(); ++c) {
    const Channel old(picture, c);
    std::vector<double> light(rows.size());  // radiance times solid angle
    for (std::size_t t = 0; t < rows.size(); ++t)
      for (const Overlap& o : rows[t])
        light[t] += double{o.sr} * (old.radiance(o.from) + (source[o.from] / counted[o.from] - 1) * old.above(o.from));
    for (const auto& [i, t] : slivers) light[t] += source[i] * old.above(i);
    double wanted = 0;
    for (std::size_t i = 0; i < source.size(); ++i) wanted += source[i] * old.radiance(i);
    const double found = std::accumulate(light.begin(), light.end(), 0.0), factor = found != 0 ? wanted / found : 1;
    for (std::size_t t = 0; t < rows.size(); ++t)
      if (target[t] > 0) out.data[t * picture.channels.size() + c] = static_cast<float>(light[t] * factor / target[t]);
  }
  return out;
}

}  // namespace gonio::probe

// See moved.h.
#include "explain/stacks/moved.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "explain/stacks/grid_regions.h"
#include "stats/distributions.h"
#include "stats/intervals.h"

namespace gonio::explain::stacks {
namespace {

constexpr double most_points = 40000, seed_z = 7, member_z = 3.5, most_share = 1.0 / 3, off_place_px = 0.25;
constexpr double clear_of_noise = 8;   // standard deviations: below, logarithms are no longer normal
constexpr double surely_above = 0.25;  // logarithm by which the highest code must lie above what is expected
constexpr double steepest_told = 4;    // a partner whose shoulder hides more than that says nothing
constexpr int core_reach = 2;
constexpr std::size_t least_points = 12, fewest_pictures = 3, most_partners = 4, least_shown = 60, level_bins = 48,
                      joined_bins = 2, least_in_bin = 60;
constexpr double none = std::numeric_limits<double>::quiet_NaN();

struct Grid {
  int stride = 1, width = 0, height = 0;
  int column(std::size_t point) const { return static_cast<int>(point) % width * stride; }  // px
  int row(std::size_t point) const { return static_cast<int>(point) / width * stride; }
  std::size_t size() const { return static_cast<std::size_t>(width * height); }
};

Grid grid_over(const Stack& stack) {
  Grid g;
  const double pixels = static_cast<double>(stack.width()) * stack.height();
  g.stride = stack.step * std::max(1, static_cast<int>(std::ceil(std::sqrt(pixels / most_points) / stack.step)));
  g.width = (stack.width() - 1) / g.stride + 1, g.height = (stack.height() - 1) / g.stride + 1;
  return g;
}

struct Reading {
  double log = none, sigma = 0;  // none: does not count
  bool at_least = false;         // the highest code
  double rounding = 0;           // half a code: neighbours of nearly the same brightness are off alike
};

bool is_told(const Reading& r) {
  return !std::isnan(r.log) && !r.at_least;
}

Reading reading_at(const Stack& stack, const ReadingNoise& noise, std::size_t g, int x, int y, int c) {
  const StackImage& image = stack.images[g];
  const double v = image.picture.at(x, y, c);
  const std::size_t place = image.picture.index(x, y, c);
  if (image.at_least[place / stack.channels.size()] && v >= stack.highest) return {std::log(v), 0, true};
  if (!image.counts[place] || !(v > clear_of_noise * noise.sigma(g, v))) return {};
  double steepest = 0;
  for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
    const int u = x + dx * stack.step, w = y + dy * stack.step;
    if (u < 0 || w < 0 || u >= stack.width() || w >= stack.height()) continue;
    steepest = std::max(steepest, std::abs(image.picture.at(u, w, c) - v) / stack.step);
  }
  return {std::log(v), std::hypot(noise.sigma(g, v), off_place_px * steepest) / v, false, 0.5 * stack.quantum / v};
}

// What one picture reads over what another does: medians over the other's reading, bins of equal counts, each joined
// with its neighbours: an object that is all there is of its level does not set its own.
struct Relation {
  std::vector<double> level, middle, spread, slope;  // slope: of one picture's logarithm over the other's
  double at(const std::vector<double>& of, double l) const {
    if (level.size() < 2) return of.front();
    const auto above = static_cast<std::size_t>(std::ranges::upper_bound(level, l) - level.begin());
    const std::size_t k = std::clamp<std::size_t>(above, 1, level.size() - 1);
    const double t = std::clamp((l - level[k - 1]) / std::max(1e-12, level[k] - level[k - 1]), -1.0, 2.0);
    return (1 - t) * of[k - 1] + t * of[k];
  }
};

std::vector<double> joined(const std::vector<double>& of) {
  std::vector<double> result;
  for (std::size_t k = 0; k < of.size(); ++k) {
    const std::size_t reach = std::min({k, of.size() - 1 - k, joined_bins});  // as far to both sides: curves rise
    result.push_back(stats::median(std::span(of).subspan(k - reach, 2 * reach + 1)));
  }
  return result;
}

// `left`: the other's reading, and what one picture has beyond it, both logarithms.
Relation relation_of(std::vector<std::pair<double, double>> left) {
  std::ranges::sort(left);
  const std::size_t each = std::max(least_in_bin, left.size() / level_bins);
  Relation r;
  for (std::size_t from = 0, to = 0; from < left.size(); from = to) {
    // Equal readings stay together: what a full well or a coarse code hides is the spread of one bin.
    to = left.size() - from < 2 * each ? left.size() : from + each;
    while (to < left.size() && left[to].first == left[to - 1].first) ++to;
    std::vector<double> levels, values;
    for (std::size_t i = from; i < to; ++i) levels.push_back(left[i].first), values.push_back(left[i].second);
    r.level.push_back(stats::median(levels));
    r.middle.push_back(stats::median(values));
    r.spread.push_back(stats::robust_sigma(values));
  }
  const std::vector<double> own_spread = r.spread;
  r.middle = joined(r.middle), r.spread = joined(r.spread);
  for (std::size_t k = 0; k < r.spread.size(); ++k) r.spread[k] = std::max(r.spread[k], own_spread[k]);
  for (std::size_t k = 0; k < r.level.size(); ++k) {
    const std::size_t from = k == 0 ? 0 : k - 1, to = std::min(r.level.size() - 1, k + 1);
    const double across = r.level[to] - r.level[from];
    r.slope.push_back(across > 0 ? 1 + (r.middle[to] - r.middle[from]) / across : 1);
  }
  return r;
}

// One channel of the stack on the grid: for every picture what is left of each point's logarithm, and its z.
struct Departures {
  std::vector<std::vector<double>> left, z;  // [picture][point]; none where it does not count
};

// Of one picture against one other: what is left of log(reading) once the other's reading at the same point has said
// what it can, and that over its noise.
struct Pair {
  std::vector<double> left, z;
};

Pair against(const std::vector<Reading>& own, const std::vector<Reading>& other) {
  Pair pair{std::vector(own.size(), none), std::vector(own.size(), none)};
  std::vector<std::pair<double, double>> shown;
  for (std::size_t i = 0; i < own.size(); ++i)
    if (is_told(own[i]) && is_told(other[i])) shown.emplace_back(other[i].log, own[i].log - other[i].log);
  if (shown.size() < least_shown) return pair;
  const Relation relation = relation_of(std::move(shown));
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (std::isnan(own[i].log) || !is_told(other[i])) continue;
    const double l = other[i].log, slope = std::abs(relation.at(relation.slope, l));
    if (slope > steepest_told || (own[i].at_least && l > relation.level.back())) continue;
    pair.left[i] = own[i].log - l - relation.at(relation.middle, l);
    if (own[i].at_least && pair.left[i] < surely_above) pair.left[i] = 0;
    const double rounding = own[i].rounding + slope * other[i].rounding;
    const double beyond = std::max(0.0, std::abs(pair.left[i]) - rounding);
    const double noise = std::hypot(own[i].sigma, slope * other[i].sigma);
    pair.z[i] =
        std::copysign(beyond, pair.left[i]) / std::max({noise, relation.at(relation.spread, l) - rounding, 1e-9});
  }
  return pair;
}

// Pictures through the same aperture, which shades alike, by the distance of their exposures, the nearest first.
std::vector<std::size_t> partners(const Stack& stack, std::size_t picture) {
  std::vector<std::size_t> others;
  for (std::size_t g = 0; g < stack.images.size(); ++g)
    if (g != picture && stack.images[g].f_number == stack.images[picture].f_number) others.push_back(g);
  const auto away = [&](std::size_t g) {
    return std::abs(std::log(stack.images[g].exposure_s / stack.images[picture].exposure_s));
  };
  std::ranges::stable_sort(others, {}, away);
  others.resize(std::min(others.size(), most_partners));
  return others;
}

// What all partners but a minority say: of an even number the middle one that says less, and of both signs nothing.
void agreed(const std::vector<Pair>& pairs, std::size_t point, double& left, double& z) {
  std::vector<std::pair<double, double>> said;  // z, left
  for (const Pair& pair : pairs)
    if (!std::isnan(pair.z[point])) said.emplace_back(pair.z[point], pair.left[point]);
  if (said.size() < fewest_pictures - 1) return;
  std::ranges::sort(said);
  const auto &low = said[(said.size() - 1) / 2], &high = said[said.size() / 2];
  std::tie(z, left) = std::abs(low.first) < std::abs(high.first) ? low : high;
  if (low.first * high.first < 0) z = 0;
}

Departures departures(const Stack& stack, const ReadingNoise& noise, const Grid& grid, int c) {
  const std::size_t pictures = stack.images.size();
  std::vector<std::vector<Reading>> readings(pictures, std::vector<Reading>(grid.size()));
  for (std::size_t g = 0; g < pictures; ++g)
    for (std::size_t i = 0; i < grid.size(); ++i)
      readings[g][i] = reading_at(stack, noise, g, grid.column(i), grid.row(i), c);
  Departures d{std::vector(pictures, std::vector(grid.size(), none)),
               std::vector(pictures, std::vector(grid.size(), none))};
  for (std::size_t g = 0; g < pictures; ++g) {
    std::vector<Pair> pairs;
    for (const std::size_t other : partners(stack, g)) pairs.push_back(against(readings[g], readings[other]));
    for (std::size_t i = 0; i < grid.size(); ++i) agreed(pairs, i, d.left[g][i], d.z[g][i]);
  }
  return d;
}

// Sum over three by three points and all channels, over its standard deviation.
std::vector<double> gathered(const std::vector<Departures>& channels, const Grid& grid, std::size_t picture) {
  std::vector<double> sum(grid.size());
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x) {
      double top = 0, count = 0;
      for (const Departures& d : channels)
        for (int b = std::max(0, y - 1); b <= std::min(grid.height - 1, y + 1); ++b)
          for (int a = std::max(0, x - 1); a <= std::min(grid.width - 1, x + 1); ++a) {
            const double z = d.z[picture][static_cast<std::size_t>(b * grid.width + a)];
            if (!std::isnan(z)) top += std::clamp(z, -20.0, 20.0), ++count;
          }
      if (count > 4) sum[static_cast<std::size_t>(y * grid.width + x)] = top / std::sqrt(count);
    }
  return sum;
}

// Do all points around this one depart to the same side? Edges of pictures that are not quite registered are thin.
bool is_core(const std::vector<double>& z, const Grid& grid, std::size_t point) {
  const int x = static_cast<int>(point) % grid.width, y = static_cast<int>(point) / grid.width;
  if (x < core_reach || y < core_reach || x + core_reach >= grid.width || y + core_reach >= grid.height) return false;
  for (int b = y - core_reach; b <= y + core_reach; ++b)
    for (int a = x - core_reach; a <= x + core_reach; ++a) {
      const double there = z[static_cast<std::size_t>(b * grid.width + a)];
      if (std::abs(there) <= member_z || there * z[point] < 0) return false;
    }
  return true;
}

MovedRegion region_of(const Stack& stack, const Grid& grid, const std::vector<Departures>& channels,
                      std::size_t picture, const std::vector<GridRegion>& parts) {
  MovedRegion r;
  r.image = picture;
  r.grid_px = grid.stride;
  int left = grid.width, right = 0, top = grid.height, bottom = 0;
  r.inside.assign(static_cast<std::size_t>(stack.width()) * static_cast<std::size_t>(stack.height()), 0);
  std::vector<double> change;
  double points = 0;
  for (const GridRegion& part : parts) {
    left = std::min(left, part.left), right = std::max(right, part.right);
    top = std::min(top, part.top), bottom = std::max(bottom, part.bottom);
    points += static_cast<double>(part.points.size());
    for (const std::size_t i : part.points) {
      for (const Departures& d : channels)
        if (!std::isnan(d.left[picture][i])) change.push_back(d.left[picture][i]);
      // With a margin of one point: the border of what moved lies between two.
      const int cx = grid.column(i), cy = grid.row(i);
      for (int y = std::max(0, cy - grid.stride); y <= std::min(stack.height() - 1, cy + grid.stride); ++y)
        for (int x = std::max(0, cx - grid.stride); x <= std::min(stack.width() - 1, cx + grid.stride); ++x)
          r.inside[static_cast<std::size_t>(y) * static_cast<std::size_t>(stack.width()) +
                   static_cast<std::size_t>(x)] = 1;
    }
  }
  r.left_px = std::max(0, (left - 1) * grid.stride), r.top_px = std::max(0, (top - 1) * grid.stride);
  r.width_px = std::min(stack.width(), (right + 1) * grid.stride + 1) - r.left_px;
  r.height_px = std::min(stack.height(), (bottom + 1) * grid.stride + 1) - r.top_px;
  r.share = points / static_cast<double>(grid.size());
  const double middle = stats::median(change);
  r.relative = std::expm1(middle);
  // Three by three points share their z: a ninth of them tell.
  r.sigma = std::exp(middle) * stats::robust_sigma(change) / std::sqrt(std::max(1.0, points / 9));
  return r;
}

// Relative errors of all readings on the grid about what their levels say, with the moved ones and without.
void score(const Stack& stack, const Grid& grid, const std::vector<Departures>& channels, Moved& moved) {
  double all = 0, error = 0, moving = 0, its_signal = 0;
  for (std::size_t g = 0; g < stack.images.size(); ++g) {
    const auto own = std::ranges::find(moved.regions, g, &MovedRegion::image);
    for (std::size_t c = 0; c < channels.size(); ++c)
      for (std::size_t i = 0; i < grid.size(); ++i) {
        const double left = channels[c].left[g][i];
        if (std::isnan(left)) continue;
        const int x = grid.column(i), y = grid.row(i);
        const double v = stack.images[g].picture.at(x, y, static_cast<int>(c)), e = v * -std::expm1(-left);
        all += v * v, error += e * e;
        const auto place =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(stack.width()) + static_cast<std::size_t>(x);
        if (own != moved.regions.end() && own->inside[place]) moving += e * e, its_signal += v * v;
      }
  }
  if (!(all > its_signal)) return;
  moved.with = std::sqrt(error / all);
  moved.without = std::sqrt(std::max(0.0, error - moving) / (all - its_signal));
  moved.effect = std::sqrt(moving / all);
}

}  // namespace

Moved find_moved(const Stack& stack, const ReadingNoise& noise) {
  const Grid grid = grid_over(stack);
  std::vector<Departures> channels;
  for (std::size_t c = 0; c < stack.channels.size(); ++c)
    channels.push_back(departures(stack, noise, grid, static_cast<int>(c)));
  Moved moved;
  double largest = 0;
  for (std::size_t g = 0; g < stack.images.size(); ++g) {
    const std::vector<double> z = gathered(channels, grid, g);
    std::vector<std::uint8_t> departs(grid.size());
    for (std::size_t i = 0; i < grid.size(); ++i) departs[i] = std::abs(z[i]) > member_z;
    std::vector<GridRegion> parts = grid_regions(departs, grid.width, grid.height, least_points);
    std::erase_if(parts, [&](const GridRegion& part) {
      return std::ranges::none_of(part.points, [&](std::size_t i) { return std::abs(z[i]) > seed_z; }) ||
             std::ranges::none_of(part.points, [&](std::size_t i) { return is_core(z, grid, i); });
    });
    if (parts.empty()) continue;
    MovedRegion region = region_of(stack, grid, channels, g, parts);
    if (region.share > most_share) continue;
    for (const GridRegion& part : parts)
      for (const std::size_t i : part.points) largest = std::max(largest, std::abs(z[i]));
    moved.regions.push_back(std::move(region));
  }
  if (moved.regions.empty()) return moved;
  const double looks = static_cast<double>(grid.size()) * static_cast<double>(stack.images.size());
  moved.p = stats::sidak(2 * stats::normal_upper(largest), looks);
  score(stack, grid, channels, moved);
  return moved;
}

void leave_out(const Moved& moved, Stack& stack) {
  for (const MovedRegion& region : moved.regions) {
    std::vector<std::uint8_t>& counts = stack.images[region.image].counts;
    const std::size_t channels = stack.channels.size();
    for (std::size_t i = 0; i < region.inside.size(); ++i)
      if (region.inside[i])
        for (std::size_t c = 0; c < channels; ++c) counts[i * channels + c] = 0;
  }
}

}  // namespace gonio::explain::stacks

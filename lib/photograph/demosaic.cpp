// See demosaic.h.
#include "photograph/demosaic.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "photograph/polarizers.h"

namespace gonio::photograph {
namespace {

struct Tap {
  int dx, dy;
  double weight;
};
using Taps = std::vector<Tap>;

// Malvar, He & Cutler's four filters, in eighths. `level`: the wanted colour's nearest samples lie in the row.
Taps green_at_colour() {
  return {{0, 0, 4}, {1, 0, 2}, {-1, 0, 2}, {0, 1, 2}, {0, -1, 2}, {2, 0, -1}, {-2, 0, -1}, {0, 2, -1}, {0, -2, -1}};
}
Taps colour_at_green(bool level) {
  Taps taps{{0, 0, 5},    {1, 0, 4},  {-1, 0, 4},  {1, 1, -1},  {1, -1, -1}, {-1, 1, -1},
            {-1, -1, -1}, {2, 0, -1}, {-2, 0, -1}, {0, 2, 0.5}, {0, -2, 0.5}};
  if (!level)
    for (Tap& t : taps) std::swap(t.dx, t.dy);
  return taps;
}
Taps colour_at_other() {
  return {{0, 0, 6},    {1, 1, 2},     {1, -1, 2},   {-1, 1, 2},   {-1, -1, 2},
          {2, 0, -1.5}, {-2, 0, -1.5}, {0, 2, -1.5}, {0, -2, -1.5}};
}

// A correction by the other colours' Laplacian so many times its noise is structure, finer than the samples of a
// colour.
constexpr double structure = 3;
// How far a plain and a corrected mean are off, in corrections: as found on the recorded mosaic of the tests.
constexpr double plain_off = 1.5, corrected_off = 1;

struct Mean {
  double value = 0, variance = 0;
  bool found = false;
  ExposureRange exposures{};
};

class Demosaic {
 public:
  Demosaic(const MosaicSamples& samples, const Mosaic& mosaic) : s_(samples), mosaic_(mosaic) {}

  // Of the samples of one colour within a step: weights 4, 2 and 1 as they are near, which is bilinear.
  Mean nearest(int x, int y, int colour) const {
    constexpr std::array<std::array<int, 3>, 3> weights{{{1, 2, 1}, {2, 4, 2}, {1, 2, 1}}};
    const bool own = mosaic_.colour(x, y) == colour && s_.trusted[at(x, y)] != 0;
    double sum = 0, squares = 0, all = 0;
    ExposureRange exposures;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        if (own && (dx != 0 || dy != 0)) continue;
        const int u = x + dx, v = y + dy;
        if (!inside(u, v) || mosaic_.colour(u, v) != colour || s_.trusted[at(u, v)] == 0) continue;
        const double w = weights[static_cast<std::size_t>(dy + 1)][static_cast<std::size_t>(dx + 1)];
        sum += w * s_.value[at(u, v)], squares += w * w * s_.variance[at(u, v)], all += w;
        exposures.add(range(at(u, v)));
      }
    if (!(all > 0)) return {};
    return {sum / all, squares / (all * all), true, exposures};
  }

  // `correction`: what colours other than this one add, with its noise.
  Mean filtered(int x, int y, int colour, const Taps& taps, Mean& correction) const {
    Mean m{0, 0, true, {}};
    for (const Tap& t : taps) {
      const int u = x + t.dx, v = y + t.dy;
      if (!inside(u, v) || s_.trusted[at(u, v)] == 0) return {};
      m.value += t.weight / 8 * s_.value[at(u, v)];
      m.variance += t.weight * t.weight / 64 * s_.variance[at(u, v)];
      m.exposures.add(range(at(u, v)));
      if (mosaic_.colour(u, v) == colour) continue;
      correction.value += t.weight / 8 * s_.value[at(u, v)];
      correction.variance += t.weight * t.weight / 64 * s_.variance[at(u, v)];
    }
    correction.found = true;
    return m;
  }

  Mean of(int x, int y, int colour, Demosaicing how) const {
    const int own = mosaic_.colour(x, y);
    if (own == colour) return nearest(x, y, colour);
    static const Taps green = green_at_colour(), level = colour_at_green(true), upright = colour_at_green(false),
                      other = colour_at_other();
    Mean correction;
    Mean m = filtered(x, y, colour,
                      colour == 1            ? green
                      : own != 1             ? other
                      : in_row(x, y, colour) ? level
                                             : upright,
                      correction);
    const bool plain = how == Demosaicing::bilinear || !m.found;
    if (plain) m = nearest(x, y, colour);
    const double squared = correction.value * correction.value, off = plain ? plain_off : corrected_off;
    if (correction.found && squared > structure * structure * correction.variance)
      m.variance += off * off * (squared - correction.variance);
    return m;
  }

 private:
  bool in_row(int x, int y, int colour) const { return mosaic_.colour(x + 1, y) == colour; }
  bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < s_.width && y < s_.height; }
  ExposureRange range(std::size_t i) const { return range_of(s_, i); }
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(s_.width) + static_cast<std::size_t>(x);
  }
  const MosaicSamples& s_;
  const Mosaic& mosaic_;
};

}  // namespace

Demosaiced demosaic(const MosaicSamples& samples, const Mosaic& mosaic, Demosaicing how) {
  if (mosaic.polarizers()) return stokes_of_polarizers(samples, how);
  const std::vector<std::string> names =
      mosaic.mono() ? std::vector<std::string>{"Y"} : std::vector<std::string>{"R", "G", "B"};
  const std::size_t pixels = samples.value.size(), columns = static_cast<std::size_t>(samples.width);
  Demosaiced result{io::Image(samples.width, samples.height, names), io::Image(samples.width, samples.height, names),
                    std::vector<std::uint8_t>(samples.trusted.begin(), samples.trusted.end()),
                    std::vector<std::uint8_t>(pixels, ExposureRange{}.first),
                    std::vector<std::uint8_t>(pixels, ExposureRange{}.last)};
  if (mosaic.mono()) {
    result.colour.data.assign(samples.value.begin(), samples.value.end());
    result.variance.data.assign(samples.variance.begin(), samples.variance.end());
    for (std::size_t i = 0; i < pixels && !samples.first.empty(); ++i)
      if (samples.trusted[i] != 0) result.first[i] = samples.first[i], result.last[i] = samples.last[i];
    return result;
  }
  const Demosaic work(samples, mosaic);
  parallel_for(0, static_cast<std::size_t>(samples.height), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < samples.width; ++x) {
      const std::size_t i = row * columns + static_cast<std::size_t>(x);
      ExposureRange exposures;
      for (int c = 0; c < 3; ++c) {
        const Mean m = work.of(x, y, c, how);
        result.colour.at(x, y, c) = static_cast<float>(m.value);
        result.variance.at(x, y, c) = static_cast<float>(m.variance);
        if (!m.found) result.trusted[i] = 0;
        exposures.add(m.exposures);
      }
      result.first[i] = exposures.first, result.last[i] = exposures.last;
    }
  });
  return result;
}

}  // namespace gonio::photograph

// See seen.h.
#include "glass/net/seen.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>

#include "base/error.h"
#include "base/text.h"
#include "photograph/polarizers.h"
#include "render/mosaic.h"

namespace gonio::glass {
namespace {

constexpr std::array degrees{0, 45, 90, 135};

Planes planes_of(const io::Image& picture) {
  Planes planes{
      picture.channels.size(), static_cast<std::size_t>(picture.height), static_cast<std::size_t>(picture.width), {}};
  planes.values.resize(picture.data.size());
  for (std::size_t c = 0; c < planes.channels; ++c)
    for (std::size_t i = 0; i < planes.pixels(); ++i) planes.plane(c)[i] = picture.data[i * planes.channels + c];
  return planes;
}

// The channels of these names as a picture of its own, called `as`; empty where one is missing.
io::Image chosen(const io::Image& picture, const std::vector<std::string>& names, const std::vector<std::string>& as) {
  io::Image part(picture.width, picture.height, as);
  for (std::size_t k = 0; k < names.size(); ++k) {
    const int c = picture.channel(names[k]);
    if (c < 0) return {};
    for (std::size_t i = 0; i < picture.pixels(); ++i)
      part.data[i * names.size() + k] = picture.data[i * picture.channels.size() + static_cast<std::size_t>(c)];
  }
  return part;
}

Planes intensities_of_stokes(const Planes& stokes) {
  Planes behind{degrees.size(), stokes.height, stokes.width, std::vector<float>(degrees.size() * stokes.pixels())};
  for (std::size_t k = 0; k < degrees.size(); ++k)
    for (std::size_t i = 0; i < stokes.pixels(); ++i)
      behind.plane(k)[i] = static_cast<float>(photograph::behind_polarizer(
          stokes.plane(0)[i], stokes.plane(1)[i], stokes.plane(2)[i], degrees[k] * M_PI / 180));
  return behind;
}

Planes shrunk(const Planes& from, std::size_t n) {
  if (n == 1) return from;
  Planes to{from.channels, from.height / n, from.width / n, {}};
  to.values.resize(to.channels * to.pixels());
  for (std::size_t c = 0; c < to.channels; ++c)
    for (std::size_t y = 0; y < to.height; ++y)
      for (std::size_t x = 0; x < to.width; ++x) {
        double sum = 0;
        for (std::size_t j = 0; j < n; ++j)
          for (std::size_t i = 0; i < n; ++i) sum += from.plane(c)[(y * n + j) * from.width + x * n + i];
        to.plane(c)[y * to.width + x] = static_cast<float>(sum / static_cast<double>(n * n));
      }
  return to;
}

Planes unshrunk(const io::Image& picture, const std::string& input, const std::string& place) {
  if (input == "rgb") {
    const io::Image colours = chosen(picture, {"R", "G", "B"}, {"R", "G", "B"});
    if (colours.pixels() > 0) return planes_of(colours);
    throw Error(Exit::data, place, "has no channels R, G, B, which these weights ask for",
                "give a picture in colours, or weights that were trained with --input stokes");
  }
  if (picture.channels.size() == 1) {
    demand_mosaic(picture, place);
    return input == "stokes" ? stokes_of_mosaic(picture) : intensities_of_mosaic(picture);
  }
  const Planes stokes = stokes_of_picture(picture);
  if (stokes.values.empty())
    throw Error(Exit::data, place, "is neither a mosaic of polarizers (one channel) nor has it Stokes vectors",
                "give a polarization camera's photograph as it was read, or what develop or render --stokes makes");
  return input == "stokes" ? stokes : intensities_of_stokes(stokes);
}

// Per pixel the amplitude of a pattern that alternates along x, along y or along both, less what straight slopes of the
// picture would add.
struct Alternating {
  bool along_x, along_y;
  double at(const io::Image& picture, int x, int y) const {
    double sum = 0;
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i) {
        const double wx = i == 0 ? 0.5 : along_x ? -0.25 : 0.25, wy = j == 0 ? 0.5 : along_y ? -0.25 : 0.25;
        sum += wx * wy * picture.at(x + i, y + j, 0);
      }
    const int odd = (along_x ? x : 0) + (along_y ? y : 0);
    return odd % 2 == 0 ? sum : -sum;
  }
};

}  // namespace

Planes stokes_of_picture(const io::Image& picture) {
  const io::Image one_band = chosen(picture, {"Y", "s1.Y", "s2.Y"}, {"Y", "s1.Y", "s2.Y"});
  if (one_band.pixels() > 0) return planes_of(one_band);
  Planes planes{3, static_cast<std::size_t>(picture.height), static_cast<std::size_t>(picture.width), {}};
  for (const std::string prefix : {"", "s1.", "s2."}) {
    const io::Image bands = chosen(picture, {prefix + "R", prefix + "G", prefix + "B"}, {"R", "G", "B"});
    if (bands.pixels() == 0) return {};
    const io::Image light = render::luminance(bands);
    planes.values.insert(planes.values.end(), light.data.begin(), light.data.end());
  }
  return planes;
}

Planes stokes_of_mosaic(const io::Image& mosaic) {
  const std::vector<float> variance(mosaic.pixels(), 1);
  const std::vector<std::uint8_t> trusted(mosaic.pixels(), 1);
  photograph::MosaicSamples samples;
  samples.width = mosaic.width, samples.height = mosaic.height;
  samples.value = mosaic.data, samples.variance = variance, samples.trusted = trusted;
  return planes_of(photograph::stokes_of_polarizers(samples, photograph::Demosaicing::gradient).colour);
}

Planes intensities_of_mosaic(const io::Image& mosaic) {
  Planes planes{degrees.size(), static_cast<std::size_t>(mosaic.height), static_cast<std::size_t>(mosaic.width), {}};
  planes.values.resize(planes.channels * planes.pixels());
  for (int y = 0; y < mosaic.height; ++y)
    for (int x = 0; x < mosaic.width; ++x) {
      float* plane = planes.plane(static_cast<std::size_t>(photograph::polarizer_degrees(x, y) / 45));
      for (int j = y / 2 * 2; j < std::min(y / 2 * 2 + 2, mosaic.height); ++j)
        for (int i = x / 2 * 2; i < std::min(x / 2 * 2 + 2, mosaic.width); ++i)
          plane[static_cast<std::size_t>(j) * planes.width + static_cast<std::size_t>(i)] = mosaic.at(x, y, 0);
    }
  return planes;
}

Planes seen_of(const io::Image& picture, const std::string& input, int shrink, const std::string& place) {
  if (picture.width < shrink || picture.height < shrink)
    throw Error(Exit::data, place,
                format("of %d x %d pixels has no block of %d", picture.width, picture.height, shrink),
                "lower --shrink");
  for (const float value : picture.data)
    if (!std::isfinite(value))
      throw Error(Exit::data, place, "has values that are no numbers", "replace them by what is beside them");
  return shrunk(unshrunk(picture, input, place), static_cast<std::size_t>(shrink));
}

void in_mean_light(Planes& seen, const std::string& input, const std::string& place) {
  const std::size_t counted = input == "stokes" ? seen.pixels() : seen.values.size();
  double sum = 0;
  for (std::size_t i = 0; i < counted; ++i) sum += seen.values[i];
  const double mean = sum / static_cast<double>(counted) * (input == "intensities" ? 2 : 1);
  if (!(mean > 0)) throw Error(Exit::data, place, "is dark: its mean light is not positive", "look at its black level");
  for (float& value : seen.values) value = static_cast<float>(value / mean);
}

MosaicEvidence mosaic_evidence(const io::Image& mosaic) {
  // Each block's mean amplitude would be squared with its noise: two halves that share no pixel's noise are multiplied.
  // Of I = (s0 + s1 cos 2a + s2 sin 2a) / 2 on [90 45; 135 0] the amplitude along x is -(s1 + s2) / 4, along y
  // (s2 - s1) / 4, and along both (I90 + I0 - I45 - I135) / 4, which is zero.
  const int block = std::clamp((std::min(mosaic.width - 6, mosaic.height - 4)) / 4 * 4, 4, 16), half = block / 2;
  constexpr std::array<Alternating, 3> patterns{{{true, false}, {false, true}, {true, true}}};
  std::array<double, 3> products{};
  double light = 0;
  for (int top = 2; top + block + 1 < mosaic.height; top += block)
    for (int left = 2; left + block + 3 < mosaic.width; left += block + 2) {
      double level = 0;
      for (int y = top; y < top + block; ++y)
        for (int x = left; x < left + block; ++x) level += mosaic.at(x, y, 0);
      level /= block * block;
      light += level * level;
      for (std::size_t k = 0; k < patterns.size(); ++k) {
        std::array<double, 2> mean{};
        for (int y = top; y < top + block; ++y)
          for (int x = 0; x < half; ++x) {
            mean[0] += patterns[k].at(mosaic, left + x, y) / (block * half);
            mean[1] += patterns[k].at(mosaic, left + half + 2 + x, y) / (block * half);
          }
        products[k] += mean[0] * mean[1];
      }
    }
  if (!(light > 0)) return {};
  return {std::sqrt(std::max(0.0, 2 * (products[0] + products[1]) / light)),
          2 * std::sqrt(std::max(0.0, products[2] / light))};
}

void demand_mosaic(const io::Image& mosaic, const std::string& place) {
  // Two recorded mosaics have diagonals that differ by 2 % (their sensors' polarizers are not alike) and polarization
  // of 4 and 10 %; mosaics of colours, as white balanced as can be, 12 to 21 % at 21 to 56; photographs without
  // filters, and of a painting's canvas, show up to 0.6 % of polarization.
  constexpr double least = 0.01, unlike = 0.04, of_polarization = 0.3;
  // Edges of a mask look polarized.
  constexpr std::size_t fewest_levels = 3;
  std::set<float> levels;
  for (std::size_t i = 0; i < mosaic.data.size() && levels.size() < fewest_levels; ++i) levels.insert(mosaic.data[i]);
  if (levels.size() < fewest_levels)
    throw Error(
        Exit::data, place,
        format("is a mask or empty, no photograph: %zu different values, at least %zu", levels.size(), fewest_levels),
        "give the photograph as the polarization camera read it, no mask");
  const MosaicEvidence found = mosaic_evidence(mosaic);
  const double limit = std::max(unlike, of_polarization * found.polarization);
  if (found.diagonals > limit)
    throw Error(
        Exit::data, place,
        format("is no mosaic of polarizers: I0 + I90 and I45 + I135 differ by %.2g %% of the light, limit %.2g %%",
               100 * found.diagonals, 100 * limit),
        "give the photograph as the polarization camera read it, super-pixel [90 45; 135 0]");
  if (found.polarization < least)
    throw Error(Exit::data, place,
                format("is no mosaic of polarizers, or nothing in it is polarized: degree %.2g %%, at least %.2g %%",
                       100 * found.polarization, 100 * least),
                "give the photograph as the polarization camera read it, neither scaled nor cropped by odd numbers");
}

}  // namespace gonio::glass

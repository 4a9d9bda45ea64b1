#include "metric/overlay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include "base/error.h"
#include "geom/luminance.h"
#include "photograph/noise_variance.h"

namespace gonio::metric {
namespace {

std::string size_text(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

// Weighted sum of the channels; for variances of independent channels the weights enter squared.
io::Image luminance(const io::Image& colour, bool squared) {
  if (colour.channels.size() != 3) return colour;
  io::Image y(colour.width, colour.height, {"Y"});
  for (std::size_t i = 0; i < y.pixels(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const auto w = static_cast<float>(luminance_weights[c]);
      y.data[i] += (squared ? w * w : w) * colour.data[3 * i + c];
    }
  return y;
}

io::Image one_channel(const io::Image& colour, std::size_t c, const std::string& name) {
  if (colour.data.empty()) return colour;
  if (colour.channels.size() != 3)
    throw Error(Exit::data, name, "is grey and has no channel of its own for red, green or blue",
                "compare --channels luminance");
  io::Image plane(colour.width, colour.height, {colour.channels[c]});
  for (std::size_t i = 0; i < plane.pixels(); ++i) plane.data[i] = colour.data[3 * i + c];
  return plane;
}

void reduce(LinearPicture& picture, Channels channels) {
  if (channels == Channels::luminance) {
    picture.colour = luminance(picture.colour, false);
    picture.variance = luminance(picture.variance, true);
  } else if (channels != Channels::all) {
    const auto c = static_cast<std::size_t>(channels) - static_cast<std::size_t>(Channels::red);
    picture.colour = one_channel(picture.colour, c, picture.name);
    picture.variance = one_channel(picture.variance, c, picture.name);
  }
}

// Sets not-finite pixels aside and reports them.
void find_not_finite(Overlay& o) {
  const std::size_t channels = o.channels.size();
  for (std::size_t p = 0; p < o.counts.size(); ++p) {
    if (!o.counts[p]) continue;
    for (std::size_t c = 0; c < channels; ++c) {
      const std::size_t i = p * channels + c;
      const bool photograph = std::isfinite(o.photograph[i]), rendering = std::isfinite(o.rendering[i]);
      if (photograph && rendering) continue;
      if (o.not_finite.pixels++ == 0) {
        o.not_finite.x = static_cast<int>(p % static_cast<std::size_t>(o.width));
        o.not_finite.y = static_cast<int>(p / static_cast<std::size_t>(o.width));
        o.not_finite.channel = o.channels[c];
        o.not_finite.in_photograph = !photograph;
      }
      o.counts[p] = 0;
      break;
    }
    o.pixels += o.counts[p];
  }
}

void check_sizes(const LinearPicture& photograph, const LinearPicture& rendering, const Mask* mask,
                 const std::string& name) {
  const io::Image &a = photograph.colour, &b = rendering.colour;
  if (a.width != b.width || a.height != b.height)
    throw Error(Exit::data, rendering.name,
                "is " + size_text(b.width, b.height) + " px, the photograph " + photograph.name + " is " +
                    size_text(a.width, a.height) + " px",
                "render with the camera of the photograph");
  if (a.pixels() == 0) throw Error(Exit::data, photograph.name, "has no pixels");
  if (mask == nullptr) return;
  if (mask->width != a.width || mask->height != a.height)
    throw Error(
        Exit::data, "mask of " + name,
        "is " + size_text(mask->width, mask->height) + " px, the photograph is " + size_text(a.width, a.height) + " px",
        "cut both alike");
  if (std::ranges::none_of(mask->counts, [](std::uint8_t v) { return v != 0; }))
    throw Error(Exit::data, "mask of " + name, "counts no pixel (none is above 0.5)", "is it inverted, or black?");
}

}  // namespace

Channels channels_named(const std::string& name) {
  constexpr std::array<std::string_view, 5> names{"all", "luminance", "red", "green", "blue"};
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) throw Error(Exit::usage, name, "names no channels", "all, luminance, red, green or blue");
  return static_cast<Channels>(found - names.begin());
}

double Overlay::variance(std::size_t i, double scale) const {
  double total = 0;
  if (noise)
    total = photograph::noise_variance(*noise, scale * rendering[i]);
  else if (!photograph_variance.empty())
    total = photograph_variance[i];
  else
    return std::numeric_limits<double>::quiet_NaN();
  if (!rendering_variance.empty()) total += scale * scale * rendering_variance[i];
  return total;
}

Overlay lay_over(std::string name, LinearPicture photograph, LinearPicture rendering, const Mask* mask,
                 Channels channels, std::optional<manifest::Noise> noise) {
  check_sizes(photograph, rendering, mask, name);
  if (channels == Channels::all && photograph.colour.channels.size() != rendering.colour.channels.size())
    channels = Channels::luminance;
  if (channels == Channels::luminance && photograph.colour.channels.size() == 3 && noise) {
    // Shot noise of a weighted sum depends on each channel, which the sum no longer shows: keep its variance beside it.
    photograph.variance = photograph.colour;
    for (float& v : photograph.variance.data) v = static_cast<float>(photograph::noise_variance(*noise, v));
    noise.reset();
  }
  reduce(photograph, channels);
  reduce(rendering, channels);
  Overlay o;
  o.name = std::move(name);
  o.width = photograph.colour.width;
  o.height = photograph.colour.height;
  o.channels = photograph.colour.channels;
  o.photograph = std::move(photograph.colour.data);
  o.rendering = std::move(rendering.colour.data);
  o.photograph_variance = std::move(photograph.variance.data);
  o.rendering_variance = std::move(rendering.variance.data);
  o.noise = noise;
  o.clipped = std::move(photograph.clipped);
  o.integer_codes = photograph.integer_codes();
  if (mask != nullptr)
    o.counts = mask->counts;
  else
    o.counts.assign(static_cast<std::size_t>(o.width) * static_cast<std::size_t>(o.height), 1);
  find_not_finite(o);
  return o;
}

}  // namespace gonio::metric

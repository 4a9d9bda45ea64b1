#include "metric/difference_pictures.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "io/picture.h"
#include "report/colour_map.h"

namespace gonio::metric {
namespace {

using report::Colour;
using report::magnitude_colour;
using report::signed_colour;

constexpr Colour not_counted{0.62f, 0.62f, 0.62f};
constexpr Colour magenta{1, 0, 1};

double upper_percentile(std::vector<float> values, double share) {
  std::erase_if(values, [](float v) { return !std::isfinite(v); });
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, at);
  return *at;
}

// A picture whose pixel is a function of its number; pixels that are not finite are magenta, the rest not counted grey.
io::Image paint(const Overlay& o, const std::function<Colour(std::size_t)>& colour) {
  io::Image picture(o.width, o.height, {"R", "G", "B"});
  const std::size_t channels = o.channels.size();
  for (std::size_t p = 0; p < picture.pixels(); ++p) {
    bool finite = true;
    for (std::size_t i = p * channels; i < (p + 1) * channels; ++i)
      finite = finite && std::isfinite(o.photograph[i]) && std::isfinite(o.rendering[i]);
    const Colour c = o.counts[p] ? colour(p) : finite ? not_counted : magenta;
    std::ranges::copy(c, picture.data.begin() + static_cast<std::ptrdiff_t>(3 * p));
  }
  return picture;
}

// The same channel three times for grey.
Colour per_channel(const Overlay& o, std::size_t p, const std::function<float(std::size_t)>& value) {
  const std::size_t channels = o.channels.size();
  if (channels == 3) return {value(3 * p), value(3 * p + 1), value(3 * p + 2)};
  const float v = value(p);
  return {v, v, v};
}

double mean_of(const std::vector<float>& values, std::size_t p, std::size_t channels, bool magnitude) {
  double sum = 0;
  for (std::size_t i = p * channels; i < (p + 1) * channels; ++i) sum += magnitude ? std::abs(values[i]) : values[i];
  return sum / static_cast<double>(channels);
}

io::Image part(const Overlay& o, const Differences& d, double white, float sign) {
  return paint(o, [&](std::size_t p) {
    return per_channel(o, p, [&](std::size_t i) {
      const double share = std::max(sign * d.signed_difference[i], 0.0f) / white;
      return static_cast<float>(std::pow(std::min(share, 1.0), 1 / 2.2));
    });
  });
}

}  // namespace

DisplayTone display_tone(const Overlay& o, const Differences& d, const Measures& m) {
  DisplayTone tone;
  const double white = upper_percentile(o.photograph, 0.995);
  tone.white = white > 0 ? white : 1;
  std::vector<float> magnitude = d.signed_difference;
  for (float& v : magnitude) v = std::abs(v);
  const double largest = upper_percentile(magnitude, 1.0), most = upper_percentile(std::move(magnitude), 0.995);
  tone.difference = most > 0 ? most : largest > 0 ? largest : tone.white;
  tone.log_range = {std::log10(m.log_floor), std::log10(std::max(largest, 10 * m.log_floor))};
  return tone;
}

io::Image display(const Overlay& o, Which which, double scale, double white) {
  const bool photograph = which == Which::photograph;
  const auto& from = photograph ? o.photograph : o.rendering;
  const double factor = (photograph ? 1.0 : scale) / white;
  io::Image picture(o.width, o.height, {"R", "G", "B"});
  for (std::size_t p = 0; p < picture.pixels(); ++p) {
    const Colour c = per_channel(o, p, [&](std::size_t i) {
      return std::isfinite(from[i]) ? io::srgb_from_linear(static_cast<float>(std::clamp(factor * from[i], 0.0, 1.0)))
                                    : std::numeric_limits<float>::quiet_NaN();
    });
    const bool finite = std::isfinite(c[0]) && std::isfinite(c[1]) && std::isfinite(c[2]);
    std::ranges::copy(finite ? c : magenta, picture.data.begin() + static_cast<std::ptrdiff_t>(3 * p));
  }
  return picture;
}

io::Image positive_part(const Overlay& o, const Differences& d, double white) {
  return part(o, d, white, 1);
}
io::Image negative_part(const Overlay& o, const Differences& d, double white) {
  return part(o, d, white, -1);
}

io::Image signed_map(const Overlay& o, const Differences& d, double white) {
  return paint(o, [&](std::size_t p) {
    return signed_colour(mean_of(d.signed_difference, p, o.channels.size(), false) / white);
  });
}

io::Image log_map(const Overlay& o, const Differences& d, const DisplayTone& tone, double floor) {
  const auto [lower, upper] = tone.log_range;
  return paint(o, [&](std::size_t p) {
    const double v = std::log10(std::max(mean_of(d.signed_difference, p, o.channels.size(), true), floor));
    return magnitude_colour((v - lower) / (upper - lower));
  });
}

io::Image z_map(const Overlay& o, const Differences& d) {
  const double unit = std::sqrt(static_cast<double>(o.channels.size())) / 4;
  return paint(o, [&](std::size_t p) {
    const double z = mean_of(d.z, p, o.channels.size(), false);
    return std::isnan(z) ? not_counted : signed_colour(z * unit);
  });
}

io::Image difference_planes(const Overlay& o, const Differences& d) {
  std::vector<std::string> names;
  for (const auto& channel : o.channels) names.push_back("difference." + channel);
  if (!d.z.empty())
    for (const auto& channel : o.channels) names.push_back("z." + channel);
  io::Image planes(o.width, o.height, names);
  const std::size_t channels = o.channels.size();
  for (std::size_t p = 0; p < planes.pixels(); ++p)
    for (std::size_t c = 0; c < channels; ++c) {
      planes.data[p * names.size() + c] = d.signed_difference[p * channels + c];
      if (!d.z.empty()) planes.data[p * names.size() + channels + c] = d.z[p * channels + c];
    }
  return planes;
}

}  // namespace gonio::metric

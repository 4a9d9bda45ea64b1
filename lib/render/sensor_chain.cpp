#include "render/sensor_chain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "base/error.h"
#include "base/random.h"
#include "camera/intrinsics.h"
#include "geom/vector.h"
#include "manifest/document.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mechanism_use.h"
#include "render/image_seed.h"
#include "render/mosaic.h"
#include "render/sensor_links.h"
#include "scene/mechanisms.h"

namespace gonio::render {
namespace {

using Links = std::vector<double Sensor::*>;  // one per parameter of the mechanism, in its order

const std::map<std::string, Links>& links() {
  static const std::map<std::string, Links> all = {
      {"optics.ghost", {&Sensor::ghost_share}},
      {"optics.veiling-glare", {&Sensor::glare_share}},
      {"sensor.shutter", {&Sensor::shutter_extra_s}},
      {"sensor.crosstalk", {&Sensor::crosstalk_share}},
      {"sensor.prnu", {&Sensor::prnu_sigma}},
      {"sensor.non-linearity", {}},  // response_of()
      {"sensor.row-pattern", {&Sensor::row_amplitude, &Sensor::row_period_px, &Sensor::row_phase_rad}},
      {"sensor.black-offset", {&Sensor::black_offset}},
      {"sensor.saturation", {&Sensor::full_scale}},
      {"sensor.clipped-resampling", {&Sensor::resampled_full_scale, &Sensor::resampling_px}}};
  return all;
}

Response response_of(const std::vector<double>& amounts) {
  ToneBends bends;
  std::copy_n(amounts.begin() + 4, bends.size(), bends.begin());
  return {amounts[0], amounts[2], amounts[1], ToneCurve(slopes_of(amounts[3], bends))};
}

// Knuth's product of uniforms; beyond 50 expected events the rounded normal, whose third moment differs by less than a
// seventh.
double poisson(double expected, Random& random) {
  if (!(expected > 0)) return 0;
  if (expected > 50) return std::max(0.0, std::round(expected + std::sqrt(expected) * random.normal()));
  double product = random.uniform();
  int events = 0;
  for (const double limit = std::exp(-expected); product > limit; ++events) product *= random.uniform();
  return events;
}

io::Image colours(const io::Image& rendered, const std::string& prefix = "") {
  io::Image result(rendered.width, rendered.height, {prefix + "R", prefix + "G", prefix + "B"});
  for (int c = 0; c < 3; ++c) {
    const int from = rendered.channel(result.channels[static_cast<std::size_t>(c)]);
    if (from < 0)
      throw Error(Exit::data, "picture",
                  "has no channel " + result.channels[static_cast<std::size_t>(c)] + " to record",
                  prefix.empty() ? "render in RGB" : "add --stokes");
    for (int y = 0; y < result.height; ++y)
      for (int x = 0; x < result.width; ++x) result.at(x, y, c) = rendered.at(x, y, from);
  }
  return result;
}

void add_ghost(io::Image& image, double share) {
  const io::Image sharp = image;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int c = 0; c < static_cast<int>(image.channels.size()); ++c)
        image.at(x, y, c) = static_cast<float>(
            with_ghost(sharp.at(x, y, c), share, sharp.at(image.width - 1 - x, image.height - 1 - y, c)));
}

void add_glare(io::Image& image, double share) {
  const std::size_t channels = image.channels.size();
  std::vector<double> sums(channels);
  for (std::size_t i = 0; i < image.data.size(); ++i) sums[i % channels] += image.data[i];
  for (std::size_t i = 0; i < image.data.size(); ++i)
    image.data[i] =
        static_cast<float>(with_veil(image.data[i], share, sums[i % channels] / static_cast<double>(image.pixels())));
}

void mix(io::Image& image, double share) {
  for (std::size_t i = 0; i + 2 < image.data.size(); i += 3) {
    const double sum = double{image.data[i]} + image.data[i + 1] + image.data[i + 2];
    for (std::size_t c = 0; c < 3; ++c)
      image.data[i + c] = static_cast<float>(with_crosstalk(image.data[i + c], share, sum));
  }
}

// What optics and filters do, linear in all bands: Stokes planes are treated as the radiance is.
io::Image through_optics(const io::Image& rendered, const Sensor& sensor, const std::string& prefix) {
  io::Image image = colours(rendered, prefix);
  if (sensor.shutter_extra_s != 0 && sensor.exposure_s > 0)
    for (float& v : image.data) v = static_cast<float>(with_shutter(v, sensor.shutter_extra_s, sensor.exposure_s));
  if (sensor.ghost_share != 0) add_ghost(image, sensor.ghost_share);
  if (sensor.glare_share != 0) add_glare(image, sensor.glare_share);
  if (sensor.crosstalk_share != 0) mix(image, sensor.crosstalk_share);
  return image;
}

io::Image joined(const std::array<io::Image, 3>& parts) {
  io::Image result(parts[0].width, parts[0].height, {"R", "G", "B", "s1.R", "s1.G", "s1.B", "s2.R", "s2.G", "s2.B"});
  for (std::size_t i = 0; i < result.pixels(); ++i)
    for (std::size_t p = 0; p < 3; ++p)
      for (std::size_t c = 0; c < 3; ++c) result.data[9 * i + 3 * p + c] = parts[p].data[3 * i + c];
  return result;
}

io::Image behind_filters(const io::Image& rendered, const Sensor& sensor) {
  io::Image image = through_optics(rendered, sensor, "");
  if (sensor.mosaic.empty()) return image;
  if (sensor.mosaic != "polarizers") return bayer_mosaic(image, sensor.mosaic);
  return luminance(polarizer_mosaic(
      joined({std::move(image), through_optics(rendered, sensor, "s1."), through_optics(rendered, sensor, "s2.")})));
}

// One reading; `fixed` belongs to the pixel of this camera, `random` to this picture.
double reading(double v, const Sensor& sensor, int row, Random& fixed, Random& random) {
  if (sensor.prnu_sigma != 0) v = with_fixed_pattern(v, sensor.prnu_sigma, fixed.normal());
  if (sensor.noise.gain > 0) v = poisson(v * sensor.noise.gain, random) / sensor.noise.gain;
  v = sensor.response(v);
  if (sensor.row_amplitude != 0)
    v = with_rows(v, sensor.row_amplitude, sensor.row_period_px, sensor.row_phase_rad, row);
  v += sensor.black_offset + sensor.noise.read * random.normal();
  return with_limit(v, sensor.full_scale);
}

// Beyond the picture's border there is what lies on it.
void resample_clipped(io::Image& image, double full_scale, double width_px) {
  const io::Image native = image;
  const auto reading = [&](int x, int y, int c) {
    return with_limit(native.at(std::clamp(x, 0, image.width - 1), std::clamp(y, 0, image.height - 1), c), full_scale);
  };
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int c = 0; c < static_cast<int>(image.channels.size()); ++c) {
        double sum = 0;
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx)
            sum += resampling_weight(dx, width_px) * resampling_weight(dy, width_px) * reading(x + dx, y + dy, c);
        image.at(x, y, c) = static_cast<float>(sum);
      }
}

}  // namespace

bool in_sensor_chain(const mechanism::Mechanism& mechanism) {
  return links().contains(mechanism.id);
}

Sensor sensor_of(const manifest::Document& document, std::size_t image) {
  const manifest::ImageEntry& entry = document.images.at(image);
  Sensor sensor;
  sensor.camera = entry.camera;
  sensor.mosaic = camera::mosaic_of(document, entry.camera);
  if (entry.noise) sensor.noise = *entry.noise;
  sensor.exposure_s = entry.exposure_s.value_or(0);
  for (const auto& [id, use] : document.mechanisms) {
    const auto link = links().find(id);
    if (link == links().end()) continue;
    const auto amounts = scene::camera_amounts(*mechanism::find_mechanism(id), use, entry.camera,
                                               manifest::place(document, "/mechanisms/" + id));
    if (!amounts) continue;
    if (id == "sensor.non-linearity") sensor.response = response_of(*amounts);
    for (std::size_t i = 0; i < link->second.size(); ++i) sensor.*link->second[i] = (*amounts)[i];
  }
  return sensor;
}

io::Image recorded(const io::Image& rendered, const Sensor& sensor, const std::string& image_id, std::uint64_t seed) {
  const std::uint64_t own_seed = seed_of(seed ^ 0x73656e736f72u, image_id);  // not the numbers that made the rendering
  const std::uint64_t camera_seed = seed_of(0x70726e75u, sensor.camera);
  io::Image image = behind_filters(rendered, sensor);
  const int channels = static_cast<int>(image.channels.size());
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const std::uint64_t pixel =
          static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(image.width) + static_cast<std::uint64_t>(x);
      Random random(own_seed, pixel), fixed(camera_seed, pixel);
      for (int c = 0; c < channels; ++c)
        image.at(x, y, c) = static_cast<float>(reading(image.at(x, y, c), sensor, y, fixed, random));
    }
  if (sensor.resampled_full_scale > 0 && sensor.mosaic.empty())
    resample_clipped(image, sensor.resampled_full_scale, sensor.resampling_px);
  return image;
}

}  // namespace gonio::render

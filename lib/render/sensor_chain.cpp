#include "render/sensor_chain.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/error.h"
#include "camera/intrinsics.h"
#include "camera/mosaic.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mechanism_use.h"
#include "render/image_seed.h"
#include "render/mosaic.h"
#include "render/polarizer_reading.h"
#include "scene/mechanisms.h"

namespace gonio::render {
namespace {

const Link* link_of(const mechanism::Mechanism& mechanism) {
  const auto all = all_links();
  const auto found = std::ranges::find_if(all, [&](const Link* link) { return link->mechanism().id == mechanism.id; });
  return found == all.end() ? nullptr : *found;
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

bool behind_polarizers(const Sensor& sensor) {
  return sensor.mosaic == camera::polarizers;
}

void act(const Sensor& sensor, Step step, io::Image& image) {
  for (const Sensor::Active& active : sensor.links) {
    if (active.link->step != step || (active.link->polarizers != nullptr && behind_polarizers(sensor))) continue;
    if (active.link->lens != nullptr) {
      if (sensor.lens) active.link->lens(active.amounts, *sensor.lens)(image);
      continue;
    }
    if (const OnPicture picture = active.link->picture(active.amounts, sensor.exposure_s)) picture(image);
  }
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

io::Image through_optics(const io::Image& rendered, const Sensor& sensor, const std::string& prefix) {
  io::Image image = colours(rendered, prefix);
  act(sensor, Step::optics, image);
  return image;
}

io::Image behind_filters(const io::Image& rendered, const Sensor& sensor) {
  io::Image image = through_optics(rendered, sensor, "");
  if (sensor.mosaic.empty()) return image;
  if (!behind_polarizers(sensor)) return bayer_mosaic(image, sensor.mosaic);
  photograph::PolarizerArray array;
  for (const Sensor::Active& active : sensor.links)
    if (active.link->polarizers != nullptr) active.link->polarizers(active.amounts, array);
  std::vector<io::Image> parts{std::move(image)};
  for (const char* prefix : {"s1.", "s2.", "s3."})
    if (prefix[1] != '3' || array.retardance_rad != 0) parts.push_back(through_optics(rendered, sensor, prefix));
  return polarizer_reading(parts, array, sensor.lens ? &*sensor.lens : nullptr);
}

// The links that act on single values, bound to their amounts.
class Pixel {
 public:
  explicit Pixel(const Sensor& sensor) : noise_(sensor.noise) {
    for (const Sensor::Active& active : sensor.links) {
      std::vector<OnValue>& step = steps_[static_cast<std::size_t>(active.link->step)];
      if (active.link->value != nullptr) step.push_back(active.link->value(active.amounts));
      if (active.link->timed != nullptr) step.push_back(active.link->timed(active.amounts, sensor.exposure_s));
    }
  }
  // One reading; `random` belongs to this picture.
  double reading(double v, const Site& site, Random& random) const {
    v = through(Step::light, v, site);
    if (noise_.gain > 0) v = poisson(v * noise_.gain, random) / noise_.gain;
    v = through(Step::signal, v, site);
    v += through(Step::dark, noise_.read * random.normal(), site);
    return through(Step::reading, v, site);
  }

 private:
  double through(Step step, double v, const Site& site) const {
    for (const OnValue& link : steps_[static_cast<std::size_t>(step)]) v = link(v, site);
    return v;
  }
  manifest::Noise noise_;
  std::array<std::vector<OnValue>, static_cast<std::size_t>(Step::resampling) + 1> steps_;
};

}  // namespace

bool in_sensor_chain(const mechanism::Mechanism& mechanism) {
  return link_of(mechanism) != nullptr;
}

void Sensor::switch_on(const mechanism::Mechanism& mechanism, std::vector<double> amounts) {
  const Link* link = link_of(mechanism);
  if (link == nullptr) throw Error(Exit::internal, mechanism.id, "is no link of the sensor chain");
  const auto before = [](const Active& a, const Active& b) {
    return std::pair(a.link->step, a.link->order) < std::pair(b.link->step, b.link->order);
  };
  Active active{link, std::move(amounts)};
  links.insert(std::ranges::upper_bound(links, active, before), std::move(active));
}

double Sensor::amount(const mechanism::Mechanism& mechanism, const std::string& parameter) const {
  const auto place = std::ranges::find(mechanism.parameters, parameter, &mechanism::Parameter::name);
  if (place == mechanism.parameters.end()) throw Error(Exit::internal, mechanism.id, "has no parameter " + parameter);
  for (const Active& active : links)
    if (active.link->mechanism().id == mechanism.id)
      return active.amounts[static_cast<std::size_t>(place - mechanism.parameters.begin())];
  return place->neutral;
}

Sensor sensor_of(const manifest::Document& document, std::size_t image) {
  const manifest::ImageEntry& entry = document.images.at(image);
  Sensor sensor;
  sensor.camera = entry.camera;
  sensor.mosaic = camera::mosaic_of(document, entry.camera);
  if (entry.noise) sensor.noise = *entry.noise;
  sensor.exposure_s = entry.exposure_s.value_or(0);
  for (const auto& [id, use] : document.mechanisms) {
    const mechanism::Mechanism* m = mechanism::find_mechanism(id);
    if (m == nullptr || !in_sensor_chain(*m)) continue;
    auto amounts =
        scene::camera_amounts(*m, use, entry.camera, manifest::place(document, "/mechanisms/" + id), entry.id);
    if (!amounts) continue;
    sensor.switch_on(*m, std::move(*amounts));
    if (!sensor.lens)
      sensor.lens.emplace(document.cameras.at(entry.camera), manifest::place(document, "/cameras/" + entry.camera));
  }
  return sensor;
}

io::Image recorded(const io::Image& rendered, const Sensor& sensor, const std::string& image_id, std::uint64_t seed) {
  const std::uint64_t own_seed = seed_of(seed ^ 0x73656e736f72u, image_id);  // not the numbers that made the rendering
  const std::uint64_t camera_seed = seed_of(0x70726e75u, sensor.camera);
  io::Image image = behind_filters(rendered, sensor);
  act(sensor, Step::charge, image);
  const int channels = static_cast<int>(image.channels.size());
  const Pixel bound(sensor);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const std::uint64_t pixel =
          static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(image.width) + static_cast<std::uint64_t>(x);
      Random random(own_seed, pixel), fixed(camera_seed, pixel);
      const Site site{y, fixed};
      for (int c = 0; c < channels; ++c)
        image.at(x, y, c) = static_cast<float>(bound.reading(image.at(x, y, c), site, random));
    }
  if (sensor.mosaic.empty()) act(sensor, Step::resampling, image);
  return image;
}

}  // namespace gonio::render

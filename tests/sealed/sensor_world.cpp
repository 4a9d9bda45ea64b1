// A camera before patches of known or unknown radiance, exposed for a range of times, in sweeps. Readings are means
// over 256 pixels, in DN of a 12-bit converter: electrons from photons, a response that bends as wells fill, an offset,
// a shutter that is slow, a lamp that warms up.
#include <algorithm>
#include <cmath>

#include "geom/vector.h"
#include "sealed/rows_world.h"
#include "sealed/worlds.h"

namespace gonio::sealed {
namespace {

constexpr double electrons_per_dn = 3.2, read_electrons = 9, pixels = 256, full_scale = 4095;

class SensorWorld final : public RowsWorld {
 public:
  std::vector<EffectKind> effects() const override;
  void design(Random& random, const std::string& variant) override;
  Numbers base() const override { return patches_known_ ? Numbers{gain_} : radiance_; }
  Numbers base_steps() const override {
    Numbers s = base();
    for (double& v : s) v *= 1e-3;
    return s;
  }

 protected:
  double reading(const Numbers& base, const Sizes& sizes, std::size_t row) const override;
  double noise_of(double dn) const override {
    const double electrons = std::max(0.0, dn) * electrons_per_dn;
    const double one = std::sqrt(electrons + read_electrons * read_electrons) / electrons_per_dn;
    return std::sqrt((one * one + 1 / 12.0) / pixels +
                     0.02 * 0.02);  // the last: the lamp's own flicker and reading out
  }
  std::string model() const override { return "sensor"; }
  void describe(Value& manifest, Value& table) const override;

 private:
  bool patches_known_ = true;
  double gain_ = 1;
  Numbers radiance_;
  std::vector<std::size_t> patch_;  // of each row
};

std::vector<EffectKind> SensorWorld::effects() const {
  const std::vector<std::string> signal{"image.radiance", "image.exposure", "scene.radiance"}, time{"image.time"},
      sensor{"sensor"}, light{"light"};
  std::vector<EffectKind> k;
  const auto add = [&](EffectKind kind) -> EffectKind& { return k.emplace_back(std::move(kind)); };
  add({"black offset", "sensor.black-offset", sensor, signal, 3, 30}).of_either_sign().means({"offset"});
  add({"bent response", "sensor.non-linearity", sensor, signal, 0.02, 0.08});
  add({"full wells", "sensor.saturation", sensor, signal, 0.05, 0.35}).values = [](const Numbers& s) {
    return std::vector<TrueValue>{{"sensor.saturation", "full_scale", (1 - s[0]) * 0.9 * full_scale}};
  };
  add({"slow shutter", "sensor.shutter", sensor, {"image.exposure"}, 2e-5, 2e-4}).of_either_sign().means({"extra_s"});
  add({"lamp warming up", "light.drift", light, time, 0.02, 0.1}).of_either_sign().means({"amplitude"});
  add({"ambient light", "light.ambient", light, signal, 0.01, 0.05}).only_for("known patches");
  add({"gain with temperature squared", "", sensor, {"image.temperature"}, 4e-4, 2e-3}).of_either_sign();
  add({"beat with the mains", "", light, time, 0.03, 0.08});
  return k;
}

void SensorWorld::design(Random& random, const std::string& variant) {
  const bool one_exposure = variant == "one exposure" || variant == "one exposure, unknown patches";
  patches_known_ = variant == "known patches" || variant == "one exposure" ||
                   (variant != "one exposure, unknown patches" && random.uniform() < 0.5);
  const std::size_t patches = one_exposure ? 24 : 6, exposures = one_exposure ? 1 : 9, sweeps = 5;
  for (std::size_t p = 0; p < patches; ++p)
    radiance_.push_back(12 * std::pow(10, -1.5 * static_cast<double>(p) / static_cast<double>(patches)) *
                        random.uniform(0.95, 1.05));
  const double longest = 0.05;
  gain_ = 0.9 * full_scale / (*std::max_element(radiance_.begin(), radiance_.end()) * longest);
  add_column("exposure_s", "s");
  if (patches_known_)
    add_column("radiance", "W/m^2/sr");
  else
    add_column("patch", "1");
  add_column("time_s", "s");
  add_column("temperature_K", "K");
  add_column("series", "1");
  double clock = 0;
  for (std::size_t s = 0; s < sweeps; ++s) {
    std::vector<std::pair<std::size_t, std::size_t>> order;
    for (std::size_t e = 0; e < exposures; ++e)
      for (std::size_t p = 0; p < patches; ++p) order.emplace_back(e, p);
    if (variant != "exposures in order")
      for (std::size_t k = order.size() - 1; k > 0; --k)
        std::swap(order[k], order[random.below(static_cast<std::uint32_t>(k + 1))]);
    for (const auto& [e, p] : order) {
      clock += random.uniform(6, 9);
      const double exposure = one_exposure ? longest : longest * std::pow(2, -0.7 * static_cast<double>(e));
      const double kelvin = 296 + 6 * std::sin(clock / 900) + random.uniform(-1, 1);
      add_row({exposure, patches_known_ ? radiance_[p] : static_cast<double>(p + 1), clock, kelvin,
               static_cast<double>(s + 1)});
      patch_.push_back(p);
    }
  }
}

double SensorWorld::reading(const Numbers& base, const Sizes& sizes, std::size_t row) const {
  const double exposure = at("exposure_s", row), time = at("time_s", row), warm = at("temperature_K", row) - 296;
  double light = patches_known_ ? radiance_[patch_[row]] : base[patch_[row]];
  light += size_of(sizes, "ambient light") * 12;
  light *= 1 + size_of(sizes, "lamp warming up") * std::exp(-time / 500);
  light *= 1 + size_of(sizes, "beat with the mains") * std::sin(2 * pi * time / 61);
  double dn = (patches_known_ ? base[0] : gain_) * light * (exposure + size_of(sizes, "slow shutter"));
  dn *= 1 + size_of(sizes, "gain with temperature squared") * warm * warm;
  if (const double bend = size_of(sizes, "bent response"); bend != 0)
    dn = full_scale / (2 * bend) * (1 - std::exp(-2 * bend * dn / full_scale));
  dn += size_of(sizes, "black offset");
  if (const double cut = size_of(sizes, "full wells"); cut > 0) {  // each pixel saturates at its own well
    const double well = (1 - cut) * 0.9 * full_scale, spread = 0.003 * well, z = (well - dn) / spread;
    const double below = 0.5 * std::erfc(-z / std::sqrt(2.0)), density = std::exp(-0.5 * z * z) / std::sqrt(2 * pi);
    dn = dn * below + well * (1 - below) - spread * density;
  }
  return dn;
}

void SensorWorld::describe(Value& manifest, Value& table) const {
  table["group"] = "series";
  table["parameters"]["gain"] = patches_known_ ? free_parameter(0.8 * gain_) : Value(gain_);
  manifest["x-instrument"] = "camera before a chart";
}

}  // namespace

std::unique_ptr<World> sensor_world() {
  return std::make_unique<SensorWorld>();
}

}  // namespace gonio::sealed

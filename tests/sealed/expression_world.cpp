// A forward model of a user's own: what a detector on a rail reads, a * radiance * exposure_s, over conditions on which
// the user believes nothing depends: distance, path through a liquid, place in the image, time.
#include <cmath>

#include "geom/vector.h"
#include "sealed/rows_world.h"
#include "sealed/worlds.h"

namespace gonio::sealed {
namespace {

class ExpressionWorld final : public RowsWorld {
 public:
  std::vector<EffectKind> effects() const override;
  void design(Random& random, const std::string& variant) override;
  Numbers base() const override { return {a_}; }
  Numbers base_steps() const override { return {1e-3 * a_}; }

 protected:
  double reading(const Numbers& base, const Sizes& sizes, std::size_t row) const override;
  double noise_of(double v) const override { return std::hypot(relative_ * v, 1e-5 * a_); }
  std::string model() const override { return "expression"; }
  void describe(Value&, Value& table) const override {
    table["expression"] = "a*radiance*exposure_s";
    table["parameters"]["a"] = free_parameter(0.7 * a_);
    table["group"] = "series";
  }

 private:
  double a_ = 1, relative_ = 0.004;
};

std::vector<EffectKind> ExpressionWorld::effects() const {
  const std::vector<std::string> signal{"image.radiance", "image.exposure", "scene.radiance"}, sensor{"sensor"},
      light{"light"}, path{"volume.path-length"};
  std::vector<EffectKind> k;
  const auto add = [&](EffectKind kind) -> EffectKind& { return k.emplace_back(std::move(kind)); };
  add({"vignetting", "optics.vignetting", {"optics"}, {"camera.image-radius"}, 0.05, 0.4}).nearly("falloff");
  add({"turbid liquid", "volume.absorption", {"transport", "volume", "surface"}, path, 1, 8}).nearly("sigma_a_per_m");
  add({"lamp warming up", "light.drift", light, {"image.time"}, 0.02, 0.1}).of_either_sign().means({"amplitude"});
  add({"slow shutter", "sensor.shutter", sensor, {"image.exposure"}, 1e-4, 1e-3}).of_either_sign().means({"extra_s"});
  add({"black offset", "sensor.black-offset", sensor, signal, 0.002, 0.02}).of_either_sign().means({"offset"}, {a_});
  add({"bent response", "sensor.non-linearity", sensor, signal, 0.03, 0.12});
  add({"inverse square", "light.inverse-square", light, {"light.distance"}, 0.3, 1});
  add({"sway of the rail", "", {}, {"light.distance"}, 0.02, 0.06});
  add({"three-halves power of the path", "", {}, path, 2, 8});
  return k;
}

void ExpressionWorld::design(Random& random, const std::string& variant) {
  a_ = random.uniform(0.5, 2);
  relative_ = random.uniform(0.002, 0.006);
  for (const char* name : {"exposure_s", "radiance", "distance_m", "path_m", "image_radius", "time_s", "series"}) {
    const std::string column = name;
    add_column(column, column == "radiance"                             ? "W/m^2/sr"
                       : column == "image_radius" || column == "series" ? "1"
                       : column.ends_with("_m")                         ? "m"
                                                                        : "s");
  }
  const bool stands = variant == "distance stands still";
  double clock = 0;
  for (int series = 0; series < 10; ++series)
    for (int k = 0; k < 30; ++k) {
      clock += random.uniform(2, 5);
      add_row({0.02 * std::pow(2, -static_cast<double>(random.below(6))), random.uniform(5, 50),
               stands ? 0.6 : random.uniform(0.4, 0.9), random.uniform(0.001, 0.03), random.uniform(0, 1.2), clock,
               static_cast<double>(series)});
    }
}

double ExpressionWorld::reading(const Numbers& base, const Sizes& sizes, std::size_t row) const {
  const double exposure = at("exposure_s", row), d = at("distance_m", row), path = at("path_m", row),
               r = at("image_radius", row);
  double v = base[0] * at("radiance", row) * (exposure + size_of(sizes, "slow shutter"));
  v *= 1 + size_of(sizes, "lamp warming up") * std::exp(-at("time_s", row) / 300);
  v *= std::pow(0.6 / d, 2 * size_of(sizes, "inverse square"));
  v *= 1 + size_of(sizes, "sway of the rail") * std::sin(2 * pi * d / 0.05);
  // A band of wavelengths, each with its own coefficient: the mean of exponentials, not the exponential of the mean.
  if (const double k = size_of(sizes, "turbid liquid"); k > 0) {
    double sum = 0;
    for (int band = 0; band < 21; ++band) sum += std::exp(-k * (0.9 + 0.01 * band) * path) / 21;
    v *= sum;
  }
  v *= 1 - size_of(sizes, "three-halves power of the path") * std::pow(path, 1.5) * 10;
  if (const double falloff = size_of(sizes, "vignetting"); falloff > 0) {
    const double cos2 = 1 / (1 + (1 / std::sqrt(1 - falloff) - 1) * r * r);
    v *= cos2 * cos2;
  }
  if (const double bend = size_of(sizes, "bent response"); bend > 0) {
    const double full = a_;
    v = full / (2 * bend) * (1 - std::exp(-2 * bend * v / full));
  }
  return v + size_of(sizes, "black offset") * a_;
}

}  // namespace

std::unique_ptr<World> expression_world() {
  return std::make_unique<ExpressionWorld>();
}

}  // namespace gonio::sealed

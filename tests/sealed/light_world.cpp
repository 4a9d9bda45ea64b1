// A photodiode on a stage under a lamp: irradiance over planes at three heights. Lamps with a size are summed over
// their discs; lamps that were put down elsewhere are where they are.
#include <algorithm>
#include <cmath>

#include "geom/vector.h"
#include "sealed/rows_world.h"
#include "sealed/worlds.h"

namespace gonio::sealed {
namespace {

class LightWorld final : public RowsWorld {
 public:
  std::vector<EffectKind> effects() const override;
  void design(Random& random, const std::string& variant) override;
  Numbers base() const override { return {watt_}; }
  Numbers base_steps() const override { return {1e-3 * watt_}; }

 protected:
  double reading(const Numbers& base, const Sizes& sizes, std::size_t row) const override;
  double noise_of(double v) const override { return std::hypot(relative_ * v, 0.003 * watt_); }
  std::string observed_unit() const override { return "W/m^2"; }
  std::string model() const override { return "light"; }
  void describe(Value& manifest, Value& table) const override;

 private:
  Vec3 lamp_, other_, push_, middle_;  // middle_: of all places of the diode
  double watt_ = 1, relative_ = 0.003;
  bool believes_parallel_ = false;
};

std::vector<EffectKind> LightWorld::effects() const {
  const std::vector<std::string> angle{"light.emission-angle", "light.incidence-angle", "surface.incidence-angle"},
      place{"surface.incidence-angle",
            "light.incidence-angle",
            "light.emission-angle",
            "light.distance",
            "scene.x",
            "scene.y"},
      light{"light"};
  std::vector<EffectKind> k;
  const auto add = [&](EffectKind kind) -> EffectKind& { return k.emplace_back(std::move(kind)); };
  add({"narrow lamp", "light.lobe", light, angle, 0.3, 4}).nearly("exponent");
  add({"lamp elsewhere", "light.position", light, place, 0.005, 0.04});
  add({"room light", "light.ambient", light, {"image.radiance", "light.irradiance"}, 0.02, 0.2});
  add({"lamp warming up", "light.drift", light, {"image.time"}, 0.02, 0.1}).of_either_sign().means({"amplitude"});
  add({"second lamp", "light.second-source", light, place, 0.03, 0.2});
  add({"diverging light",
       "light.inverse-square",
       light,
       {"light.distance", "surface.incidence-angle", "scene.x", "scene.y"},
       1,
       1.0001})
      .only_for("believed parallel");
  add({"dark reading", "sensor.black-offset", {"sensor"}, {"image.radiance"}, 0.02, 0.2}).only_for("a rival");
  add({"rings of a Fresnel lens", "", light, {}, 0.03, 0.1});
  return k;
}

void LightWorld::design(Random& random, const std::string& variant) {
  believes_parallel_ = variant == "believed parallel";
  const double far = believes_parallel_ ? 1.6 : 1;
  lamp_ = {random.uniform(-0.15, 0.15), random.uniform(-0.15, 0.15), far * random.uniform(0.5, 0.8)};
  const double a = random.uniform(0, 2 * pi), b = random.uniform(0, 2 * pi);
  other_ = {0.7 * std::cos(a), 0.7 * std::sin(a), 0.5};
  push_ = {std::cos(b), std::sin(b), 0.3};
  watt_ = random.uniform(1, 5);
  relative_ = random.uniform(0.002, 0.005);
  for (const char* name : {"x_m", "y_m", "z_m"}) add_column(name, "m");
  add_column("time_s", "s");
  add_column("series", "1");
  double clock = 0;
  for (int series = 0; series < 9; ++series)
    for (int k = 0; k < 30; ++k) {
      clock += random.uniform(1, 3);
      add_row({random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4), 0.08 * (series % 3), clock,
               static_cast<double>(series)});
    }
  for (std::size_t r = 0; r < rows(); ++r)
    middle_ += Vec3{at("x_m", r), at("y_m", r), at("z_m", r)} / static_cast<double>(rows());
}

double LightWorld::reading(const Numbers& base, const Sizes& sizes, std::size_t row) const {
  const Vec3 at_diode{at("x_m", row), at("y_m", row), at("z_m", row)};
  // A lamp that is narrower sideways faces the middle of what it lights.
  const auto from = [&](Vec3 lamp, double exponent) {
    const Vec3 to = lamp - at_diode, axis = lamp - middle_;
    const double d2 = dot(to, to), off = dot(to, axis) / std::sqrt(d2 * dot(axis, axis));
    return to.z / std::pow(d2, 1.5) * std::pow(std::max(0.0, off), exponent);
  };
  double e = 0;
  if (believes_parallel_ && size_of(sizes, "diverging light") == 0) {
    const Vec3 to = lamp_ - middle_;
    e = base[0] * to.z / std::pow(dot(to, to), 1.5);
  } else {
    e = base[0] * from(lamp_ + push_ * size_of(sizes, "lamp elsewhere"), size_of(sizes, "narrow lamp"));
  }
  if (const double w = size_of(sizes, "rings of a Fresnel lens"); w > 0) {
    const Vec3 to = lamp_ - at_diode;
    e *= 1 + w * std::sin(2 * pi * std::hypot(to.x, to.y) / 0.07);
  }
  e += base[0] * size_of(sizes, "second lamp") * from(other_, 0);
  e *= 1 + size_of(sizes, "lamp warming up") * std::exp(-at("time_s", row) / 150);
  return e + base[0] * (size_of(sizes, "room light") + size_of(sizes, "dark reading"));
}

void LightWorld::describe(Value& manifest, Value& table) const {
  const auto three = [](Vec3 v) { return Value(std::vector<double>{v.x, v.y, v.z}); };
  Value light = Value::object();
  if (believes_parallel_) {
    light = Value::object({{"model", "directional"}, {"towards", three(lamp_ - middle_)}});
    light["watt_per_m2"] = free_parameter(1);
  } else {
    light = Value::object({{"model", "point"}, {"position_m", three(lamp_)}});
    light["watt_per_sr"] = free_parameter(1);
  }
  manifest["lights"]["l"] = light;
  table["light"] = "l";
  table["group"] = "series";
}

}  // namespace

std::unique_ptr<World> light_world() {
  return std::make_unique<LightWorld>();
}

}  // namespace gonio::sealed

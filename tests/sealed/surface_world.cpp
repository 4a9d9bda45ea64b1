// A goniometer: reflectance of a sample at several incidences, in the plane of incidence and out of it, with a noise in
// proportion to the light and a floor.
#include <cmath>

#include "sealed/matter.h"
#include "sealed/rows_world.h"
#include "sealed/worlds.h"

namespace gonio::sealed {
namespace {

class SurfaceWorld final : public RowsWorld {
 public:
  std::vector<EffectKind> effects() const override;
  void design(Random& random, const std::string& variant) override;
  Numbers base() const override { return {albedo_}; }
  Numbers base_steps() const override { return {1e-3}; }

 protected:
  double reading(const Numbers& base, const Sizes& sizes, std::size_t row) const override;
  double noise_of(double f) const override { return std::hypot(relative_ * f, 2e-4); }
  std::string observed_name() const override { return "f"; }
  std::string observed_unit() const override { return "1/sr"; }
  std::string model() const override { return "surface"; }
  void describe(Value& manifest, Value& table) const override {
    manifest["surfaces"]["s"] = Value::object({{"model", "diffuse"}, {"albedo", free_parameter(0.5)}});
    table["surface"] = "s";
  }

 private:
  double albedo_ = 0.5, relative_ = 0.01, alpha_ = 0.2, direction_ = 0;
};

std::vector<EffectKind> SurfaceWorld::effects() const {
  const std::vector<std::string> angles{"surface.incidence-angle", "surface.exitance-angle", "surface.phase-angle",
                                        "surface.retro-angle"},
      surface{"surface"};
  std::vector<EffectKind> k;
  const auto add = [&](EffectKind kind) -> EffectKind& { return k.emplace_back(std::move(kind)); };
  add({"clear coat", "surface.interface", surface, {"surface.half-angle"}, 0.02, 0.07}).nearly("f0");
  add({"rough matte", "surface.diffuse-roughness", surface, angles, 0.15, 0.5}).nearly("sigma_rad");
  add({"sent back to the lamp",
       "surface.retro-reflection",
       surface,
       {"surface.phase-angle", "surface.retro-angle"},
       0.02,
       0.15});
  add({"tile that is no Lambertian one", "reference.tile", {"reference", "surface", "sensor"}, angles, 0.05, 0.3});
  add({"uneven goniometer", "", {}, {}, 0.05, 0.15});
  return k;
}

void SurfaceWorld::design(Random& random, const std::string& variant) {
  albedo_ = random.uniform(0.15, 0.7);
  relative_ = random.uniform(0.005, 0.02);
  alpha_ = random.uniform(0.1, 0.3);
  direction_ = random.uniform(0, pi);
  for (const char* name : {"theta_i", "phi_i", "theta_o", "phi_o"}) add_column(name, "rad");
  add_column("series", "1");
  const bool normal_only = variant == "normal incidence";
  for (int series = 0; series < 8; ++series) {
    const double incidence = normal_only ? 0.02 * series : pi / 180 * (5 + 9.5 * series);
    for (int k = 0; k < 36; ++k) {
      const bool in_plane = k < 24;
      const double theta = in_plane ? pi / 180 * std::abs(-72 + 6.3 * k) : pi / 180 * (6 + 6 * (k - 24));
      const double phi = in_plane ? (k < 12 ? 0.0 : pi) : 0.5 * pi + 0.2 * std::sin(3.0 * k);
      add_row({incidence, 0, theta + 0.002 * random.normal(), phi, static_cast<double>(series)});
    }
  }
}

double SurfaceWorld::reading(const Numbers& base, const Sizes& sizes, std::size_t row) const {
  const auto towards = [](double theta, double phi) {
    return Vec3{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
  };
  const double incidence = at("theta_i", row), exitance = at("theta_o", row);
  Matter m;
  m.f0 = size_of(sizes, "clear coat"), m.alpha = alpha_;
  m.slope_rad = size_of(sizes, "rough matte");
  m.retro = size_of(sizes, "sent back to the lamp");
  m.albedo = {base[0], base[0], base[0]};
  const Scattering f =
      scatter(m, {0, 0, 1}, {1, 0, 0}, towards(incidence, at("phi_i", row)), towards(exitance, at("phi_o", row)));
  double value = base[0] * f.base.x + f.coat;
  // White tiles lose light at grazing incidence; everything measured against them gains.
  value /= 1 - size_of(sizes, "tile that is no Lambertian one") * std::pow(std::sin(incidence), 4);
  return value * (1 + size_of(sizes, "uneven goniometer") * std::sin(9 * exitance + direction_));
}

}  // namespace

std::unique_ptr<World> surface_world() {
  return std::make_unique<SurfaceWorld>();
}

}  // namespace gonio::sealed

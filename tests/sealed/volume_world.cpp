// A plate between a lamp and a detector, turned and exchanged for thicker ones: light is followed through face after
// face until nothing is left of it, wavelength by wavelength over the detector's band.
#include <cmath>

#include "geom/vector.h"
#include "sealed/matter.h"
#include "sealed/rows_world.h"
#include "sealed/worlds.h"

namespace gonio::sealed {
namespace {

constexpr double believed_index = 1.5;

class VolumeWorld final : public RowsWorld {
 public:
  std::vector<EffectKind> effects() const override {
    const std::vector<std::string> inside{"transport", "volume", "surface"}, path{"volume.path-length"},
        angle{"surface.incidence-angle"};
    std::vector<EffectKind> k;
    const auto add = [&](EffectKind kind) -> EffectKind& { return k.emplace_back(std::move(kind)); };
    add({"absorbing glass", "volume.absorption", inside, path, 1, 10}).nearly("sigma_a_per_m");
    add({"other glass", "volume.index", inside, angle, 0.04, 0.25}).means({"shift"});
    add({"lamp warming up", "light.drift", {"light"}, {"image.time"}, 0.02, 0.1}).of_either_sign().means({"amplitude"});
    add({"dark reading", "sensor.black-offset", {"sensor"}, {"image.radiance"}, 0.02, 0.08}).means({"offset"});
    add({"fringes", "", {}, {"surface.incidence-angle", "volume.path-length"}, 0.02, 0.06});
    return k;
  }
  void design(Random& random, const std::string&) override {
    relative_ = random.uniform(0.0015, 0.004);
    gain_ = random.uniform(0.9, 1.1);
    for (const auto& [name, unit] : {std::pair{"theta_i", "rad"}, {"path_m", "m"}, {"time_s", "s"}, {"series", "1"}})
      add_column(name, unit);
    double clock = 0;
    for (int series = 0; series < 10; ++series)
      for (int k = 0; k < 24; ++k) {
        clock += random.uniform(3, 6);
        const double theta = random.uniform(0, 1.3), thickness = random.uniform(0.001, 0.02);
        const double sine = std::sin(theta) / believed_index;
        add_row({theta, thickness / std::sqrt(1 - sine * sine), clock, static_cast<double>(series)});
      }
  }
  Numbers base() const override { return {gain_}; }
  Numbers base_steps() const override { return {1e-3}; }

 protected:
  double reading(const Numbers& base, const Sizes& sizes, std::size_t row) const override {
    const double index = believed_index + size_of(sizes, "other glass");
    const double root_f0 = (index - 1) / (index + 1), theta = at("theta_i", row), path = at("path_m", row);
    const double reflected = fresnel(std::cos(theta), root_f0 * root_f0), k = size_of(sizes, "absorbing glass");
    double sum = 0;
    for (int band = 0; band < 11; ++band) {
      const double through = std::exp(-k * (0.9 + 0.02 * band) * path);
      double inside = 1 - reflected;
      for (int face = 0; face < 40; ++face) {  // there and back
        inside *= through;
        if (face % 2 == 0) sum += inside * (1 - reflected) / 11;
        inside *= reflected;
      }
    }
    double v = base[0] * sum * (1 + size_of(sizes, "lamp warming up") * std::exp(-at("time_s", row) / 300));
    v *= 1 + size_of(sizes, "fringes") * std::sin(60 * theta * theta);
    return v + size_of(sizes, "dark reading");
  }
  double noise_of(double v) const override { return std::hypot(relative_ * v, 5e-4); }
  std::string model() const override { return "volume"; }
  void describe(Value&, Value& table) const override {
    table["parameters"]["gain"] = free_parameter(1);
    table["parameters"]["eta"] = believed_index;
    table["group"] = "series";
  }

 private:
  double gain_ = 1, relative_ = 0.002;
};

}  // namespace

std::unique_ptr<World> volume_world() {
  return std::make_unique<VolumeWorld>();
}

}  // namespace gonio::sealed

// Stacks of pictures without geometry. Exposures: a static scene of patches and gradients over two and a half decades,
// recorded for eight times. Photometric: a bumpy relief under fourteen distant lamps.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/text.h"
#include "geom/vector.h"
#include "io/exr.h"
#include "sealed/camera_chain.h"
#include "sealed/matter.h"
#include "sealed/recording.h"
#include "sealed/worlds.h"

namespace gonio::sealed {
namespace {

constexpr int side = 64;
constexpr std::size_t area = side * side;

class StackWorld : public World {
 public:
  Numbers base() const override { return {}; }
  Numbers base_steps() const override { return {}; }
  std::vector<std::size_t> strata() const override {
    std::vector<std::size_t> s(count() * area);
    for (std::size_t i = 0; i < s.size(); ++i) s[i] = i % area;
    return s;
  }
  Numbers sigma(const Numbers& clean) const override {
    Numbers s(clean.size());
    for (std::size_t i = 0; i < s.size(); ++i) s[i] = noise_sigma(sensor_, clean[i]);
    return s;
  }
  Numbers noisy(const Numbers& clean, Random& random) const override {
    Numbers values = clean;
    expose(sensor_, values, area, random);
    return values;
  }
  Numbers norm(const Numbers& observed) const override {
    Numbers n(observed.size());
    for (std::size_t i = 0; i < n.size(); ++i) n[i] = observed[i] * observed[i];
    return n;
  }
  bool relative() const override { return true; }
  bool knows_floor() const override { return false; }  // sites are means over several pixels
  void locate(const Numbers& surviving, const Numbers&, Case& into) const override {
    for (std::size_t k = 0; k < count(); ++k) {
      std::vector<float>& map = into.pixels[image_id(k)];
      for (std::size_t p = 0; p < area; ++p) map.push_back(static_cast<float>(std::abs(surviving[k * area + p])));
    }
  }
  void write(const Numbers& observed, const Numbers& stated, Case& into) const override {
    const double misstated = stated[0] / noise_sigma(sensor_, simulate({}, {})[0]);
    Value m = Value::object(), images = Value::array();
    for (std::size_t k = 0; k < count(); ++k) {
      io::Image picture(side, side, {"Y"});
      for (std::size_t p = 0; p < area; ++p) picture.data[p] = static_cast<float>(observed[k * area + p]);
      into.files[image_id(k) + ".exr"] = io::encode_exr(picture);
      Value image = Value::object({{"id", image_id(k)}, {"file", image_id(k)}, {"camera", "c"}});
      describe(k, image);
      image["response"] = "linear";
      image["noise"] =
          Value::object({{"gain", sensor_.gain / (misstated * misstated)}, {"read", sensor_.read * misstated}});
      images.push_back(image);
    }
    m["cameras"]["c"] = Value::object({{"model", "pinhole"},
                                       {"width_px", side},
                                       {"height_px", side},
                                       {"fx_px", 400},
                                       {"fy_px", 400},
                                       {"cx_px", 0.5 * (side - 1)},
                                       {"cy_px", 0.5 * (side - 1)}});
    lights(m);
    m["images"] = images;
    finish(m, into);
  }

 protected:
  virtual std::size_t count() const = 0;
  virtual void describe(std::size_t k, Value& image) const = 0;
  virtual void lights(Value&) const {}
  static std::string image_id(std::size_t k) { return format("image_%02zu", k); }
  Sensor sensor_;
};

class Exposures final : public StackWorld {
 public:
  std::vector<EffectKind> effects() const override {
    const std::vector<std::string> signal{"image.radiance", "image.exposure", "image.reading"}, sensor{"sensor"};
    std::vector<EffectKind> k;
    const auto add = [&](EffectKind kind) -> EffectKind& { return k.emplace_back(std::move(kind)); };
    add({"film", "sensor.non-linearity", sensor, signal, 0.1, 0.5});
    add({"bent response", "sensor.non-linearity", sensor, signal, 0.02, 0.1});
    add({"black offset", "sensor.black-offset", sensor, signal, 0.004, 0.03}).means({"offset"});
    add({"full wells", "sensor.saturation", sensor, signal, 0.1, 0.5}).values = [](const Numbers& s) {
      return std::vector<TrueValue>{{"sensor.saturation", "full_scale", 1 - s[0]}};
    };
    add({"slow shutter", "sensor.shutter", sensor, {"image.exposure"}, 1e-4, 1e-3}).of_either_sign().means({"extra_s"});
    add({"lamp warming up", "light.drift", {"light"}, {"image.time"}, 0.03, 0.12})
        .of_either_sign()
        .means({"amplitude"});
    add({"glare", "optics.veiling-glare", {"optics"}, signal, 0.01, 0.1}).only_for("where asked");
    add({"reciprocity failure", "", sensor, {"image.exposure"}, 0.03, 0.12});
    return k;
  }
  void design(Random& random, const std::string&) override {
    sensor_ = {.gain = 30000, .read = 4e-4, .pattern = 2e-3, .white = 1, .seed = random.next()};
    std::array<double, 16> patch{};
    for (double& p : patch) p = std::pow(10, -2.5 * random.uniform());
    double brightest = 0;
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const double level = patch[static_cast<std::size_t>(4 * (y / 16) + x / 16)];
        radiance_.push_back(level * (1 + 0.1 * std::sin(0.2 * x + 0.1 * y)));
        brightest = std::max(brightest, radiance_.back());
      }
    double clock = 0;
    for (int k = 0; k < 9; ++k) exposure_.push_back(0.1 * std::pow(2, -static_cast<double>(k) * 0.8));
    for (std::size_t k = exposure_.size() - 1; k > 0; --k)
      std::swap(exposure_[k], exposure_[random.below(static_cast<std::uint32_t>(k + 1))]);
    for (std::size_t k = 0; k < exposure_.size(); ++k) time_.push_back(clock += random.uniform(20, 40));
    for (double& r : radiance_) r *= 0.95 / (brightest * 0.1);
  }
  std::vector<Numbers> own_columns() const override { return {simulate({}, {})}; }
  Numbers simulate(const Numbers&, const Sizes& sizes) const override {
    Numbers all;
    double mean = 0;
    for (const double r : radiance_) mean += r / static_cast<double>(area);
    for (std::size_t k = 0; k < exposure_.size(); ++k) {
      double light = exposure_[k] + size_of(sizes, "slow shutter");
      light *= 1 + size_of(sizes, "lamp warming up") * std::exp(-time_[k] / 90);
      light *= std::pow(exposure_[k] / 0.1, -size_of(sizes, "reciprocity failure"));
      for (const double r : radiance_) {
        double v = (r + size_of(sizes, "glare") * mean) * light;
        if (const double bend = size_of(sizes, "bent response"); bend > 0)
          v = (1 - std::exp(-2 * bend * v)) / (2 * bend);
        if (const double film = size_of(sizes, "film"); film > 0)  // straight in the middle, a toe and a shoulder
          v = std::pow(v, 1 - film) / (std::pow(v, 1 - film) + std::pow(0.35, 1 - film)) *
              (1 + std::pow(0.35, 1 - film));
        v += size_of(sizes, "black offset");
        if (const double cut = size_of(sizes, "full wells"); cut > 0) v = std::min(v, 1 - cut);
        all.push_back(v);
      }
    }
    return all;
  }

 protected:
  std::size_t count() const override { return exposure_.size(); }
  void describe(std::size_t k, Value& image) const override {
    image["exposure_s"] = exposure_[k];
    image["time_s"] = time_[k];
  }

 private:
  Numbers radiance_, exposure_, time_;
};

class Photometric final : public StackWorld {
 public:
  std::vector<EffectKind> effects() const override {
    const std::vector<std::string> bright{"image.radiance"}, surface{"surface"}, sensor{"sensor"}, light{"light"},
        angles{"surface.incidence-angle", "surface.exitance-angle", "surface.phase-angle"},
        gloss{"surface.half-angle", "image.radiance"};
    std::vector<EffectKind> k;
    const auto add = [&](EffectKind kind) -> EffectKind& { return k.emplace_back(std::move(kind)); };
    add({"clear coat", "surface.interface", surface, gloss, 0.02, 0.06}).nearly("f0");
    add({"rough matte", "surface.diffuse-roughness", surface, angles, 0.2, 0.6});
    add({"lamps elsewhere", "light.direction", light, {"light.identity", "surface.incidence-angle"}, 0.02, 0.1});
    add({"ambient light",
         "light.ambient",
         light,
         {"image.radiance", "scene.ambient-visibility", "surface.incidence-angle"},
         0.01,
         0.06});
    add({"bent response", "sensor.non-linearity", sensor, bright, 0.05, 0.2});
    add({"black offset", "sensor.black-offset", sensor, bright, 0.005, 0.03}).means({"offset"});
    add({"vignetting", "optics.vignetting", {"optics"}, {"camera.image-radius"}, 0.1, 0.4}).only_for("where asked");
    add({"shadow of a wire", "", light, {}, 0.15, 0.5});
    return k;
  }
  void design(Random& random, const std::string&) override {
    sensor_ = {.gain = 20000, .read = 5e-4, .pattern = 2e-3, .white = 1, .seed = random.next()};
    const double a = random.uniform(0.2, 0.5), b = random.uniform(0.15, 0.3);
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const double u = (x - 31.5) / 36, v = (y - 31.5) / 36;
        normal_.push_back(normalized({a * std::sin(5 * u) + 0.6 * u, b * std::cos(6 * v) + 0.6 * v, 1}));
        albedo_.push_back((x / 16 + y / 16) % 2 == 0 ? 0.7 : 0.45);
      }
    for (int k = 0; k < 14; ++k) {
      const double tilt = random.uniform(0.25, 0.95), around = 2 * pi * (k + random.uniform(0, 0.7)) / 14;
      towards_.push_back({std::sin(tilt) * std::cos(around), std::sin(tilt) * std::sin(around), std::cos(tilt)});
      off_.push_back(normalized({random.normal(), random.normal(), 0.2 * random.normal()}));
    }
  }
  std::vector<Numbers> own_columns() const override {
    std::vector<Numbers> own(3);
    for (const Vec3 l : towards_)
      for (const Vec3 n : normal_)
        for (int c = 0; c < 3; ++c) own[static_cast<std::size_t>(c)].push_back(dot(n, l) > 0 ? l[c] : 0);
    return own;
  }
  Numbers simulate(const Numbers&, const Sizes& sizes) const override {
    Matter m;
    m.f0 = size_of(sizes, "clear coat"), m.alpha = 0.2, m.slope_rad = size_of(sizes, "rough matte");
    const Vec3 eye{0, 0, 1};
    Numbers all;
    for (std::size_t k = 0; k < towards_.size(); ++k) {
      const Vec3 l = normalized(towards_[k] + off_[k] * size_of(sizes, "lamps elsewhere"));
      for (std::size_t p = 0; p < area; ++p) {
        const double cosine = dot(normal_[p], l);
        double v = 0;
        if (cosine > 0) {
          m.albedo = {albedo_[p], albedo_[p], albedo_[p]};
          const Vec3 x = normalized(cross(normal_[p], Vec3{0.3, 1, 0.2}));
          const Scattering f = scatter(m, normal_[p], x, l, eye);
          v = pi * (albedo_[p] * f.base.x + f.coat) * cosine;
        }
        if (const double depth = size_of(sizes, "shadow of a wire"); depth > 0) {  // falls elsewhere for each lamp
          const double across =
              static_cast<double>(p % side) - 0.3 * static_cast<double>(p / side) - 22 + 18 * l.x / l.z;
          v *= 1 - depth * std::exp(-0.5 * across * across / 6);
        }
        v += albedo_[p] * size_of(sizes, "ambient light") * 0.5 * (1 + normal_[p].z);
        if (const double falloff = size_of(sizes, "vignetting"); falloff > 0) {
          const double u = (static_cast<double>(p % side) - 31.5) / 32, w = (static_cast<double>(p / side) - 31.5) / 32;
          v *= 1 - falloff * (u * u + w * w);
        }
        if (const double bend = size_of(sizes, "bent response"); bend > 0)
          v = (1 - std::exp(-2 * bend * v)) / (2 * bend);
        all.push_back(v + size_of(sizes, "black offset"));
      }
    }
    return all;
  }

 protected:
  std::size_t count() const override { return towards_.size(); }
  void describe(std::size_t k, Value& image) const override { image["light"] = format("light-%02zu", k); }
  void lights(Value& m) const override {
    for (std::size_t k = 0; k < towards_.size(); ++k)
      m["lights"][format("light-%02zu", k)] =
          Value::object({{"model", "directional"},
                         {"towards", Value(std::vector<double>{towards_[k].x, towards_[k].y, towards_[k].z})},
                         {"watt_per_m2", Value(std::vector<double>{pi, pi, pi})}});
  }

 private:
  std::vector<Vec3> normal_, towards_, off_;
  Numbers albedo_;
};

}  // namespace

std::unique_ptr<World> exposures_world() {
  return std::make_unique<Exposures>();
}
std::unique_ptr<World> photometric_world() {
  return std::make_unique<Photometric>();
}

}  // namespace gonio::sealed

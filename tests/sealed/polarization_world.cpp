// Mosaic photographs of a ball of metal and one of black glass between a polarized screen and an unpolarized panel, by
// coherency matrices (coherent_light.h), in three wavelengths: three views, each with both lamps on and with the screen
// alone. Designs "even light" (as always: the light of a sample and of those beside it is alike, and crosstalk is a
// leak of twice its share) and "screen alone" (the balls are too small to tell how their light swings).
#include <algorithm>
#include <array>
#include <cmath>

#include "base/text.h"
#include "io/exr.h"
#include "sealed/camera_chain.h"
#include "sealed/mirror_stage.h"
#include "sealed/recording.h"
#include "sealed/traced_scene.h"
#include "sealed/worlds.h"

namespace gonio::sealed {
namespace {

constexpr int size = 64, across = 3;
constexpr double focal = 100;
constexpr std::size_t views = 3, states = 2, pixels = size * size;

class Polarization final : public World {
 public:
  std::vector<EffectKind> effects() const override {
    std::vector<EffectKind> k;
    const auto add = [&](EffectKind kind) -> EffectKind& { return k.emplace_back(std::move(kind)); };
    const std::vector<std::string> sensor{"sensor"}, light{"light"}, surface{"surface"};
    add({"leaky polarizers", "polarizer.leak", sensor, {"light.polarized-part", "sensor.neighbours"}, 0.01, 0.08})
        .only_for("even light")
        .values = [](const Numbers& size) {
      return std::vector<TrueValue>{{"polarizer.leak", "leak", size[0], false}};
    };
    add({"turned polarizers", "polarizer.angle", sensor, {"light.polarized-across"}, 0.01, 0.07})
        .of_either_sign()
        .means({"turn_rad"});
    add({"uneven polarizers", "polarizer.angle", sensor, {"light.polarized-across"}, 0.006, 0.03})
        .of_either_sign()
        .of_parts(3)
        .means({"turn_45_rad", "turn_90_rad", "turn_135_rad"});
    add({"crosstalk", "sensor.crosstalk", sensor, {"sensor.neighbours", "light.polarized-part"}, 0.004, 0.03})
        .only_for("even light")
        .nearly("share");
    add({"stressed lens", "lens.birefringence", {"optics"}, {"camera.image-radius"}, 0.25, 1.2})
        .of_either_sign()
        .as_drawn()
        .means({"retardance_rad"});
    add({"veil of the lens", "optics.veiling-glare", {"optics"}, {"image.mean", "image.radiance"}, 0.01, 0.08})
        .means({"share"});
    add({"leaky screen", "screen.leak", light, {"screen.polarized-part"}, 0.01, 0.15}).means({"leak"});
    add({"turned screen", "screen.angle", light, {"screen.polarized-across"}, 0.015, 0.1})
        .of_either_sign()
        .means({"turn_rad"});
    add({"rough metal", "surface.roughness", surface, {"surface.depolarized", "surface.incidence-angle"}, 0.05, 0.2})
        .as_drawn()
        .means({"more"});
    add({"coated metal", "surface.coating", surface, {"surface.incidence-angle", "surface.depolarized"}, 30e-9, 130e-9})
        .as_drawn()
        .nearly("film_m");
    add({"dichroic lens", "", {}, {}, 0.05, 0.2}).of_either_sign();
    add({"dull polarizer", "", {}, {}, 0.01, 0.05});
    return k;
  }

  void design(Random& random, const std::string& variant) override {
    const double around = random.uniform(0, 2 * pi);
    const auto at = [](double azimuth, double out, double z) {
      return Vec3{out * std::cos(azimuth), out * std::sin(azimuth), z};
    };
    const bool alone = variant == "screen alone";
    for (std::size_t b = 0; b < 2; ++b) {
      MirrorBall& ball = stage_.balls[b];
      ball.radius = alone ? 0.008 : random.uniform(0.055, 0.065);
      ball.centre = at(around + (b == 0 ? 1.2 : 1.2 + pi), random.uniform(0.066, 0.072), 0);
    }
    metal_ = {random.uniform(0.9, 2.2), random.uniform(4, 6.5)}, glass_ = random.uniform(1.48, 1.6);
    for (std::size_t w = 0; w < wavelengths.size(); ++w) {
      const double off = static_cast<double>(w) - 1;
      stage_.balls[0].mirror[w].index = metal_ + Complex(0.05, 0.15) * off;
      stage_.balls[1].mirror[w].index = glass_ - 0.004 * off;
    }
    stage_.screen = facing(at(around, 0.36, random.uniform(0, 0.06)), random.uniform(0.16, 0.22));
    stage_.screen.degree = random.uniform(0.96, 1), stage_.screen.angle = random.uniform(-1.5, 1.5);
    stage_.panel =
        facing(at(around + random.uniform(2.2, 2.8), 0.36, random.uniform(0.1, 0.2)), random.uniform(0.16, 0.22));
    stage_.panel.radiance = random.uniform(0.5, 1.2);
    const std::array<double, views> azimuths = {around + random.uniform(1.1, 1.4), around + random.uniform(2.9, 3.3),
                                                around + random.uniform(4.8, 5.1)};
    for (const double azimuth : azimuths) {
      const Vec3 target = alone ? stage_.screen.centre : Vec3{};
      eyes_.push_back(
          eye_at(at(alone ? around + pi + 0.4 * (azimuth - around - pi) : azimuth, 0.42, random.uniform(0.05, 0.2)),
                 target, focal, size));
    }
    exposure_ = random.uniform(0.9, 1.1);
    for (double& e : own_) e = 1 + 0.003 * random.normal();
    sensor_.gain = 8000, sensor_.read = 3e-4, sensor_.white = 1.2, sensor_.seed = random.next();
    draws_ = random.next();
  }

  Numbers base() const override { return {0}; }
  Numbers base_steps() const override { return {1}; }
  std::vector<Numbers> base_columns() const override {
    const Numbers clean = simulate({}, {});
    std::vector<Numbers> columns{clean};
    for (std::size_t p = 0; p < views * states; ++p) {
      Numbers& own = columns.emplace_back(clean.size(), 0.0);
      std::copy_n(clean.begin() + static_cast<std::ptrdiff_t>(p * pixels), pixels,
                  own.begin() + static_cast<std::ptrdiff_t>(p * pixels));
    }
    columns.erase(columns.begin());  // the sum of the others
    return columns;
  }
  Numbers simulate(const Numbers&, const Sizes& sizes) const override {
    for (const auto& [known, all] : simulated_)
      if (known == sizes) return all;
    MirrorStage stage = stage_;
    bend(stage, sizes);
    Numbers all;
    for (std::size_t p = 0; p < views * states; ++p) {
      const Numbers one = picture(stage, p);
      all.insert(all.end(), one.begin(), one.end());
    }
    simulated_.emplace_back(sizes, std::move(all));
    return simulated_.back().second;
  }
  Numbers sigma(const Numbers& clean) const override {
    Numbers s(clean.size());
    for (std::size_t i = 0; i < s.size(); ++i) s[i] = noise_sigma(sensor_, clean[i]);
    return s;
  }
  Numbers noisy(const Numbers& clean, Random& random) const override {
    Numbers values = clean;
    expose(sensor_, values, pixels, random);
    return values;
  }
  Numbers norm(const Numbers& observed) const override {
    Numbers n(observed.size());
    for (std::size_t i = 0; i < n.size(); ++i) n[i] = observed[i] * observed[i];
    return n;
  }
  bool relative() const override { return true; }
  bool asks_rivals() const override { return false; }
  bool knows_floor() const override { return false; }  // tiles of it are asked, whose light is even
  void locate(const Numbers&, const Numbers&, Case&) const override {}
  void write(const Numbers& observed, const Numbers& stated, Case& into) const override;

 private:
  static Display facing(Vec3 centre, double half) {
    Display d;
    d.centre = centre, d.half = half, d.out = normalized(centre * -1.0);
    d.up = normalized(Vec3{0, 0, 1} - d.out * d.out.z), d.right = cross(d.up, d.out);
    return d;
  }
  static void bend(MirrorStage& stage, const Sizes& sizes) {
    MosaicCamera& c = stage.camera;
    c.leak = size_of(sizes, "leaky polarizers"), c.share = size_of(sizes, "crosstalk");
    c.retardance = size_of(sizes, "stressed lens"), c.dichroism = size_of(sizes, "dichroic lens");
    c.veil = size_of(sizes, "veil of the lens"), c.dull = size_of(sizes, "dull polarizer");
    const double all = size_of(sizes, "turned polarizers");
    const auto own = [&](std::size_t part) {
      return all + (sizes.contains("uneven polarizers") ? size_of(sizes, "uneven polarizers", part) : 0);
    };
    c.axis = {pi / 2 + own(1), pi / 4 + own(0), 3 * pi / 4 + own(2), all};
    const double leak = size_of(sizes, "leaky screen");
    stage.screen.degree *= (1 - leak) / (1 + leak);
    stage.screen.angle += size_of(sizes, "turned screen");
    stage.balls[0].alpha = size_of(sizes, "rough metal");
    for (Mirror& mirror : stage.balls[0].mirror) mirror.film_m = size_of(sizes, "coated metal");
  }

  // Before light goes to the samples beside.
  double sample(const MirrorStage& stage, std::size_t p, int x, int y, Random& random) const {
    const Eye& eye = eyes_[p / states];
    const MosaicCamera& c = stage.camera;
    const double axis = c.axis[static_cast<std::size_t>(2 * (y % 2) + x % 2)], middle = 0.5 * (size - 1);
    const int ways = stage.balls[0].alpha > 0 ? 1 : across;
    double total = 0;
    for (std::size_t band = 0; band < wavelengths.size(); ++band) {
      const Follower follower(stage, p % states == 0, band, random);
      for (int k = 0; k < ways * ways; ++k) {
        const double u = x - 0.5 + (k % ways + 0.5) / ways, v = y - 0.5 + (k / ways + 0.5) / ways;
        const Vec3 way =
            normalized(eye.right * ((u - middle) / focal) + eye.down * ((v - middle) / focal) + eye.forward);
        const Coherency light = follower.from(eye.position, way, 0);
        total += read(c, light, eye.right, way, axis, (u - middle) / (size / 2.0), (v - middle) / (size / 2.0));
      }
    }
    const double v = total / (static_cast<double>(wavelengths.size()) * ways * ways);
    return axis == c.axis[1] ? v * (1 - c.dull) : v;
  }
  // What a sample reads of light that arrives along -way.
  static double read(const MosaicCamera& c, const Coherency& light, Vec3 right, Vec3 way, double axis, double u,
                     double v) {
    const Vec3 x = normalized(right - way * dot(right, way)), y = cross(way * -1.0, x);
    const double late = c.retardance * (u * u + v * v), length = std::hypot(u, v);
    const Vec3 out = length > 0 ? x * (u / length) - y * (v / length) : x, beside = cross(way * -1.0, out);
    // The lens takes E to L E; a sample that sees a* E sees (L* a)* of what came before.
    const auto before_lens = [&](double angle) {
      const Vec3 a = x * std::cos(angle) + y * std::sin(angle);
      const Complex o = dot(a, out) * std::exp(Complex(0, -late)), b = dot(a, beside);
      return Field{o * out.x + b * beside.x, o * out.y + b * beside.y, o * out.z + b * beside.z};
    };
    double value = light.along(before_lens(axis)) + c.leak * light.along(before_lens(axis + pi / 2));
    if (c.dichroism != 0) {  // circular light of one hand is passed better
      const Complex i(0, 1);
      const double root = std::sqrt(0.5);
      const auto hand = [&](double sign) {
        return Field{root * (x.x + sign * i * y.x), root * (x.y + sign * i * y.y), root * (x.z + sign * i * y.z)};
      };
      value += 0.5 * c.dichroism * (light.along(hand(1)) - light.along(hand(-1)));
    }
    return value;
  }
  Numbers picture(const MirrorStage& stage, std::size_t p) const {
    Numbers own(pixels);
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        const auto i = static_cast<std::size_t>(y * size + x);
        Random random(draws_, p * pixels + i);
        own[i] = exposure_ * own_[p] * sample(stage, p, x, y, random);
      }
    // Light that runs to and fro in the lens keeps its polarization: behind each polarizer it is that of the picture.
    for (const int filter : {0, 1, 2, 3}) {
      const auto of_filter = [&](std::size_t i) {
        return static_cast<int>(2 * (i / size % 2) + i % size % 2) == filter;
      };
      double sum = 0;
      for (std::size_t i = 0; i < pixels; ++i) sum += of_filter(i) ? own[i] : 0;
      for (std::size_t i = 0; i < pixels; ++i)
        if (of_filter(i)) own[i] += stage.camera.veil * sum / (pixels / 4);
    }
    if (stage.camera.share == 0) return own;
    // Charge walks: to those beside, and on from there.
    Numbers walked = own;
    for (int hop = 0; hop < 2; ++hop) {
      const Numbers now = walked;
      const double share = 0.5 * stage.camera.share;
      for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
          double& to = walked[static_cast<std::size_t>(y * size + x)];
          for (const auto& [a, b] : {std::array{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
            if (x + a >= 0 && y + b >= 0 && x + a < size && y + b < size)
              to += share * (now[static_cast<std::size_t>((y + b) * size + x + a)] -
                             now[static_cast<std::size_t>(y * size + x)]);
        }
    }
    return walked;
  }

  MirrorStage stage_;
  std::vector<Eye> eyes_;
  Complex metal_;
  double glass_ = 1.5, exposure_ = 1;
  std::array<double, views * states> own_{};
  Sensor sensor_;
  std::uint64_t draws_ = 0;
  mutable std::vector<std::pair<Sizes, Numbers>> simulated_;
};

Value three(Vec3 v) {
  return Value(std::vector<double>{v.x, v.y, v.z});
}

void Polarization::write(const Numbers& observed, const Numbers& stated, Case& into) const {
  const double misstated = stated[0] / noise_sigma(sensor_, simulate({}, {})[0]);
  Value m = Value::object(), images = Value::array(), objects = Value::array();
  m["cameras"]["c"] = Value::object({{"model", "pinhole"},
                                     {"width_px", size},
                                     {"height_px", size},
                                     {"fx_px", focal},
                                     {"fy_px", focal},
                                     {"cx_px", 0.5 * (size - 1)},
                                     {"cy_px", 0.5 * (size - 1)},
                                     {"mosaic", "polarizers"}});
  m["surfaces"]["metal"] =
      Value::object({{"model", "conductor"}, {"eta", metal_.real()}, {"k", metal_.imag()}, {"alpha", 0}});
  m["surfaces"]["glass"] = Value::object({{"model", "dielectric"}, {"eta", glass_}, {"sigma_a_per_m", 1e6}});
  for (std::size_t b = 0; b < 2; ++b) {
    const std::string name = b == 0 ? "first" : "second";
    m["meshes"][name]["sphere"]["radius_m"] = stage_.balls[b].radius;
    const Vec3 at = stage_.balls[b].centre;
    objects.push_back(Value::object({{"id", name},
                                     {"mesh", name},
                                     {"surface", b == 0 ? "metal" : "glass"},
                                     {"world_from_object", pose({1, 0, 0, 0, 1, 0, 0, 0, 1}, at.x, at.y, at.z)}}));
  }
  io::Image white(2, 2, {"R", "G", "B"});
  std::fill(white.data.begin(), white.data.end(), 1.0f);
  into.files["white.exr"] = io::encode_exr(white);
  for (const Display* d : {&stage_.screen, &stage_.panel}) {
    Value& light = m["lights"][d == &stage_.screen ? "screen" : "panel"];
    light =
        Value::object({{"model", "screen"}, {"file", "white"}, {"width_m", 2 * d->half}, {"height_m", 2 * d->half}});
    light["position_m"] = three(d->centre), light["direction"] = three(d->out), light["up"] = three(d->up);
    light["scale"] = d->radiance;
    light["polarization_rad"] = d->angle, light["polarization_degree"] = d->degree;
  }
  for (std::size_t p = 0; p < views * states; ++p) {
    io::Image picture(size, size, {"Y"});
    for (std::size_t i = 0; i < pixels; ++i) picture.data[i] = static_cast<float>(observed[p * pixels + i]);
    const std::string id = format("image_%02zu", p);
    into.files[id + ".exr"] = io::encode_exr(picture);
    const Eye& e = eyes_[p / states];
    Value image = Value::object({{"id", id}, {"file", id}, {"camera", "c"}});
    image["world_from_camera"] =
        pose({e.right.x, e.down.x, e.forward.x, e.right.y, e.down.y, e.forward.y, e.right.z, e.down.z, e.forward.z},
             e.position.x, e.position.y, e.position.z);
    image["light"] = p % states == 0 ? Value(std::vector<std::string>{"screen", "panel"}) : Value("screen");
    image["noise"] =
        Value::object({{"gain", sensor_.gain / (misstated * misstated)}, {"read", sensor_.read * misstated}});
    images.push_back(image);
  }
  m["objects"] = objects;
  m["images"] = images;
  finish(m, into);
}

}  // namespace

std::unique_ptr<World> polarization_world() {
  return std::make_unique<Polarization>();
}

}  // namespace gonio::sealed

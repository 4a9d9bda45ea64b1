// Photographs of balls and a box on a table under three lamps from three views, traced by traced_scene.h. Designs:
// "direct light only" (the base model knows of no other), "table alone", "varnished" (everything under a clear coat,
// without light between surfaces, in truth and in the base model).
#include <algorithm>
#include <cmath>
#include <memory>

#include "base/text.h"
#include "io/exr.h"
#include "sealed/camera_chain.h"
#include "sealed/image_effects.h"
#include "sealed/recording.h"
#include "sealed/traced_scene.h"
#include "sealed/worlds.h"

namespace gonio::sealed {
namespace {

constexpr int size = 96;
constexpr int rough = 64, exact = 384;  // ways through a pixel: its mean is off by 1 %, by 0.3 %
constexpr double focal = 204;
constexpr double varnish_f0 = 0.045;
constexpr std::size_t views = 3, lamps = 3;

class Images final : public World {
 public:
  std::vector<EffectKind> effects() const override { return image_effects(&white_); }
  void design(Random& random, const std::string& variant) override;
  Numbers base() const override { return {}; }
  Numbers base_steps() const override { return {}; }
  Numbers simulate(const Numbers&, const Sizes& sizes) const override {
    if (!sizes.empty()) return pictures(sizes, rough, nullptr);
    if (clean_.empty()) clean_ = pictures({}, rough, &of_matter_);
    return clean_;
  }
  Numbers exposed(const Sizes& sizes, Numbers) const override { return pictures(sizes, exact, nullptr); }
  std::vector<Numbers> base_columns() const override;  // albedos, then the lamps' common intensity, per band
  Numbers sigma(const Numbers& clean) const override {
    Numbers s(clean.size());
    for (std::size_t i = 0; i < s.size(); ++i) s[i] = noise_sigma(sensor_, clean[i]);
    return s;
  }
  Numbers noisy(const Numbers& clean, Random& random) const override {
    Numbers values = clean;
    expose(sensor_, values, 3 * size * size, random);
    return values;
  }
  Numbers norm(const Numbers& observed) const override {
    Numbers n(observed.size());
    for (std::size_t i = 0; i < n.size(); ++i) n[i] = observed[i] * observed[i];
    return n;
  }
  bool relative() const override { return true; }
  bool asks_rivals() const override { return false; }
  void locate(const Numbers& surviving, const Numbers& observed, Case& into) const override;
  void write(const Numbers& observed, const Numbers& stated, Case& into) const override;

 private:
  Numbers pictures(const Sizes& sizes, int samples, std::vector<Numbers>* of_matter) const;
  Scene altered(const Sizes& sizes, std::size_t lamp) const;
  static std::string image_id(std::size_t k) { return format("image_%02zu_%02zu", k / lamps, k % lamps); }

  Scene scene_;  // lamps: all three
  std::vector<Eye> eyes_;
  std::vector<Vec3> turns_;  // axes about which the lamps may be off
  Vec3 second_{}, push_{};
  Sensor sensor_;
  double white_ = 1;
  bool believes_direct_ = false, varnished_ = false;
  std::shared_ptr<const CoatAlbedo> coat_;
  double plane_ = 0;  // of polarization, about the way to the scene
  mutable Numbers clean_;
  mutable std::vector<Numbers> of_matter_;
};

void Images::design(Random& random, const std::string& variant) {
  believes_direct_ = variant == "direct light only";
  const auto albedo = [&] {
    const double grey = random.uniform(0.25, 0.7);
    return Rgb{grey * random.uniform(0.7, 1.1), grey * random.uniform(0.7, 1.1), grey * random.uniform(0.7, 1.1)};
  };
  for (int m = 0; m < 3; ++m) scene_.matters.push_back({.albedo = albedo()});
  scene_.table_matter = 0;
  varnished_ = variant == "varnished";
  if (varnished_) {
    const double alpha = random.uniform(0.15, 0.25);
    coat_ = std::make_shared<CoatAlbedo>(varnish_f0, alpha);
    for (Matter& m : scene_.matters) m.f0 = varnish_f0, m.alpha = alpha, m.coat = coat_.get();
    scene_.table_lay = random.uniform(0, pi);
    plane_ = random.uniform(0, pi);
  }
  if (variant != "table alone") {
    const double r = random.uniform(0.045, 0.06), small = random.uniform(0.025, 0.035);
    scene_.balls.push_back({{random.uniform(-0.04, -0.01), random.uniform(-0.02, 0.02), r}, r, 1});
    scene_.balls.push_back({{random.uniform(0.06, 0.08), random.uniform(-0.05, -0.03), small}, small, 1});
    const double half = random.uniform(0.02, 0.03);
    scene_.box_lower = {0.05 - half, 0.06 - half, 0};
    scene_.box_upper = {0.05 + half, 0.06 + half, 2 * half};
    scene_.box_matter = 2;
  }
  const double around = random.uniform(0, 2 * pi);
  for (std::size_t v = 0; v < views; ++v) {
    const double a = around + 2 * pi * static_cast<double>(v) / views;
    eyes_.push_back(
        eye_at({0.42 * std::cos(a), 0.42 * std::sin(a), random.uniform(0.22, 0.32)}, {0, 0, 0.02}, focal, size));
  }
  for (std::size_t l = 0; l < lamps; ++l) {
    const double a = random.uniform(0, 2 * pi), out = random.uniform(0.12, 0.35);
    scene_.lamps.push_back({{out * std::cos(a), out * std::sin(a), random.uniform(0.38, 0.5)}, 0, {}});
    const double turn = random.uniform(0, 2 * pi);
    turns_.push_back({std::cos(turn), std::sin(turn), 0});
  }
  const double watt = random.uniform(0.8, 1.3);
  for (Lamp& l : scene_.lamps) l.intensity = {watt, watt, watt};
  const double a = random.uniform(0, 2 * pi), b = random.uniform(0, 2 * pi);
  second_ = {0.4 * std::cos(a), 0.4 * std::sin(a), 0.4};
  push_ = {std::cos(b), std::sin(b), 0};
  sensor_.seed = random.next();
  const Numbers& clean = simulate({}, {});
  white_ = sensor_.white = *std::max_element(clean.begin(), clean.end());
}

// The scene as it truly is while lamp `lamp` is on.
Scene Images::altered(const Sizes& sizes, std::size_t lamp) const {
  Scene s = scene_;
  Lamp on = scene_.lamps[lamp];
  on.radius = size_of(sizes, "lamp with a size");
  if (const double angle = size_of(sizes, "lamps elsewhere"); angle != 0) {
    const Vec3 k = turns_[lamp], p = on.position;
    on.position = p * std::cos(angle) + cross(k, p) * std::sin(angle) + k * (dot(k, p) * (1 - std::cos(angle)));
  }
  if (const double degree = size_of(sizes, "polarized lamps"); degree > 0) {
    const Vec3 way = normalized(on.position), a = normalized(cross(way, Vec3{0.2, 1, 0.1})), b = cross(way, a);
    on.light = {a * std::cos(plane_) + b * std::sin(plane_), degree};
  }
  s.lamps = {on};
  s.matters[0].stretch = std::exp(size_of(sizes, "brushed table"));
  if (const double share = size_of(sizes, "second lamp"); share > 0)
    s.lamps.push_back({second_, 0, on.intensity * share});
  const double sky = size_of(sizes, "ambient light");
  s.ambient = {sky, sky, 1.1 * sky};
  if (const double f0 = size_of(sizes, "clear coat"); f0 > 0) s.matters[1].f0 = f0, s.matters[1].alpha = 0.15;
  s.matters[1].slope_rad = size_of(sizes, "rough matte");
  s.stain = {{0.02, -0.09, 0}, 0.03, size_of(sizes, "stain")};
  s.indirect = (!believes_direct_ && !varnished_) || sizes.contains("light between surfaces");
  if (!s.balls.empty()) {
    Ball& ball = s.balls[0];
    ball.centre += push_ * size_of(sizes, "moved ball");
    const double less = 1 - size_of(sizes, "shrunk ball");
    ball.radius *= less;
  }
  const Vec3 half = (on.position + Vec3{0, 0, 0.1}) * 0.4;
  s.wire = {half + Vec3{-0.3, -0.05, 0}, half + Vec3{0.3, 0.05, 0}, lamp == 1 ? size_of(sizes, "wire") : 0};
  return s;
}

Numbers Images::pictures(const Sizes& sizes, int samples, std::vector<Numbers>* of_matter) const {
  const std::size_t per = 3 * size * size;
  Numbers all(per * views * lamps);
  if (of_matter != nullptr) of_matter->assign(scene_.matters.size(), Numbers(all.size()));
  for (std::size_t k = 0; k < views * lamps; ++k) {
    const Scene s = altered(sizes, k % lamps);
    Eye eye = eyes_[k / lamps];
    eye.pupil_m = size_of(sizes, "wide pupil");
    eye.focus_m = 0.62;
    Numbers one(per);
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        const Seen seen = look(s, eye, x, y, samples, sensor_.seed + k);
        const std::size_t at = 3 * (static_cast<std::size_t>(y) * size + static_cast<std::size_t>(x));
        for (int c = 0; c < 3; ++c) {
          one[at + static_cast<std::size_t>(c)] = seen.radiance[c];
          for (std::size_t m = 0; of_matter != nullptr && m < of_matter->size(); ++m)
            (*of_matter)[m][k * per + at + static_cast<std::size_t>(c)] = seen.of_matter[m][c];
        }
      }
    if (!sizes.empty()) through_camera(one, size, size, sizes, k, white_);
    std::copy(one.begin(), one.end(), all.begin() + static_cast<std::ptrdiff_t>(k * per));
  }
  return all;
}

std::vector<Numbers> Images::base_columns() const {
  const Numbers& clean = simulate({}, {});
  std::vector<Numbers> columns;
  const auto add = [&](const Numbers& light) {
    for (std::size_t c = 0; c < 3; ++c) {
      columns.emplace_back(light.size());
      for (std::size_t i = c; i < light.size(); i += 3) columns.back()[i] = light[i];
    }
  };
  for (const Numbers& m : of_matter_) add(m);
  add(clean);
  return columns;
}

void Images::locate(const Numbers& surviving, const Numbers&, Case& into) const {
  for (std::size_t k = 0; k < views * lamps; ++k) {
    std::vector<float>& map = into.pixels[image_id(k)];
    for (std::size_t p = 0; p < size * size; ++p) {
      const double* e = &surviving[3 * (k * size * size + p)];
      map.push_back(static_cast<float>(std::sqrt((e[0] * e[0] + e[1] * e[1] + e[2] * e[2]) / 3)));
    }
  }
}

// Eight corners, twelve triangles, sides turned outwards.
std::string box_ply(Vec3 lower, Vec3 upper) {
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 12\nproperty list uchar int vertex_indices\nend_header\n";
  for (int k = 0; k < 8; ++k)
    text += format("%.9g %.9g %.9g\n", k & 1 ? upper.x : lower.x, k & 2 ? upper.y : lower.y, k & 4 ? upper.z : lower.z);
  static constexpr int faces[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                       {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  for (const auto& f : faces) text += format("3 %d %d %d\n", f[0], f[1], f[2]);
  return text;
}

Value numbers3(Vec3 v) {
  return Value(std::vector<double>{v.x, v.y, v.z});
}

Value object_entry(const std::string& id, const std::string& mesh, const std::string& surface, Vec3 at) {
  return Value::object({{"id", id},
                        {"mesh", mesh},
                        {"surface", surface},
                        {"world_from_object", pose({1, 0, 0, 0, 1, 0, 0, 0, 1}, at.x, at.y, at.z)}});
}

Value free_rgb(double start, const char* share) {
  Value v = Value::object({{"value", Value(std::vector<double>{start, start, start})}, {"free", true}, {"min", 0}});
  if (*share != 0)
    v["share"] = share;
  else
    v["max"] = 1;
  return v;
}

void Images::write(const Numbers& observed, const Numbers& stated, Case& into) const {
  const double misstated = stated[0] / noise_sigma(sensor_, clean_[0]);
  Value m = Value::object(), images = Value::array(), objects = Value::array();
  m["cameras"]["c"] = Value::object({{"model", "pinhole"},
                                     {"width_px", size},
                                     {"height_px", size},
                                     {"fx_px", focal},
                                     {"fy_px", focal},
                                     {"cx_px", 0.5 * (size - 1)},
                                     {"cy_px", 0.5 * (size - 1)}});
  const double side = 2 * scene_.table_half;
  m["meshes"]["table"]["plane"]["size_m"] = Value(std::vector<double>{side, side});
  objects.push_back(object_entry("table", "table", "s0", {}));
  for (std::size_t b = 0; b < scene_.balls.size(); ++b) {
    const std::string name = "ball" + std::to_string(b);
    m["meshes"][name]["sphere"]["radius_m"] = scene_.balls[b].radius;
    objects.push_back(object_entry(name, name, "s1", scene_.balls[b].centre));
  }
  if (scene_.box_lower.x < scene_.box_upper.x) {
    into.files["box.ply"] = box_ply(scene_.box_lower, scene_.box_upper);
    m["meshes"]["box"] = Value::object({{"file", "box"}, {"normals", "flat"}});
    objects.push_back(object_entry("box", "box", "s2", {}));
  }
  for (std::size_t s = 0; s < (scene_.balls.empty() ? 1u : 3u); ++s) {
    Value& surface = m["surfaces"]["s" + std::to_string(s)];
    surface = Value::object({{"model", varnished_ ? "coated-diffuse" : "diffuse"}, {"albedo", free_rgb(0.5, "")}});
    if (varnished_) surface["f0"] = varnish_f0, surface["alpha"] = free_parameter(0.2);
  }
  for (std::size_t l = 0; l < lamps; ++l)
    m["lights"]["light-" + std::to_string(l)] = Value::object(
        {{"model", "point"}, {"position_m", numbers3(scene_.lamps[l].position)}, {"watt_per_sr", free_rgb(1, "i")}});
  for (std::size_t k = 0; k < views * lamps; ++k) {
    io::Image picture(size, size, {"R", "G", "B"});
    for (std::size_t i = 0; i < picture.data.size(); ++i)
      picture.data[i] = static_cast<float>(observed[k * picture.data.size() + i]);
    into.files[image_id(k) + ".exr"] = io::encode_exr(picture);
    const Eye& e = eyes_[k / lamps];
    Value image = Value::object({{"id", image_id(k)}, {"file", image_id(k)}, {"camera", "c"}});
    image["world_from_camera"] =
        pose({e.right.x, e.down.x, e.forward.x, e.right.y, e.down.y, e.forward.y, e.right.z, e.down.z, e.forward.z},
             e.position.x, e.position.y, e.position.z);
    image["light"] = "light-" + std::to_string(k % lamps);
    image["response"] = "linear";
    image["noise"] =
        Value::object({{"gain", sensor_.gain / (misstated * misstated)}, {"read", sensor_.read * misstated}});
    images.push_back(image);
  }
  m["objects"] = objects;
  m["images"] = images;
  if (believes_direct_ || varnished_) m["mechanisms"]["transport.indirect"]["strength"] = 0;
  finish(m, into);
}

}  // namespace

std::unique_ptr<World> images_world() {
  return std::make_unique<Images>();
}

}  // namespace gonio::sealed

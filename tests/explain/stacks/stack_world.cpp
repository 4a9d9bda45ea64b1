#include "explain/stacks/stack_world.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <random>

#include "geom/vector.h"
#include "io/codes.h"
#include "io/picture.h"
#include "manifest/document.h"

namespace gonio::tests {
namespace {

std::string number(double v) {
  char text[40];
  std::snprintf(text, sizeof text, "%.12g", v);
  return text;
}

// Sum of a patchwork and two waves in the logarithm of radiance, about two and a half decades.
class SceneLog {
 public:
  explicit SceneLog(const ExposureWorld& world) : across_((world.width - 1) / 9 + 1) {
    for (int v = 0; v <= (world.height - 1) / 9; ++v)
      for (int u = 0; u < across_; ++u) {
        std::mt19937_64 patch(world.seed * 7919 + static_cast<std::uint64_t>(u + 64 * v) * 31);
        patches_.push_back(std::uniform_real_distribution<double>(-2.4, 2.4)(patch));
      }
  }
  double operator()(int x, int y, int channel) const {
    const double hue = 0.3 * channel * std::sin(0.07 * x + 1.3 * channel);
    return patches_[static_cast<std::size_t>(y / 9 * across_ + x / 9)] + 0.4 * std::sin(0.11 * x) +
           0.4 * std::cos(0.13 * y) + hue;
  }

 private:
  int across_;
  std::vector<double> patches_;
};

void write(const std::filesystem::path& path, const io::Image& image, int bits) {
  if (bits > 0)
    io::write_png(path, image, bits);
  else
    io::write_picture(path, image);
}

}  // namespace

namespace {

// What the filter of a pixel passes.
double passed(int x, int y, const ExposureWorld& world) {
  if (!(world.red > 0)) return 1;
  return y % 2 == 0 ? (x % 2 == 0 ? world.red : 1) : (x % 2 == 0 ? 1 : world.blue);
}

// What full pixels give their neighbours, counted from whoever gives.
void flow_over(io::Image& light, const ExposureWorld& world) {
  const io::Image before = light;
  const auto give = [&](int x, int y, int c, double charge) {
    if (x >= 0 && y >= 0 && x < light.width && y < light.height) light.at(x, y, c) += static_cast<float>(charge);
  };
  for (int y = 0; y < light.height; ++y)
    for (int x = 0; x < light.width; ++x)
      for (int c = 0; c < world.channels; ++c) {
        const double more = before.at(x, y, c) - 1;
        if (more <= 0) continue;
        for (const int step : {-1, 1})
          give(x, y + step, c, world.along * more), give(x + step, y, c, world.across * more);
      }
}

// What passes the lens in a picture at a place `radius` half widths from the centre: rays on a grid, counted one by
// one.
double through_lens(double radius, std::size_t picture, const ExposureWorld& world) {
  if (world.f_numbers.empty()) return 1;
  const double n = world.f_numbers[picture], widest = std::ranges::min(world.f_numbers);
  double share = std::pow(widest / n, 2) * (n > widest ? world.stopped_down : 1);
  if (!(world.rim > 0)) return share;
  const double rim2 = 1 / (world.rim * world.rim);
  int started = 0, passed_rim = 0;
  constexpr int across = 160;
  for (int j = 0; j < across; ++j)
    for (int i = 0; i < across; ++i) {
      const double x = (2 * i + 1.0) / across - 1, y = (2 * j + 1.0) / across - 1;  // over the aperture
      if (x * x + y * y > 1) continue;
      ++started;
      const double across_rim = x / n - world.rim_shift * radius / world.rim, along = y / n;
      passed_rim += across_rim * across_rim + along * along < rim2;
    }
  return share * passed_rim / started;
}

// The same by tenths of a pixel from the centre to the corner, for as long as pictures have the same lens.
const std::vector<double>& by_radius(std::size_t picture, const ExposureWorld& world) {
  const bool lens = !world.f_numbers.empty();
  const std::vector<double> key = {static_cast<double>(world.width),
                                   static_cast<double>(world.height),
                                   lens ? world.f_numbers[picture] : 0,
                                   lens ? std::ranges::min(world.f_numbers) : 0,
                                   world.stopped_down,
                                   world.rim,
                                   world.rim_shift};
  static std::map<std::vector<double>, std::vector<double>> known;
  std::vector<double>& all = known[key];
  if (all.empty())
    for (int r = 0; r <= static_cast<int>(5 * std::hypot(world.width, world.height)); ++r)
      all.push_back(through_lens((r + 0.5) / 5 / world.width, picture, world));
  return all;
}

}  // namespace

manifest::Document record(const ExposureWorld& world, const std::filesystem::path& folder) {
  const std::vector<std::string> names =
      world.channels == 1 ? std::vector<std::string>{"Y"} : std::vector<std::string>{"R", "G", "B"};
  const char* extension = world.bits > 0 ? "png" : "exr";
  std::string files, images;
  // The middle of the scene is at a fifth of full scale in the middle exposure.
  const double scale = 0.2 / world.exposures_s[world.exposures_s.size() / 2];
  const SceneLog scene_log(world);
  for (std::size_t g = 0; g < world.exposures_s.size(); ++g) {
    std::mt19937_64 random(world.seed * 1000003 + g);
    io::Image picture(world.width, world.height, names);
    const double open_s =
        (world.exposures_s[g] + world.extra_s) * (1 + (world.longer.empty() ? 0 : world.longer.at(g)));
    io::Image light(world.width, world.height, names);
    const std::vector<double>& lens = by_radius(g, world);
    for (int y = 0; y < world.height; ++y)
      for (int x = 0; x < world.width; ++x)
        for (int c = 0; c < world.channels; ++c) {
          double scene = std::exp(scene_log(x, y, c)) * passed(x, y, world);
          for (const ExposureWorld::Passer& p : world.passers)
            if (p.picture == g && std::hypot(x - p.x, y - p.y) < p.radius) scene = p.light;
          const double from_centre = std::hypot(x + 0.5 - 0.5 * world.width, y + 0.5 - 0.5 * world.height);
          const double v = scene * scale * open_s * lens[static_cast<std::size_t>(10 * from_centre)];
          light.at(x, y, c) = static_cast<float>(world.light ? world.light(v, world.times_s.at(g)) : v);
        }
    for (const ExposureWorld::Hot& hot : world.hot)
      light.at(hot.x, hot.y, 0) += static_cast<float>(hot.per_s * world.exposures_s[g]);
    if (world.along > 0 || world.across > 0) flow_over(light, world);
    for (int y = 0; y < world.height; ++y)
      for (int x = 0; x < world.width; ++x)
        for (int c = 0; c < world.channels; ++c) {
          double v = light.at(x, y, c);
          v = static_cast<double>(std::poisson_distribution<long>(std::min(50.0, v) * world.electrons)(random)) /
              world.electrons;
          if (world.response) v = world.response(v);
          v += world.offset + std::normal_distribution<double>(0, world.read)(random);
          picture.at(x, y, c) = static_cast<float>(world.full_scale > 0 ? std::min(v, world.full_scale) : v);
        }
    const std::string id = "e" + std::to_string(g), file = id + "." + extension;
    write(folder / file, picture, world.bits);
    files += (g ? ", \"" : "\"") + id + "\": {\"path\": \"" + file + "\"}";
    images += (g ? ", " : "") + std::string("{\"id\": \"") + id + "\", \"file\": \"" + id +
              "\", \"camera\": \"c\", \"exposure_s\": " + number(world.exposures_s[g]) + ", \"response\": \"linear\"";
    if (!world.f_numbers.empty()) images += ", \"f_number\": " + number(world.f_numbers[g]);
    if (!world.times_s.empty()) images += ", \"time_s\": " + number(world.times_s[g]);
    if (!world.response)
      images += ", \"noise\": {\"gain\": " + number(world.electrons) + ", \"read\": " + number(world.read) + "}";
    images += "}";
  }
  const std::string text =
      "{\"gonio\": 1, \"files\": {" + files +
      "}, \"cameras\": {\"c\": {\"model\": \"pinhole\", \"width_px\": " + std::to_string(world.width) +
      ", \"height_px\": " + std::to_string(world.height) +
      ", \"fx_px\": 80, \"fy_px\": 80, \"cx_px\": 35.5, \"cy_px\": 29.5" +
      (world.red > 0 ? ", \"mosaic\": \"RGGB\"" : "") + "}}, \"images\": [" + images + "]}";
  return manifest::parse_document(text, "stack.json", folder);
}

namespace {

struct Direction {
  double x, y, z;
};
Direction unit(Direction a) {
  const double n = std::sqrt(a.x * a.x + a.y * a.y + a.z * a.z);
  return {a.x / n, a.y / n, a.z / n};
}
double inner(Direction a, Direction b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

// Normal (z to the camera, y down) of the object at a pixel; z = 0: none.
Direction normal_at(double u, double v) {
  const double r2 = u * u + v * v;
  if (r2 < 0.81) return unit({u, v, std::sqrt(1 - r2)});
  return {0, 0, 0};
}

// Oren & Nayar's qualitative model and a Cook-Torrance lobe with Smith's separable masking, cosines included.
double reflected(Direction n, Direction l, double albedo, const LightWorld& world) {
  const Direction eye{0, 0, 1};
  const double ci = inner(n, l), co = n.z;
  if (ci <= 0 || co <= 0) return 0;
  const double s2 = world.sigma_rad * world.sigma_rad;
  const double a = 1 - 0.5 * s2 / (s2 + 0.33), b = 0.45 * s2 / (s2 + 0.09);
  const double ti = std::acos(ci), to = std::acos(co);
  const double cos_phi =
      std::sin(ti) * std::sin(to) > 1e-9 ? (inner(l, eye) - ci * co) / (std::sin(ti) * std::sin(to)) : 0;
  double f = albedo / pi * (a + b * std::max(0.0, cos_phi) * std::sin(std::max(ti, to)) * std::tan(std::min(ti, to)));
  if (world.f0 > 0) {
    const Direction h = unit({l.x, l.y, l.z + 1});
    const double nh = inner(n, h), vh = h.z, a2 = world.alpha * world.alpha;
    const double d = a2 / (pi * std::pow(nh * nh * (a2 - 1) + 1, 2));
    const auto g1 = [&](double c) { return 2 * c / (c + std::sqrt(a2 + (1 - a2) * c * c)); };
    const double fresnel = world.f0 + (1 - world.f0) * std::pow(1 - vh, 5);
    f = f * (1 - world.f0) + fresnel * d * g1(ci) * g1(co) / (4 * ci * co);
  }
  return f * ci;
}

}  // namespace

manifest::Document record(const LightWorld& world, const std::filesystem::path& folder) {
  std::mt19937_64 random(world.seed * 104729);
  std::normal_distribution<double> normal(0, 1);
  std::string files = "\"mask\": {\"path\": \"mask.png\"}", images, lights;
  io::Image mask(world.size, world.size, {"Y"});
  for (int k = 0; k < world.lights; ++k) {
    const double azimuth = 2 * pi * k * 0.381966, zenith = 0.25 + 0.6 * std::sqrt((k + 0.5) / world.lights);
    const Direction believed{std::sin(zenith) * std::cos(azimuth), std::sin(zenith) * std::sin(azimuth),
                             std::cos(zenith)};
    const double across = 2 * pi * std::uniform_real_distribution<double>(0, 1)(random);
    const Direction t = unit({std::cos(zenith) * std::cos(azimuth), std::cos(zenith) * std::sin(azimuth),
                              -std::sin(zenith)}),
                    s{-std::sin(azimuth), std::cos(azimuth), 0};
    const double c = std::cos(across) * std::tan(world.turn_rad), d = std::sin(across) * std::tan(world.turn_rad);
    const Direction l =
        unit({believed.x + c * t.x + d * s.x, believed.y + c * t.y + d * s.y, believed.z + c * t.z + d * s.z});
    io::Image picture(world.size, world.size, {"Y"});
    for (int y = 0; y < world.size; ++y)
      for (int x = 0; x < world.size; ++x) {
        const double u = 2.2 * (x - 0.5 * (world.size - 1)) / world.size,
                     v = 2.2 * (y - 0.5 * (world.size - 1)) / world.size;
        const Direction n = normal_at(u, v);
        mask.at(x, y, 0) = n.z > 0 ? 1.0f : 0.0f;
        const double albedo = 0.45 + 0.2 * std::sin(7 * u) * std::cos(5 * v);
        double value =
            n.z > 0 ? world.scale * (pi * reflected(n, l, albedo, world) + world.ambient * albedo * (1 + n.z) / 2) : 0;
        if (k % 3 == 0) value *= std::exp(-world.uneven * v / 1.1);
        value = std::pow(std::max(0.0, value), world.gamma) + world.offset;
        picture.at(x, y, 0) = static_cast<float>(value + world.noise * normal(random));
      }
    const std::string id = "l" + std::to_string(k);
    io::write_picture(folder / (id + ".exr"), picture);
    files += ", \"" + id + "\": {\"path\": \"" + id + ".exr\"}";
    const std::string w = number(pi * world.scale), white = "[" + w + ", " + w + ", " + w + "]";
    lights += (k ? ", \"" : "\"") + id + "\": {\"model\": \"directional\", \"towards\": [" + number(believed.x) + ", " +
              number(believed.y) + ", " + number(-believed.z) + "], \"watt_per_m2\": " +
              (world.uneven != 0 ? "{\"value\": " + white + ", \"free\": true, \"min\": 0}" : white) + "}";
    images += (k ? ", " : "") + std::string("{\"id\": \"") + id + "\", \"file\": \"" + id +
              "\", \"camera\": \"c\", \"light\": \"" + id +
              "\", \"mask\": \"mask\", \"noise\": {\"gain\": 1e9, \"read\": " + number(world.noise) + "}}";
  }
  io::write_picture(folder / "mask.png", mask);
  const std::string side = std::to_string(world.size);
  return manifest::parse_document("{\"gonio\": 1, \"files\": {" + files + "}, \"cameras\": {\"c\": {\"model\": " +
                                      "\"orthographic\", \"width_px\": " + side + ", \"height_px\": " + side +
                                      ", \"px_per_m\": 100, \"cx_px\": 47.5, \"cy_px\": 47.5}}, \"lights\": {" +
                                      lights + "}, \"images\": [" + images + "]}",
                                  "lights.json", folder);
}

}  // namespace gonio::tests

// A laboratory's background with truth: a table of two-coloured checks, a folded cloth of two materials on it, lamps
// high up of which each view has another, a bar before one of them; glossy, with shadows, highlights and sensor noise.
//
// What is labelled is a scan of it: another triangulation, with noise, that knows nothing of materials.
#pragma once
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "base/random.h"
#include "mesh/mesh.h"
#include "reassembly/labels.h"
#include "render/looking_at.h"
#include "render/path_tracer.h"
#include "scene/scene.h"

namespace gonio::tests {

struct LabelSceneWish {
  std::uint64_t seed = 1;
  int views = 2, width_px = 160, height_px = 120, spp = 16;
  double check_m = 0.04;
  bool bar_is_known = true;  // else the shading lacks its shadow
  double face_m = 0.012;     // of the scan
};

struct LabelScene {
  static constexpr double half_x = 0.24, half_y = 0.16;  // of the table
  std::vector<reassembly::Material> materials;           // two of the checks, two of the cloth
  io::TriangleMesh scan;
  std::size_t cloth_faces = 0;  // the first ones of the scan; then the table's
  std::vector<io::Image> photographs, shadings, highlights;
  std::vector<std::vector<std::uint8_t>> clipped;
  std::vector<std::vector<std::int32_t>> truth;  // per pixel; unlabelled where the background is not seen
  std::vector<camera::CameraModel> cameras;
  std::vector<Rigid<frame::World, frame::Camera>> poses;
  double check_m = 0, phase = 0, pixel_m = 0;  // pixel_m: what one sees, at the table's middle

  double cloth_border(double y) const { return 0.02 + 0.03 * std::sin(25 * y + phase); }
  bool on_cloth(Vec3 p) const { return std::abs(p.x) < 0.12 && std::abs(p.y) < 0.1 && p.z > 0.006; }
  double cloth_z(double x, double y) const {
    return 0.026 + 0.012 * std::sin(45 * x + 12 * y + phase) + 0.006 * std::sin(50 * y - 20 * x);
  }
  std::int32_t label(Vec3 p) const {
    if (on_cloth(p)) return p.x < cloth_border(p.y) ? 2 : 3;
    const auto cell = [&](double v) { return static_cast<long>(std::floor(v / check_m)); };
    return (cell(p.x) + cell(p.y)) % 2 == 0 ? 0 : 1;
  }
  // Along the table, or nearly so along the cloth. Where either ends is a border, too: pixels see what is behind.
  double from_border_m(Vec3 p) const {
    if (on_cloth(p)) {
      double least = std::min(0.12 - std::abs(p.x), 0.1 - std::abs(p.y));
      for (double y = p.y - 0.03; y < p.y + 0.03; y += 0.0005)
        least = std::min(least, std::hypot(p.x - cloth_border(y), p.y - y));
      return least;
    }
    const auto line = [&](double v) { return std::abs(v / check_m - std::round(v / check_m)) * check_m; };
    return std::min({line(p.x), line(p.y), half_x - std::abs(p.x), half_y - std::abs(p.y)});
  }
};

namespace label_scene_parts {

// A grid of nu x nv quads; vertices by a function of (u, v) in the unit square.
template <class Place>
void add_grid(io::TriangleMesh& mesh, int nu, int nv, const Place& place) {
  const auto base = static_cast<std::uint32_t>(mesh.positions_m.size()), row = static_cast<std::uint32_t>(nu + 1);
  for (int j = 0; j <= nv; ++j)
    for (int i = 0; i <= nu; ++i)
      mesh.positions_m.push_back(place(i / static_cast<double>(nu), j / static_cast<double>(nv)));
  for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(nv); ++j)
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(nu); ++i) {
      const std::uint32_t a = base + j * row + i, b = a + 1, c = a + row, d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
}

inline std::shared_ptr<const mesh::Mesh> prepared(io::TriangleMesh mesh) {
  return std::make_shared<const mesh::Mesh>(mesh::prepare(std::move(mesh), mesh::Shading::smooth, "test"));
}

inline io::TriangleMesh checks(const LabelScene& s, std::int32_t label) {
  io::TriangleMesh mesh;
  const double c = s.check_m;
  for (double x = -LabelScene::half_x; x < LabelScene::half_x - c / 2; x += c)
    for (double y = -LabelScene::half_y; y < LabelScene::half_y - c / 2; y += c)
      if (s.label({x + c / 2, y + c / 2, 0}) == label)
        add_grid(mesh, 1, 1, [&](double u, double v) { return Vec3{x + u * c, y + v * c, 0}; });
  return mesh;
}

inline io::TriangleMesh cloth(const LabelScene& s, std::int32_t label) {
  io::TriangleMesh mesh;
  add_grid(mesh, 120, 160, [&](double u, double v) {
    const double y = -0.1 + 0.2 * v, b = s.cloth_border(y),
                 x = label == 2 ? -0.12 + u * (b + 0.12) : b + u * (0.12 - b);
    return Vec3{x, y, s.cloth_z(x, y)};
  });
  return mesh;
}

inline void make_scan(LabelScene& s, const LabelSceneWish& wish, Random& random) {
  const auto noisy = [&](Vec3 p) { return p + Vec3{random.normal(), random.normal(), random.normal()} * 1e-4; };
  const auto cells = [&](double size_m, double face_m) { return static_cast<int>(std::ceil(size_m / face_m)); };
  add_grid(s.scan, cells(0.24, wish.face_m / 2), cells(0.2, wish.face_m / 2), [&](double u, double v) {
    const double x = 0.24 * (u - 0.5), y = 0.2 * (v - 0.5);
    return noisy({x, y, s.cloth_z(x, y)});
  });
  s.cloth_faces = s.scan.triangles.size();
  // The table's grid stands askew to its checks.
  add_grid(s.scan, cells(2 * LabelScene::half_x, wish.face_m), cells(2 * LabelScene::half_y, wish.face_m),
           [&](double u, double v) {
             const double inside = u > 0 && u < 1 && v > 0 && v < 1 ? 0.3 * wish.face_m : 0;
             return noisy({LabelScene::half_x * (2 * u - 1) + inside * std::sin(9 * v + 5 * u),
                           LabelScene::half_y * (2 * v - 1) + inside * std::sin(7 * u - 4 * v), 0});
           });
}

inline scene::Surface surface(const std::string& id, const char* model, const manifest::Parameters& parameters) {
  scene::Surface result;
  result.id = id;
  result.model = surface::find(model);
  result.parameters = parameters;
  scene::refresh(result, "test");
  return result;
}

inline scene::Light light(const char* model, const manifest::Parameters& parameters) {
  scene::Light result;
  result.id = model;
  result.model = light::find(model);
  result.parameters = parameters;
  scene::refresh(result, "test");
  return result;
}

inline std::vector<double> numbers(Vec3 v) {
  return {v.x, v.y, v.z};
}

// Lamps, bar and cameras; lamps `off_m` beside their places.
inline scene::Scene laboratory(const LabelScene& s, double off_m, bool bar) {
  scene::Scene scene;
  const auto lamp = [&](Vec3 at, Vec3 colour) {
    return light("sphere", {{"position_m", numbers(at + Vec3{off_m, -off_m, off_m})},
                            {"watt_per_sr", numbers(colour)},
                            {"radius_m", 0.012}});
  };
  scene.appearance.lights = {lamp({0.35, -0.25, 1.2}, {2.9, 2.8, 2.5}), lamp({-0.45, 0.15, 1.0}, {2.2, 2.3, 2.4}),
                             light("uniform", {{"radiance", 0.06}})};
  if (bar) {
    scene.appearance.surfaces.push_back(surface("bar", "diffuse", {{"albedo", 0.1}}));
    scene.instances.push_back({"bar", scene::Plane{0.6, 0.02}, {{}, {0.225, -0.154, 0.7}}, 0});
  }
  for (std::size_t v = 0; v < s.cameras.size(); ++v)
    scene.views.push_back({"v", s.cameras[v], s.poses[v], {v % 2, 2}, {1, 1, 1}, {}, "c"});
  return scene;
}

inline void add(scene::Scene& scene, const scene::Surface& surface, io::TriangleMesh mesh) {
  scene.appearance.surfaces.push_back(surface);
  scene.instances.push_back({surface.id, prepared(std::move(mesh)), {}, scene.appearance.surfaces.size() - 1});
}

inline void expose(LabelScene& s, io::Image picture, Random& random) {
  std::vector<std::uint8_t> clipped(picture.pixels());
  std::vector<std::int32_t> truth(picture.pixels(), reassembly::unlabelled);
  const int id = picture.channel("id");
  io::Image photograph(picture.width, picture.height, {"R", "G", "B"});
  for (std::size_t i = 0; i < picture.pixels(); ++i) {
    const int x = static_cast<int>(i % static_cast<std::size_t>(picture.width)),
              y = static_cast<int>(i / static_cast<std::size_t>(picture.width));
    for (int c = 0; c < 3; ++c) {
      const double v = picture.at(x, y, c), noisy = v + random.normal() * std::sqrt(v / 4000 + 4e-6);
      clipped[i] |= noisy >= 1 ? 1 : 0;
      photograph.at(x, y, c) = static_cast<float>(std::clamp(noisy, 0.0, 1.0));
    }
    const int instance = static_cast<int>(std::lround(picture.at(x, y, id))) - 2;  // 1 is the bar
    if (instance >= 0) truth[i] = instance;
  }
  s.photographs.push_back(std::move(photograph));
  s.clipped.push_back(std::move(clipped));
  s.truth.push_back(std::move(truth));
}

}  // namespace label_scene_parts

inline LabelScene label_scene(const LabelSceneWish& wish) {
  using namespace label_scene_parts;
  LabelScene s;
  Random random(wish.seed, 5);
  s.check_m = wish.check_m;
  s.phase = random.uniform(0, 2 * pi);
  const auto vary = [&](Vec3 colour) {
    return Vec3{colour.x * random.uniform(0.85, 1.15), colour.y * random.uniform(0.85, 1.15),
                colour.z * random.uniform(0.85, 1.15)};
  };
  s.materials = {{"ivory", vary({0.62, 0.57, 0.46})},
                 {"slate", vary({0.09, 0.11, 0.15})},
                 {"red", vary({0.42, 0.09, 0.07})},
                 {"green", vary({0.13, 0.30, 0.15})}};
  const double focal_px = 1.25 * wish.width_px;
  for (int v = 0; v < wish.views; ++v) {
    const double turn = 2 * pi * v / std::max(3, wish.views) + random.uniform(-0.2, 0.2);
    const Vec3 from{0.45 * std::sin(turn), -0.45 * std::cos(turn), random.uniform(0.5, 0.62)};
    s.cameras.emplace_back(
        camera::Intrinsics{focal_px, focal_px, (wish.width_px - 1) / 2.0, (wish.height_px - 1) / 2.0, {}},
        wish.width_px, wish.height_px);
    s.poses.push_back(render::looking_at(from, {0, 0, 0}));
    s.pixel_m = std::max(s.pixel_m, norm(from) / focal_px);
  }
  make_scan(s, wish, random);
  scene::Scene real = laboratory(s, 0, true), believed = laboratory(s, 0.004, wish.bar_is_known);
  for (std::size_t k = 0; k < s.materials.size(); ++k) {
    const auto label = static_cast<std::int32_t>(k);
    const manifest::Parameters parameters{
        {"albedo", numbers(s.materials[k].albedo)}, {"f0", k < 2 ? 0.05 : 0.03}, {"alpha", k < 2 ? 0.12 : 0.45}};
    add(real, surface(s.materials[k].surface, "coated-diffuse", parameters),
        k < 2 ? checks(s, label) : cloth(s, label));
  }
  // White without an interface, and an interface over black, a little duller than the glossier one is.
  const scene::Surface white = surface("scan", "diffuse", {{"albedo", 1.0}});
  const scene::Surface black = surface("scan", "coated-diffuse", {{"albedo", 0.0}, {"f0", 0.05}, {"alpha", 0.15}});
  add(believed, white, s.scan);
  const render::RayCaster real_caster(real.instances), believed_caster(believed.instances);
  const auto believed_picture = [&](std::size_t v, const scene::Surface& made_of) {
    believed.appearance.surfaces.back() = made_of;
    io::Image picture = render::render(believed, v, believed_caster,
                                       {.spp = wish.spp, .seed = wish.seed + 99, .transport = {.max_bounces = 1}});
    const auto channels = picture.channels.size(), id = static_cast<std::size_t>(picture.channel("id"));
    for (std::size_t i = 0; i < picture.pixels(); ++i)  // nothing where the believed scene has nothing
      if (picture.data[i * channels + id] < 0.5f)
        std::fill_n(picture.data.begin() + static_cast<std::ptrdiff_t>(i * channels), 3, 0.0f);
    return picture;
  };
  for (std::size_t v = 0; v < s.cameras.size(); ++v) {
    expose(s,
           render::render(real, v, real_caster, {.spp = wish.spp, .seed = wish.seed, .transport = {.max_bounces = 6}}),
           random);
    s.shadings.push_back(believed_picture(v, white));
    s.highlights.push_back(believed_picture(v, black));
  }
  for (reassembly::Material& m : s.materials)  // what is believed of them
    m.albedo = m.albedo * Vec3{random.uniform(0.95, 1.05), random.uniform(0.95, 1.05), random.uniform(0.95, 1.05)};
  return s;
}

}  // namespace gonio::tests

// Scenes for tests of polarized light: a pixel, a sky of which everything is known, plates and prisms.
#pragma once
#include <gtest/gtest.h>

#include <array>
#include <memory>

#include "mesh/mesh.h"
#include "render/integrator.h"
#include "render/path_setting.h"
#include "render/polarized_carrier.h"
#include "scenes.h"

namespace gonio::tests {

// Uniform radiance from all directions with a positive component along `side`; fully polarized as `stokes` says in the
// frame whose x axis is `x`, made perpendicular to the direction of travel. Only met, never sampled: for smooth scenes.
struct Sky final : light::Emitter {
  Vec3 side, x;
  optics::Stokes stokes{{1, 0, 0, 0}};
  Sky(Vec3 the_side, Vec3 the_x, optics::Stokes the_stokes) : side(the_side), x(the_x), stokes(the_stokes) {}
  light::Sample sample(Vec3, Vec2) const override { return {}; }
  light::Hit hit(Vec3, Vec3 direction) const override {
    return dot(direction, side) > 0 ? light::Hit{.radiance = {1, 1, 1}, .pdf = 0} : light::Hit{};
  }
  bool infinite() const override { return true; }
  std::optional<light::Polarization> polarization(Vec3 travel) const override {
    return light::Polarization{normalized(x - travel * dot(x, travel)), stokes};
  }
};

inline void add_emitter(scene::Scene& scene, std::shared_ptr<const light::Emitter> emitter) {
  scene::Light light;
  light.id = "sky";
  light.emitter = std::move(emitter);
  scene.appearance.lights.push_back(light);
  scene.views.front().lights = {scene.appearance.lights.size() - 1};
}

// One pixel that looks along `forward`, its x axis along `right`; the ray through its middle starts at `eye_m`.
inline scene::View one_pixel(Vec3 eye_m, Vec3 forward, Vec3 right) {
  const Vec3 down = cross(forward, right);
  const Mat3 rotation{{right.x, down.x, forward.x, right.y, down.y, forward.y, right.z, down.z, forward.z}};
  scene::View view{.image = "view", .camera = camera::CameraModel::parallel(1e6, 1, 1)};
  view.world_from_camera = {quaternion_of(rotation), eye_m};
  return view;
}

// A prism with the polygon `outline` in x and z (counter-clockwise seen from -y) and 2 `half_m` deep in y; flat faces.
inline std::shared_ptr<const mesh::Mesh> prism(const std::vector<Vec2>& outline, double half_m) {
  io::TriangleMesh raw;
  const auto n = static_cast<std::uint32_t>(outline.size());
  for (const double y : {-half_m, half_m})
    for (const Vec2 p : outline) raw.positions_m.push_back({p.x, y, p.y});
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    raw.triangles.push_back({i, n + j, j});
    raw.triangles.push_back({i, n + i, n + j});
  }
  for (std::uint32_t i = 1; i + 1 < n; ++i) {
    raw.triangles.push_back({0, i, i + 1});
    raw.triangles.push_back({n, n + i + 1, n + i});
  }
  return std::make_shared<const mesh::Mesh>(mesh::prepare(raw, mesh::Shading::flat, "prism"));
}

// Looks down at the plane z = 0 at an angle to its normal, from +x; the picture's x axis is y, the s axis.
inline scene::View slanted_view(double angle) {
  const Vec3 forward{-std::sin(angle), 0, -std::cos(angle)};
  return one_pixel(forward * -5, forward, {0, 1, 0});
}

inline scene::Scene plate(const std::string& model, const manifest::Parameters& parameters, double angle, Vec3 side,
                          const optics::Stokes& stokes, double thickness_m = 1) {
  SceneBuilder builder;
  builder.object(prism({{-100, -thickness_m}, {100, -thickness_m}, {100, 0}, {-100, 0}}, 100),
                 builder.surface(model, parameters));
  scene::Scene scene = builder.scene();
  scene.views = {slanted_view(angle)};
  add_emitter(scene, std::make_shared<Sky>(side, Vec3{0, 1, 0}, stokes));
  return scene;
}

// All paths of a scene of smooth interfaces, each weighted by its probability: what the path tracer estimates, without
// its noise. A path is followed to a billionth of its light.
class AllPaths {
 public:
  explicit AllPaths(const scene::Scene& scene) : caster_(scene.instances), setting_(scene, 0, caster_, {}) {}

  optics::Stokes stokes() {
    const auto [origin_m, direction] = setting_.rays.principal({0, 0});
    follow(render::Polarized::start(setting_.camera_x(), direction), {}, origin_m, direction, setting_.camera_inside);
    return sum_;
  }

 private:
  void follow(render::Polarized carrier, const std::optional<render::SurfacePoint>& left, Vec3 origin_m, Vec3 direction,
              const render::Inside& inside) {
    const auto met = left ? caster_.closest_from(*left, direction) : caster_.closest(origin_m, direction);
    if (const surface::Medium* medium = setting_.media.at(inside))
      carrier.attenuate(render::transmittance(*medium, met ? met->distance_m : render::far_away));
    if (!met) return arrive(carrier, origin_m, direction);
    std::optional<render::Crossing> crossing;
    std::optional<render::InterfaceHere> here;
    if (setting_.transmits[met->surface]) {
      crossing = setting_.media.crossing(inside, *met);
      here = render::InterfaceHere{crossing->eta, 0};
    }
    const render::Vertex vertex(setting_.scene, *met, -direction, here);
    Vec3 earlier;
    for (const double u_lobe : {1e-12, 1 - 1e-12}) {  // the first lobe and the last
      const surface::Sample next = vertex.model->sample(vertex.values, vertex.wo, {0.5, 0.5}, u_lobe);
      if (!(next.pdf > 0) || norm(next.wi - earlier) < 1e-9) continue;
      ASSERT_TRUE(next.delta);
      earlier = next.wi;
      render::Polarized branch = carrier;
      branch.scatter(vertex, next.wi, next.weight * next.pdf);
      if (branch.power().y < 1e-9) continue;
      const bool through = next.wi.z < 0;
      follow(branch, through ? render::beyond(*met) : *met, met->position_m, vertex.frame.to_world(next.wi),
             through ? crossing->inside_beyond : inside);
    }
  }
  void arrive(const render::Polarized& carrier, Vec3 origin_m, Vec3 direction) {
    for (const light::Emitter* emitter : setting_.emitters) {
      const auto value = carrier.met(direction, emitter->hit(origin_m, direction).radiance, *emitter);
      for (std::size_t i = 0; i < 4; ++i) sum_.s[i] += value[i].y;
    }
  }

  render::RayCaster caster_;
  render::PathSetting setting_;
  optics::Stokes sum_;
};

struct StokesEstimate {
  std::array<double, 4> mean{}, sigma{};  // of the middle band; sigma from the scatter of 16 passes
};
inline StokesEstimate stokes_of(const scene::Scene& scene, std::uint32_t samples, bool stokes = true,
                                int max_bounces = 128) {
  const render::RayCaster caster(scene.instances);
  render::Transport transport;
  transport.stokes = stokes;
  transport.max_bounces = max_bounces;
  const auto integrator = render::path_integrator(scene, 0, caster, transport);
  constexpr std::uint32_t passes = 16;
  StokesEstimate result;
  render::Noticed noticed;
  noticed.seen.resize(integrator->lights());
  const std::size_t planes = integrator->planes().size();
  for (std::uint32_t pass = 0; pass < passes; ++pass) {
    std::vector<Rgb> sum(planes);
    for (std::uint32_t i = 0; i < samples / passes; ++i) {
      render::Sampler sampler(7, pass, i);
      integrator->trace({0, 0}, sampler, sum, noticed);
    }
    for (std::size_t k = 0; k < planes; ++k) {
      const double value = sum[k].y / (samples / passes);
      result.mean[k] += value / passes;
      result.sigma[k] += value * value / passes;
    }
  }
  for (std::size_t k = 0; k < planes; ++k)
    result.sigma[k] = std::sqrt(std::max(0.0, result.sigma[k] - result.mean[k] * result.mean[k]) / (passes - 1));
  return result;
}

// `within`: over the light that arrives.
inline void expect_near(const optics::Stokes& found, const optics::Stokes& expected, double within = 1e-4) {
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(found.s[i], expected.s[i], within) << "s" << i;
  EXPECT_LE(std::hypot(found.s[1], found.s[2], found.s[3]), found.s[0] * (1 + 1e-12));
}
inline optics::Stokes all_paths(const scene::Scene& scene) {
  return AllPaths(scene).stokes();
}
// At 4.5 standard errors of 16 passes a false alarm comes about once in 2000 numbers (Student's t, 15 degrees).
inline void expect_estimates(const scene::Scene& scene, std::uint32_t samples, const optics::Stokes& expected) {
  const StokesEstimate found = stokes_of(scene, samples);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(found.mean[i], expected.s[i], 4.5 * found.sigma[i] + 1e-9) << "s" << i;
    EXPECT_LT(found.sigma[i], 2e-3);
  }
  EXPECT_LE(std::hypot(found.mean[1], found.mean[2], found.mean[3]), found.mean[0] * (1 + 1e-12));
}

}  // namespace gonio::tests

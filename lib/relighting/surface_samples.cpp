#include "relighting/surface_samples.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/random.h"

namespace gonio::relighting {
namespace {

struct Drawn {
  Vec3 position_m, normal, geometric_normal;  // object frame
};

double area_of(const scene::Shape& shape) {
  if (const auto* sphere = std::get_if<scene::Sphere>(&shape)) return 4 * pi * sphere->radius_m * sphere->radius_m;
  if (const auto* plane = std::get_if<scene::Plane>(&shape)) return plane->size_x_m * plane->size_y_m;
  return mesh::area_m2(*std::get<std::shared_ptr<const mesh::Mesh>>(shape));
}

Drawn on_triangle(const mesh::Mesh& mesh, std::size_t t, Vec2 u) {
  const auto& [a, b, c] = mesh.triangles[t];
  const double root = std::sqrt(u.x), b1 = root * (1 - u.y), b2 = root * u.y, b0 = 1 - b1 - b2;
  const Vec3 p = mesh.positions_m[a], q = mesh.positions_m[b], r = mesh.positions_m[c];
  const Vec3 geometric = normalized(cross(q - p, r - p));
  const Vec3 normal =
      mesh.normals.empty() ? geometric : normalized(mesh.normals[a] * b0 + mesh.normals[b] * b1 + mesh.normals[c] * b2);
  return {p * b0 + q * b1 + r * b2, normal, geometric};
}

// Points in the object's frame, area by area; stratified along the surface's area.
std::vector<Drawn> draw(const scene::Shape& shape, std::size_t count, Random& random) {
  std::vector<Drawn> points;
  if (const auto* sphere = std::get_if<scene::Sphere>(&shape)) {
    for (std::size_t i = 0; i < count; ++i) {
      const double z = 1 - 2 * (static_cast<double>(i) + random.uniform()) / static_cast<double>(count);
      const double phi = 2 * pi * random.uniform(), across = std::sqrt(std::max(0.0, 1 - z * z));
      const Vec3 n{across * std::cos(phi), across * std::sin(phi), z};
      points.push_back({n * sphere->radius_m, n, n});
    }
  } else if (const auto* plane = std::get_if<scene::Plane>(&shape)) {
    for (std::size_t i = 0; i < count; ++i) {
      const double x = (static_cast<double>(i) + random.uniform()) / static_cast<double>(count) - 0.5;
      points.push_back({{x * plane->size_x_m, (random.uniform() - 0.5) * plane->size_y_m, 0}, {0, 0, 1}, {0, 0, 1}});
    }
  } else {
    const mesh::Mesh& mesh = *std::get<std::shared_ptr<const mesh::Mesh>>(shape);
    std::vector<double> until;
    double sum = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
      const Vec3 p = mesh.positions_m[a];
      until.push_back(sum += norm(cross(mesh.positions_m[b] - p, mesh.positions_m[c] - p)) / 2);
    }
    for (std::size_t i = 0; i < count; ++i) {
      const double at = (static_cast<double>(i) + random.uniform()) / static_cast<double>(count) * sum;
      const auto t = static_cast<std::size_t>(std::upper_bound(until.begin(), until.end(), at) - until.begin());
      const double u = random.uniform();
      points.push_back(on_triangle(mesh, std::min(t, until.size() - 1), {u, random.uniform()}));
    }
  }
  return points;
}

bool inside(Vec3 p, Vec3 lower, Vec3 upper) {
  return p.x >= lower.x && p.y >= lower.y && p.z >= lower.z && p.x <= upper.x && p.y <= upper.y && p.z <= upper.z;
}

// The part of a plane that reaches into the box, as a plane of its own; other shapes as they are.
scene::Shape clipped(const scene::Instance& instance, Vec3 lower, Vec3 upper, Vec3& shift) {
  shift = {};
  const auto* plane = std::get_if<scene::Plane>(&instance.shape);
  if (!plane) return instance.shape;
  double low[2] = {plane->size_x_m, plane->size_y_m}, high[2] = {-low[0], -low[1]};
  const auto object_from_world = inverse(instance.world_from_object);
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p = object_from_world *
                   Vec3{corner & 1 ? lower.x : upper.x, corner & 2 ? lower.y : upper.y, corner & 4 ? lower.z : upper.z};
    low[0] = std::min(low[0], p.x), high[0] = std::max(high[0], p.x);
    low[1] = std::min(low[1], p.y), high[1] = std::max(high[1], p.y);
  }
  const double half[2] = {plane->size_x_m / 2, plane->size_y_m / 2};
  for (int k = 0; k < 2; ++k) low[k] = std::max(low[k], -half[k]), high[k] = std::min(high[k], half[k]);
  if (high[0] <= low[0] || high[1] <= low[1]) return scene::Plane{0, 0};
  shift = {(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, 0};
  return scene::Plane{high[0] - low[0], high[1] - low[1]};
}

}  // namespace

float received(const render::RayCaster& caster, const render::SurfacePoint& at, const LightSource& light) {
  Vec3 wi = light.direction;
  double distance_m = render::far_away, falloff = 1;
  if (!light.directional) {
    const Vec3 to_light = light.position_m - at.position_m;
    falloff = 1 / dot(to_light, to_light);
    distance_m = std::sqrt(1 / falloff);
    wi = to_light / distance_m;
  }
  const double cosine = dot(at.normal, wi);
  if (cosine <= 0 || caster.occluded(at, wi, distance_m)) return 0;
  return static_cast<float>(cosine * falloff);
}

SurfaceSamples surface_samples(const Setting& setting, std::size_t surface, Vec3 lower_m, Vec3 upper_m,
                               std::size_t count) {
  std::vector<render::SurfacePoint> points;
  std::vector<std::pair<std::size_t, scene::Shape>> shapes;
  std::vector<Vec3> shifts;
  double area = 0;
  for (std::size_t i = 0; i < setting.scene.instances.size(); ++i) {
    if (setting.scene.instances[i].surface != surface) continue;
    shifts.emplace_back();
    shapes.emplace_back(i, clipped(setting.scene.instances[i], lower_m, upper_m, shifts.back()));
    area += area_of(shapes.back().second);
  }
  Random random(41, surface);
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    const scene::Instance& instance = setting.scene.instances[shapes[k].first];
    const double share = area > 0 ? area_of(shapes[k].second) / area : 0;
    const auto wanted = static_cast<std::size_t>(share * static_cast<double>(count));
    if (wanted == 0) continue;
    for (const Drawn& d : draw(shapes[k].second, wanted, random)) {
      render::SurfacePoint p;
      p.instance = static_cast<std::uint32_t>(shapes[k].first);
      p.surface = static_cast<std::uint32_t>(surface);
      p.position_m = instance.world_from_object * (d.position_m + shifts[k]);
      p.normal = instance.world_from_object.rotate(d.normal);
      p.geometric_normal = instance.world_from_object.rotate(d.geometric_normal);
      if (inside(p.position_m, lower_m, upper_m)) points.push_back(p);
    }
  }
  SurfaceSamples samples;
  const std::size_t lights = setting.layout.lights.size();
  samples.irradiance.resize(points.size() * lights);
  for (const render::SurfacePoint& p : points) samples.position_m.push_back(p.position_m);
  parallel_for(
      0, points.size(),
      [&](std::size_t i) {
        for (std::size_t l = 0; l < lights; ++l)
          samples.irradiance[i * lights + l] = received(setting.caster, points[i], setting.layout.lights[l]);
      },
      256);
  return samples;
}

}  // namespace gonio::relighting

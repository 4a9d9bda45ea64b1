#include "relighting/lamp_shadows.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace gonio::relighting {
namespace {

constexpr std::size_t middle = shadow_across / 2;
// Of sub-samples in rows of a square: one in each other row, each in another column.
constexpr std::array<double, shadow_origins> origin_places = {0.16, 0.47, 0.64, 0.95};
constexpr double backs = -0.3;  // cosine below which no turn within the table brings the lamp over the horizon

struct NodeBefore {
  std::size_t node = 0;
  double t = 0;
};
NodeBefore node_before(double offset) {
  const double x = std::clamp(offset / shadow_step + static_cast<double>(middle), 0.0, shadow_across - 1.0);
  const std::size_t node = std::min(static_cast<std::size_t>(x), shadow_across - 2);
  return {node, x - static_cast<double>(node)};
}

double offset_of(std::size_t node) {
  return shadow_step * (static_cast<double>(node) - static_cast<double>(middle));
}

double interpolated(const std::uint8_t* nodes, double x, double y) {
  const NodeBefore u = node_before(x), v = node_before(y);
  const auto row = [&](std::size_t i) {
    const std::uint8_t* at = nodes + i * shadow_across + v.node;
    return (1 - v.t) * at[0] + v.t * at[1];
  };
  return (1 - u.t) * row(u.node) + u.t * row(u.node + 1);
}

}  // namespace

bool cast_shadows_about(Vec3 towards, Vec3 normal, const std::function<bool(Vec3)>& open,
                        std::vector<std::uint8_t>& nodes) {
  const Basis about(towards);
  const std::size_t first = nodes.size();
  nodes.resize(first + shadow_nodes, 0);
  if (dot(towards, normal) < backs) return false;
  const auto node = [&](std::size_t i, std::size_t j) -> std::uint8_t& { return nodes[first + i * shadow_across + j]; };
  const auto look = [&](std::size_t i, std::size_t j) {
    return open(normalized(about.to_world({offset_of(i), offset_of(j), 1})));
  };
  std::size_t seen = 0, corners = 0;
  for (std::size_t i = 0; i < shadow_across; i += shadow_stride)
    for (std::size_t j = 0; j < shadow_across; j += shadow_stride, ++corners) seen += node(i, j) = look(i, j);
  for (std::size_t i = 0; i + 1 < shadow_across; i += shadow_stride)
    for (std::size_t j = 0; j + 1 < shadow_across; j += shadow_stride) {
      const std::size_t u = i + shadow_stride, v = j + shadow_stride;
      const bool alike = node(i, j) == node(u, j) && node(i, j) == node(i, v) && node(i, j) == node(u, v);
      for (std::size_t k = i; k <= u; ++k)
        for (std::size_t l = j; l <= v; ++l)
          if (k % shadow_stride != 0 || l % shadow_stride != 0) node(k, l) = alike ? node(i, j) : look(k, l);
    }
  return seen > 0 && seen < corners;
}

bool cast_shadows_about(const render::RayCaster& caster, std::span<const render::SurfacePoint* const> from,
                        const LightSource& light, std::vector<std::uint8_t>& nodes) {
  const std::size_t before = nodes.size();
  bool both = false;
  for (std::size_t k = 0; k < shadow_origins; ++k) {
    const auto place = static_cast<std::size_t>(origin_places[k] * static_cast<double>(from.size()));
    const render::SurfacePoint& at = *from[place];
    const Vec3 arm = light.directional ? light.direction : light.position_m - at.position_m;
    const double distance_m = light.directional ? render::far_away : norm(arm);
    std::vector<std::uint8_t> own;
    both |= cast_shadows_about(
        normalized(arm), at.normal, [&](Vec3 direction) { return !caster.occluded(at, direction, distance_m); }, own);
    if (k == 0)
      nodes.insert(nodes.end(), own.begin(), own.end());
    else
      std::transform(own.begin(), own.end(), nodes.begin() + static_cast<std::ptrdiff_t>(before),
                     nodes.begin() + static_cast<std::ptrdiff_t>(before),
                     [](std::uint8_t a, std::uint8_t b) { return static_cast<std::uint8_t>(a + b); });
    if (k == 1 && !both) break;
  }
  if (!both) nodes.resize(before);
  return both;
}

double visible_along(const std::uint8_t* nodes, Vec3 given, Vec3 now, double visible) {
  constexpr double within_pixel = 0.02;  // rad
  const Vec3 local = Basis(given).to_local(now);
  if (!(local.z > 0)) return visible;
  const double x = local.x / local.z, y = local.y / local.z, word = std::min(1.0, std::hypot(x, y) / within_pixel);
  const double table = interpolated(nodes, x, y) / static_cast<double>(shadow_origins);
  return visible + word * (table - visible);
}

std::optional<double> openness_within(const std::uint8_t* nodes, Vec3 given, Vec3 now) {
  const Vec3 local = Basis(given).to_local(now);
  const double widest = offset_of(shadow_across - 1) * local.z;
  if (!(std::abs(local.x) <= widest && std::abs(local.y) <= widest)) return {};
  return interpolated(nodes, local.x / local.z, local.y / local.z);
}

double openness_or_last(const std::uint8_t* nodes, Vec3 given, Vec3 now) {
  const Vec3 local = Basis(given).to_local(now);
  if (!(local.z > 0)) return 0;
  return interpolated(nodes, local.x / local.z, local.y / local.z);
}

Rgb sent_back(const SurfaceState& surface, const Facet& facet, const Patch& patch, Vec3 to_light) {
  if (surface.lambertian()) return surface.model->albedo(surface.values, {0, 0, 1}) * facet.tint * (1 / pi);
  const Basis basis(patch.normal);
  const Vec3 wo = basis.to_local(patch.wo), wi = basis.to_local(to_light);
  return wo.z > 0 && wi.z > 0 ? surface.model->evaluate(surface.values, wo, wi) : Rgb{};
}

}  // namespace gonio::relighting

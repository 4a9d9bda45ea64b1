// marker.refracted: what is seen through glass is displaced.
#include "reassembly/mechanisms/marker_refracted.h"

#include <cmath>
#include <limits>
#include <optional>

namespace gonio::mechanism {

const Mechanism& marker_refracted() {
  static const Mechanism declaration{
      .id = "marker.refracted",
      .sentence = "Markers that are seen through glass stand elsewhere than they seem to: the ray of sight is bent.",
      .typical = "0.3 to 1 mm for each 3 mm of glass at 30 to 60 degrees; more through what is curved and far in front",
      .equation =
          "n1 sin(i) = n2 sin(t) where the line of sight goes into each wall and out of it, n = eta within; through a "
          "plate it comes out displaced by path cos(t) (tan(i) - tan(t))",
      .source = "Snell; Treibitz et al., IEEE PAMI 34 (2012) 51-65, eq. 1-4: flat refractive geometry",
      .stage = "geometry",
      .target = Target::scene,
      .domains = {"tables"},
      .parameters = {{.name = "eta",
                      .unit = "1",
                      .neutral = 1,
                      .lower = 1,
                      .upper = 2.2,
                      .start = 1.4,
                      .typical = 0.5,
                      .meaning = "index of refraction of the walls; 1: as if there were none"}},
      .conditions = {"glass.path", "glass.incidence"},
      .mistaken_for = {{.with = "geometry.pose",
                        .told_apart = "a view in which nothing stands in front of the markers"},
                       {.with = "volume.index", .told_apart = "nothing needs to: it is the same index"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism

namespace gonio::equation {
namespace {

constexpr int most_rounds = 12;

// Snell in vectors: `d` unit, `normal` either way round, ratio = index before over index behind.
std::optional<Vec3> bent(Vec3 d, Vec3 normal, double ratio) {
  const double along = dot(d, normal);
  const Vec3 across = (d - normal * along) * ratio;
  const double left = 1 - dot(across, across);
  if (left <= 0) return {};
  return across + normal * std::copysign(std::sqrt(left), along);
}

struct Sight {
  Vec3 at, direction;
};
struct Facet {
  Vec3 at, normal;
};
// Where the ray meets the facet's plane; nothing where it runs along it.
std::optional<Vec3> meets(const Sight& ray, const Facet& facet) {
  const double along = dot(ray.direction, facet.normal);
  if (std::abs(along) < 1e-6) return {};
  return ray.at + ray.direction * (dot(facet.at - ray.at, facet.normal) / along);
}

// Through one wall. A bent ray leaves it elsewhere than the straight line does, and where the wall is curved its face
// is turned there: by as much less as the ray has gone less far along the wall. Straight through (along the first
// normal) a wall of even thickness has parallel faces; the straight line saw how far they turn over its way. Without
// this a concentric shell bends light eta times as much as it should.
std::optional<Sight> past(const Sight& ray, const Facet& in, const Facet& out, double eta) {
  const std::optional<Vec3> first = meets(ray, in);
  const std::optional<Vec3> within = bent(ray.direction, in.normal, 1 / eta);
  if (!first || !within) return {};
  const std::optional<Vec3> second = meets({*first, *within}, out);
  if (!second) return {};
  const auto sideways = [&](Vec3 way) { return way - in.normal * dot(way, in.normal); };
  const Vec3 believed = sideways(out.at - in.at);
  const double length2 = dot(believed, believed);
  const double share = length2 > 1e-16 ? dot(sideways(*second - *first), believed) / length2 : 1;
  const std::optional<Vec3> behind = bent(*within, normalized(in.normal * (1 - share) - out.normal * share), eta);
  if (!behind) return {};
  return Sight{*second, *behind};
}

}  // namespace

Vec3 marker_refracted(Vec3 camera_m, Vec3 marker_m, Vec3 from_m, Vec3 to_m,
                      std::span<const reassembly::GlassWall> walls, double eta) {
  if (eta == 1) return marker_m;
  const Vec3 straight = normalized(to_m - from_m);
  // The camera has to look elsewhere for its bent ray to meet the marker: by what it missed it, and again, since that
  // ray is bent a little differently; much so by a thick lens. To the last digit: somebody takes differences of this.
  // What does not settle is a lens that has its focus before the marker, which nobody reads a place through.
  Vec3 seems = marker_m;
  double last = std::numeric_limits<double>::infinity();
  for (int round = 0; round < most_rounds; ++round) {
    std::optional<Sight> ray = Sight{camera_m, normalized(seems - camera_m)};
    for (const reassembly::GlassWall& wall : walls) {
      if (!(wall.path_m > 0)) continue;
      const Vec3 out = to_m - straight * wall.behind_m, in = out - straight * wall.path_m;
      if (ray) ray = past(*ray, {in, wall.in}, {out, wall.out}, eta);
    }
    if (!ray) return marker_m;
    const Vec3 missed = ray->at + ray->direction * dot(marker_m - ray->at, ray->direction) - marker_m;
    const double distance = norm(missed);
    if (distance > last && distance > 1e-9) return marker_m;
    seems = seems - missed;
    if (distance < 1e-14) break;
    last = distance;
  }
  return seems;
}

}  // namespace gonio::equation
